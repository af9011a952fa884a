// Jerk limits on the whole controller: every cycle against the limit, and the times of what has a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

constexpr double kJerk = 20000, kAcc = 1000, kSpeed = 80;

class Jerk : public testing::Test {
 protected:
  void SetUp() override {
    for (auto& j : rig.config.joint) j.max_jerk = kJerk;
    rig.apply_config();
    rig.ready();
  }
  /// From rest to rest, or from `speed` to rest with `distance` 0.
  static double seven_phases(double distance, double speed) {
    const double up =
        speed >= kAcc * kAcc / kJerk ? speed / kAcc + kAcc / kJerk : 2 * std::sqrt(speed / kJerk);
    return distance > 0 ? distance / speed + up : up;
  }
  void cycle() {
    rig.cycle();
    for (std::size_t j = 0; j < 3; ++j) {
      const double p = rig.status().joint[j].pos_cmd;
      const double third = (p - 3 * before[j][0] + 3 * before[j][1] - before[j][2]) / 1e-9;
      if (++seen > 9) {
        ASSERT_LE(std::abs(third), kJerk * 1.001 + 5) << "joint " << j;
      }
      before[j][2] = before[j][1];
      before[j][1] = before[j][0];
      before[j][0] = p;
    }
  }
  template <class F>
  int run_until(F&& done, int most = 100000) {
    for (int i = 0; i < most && !HasFatalFailure(); ++i) {
      cycle();
      if (done()) return i + 1;
    }
    return -1;
  }
  int finish() {
    return run_until(
        [&] { return rig.status().executed_seq >= rig.seq && rig.status().path_empty; });
  }
  [[nodiscard]] bool stands() const { return rig.status().vel_mm_s == 0; }
  void expect_no_fault() const {
    for (const auto& f : rig.faults)
      ADD_FAILURE() << "fault " << static_cast<int>(f.fault) << " value " << f.value;
  }

  Rig rig;
  double before[3][3]{};
  int seen{0};
};

TEST_F(Jerk, AnExactStopTakesTheSevenPhases) {
  rig.push(PathControl{.mode = PathControl::Mode::exact_stop});
  rig.line({.x = 20}, kSpeed);
  rig.line({.x = 20, .y = 30}, kSpeed);
  const double least = seven_phases(20, kSpeed) + seven_phases(30, kSpeed);
  EXPECT_NEAR(finish() * Rig::kPeriod, least, 0.012);
  expect_no_fault();
}

/// Too short to reach full acceleration: four phases of full jerk.
TEST_F(Jerk, AShortExactStopTakesTheFourPhases) {
  constexpr double kWay = 0.5;
  constexpr int kMoves = 20;
  rig.push(PathControl{.mode = PathControl::Mode::exact_stop});
  for (int i = 0; i < kMoves; ++i) {
    const int along = (i + 2) / 2, across = (i + 1) / 2;
    rig.line({.x = kWay * along, .y = kWay * across}, kSpeed);
  }
  const double least = kMoves * 4 * std::cbrt(kWay / (2 * kJerk));
  const double seconds = finish() * Rig::kPeriod;
  EXPECT_LE(seconds, 1.03 * least);
  EXPECT_GE(seconds, least);
  expect_no_fault();
}

TEST_F(Jerk, AHoldStopsAtOnceInTheLeastTimeAndResumes) {
  rig.line({.x = 200}, kSpeed);
  run_until([&] { return rig.status().pos_cmd.x > 50; });
  rig.orders.hold = true;
  const int cycles = run_until([&] { return stands(); });
  EXPECT_LE(cycles * Rig::kPeriod, seven_phases(0, kSpeed) * 1.02 + 2 * Rig::kPeriod);
  run_until([] { return false; }, 50);
  EXPECT_TRUE(stands());
  rig.orders.hold = false;
  EXPECT_GT(finish(), 0);
  EXPECT_EQ(rig.status().pos_cmd.x, 200);
  expect_no_fault();
}

TEST_F(Jerk, AHoldWhileItSpeedsUpAndOneWhileItBrakes) {
  for (const double share : {0.02, 0.1, 0.9, 0.98}) {
    const double from = rig.status().pos_cmd.x, to = from + 12;
    rig.line({.x = to}, kSpeed);
    run_until([&] { return rig.status().pos_cmd.x > from + 12 * share; });
    rig.orders.hold = true;
    run_until([&] { return stands(); });
    EXPECT_LE(rig.status().pos_cmd.x, to);
    rig.orders.hold = false;
    EXPECT_GT(finish(), 0);
    EXPECT_EQ(rig.status().pos_cmd.x, to);
  }
  expect_no_fault();
}

TEST_F(Jerk, ALineThatRunsIntoAnArcIsBlendedOnAnExactPathTooWithinItsTolerance) {
  for (const double p : {0.02, 0.0}) {
    PathControl control;
    control.mode = p > 0 ? PathControl::Mode::continuous : PathControl::Mode::exact_path;
    control.tolerance_mm = p;
    rig.push(control);
    const Pose at = rig.status().pos_cmd;
    rig.line({.x = at.x + 10, .y = at.y}, 40);
    ArcMove arc;
    arc.end = {.x = at.x + 10, .y = at.y + 8};
    arc.centre[0] = at.x + 10;
    arc.centre[1] = at.y + 4;
    arc.normal[2] = 1;
    arc.vel_mm_s = 40;
    rig.push(arc);
    double slowest = 1e9, off = 0;
    run_until([&] {
      const Pose& now = rig.status().pos_cmd;
      const double x = now.x - arc.centre[0], y = now.y - arc.centre[1];
      if (std::hypot(x, y + 4) < 0.3) slowest = std::min(slowest, rig.status().vel_mm_s);
      off = std::max(off, x < 0 && y < 0 ? std::abs(y + 4) : std::abs(std::hypot(x, y) - 4));
      return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
    });
    EXPECT_GT(slowest, p > 0 ? 8 : 3);
    EXPECT_LE(off, p > 0 ? p : path::kExact);
  }
  expect_no_fault();
}

/// Angles that come from points with three decimals are none to stop at; others are.
TEST_F(Jerk, OnAnExactPathOnlyWhatIsNoCornerIsPassed) {
  rig.push(PathControl{.mode = PathControl::Mode::exact_path});
  for (const double kink : {0.001, 0.02}) {
    const Pose at = rig.status().pos_cmd;
    rig.line({.x = at.x + 10, .y = at.y}, 40);
    rig.line({.x = at.x + 20, .y = at.y + 10 * kink}, 40);
    double slowest = 1e9;
    run_until([&] {
      if (std::abs(rig.status().pos_cmd.x - at.x - 10) < 0.3)
        slowest = std::min(slowest, rig.status().vel_mm_s);
      return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
    });
    if (kink < 0.01)
      EXPECT_GT(slowest, 2) << kink;
    else
      EXPECT_LT(slowest, 1) << kink;
  }
  expect_no_fault();
}

/// As an adaptive feed has it that swings and touches 0. A machine that goes on at that is in a state from which no law leads anywhere.
TEST_F(Jerk, AFeedOfNextToNothingIsDrivenOrNone) {
  rig.push(PathControl{.mode = PathControl::Mode::continuous, .tolerance_mm = 0.02});
  for (int i = 0; i < 30; ++i) {
    ArcMove arc;
    arc.centre[0] = 30.0 * i + 15;
    arc.end = {.x = 30.0 * i + 30};
    arc.normal[2] = i % 2 == 0 ? 1 : -1;
    arc.vel_mm_s = 40;
    rig.push(arc);
  }
  const auto run = [&](int cycles) { run_until([] { return false; }, cycles); };
  run(500);
  for (const double feed :
       {0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-12, 1e-15}) {
    rig.intent.feed_override = feed;
    run(100);
    EXPECT_LT(rig.status().vel_mm_s, 30) << feed;
    run(200);
    EXPECT_LT(rig.status().vel_mm_s, 1.05 * 40 * feed) << feed;
    if (40 * feed < 1e-6) {
      EXPECT_EQ(rig.status().vel_mm_s, 0) << feed;
    }
    if (rig.status().vel_mm_s == 0) {
      EXPECT_EQ(rig.status().waiting_for, PathWait::zero_override);
    }
    rig.intent.feed_override = 1;
    run(250);
    EXPECT_GT(rig.status().vel_mm_s, 35) << feed;
  }
  expect_no_fault();
}

/// On short moves with curves between them, too. Where it stood the next law begins anywhere, a hair before the end of one of them if need be.
TEST_F(Jerk, ALowOverrideIsMetAsSoonAsAStopAndLeftAgain) {
  rig.push(PathControl{.mode = PathControl::Mode::continuous, .tolerance_mm = 0.02});
  for (int i = 1; i <= 800; ++i) rig.line({.x = 0.4 * i, .y = 3 * std::sin(0.2 * i)}, 40);
  const auto run = [&](int cycles) { run_until([] { return false; }, cycles); };
  run(500);
  for (const double feed : {0.1, 0.03, 0.02, 0.01, 5e-3, 3e-3, 2e-3, 1e-3, 3e-4, 1e-4, 1e-5}) {
    rig.intent.feed_override = feed;
    run(200);
    EXPECT_LT(rig.status().vel_mm_s, 1.05 * 40 * feed) << feed;
    run(300);
    EXPECT_LT(rig.status().vel_mm_s, 1.0001 * 40 * feed) << feed;
    if (40 * feed > 0.1) {
      EXPECT_GT(rig.status().vel_mm_s, 0.95 * 40 * feed) << feed;
    }
    rig.intent.feed_override = 1;
    run(250);
    EXPECT_GT(rig.status().vel_mm_s, 20) << feed;
  }
  expect_no_fault();
}

TEST_F(Jerk, ANegativeAdaptiveFeedTurnsBackWithinTheLimit) {
  OverrideEnable e;
  e.feed = e.feed_hold = e.adaptive = true;
  rig.push(e);
  rig.push(PathControl{.mode = PathControl::Mode::continuous, .tolerance_mm = 0.2});
  for (int i = 1; i < 6; ++i) rig.line({.x = 6.0 * i, .y = i % 2 != 0 ? 7.0 : 0.0}, 40);
  run_until([&] { return rig.status().pos_cmd.x > 20; });
  rig.in.adaptive_feed = -0.7;
  run_until([&] { return rig.status().pos_cmd.x < 8; });
  EXPECT_LT(rig.status().pos_cmd.x, 8);
  rig.in.adaptive_feed = 1;
  EXPECT_GT(finish(), 0);
  EXPECT_EQ(rig.status().pos_cmd.x, 30);
  expect_no_fault();
}

TEST_F(Jerk, TheGuardLatchesAJumpOfAcceleration) {
  rig.line({.x = 50}, 40);
  // The guard goes by its own limits, so a lower one than was planned with is a break.
  MachineConfig lower = rig.config;
  lower.joint[0].max_jerk = kJerk / 2;
  rig.controller->configure(lower);
  rig.run(50);
  ASSERT_TRUE(rig.saw(Fault::limit_jerk));
  EXPECT_EQ(rig.faults.front().index, 0);
  EXPECT_EQ(rig.faults.front().tag.line, 1);
}

/// However slow: a law of days must not lose the seconds at its start.
TEST(JerkFromRest, AProgrammedFeedIsReachedSoonHoweverSlow) {
  for (const double jerk : {5000.0, 50000.0, 1e6})
    for (const double feed : {1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 2e-6}) {
      Rig slow;
      for (auto& j : slow.config.joint) j.max_jerk = jerk;
      slow.apply_config();
      slow.ready();
      ArcMove arc;
      arc.centre[0] = 15;
      arc.end = {.x = 30};
      arc.normal[2] = 1;
      arc.vel_mm_s = feed;
      slow.push(arc);
      slow.run(100);
      EXPECT_GT(slow.status().vel_mm_s, 0.9 * feed) << jerk;
      EXPECT_LT(slow.status().vel_mm_s, 1.03 * feed) << jerk;
    }
}

}  // namespace
}  // namespace kerf::motion
