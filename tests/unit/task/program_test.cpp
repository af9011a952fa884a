// Programs, MDI and their outcomes, with a pretended motion.
#include <gmock/gmock.h>

#include "rig.hpp"

namespace kerf::task::testing {
namespace {

using ::testing::HasSubstr;
using State = CommandState;

TEST(Program, machine_states_follow_the_estop_chain) {
  Rig rig;
  rig.run_for(0.01);
  EXPECT_EQ(rig.status().task_state, TaskState::estop);
  EXPECT_EQ(rig.command({"state", "on"}).state, State::error);
  rig.does({"state", "estop-reset"});
  EXPECT_EQ(rig.status().task_state, TaskState::estop_reset);
  EXPECT_TRUE(rig.pins.out.user_enable_out);
  rig.does({"state", "on"});
  EXPECT_EQ(rig.status().task_state, TaskState::on);
  rig.pins.external_ok = false;
  EXPECT_TRUE(rig.run_until([&] { return rig.status().task_state == TaskState::estop; }, 0.1));
  EXPECT_FALSE(rig.pins.out.user_enable_out);
  EXPECT_EQ(rig.shared->intent.enable.get(), 0u);
  EXPECT_THAT(rig.messages(), HasSubstr("emc-enable-in"));
  const Reply refused = rig.command({"state", "estop-reset"});
  EXPECT_EQ(refused.state, State::error);
  EXPECT_THAT(refused.text, HasSubstr("emc-enable-in is FALSE"));
}

// Whoever looks just then sees nothing, and when the write ends there may be nothing new that task would be told of.
TEST(Program, servo_thread_stopped_in_the_middle_of_a_write_holds_nothing_up) {
  Rig rig;
  rig.ready();
  for (int k = 0; k < 14; ++k) {
    EXPECT_EQ(rig.fake->stalls_from, rtapi::kForever) << k;
    rig.fake->stalls_from = rig.scheduler->now() + k * kMillisecond;
    EXPECT_EQ(rig.command({"mdi", "G4 P0.01"}, 0.2).state, State::done) << k;
    EXPECT_EQ(rig.command({"mdi", "G0 X1 G1"}, 0.2).state, State::error) << k;
  }
}

TEST(Program, machine_that_does_not_enable_says_so) {
  Rig rig;
  rig.fake->may_enable = false;
  rig.does({"state", "estop-reset"});
  const Reply r = rig.command({"state", "on"});
  EXPECT_EQ(r.state, State::error);
  EXPECT_THAT(r.text, HasSubstr("motion.enable"));
  EXPECT_EQ(rig.status().task_state, TaskState::estop_reset);
}

/// A busy computer may keep the servo thread from running for longer than a machine takes to answer.
TEST(Program, power_on_waits_for_a_servo_thread_that_has_not_run) {
  Rig rig;
  rig.does({"state", "estop-reset"});
  rig.fake->sleeps_until = rig.scheduler->now() + rtapi::seconds(2.5);
  const auto on = rig.send({"state", "on"});
  rig.run_for(2.4);
  EXPECT_FALSE(rig.finished(on)) << rig.outcome(on).text;
  EXPECT_EQ(rig.wait(on).state, State::done) << rig.outcome(on).text;
}

TEST(Program, power_on_without_a_servo_thread_says_so) {
  Rig rig;
  rig.does({"state", "estop-reset"});
  rig.fake->sleeps_until = rig.scheduler->now() + rtapi::seconds(60);
  const Reply r = rig.command({"state", "on"}, 10);
  EXPECT_EQ(r.state, State::error);
  EXPECT_THAT(r.text, HasSubstr("motion does not run"));
}

TEST(Program, state_on_that_is_taken_back_ends_aborted) {
  for (const char* other : {"off", "estop"}) {
    Rig rig;
    rig.fake->may_enable = false;
    rig.does({"state", "estop-reset"});
    const auto on = rig.send({"state", "on"});
    rig.run_for(0.1);
    EXPECT_FALSE(rig.finished(on));
    rig.does({"state", other});
    EXPECT_EQ(rig.outcome(on).state, State::aborted) << other;
    const auto& c = rig.status().commands;
    EXPECT_EQ(c.received, c.done + c.errors + c.aborted);
  }
}

TEST(Program, mdi_needs_power_and_homing) {
  Rig rig;
  EXPECT_THAT(rig.command({"mdi", "G0 X1"}).text,
              HasSubstr("until the machine is out of E-stop and turned on"));
  rig.power_on();
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).text, "Can't issue MDI command when not homed");
  EXPECT_THAT(rig.messages(), HasSubstr("Can't issue MDI command when not homed"));
  rig.does({"home"});
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 1);
}

TEST(Program, is_not_mistaken_about_what_motion_sees_late) {
  Rig rig;
  rig.power_on();
  rig.fake->take_cycles = 40;
  EXPECT_EQ(rig.command({"home"}).state, State::done);
  EXPECT_TRUE(rig.fake->status.all_homed);
  EXPECT_EQ(rig.command({"teleop", "off"}).state, State::done);
  EXPECT_EQ(rig.command({"unhome"}).state, State::done);
  EXPECT_FALSE(rig.fake->status.all_homed);
  // Nothing else comes between a jog and motion's look at it.
  rig.does({"jog", "0", "5"});
  rig.run_for(0.02);
  EXPECT_THAT(rig.command({"home"}).text, HasSubstr("can't home while something runs"));
  rig.does({"jog-stop"});
  rig.fake->homes = false;
  rig.run_for(0.1);
  EXPECT_THAT(rig.command({"home"}).text, HasSubstr("not all joints are homed"));
}

TEST(Program, a_step_that_motion_sees_late_is_one_block) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = 50 * rtapi::kMillisecond;
  rig.folder.write("nc/steps.ngc", "G1 F600 X1\nX2\nX3\nX4\nX5\nM2\n");
  rig.does({"open", "steps.ngc"});
  const auto run = rig.send({"run"});
  rig.run_until([&] { return rig.fake->status.current.line == 2; });
  rig.does({"pause"});
  rig.run_for(0.2);
  rig.fake->take_cycles = 40;
  for (int n = 0; n < 3; ++n) {
    const std::size_t before = rig.fake->done.size();
    rig.does({"step"});
    rig.run_for(0.4);
    EXPECT_EQ(rig.fake->done.size(), before + 1) << n;
    EXPECT_TRUE(rig.status().paused);
  }
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
}

TEST(Program, no_force_homing_lets_mdi_run) {
  std::string ini = kMillIni;
  ini.replace(ini.find("COORDINATES"), 0, "NO_FORCE_HOMING = 1\n");
  Rig rig(ini);
  rig.power_on();
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
}

TEST(Program, runs_from_start_to_end_and_keeps_auto) {
  Rig rig;
  rig.ready();
  const Reply r = rig.run_text("G21 G90\nG0 X10\nG1 X20 F600\nG2 X30 I5 F300\nM2\n");
  EXPECT_EQ(r.state, State::done) << r.text;
  const auto lines = rig.fake->executed<motion::LinearMove>();
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].kind, motion::MotionKind::traverse);
  EXPECT_DOUBLE_EQ(lines[1].vel_mm_s, 10);
  const auto arcs = rig.fake->executed<motion::ArcMove>();
  ASSERT_EQ(arcs.size(), 1u);
  EXPECT_DOUBLE_EQ(arcs[0].centre[0], 25);
  EXPECT_DOUBLE_EQ(arcs[0].normal[2], -1);
  EXPECT_EQ(arcs[0].turns, 1);
  const TaskStatus s = rig.status();
  EXPECT_EQ(s.mode, TaskMode::automatic);
  EXPECT_EQ(s.interp_state, InterpState::idle);
  EXPECT_EQ(s.program_lines, 5);
  EXPECT_DOUBLE_EQ(s.progress, 1);
  EXPECT_TRUE(s.idle);
  // Idle AUTO takes MDI and stays AUTO.
  EXPECT_EQ(rig.command({"mdi", "G0 X0"}).state, State::done);
  EXPECT_EQ(rig.status().mode, TaskMode::automatic);
}

TEST(Program, runs_again_from_the_start_as_the_file_is_now) {
  Rig rig;
  rig.ready();
  rig.run_text("G0 X10\nM2\n");
  rig.folder.write("nc/test.ngc", "G0 X7\nM2\n");
  rig.does({"run"});
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 7);
}

TEST(Program, error_is_met_where_it_stands_and_stops_the_machine) {
  Rig rig;
  rig.ready();
  const Reply r = rig.run_text("M3 S1000 M8\nG0 X10\nG1 X20\nG0 X30\nM2\n");
  EXPECT_EQ(r.state, State::error);
  EXPECT_THAT(r.text, HasSubstr("test.ngc:3"));
  EXPECT_THAT(r.text, HasSubstr("Cannot do g1 with zero feed rate"));
  EXPECT_THAT(rig.messages(), HasSubstr("test.ngc:3"));
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 10) << "all before the error is done";
  rig.run_for(0.2);
  EXPECT_GT(rig.fake->spindle_stops, 0u);
  EXPECT_FALSE(rig.pins.out.coolant_flood);
  EXPECT_EQ(rig.status().task_state, TaskState::on);
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
}

TEST(Program, mdi_error_leaves_the_spindle_turning) {
  Rig rig;
  rig.ready();
  rig.does({"mdi", "M3 S500"});
  const auto stops = rig.fake->spindle_stops;
  const Reply r = rig.command({"mdi", "G1 X5"});
  EXPECT_EQ(r.state, State::error);
  EXPECT_THAT(r.text, HasSubstr("Cannot do g1 with zero feed rate"));
  EXPECT_EQ(rig.fake->spindle_stops, stops);
  EXPECT_EQ(rig.command({"mdi", "G0 X5"}).state, State::done);
}

TEST(Program, back_pressure_holds_the_interpreter_and_loses_nothing) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = kMillisecond;
  std::string text = "G90 F60000\n";
  for (int i = 1; i <= 5000; ++i) text += "G1 X" + std::to_string(i) + "\n";
  const Reply r = rig.run_text(text + "M2\n", 100);
  EXPECT_EQ(r.state, State::done) << r.text;
  const auto lines = rig.fake->executed<motion::LinearMove>();
  ASSERT_EQ(lines.size(), 5000u);
  for (int i = 0; i < 5000; ++i) ASSERT_EQ(lines[static_cast<std::size_t>(i)].end.x, i + 1);
  EXPECT_GE(rig.fake->peak_queue, motion::PathRing::capacity() - 1);
}

TEST(Program, pause_holds_and_resume_goes_on) {
  Rig rig;
  rig.ready();
  const auto run = rig.start_text("G0 X10\nG0 X20\nG0 X30\nM8\nG0 X40\nM2\n");
  ASSERT_TRUE(rig.run_until([&] { return rig.fake->status.pos_cmd.x == 10; }));
  rig.does({"pause"});
  EXPECT_EQ(rig.shared->intent.hold.get(), 1u);
  rig.run_for(1);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 10);
  EXPECT_EQ(rig.status().interp_state, InterpState::paused);
  EXPECT_TRUE(rig.status().paused);
  EXPECT_THAT(rig.command({"mdi", "G0 X1"}).text, HasSubstr("while a program runs"));
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 40);
}

TEST(Program, step_executes_one_block_at_a_time) {
  Rig rig;
  rig.ready();
  rig.does({"open", rig.folder.write("nc/test.ngc", "G0 X1\nG0 X2\n(nothing)\nG0 X3\nM2\n")});
  for (int i = 1; i <= 3; ++i) {
    rig.does({"step"});
    rig.run_for(0.5);
    EXPECT_EQ(rig.fake->status.pos_cmd.x, i);
    EXPECT_EQ(rig.status().interp_state, InterpState::paused);
    EXPECT_EQ(rig.status().single_step, 1);
  }
  rig.does({"resume"});
  EXPECT_TRUE(rig.run_until([&] { return rig.status().idle; }, 5));
  EXPECT_EQ(rig.status().programs_ended, 1u);
}

TEST(Program, step_after_pause_ends_the_held_block) {
  Rig rig;
  rig.ready();
  const auto run = rig.start_text("G0 X1\nG0 X2\nG0 X3\nG0 X4\nM2\n");
  ASSERT_TRUE(rig.run_until([&] { return rig.fake->status.pos_cmd.x == 1; }));
  rig.does({"pause"});
  rig.does({"step"});
  rig.run_for(1);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 2);
  rig.does({"step"});
  rig.run_for(1);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 3);
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
}

TEST(Program, m0_waits_for_resume_and_m1_for_the_switch) {
  Rig rig;
  rig.ready();
  EXPECT_TRUE(rig.status().optional_stop) << "on at the start";
  rig.does({"optional-stop", "off"});
  auto run = rig.start_text("G0 X1\nM0\nG0 X2\nM1\nG0 X3\nM2\n");
  rig.run_for(1);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 1);
  EXPECT_EQ(rig.status().interp_state, InterpState::paused);
  EXPECT_EQ(rig.status().current_line, 2);
  EXPECT_EQ(rig.status().waiting_for.object.view(), "resume");
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
  rig.does({"optional-stop", "on"});
  run = rig.send({"run"});
  rig.run_for(1);
  rig.does({"resume"});
  rig.run_for(1);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 2);
  EXPECT_FALSE(rig.finished(run));
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_EQ(rig.command({"mdi", "M0"}).state, State::done) << "MDI stops after each line anyway";
}

TEST(Program, block_delete_skips_lines) {
  Rig rig;
  rig.ready();
  EXPECT_TRUE(rig.status().block_delete) << "on at the start";
  rig.run_text("/G0 X5\nG0 Y1\nM2\n");
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 0);
  rig.does({"block-delete", "off"});
  rig.does({"run"});
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 5);
}

TEST(Program, messages_and_coolant_come_in_their_place) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  const auto run = rig.start_text("G0 X1\n(MSG, half way)\nM8\nG0 X2\nM9\nM2\n");
  rig.run_for(0.5);
  EXPECT_EQ(rig.messages(), "");
  EXPECT_FALSE(rig.pins.out.coolant_flood);
  rig.run_for(1);
  EXPECT_THAT(rig.messages(), HasSubstr("half way"));
  EXPECT_TRUE(rig.pins.out.coolant_flood);
  EXPECT_TRUE(rig.status().flood);
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_FALSE(rig.status().flood);
}

TEST(Program, tool_change_takes_its_handshake) {
  Rig rig;
  rig.ready();
  rig.pins.changes = false;
  const auto run = rig.start_text("T2 M6\nG43\nG0 Z5\nM2\n");
  rig.run_for(0.5);
  EXPECT_TRUE(rig.pins.out.tool_change);
  EXPECT_EQ(rig.pins.out.tool_prep_number, 2);
  EXPECT_EQ(rig.pins.out.tool_prep_pocket, 2);
  EXPECT_EQ(rig.status().waiting_for.pin.view(), "iocontrol.0.tool-changed");
  rig.pins.changes = true;
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_EQ(rig.pins.out.tool_number, 2);
  EXPECT_EQ(rig.pins.out.tool_prep_number, 0);
  EXPECT_EQ(rig.status().tool_in_spindle, 2);
  EXPECT_EQ(rig.fake->status.pos_cmd.z, 25) << "G43 takes the offset of the tool in the spindle";
}

TEST(Program, operator_confirms_a_tool_change) {
  Rig rig;
  rig.ready();
  EXPECT_EQ(rig.command({"tool-changed"}).state, State::error);
  rig.pins.changes = false;
  const auto change = rig.send({"mdi", "T1 M6"});
  rig.run_for(0.5);
  EXPECT_FALSE(rig.finished(change));
  rig.does({"tool-changed"});
  EXPECT_EQ(rig.wait(change).state, State::done);
  EXPECT_EQ(rig.status().tool_in_spindle, 1);
}

TEST(Program, unknown_tool_is_an_error_with_its_line) {
  Rig rig;
  rig.ready();
  const Reply r = rig.run_text("G0 X1\nT99 M6\nM2\n");
  EXPECT_EQ(r.state, State::error);
  EXPECT_THAT(r.text, HasSubstr("test.ngc:2"));
  EXPECT_THAT(r.text, HasSubstr("99"));
}

TEST(Program, m66_waits_for_the_input_or_the_time) {
  Rig rig;
  rig.ready();
  auto run = rig.start_text("M66 P1 L3 Q5\nG0 X[#5399 + 10]\nM2\n");
  rig.run_for(1);
  EXPECT_FALSE(rig.finished(run));
  EXPECT_EQ(rig.status().waiting_for.pin.view(), "motion.digital-in-01");
  rig.fake->status.digital_in = 2;
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 11);
  rig.fake->status.digital_in = 0;
  const double begin = rig.seconds();
  rig.does({"run"});
  EXPECT_NEAR(rig.seconds() - begin, 5, 0.1);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 9) << "-1 is the time-out";
  // A rise is not a level: the input must have been low.
  rig.fake->status.digital_in = 1;
  run = rig.start_text("M66 P0 L1 Q3\nG0 X[#5399 + 20]\nM2\n");
  rig.run_for(1);
  EXPECT_FALSE(rig.finished(run));
  rig.fake->status.digital_in = 0;
  rig.run_for(0.1);
  rig.fake->status.digital_in = 1;
  EXPECT_EQ(rig.wait(run, 1).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 21);
  EXPECT_EQ(rig.run_text("M66 E2 L0\nG0 X#5399\nM2\n").state, State::done);
  EXPECT_THAT(rig.run_text("M66 P9 L0\nM2\n").text, HasSubstr("there is no digital input 9"));
}

TEST(Program, outputs_go_to_motion_in_order_and_lost_ones_are_named) {
  Rig rig;
  rig.ready();
  EXPECT_EQ(rig.run_text("M62 P1\nM67 E2 Q0.5\nG0 X1\nM64 P0\nM68 E1 Q2\nM63 P1\nM2\n").state,
            State::done);
  const auto outs = rig.fake->executed<motion::OutputChange>();
  ASSERT_EQ(outs.size(), 5u);
  EXPECT_TRUE(outs[0].synchronised && outs[0].value == 1 && outs[0].index == 1);
  EXPECT_TRUE(outs[1].analog && outs[1].value == 0.5);
  EXPECT_FALSE(outs[2].synchronised);
  EXPECT_TRUE(outs[3].analog && !outs[3].synchronised && outs[3].value == 2);
  EXPECT_THAT(rig.messages(), HasSubstr("M62, M63 or M67"));
}

TEST(Program, offsets_rotation_and_inches_reach_machine_coordinates) {
  Rig rig;
  rig.ready();
  EXPECT_EQ(
      rig.run_text("G10 L2 P1 X100 Y50 R90\nG54\nG0 X10 Y0\nG20\nG0 X1 Y0\nG92 X0\nG0 X1\nM2\n")
          .state,
      State::done);
  const auto moves = rig.fake->executed<motion::LinearMove>();
  ASSERT_EQ(moves.size(), 3u);
  EXPECT_NEAR(moves[0].end.x, 100, 1e-9);
  EXPECT_NEAR(moves[0].end.y, 60, 1e-9);
  EXPECT_NEAR(moves[1].end.y, 75.4, 1e-9);
  EXPECT_NEAR(moves[2].end.y, 100.8, 1e-9);
}

TEST(Program, parameters_survive_and_are_saved_at_the_end) {
  Rig rig;
  rig.ready();
  EXPECT_EQ(rig.run_text("G10 L2 P2 X12.5\nG55\nG0 X1\nG54\nM2\n").state, State::done);
  EXPECT_THAT(rig.folder.read("test.var"), HasSubstr("5241\t12.5"));
  rig.stop();
  rig.start();
  rig.ready();
  EXPECT_EQ(rig.command({"mdi", "G55 G0 X0"}).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 12.5);
}

TEST(Program, mdi_queue_has_an_end_and_keeps_order) {
  Rig rig;
  rig.ready();
  std::vector<std::uint64_t> ids;
  for (int i = 1; i <= 14; ++i) ids.push_back(rig.send({"mdi", "G0 X" + std::to_string(i)}));
  rig.run_for(10);
  int refused = 0;
  for (const auto id : ids) refused += rig.outcome(id).state == State::error ? 1 : 0;
  EXPECT_GT(refused, 0);
  const auto moves = rig.fake->executed<motion::LinearMove>();
  for (std::size_t i = 0; i < moves.size(); ++i)
    EXPECT_EQ(moves[i].end.x, static_cast<double>(i + 1));
  const auto& c = rig.status().commands;
  EXPECT_EQ(c.received, c.done + c.errors + c.aborted);
}

TEST(Program, jogs_stop_on_request_and_need_their_mode) {
  Rig rig;
  rig.power_on();
  rig.does({"jog", "0", "5"});
  rig.run_for(0.05);
  EXPECT_EQ(rig.fake->intent.joint_jog[0].kind, motion::JogIntent::Kind::continuous);
  EXPECT_EQ(rig.fake->intent.joint_jog[0].vel, 5);
  rig.does({"jog-stop"});
  rig.run_for(0.05);
  EXPECT_EQ(rig.fake->intent.joint_jog[0].kind, motion::JogIntent::Kind::none);
  EXPECT_THAT(rig.command({"jog", "x", "5"}).text, HasSubstr("teleop"));
  EXPECT_THAT(rig.command({"jog", "7", "5"}).text, HasSubstr("joint 7 does not exist"));
  EXPECT_THAT(rig.command({"jog", "a", "5"}).text, HasSubstr("axis 'a' does not exist"));
  rig.does({"home"});
  rig.does({"teleop", "on"});
  rig.does({"jog", "y", "-3", "12"});
  rig.run_for(0.05);
  EXPECT_EQ(rig.fake->intent.axis_jog[1].kind, motion::JogIntent::Kind::incremental);
  EXPECT_EQ(rig.fake->intent.axis_jog[1].target, -12);
}

TEST(Program, teleop_and_joint_mode_are_asked_for_in_any_idle_mode) {
  Rig rig;
  rig.power_on();
  rig.does({"home"});
  for (const char* mode : {"mdi", "auto"}) {
    for (const char* on : {"off", "on"}) {
      rig.does({"mode", mode});
      rig.does({"teleop", on});
      EXPECT_EQ(rig.status().mode, TaskMode::manual) << mode;
      EXPECT_EQ(rig.fake->intent.mode,
                std::string(on) == "on" ? motion::MotionMode::teleop : motion::MotionMode::free);
    }
  }
  rig.start_text("G1 X10 F100\nG4 P5\nM2\n");
  rig.run_for(0.1);
  EXPECT_THAT(rig.command({"teleop", "on"}).text, HasSubstr("something runs"));
  EXPECT_EQ(rig.status().mode, TaskMode::automatic);
}

TEST(Program, overriding_limits_lasts_one_jog) {
  Rig rig;
  rig.power_on();
  rig.does({"override-limits", "on"});
  rig.does({"jog", "0", "5"});
  rig.run_for(0.05);
  EXPECT_TRUE(rig.status().override_limits);
  rig.does({"jog-stop"});
  rig.run_for(0.05);
  EXPECT_FALSE(rig.status().override_limits);
}

TEST(Program, fault_of_motion_ends_the_program) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  const auto run = rig.start_text("G0 X1\nG0 X2\nM2\n");
  rig.run_for(1.5);
  rig.fake->raise(motion::Fault::following_error, 1);
  const Reply end = rig.wait(run, 0.2);
  EXPECT_EQ(end.state, State::error);
  EXPECT_THAT(end.text, HasSubstr("following error"));
  const std::string said = rig.messages();
  EXPECT_THAT(said, HasSubstr("joint 1 following error"));
  EXPECT_THAT(said, HasSubstr("test.ngc:2"));
}

TEST(Program, a_late_servo_cycle_pauses_or_is_an_estop_as_the_ini_file_says) {
  for (const bool estop : {false, true}) {
    Rig rig(std::string(kMillIni) + "[KERF]\nOVERRUN = " + (estop ? "estop" : "hold") + "\n");
    rig.ready();
    rig.fake->move_time = rtapi::kSecond;
    const auto run = rig.start_text("G0 X1\nG0 X2\nM2\n");
    rig.run_for(0.5);
    rig.fake->raise(motion::Fault::overrun, -1);
    rig.run_for(0.2);
    EXPECT_THAT(rig.messages(), HasSubstr("[KERF]OVERRUN"));
    if (estop) {
      EXPECT_EQ(rig.status().task_state, TaskState::estop);
      EXPECT_EQ(rig.wait(run, 1).state, State::aborted);
    } else {
      EXPECT_TRUE(rig.status().paused);
      EXPECT_EQ(rig.status().task_state, TaskState::on);
      rig.send({"resume"});
      EXPECT_EQ(rig.wait(run, 10).state, State::done);
    }
  }
}

TEST(Program, heartbeat_never_pauses) {
  Rig rig;
  rig.ready();
  std::uint64_t last = rig.fake->beats_seen;
  rig.start_text("G4 P2\nM2\n");
  for (int i = 0; i < 30; ++i) {
    rig.run_for(0.033);
    EXPECT_GT(rig.fake->beats_seen, last);
    last = rig.fake->beats_seen;
  }
}

TEST(Program, pause_of_nothing_is_refused) {
  Rig rig;
  rig.ready();
  EXPECT_EQ(rig.command({"pause"}).state, State::error);
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}, 1).state, State::done);
}

TEST(Program, failed_homing_says_so) {
  Rig rig;
  rig.power_on();
  rig.fake->homes = false;
  const auto home = rig.send({"home", "1"});
  rig.run_for(0.001);
  rig.fake->raise(motion::Fault::home_no_switch, 1);
  const Reply r = rig.wait(home);
  EXPECT_EQ(r.state, State::error);
  EXPECT_THAT(r.text, HasSubstr("without finding its home switch"));
  EXPECT_THAT(rig.command({"home", "3"}).text, HasSubstr("joint 3 does not exist"));
}

TEST(Program, g10_l1_changes_and_saves_the_tool_table) {
  Rig rig;
  rig.ready();
  EXPECT_EQ(rig.command({"mdi", "G10 L1 P1 Z12.5"}).state, State::done);
  EXPECT_THAT(rig.folder.read("tool.tbl"), HasSubstr("T1 P1 Z12.5 D6 ;mill"));
  EXPECT_EQ(rig.command({"mdi", "G43 H1 G0 Z0"}).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.z, 12.5);
  rig.folder.write("tool.tbl", "T1 P1 Z3\n");
  rig.does({"tool-table"});
  EXPECT_EQ(rig.command({"mdi", "G43 H1 G0 Z0"}).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.z, 3);
  rig.folder.write("tool.tbl", "T1\n");
  EXPECT_THAT(rig.command({"tool-table"}).text, HasSubstr("tool.tbl:1: no pocket number"));
}

TEST(Program, change_position_comes_before_the_change) {
  std::string ini = kMillIni;
  ini.replace(ini.find("TOOL_TABLE"), 0,
              "TOOL_CHANGE_QUILL_UP = 1\nTOOL_CHANGE_POSITION = 7 8 9\n");
  Rig rig(ini);
  rig.ready();
  EXPECT_EQ(rig.run_text("G0 X1 Z-5\nT1 M6\nG0 X2\nM2\n").state, State::done);
  const auto moves = rig.fake->executed<motion::LinearMove>();
  ASSERT_EQ(moves.size(), 4u);
  EXPECT_EQ(moves[1].end.z, 0);
  EXPECT_EQ(moves[1].kind, motion::MotionKind::tool_change);
  EXPECT_EQ(moves[2].end, (rtapi::Pose{7, 8, 9, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(moves[3].end, (rtapi::Pose{2, 8, 9, 0, 0, 0, 0, 0, 0}));
}

TEST(Program, stop_in_the_block_of_a_tool_change_keeps_the_change_position) {
  std::string ini = kMillIni;
  ini.replace(ini.find("TOOL_TABLE"), 0, "TOOL_CHANGE_POSITION = 7 8 9\n");
  Rig rig(ini);
  rig.ready();
  const auto run = rig.start_text("G0 X1 Z-5\nT1 M6 M0\nG0 X2\nM2\n");
  rig.run_for(1);
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd, (rtapi::Pose{2, 8, 9, 0, 0, 0, 0, 0, 0}));
}

TEST(Program, end_in_the_block_of_a_tool_change_keeps_the_change_position) {
  std::string ini = kMillIni;
  ini.replace(ini.find("TOOL_TABLE"), 0, "TOOL_CHANGE_POSITION = 7 8 9\n");
  Rig rig(ini);
  rig.ready();
  EXPECT_EQ(rig.run_text("G0 X1 Z-5\nT1 M6 M30\n").state, State::done);
  rig.does({"mdi", "G0 X2"});
  EXPECT_EQ(rig.fake->status.pos_cmd, (rtapi::Pose{2, 8, 9, 0, 0, 0, 0, 0, 0}));
}

TEST(Program, stop_in_the_block_of_an_input_or_a_probe_keeps_its_result) {
  Rig rig;
  rig.ready();
  rig.fake->status.digital_in = 2;
  auto run = rig.start_text("M66 P1 L0 M0\nG0 X[#5399 + 10]\nM2\n");
  rig.run_for(1);
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 11);
  rig.fake->status.probe_tripped = true;
  rig.fake->status.probed.x = 4.5;
  run = rig.start_text("G38.3 X20 F60 M0\nG0 Y#5061 Z#5070\nM2\n");
  rig.run_for(1);
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.y, 4.5);
  EXPECT_EQ(rig.fake->status.pos_cmd.z, 1);
}

TEST(Program, end_turns_off_the_coolant_that_the_operator_turned_on) {
  Rig rig;
  rig.ready();
  for (const char* end : {"M2", "M30"}) {
    rig.does({"flood", "on"});
    rig.does({"mist", "on"});
    rig.run_for(0.1);
    EXPECT_TRUE(rig.pins.out.coolant_flood && rig.pins.out.coolant_mist);
    EXPECT_EQ(rig.run_text(std::string("G0 X1\n") + end + "\n").state, State::done);
    rig.run_for(0.1);
    EXPECT_FALSE(rig.pins.out.coolant_flood || rig.pins.out.coolant_mist) << end;
  }
}

TEST(Program, m0_in_a_sub_called_from_mdi_waits) {
  Rig rig;
  rig.folder.write("subs/halt.ngc", "o<halt> sub\nG0 X1\nM0\nG0 X2\no<halt> endsub\nM2\n");
  rig.ready();
  const auto call = rig.send({"mdi", "o<halt> call"});
  rig.run_for(1);
  EXPECT_FALSE(rig.finished(call));
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 1);
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(call, 2).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 2);
}

TEST(Program, mdi_lines_behind_a_failed_one_do_not_run) {
  Rig rig;
  rig.ready();
  const auto first = rig.send({"mdi", "G0 X5"});
  const auto bad = rig.send({"mdi", "G1 X7"});
  const auto third = rig.send({"mdi", "G0 X9"});
  const auto fourth = rig.send({"mdi", "G0 Y9"});
  rig.run_for(1);
  EXPECT_EQ(rig.outcome(first).state, State::done);
  EXPECT_EQ(rig.outcome(bad).state, State::error);
  EXPECT_EQ(rig.outcome(third).state, State::aborted);
  EXPECT_EQ(rig.outcome(third).text, "an earlier MDI line failed");
  EXPECT_EQ(rig.outcome(fourth).state, State::aborted);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 5);
  EXPECT_EQ(rig.fake->status.pos_cmd.y, 0);
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
}

TEST(Program, reloaded_table_counts_for_the_tool_in_the_spindle) {
  Rig rig;
  rig.ready();
  rig.does({"mdi", "T1 M6 G43"});
  rig.folder.write("tool.tbl", "T1 P1 Z33 D6\n");
  rig.does({"tool-table"});
  rig.does({"mdi", "G43"});
  EXPECT_EQ(rig.status().tool_offset.z, 33);
  rig.folder.write("tool.tbl", "T1 P1 Z44 D6\n");
  rig.does({"mdi", "G10 L0"});
  rig.does({"mdi", "G43"});
  EXPECT_EQ(rig.status().tool_offset.z, 44);
}

TEST(Program, tool_table_is_not_changed_by_a_block_that_was_only_read) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  rig.start_text("G1 X500 F50\nG10 L1 P1 Z77\nG0 X1\nM2\n");
  rig.run_for(0.5);
  rig.does({"abort"});
  EXPECT_THAT(rig.folder.read("tool.tbl"), HasSubstr("Z10"));
  rig.fake->move_time = kMillisecond;
  EXPECT_EQ(rig.run_text("G10 L1 P1 Z55\nG43 H1\nG0 Z0\nM2\n").state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.z, 55);
  EXPECT_THAT(rig.folder.read("tool.tbl"), HasSubstr("Z55"));
}

TEST(Program, bad_startup_code_names_its_line) {
  std::string ini = kMillIni;
  ini.replace(ini.find("PARAMETER_FILE"), 0, "RS274NGC_STARTUP_CODE = G17 G999\n");
  TempFolder folder;
  folder.write("tool.tbl", "");
  const auto loaded = ini::IniFile::load(folder.write("test.ini", ini));
  const auto segment = rtapi::Segment::in_memory();
  ASSERT_TRUE(segment->make<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi).ok());
  FakePins pins;
  TaskOptions options;
  options.pins = &pins;
  options.listen = false;
  Task task(loaded.file, *segment, nullptr, options);
  const auto started = task.start();
  ASSERT_FALSE(started.ok());
  EXPECT_THAT(started.error().message(), HasSubstr("test.ini:7: [RS274NGC]RS274NGC_STARTUP_CODE"));
}

TEST(Program, task_without_motion_says_what_is_missing) {
  TempFolder folder;
  folder.write("tool.tbl", "");
  const auto loaded = ini::IniFile::load(folder.write("test.ini", kMillIni));
  const auto segment = rtapi::Segment::in_memory();
  FakePins pins;
  TaskOptions options;
  options.pins = &pins;
  options.listen = false;
  Task task(loaded.file, *segment, nullptr, options);
  const auto started = task.start();
  ASSERT_FALSE(started.ok());
  EXPECT_THAT(started.error().message(), HasSubstr("loadrt motmod"));
}

}  // namespace
}  // namespace kerf::task::testing
