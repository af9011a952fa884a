// Every kind of homing that the manual has, on motors that keep their true place whatever their encoders say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motion/core/homing.hpp"
#include "unit/motion/homing_rig.hpp"

namespace kerf::motion {
namespace {

using test::HomingRig;

HomeFailure why(const HomingRig& rig) {
  return static_cast<HomeFailure>(static_cast<int>(rig.failure()));
}

/// Switch at 3, index pulses every 2: the one behind the switch at 2 (going back) or 4 (going on).
TEST(HomingToIndex, CountsFromThePulse) {
  for (const bool resets : {true, false}) {
    for (const double latch : {-5.0, 5.0}) {
      HomingRig rig;
      JointConfig& c = rig.config.joint[0];
      c.home_latch_vel = latch;
      c.home_flags = home_use_index | (resets ? 0 : home_index_no_encoder_reset);
      rig.apply_config();
      rig.drive[0].index_every = 2;
      rig.drive[0].resets = resets;
      rig.enable();
      double worst = 0;
      rig.disturb = [&] {
        if (rig.status().homing_active)
          worst = std::max(worst, std::abs(rig.drive[0].place - rig.drive[0].seen));
      };
      rig.home(0);
      ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[0].homed; })) << latch;
      // Joint position 5 is at the pulse; the joint went to 1. Without a reset the place is known to one cycle of the latch.
      const double pulse = latch < 0 ? 2 : 4;
      EXPECT_NEAR(rig.drive[0].place, pulse - 4, resets ? 1e-9 : 0.0051) << latch;
      EXPECT_EQ(rig.status().joint[0].pos_cmd, 1);
      EXPECT_TRUE(rig.faults.empty()) << static_cast<int>(rig.faults[0].fault);
      EXPECT_FALSE(rig.drive[0].index_enable);
      EXPECT_EQ(rig.drive[0].zero, resets ? pulse : 0);
      rig.steps(100);
      EXPECT_TRUE(rig.status().enabled) << "the new count is no following error";
    }
  }
}

TEST(HomingToIndex, WithoutASwitchTheFirstPulseCounts) {
  HomingRig rig;
  JointConfig& c = rig.config.joint[1];
  c.home_search_vel = 0;
  c.home_latch_vel = -5;
  c.home_flags = home_use_index;
  rig.apply_config();
  rig.drive[1].place = 1;
  rig.drive[1].index_every = 8;
  rig.enable();
  rig.home(1);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[1].homed; }));
  EXPECT_NEAR(rig.drive[1].place, -4, 1e-9);
  EXPECT_EQ(rig.drive[1].zero, 0);
}

TEST(HomingToIndex, APulseThatNeverComesIsBoundedAndNamed) {
  HomingRig rig;
  JointConfig& c = rig.config.joint[0];
  c.home_flags = home_use_index;
  c.home_latch_dist = 4;
  rig.apply_config();
  rig.enable();
  rig.home(0);
  double low = 1e9;
  ASSERT_TRUE(rig.step_until([&] {
    low = std::min(low, rig.drive[0].place);
    return !rig.faults.empty();
  }));
  EXPECT_EQ(why(rig), HomeFailure::no_index);
  rig.steps(100);
  EXPECT_GE(low, 3 - 4 - 1e-6);
  EXPECT_FALSE(rig.drive[0].index_enable) << "the encoder would count from a later pulse";
  EXPECT_FALSE(rig.status().joint[0].homed);
  EXPECT_FALSE(rig.status().homing_active);
}

TEST(HomingToIndex, AbortTakesTheRequestBack) {
  HomingRig rig;
  rig.config.joint[0].home_flags = home_use_index;
  rig.apply_config();
  rig.enable();
  rig.home(0);
  ASSERT_TRUE(
      rig.step_until([&] { return rig.status().joint[0].home_state == Homing::index_search; }));
  rig.steps(2);
  EXPECT_TRUE(rig.drive[0].index_enable);
  rig.abort();
  rig.steps(100);
  EXPECT_FALSE(rig.drive[0].index_enable);
  const double offset = rig.status().joint[0].motor_offset;
  rig.drive[0].index_every = 1;
  rig.steps(10);
  EXPECT_EQ(rig.status().joint[0].motor_offset, offset);
}

TEST(HomingAbsolute, TakesTheOffsetWhereItStands) {
  for (const bool moves : {true, false}) {
    HomingRig rig;
    JointConfig& c = rig.config.joint[0];
    c.home_flags =
        home_absolute_encoder | home_no_rehome | home_is_shared | (moves ? 0 : home_no_final_move);
    rig.apply_config();
    rig.drive[0].place = 10;  // on its switch, which does not matter
    rig.enable();
    rig.home(0);
    ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[0].homed; }));
    EXPECT_EQ(rig.status().joint[0].pos_cmd, moves ? 1 : 5);
    EXPECT_NEAR(rig.drive[0].place, moves ? 6 : 10, 1e-9);
    rig.home(0);
    rig.steps(20);
    EXPECT_TRUE(rig.status().joint[0].homed) << "a second request passes silently";
    EXPECT_NEAR(rig.drive[0].place, moves ? 6 : 10, 1e-9);
    EXPECT_FALSE(rig.status().homing_active);
    EXPECT_TRUE(rig.faults.empty());
  }
}

TEST(HomingIndexer, MovesOnlyUnlockedAndIsLockedAtTheEnd) {
  HomingRig rig;
  rig.config.joint[2].home_flags = home_unlock_first;
  rig.apply_config();
  rig.drive[2].locks = true;
  rig.enable();
  rig.home(-1);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[0].homed; }));
  ASSERT_TRUE(rig.step_until([&] { return rig.all_home(); }));
  EXPECT_EQ(rig.turned_locked, 0);
  EXPECT_FALSE(rig.drive[2].unlocked) << "homed means locked again";
  EXPECT_NEAR(rig.drive[2].place, -1, 0.01);
  // Stopped half way it brakes first, then locks.
  rig.home(2);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[2].home_state == Homing::search; }));
  rig.steps(100);
  rig.abort();
  rig.steps(200);
  EXPECT_EQ(rig.turned_locked, 0);
  EXPECT_FALSE(rig.drive[2].unlocked);
  EXPECT_FALSE(rig.status().joint[2].homed);
}

TEST(HomingShortCam, OverrunInTheSearchIsFoundAgain) {
  for (const double latch : {-5.0, 5.0}) {
    HomingRig rig;
    rig.config.joint[0].home_search_vel = 50;
    rig.config.joint[0].home_latch_vel = latch;
    rig.apply_config();
    rig.drive[0].cam = 0.4;  // the stop from 50 mm/s takes 1.25
    rig.enable();
    rig.home(0);
    ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[0].homed; })) << latch;
    EXPECT_NEAR(rig.drive[0].place, 3 - 4, 0.006) << "the edge that the search met first";
    EXPECT_TRUE(rig.faults.empty());
  }
}

TEST(HomingShortCam, AGlitchIsNoSwitch) {
  for (const double latch : {-5.0, 5.0}) {
    HomingRig rig;
    rig.config.joint[0].home_latch_vel = latch;
    rig.apply_config();
    rig.enable();
    rig.home(0);
    int cycle = 0;
    rig.disturb = [&] { rig.in.joint[0].home_switch = ++cycle == 60; };
    double low = 1e9;
    ASSERT_TRUE(rig.step_until([&] {
      low = std::min(low, rig.drive[0].place);
      return !rig.faults.empty();
    }));
    rig.steps(100);
    EXPECT_EQ(why(rig), HomeFailure::switch_lost);
    EXPECT_FALSE(rig.status().joint[0].homed);
    EXPECT_GT(rig.drive[0].place, 0) << "not sent across the machine";
  }
}

TEST(HomingBounds, EndEachPhase) {
  struct Case {
    double search_dist, latch_dist, latch;
    double edge, from;
    bool never_opens;
    double end_low, high;
    Fault fault;
  };
  const Case cases[] = {
      {10, 0, -5, 1e9, 0, false, -0.01, 10.01, Fault::home_no_switch},
      {10, 2, -5, 3, 0, true, 3 - 2, 3.3, Fault::home_no_switch},
      {10, 2, -5, 3, 5, true, -5.01, 5.01, Fault::home_failed},
      {10, 2, 5, 3, 0, true, 3 - 10, 3.3, Fault::home_failed},
  };
  for (const Case& k : cases) {
    HomingRig rig;
    JointConfig& c = rig.config.joint[0];
    c.home_search_dist = k.search_dist;
    c.home_latch_dist = k.latch_dist;
    c.home_latch_vel = k.latch;
    rig.apply_config();
    rig.drive[0].edge = k.edge;
    rig.drive[0].place = k.from;
    rig.enable();
    bool closed = false;
    rig.disturb = [&] {
      closed = closed || rig.in.joint[0].home_switch;
      if (k.never_opens) rig.in.joint[0].home_switch = closed;
    };
    rig.home(0);
    double high = k.from;
    ASSERT_TRUE(rig.step_until([&] {
      high = std::max(high, rig.drive[0].place);
      return !rig.faults.empty();
    }));
    EXPECT_EQ(rig.faults[0].fault, k.fault);
    EXPECT_LE(high, k.high);
    rig.steps(100);
    EXPECT_GE(rig.drive[0].place, k.end_low);
    EXPECT_TRUE(rig.status().in_position);
    EXPECT_FALSE(rig.status().joint[0].homed);
  }
}

TEST(HomingRules, WhatCannotBeIsRefusedBeforeAnythingMoves) {
  HomingRig rig;
  rig.config.joint[2].home_sequence = 2;
  rig.config.joint[2].home_latch_vel = 0;
  rig.apply_config();
  rig.enable();
  rig.home(-1);
  rig.steps(50);
  EXPECT_EQ(why(rig), HomeFailure::latch_vel_zero);
  EXPECT_EQ(rig.drive[0].place, 0);
  EXPECT_FALSE(rig.status().homing_active);
}

TEST(HomingRules, AStopOnAnIgnoredLimitEndsUnderPower) {
  HomingRig rig;
  rig.config.joint[0].home_flags = home_ignore_limits;
  rig.apply_config();
  rig.enable();
  rig.home(0);
  rig.disturb = [&] { rig.in.joint[0].pos_limit = rig.in.joint[0].home_switch; };
  ASSERT_TRUE(rig.step_until([&] { return rig.in.joint[0].pos_limit; }));
  rig.abort();
  rig.steps(3);
  EXPECT_TRUE(rig.status().enabled);
  EXPECT_FALSE(rig.status().in_position);
  rig.steps(100);
  EXPECT_TRUE(rig.saw(Fault::joint_hard_limit_max)) << "at rest it counts";
}

/// Two legs of Y on one beam, switches 1.5 apart. Both kinds of latch, from before, between and behind the switches.
TEST(HomingGantry, LegsKeepTogether) {
  double worst = 0;
  for (const double latch : {-5.0, 5.0}) {
    for (const double from : {0.0, 3.5, 8.0}) {
      for (const bool index : {false, true}) {
        HomingRig rig({0, 1, 1});
        for (int j = 1; j < 3; ++j) {
          JointConfig& c = rig.config.joint[j];
          c.home_sequence = -1;
          c.home_latch_vel = latch;
          c.max_acc = j == 1 ? 1000 : 500;
          c.home_final_vel = j == 1 ? 30 : 40;
          c.home_flags = index ? home_use_index : 0;
          rig.drive[j].index_every = 0.5;
          rig.drive[j].place = from;
        }
        rig.drive[2].edge = 4.5;
        rig.config.joint[2].home_offset = 6.5;
        rig.apply_config();
        rig.enable();
        rig.home(1);
        double skew = 0;
        ASSERT_TRUE(rig.step_until([&] {
          skew = std::max(skew, std::abs(rig.drive[1].place - rig.drive[2].place));
          return rig.status().joint[1].homed && rig.status().joint[2].homed;
        })) << latch
            << ' ' << from;
        // Misalignment, the cycle in which it is seen, the latch's way to stop, and with an index one pulse of it.
        const double overshoot = 0.02 + 5 * 5 / (2 * 500.0) + (index ? 0.5 : 0);
        EXPECT_LE(skew, 1.5 + overshoot) << latch << ' ' << from << ' ' << index;
        if (!index) worst = std::max(worst, skew - 1.5);
        EXPECT_NEAR(rig.drive[1].place, rig.drive[2].place, index ? 0.5001 : 0.006)
            << "the offsets square it";
        EXPECT_TRUE(rig.faults.empty());
        EXPECT_FALSE(rig.status().joint[0].homed);
      }
    }
  }
  std::printf(
      "result: gantry with coupled legs, switches 1.5 mm apart: skew at most the misalignment + "
      "%.3f "
      "mm (latch overshoot allowed: 0.045)\n",
      worst);
}

TEST(HomingGantry, AFaultOfOneLegStopsBoth) {
  HomingRig rig({0, 1, 1});
  for (int j = 1; j < 3; ++j) rig.config.joint[j].home_sequence = -1;
  rig.config.joint[2].home_search_dist = 6;
  rig.drive[2].edge = 1e9;
  rig.apply_config();
  rig.enable();
  rig.home(2);
  ASSERT_TRUE(rig.step_until([&] { return rig.saw(Fault::home_no_switch); }));
  const double at = rig.drive[1].place;
  rig.steps(200);
  EXPECT_EQ(rig.drive[1].place, at) << "it had waited on its switch";
  EXPECT_NEAR(rig.drive[2].place, 6, 1e-6);
  EXPECT_FALSE(rig.status().joint[1].homed || rig.status().joint[2].homed);
}

}  // namespace
}  // namespace kerf::motion
