// Power, faults, modes and jogging.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

void jog(Rig& rig, int joint, JogIntent::Kind kind, double vel, double target = 0) {
  JogIntent& j = rig.intent.mode == MotionMode::teleop ? rig.intent.axis_jog[joint]
                                                       : rig.intent.joint_jog[joint];
  ++j.seq;
  j.kind = kind;
  j.vel = vel;
  j.target = target;
}

TEST(Controller, DisabledFollowsTheFeedback) {
  Rig rig;
  rig.follow = false;
  rig.in.joint[0].motor_pos_fb = 7;
  rig.run(2);
  EXPECT_FALSE(rig.status().enabled);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, 7);
  EXPECT_EQ(rig.status().pos_cmd.x, 7);
  rig.follow = true;
  rig.enable();
  EXPECT_TRUE(rig.status().enabled);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, 7) << "switching on moves nothing";
}

TEST(Controller, JointsBeginWhereTheyWereWhenTheMachineWentOff) {
  Rig rig;
  rig.follow = false;
  rig.in.joint[0].motor_pos_fb = 7;
  rig.config.joint[0].start = 12.5;
  rig.config.joint[0].has_start = true;
  rig.apply_config();
  rig.run(2);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, 12.5);
  EXPECT_EQ(rig.status().joint[0].pos_fb, 12.5);
  EXPECT_EQ(rig.status().pos_cmd.x, 12.5);
  EXPECT_EQ(rig.status().joint[0].motor_offset, -5.5);
  EXPECT_FALSE(rig.status().joint[0].homed);
  EXPECT_EQ(rig.status().joint[1].pos_cmd, 0);
  rig.in.joint[0].motor_pos_fb = 8;
  rig.apply_config();
  rig.run(2);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, 13.5) << "only the first time";
}

TEST(Controller, FaultsSwitchOffAndNeedANewRequest) {
  const auto off_by = [](Fault fault, auto&& provoke, auto&& mend) {
    Rig rig;
    rig.ready();
    rig.push(SpindleChange{.action = SpindleChange::Action::forward, .speed_rpm = 100});
    rig.line({.x = 500}, 50);
    rig.run(100);
    provoke(rig);
    rig.run(3);
    EXPECT_FALSE(rig.status().enabled);
    EXPECT_TRUE(rig.saw(fault)) << static_cast<int>(fault);
    EXPECT_FALSE(rig.controller->spindles().outputs(0).on);
    EXPECT_TRUE(rig.status().path_empty);
    const std::size_t faults = rig.faults.size();
    mend(rig);
    rig.follow = true;
    rig.run(100);
    EXPECT_FALSE(rig.status().enabled) << "only a new request switches on";
    EXPECT_EQ(rig.faults.size(), faults);
    rig.orders.enable = false;
    rig.run(2);
    rig.orders.enable = true;
    rig.run(2);
    EXPECT_TRUE(rig.status().enabled);
    const double x = rig.status().pos_cmd.x;
    rig.run(500);
    EXPECT_EQ(rig.status().pos_cmd.x, x) << "what was queued is void";
  };
  off_by(
      Fault::enable_lost, [](Rig& r) { r.in.enable = false; }, [](Rig& r) { r.in.enable = true; });
  off_by(
      Fault::amp_fault, [](Rig& r) { r.in.joint[1].amp_fault = true; },
      [](Rig& r) { r.in.joint[1].amp_fault = false; });
  off_by(
      Fault::spindle_fault, [](Rig& r) { r.in.spindle[0].amp_fault = true; },
      [](Rig& r) { r.in.spindle[0].amp_fault = false; });
  off_by(
      Fault::joint_hard_limit_max, [](Rig& r) { r.in.joint[0].pos_limit = true; },
      [](Rig& r) { r.in.joint[0].pos_limit = false; });
  off_by(
      Fault::joint_hard_limit_min, [](Rig& r) { r.in.joint[0].neg_limit = true; },
      [](Rig& r) { r.in.joint[0].neg_limit = false; });
  off_by(
      Fault::following_error,
      [](Rig& r) {
        r.follow = false;
        r.in.joint[2].motor_pos_fb += 2;
      },
      [](Rig&) {});
}

TEST(Controller, FollowingErrorLimitGrowsWithTheSpeed) {
  Rig rig;
  rig.config.joint[0].ferror = 10;
  rig.config.joint[0].min_ferror = 0.5;
  rig.ready();
  rig.line({.x = 500}, 50);
  rig.run(300);
  EXPECT_NEAR(rig.status().joint[0].ferror_limit, 5, 1e-6);
  EXPECT_NEAR(rig.status().joint[1].ferror_limit, 0.5, 1e-12);
  rig.follow = false;
  rig.run(90);
  EXPECT_TRUE(rig.status().enabled) << "4.5 mm behind";
  rig.run(20);
  EXPECT_TRUE(rig.saw(Fault::following_error));
}

// BACKLASH = 0.4: the motor goes 0.2 further to the side that the joint moves to; the joint's own position knows nothing of
// it, nor does the following error.
TEST(Controller, BacklashIsMadeGoodWithinItsShareOfTheLimits) {
  Rig rig;
  rig.config.joint[0].backlash = 0.4;
  rig.apply_config();
  rig.ready();
  const auto extra = [&] { return rig.controller->joint(0).backlash.position(); };
  rig.run(10);
  EXPECT_EQ(extra(), 0) << "nothing has moved yet";
  double before = 0, speed_before = 0;
  const auto goes_within_limits = [&] {
    const double speed = (extra() - before) / Rig::kPeriod;
    EXPECT_LE(std::abs(speed), 0.5 * rig.config.joint[0].max_vel + 1e-9);
    EXPECT_LE(std::abs(speed - speed_before) / Rig::kPeriod,
              0.5 * rig.config.joint[0].max_acc * (1 + 1e-6) + 1e-3);
    before = extra();
    speed_before = speed;
    EXPECT_NEAR(rig.status().joint[0].ferror, 0, 1e-9);
  };
  const auto move_to = [&](double x) {
    ASSERT_TRUE(rig.line({.x = x}, 20));
    ASSERT_GT(rig.run_until([&] {
      goes_within_limits();
      return rig.status().path_empty && rig.status().in_position;
    }),
              0);
    for (int i = 0; i < 200; ++i) {
      rig.cycle();
      goes_within_limits();
    }
    EXPECT_NEAR(rig.status().joint[0].pos_cmd, x, 1e-9);
  };
  move_to(5);
  EXPECT_NEAR(extra(), 0.2, 1e-12);
  move_to(8);
  EXPECT_NEAR(extra(), 0.2, 1e-12) << "the same side";
  move_to(3);
  EXPECT_NEAR(extra(), -0.2, 1e-12);
  EXPECT_EQ(rig.controller->joint(1).backlash.position(), 0) << "that joint did not move";
  EXPECT_EQ(rig.faults.size(), 0U);
  rig.config.joint[0].backlash = 0.1;
  rig.controller->adopt(rig.config);
  for (int i = 0; i < 200; ++i) {
    rig.cycle();
    goes_within_limits();
  }
  EXPECT_NEAR(extra(), -0.05, 1e-12) << "a new value takes the same side";
}

/// [JOINT_n]COMP_FILE: by place and direction, within its share of the limits, once homed.
TEST(Controller, AScrewTableIsFollowedByPlaceAndDirection) {
  for (const double jerk : {0.0, 40000.0}) {
    Rig rig;
    std::vector<ScrewTable> tables(kMaxJoints);
    tables[0].count = 3;
    tables[0].point[0] = {0, 0.1, -0.3};
    tables[0].point[1] = {10, 0.4, -0.2};
    tables[0].point[2] = {20, 0, 0};
    rig.controller->use_screws(tables.data());
    rig.config.joint[0].backlash = 5;  // does not count
    rig.config.joint[0].max_jerk = jerk;
    rig.apply_config();
    rig.enable();
    rig.intent.joint_jog[0] = {1, JogIntent::Kind::incremental, 50, 3};
    rig.run(500);
    const auto extra = [&] { return rig.controller->joint(0).backlash.position(); };
    EXPECT_EQ(extra(), 0) << "not homed";
    rig.ready();
    rig.run(500);
    EXPECT_NE(extra(), 0) << "homed";
    double last = extra(), last_vel = 0;
    struct Stop {
      double x, extra;
    };
    // As LinuxCNC has them.
    for (const Stop stop :
         {Stop{5, 0.25}, Stop{10, 0.4}, Stop{12, 0.32}, Stop{30, 0}, Stop{12, -0.16},
          Stop{5, -0.25}, Stop{0, -0.3}, Stop{-5, -0.3}, Stop{0, 0.1}}) {
      rig.line({.x = stop.x}, 100);
      for (int i = 0; i < 1500; ++i) {
        rig.cycle();
        const double vel = (extra() - last) / Rig::kPeriod;
        EXPECT_LE(std::abs(vel), 50.001);
        EXPECT_LE(std::abs(vel - last_vel) / Rig::kPeriod, 500.5);
        last_vel = vel;
        last = extra();
      }
      EXPECT_NEAR(extra(), stop.extra, 1e-6) << stop.x;
      EXPECT_NEAR(rig.status().joint[0].pos_fb, stop.x, 1e-6) << "feedback is without it";
    }
    EXPECT_TRUE(rig.faults.empty());
  }
}

TEST(Controller, ALostHeartbeatStopsOnThePathThenSwitchesOff) {
  Rig rig;
  rig.ready();
  rig.line({.x = 500, .y = 250}, 100);
  rig.run(300);
  rig.heart = false;
  rig.run(105);
  EXPECT_TRUE(rig.saw(Fault::heartbeat_lost));
  EXPECT_TRUE(rig.status().enabled) << "it brakes first";
  rig.run_until([&] { return !rig.status().enabled; }, 200);
  EXPECT_NEAR(rig.status().pos_cmd.y, rig.status().pos_cmd.x / 2, 1e-9);
  EXPECT_FALSE(rig.saw(Fault::limit_acceleration));
  EXPECT_EQ(rig.faults.size(), 1U);
}

TEST(Controller, ALostHeartbeatSwitchesOffAtOnceIfTheMachineSaysSo) {
  Rig rig;
  rig.config.lost_heartbeat_is_off = true;
  rig.ready();
  rig.line({.x = 500, .y = 250}, 100);
  rig.run(300);
  rig.heart = false;
  rig.run(99);
  EXPECT_TRUE(rig.status().enabled);
  rig.run(3);
  EXPECT_TRUE(rig.saw(Fault::heartbeat_lost));
  EXPECT_FALSE(rig.status().enabled);
}

TEST(Controller, ALateCycleIsAFaultAndSwitchesOffIfTheMachineSaysSo) {
  for (const OverrunPolicy policy :
       {OverrunPolicy::warn, OverrunPolicy::hold, OverrunPolicy::estop}) {
    Rig rig;
    rig.config.overrun = policy;
    rig.ready();
    rig.line({.x = 500, .y = 250}, 100);
    rig.run(300);
    rig.in.since_last_s = 2.9e-3;
    rig.run(1);
    EXPECT_EQ(rig.faults.size(), 0U) << "below OVERRUN_PERIODS";
    rig.in.since_last_s = 3.1e-3;
    rig.run(1);
    rig.in.since_last_s = 1e-3;
    rig.run(3);
    EXPECT_EQ(rig.saw(Fault::overrun), policy != OverrunPolicy::warn);
    EXPECT_EQ(rig.status().enabled, policy != OverrunPolicy::estop);
  }
}

/// A link that loses packets: within the budget nothing is felt of it, beyond it the machine stops on its path; then on again.
TEST(StaleFeedback, IsBridgedWithinItsBudgetThenStopsAndIsArmedAgain) {
  int bridged = 0, stopped = 0;
  for (const int budget : {0, 1, 3, 5}) {
    for (int lost = 1; lost <= 8; ++lost) {
      for (const int gap : {1, 7, 60}) {
        Rig rig;
        rig.config.stale_cycles = budget;
        rig.config.stale_window = 50;
        for (auto& j : rig.config.joint) j.ferror = j.min_ferror = 0.3;
        rig.apply_config();
        rig.ready();
        rig.run(60);
        rig.follow = false;
        rig.line({.x = 40, .y = 20}, 60);
        double seen[3]{};
        int left = lost, wait = 0;
        double worst = 0;
        bool flagged = true;
        for (int i = 0; i < 1200; ++i) {
          const bool stale = i > 150 && left > 0 && wait == 0 && rig.status().enabled;
          if (i > 150) wait = wait > 0 ? wait - 1 : gap - 1;
          for (std::size_t j = 0; j < 3; ++j) {
            JointInputs& in = rig.in.joint[j];
            const double now = rig.status().joint[j].pos_cmd + rig.status().joint[j].motor_offset;
            in.fb_stale = stale;
            // A motor that is a cycle behind; what was not read stays as it was.
            if (!stale) in.motor_pos_fb = seen[j];
            seen[j] = now;
          }
          if (stale) --left;
          const double before = rig.status().joint[0].pos_cmd;
          rig.cycle();
          const JointStatus& s = rig.status().joint[0];
          if (stale) flagged = flagged && s.fb_extrapolated;
          if (rig.status().enabled && !stale) flagged = flagged && !s.fb_extrapolated;
          if (rig.status().enabled && i > 2) worst = std::max(worst, std::abs(before - s.pos_fb));
        }
        const std::string where = std::to_string(budget) + " of 50, lost " + std::to_string(lost) +
                                  " each " + std::to_string(gap);
        EXPECT_TRUE(flagged) << where;
        EXPECT_LT(worst, 0.15) << where << ": no jump of the position";
        const int at_a_time = std::min(lost, (50 + gap - 1) / gap);
        const bool over = at_a_time > budget;
        EXPECT_EQ(rig.saw(Fault::stale_feedback), over) << where;
        EXPECT_EQ(rig.status().enabled, !over) << where;
        EXPECT_FALSE(rig.saw(Fault::following_error) || rig.saw(Fault::limit_acceleration))
            << where;
        if (!over) {
          ++bridged;
          EXPECT_EQ(rig.status().pos_cmd.x, 40) << where;
          EXPECT_EQ(rig.status().joint[0].fb_lost, static_cast<unsigned>(lost)) << where;
          continue;
        }
        ++stopped;
        const FaultRecord& f = rig.faults.front();
        EXPECT_EQ(f.fault, Fault::stale_feedback) << where;
        EXPECT_EQ(f.value, budget + 1) << where;
        EXPECT_EQ(f.limit, budget) << where;
        // On the path: X and Y stopped together.
        EXPECT_NEAR(rig.status().pos_cmd.y, rig.status().pos_cmd.x / 2, 1e-4) << where;
        EXPECT_TRUE(rig.status().all_homed) << where;
        rig.follow = true;
        rig.orders.enable = false;
        rig.abort();
        rig.run(20);
        rig.enable();
        ASSERT_TRUE(rig.status().enabled) << where;
        rig.intent.mode = MotionMode::coordinated;
        rig.run(3);
        rig.line({.x = 40, .y = 20}, 60);
        EXPECT_GT(rig.finish(3000), 0) << where << ": armed again";
      }
    }
  }
  EXPECT_GT(bridged, 20);
  EXPECT_GT(stopped, 20);
  std::printf(
      "result: feedback lost at 60 mm/s in 1 to 8 cycles, budgets 0, 1, 3 and 5 of 50: %d bridged, "
      "%d "
      "controlled stops on the path, each armed again\n",
      bridged, stopped);
}

TEST(StaleFeedback, KeepsTheMachineOffWhileItLasts) {
  Rig rig;
  rig.run(3);
  rig.in.joint[1].fb_stale = true;
  rig.orders.enable = true;
  rig.run(3);
  EXPECT_FALSE(rig.status().enabled);
  EXPECT_TRUE(rig.saw(Fault::stale_feedback));
  EXPECT_EQ(rig.faults.front().index, 1);
  rig.orders.enable = false;
  rig.in.joint[1].fb_stale = false;
  rig.run(2);
  rig.enable();
  EXPECT_TRUE(rig.status().enabled);
}

TEST(StaleFeedback, AProbeContactInSuchACycleIsRefused) {
  for (const int stale_before : {0, 1, 3}) {
    Rig rig;
    rig.ready();
    ProbeMove p;
    p.end.x = 4;
    p.vel_mm_s = 20;
    rig.push(p);
    rig.run(60 - stale_before);
    rig.in.joint[0].fb_stale = stale_before > 0;
    rig.run(1);
    rig.in.joint[0].fb_stale = false;
    rig.run(std::max(stale_before - 1, 0));
    rig.in.probe = true;
    rig.run(200);
    const bool unseen = stale_before == 1;
    EXPECT_EQ(rig.saw(Fault::stale_feedback), unseen) << stale_before;
    EXPECT_EQ(rig.status().probe_tripped, !unseen) << stale_before;
    EXPECT_TRUE(rig.status().enabled);
    EXPECT_TRUE(rig.status().in_position);
  }
}

TEST(Controller, CoordinatedModeNeedsHomedJoints) {
  Rig rig;
  rig.enable();
  rig.intent.mode = MotionMode::coordinated;
  rig.run(50);
  EXPECT_EQ(rig.status().mode, MotionMode::free);
  EXPECT_EQ(rig.faults.size(), 1U) << "said once";
  EXPECT_TRUE(rig.saw(Fault::not_homed));
  rig.config.no_force_homing = true;
  rig.apply_config();
  rig.run(2);
  EXPECT_EQ(rig.status().mode, MotionMode::coordinated);
}

TEST(Controller, ModeChangesWaitForRest) {
  Rig rig;
  rig.ready();
  rig.line({.x = 20}, 50);
  rig.run(50);
  rig.intent.mode = MotionMode::teleop;
  rig.run(50);
  EXPECT_EQ(rig.status().mode, MotionMode::coordinated);
  rig.finish();
  rig.run(2);
  EXPECT_EQ(rig.status().mode, MotionMode::teleop);
  EXPECT_EQ(rig.status().pos_cmd.x, 20);
}

TEST(Controller, UnhomingLeavesTheModesThatNeedIt) {
  Rig rig;
  rig.ready();
  ++rig.intent.unhome_seq;
  rig.intent.unhome_joint = 1;
  rig.run(3);
  EXPECT_EQ(rig.status().mode, MotionMode::free);
  EXPECT_FALSE(rig.status().joint[1].homed);
  EXPECT_TRUE(rig.status().joint[0].homed);
}

TEST(Jog, ContinuousRunsUntilToldToStop) {
  Rig rig;
  rig.enable();
  jog(rig, 1, JogIntent::Kind::continuous, -30);
  rig.run(200);
  EXPECT_TRUE(rig.status().jogging);
  EXPECT_NEAR(rig.status().joint[1].vel_cmd, -30, 1e-6);
  jog(rig, 1, JogIntent::Kind::none, 0);
  rig.run(100);
  EXPECT_FALSE(rig.status().jogging);
  EXPECT_EQ(rig.status().joint[1].vel_cmd, 0);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Jog, IncrementsAddUpAndTargetsAreExact) {
  Rig rig;
  rig.enable();
  jog(rig, 0, JogIntent::Kind::incremental, 20, 0.1);
  rig.run(1);
  jog(rig, 0, JogIntent::Kind::incremental, 20, 0.1);
  rig.run(200);
  EXPECT_NEAR(rig.status().joint[0].pos_cmd, 0.2, 1e-12);
  jog(rig, 0, JogIntent::Kind::absolute, 20, -3.25);
  rig.run(1000);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, -3.25);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Jog, SoftLimitsOfHomedJointsAreNeverCrossed) {
  Rig rig;
  rig.config.joint[0].min_limit = -2;
  rig.config.joint[0].max_limit = 12;
  rig.ready();
  rig.intent.mode = MotionMode::free;
  rig.run(2);
  jog(rig, 0, JogIntent::Kind::continuous, 100);
  double most = 0;
  rig.run_until(
      [&] { return most = std::max(most, rig.status().joint[0].pos_cmd), !rig.status().jogging; },
      2000);
  EXPECT_EQ(most, 12);
  EXPECT_TRUE(rig.status().joint[0].max_soft_limit);
  jog(rig, 0, JogIntent::Kind::continuous, 5);
  rig.run(2);
  EXPECT_TRUE(rig.saw(Fault::jog_beyond_limit));
  jog(rig, 0, JogIntent::Kind::incremental, 100, -100);
  rig.run(1000);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, -2);
}

TEST(Jog, UnhomedJointsMayGoOneTravelEitherWay) {
  Rig rig;
  rig.config.joint[0].min_limit = -2;
  rig.config.joint[0].max_limit = 3;
  rig.apply_config();
  rig.enable();
  jog(rig, 0, JogIntent::Kind::continuous, 50);
  rig.run(1000);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, 5);
}

TEST(Jog, TeleopMovesAxesWithinTheTighterLimits) {
  Rig rig({0, 1, 2, 1});  // two joints on Y
  rig.config.axis[1].max_vel = 40;
  rig.config.joint[3].max_vel = 25;
  rig.config.axis[1].max_limit = 6;
  rig.ready();
  rig.intent.mode = MotionMode::teleop;
  rig.run(2);
  jog(rig, 1, JogIntent::Kind::continuous, 99);
  rig.run(100);
  EXPECT_NEAR(rig.status().joint[3].vel_cmd, 25, 1e-6);
  rig.run(1000);
  EXPECT_EQ(rig.status().pos_cmd.y, 6);
  EXPECT_EQ(rig.status().joint[1].pos_cmd, 6);
  EXPECT_EQ(rig.status().joint[3].pos_cmd, 6);
  EXPECT_TRUE(rig.faults.empty());
  rig.intent.mode = MotionMode::coordinated;
  rig.run(3);
  rig.line({.x = 1, .y = 6}, 10);
  EXPECT_GT(rig.finish(1000), 0) << "the path begins where the jog ended";
}

TEST(Jog, WrongModeInhibitAndOffAreRefused) {
  Rig rig;
  jog(rig, 0, JogIntent::Kind::continuous, 10);
  rig.run(5);
  EXPECT_EQ(rig.faults.size(), 1U);
  rig.enable();
  rig.in.jog_inhibit = true;
  jog(rig, 0, JogIntent::Kind::continuous, 10);
  rig.run(5);
  EXPECT_EQ(rig.faults.size(), 2U);
  rig.in.jog_inhibit = false;
  ++rig.intent.axis_jog[0].seq;
  rig.intent.axis_jog[0].kind = JogIntent::Kind::continuous;
  rig.intent.axis_jog[0].vel = 1;
  rig.run(5);
  EXPECT_EQ(rig.faults.size(), 3U);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, 0);
  EXPECT_TRUE(rig.saw(Fault::jog_while_not_ready));
}

TEST(Jog, AbortAndJogStopPinEndJogs) {
  Rig rig;
  rig.enable();
  jog(rig, 0, JogIntent::Kind::continuous, 50);
  rig.run(100);
  rig.abort();
  rig.run(60);
  EXPECT_FALSE(rig.status().jogging);
  EXPECT_EQ(rig.status().acked_epoch, 2U);
  jog(rig, 0, JogIntent::Kind::continuous, 50);
  rig.run(100);
  rig.in.jog_stop = true;
  rig.run(60);
  EXPECT_FALSE(rig.status().jogging);
  jog(rig, 0, JogIntent::Kind::continuous, 50);
  rig.run(100);
  rig.in.jog_stop_immediate = true;
  rig.run(1);
  EXPECT_FALSE(rig.status().jogging);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Jog, AProbeContactEndsItUnlessAllowed) {
  for (const bool allowed : {false, true}) {
    Rig rig;
    rig.config.probe_error_inhibit_jog = allowed;
    rig.apply_config();
    rig.enable();
    jog(rig, 0, JogIntent::Kind::continuous, 50);
    rig.run(100);
    rig.in.probe = true;
    rig.run(60);
    EXPECT_EQ(rig.status().jogging, allowed);
    EXPECT_EQ(rig.saw(Fault::probe_unexpected), !allowed);
    EXPECT_FALSE(rig.saw(Fault::limit_acceleration));
  }
}

TEST(Jog, AJointOfAGantryIsNotJoggedAloneBeforeItIsHomed) {
  Rig rig;
  rig.config.joint[1].home_sequence = -1;
  rig.apply_config();
  rig.enable();
  jog(rig, 1, JogIntent::Kind::continuous, 50);
  rig.run(60);
  EXPECT_TRUE(rig.saw(Fault::jog_while_not_ready));
  EXPECT_EQ(rig.status().joint[1].pos_cmd, 0);
}

TEST(Jog, OffAHardLimitOnlyTheWayBackIsOpen) {
  Rig rig;
  rig.in.joint[0].pos_limit = true;
  rig.orders.enable = true;
  rig.run(3);
  EXPECT_FALSE(rig.status().enabled);
  EXPECT_TRUE(rig.saw(Fault::joint_hard_limit_max));
  rig.intent.override_limits = true;
  rig.orders.enable = false;
  rig.run(2);
  rig.enable();
  ASSERT_TRUE(rig.status().enabled);
  jog(rig, 0, JogIntent::Kind::continuous, 10);
  rig.run(50);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, 0);
  EXPECT_TRUE(rig.saw(Fault::jog_beyond_limit));
  jog(rig, 0, JogIntent::Kind::continuous, -10);
  rig.run(50);
  EXPECT_LT(rig.status().joint[0].pos_cmd, -0.1);
}

TEST(Jog, AnAxisOnAnOverriddenHardLimitGoesTheWayBackOnly) {
  Rig rig({0, 1, 1});
  rig.ready();
  rig.intent.mode = MotionMode::teleop;
  rig.intent.override_limits = true;
  rig.run(3);
  rig.in.joint[2].neg_limit = true;
  rig.run(3);
  ASSERT_TRUE(rig.status().enabled);
  jog(rig, 1, JogIntent::Kind::continuous, -10);
  rig.run(50);
  EXPECT_EQ(rig.status().pos_cmd.y, 0);
  EXPECT_TRUE(rig.saw(Fault::jog_beyond_limit));
  jog(rig, 1, JogIntent::Kind::continuous, 10);
  rig.run(50);
  EXPECT_GT(rig.status().pos_cmd.y, 0.1);
}

TEST(Controller, OverridingLimitsIsForJoggingOnly) {
  Rig path;
  path.ready();
  path.intent.override_limits = true;
  path.line({.x = 100}, 50);
  path.run(100);
  path.in.joint[0].pos_limit = true;
  path.run(2);
  EXPECT_TRUE(path.saw(Fault::joint_hard_limit_max));
  EXPECT_FALSE(path.status().enabled);

  Rig home;
  home.config.joint[0].home_search_vel = 20;
  home.config.joint[0].home_latch_vel = -5;
  home.apply_config();
  home.enable();
  home.intent.override_limits = true;
  ++home.intent.home_seq;
  home.intent.home_joint = 0;
  home.run(50);
  ASSERT_TRUE(home.status().homing_active);
  home.in.joint[0].pos_limit = true;
  home.run(2);
  EXPECT_TRUE(home.saw(Fault::joint_hard_limit_max));
  EXPECT_FALSE(home.status().enabled);
}

TEST(Controller, FeedbackThatIsNoNumberKeepsTheMachineOff) {
  for (const double bad : {std::nan(""), static_cast<double>(INFINITY)}) {
    Rig rig;
    rig.follow = false;
    rig.in.joint[1].motor_pos_fb = 3;
    rig.run(2);
    rig.in.joint[1].motor_pos_fb = bad;
    rig.enable();
    EXPECT_FALSE(rig.status().enabled);
    EXPECT_TRUE(rig.saw(Fault::following_error));
    EXPECT_EQ(rig.status().joint[1].pos_cmd, 3) << "the last place that was known";
    EXPECT_EQ(rig.status().pos_cmd.y, 3);
    EXPECT_EQ(rig.status().pos_fb.y, 3);
    rig.in.joint[1].motor_pos_fb = 4;
    rig.orders.enable = false;
    rig.run(2);
    rig.enable();
    EXPECT_TRUE(rig.status().enabled);
    rig.in.joint[1].motor_pos_fb = bad;
    rig.run(2);
    EXPECT_FALSE(rig.status().enabled);
    EXPECT_EQ(rig.status().joint[1].pos_cmd, 4);
  }
}

TEST(Jog, OfNoSpeedIsNoJog) {
  for (const auto kind : {JogIntent::Kind::incremental, JogIntent::Kind::absolute}) {
    Rig rig;
    rig.enable();
    jog(rig, 0, kind, 0, 5);
    rig.run(5);
    EXPECT_FALSE(rig.status().jogging);
    EXPECT_TRUE(rig.status().in_position);
    jog(rig, 0, JogIntent::Kind::continuous, 50);
    rig.run(50);
    jog(rig, 0, kind, 0, 5);
    rig.run(100);
    EXPECT_FALSE(rig.status().jogging) << "ends the jog under way";
  }
}

TEST(Controller, AJointOfAGantryThatWasMovedAloneNeverSteps) {
  for (const MotionMode mode : {MotionMode::teleop, MotionMode::coordinated}) {
    Rig rig({0, 1, 1, 2});
    rig.ready();
    rig.intent.mode = MotionMode::free;
    rig.run(2);
    jog(rig, 2, JogIntent::Kind::incremental, 50, 10);
    rig.run(500);
    ASSERT_EQ(rig.status().joint[2].pos_cmd, 10);
    rig.intent.mode = mode;
    rig.run(5);
    ASSERT_EQ(rig.status().mode, mode);
    EXPECT_EQ(rig.status().joint[1].pos_cmd, 0);
    EXPECT_EQ(rig.status().joint[2].pos_cmd, 10);
    if (mode == MotionMode::teleop) {
      jog(rig, 1, JogIntent::Kind::incremental, 50, 3);
      rig.run(500);
    } else {
      rig.line({.x = 1, .y = 3}, 50);
      rig.finish();
    }
    EXPECT_NEAR(rig.status().joint[1].pos_cmd, 3, 1e-12);
    EXPECT_NEAR(rig.status().joint[2].pos_cmd, 13, 1e-12);
    rig.orders.enable = false;
    rig.run(3);
    rig.enable();
    rig.run(3);
    EXPECT_TRUE(rig.status().enabled);
    EXPECT_NEAR(rig.status().joint[2].pos_cmd, 13, 1e-12) << "nor at switching on";
    EXPECT_TRUE(rig.faults.empty());
  }
}

TEST(Guard, ReportsTheFirstBreakOnce) {
  // Limits lowered behind the planner's back, so that the oracle has something to find.
  Rig rig;
  rig.ready();
  rig.line({.x = 500}, 90);
  rig.run(1);
  rig.config.joint[0].max_vel = 40;
  rig.controller->configure(rig.config);
  rig.run(500);
  ASSERT_EQ(rig.faults.size(), 1U);
  EXPECT_EQ(rig.faults[0].fault, Fault::limit_velocity);
  EXPECT_EQ(rig.faults[0].index, 0);
  EXPECT_EQ(rig.faults[0].limit, 40);
  EXPECT_TRUE(rig.status().enabled);
}

/// Its joint is `slip` beside its axis.
class Slipping final : public Kinematics {
 public:
  [[nodiscard]] KinematicsType type() const noexcept override { return KinematicsType::identity; }
  [[nodiscard]] std::int32_t joints() const noexcept override { return 1; }
  [[nodiscard]] bool forward(const JointVector& q, Pose& p) const noexcept override {
    p.x = q[0] - slip;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& p, JointVector& q) const noexcept override {
    q[0] = p.x + slip;
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t) const noexcept override { return 0; }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return 1; }
  double slip{0};
};

TEST(Guard, AJumpIsNotCommandedAndTheDrivesGoOff) {
  Slipping slipping;
  Rig rig(test::RigKinematics{slipping});
  rig.ready();
  rig.line({.x = 100}, 50);
  rig.run(500);
  ASSERT_GT(rig.status().vel_mm_s, 40);
  const double before = rig.status().joint[0].pos_cmd;
  slipping.slip = 3;
  rig.run(1);
  EXPECT_TRUE(rig.saw(Fault::limit_continuity));
  EXPECT_FALSE(rig.status().enabled);
  EXPECT_EQ(rig.status().joint[0].pos_cmd, before);
  rig.run(300);
  EXPECT_NEAR(rig.status().joint[0].pos_cmd, before, 1);
  EXPECT_EQ(rig.faults.size(), 1U);
}

TEST(Controller, TellsTaskOnlyWhatIsNew) {
  Rig rig;
  rig.ready();
  rig.line({.x = 50}, 50);
  rig.run(50);
  int changes = 0;
  for (int i = 0; i < 500; ++i) {
    rig.cycle();
    changes += rig.controller->changed() ? 1 : 0;
  }
  EXPECT_EQ(changes, 0) << "nothing happens in the middle of a move";
  rig.finish();
  EXPECT_TRUE(rig.controller->changed());
}

}  // namespace
}  // namespace kerf::motion
