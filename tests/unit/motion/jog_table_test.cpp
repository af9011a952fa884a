// Each kind of jog against each limit, from inside, at the limit and beyond it; modes that change under a jog.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;
using Kind = JogIntent::Kind;

enum class How { continuous, incremental, absolute, wheel, wheel_velocity };
constexpr How kHow[] = {How::continuous, How::incremental, How::absolute, How::wheel,
                        How::wheel_velocity};

constexpr double kLow = -4, kHigh = 6;

struct Jogs : Rig {
  bool axis;
  explicit Jogs(bool of_axis, double start = 0, bool home = true, double jerk = 0) : axis(of_axis) {
    for (JointConfig& j : config.joint) {
      j.min_limit = kLow;
      j.max_limit = kHigh;
      j.max_jerk = jerk;
    }
    config.joint[0].home_offset = config.joint[0].home = start;
    if (home) {
      ready();
    } else {
      apply_config();
      enable();
    }
    intent.mode = axis ? MotionMode::teleop : MotionMode::free;
    run(3);
    in.joint_wheel[0].per_count = in.axis_wheel[0].per_count = 0.5;
  }
  [[nodiscard]] WheelInputs& wheel() { return axis ? in.axis_wheel[0] : in.joint_wheel[0]; }
  [[nodiscard]] double at() const { return status().joint[0].pos_cmd; }
  /// `cycles`: how long a hand turns the wheel; a button is pressed for so long.
  void jog(How how, double sign, int cycles = 300) {
    JogIntent& j = axis ? intent.axis_jog[0] : intent.joint_jog[0];
    switch (how) {
      case How::continuous: j = {j.seq + 1, Kind::continuous, sign * 80, 0}; return;
      case How::incremental: j = {j.seq + 1, Kind::incremental, 80, sign * 30}; return;
      case How::absolute: j = {j.seq + 1, Kind::absolute, 80, sign * 30}; return;
      default:
        wheel().enable = true;
        wheel().velocity_mode = how == How::wheel_velocity;
        // A hand that turns on for a while.
        for (int i = 0; i < cycles; ++i) {
          if (i % 5 == 0) wheel().counts += sign > 0 ? 1 : -1;
          cycle();
          note();
        }
    }
  }
  void settle() {
    for (int i = 0; i < 3000; ++i) {
      cycle();
      note();
      if (i > 2 && !status().jogging) return;
    }
  }
  void note() {
    low = std::min(low, at());
    high = std::max(high, at());
  }
  double low{1e9}, high{-1e9};
};

TEST(JogTable, EachKindAgainstEachLimit) {
  int cases = 0;
  for (const bool axis : {false, true}) {
    for (const double jerk : {0.0, 20000.0}) {
      for (const How how : kHow) {
        for (const double start : {0.0, kLow, kHigh, kLow - 3, kHigh + 3}) {
          for (const double sign : {-1.0, 1.0}) {
            Jogs rig(axis, start, true, jerk);
            const std::string where = std::string(axis ? "axis " : "joint ") + "kind " +
                                      std::to_string(static_cast<int>(how)) + " from " +
                                      std::to_string(start) + (sign > 0 ? " up" : " down");
            ASSERT_EQ(rig.at(), start) << where;
            rig.low = rig.high = start;
            rig.jog(how, sign);
            rig.settle();
            ++cases;
            EXPECT_FALSE(rig.status().jogging) << where;
            // Not beyond a limit, and from outside one not farther out.
            EXPECT_GE(rig.low, std::min(kLow, start)) << where;
            EXPECT_LE(rig.high, std::max(kHigh, start)) << where;
            const bool outward = sign > 0 ? start >= kHigh : start <= kLow;
            if (outward) {
              EXPECT_EQ(rig.at(), start) << where;
            } else {
              EXPECT_EQ(rig.at(), sign > 0 ? kHigh : kLow) << where << ": inward is always open";
            }
            const bool button = how < How::wheel;
            EXPECT_EQ(rig.saw(Fault::jog_beyond_limit), outward && button) << where;
            for (const FaultRecord& f : rig.faults) {
              if (f.fault != Fault::jog_beyond_limit) continue;
              EXPECT_EQ(f.index, axis ? kAxisJog : 0);
              EXPECT_EQ(f.value, start);
              EXPECT_EQ(f.limit, sign > 0 ? kHigh : kLow);
            }
            EXPECT_FALSE(rig.saw(Fault::limit_acceleration) || rig.saw(Fault::limit_jerk)) << where;
          }
        }
      }
    }
  }
  std::printf(
      "result: each kind of jog against each soft limit, of joints and axes, with and without jerk "
      "limit, "
      "from inside, at and beyond it: %d cases, none crosses it\n",
      cases);
}

/// The switch closes under way: off in that cycle, with joint and place; then only the way off it is open, for any kind of jog.
TEST(JogTable, EachKindOntoEachLimitSwitch) {
  int cases = 0;
  for (const bool axis : {false, true}) {
    for (const How how : kHow) {
      for (const double sign : {-1.0, 1.0}) {
        for (int after = 5; after < 60; after += 9) {
          Jogs rig(axis);
          const std::string where = "kind " + std::to_string(static_cast<int>(how)) +
                                    (sign > 0 ? " up" : " down") + " after " +
                                    std::to_string(after);
          rig.jog(how, sign, after);
          if (how < How::wheel) rig.run(after);
          bool& limit = sign > 0 ? rig.in.joint[0].pos_limit : rig.in.joint[0].neg_limit;
          limit = true;
          const double at = rig.at();
          rig.cycle();
          EXPECT_FALSE(rig.status().enabled) << where;
          ASSERT_FALSE(rig.faults.empty()) << where;
          const FaultRecord f = rig.faults[0];
          EXPECT_EQ(f.fault, sign > 0 ? Fault::joint_hard_limit_max : Fault::joint_hard_limit_min);
          EXPECT_EQ(f.index, 0);
          EXPECT_NEAR(f.value, at, 0.11) << where;
          rig.run(20);
          const double rest = rig.at();
          // Overridden: farther on is refused or does nothing, the way off is open.
          rig.orders.enable = false;
          rig.run(2);
          rig.intent.override_limits = true;
          rig.enable();
          ASSERT_TRUE(rig.status().enabled) << where;
          rig.jog(how, sign);
          rig.settle();
          EXPECT_EQ(rig.at(), rest) << where;
          rig.jog(how, -sign);
          limit = false;
          rig.run(30);
          EXPECT_GT((rest - rig.at()) * sign, 0.05) << where;
          EXPECT_TRUE(rig.status().enabled) << where;
          ++cases;
        }
      }
    }
  }
  std::printf(
      "result: each kind of jog onto each limit switch, at 7 moments: %d cases, drives off in the "
      "same "
      "cycle, then only the way off is open\n",
      cases);
}

/// Nobody knows where the limits are: one travel from where each jog begins.
TEST(JogTable, UnhomedJointsHaveOneTravelAndNoLimitOfPosition) {
  for (const How how : {How::continuous, How::incremental, How::absolute}) {
    for (const double sign : {-1.0, 1.0}) {
      Jogs rig(false, 0, false);
      rig.jog(how, sign);
      rig.settle();
      EXPECT_NEAR(rig.at(), sign * (kHigh - kLow), 1e-9);
      EXPECT_TRUE(rig.faults.empty());
    }
  }
}

/// At each cycle of a jog: the mode that is asked for comes when the machine stands, the jog's limits hold until then.
TEST(JogTable, AnotherModeWaitsForTheEndOfTheJog) {
  int cases = 0;
  for (const bool axis : {false, true}) {
    for (int after = 1; after < 160; after += 3) {
      Jogs rig(axis);
      rig.jog(How::continuous, 1);
      rig.run(after);
      const MotionMode was = rig.status().mode;
      rig.intent.mode = MotionMode::coordinated;
      bool early = false;
      for (int i = 0; i < 400; ++i) {
        const bool moved = rig.status().jogging;
        rig.cycle();
        rig.note();
        early = early || (moved && rig.status().jogging && rig.status().mode != was);
      }
      EXPECT_FALSE(early);
      EXPECT_EQ(rig.status().mode, MotionMode::coordinated);
      EXPECT_LE(rig.high, kHigh);
      EXPECT_TRUE(rig.faults.empty());
      ++cases;
    }
  }
  std::printf(
      "result: another mode asked for in a jog, at %d moments: none came before the jog's end\n",
      cases);
}

TEST(JogTable, InhibitRefusesAndCountsOutsideManualAreDiscarded) {
  Jogs rig(true);
  rig.in.jog_inhibit = true;
  rig.jog(How::incremental, 1);
  rig.run(50);
  EXPECT_TRUE(rig.saw(Fault::jog_while_not_ready));
  rig.jog(How::wheel, 1);
  EXPECT_EQ(rig.at(), 0);
  rig.in.jog_inhibit = false;
  rig.run(50);
  EXPECT_EQ(rig.at(), 0) << "counts of that time are gone";
  rig.intent.mode = MotionMode::coordinated;
  rig.run(5);
  rig.jog(How::wheel, 1);
  rig.intent.mode = MotionMode::teleop;
  rig.run(100);
  EXPECT_EQ(rig.at(), 0);
  rig.wheel().counts += 1;
  rig.run(200);
  EXPECT_NEAR(rig.at(), 0.5, 1e-12);
}

/// Joints 0 and 1 move X+Y and X-Y: no axis stands for their limits, and they hold in jogs of axes.
TEST(JogTable, JointsThatShareAxesKeepTheirLimits) {
  for (const double jerk : {0.0, 20000.0}) {
    for (const bool both : {false, true}) {
      Rig rig;
      rig.kinematics.core_xy = true;
      rig.kinematics.kind = KinematicsType::both;
      for (int j = 0; j < 2; ++j) {
        rig.config.joint[j].min_limit = -5;
        rig.config.joint[j].max_limit = 5;
        rig.config.joint[j].max_jerk = 3 * jerk;
        rig.config.joint[j].max_vel = 400;
        rig.config.joint[j].max_acc = 4000;
        rig.config.axis[j].max_jerk = jerk;
      }
      rig.ready();
      rig.intent.mode = MotionMode::teleop;
      rig.run(3);
      rig.intent.axis_jog[0] = {1, Kind::continuous, 90, 0};
      if (both) rig.intent.axis_jog[1] = {1, Kind::continuous, 60, 0};
      double most = 0;
      for (int i = 0; i < 2000; ++i) {
        rig.cycle();
        for (int j = 0; j < 2; ++j) most = std::max(most, std::abs(rig.status().joint[j].pos_cmd));
      }
      EXPECT_FALSE(rig.status().jogging);
      EXPECT_LE(most, 5 + 1e-9) << both;
      EXPECT_GT(most, 4.7) << "it goes close";
      rig.intent.axis_jog[0] = {2, Kind::incremental, 90, -3};
      rig.run(1000);
      EXPECT_LT(rig.status().pos_cmd.x, 3) << "the way back is open";
      EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults[0].fault);
    }
  }
}

/// A leg that stands 0.5 ahead of its partner gets to its limit first: jogs end there, moves beyond it are refused.
TEST(JogTable, TheSkewOfAGantryCountsInItsLimits) {
  Rig rig({0, 1, 1});
  for (auto& j : rig.config.joint) j.max_limit = 10;
  rig.config.joint[2].home_offset = rig.config.joint[2].home = 0.5;
  rig.ready();
  ASSERT_EQ(rig.status().joint[2].pos_cmd, 0.5);
  const double skew = rig.status().joint[2].pos_cmd - rig.status().joint[1].pos_cmd;
  ASSERT_NEAR(skew, 0.5, 1e-12);
  rig.line({.y = 9.8}, 50);
  rig.run(1000);
  EXPECT_TRUE(rig.saw(Fault::joint_soft_limit_max));
  EXPECT_EQ(rig.status().joint[2].pos_cmd, 0.5) << "nothing was moved";
  rig.faults.clear();
  rig.abort();
  rig.run(3);
  rig.intent.mode = MotionMode::teleop;
  rig.run(3);
  rig.intent.axis_jog[1] = {1, Kind::continuous, 50, 0};
  rig.run(1500);
  EXPECT_LE(rig.status().joint[2].pos_cmd, 10);
  EXPECT_NEAR(rig.status().joint[2].pos_cmd, 10, 1e-9);
  EXPECT_TRUE(rig.faults.empty());
}

}  // namespace
}  // namespace kerf::motion
