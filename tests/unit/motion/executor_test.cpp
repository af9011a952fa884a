// The path as the servo cycle runs it: events in their places, waits, probing, overrides, hold and abort.
#include <gtest/gtest.h>

#include <cmath>

#include "unit/motion/rig.hpp"

namespace kerf::motion {
namespace {

using test::Rig;

SpindleChange spin(SpindleChange::Action action, double rpm, int spindle = 0) {
  SpindleChange s;
  s.spindle = spindle;
  s.action = action;
  s.speed_rpm = rpm;
  return s;
}

TEST(Executor, LinesTakeTheTimeOfTheTrapezoidAndEndExactly) {
  Rig rig;
  rig.ready();
  rig.line({.x = 10, .y = 1.0 / 3}, 20);
  const double length = std::hypot(10, 1.0 / 3), acc = 1000 / (10 / length);
  const int cycles = rig.finish();
  // Five milliseconds go by before the planner believes that no more moves come.
  EXPECT_NEAR(cycles * Rig::kPeriod, length / 20 + 20 / acc + 0.005, 0.003);
  EXPECT_EQ(rig.status().pos_cmd, (Pose{.x = 10, .y = 1.0 / 3}));
  EXPECT_EQ(rig.status().joint[1].pos_cmd, 1.0 / 3);
  EXPECT_FALSE(rig.saw(Fault::limit_acceleration));
}

TEST(Executor, TheRestOfACycleIsCarriedIntoTheNextMove) {
  Rig many;
  many.ready();
  many.push(PathControl{.mode = PathControl::Mode::exact_stop});
  for (int i = 1; i <= 40; ++i) many.line({.x = 0.1 * i}, 50);
  const double exact = 0.005 + 40 * 2 * std::sqrt(0.1 / 1000);  // 40 triangles
  EXPECT_NEAR(many.finish() * Rig::kPeriod, exact, 0.003);
  EXPECT_TRUE(many.faults.empty());
}

TEST(Executor, SynchronisedOutputsActWithTheNextMoveAndNeverWithoutOne) {
  Rig rig;
  rig.ready();
  rig.push(OutputChange{.index = 0, .synchronised = true, .value = 1});
  rig.push(OutputChange{.index = 2, .analog = true, .synchronised = true, .value = 4.5});
  rig.run(50);
  EXPECT_EQ(rig.status().executed_seq, 2U);
  EXPECT_EQ(rig.controller->outputs().digital, 0U);
  rig.line({.x = 1}, 10);
  int cycle = 0;
  rig.run_until([&] { return ++cycle, rig.status().pos_cmd.x > 0; }, 20);
  EXPECT_EQ(rig.controller->outputs().digital, 1U) << "in the first cycle of the move";
  EXPECT_EQ(rig.controller->outputs().analog[2], 4.5);
  rig.finish();
  rig.push(OutputChange{.index = 1, .synchronised = true, .value = 1});
  rig.run(5);
  rig.abort();
  rig.run(5);
  rig.line({.x = 2}, 10);
  rig.finish();
  EXPECT_EQ(rig.controller->outputs().digital, 1U) << "an abort forgets what waited";
}

TEST(Executor, SynchronisedOutputsDoNotOutliveTheirProgram) {
  Rig rig;
  rig.ready();
  rig.push(OutputChange{.index = 0, .synchronised = true, .value = 1});
  rig.push(OutputChange{.index = 2, .analog = true, .synchronised = true, .value = 4.5});
  Marker end;
  end.drop_outputs = true;
  rig.push(end);
  rig.line({.x = 1}, 10);  // of the next program
  rig.finish();
  EXPECT_EQ(rig.controller->outputs().digital, 0U);
  EXPECT_EQ(rig.controller->outputs().analog[2], 0);
}

TEST(Executor, ImmediateOutputsActInTheirPlaceAtRest) {
  Rig rig;
  rig.ready();
  rig.line({.x = 5}, 50);
  rig.push(OutputChange{.index = 7, .value = 1});
  rig.line({.x = 10}, 50);
  rig.run_until([&] { return rig.controller->outputs().digital != 0; }, 1000);
  EXPECT_NEAR(rig.status().pos_cmd.x, 5, 1e-3);
  rig.finish();
  EXPECT_EQ(rig.controller->outputs().digital, 128U);
}

TEST(Executor, DwellTakesItsTime) {
  Rig rig;
  rig.ready();
  rig.push(Dwell{0.25});
  const int cycles = rig.finish();
  EXPECT_NEAR(cycles, 250, 2);
  rig.push(Dwell{0.1});
  rig.run(50);
  EXPECT_EQ(rig.status().waiting_for, PathWait::dwell);
  rig.orders.hold = true;
  rig.run(500);
  EXPECT_GT(rig.status().dwell_left_s, 0.04);
  rig.orders.hold = false;
  rig.run(80);
  EXPECT_TRUE(rig.status().path_empty);
}

TEST(Executor, FeedWaitsForTheSpindleTraverseDoesNot) {
  Rig rig;
  rig.ready();
  rig.in.spindle[0].at_speed = false;
  rig.push(spin(SpindleChange::Action::forward, 1000));
  rig.line({.x = 5}, 0, MotionKind::traverse);
  rig.line({.x = 6}, 10);
  rig.run(2000);
  EXPECT_EQ(rig.status().pos_cmd.x, 5);
  EXPECT_EQ(rig.status().waiting_for, PathWait::spindle_at_speed);
  EXPECT_EQ(rig.status().waiting_index, 0);
  EXPECT_EQ(rig.controller->spindles().outputs(0).speed_rpm, 1000);
  rig.in.spindle[0].at_speed = true;
  EXPECT_GT(rig.finish(1000), 0);
  // Only until it was there once; a stopped spindle is not waited for.
  rig.in.spindle[0].at_speed = false;
  rig.line({.x = 7}, 10);
  EXPECT_GT(rig.finish(1000), 0);
  rig.push(spin(SpindleChange::Action::stop, 0));
  rig.line({.x = 8}, 10);
  EXPECT_GT(rig.finish(1000), 0);
}

TEST(Executor, SpindleSpeedFollowsOverrideLimitsInhibitAndDirection) {
  Rig rig;
  rig.config.spindle[0].max_forward_rpm = 2000;
  rig.config.spindle[0].min_forward_rpm = 100;
  rig.config.spindle[0].max_reverse_rpm = 500;
  rig.ready();
  const auto& out = rig.controller->spindles().outputs(0);
  rig.push(spin(SpindleChange::Action::forward, 1500));
  rig.run(3);
  EXPECT_TRUE(out.on && out.forward && !out.reverse && !out.brake);
  rig.intent.spindle_override[0] = 2;
  rig.run(1);
  EXPECT_EQ(out.speed_rpm, 2000);
  rig.intent.spindle_override[0] = 0.001;
  rig.run(1);
  EXPECT_EQ(out.speed_rpm, 100);
  OverrideEnable no;
  no.spindle[0] = false;
  rig.push(no);
  rig.run(2);
  EXPECT_EQ(out.speed_rpm, 1500);
  rig.in.spindle[0].inhibit = true;
  rig.run(1);
  EXPECT_EQ(out.speed_rpm, 0);
  rig.in.spindle[0].inhibit = false;
  rig.push(spin(SpindleChange::Action::reverse, 1500));
  rig.run(2);
  EXPECT_EQ(out.speed_rpm, -500);
  EXPECT_TRUE(out.reverse);
  ++rig.intent.spindle_stop_seq[0];
  rig.run(1);
  EXPECT_FALSE(out.on);
  EXPECT_TRUE(out.brake);
}

TEST(Executor, ConstantSurfaceSpeedFollowsTheRadius) {
  Rig rig;
  rig.ready();
  SpindleChange s = spin(SpindleChange::Action::forward, 100);
  s.css_factor = 10000;
  s.css_max_rpm = 900;
  rig.line({.x = 20}, 100);
  rig.push(s);
  rig.finish();
  rig.run(2);
  EXPECT_NEAR(rig.controller->spindles().outputs(0).speed_rpm, 500, 1e-9);
  rig.line({.x = 1}, 100);
  rig.finish();
  EXPECT_NEAR(rig.controller->spindles().outputs(0).speed_rpm, 900, 1e-9);
}

TEST(Executor, ConstantSurfaceSpeedMeasuresFromTheWorkpiece) {
  Rig rig;
  rig.ready();
  SpindleChange s = spin(SpindleChange::Action::forward, 100);
  s.css_factor = 10000;
  s.css_max_rpm = 900;
  s.css_center_x_mm = -20;
  rig.push(ToolOffset{{.x = 5}});
  rig.push(s);
  rig.line({.x = 25}, 100);  // 40 from the centre
  rig.finish();
  rig.run(2);
  EXPECT_NEAR(rig.controller->spindles().outputs(0).speed_rpm, 250, 1e-9);
  s.css_max_rpm = 0;
  rig.push(s);
  rig.run(5);
  EXPECT_TRUE(rig.saw(Fault::bad_item)) << "no bound";
}

TEST(Executor, ConstantSurfaceSpeedWaitsAfterEachTraverse) {
  Rig rig;
  rig.ready();
  SpindleChange s = spin(SpindleChange::Action::forward, 100);
  s.css_factor = 10000;
  s.css_max_rpm = 900;
  rig.push(s);
  rig.line({.x = 20}, 100);
  ASSERT_GT(rig.finish(1000), 0);
  rig.in.spindle[0].at_speed = false;
  rig.line({.x = 21}, 100);
  ASSERT_GT(rig.finish(1000), 0) << "feed after feed does not wait";
  rig.line({.x = 5}, 0, MotionKind::traverse);
  rig.line({.x = 4}, 100);
  rig.run(1000);
  EXPECT_EQ(rig.status().pos_cmd.x, 5);
  EXPECT_EQ(rig.status().waiting_for, PathWait::spindle_at_speed);
  rig.in.spindle[0].at_speed = true;
  EXPECT_GT(rig.finish(1000), 0);
}

TEST(Executor, OrientWaitsForTheDriveAndLocks) {
  Rig rig;
  rig.ready();
  SpindleChange s = spin(SpindleChange::Action::orient, 0);
  s.orient_angle_deg = 90;
  s.orient_mode = 2;
  rig.push(s);
  rig.line({.x = 1}, 10);
  rig.run(100);
  const auto& out = rig.controller->spindles().outputs(0);
  EXPECT_TRUE(out.orient);
  EXPECT_EQ(out.orient_angle_deg, 90);
  EXPECT_EQ(out.orient_mode, 2);
  EXPECT_EQ(rig.status().waiting_for, PathWait::orient);
  EXPECT_EQ(rig.status().executed_seq, 0U);
  rig.in.spindle[0].is_oriented = true;
  EXPECT_GT(rig.finish(1000), 0);
  EXPECT_FALSE(out.orient);
  EXPECT_TRUE(out.locked && out.brake);
  rig.in.spindle[0].is_oriented = false;
  rig.push(spin(SpindleChange::Action::forward, 10));
  rig.run(2);
  EXPECT_FALSE(out.locked);
}

TEST(Executor, TheAnswerToAnEarlierOrientationDoesNotEndTheNext) {
  Rig rig;
  rig.ready();
  rig.in.spindle[0].is_oriented = true;
  rig.push(spin(SpindleChange::Action::orient, 0));
  rig.line({.x = 1}, 10);
  rig.run(2);
  rig.in.spindle[0].is_oriented = false;  // the drive takes its old answer back
  rig.run(100);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  EXPECT_TRUE(rig.controller->spindles().outputs(0).orient);
  rig.in.spindle[0].is_oriented = true;
  EXPECT_GT(rig.finish(1000), 0);
  rig.push(spin(SpindleChange::Action::orient, 0));
  rig.line({.x = 2}, 10);
  EXPECT_GT(rig.finish(1000), 0) << "a pin that is always true is an answer too";
}

TEST(Executor, OrientFaultEndsThePath) {
  Rig rig;
  rig.ready();
  rig.push(spin(SpindleChange::Action::orient, 0));
  rig.line({.x = 1}, 10);
  rig.run(5);
  rig.in.spindle[0].orient_fault = 7;
  rig.run(500);
  EXPECT_TRUE(rig.saw(Fault::orient_fault));
  EXPECT_EQ(rig.faults[0].value, 7);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  EXPECT_TRUE(rig.status().path_empty);
}

TEST(Executor, OrientationHasATimeout) {
  Rig rig;
  rig.ready();
  SpindleChange s = spin(SpindleChange::Action::orient, 0);
  s.orient_timeout_s = 0.2;
  rig.push(s);
  rig.line({.x = 1}, 10);
  rig.run(150);
  rig.orders.hold = true;
  rig.run(500);
  EXPECT_TRUE(rig.faults.empty()) << "a program that is held has all the time";
  rig.orders.hold = false;
  rig.run(100);
  ASSERT_EQ(rig.faults.size(), 1U);
  EXPECT_EQ(rig.faults[0].fault, Fault::orient_fault);
  EXPECT_EQ(rig.faults[0].value, -1);
  EXPECT_FALSE(rig.controller->spindles().outputs(0).orient);
  rig.run(500);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  EXPECT_TRUE(rig.status().path_empty);
}

TEST(Executor, AnOrientationThatWasStoppedIsNotDone) {
  for (const bool aborted : {false, true}) {
    Rig rig;
    rig.ready();
    rig.push(spin(SpindleChange::Action::orient, 0));
    rig.line({.x = 1}, 10);
    rig.run(5);
    ++rig.intent.spindle_stop_seq[0];
    if (aborted) rig.abort();
    rig.run(500);
    EXPECT_EQ(rig.status().executed_seq, 0U);
    EXPECT_EQ(rig.status().pos_cmd.x, 0);
    EXPECT_TRUE(rig.status().path_empty);
    EXPECT_EQ(rig.saw(Fault::orient_fault), !aborted);
  }
}

ProbeMove probe(double x, double vel, bool until_open = false, bool error = true) {
  ProbeMove p;
  p.end.x = x;
  p.vel_mm_s = vel;
  p.until_open = until_open;
  p.fail_is_error = error;
  return p;
}

TEST(Executor, ProbeStopsAtContactAndRemembersThePlace) {
  Rig rig;
  rig.ready();
  rig.push(probe(100, 50));
  rig.line({.x = 0}, 50);
  rig.run_until([&] { return rig.status().pos_cmd.x >= 20; }, 5000);
  EXPECT_TRUE(rig.status().probing);
  const double contact = rig.in.joint[0].motor_pos_fb;
  rig.in.probe = true;
  rig.run_until([&] { return rig.status().executed_seq == 1; }, 200);
  EXPECT_TRUE(rig.status().probe_tripped);
  EXPECT_EQ(rig.status().probed.x, contact);
  EXPECT_NEAR(rig.status().pos_cmd.x, contact + 50 * 50 / 2000.0, 0.2) << "it brakes within limits";
  rig.in.probe = false;
  EXPECT_GT(rig.finish(5000), 0) << "the next move begins where the probe stopped";
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Executor, ProbeWithoutContactIsAnErrorOnlyWhereAsked) {
  Rig rig;
  rig.ready();
  rig.push(probe(5, 50, false, false));
  EXPECT_GT(rig.finish(1000), 0);
  EXPECT_FALSE(rig.status().probe_tripped);
  EXPECT_TRUE(rig.faults.empty());
  rig.push(probe(10, 50));
  rig.line({.x = 20}, 50);
  rig.run(2000);
  EXPECT_TRUE(rig.saw(Fault::probe_no_contact));
  EXPECT_EQ(rig.status().pos_cmd.x, 10) << "nothing behind a failed probe is carried out";
}

TEST(Executor, ProbeAlreadyTrippedDoesNotMove) {
  Rig rig;
  rig.ready();
  rig.in.probe = true;
  rig.push(probe(5, 50));
  rig.run(200);
  EXPECT_TRUE(rig.saw(Fault::probe_already_tripped));
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  rig.abort();
  rig.run(2);
  rig.push(probe(5, 50, true));
  rig.run(30);
  rig.in.probe = false;
  EXPECT_GT(rig.finish(1000), 0) << "until open works from a closed contact";
  EXPECT_TRUE(rig.status().probe_tripped);
}

TEST(Executor, UnexpectedContactStopsThePath) {
  Rig rig;
  rig.ready();
  rig.line({.x = 50}, 50);
  rig.run(200);
  rig.in.probe = true;
  rig.run(500);
  EXPECT_TRUE(rig.saw(Fault::probe_unexpected));
  EXPECT_LT(rig.status().pos_cmd.x, 15);
  EXPECT_TRUE(rig.status().in_position);
  EXPECT_TRUE(rig.status().path_empty);
}

TEST(Executor, OverridesScaleTheFeedUpToTheCeiling) {
  Rig rig;
  rig.ready();
  rig.line({.x = 900}, 50);
  rig.run(300);
  EXPECT_NEAR(rig.status().vel_mm_s, 50, 1e-9);
  rig.intent.feed_override = 1.4;
  rig.run(100);
  EXPECT_NEAR(rig.status().vel_mm_s, 70, 1e-9);
  rig.intent.feed_override = 100;
  rig.run(100);
  EXPECT_NEAR(rig.status().vel_mm_s, 75, 1e-9) << "MAX_FEED_OVERRIDE bounds";
  rig.intent.max_vel_mm_s = 30;
  rig.run(100);
  EXPECT_NEAR(rig.status().vel_mm_s, 30, 1e-9);
  rig.intent.max_vel_mm_s = 1e99;
  rig.intent.rapid_override = 0.1;
  rig.run(100);
  EXPECT_NEAR(rig.status().vel_mm_s, 75, 1e-9) << "rapid override is for traverses";
  rig.intent.feed_override = 0;
  rig.run(300);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  EXPECT_EQ(rig.status().waiting_for, PathWait::zero_override);
  rig.intent.feed_override = NAN;
  rig.run(10);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  EXPECT_TRUE(rig.faults.empty());
}

/// Held on a circle by an override of 0, and let go with hardly any: what it begins to do at that pace it does not go on with when the feed is back.
TEST(Executor, AFeedThatComesBackFromNothingIsDrivenAtOnce) {
  for (const bool holds : {false, true}) {
    Rig rig;
    rig.ready();
    ArcMove arc;
    arc.centre[0] = 10;
    arc.end = {.x = 20};
    arc.normal[2] = 1;
    arc.vel_mm_s = 50;
    rig.push(arc);
    rig.run(300);
    rig.intent.feed_override = 0;
    rig.run(300);
    ASSERT_EQ(rig.status().vel_mm_s, 0);
    ASSERT_GT(rig.status().distance_to_go, 5);
    // The planner has not seen it yet: where this stretch ends the path still stands.
    rig.plan = false;
    rig.intent.feed_override = 0.001;
    rig.run(20);
    EXPECT_GT(rig.status().vel_mm_s, 0);
    if (holds) {
      rig.orders.hold = true;
      rig.run(20);
      EXPECT_EQ(rig.status().vel_mm_s, 0);
      rig.orders.hold = false;
      rig.run(20);
    }
    rig.plan = true;
    rig.intent.feed_override = 1;
    rig.run(100);
    EXPECT_NEAR(rig.status().vel_mm_s, 50, 1e-3);
    EXPECT_GT(rig.finish(), 0);
    EXPECT_TRUE(rig.faults.empty());
  }
}

TEST(Executor, TraversesRunAtTheCeilingTimesTheRapidOverride) {
  Rig rig;
  rig.ready();
  rig.intent.feed_override = 0.1;
  rig.line({.x = 900}, 0, MotionKind::traverse);
  rig.run(300);
  EXPECT_NEAR(rig.status().vel_mm_s, 100, 1e-9);
  EXPECT_EQ(rig.status().kind, MotionKind::traverse);
  rig.intent.rapid_override = 0.25;
  rig.run(300);
  EXPECT_NEAR(rig.status().vel_mm_s, 25, 1e-9);
}

TEST(Executor, M50ToM53DecideWhatCounts) {
  Rig rig;
  rig.ready();
  OverrideEnable e;
  e.feed = false;
  e.feed_hold = false;
  rig.push(e);
  rig.line({.x = 900}, 50);
  rig.intent.feed_override = 0.5;
  rig.in.feed_hold = true;
  rig.in.adaptive_feed = 0.1;
  rig.run(300);
  EXPECT_NEAR(rig.status().vel_mm_s, 50, 1e-9);
  rig.abort();
  rig.run(300);
  rig.in.feed_hold = false;
  e.feed = e.feed_hold = e.adaptive = true;
  rig.push(e);
  rig.line({.x = 0}, 50);
  rig.run(200);
  EXPECT_NEAR(rig.status().vel_mm_s, 2.5, 1e-9);
  rig.in.feed_hold = true;
  rig.run(100);
  EXPECT_EQ(rig.status().vel_mm_s, 0);
  EXPECT_EQ(rig.status().waiting_for, PathWait::feed_hold_pin);
  rig.in.feed_hold = false;
  rig.in.feed_inhibit = true;
  rig.run(100);
  EXPECT_EQ(rig.status().waiting_for, PathWait::feed_inhibit);
}

TEST(Executor, HoldStopsOnThePathAndGoesOnFromThere) {
  Rig rig;
  rig.ready();
  rig.line({.x = 20, .y = 10}, 80);
  rig.run(100);
  rig.orders.hold = true;
  rig.run(200);
  EXPECT_TRUE(rig.status().held);
  const Pose at = rig.status().pos_cmd;
  EXPECT_NEAR(at.y, at.x / 2, 1e-12);
  rig.run(100);
  EXPECT_EQ(rig.status().pos_cmd, at);
  rig.orders.hold = false;
  EXPECT_GT(rig.finish(2000), 0);
  EXPECT_EQ(rig.status().pos_cmd, (Pose{.x = 20, .y = 10}));
}

TEST(Executor, SingleStepRunsOneBlockAfterEachRelease) {
  Rig rig;
  rig.ready();
  rig.intent.single_step = true;
  rig.orders.hold = true;
  rig.line({.x = 1}, 50);
  rig.line({.x = 2}, 50);
  rig.push(OutputChange{.index = 0, .value = 1});
  rig.run(100);
  EXPECT_EQ(rig.status().pos_cmd.x, 0);
  rig.orders.hold = false;
  rig.run(500);
  EXPECT_EQ(rig.status().pos_cmd.x, 1);
  EXPECT_TRUE(rig.status().held);
  for (int i = 0; i < 2; ++i) {
    rig.orders.hold = true;
    rig.run(2);
    rig.orders.hold = false;
    rig.run(500);
    EXPECT_EQ(rig.status().pos_cmd.x, 2);
    EXPECT_EQ(rig.controller->outputs().digital, i == 0 ? 0U : 1U);
  }
  EXPECT_TRUE(rig.status().path_empty);
}

TEST(Executor, AbortStopsOnThePathAndForgetsTheRest) {
  Rig rig;
  rig.ready();
  rig.line({.x = 20, .y = 10}, 80);
  rig.line({.x = 0}, 80);
  rig.run(100);
  const Pose before = rig.status().pos_cmd;
  rig.abort();
  const int cycles = rig.run_until([&] { return rig.status().acked_epoch == 2; }, 500);
  EXPECT_LE(cycles, 80 / 1000.0 / Rig::kPeriod + 2);
  const Pose at = rig.status().pos_cmd;
  EXPECT_GT(at.x, before.x);
  EXPECT_NEAR(at.y, at.x / 2, 1e-12);
  EXPECT_EQ(rig.status().current.line, 1);
  rig.run(500);
  EXPECT_EQ(rig.status().pos_cmd, at);
  EXPECT_TRUE(rig.status().path_empty);
  EXPECT_EQ(rig.status().executed_seq, 0U);
  rig.line({.x = 3}, 80);
  EXPECT_GT(rig.finish(2000), 0);
  EXPECT_EQ(rig.status().pos_cmd.x, 3);
  EXPECT_TRUE(rig.faults.empty());
}

/// Least time to stop on a circle about 0 from a point at a speed: at each instant as hard as both axes allow.
double least_stop_s(Pose at, double speed, double acc) {
  const double r = std::hypot(at.x, at.y), dt = 1e-5;
  double phi = std::atan2(at.y, at.x), t = 0;
  while (speed > 0) {
    const double c = std::cos(phi), s = std::sin(phi), n = speed * speed / r;
    // Acceleration of X: u sin - n cos, of Y: -u cos - n sin, for a braking u.
    double u = 1e9;
    if (std::abs(s) > 1e-9) u = std::min(u, (acc + (s > 0 ? n * c : -n * c)) / std::abs(s));
    if (std::abs(c) > 1e-9) u = std::min(u, (acc + (c > 0 ? -n * s : n * s)) / std::abs(c));
    speed -= u * dt;
    phi += speed / r * dt;
    t += dt;
  }
  return t;
}

TEST(Executor, StopsOnArcsTakeLittleMoreThanTheLeastTime) {
  for (const double override_factor : {1.0, 0.3, 0.02}) {
    for (const int cycles : {400, 777, 1313, 2001}) {
      Rig rig;
      rig.ready();
      rig.line({.x = 20}, 90);
      ASSERT_GT(rig.finish(), 0);
      ArcMove m;
      m.end = {.x = 20};
      m.normal[2] = 1;
      m.vel_mm_s = 90;
      m.turns = 3;
      rig.push(m);
      rig.intent.feed_override = override_factor;
      rig.run(cycles);
      const double speed = rig.status().vel_mm_s;
      ASSERT_GT(speed, 0);
      const double least = least_stop_s(rig.status().pos_cmd, speed, 1000);
      rig.abort();
      const int took = rig.run_until([&] { return rig.status().acked_epoch == 2; }, 2000);
      EXPECT_GT(took, 0);
      EXPECT_LE(took * Rig::kPeriod, 1.1 * least + 2.5 * Rig::kPeriod)
          << "override " << override_factor << " after " << cycles;
      EXPECT_TRUE(rig.faults.empty());
    }
  }
}

TEST(Executor, MarkersAndToolOffsetsPassInOrder) {
  Rig rig;
  rig.ready();
  ToolOffset t;
  t.offset.z = 12.5;
  rig.push(Marker{1});
  rig.push(t);
  rig.push(PathControl{});
  rig.line({}, 10);  // a point: no time at all
  rig.push(Marker{2});
  EXPECT_LE(rig.finish(10), 2);
  EXPECT_EQ(rig.status().tool_offset.z, 12.5);
  EXPECT_EQ(rig.status().executed_seq, 5U);
}

}  // namespace
}  // namespace kerf::motion
