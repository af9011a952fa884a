// Moves that follow a spindle: threads and taps through planner and controller. Their arithmetic: synchronised_arithmetic_test.cpp.
#include "motion/core/synchronised.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "motion/api/faults.hpp"
#include "property/motion/random_program.hpp"
#include "spindle_rig.hpp"

namespace kerf::motion {
namespace {

using test::SpindleRig;

/// Z against the spindle in a thread to Z-20, from where the machine says that it is in step.
struct Trace {
  double phase{
      0};  ///< Z where the index was, extrapolated along the pitch: of the first place in step
  double spread{0}, run_in{0};
  bool joined{false};
};
Trace cut(SpindleRig& rig, const Pose& end, double pitch) {
  Trace out;
  rig.thread(end, pitch);
  double low = 1e9, high = -1e9;
  const double jerk = rig.config.joint[2].max_jerk;
  const RampLimits limits{1000, jerk > 0 ? jerk : 1e12};
  rig.run_until(
      [&] {
        const MotionStatus& s = rig.status();
        const double from_end = s.pos_cmd.z - end.z;
        const double v = rig.rps * pitch;
        out.joined = out.joined || s.sync_in_step;
        if (s.sync_in_step && s.vel_mm_s > 0 &&
            from_end > 1.2 * stopping_distance(v, limits) + 0.05) {
          const double turns = rig.angle - rig.index_at;
          const double at = s.pos_cmd.z + turns * pitch;
          const double phase = at - std::floor(at / pitch + 0.5) * pitch;
          low = std::min(low, phase);
          high = std::max(high, phase);
        }
        return s.executed_seq >= rig.seq && s.path_empty;
      },
      60000);
  out.phase = (low + high) / 2;
  out.spread = high - low;
  out.run_in = rig.status().sync_run_in_mm;
  return out;
}

std::string two_places(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

TEST(Thread, StartsAtTheSameAngleAtEachSpeedToHalfACount) {
  constexpr double kPitch = 1.5, kCount = kPitch / 1024;
  double worst = 0;
  std::string run_ins;
  for (const double rpm : {60.0, 200.0, 500.0, 1000.0, 1500.0, 2000.0}) {
    SpindleRig rig;
    rig.counts = 1024;
    rig.ready();
    rig.turn(rpm);
    for (int pass = 0; pass < 3; ++pass) {
      const Trace t = cut(rig, {.z = -20}, kPitch);
      ASSERT_TRUE(t.joined) << rpm << " pass " << pass
                            << (rig.faults.empty() ? "" : fault_name(rig.faults[0].fault));
      // The counter shows the count below: half a count on average.
      EXPECT_NEAR(t.phase, 0.5 * kCount, 0.5 * kCount) << rpm;
      worst = std::max(worst, std::abs(t.phase - 0.5 * kCount) / kCount);
      if (pass == 0) run_ins += (run_ins.empty() ? "" : ", ") + two_places(t.run_in);
      EXPECT_LT(t.spread, 1.0 * kCount) << rpm;
      const double v = kPitch * rpm / 60;
      EXPECT_LT(t.run_in, v * v / 1600 + 0.02 * v + 0.01) << rpm;
      EXPECT_EQ(rig.passed, pass + 1) << "the index is armed anew for each pass";
      EXPECT_EQ(rig.status().pos_cmd.z, -20);
      rig.line({}, 50, MotionKind::traverse);
      ASSERT_GT(rig.finish(), 0);
    }
    EXPECT_TRUE(rig.faults.empty()) << rpm << " " << fault_name(rig.faults.at(0).fault);
  }
  std::printf(
      "result: thread of pitch 1.5 at 60, 200, 500, 1000, 1500, 2000 rpm, 3 passes each: phase "
      "error after "
      "the run-in at most %.2f counts of 1024 (allowed 0.5); run-in %s mm\n",
      worst, run_ins.c_str());
}

TEST(Thread, TheIndexOfThePassBehindARapidMoveComesMeanwhile) {
  constexpr double kPitch = 1.5, kCount = kPitch / 1024;
  double longest = 0;
  for (const double rpm : {100.0, 333.0, 600.0, 1000.0, 2000.0}) {
    SpindleRig rig;
    rig.counts = 1024;
    rig.ready();
    rig.turn(rpm);
    rig.thread({.z = -20}, kPitch);
    for (int pass = 0; pass < 4; ++pass) {
      rig.line({.x = 2, .z = -20}, 0, MotionKind::traverse);
      rig.line({.x = 2 + 0.1 * pass}, 0, MotionKind::traverse);
      rig.line({}, 0, MotionKind::traverse);
      rig.thread({.z = -20}, kPitch);
    }
    rig.line({}, 0, MotionKind::traverse);
    int stood = 0, most = 0;
    bool was_in_step = false;
    rig.run_until(
        [&] {
          const MotionStatus& s = rig.status();
          const bool waits = s.waiting_for == PathWait::spindle_index;
          stood = waits && rig.passed > 0 && was_in_step ? stood + 1 : 0;
          most = std::max(most, stood);
          was_in_step = was_in_step || s.sync_in_step;
          if (s.sync_in_step && s.vel_mm_s > 0 && s.pos_cmd.z > -18) {
            const double at = s.pos_cmd.z + (rig.angle - rig.index_at) * kPitch;
            EXPECT_NEAR(at - std::floor(at / kPitch + 0.5) * kPitch, 0.5 * kCount, 1.5 * kCount)
                << rpm;
          }
          return s.executed_seq >= rig.seq && s.path_empty;
        },
        100000);
    EXPECT_EQ(rig.passed, 5) << "each pass has an index of its own";
    EXPECT_TRUE(rig.faults.empty()) << rpm << " " << fault_name(rig.faults.at(0).fault);
    EXPECT_FALSE(rig.in.spindle[0].index_enable);
    longest = std::max(longest, most * SpindleRig::kPeriod * rpm / 60);
    // A whole turn at most, or what is left of the time that the observer needs.
    EXPECT_LE(most * SpindleRig::kPeriod,
              std::max(1.0, std::ceil(0.07 * rpm / 60)) * 60 / rpm + 0.003)
        << rpm;
  }
  std::printf("result: threads behind rapid moves stood at most %.2f turns\n", longest);
}

void thread_behind_a_rapid_move(SpindleRig& rig, double rpm) {
  rig.ready();
  rig.turn(rpm);
  rig.line({.x = 50}, 0, MotionKind::traverse);
  rig.thread({.x = 50, .z = -20}, 1.5);
  rig.line({}, 0, MotionKind::traverse);
}

TEST(Thread, AnIndexThatWasForeseenIsForgottenWhenItCountsNoMore) {
  SpindleRig rig;
  thread_behind_a_rapid_move(rig, 60);
  ASSERT_GT(rig.run_until([&] { return rig.in.spindle[0].index_enable; }, 1000), 0);
  rig.run(5);
  EXPECT_GT(rig.status().vel_mm_s, 0) << "during the rapid move";
  rig.abort();
  rig.run(300);
  EXPECT_FALSE(rig.in.spindle[0].index_enable) << "aborted";

  // Feed moves and orders to the spindle in between: the thread asks for its index itself.
  for (const bool turns : {false, true}) {
    SpindleRig other;
    other.ready();
    other.turn(600);
    other.line({.x = 10}, 0, MotionKind::traverse);
    if (turns)
      other.turn(300);
    else
      other.line({.x = 11}, 5);
    other.thread({.x = 11, .z = -20}, 1.5);
    other.line({}, 0, MotionKind::traverse);
    bool early = false;
    other.run_until(
        [&] {
          early = early || (other.in.spindle[0].index_enable && other.status().vel_mm_s > 0 &&
                            other.status().pos_cmd.z == 0);
          return other.status().executed_seq >= other.seq && other.status().path_empty;
        },
        20000);
    EXPECT_FALSE(early) << turns;
    EXPECT_TRUE(other.faults.empty());
    EXPECT_EQ(other.passed, 1);
  }

  // Somebody sets the counter after the index: it is asked for again.
  SpindleRig set;
  thread_behind_a_rapid_move(set, 600);
  ASSERT_GT(set.run_until([&] { return set.passed == 1; }, 2000), 0);
  EXPECT_GT(set.status().vel_mm_s, 0);
  set.run(20);
  set.zero -= 7.3;
  EXPECT_GT(set.finish(), 0);
  EXPECT_EQ(set.passed, 2);
  EXPECT_TRUE(set.faults.empty()) << fault_name(set.faults.at(0).fault);
}

/// Z along a tap and what its spindle was told.
struct TapTrace {
  double deepest{0}, highest{-1e9}, worst{0}, worst_acc{0};
  bool reversed{false}, forward_again{false};
};
TapTrace run_tap(SpindleRig& rig, double pitch, int limit = 60000) {
  TapTrace out;
  double before = rig.status().pos_cmd.z, v = 0;
  rig.run_until(
      [&] {
        const MotionStatus& s = rig.status();
        const double now = (s.pos_cmd.z - before) / SpindleRig::kPeriod;
        out.worst_acc = std::max(out.worst_acc, std::abs(now - v) / SpindleRig::kPeriod);
        v = now;
        before = s.pos_cmd.z;
        out.deepest = std::min(out.deepest, s.pos_cmd.z);
        out.highest = std::max(out.highest, s.pos_cmd.z);
        out.reversed = out.reversed || rig.controller->spindles().outputs(0).reverse;
        out.forward_again = out.reversed && rig.controller->spindles().outputs(0).forward;
        if (s.sync_in_step) out.worst = std::max(out.worst, std::abs(s.sync_lag_mm));
        (void)pitch;
        return s.executed_seq >= rig.seq && s.path_empty;
      },
      limit);
  return out;
}

TEST(Tap, FollowsTheSpindleBeyondBothEndsAndComesToRestWhereItBegan) {
  for (const double factor : {1.0, 2.0}) {
    SpindleRig rig;
    rig.counts = 1000;
    rig.acceleration = 50;
    rig.ready();
    rig.line({.x = 5, .z = 2}, 50, MotionKind::traverse);
    rig.turn(600);
    rig.tap({.x = 5, .z = -10}, 1.25, factor);
    const TapTrace t = run_tap(rig, 1.25);
    ASSERT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
    // 10 rev/s stopped with 50 rev/s2 is one turn.
    EXPECT_NEAR(t.deepest, -11.25, 0.1) << "the spindle is reversed at the end, not before";
    EXPECT_GT(t.highest, 2 + 1.25 * 0.9 * factor * factor);
    EXPECT_LT(t.highest, 2 + 1.25 * 1.1 * factor * factor + 0.1);
    EXPECT_LT(t.worst, 0.05);
    EXPECT_LE(t.worst_acc, 1001);
    EXPECT_TRUE(t.reversed && t.forward_again);
    EXPECT_EQ(rig.status().pos_cmd, (Pose{.x = 5, .z = 2}));
    EXPECT_EQ(rig.status().spindle[0].direction, 1);
    EXPECT_NEAR(rig.controller->spindles().outputs(0).speed_rpm, 600, 1e-9);
    rig.line({.x = 10, .z = 2}, 50);
    EXPECT_GT(rig.finish(), 0);
  }
}

TEST(Tap, LeftHandWithTheSpindleInReverse) {
  SpindleRig rig;
  rig.acceleration = 50;
  rig.ready();
  rig.turn(300, false);
  rig.tap({.z = -8}, 1);
  const TapTrace t = run_tap(rig, 1);
  ASSERT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
  EXPECT_NEAR(t.deepest, -8.25, 0.1);
  EXPECT_LT(t.worst, 0.05);
  EXPECT_EQ(rig.status().pos_cmd.z, 0);
  EXPECT_EQ(rig.status().spindle[0].direction, -1);
}

TEST(Tap, AbortStopsTheSpindleAndTheAxisWithIt) {
  // From before the index to the way home.
  for (int after = 20; after < 6000; after += 137) {
    SpindleRig rig;
    rig.acceleration = 30;
    rig.ready();
    rig.turn(300);
    rig.tap({.z = -8}, 1);
    rig.run(after);
    rig.abort();
    ++rig.intent.spindle_stop_seq[0];  // as task does
    double worst_acc = 0, before = rig.status().pos_cmd.z, v = rig.status().joint[2].vel_cmd;
    // Z and the spindle's angle keep together as long as the tap is in its hole.
    const bool in_step = rig.status().sync_in_step;
    const double step = before + rig.angle;
    double lag = 0;
    const int took = rig.run_until(
        [&] {
          const double now = (rig.status().pos_cmd.z - before) / SpindleRig::kPeriod;
          worst_acc = std::max(worst_acc, std::abs(now - v) / SpindleRig::kPeriod);
          v = now;
          before = rig.status().pos_cmd.z;
          if (in_step && before < -0.2) lag = std::max(lag, std::abs(before + rig.angle - step));
          return rig.status().acked_epoch == 2 && rig.rps == 0;
        },
        5000);
    ASSERT_GT(took, 0) << after;
    EXPECT_LE(took, 500) << after;
    EXPECT_LE(worst_acc, 1001) << after;
    EXPECT_LE(lag, 0.1) << "a tap must not be torn out of its hole, at " << after;
    EXPECT_TRUE(rig.faults.empty());
    rig.run(300);
    EXPECT_FALSE(rig.in.spindle[0].index_enable) << after;
    // The next one begins afresh.
    rig.turn(300);
    rig.thread({.z = -30}, 1);
    EXPECT_GT(rig.finish(), 0) << after;
    EXPECT_EQ(rig.status().pos_cmd.z, -30);
    EXPECT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
  }
}

TEST(Thread, AbortInEachPhaseStopsAtTheLimitsAndTheNextThreadBeginsAfresh) {
  for (int after = 20; after < 3200; after += 97) {
    SpindleRig rig;
    rig.counts = 1024;
    rig.ready();
    rig.intent.feed_override = 0.5;
    rig.turn(600);
    rig.thread({.z = -20}, 1.5);
    rig.run(after);
    const double v = rig.status().vel_mm_s;
    rig.abort();
    const int took = rig.run_until([&] { return rig.status().acked_epoch == 2; }, 5000);
    ASSERT_GT(took, 0) << after;
    EXPECT_LE(took, v / 1000 / SpindleRig::kPeriod + 3) << after;
    EXPECT_LE(rig.status().pos_cmd.z, 0) << after;
    rig.run(2);
    EXPECT_FALSE(rig.in.spindle[0].index_enable) << "nothing waits for the index any more";
    const double at = rig.status().pos_cmd.z;
    const int passed = rig.passed;
    rig.thread({.z = -40}, 1.5);
    double fastest = 0;
    EXPECT_GT(rig.run_until(
                  [&] {
                    fastest = std::max(fastest, rig.status().vel_mm_s);
                    return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
                  },
                  60000),
              0);
    EXPECT_EQ(rig.passed, passed + 1);
    EXPECT_LE(fastest, 15.5) << "no catching up from " << at;
    EXPECT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
  }
}

TEST(Thread, AndTapFollowTheSpindleThatTheyName) {
  SpindleRig rig;
  rig.number = 1;
  rig.counts = 1024;
  rig.acceleration = 40;
  rig.ready();
  rig.turn(400);
  const Trace t = cut(rig, {.z = -20}, 1.5);
  ASSERT_TRUE(t.joined);
  EXPECT_NEAR(t.phase, 0.75 / 1024, 0.75 / 1024);
  rig.tap({.z = -30}, 1.25);
  ASSERT_GT(rig.finish(), 0);
  EXPECT_EQ(rig.status().pos_cmd.z, -20);
  EXPECT_EQ(rig.status().spindle[1].direction, 1);
  EXPECT_EQ(rig.status().spindle[0].direction, 0);
  EXPECT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
}

TEST(Tap, HoldWaitsForItsEndAndALostHeartbeatStopsTheSpindleWithTheAxis) {
  SpindleRig rig;
  rig.acceleration = 50;
  rig.ready();
  rig.turn(300);
  rig.tap({.z = -8}, 1);
  rig.line({.x = 5}, 50);
  ASSERT_GT(rig.run_until([&] { return rig.status().pos_cmd.z < -3; }), 0);
  rig.orders.hold = true;
  ASSERT_GT(rig.run_until([&] { return rig.status().executed_seq >= 2; }, 20000), 0);
  EXPECT_EQ(rig.status().pos_cmd.z, 0);
  rig.run(300);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  rig.orders.hold = false;
  ASSERT_GT(rig.finish(), 0);
  rig.tap({.x = 5, .z = -8}, 1);
  ASSERT_GT(rig.run_until([&] { return rig.status().pos_cmd.z < -3; }), 0);
  const double step = rig.status().pos_cmd.z + rig.angle;
  rig.heart = false;
  double lag = 0;
  ASSERT_GT(rig.run_until(
                [&] {
                  if (rig.status().enabled)
                    lag = std::max(lag, std::abs(rig.status().pos_cmd.z + rig.angle - step));
                  return !rig.status().enabled;
                },
                3000),
            0);
  EXPECT_LT(lag, 0.1);
  EXPECT_LT(std::abs(rig.rps), 0.1) << "the machine goes off when both stand";
  ASSERT_EQ(rig.faults.size(), 1U);
  EXPECT_EQ(rig.faults[0].fault, Fault::heartbeat_lost);
}

TEST(Thread, AndTapOnAMachineWithJerkLimits) {
  SpindleRig rig;
  rig.counts = 1024;
  rig.acceleration = 40;
  for (auto& j : rig.config.joint) j.max_jerk = 20000;
  for (auto& a : rig.config.axis) a.max_jerk = 20000;
  rig.apply_config();
  rig.ready();
  rig.turn(600);
  for (int pass = 0; pass < 2; ++pass) {
    const Trace t = cut(rig, {.z = -20}, 1.5);
    ASSERT_TRUE(t.joined) << (rig.faults.empty() ? "" : fault_text(rig.faults[0], rig.config));
    EXPECT_NEAR(t.phase, 0.75 / 1024, 0.75 / 1024);
    rig.line({}, 50, MotionKind::traverse);
    ASSERT_GT(rig.finish(), 0);
  }
  rig.tap({.z = -10}, 1.25);
  ASSERT_GT(rig.finish(), 0);
  EXPECT_EQ(rig.status().pos_cmd.z, 0);
  rig.line({.x = 30, .y = 10}, 80);
  ASSERT_GT(rig.finish(), 0);
  EXPECT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
}

TEST(Thread, HoldsAndOverridesWaitForItsEnd) {
  SpindleRig rig;
  rig.ready();
  rig.turn(300);
  rig.thread({.z = -10}, 1);
  rig.line({.x = 5, .z = -10}, 50);
  ASSERT_GT(rig.run_until([&] { return rig.status().sync_in_step; }), 0);
  rig.orders.hold = true;
  rig.in.feed_hold = rig.in.feed_inhibit = true;
  rig.intent.feed_override = 0;
  rig.intent.max_vel_mm_s = 0.1;
  ASSERT_GT(rig.run_until([&] { return rig.status().executed_seq >= 2; }, 10000), 0);
  EXPECT_EQ(rig.status().pos_cmd.z, -10);
  rig.run(500);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  rig.orders.hold = rig.in.feed_hold = rig.in.feed_inhibit = false;
  rig.intent.feed_override = 1;
  rig.intent.max_vel_mm_s = 1e9;
  EXPECT_GT(rig.finish(), 0);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Thread, HeldBeforeItBeginsItStandsAndMissesNothing) {
  SpindleRig rig;
  rig.ready();
  rig.turn(300);
  rig.thread({.z = -10}, 1);
  rig.orders.hold = true;
  rig.run(3000);
  EXPECT_EQ(rig.status().pos_cmd.z, 0);
  rig.orders.hold = false;
  EXPECT_GT(rig.run_until([&] { return rig.status().sync_in_step; }, 3000), 0);
  EXPECT_LT(rig.status().sync_run_in_mm, 0.2);
  EXPECT_GT(rig.finish(), 0);
  EXPECT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
}

TEST(Thread, WaitsForTheSpindleToTurnToBeAtSpeedAndToPassItsIndex) {
  SpindleRig rig;
  rig.ready();
  rig.thread({.z = -10}, 1);
  rig.run(200);
  EXPECT_EQ(rig.status().waiting_for, PathWait::spindle_turning);
  rig.abort();
  rig.run(5);
  rig.acceleration = 5;
  rig.turn(300);
  rig.thread({.z = -10}, 1);
  rig.run(300);
  EXPECT_EQ(rig.status().waiting_for, PathWait::spindle_at_speed);
  EXPECT_FALSE(rig.in.spindle[0].index_enable);
  ASSERT_GT(rig.run_until([&] { return rig.status().waiting_for == PathWait::spindle_index; }), 0);
  rig.run(1);
  EXPECT_TRUE(rig.in.spindle[0].index_enable);
  EXPECT_EQ(rig.status().waiting_index, 0);
  EXPECT_GT(rig.finish(), 0);
}

TEST(Thread, WhatCannotBeIsRefusedWithNumbersBeforeAnythingMoves) {
  const auto refused = [](double rpm, double z, double pitch, Fault fault, double value,
                          double limit) {
    SpindleRig rig;
    rig.ready();
    rig.turn(rpm);
    rig.thread({.z = z}, pitch);
    rig.run(3000);
    ASSERT_EQ(rig.faults.size(), 1U);
    EXPECT_EQ(rig.faults[0].fault, fault);
    EXPECT_NEAR(rig.faults[0].value, value, 0.05 * value);
    EXPECT_NEAR(rig.faults[0].limit, limit, 1e-6);
    EXPECT_EQ(rig.status().pos_cmd.z, 0);
    EXPECT_FALSE(rig.in.spindle[0].index_enable);
  };
  refused(3100, -20, 2, Fault::sync_too_fast, 103.3, 100);
  // 50 mm/s: 1.56 mm on 0.8 of 1000 mm/s2, 1 mm of tail, 1.25 mm to stop.
  refused(1500, -3, 2, Fault::sync_too_short, 3.81, 3);
  // The override comes later than the plan: judged again at the start.
  SpindleRig rig;
  rig.ready();
  rig.intent.spindle_override[0] = 1.5;
  rig.turn(2500);
  rig.thread({.z = -20}, 2);
  rig.run(6000);
  ASSERT_EQ(rig.faults.size(), 1U);
  EXPECT_EQ(rig.faults[0].fault, Fault::sync_too_fast);
  EXPECT_NEAR(rig.faults[0].value, 125, 0.5);
}

TEST(Thread, ASpindleThatSlowsDownAtOnceIsNotJudgedByTheSpeedItHad) {
  SpindleRig rig;
  rig.acceleration = 0;
  rig.ready();
  rig.turn(4700);
  rig.run(1000);
  rig.turn(230);
  rig.thread({.z = -10}, 2);
  EXPECT_GT(rig.finish(), 0);
  EXPECT_TRUE(rig.faults.empty());
  EXPECT_NEAR(rig.status().pos_cmd.z, -10, 1e-9);
}

TEST(Thread, ASpindleWithoutIndexIsNoticedAndACounterThatGoesOnIsNot) {
  SpindleRig rig;
  rig.index = false;
  rig.ready();
  rig.turn(300);
  rig.thread({.z = -10}, 1);
  rig.run(3000);
  ASSERT_EQ(rig.faults.size(), 1U);
  EXPECT_EQ(rig.faults[0].fault, Fault::sync_no_index);
  EXPECT_EQ(rig.status().pos_cmd.z, 0);

  SpindleRig counting;
  counting.zero_at_index = false;
  counting.counts = 1024;
  counting.ready();
  counting.turn(300);
  const Trace t = cut(counting, {.z = -10}, 1);
  EXPECT_TRUE(t.joined);
  EXPECT_NEAR(t.phase, 0.5 / 1024, 0.5 / 1024);
}

TEST(Thread, MovesOfOneThreadKeepStepOverPitchAndDirection) {
  SpindleRig rig;
  rig.counts = 1024;
  rig.ready();
  rig.turn(300);
  PathControl mode;
  mode.tolerance_mm = 0.02;
  rig.push(mode);
  rig.thread({.z = -10}, 1);
  rig.thread({.x = 1, .z = -20}, 1);
  rig.thread({.x = 1, .z = -30}, 1.5);
  double worst = 0;
  const double way2 = std::hypot(10, 1);
  EXPECT_GT(
      rig.run_until(
          [&] {
            const MotionStatus& s = rig.status();
            const double z = s.pos_cmd.z;
            if (s.sync_in_step && z > -29.5 && std::abs(z + 10) > 0.2 && std::abs(z + 20) > 0.2) {
              const double turns = rig.angle - rig.index_at;
              const double due = z > -10   ? -z
                                 : z > -20 ? 10 + (-z - 10) * way2 / 10
                                           : 10 + way2 + (-z - 20) / 1.5;
              const double off = turns - due;
              worst = std::max(worst, std::abs(off - std::round(off)));
            }
            return s.executed_seq >= rig.seq && s.path_empty;
          },
          60000),
      0);
  EXPECT_LT(worst, 1.5 / 1024);
  EXPECT_EQ(rig.passed, 1) << "only the first waits for the index";
  EXPECT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
}

TEST(Thread, ASpindleThatChangesSpeedIsFollowedAndOneBeyondTheAxisIsTold) {
  SpindleRig rig;
  rig.counts = 1024;
  rig.ready();
  rig.turn(600);
  rig.thread({.z = -80}, 1.5);
  ASSERT_GT(rig.run_until([&] { return rig.status().sync_in_step; }), 0);
  double worst = 0;
  for (int i = 0; i < 1500; ++i) {
    rig.disturbance = 3 * std::sin(i * 0.004);
    rig.cycle();
    worst = std::max(worst, std::abs(rig.status().sync_lag_mm));
  }
  EXPECT_LT(worst, 0.02);
  EXPECT_TRUE(rig.faults.empty());
  // 1.5 mm at 2000 rev/s2 are 3000 mm/s2.
  rig.acceleration = 2000;
  rig.disturbance = 30;
  EXPECT_GT(rig.finish(), 0);
  ASSERT_EQ(rig.faults.size(), 1U) << "said once, and the guard says nothing";
  EXPECT_EQ(rig.faults[0].fault, Fault::sync_behind);
  EXPECT_EQ(rig.status().pos_cmd.z, -80);
}

TEST(Thread, ASpindleThatIsStoppedTakesTheAxisAlongAndGoesOnWithIt) {
  SpindleRig rig;
  rig.counts = 1024;
  rig.ready();
  rig.turn(600);
  rig.thread({.z = -60}, 1.5);
  ASSERT_GT(rig.run_until([&] { return rig.status().sync_in_step; }), 0);
  rig.run(500);
  rig.disturbance = -10;
  rig.run(1500);
  const double z = rig.status().pos_cmd.z;
  rig.run(500);
  EXPECT_NEAR(rig.status().pos_cmd.z, z, 0.01);
  EXPECT_LT(z, -5);
  EXPECT_GT(z, -60);
  rig.disturbance = 0;
  EXPECT_GT(rig.finish(), 0);
  EXPECT_TRUE(rig.faults.empty()) << fault_text(rig.faults[0], rig.config);
}

TEST(FeedPerRevolution, FollowsTheMeasuredSpeedAndStandsWithTheSpindle) {
  SpindleRig rig;
  rig.acceleration = 100;
  rig.ready();
  rig.turn(600);
  FeedPerRev mode;
  mode.spindle = 0;
  mode.rps = 10;
  rig.push(mode);
  rig.line({.x = 100}, 5);  // 0.5 mm a revolution
  rig.run(1500);
  EXPECT_NEAR(rig.status().vel_mm_s, 5, 0.05);
  rig.disturbance = 10;
  rig.run(1000);
  EXPECT_NEAR(rig.status().vel_mm_s, 10, 0.1);
  rig.intent.feed_override = 0.5;
  rig.run(500);
  EXPECT_NEAR(rig.status().vel_mm_s, 5, 0.05) << "overrides count";
  rig.disturbance = -10;
  rig.run(1500);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  EXPECT_EQ(rig.status().waiting_for, PathWait::spindle_turning);
  rig.disturbance = 0;
  rig.intent.feed_override = 1;
  EXPECT_GT(rig.finish(), 0);
  rig.push(FeedPerRev{});
  rig.line({}, 20);
  rig.run(1000);
  EXPECT_NEAR(rig.status().vel_mm_s, 20, 1e-9) << "in G94 the spindle does not count";
  EXPECT_TRUE(rig.faults.empty());
}

}  // namespace
}  // namespace kerf::motion
