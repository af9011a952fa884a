// Machines whose kinematics answer later, as modules in C do: their corners are passed as those of others are.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "property/motion/drive.hpp"

namespace kerf::motion {
namespace {

using test::Drive;

constexpr double kJerk = 50'000;
/// What answers may cost, most of it before the first move (cycles).
constexpr int kFirstAnswers = 250;

test::RigKinematics later(const Kinematics& kinematics) {
  test::RigKinematics out(kinematics);
  out.later = true;
  return out;
}

int cycles_of(Drive& one) {
  int cycles = 0;
  while (!one.done() && one.rig.faults.empty() && cycles < 100'000) one.cycle(), ++cycles;
  EXPECT_TRUE(one.rig.faults.empty());
  EXPECT_TRUE(one.done());
  EXPECT_LE(one.oracle.vel, 1.0001);
  EXPECT_LE(one.oracle.acc, 1.001);
  EXPECT_LE(one.oracle.jerk, 1.01);
  return cycles;
}

class AskedPath : public testing::TestWithParam<double> {};

TEST_P(AskedPath, CornersArePassedAsWhenAnswersComeAtOnce) {
  const double jerk = GetParam();
  for (const double feed : {50.0, 150.0}) {
    const bench::Program wall = bench::swarf(40, 0.02, feed);
    Drive at_once(wall, jerk), asked(wall, jerk, true, later(bench::kTable));
    const int least = cycles_of(at_once), taken = cycles_of(asked);
    EXPECT_LE(taken, 1.02 * least + kFirstAnswers) << "F" << feed << " mm/s";
    for (std::size_t j = 0; j < 5; ++j)
      EXPECT_NEAR(asked.rig.status().joint[j].pos_cmd, at_once.rig.status().joint[j].pos_cmd, 1e-9);
  }
}

/// Moves of 3 to 16 ms: answers do not come so fast, but what has come is driven without a stop at each corner.
TEST_P(AskedPath, MovesThatEndBeforeAnswersComeTakeTwiceAsLongAtMost) {
  const double jerk = GetParam();
  const bench::Program wall = bench::swarf(300, 0.02, 100);
  Drive at_once(wall, jerk), asked(wall, jerk, true, later(bench::kTable));
  const int least = cycles_of(at_once), taken = cycles_of(asked);
  EXPECT_LE(taken, 2 * least);
  std::printf(
      "result: 300 moves at 100 mm/s on the table, jerk %g: %.2f times as long where kinematics "
      "answer later\n",
      jerk, static_cast<double>(taken) / least);
}

TEST_P(AskedPath, WhateverTheOperatorDoesMeanwhileLimitsHold) {
  const double jerk = GetParam();
  for (int seed = 1; seed <= test::property_count(20) && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random r(static_cast<unsigned>(seed));
    const bench::Program wall =
        bench::swarf(60, 0.02, r.uniform(20, 150), static_cast<std::uint64_t>(seed));
    Drive one(wall, jerk, true, later(bench::kTable));
    // Often while the first answers are awaited.
    const int abort_at = r.integer(1, r.chance(0.5) ? 60 : 1500);
    for (int cycle = 0; cycle < abort_at; ++cycle) {
      if (r.chance(0.01)) one.rig.intent.feed_override = r.uniform(0, 2);
      if (r.chance(0.01)) one.rig.orders.hold = !one.rig.orders.hold;
      one.cycle();
    }
    one.rig.abort();
    one.rig.orders.hold = false;
    one.rig.intent.feed_override = 1;
    const auto until = [&](auto&& done) {
      int cycles = 0;
      for (; !done() && cycles < 5000; ++cycles) {
        one.rig.cycle();
        one.oracle.watch(one.rig);
      }
      return cycles < 5000;
    };
    EXPECT_TRUE(until([&] { return one.rig.status().in_position; }));
    const double before = one.rig.status().joint[0].pos_cmd;
    int waits = 0;
    EXPECT_TRUE(until([&] { return ++waits > 50; }));
    EXPECT_EQ(one.rig.status().joint[0].pos_cmd, before) << "nothing that was awaited is driven";
    Pose there = one.rig.status().pos_cmd;
    there.x += 5;
    ASSERT_TRUE(one.rig.line(there, 20));
    EXPECT_TRUE(until([&] {
      return one.rig.status().executed_seq >= one.rig.seq && one.rig.status().path_empty;
    }));
    EXPECT_NEAR(one.rig.status().pos_cmd.x, there.x, 1e-9);
    EXPECT_TRUE(one.rig.faults.empty());
    EXPECT_LE(one.oracle.vel, 1.0001);
    EXPECT_LE(one.oracle.acc, 1.001);
    EXPECT_LE(one.oracle.jerk, 1.01);
  }
}

/// The table with joints as rough as those of a search that ends 1e-8 mm from the solution.
class Rough final : public Kinematics {
 public:
  [[nodiscard]] KinematicsType type() const noexcept override { return bench::kTable.type(); }
  [[nodiscard]] std::int32_t joints() const noexcept override { return bench::kTable.joints(); }
  [[nodiscard]] bool forward(const JointVector& q, Pose& p) const noexcept override {
    return bench::kTable.forward(q, p);
  }
  [[nodiscard]] bool inverse(const Pose& p, JointVector& q) const noexcept override {
    if (!bench::kTable.inverse(p, q)) return false;
    for (std::size_t j = 0; j < 3; ++j)
      q[j] += 1e-8 * std::sin(1e5 * (p.x + 2 * p.y + 3 * p.z) + static_cast<double>(j));
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t j) const noexcept override {
    return bench::kTable.axis_of_joint(j);
  }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override {
    return bench::kTable.axis_mask();
  }
};

TEST_P(AskedPath, RoughAnswersMakeEachMoveOneByItself) {
  const double jerk = GetParam();
  const Rough rough;
  const bench::Program wall = bench::swarf(60, 0.02, 50);
  Drive smooth(wall, jerk), one(wall, jerk, true, later(rough));
  const int least = cycles_of(smooth);
  const int taken = cycles_of(one);
  EXPECT_GT(taken, 2 * least) << "it stops at each corner";
  EXPECT_LT(taken, 20 * least) << "it crawls";
  std::printf(
      "result: 60 moves at 50 mm/s on the table, jerk %g: %.2f times as long where answers are "
      "rough\n",
      jerk, static_cast<double>(taken) / least);
}

/// It asks more than there is room for if each turn is looked at as closely as one alone.
TEST_P(AskedPath, ATableThatTurnsByALotBegins) {
  bench::ProgramWriter writer("turns", 0.02, 50);
  writer.program().machine = bench::Machine::table;
  Pose turned;
  turned.x = 30;
  turned.c = 30'000;
  writer.rapid(turned);
  const bench::Program program = writer.done();
  Drive one(program, GetParam(), true, later(bench::kTable));
  for (int n = 0; n < 2000; ++n) one.cycle();
  EXPECT_TRUE(one.rig.faults.empty());
  EXPECT_GT(one.rig.status().joint[4].pos_cmd, 45);
}

INSTANTIATE_TEST_SUITE_P(Limits, AskedPath, testing::Values(0.0, kJerk),
                         [](const auto& p) { return p.param > 0 ? "jerk" : "acceleration"; });

}  // namespace
}  // namespace kerf::motion
