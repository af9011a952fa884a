// Single step through what motion has already: blocks that G64 Q has joined, blocks shorter than a span, curves, with and without jerk limits.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

struct Stream {
  std::string name;
  double p, q;
  double jerk;  ///< 0: none
  double feed;  ///< mm/s
  bool time_laws{true};
  std::vector<Pose> point;
};

std::vector<Pose> straight(int lines, double step) {
  std::vector<Pose> out;
  out.reserve(static_cast<std::size_t>(lines));
  for (int i = 1; i <= lines; ++i)
    out.push_back({.x = step * i * 0.8, .y = step * i * 0.6 + (i % 3 == 1 ? 0.0005 : 0.0)});
  return out;
}

std::vector<Pose> circle(int lines, double step, double radius) {
  std::vector<Pose> out;
  out.reserve(static_cast<std::size_t>(lines));
  for (int i = 1; i <= lines; ++i) {
    const double a = i * step / radius;
    out.push_back({.x = radius * std::sin(a), .y = radius * (1 - std::cos(a))});
  }
  return out;
}

/// Sides of short lines, with corners.
std::vector<Pose> squares(int lines, double step, int side) {
  std::vector<Pose> out;
  out.reserve(static_cast<std::size_t>(lines));
  Pose at;
  for (int i = 0; i < lines; ++i) {
    const int turn = i / side % 4;
    (turn % 2 == 0 ? at.x : at.y) += turn < 2 ? step : -step;
    out.push_back(at);
  }
  return out;
}

std::vector<Stream> streams() {
  std::vector<Stream> out;
  const auto add = [&](const std::string& name, const std::vector<Pose>& points, double feed = 50) {
    for (const double jerk : {0.0, 20000.0})
      for (const double q : {0.0, 0.05})
        for (const bool laws : {true, false}) {
          if (jerk == 0 && !laws) continue;
          out.push_back({name + (q > 0 ? ", joined" : ", Q0") +
                             (jerk == 0 ? ""
                              : laws    ? ", laws"
                                        : ", boxes"),
                         0.05, q, jerk, feed, laws, points});
        }
  };
  add("straight of 0.1 mm", straight(220, 0.1));
  add("circle of 0.1 mm", circle(220, 0.1, 8));
  add("circle of 0.01 mm", circle(600, 0.01, 3), 10);
  add("squares of 0.1 mm", squares(220, 0.1, 25));
  return out;
}

class StepStream : public testing::TestWithParam<Stream> {};

void start(Rig& rig, const Stream& s) {
  for (auto& j : rig.config.joint) j.max_jerk = s.jerk;
  rig.config.time_laws = s.time_laws;
  rig.apply_config();
  rig.ready();
  rig.seq = 0;
  rig.push(PathControl{.tolerance_mm = s.p, .naive_cam_tolerance_mm = s.q});
  for (const Pose& p : s.point) ASSERT_TRUE(rig.line(p, s.feed));
}

/// As task does it: hold, then single step from the release of hold to the moment at which motion stands.
bool step(Rig& rig) {
  rig.intent.single_step = true;
  rig.orders.hold = false;
  rig.run(3);
  const bool stood =
      rig.run_until([&] { return rig.status().held || rig.status().path_empty; }, 5000) > 0;
  rig.orders.hold = true;
  rig.intent.single_step = false;
  rig.run(3);
  return stood;
}

TEST_P(StepStream, EachBlockIsOneStepAndEndsAtItsPlace) {
  const Stream& s = GetParam();
  Rig rig;
  start(rig, s);
  // Paused in the middle of the stream, under way.
  const std::uint64_t from = 2 + s.point.size() / 3;
  ASSERT_GT(rig.run_until([&] { return rig.status().current_seq >= from; }, 20000), 0);
  rig.orders.hold = true;
  ASSERT_GT(rig.run_until([&] { return rig.status().held; }, 2000), 0);
  EXPECT_LT(rig.status().executed_seq, rig.seq * 2 / 3);
  std::uint64_t block = rig.status().current_seq;
  if (rig.status().executed_seq >= block) ++block;
  for (; block <= rig.seq; ++block) {
    ASSERT_TRUE(step(rig)) << "block " << block;
    const MotionStatus& now = rig.status();
    ASSERT_EQ(now.executed_seq, block);
    EXPECT_EQ(now.current_seq, block);
    EXPECT_EQ(now.distance_to_go, 0);
    const Pose& end = s.point[block - 2];
    EXPECT_LE(std::hypot(now.pos_cmd.x - end.x, now.pos_cmd.y - end.y), s.p + 1e-9) << block;
  }
  EXPECT_TRUE(rig.status().path_empty);
  EXPECT_EQ(rig.status().pos_cmd, s.point.back());
  EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults.front().fault);
}

/// Steps, and then on as if nothing had been: the end is exact, every block is shown in its order, no limit is broken.
TEST_P(StepStream, RunsOnAfterSteps) {
  const Stream& s = GetParam();
  Rig rig;
  start(rig, s);
  ASSERT_GT(rig.run_until([&] { return rig.status().current_seq >= 40; }, 20000), 0);
  rig.orders.hold = true;
  ASSERT_GT(rig.run_until([&] { return rig.status().held; }, 2000), 0);
  for (int n = 0; n < 7; ++n) {
    ASSERT_TRUE(step(rig));
    if (n != 3) continue;
    // Resumed in the middle of a step.
    rig.intent.single_step = true;
    rig.run(2);
    rig.orders.hold = false;
    rig.run(4);
    rig.intent.single_step = false;
    rig.run(15);
    rig.orders.hold = true;
    ASSERT_GT(rig.run_until([&] { return rig.status().held; }, 2000), 0);
  }
  rig.orders.hold = false;
  std::uint64_t before = rig.status().current_seq;
  ASSERT_GT(rig.run_until([&] {
    EXPECT_GE(rig.status().current_seq, before);
    EXPECT_GE(rig.status().current_seq, rig.status().executed_seq);
    before = rig.status().current_seq;
    return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
  }),
            0);
  EXPECT_EQ(rig.status().pos_cmd, s.point.back());
  EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults.front().fault);
}

/// Whoever steps while the machine still brakes gets the block in which it comes to rest, and no more.
TEST_P(StepStream, BegunWhileItBrakesEndsTheBlockWhereItRests) {
  const Stream& s = GetParam();
  for (int after = 1; after < 40; after += 3) {
    Rig rig;
    start(rig, s);
    ASSERT_GT(rig.run_until([&] { return rig.status().current_seq >= 60; }, 20000), 0);
    rig.orders.hold = true;
    rig.run(after);
    if (rig.status().held) break;
    ASSERT_TRUE(step(rig)) << after;
    EXPECT_EQ(rig.status().executed_seq, rig.status().current_seq) << after;
    EXPECT_EQ(rig.status().distance_to_go, 0) << after;
    EXPECT_LT(rig.status().executed_seq, rig.seq) << after;
    EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults.front().fault);
  }
}

std::string name_of(const testing::TestParamInfo<Stream>& stream) {
  std::string name;
  for (const char c : stream.param.name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, StepStream, testing::ValuesIn(streams()), name_of);

}  // namespace
}  // namespace kerf::motion
