#include "motion/core/homing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

/// A home switch that is closed where the motor stands at or above `edge`.
struct SwitchRig : Rig {
  double edge[3]{30, 30, 30};
  explicit SwitchRig(double search = 20, double latch = -2) {
    for (int j = 0; j < 3; ++j) {
      JointConfig& c = config.joint[j];
      c.home_search_vel = search;
      c.home_latch_vel = latch;
      c.home_offset = 5;
      c.home = 1;
      c.home_sequence = j;
      c.min_limit = -100;
      c.max_limit = 100;
    }
    apply_config();
  }
  void home(int joint) {
    ++intent.home_seq;
    intent.home_joint = joint;
  }
  void step() {
    for (int j = 0; j < 3; ++j) in.joint[j].home_switch = in.joint[j].motor_pos_fb >= edge[j];
    cycle();
  }
  template <class F>
  bool step_until(F&& done, int limit = 60000) {
    for (int i = 0; i < limit; ++i) {
      step();
      if (done()) return true;
    }
    return false;
  }
};

TEST(Homing, FindsTheSwitchAndGoesHome) {
  for (const double latch : {-2.0, 2.0}) {
    SwitchRig rig(20, latch);
    rig.enable();
    rig.home(0);
    ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[0].homed; }));
    const JointStatus& s = rig.status().joint[0];
    EXPECT_EQ(s.pos_cmd, 1);
    EXPECT_FALSE(s.homing);
    // Coordinate 5 stands where the switch changes: motor 30, seen in steps of the latch speed.
    EXPECT_NEAR(s.motor_offset, 25, 0.005) << latch;
    EXPECT_NEAR(rig.in.joint[0].motor_pos_fb, 26, 0.01);
    EXPECT_FALSE(rig.status().joint[1].homed);
    EXPECT_TRUE(rig.faults.empty());
  }
}

TEST(Homing, BacksOffASwitchThatIsClosedAtTheStart) {
  SwitchRig rig;
  rig.in.joint[0].motor_pos_fb = 33;
  rig.enable();
  rig.home(0);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[0].homed; }));
  EXPECT_NEAR(rig.status().joint[0].motor_offset, 25, 0.005);
}

TEST(Homing, AllFollowsTheSequence) {
  SwitchRig rig;
  rig.config.joint[0].home_sequence = 1;
  rig.config.joint[1].home_sequence = 0;
  rig.config.joint[2].home_sequence = 1;
  rig.apply_config();
  rig.enable();
  rig.home(-1);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[1].homed; }));
  EXPECT_NEAR(rig.status().joint[0].pos_cmd, 0, 0.01);
  EXPECT_NEAR(rig.status().joint[2].pos_cmd, 0, 0.01);
  rig.step();
  rig.step();
  EXPECT_TRUE(rig.status().joint[0].homing && rig.status().joint[2].homing)
      << "equal numbers go together";
  ASSERT_TRUE(
      rig.step_until([&] { return rig.status().all_homed && !rig.status().homing_active; }));
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Homing, NegativeSequencesMakeTheFinalMoveTogether) {
  SwitchRig rig;
  rig.config.joint[0].home_sequence = 0;
  rig.config.joint[1].home_sequence = -1;
  rig.config.joint[2].home_sequence = -1;
  rig.edge[2] = 60;
  rig.apply_config();
  rig.enable();
  rig.home(2);
  ASSERT_TRUE(
      rig.step_until([&] { return rig.status().joint[1].home_state == Homing::wait_sequence; }));
  EXPECT_LT(rig.status().joint[2].home_state, Homing::wait_sequence);
  ASSERT_TRUE(
      rig.step_until([&] { return rig.status().joint[2].home_state == Homing::final_move; }));
  EXPECT_EQ(rig.status().joint[1].home_state, Homing::final_move);
  ASSERT_TRUE(
      rig.step_until([&] { return rig.status().joint[1].homed && rig.status().joint[2].homed; }));
  EXPECT_FALSE(rig.status().joint[0].homed);
}

TEST(Homing, InPlaceWhenThereIsNoSwitch) {
  SwitchRig rig(0, 0);
  rig.in.joint[1].motor_pos_fb = 77;
  rig.config.joint[1].home = 5;
  rig.apply_config();
  rig.enable();
  rig.home(1);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[1].homed; }, 10));
  EXPECT_EQ(rig.status().joint[1].pos_cmd, 5);
  EXPECT_EQ(rig.status().joint[1].motor_offset, 72);
  EXPECT_EQ(rig.in.joint[1].motor_pos_fb, 77);
}

TEST(Homing, ASearchHasAnEnd) {
  SwitchRig rig;
  rig.edge[0] = 1e9;
  rig.config.joint[0].max_limit = 10;
  rig.config.joint[0].min_limit = 0;
  rig.apply_config();
  rig.enable();
  rig.home(-1);
  ASSERT_TRUE(rig.step_until([&] { return rig.saw(Fault::home_no_switch); }));
  EXPECT_NEAR(rig.in.joint[0].motor_pos_fb, 20, 1e-6) << "twice the travel";
  rig.run(10);
  EXPECT_FALSE(rig.status().homing_active);
  EXPECT_FALSE(rig.status().joint[1].homed);
}

TEST(Homing, ASecondRequestIsRefusedAndChangesNothing) {
  SwitchRig rig;
  rig.enable();
  rig.home(0);
  for (int i = 0; i < 50; ++i) rig.step();
  rig.home(1);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().joint[0].homed; }));
  EXPECT_TRUE(rig.saw(Fault::home_busy));
  EXPECT_FALSE(rig.status().joint[1].homed);
}

TEST(Homing, RefusalsSayWhy) {
  const auto reason = [](auto&& prepare) {
    SwitchRig rig;
    rig.enable();
    prepare(rig);
    rig.apply_config();
    rig.home(0);
    for (int i = 0; i < 5; ++i) rig.step();
    EXPECT_TRUE(rig.saw(Fault::home_failed));
    EXPECT_FALSE(rig.status().homing_active);
    return rig.faults.empty() ? HomeFailure{}
                              : static_cast<HomeFailure>(static_cast<int>(rig.faults[0].value));
  };
  EXPECT_EQ(reason([](SwitchRig& r) { r.config.joint[0].home_latch_vel = 0; }),
            HomeFailure::latch_vel_zero);
  EXPECT_EQ(reason([](SwitchRig& r) { r.config.joint[0].home_search_vel = 0; }),
            HomeFailure::latch_alone);
  EXPECT_EQ(reason([](SwitchRig& r) {
              r.config.joint[0].home_flags = home_use_index;
              r.config.joint[0].home_search_vel = r.config.joint[0].home_latch_vel = 0;
            }),
            HomeFailure::index_without_vel);
  EXPECT_EQ(reason([](SwitchRig& r) { r.in.homing_inhibit = true; }), HomeFailure::inhibited);
  EXPECT_EQ(reason([](SwitchRig& r) { r.orders.enable = false; }), HomeFailure::not_enabled);
  EXPECT_EQ(reason([](SwitchRig& r) {
              r.config.joint[0].home_flags = home_is_shared;
              r.edge[0] = -1;
            }),
            HomeFailure::switch_closed);
}

TEST(Homing, AbortAndFaultsStopAllJoints) {
  SwitchRig rig;
  for (auto& c : rig.config.joint) c.home_sequence = 0;
  rig.apply_config();
  rig.enable();
  rig.home(-1);
  for (int i = 0; i < 200; ++i) rig.step();
  rig.abort();
  for (int i = 0; i < 100; ++i) rig.step();
  EXPECT_FALSE(rig.status().homing_active);
  EXPECT_TRUE(rig.status().in_position);
  EXPECT_EQ(rig.status().acked_epoch, 2U);
  rig.home(-1);
  for (int i = 0; i < 200; ++i) rig.step();
  EXPECT_TRUE(rig.status().homing_active);
  rig.in.joint[1].amp_fault = true;
  rig.step();
  rig.step();
  EXPECT_FALSE(rig.status().homing_active);
  EXPECT_FALSE(rig.status().enabled);
  EXPECT_FALSE(rig.saw(Fault::limit_acceleration));
}

TEST(Homing, ASwitchSharedWithALimitIsIgnoredOnlyWhileHoming) {
  SwitchRig rig;
  rig.config.joint[0].home_flags = home_ignore_limits;
  rig.apply_config();
  rig.enable();
  rig.home(0);
  ASSERT_TRUE(rig.step_until([&] {
    rig.in.joint[0].pos_limit = rig.in.joint[0].motor_pos_fb >= 30;
    return rig.status().joint[0].homed || !rig.status().enabled;
  }));
  EXPECT_TRUE(rig.status().joint[0].homed);
  rig.in.joint[0].pos_limit = true;
  rig.step();
  EXPECT_FALSE(rig.status().enabled);
}

TEST(Homing, VolatileJointsForgetWhenSwitchedOff) {
  SwitchRig rig(0, 0);
  rig.config.joint[2].volatile_home = true;
  rig.apply_config();
  rig.enable();
  rig.home(-1);
  ASSERT_TRUE(rig.step_until([&] { return rig.status().all_homed; }, 2000));
  rig.orders.enable = false;
  rig.run(2);
  EXPECT_TRUE(rig.status().joint[0].homed);
  EXPECT_FALSE(rig.status().joint[2].homed);
}

}  // namespace
}  // namespace kerf::motion
