// G64 Q: rows of short lines become one.
#include "motion/core/planner/merge.hpp"

#include <gtest/gtest.h>

#include <set>

#include "unit/motion/polar_kinematics.hpp"
#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using path::Vec;
using test::Rig;

Vec at(double x, double y, double a = 0) { return path::to_vec({.x = x, .y = y, .a = a}); }

TEST(Merge, TakesWhatIsNearlyStraightAndLeadsForwards) {
  Merge m;
  m.begin(at(0, 0), at(1, 0));
  EXPECT_TRUE(m.add(at(2, 0.01), 0.01));
  EXPECT_NEAR(m.off_mm(), 0.005, 1e-6);
  EXPECT_FALSE(m.add(at(3, 0.1), 0.01)) << "the first vertex would be 0.033 off";
  EXPECT_TRUE(m.add(at(3, 0.01), 0.01)) << "a line that did not fit changes nothing";
  EXPECT_FALSE(m.add(at(2.5, 0.01), 0.01)) << "back on itself";
  EXPECT_FALSE(m.add(at(0, 0), 0.01)) << "back to the start";
  EXPECT_FALSE(m.add(at(4, 0, 1), 0.01)) << "angles have another measure";
  EXPECT_EQ(m.start(), at(0, 0));
  m.end();
  EXPECT_FALSE(m.add(at(4, 0), 1));
}

TEST(Merge, BoundedInNumber) {
  Merge m;
  m.begin(at(0, 0), at(1, 0));
  std::size_t n = 1;
  while (m.add(at(static_cast<double>(n + 1), 0), 0.01)) ++n;
  EXPECT_EQ(n, Merge::kMost);
}

/// The items, and the spans, that were ever in execution.
struct Driven {
  std::set<std::uint64_t> items, spans;
};
Driven driven(Rig& rig) {
  Driven seen;
  EXPECT_GT(rig.run_until([&] {
    if (const PathSpan* span = rig.controller->executor().move(); span != nullptr) {
      seen.items.insert(rig.status().current_seq);
      seen.spans.insert(span->number);
    }
    return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
  }),
            0);
  return seen;
}

void stream(Rig& rig, double q, int lines, double speed = 20) {
  rig.push(PathControl{.tolerance_mm = 0.05, .naive_cam_tolerance_mm = q});
  for (int i = 1; i <= lines; ++i) rig.line({.x = 0.5 * i, .y = i % 2 == 0 ? 0.0 : 0.001}, speed);
}

TEST(Merge, QJoinsTheLinesOfAStream) {
  Rig with, without;
  with.ready();
  without.ready();
  stream(with, 0.05, 40);
  stream(without, 0, 40);
  const Driven joined = driven(with), apart = driven(without);
  EXPECT_LE(joined.spans.size(), 8U);
  EXPECT_GE(apart.spans.size(), 40U);
  // Each line is shown all the same.
  EXPECT_EQ(joined.items.size(), 40U);
  EXPECT_EQ(apart.items.size(), 40U);
  EXPECT_EQ(with.status().pos_cmd, without.status().pos_cmd);
  EXPECT_TRUE(with.faults.empty());
}

TEST(Merge, OtherFeedsModesAndRapidsAreNotJoined) {
  Rig rig;
  rig.ready();
  rig.push(PathControl{.tolerance_mm = 0.05, .naive_cam_tolerance_mm = 0.05});
  rig.line({.x = 5}, 20);
  rig.line({.x = 10}, 30);
  rig.line({.x = 15}, 0, MotionKind::traverse);
  rig.line({.x = 20}, 0, MotionKind::traverse);
  rig.push(PathControl{.mode = PathControl::Mode::exact_path, .naive_cam_tolerance_mm = 0.05});
  rig.line({.x = 25}, 20);
  rig.line({.x = 30}, 20);
  EXPECT_EQ(driven(rig).items.size(), 6U);
}

/// Chords around a pole: their joints are within, those of one line for several of them are not.
TEST(Merge, NoJointGoesBeyondItsSoftLimitForIt) {
  const test::PolarKinematics polar;
  Rig rig{test::RigKinematics(polar)};
  constexpr double kInwards = 5e-4;
  rig.config.joint[0].min_limit = -kInwards;
  rig.apply_config();
  rig.ready();
  PathControl control;
  control.tolerance_mm = 0.1;
  control.naive_cam_tolerance_mm = 0.1;
  ASSERT_TRUE(rig.push(control));
  for (int degree = 1; degree <= 60; ++degree) {
    JointVector q{};
    Pose end;
    q[1] = degree;
    ASSERT_TRUE(polar.forward(q, end));
    ASSERT_TRUE(rig.line(end, 20));
  }
  double least = 0;
  ASSERT_GT(rig.run_until([&] {
    least = std::min(least, rig.status().joint[0].pos_cmd);
    return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
  }),
            0);
  EXPECT_GE(least, -kInwards - 1e-6);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Merge, SingleStepsKeepTheirBlocks) {
  Rig rig;
  rig.ready();
  rig.intent.single_step = true;
  rig.run(2);
  stream(rig, 0.05, 3);
  std::set<std::uint64_t> seen;
  for (int i = 0; i < 4000 && rig.status().executed_seq < rig.seq; ++i) {
    rig.cycle();
    if (rig.controller->executor().move() != nullptr) seen.insert(rig.status().current_seq);
    if (!rig.status().held) continue;
    rig.orders.hold = true;
    rig.run(2);
    rig.orders.hold = false;
    rig.run(2);
  }
  EXPECT_EQ(rig.status().executed_seq, rig.seq);
  EXPECT_EQ(seen.size(), 3U);
}

/// M62 between the lines of a stream switches where it is written, in the cycle in which the machine passes there.
TEST(Merge, OutputsKeepTheirPlaceAndOrder) {
  Rig rig;
  rig.ready();
  rig.push(PathControl{.tolerance_mm = 0.05, .naive_cam_tolerance_mm = 0.05});
  const auto output = [&](int index, double value) {
    OutputChange change;
    change.index = index;
    change.synchronised = true;
    change.value = value;
    rig.push(change);
  };
  for (int i = 1; i <= 60; ++i) {
    if (i == 21) output(0, 1);
    if (i == 41) output(1, 1), output(0, 0);
    rig.line({.x = 0.25 * i}, 20);
  }
  double on = -1, off = -1;
  ASSERT_GT(rig.run_until([&] {
    const std::uint64_t bits = rig.status().digital_out;
    if (on < 0 && (bits & 1U) != 0) on = rig.status().pos_cmd.x;
    if (on >= 0 && off < 0 && (bits & 1U) == 0) {
      off = rig.status().pos_cmd.x;
      EXPECT_EQ(bits, 2U);
    }
    return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
  }),
            0);
  const double cycle = 20 * Rig::kPeriod + 1e-9;
  EXPECT_GE(on, 5.0 - 1e-9);
  EXPECT_LE(on, 5.0 + cycle);
  EXPECT_GE(off, 10.0 - 1e-9);
  EXPECT_LE(off, 10.0 + cycle);
}

}  // namespace
}  // namespace kerf::motion
