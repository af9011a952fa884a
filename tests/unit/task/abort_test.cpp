// Abort in every wait: within 100 ms, one terminal outcome, interpreter where the machine stopped.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>

#include "rig.hpp"

namespace kerf::task::testing {
namespace {

using ::testing::HasSubstr;
using State = CommandState;

struct Wait {
  const char* name;
  const char* program;
};

std::ostream& operator<<(std::ostream& out, const Wait& w) { return out << w.name; }

class AbortInWait : public ::testing::TestWithParam<Wait> {};

TEST_P(AbortInWait, ends_within_100_ms) {
  Rig rig;
  rig.folder.write("mcodes/M110", "#!/bin/sh\ntrap '' TERM\nsleep 30 &\nsleep 30\n", true);
  // Prints without end, and ends for nobody but KILL.
  rig.folder.write("mcodes/M111", "#!/bin/sh\ntrap '' TERM\nyes >&2 &\nyes\n", true);
  rig.pins.changes = false;
  rig.fake->orients = false;
  rig.fake->move_time = 10 * rtapi::kSecond;
  rig.ready();
  const auto run = rig.start_text(std::string(GetParam().program) + "\nG0 X500\nM2\n");
  // A user M-code holds time, so this looks at the state and not at the clock.
  rig.run_until([&] { return !rig.status().waiting_for.object.empty(); }, 1);
  EXPECT_FALSE(rig.finished(run));
  const double begin = rig.seconds();
  const auto abort = rig.send({"abort"});
  EXPECT_TRUE(rig.run_until(
      [&] { return rig.finished(run) && rig.finished(abort) && rig.status().idle; }, 1));
  EXPECT_LE(rig.seconds() - begin, 0.1);
  EXPECT_EQ(rig.outcome(run).state, State::aborted);
  EXPECT_EQ(rig.outcome(abort).state, State::done);
  EXPECT_EQ(rig.status().waiting_for.object.view(), "");
  EXPECT_FALSE(rig.pins.out.tool_change);
  EXPECT_FALSE(rig.pins.out.tool_prepare);
  // Nothing of a user M-code lives on, nor does it wait to be buried.
  int left = 0;
  EXPECT_TRUE(::waitpid(-1, &left, WNOHANG) < 0 && errno == ECHILD);
  EXPECT_GT(rig.fake->spindle_stops, 0u);
  const auto moves = rig.fake->done.size();
  rig.run_for(1);
  EXPECT_EQ(rig.fake->done.size(), moves) << "nothing of the program goes on";
  rig.fake->move_time = kMillisecond;
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
  const auto& c = rig.status().commands;
  EXPECT_EQ(c.received, c.done + c.errors + c.aborted);
}

INSTANTIATE_TEST_SUITE_P(All, AbortInWait,
                         ::testing::Values(Wait{"motion", "G0 X1"}, Wait{"dwell", "G4 P20"},
                                           Wait{"m0", "M0"}, Wait{"m66", "M66 P0 L3 Q20"},
                                           Wait{"tool_change", "T1 M6"}, Wait{"user_mcode", "M110"},
                                           Wait{"user_mcode_that_prints", "M111"},
                                           Wait{"orient", "M19 R90 Q20"}),
                         [](const auto& p) { return std::string(p.param.name); });

TEST(Abort, endless_loop_lets_time_pass_and_ends) {
  Rig rig;
  rig.ready();
  const auto run = rig.start_text("o1 while [1]\n#1 = [#1 + 1]\no1 endwhile\nM2\n");
  rig.run_for(0.2);
  EXPECT_FALSE(rig.finished(run));
  rig.does({"abort"});
  EXPECT_EQ(rig.outcome(run).state, State::aborted);
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
}

TEST(Abort, full_queue_is_dropped) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  std::string text = "F600\n";
  for (int i = 1; i <= 3000; ++i) text += "G1 X" + std::to_string(i) + "\n";
  const auto run = rig.start_text(text + "M2\n");
  rig.run_for(2.5);
  EXPECT_EQ(rig.shared->path.size(), motion::PathRing::capacity());
  rig.does({"abort"});
  EXPECT_EQ(rig.outcome(run).state, State::aborted);
  rig.run_for(0.1);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 2);
  rig.fake->move_time = kMillisecond;
  rig.does({"mdi", "G91 G0 X1"});
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 3) << "increments count from where the machine stopped";
}

TEST(Abort, interpreter_returns_to_the_state_of_the_stopped_block) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  rig.start_text("G21 G90 G54\nG0 X10\nG91\nG0 X10\nG20 G55 F100\nG0 X1\nG18\nG1 Z1\nM2\n");
  rig.run_for(1.5);  // in the middle of line 4
  EXPECT_EQ(rig.status().current_line, 4);
  rig.does({"abort"});
  rig.run_for(0.1);
  const TaskStatus s = rig.status();
  EXPECT_EQ(s.g5x_index, 1) << "G55 was read, not reached";
  EXPECT_EQ(s.program_units, 2);
  EXPECT_EQ(s.g_codes[6], 910) << "G91 of line 3 is in force at line 4";
  EXPECT_EQ(s.g_codes[3], 170);
}

TEST(Abort, restoring_issues_no_outputs) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  rig.start_text("M3 S500 M8\nM62 P0\nG0 X10\nG0 X20\nM2\n");
  rig.run_for(1.5);
  EXPECT_TRUE(rig.pins.out.coolant_flood);
  rig.does({"abort"});
  rig.run_for(1);
  EXPECT_FALSE(rig.pins.out.coolant_flood);
  EXPECT_TRUE(rig.shared->path.empty());
  const auto before = rig.fake->done.size();
  rig.fake->move_time = kMillisecond;
  rig.does({"mdi", "G0 X1"});
  for (std::size_t i = before; i < rig.fake->done.size(); ++i) {
    const auto& body = rig.fake->done[i].body;
    EXPECT_FALSE(std::holds_alternative<motion::SpindleChange>(body) ||
                 std::holds_alternative<motion::OutputChange>(body));
  }
}

TEST(Abort, commands_sent_behind_it_are_carried_out) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  const auto first = rig.send({"mdi", "G0 X100"});
  const auto second = rig.send({"mdi", "G0 X200"});
  rig.run_for(0.3);
  const auto abort = rig.send({"abort"});
  const auto third = rig.send({"mdi", "G0 X5"});
  rig.run_for(3);
  EXPECT_EQ(rig.outcome(first).state, State::aborted);
  EXPECT_EQ(rig.outcome(second).state, State::aborted);
  EXPECT_EQ(rig.outcome(abort).state, State::done);
  EXPECT_EQ(rig.outcome(third).state, State::done);
  EXPECT_EQ(rig.fake->status.pos_cmd.x, 5);
}

TEST(Abort, works_in_pause_and_twice) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  const auto run = rig.start_text("G0 X10\nG0 X20\nM2\n");
  rig.run_for(0.5);
  rig.does({"pause"});
  const auto a = rig.send({"abort"});
  const auto b = rig.send({"abort"});
  rig.run_for(0.1);
  EXPECT_EQ(rig.outcome(run).state, State::aborted);
  EXPECT_TRUE(rig.finished(a) && rig.finished(b));
  EXPECT_EQ(rig.shared->intent.hold.get(), 0u);
  EXPECT_FALSE(rig.status().paused);
}

TEST(Abort, estop_ends_everything_at_once) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  const auto run = rig.start_text("M8\nG0 X10\nG0 X20\nM2\n");
  rig.run_for(0.5);
  const auto estop = rig.send({"state", "estop"});
  rig.run_for(0.001);
  EXPECT_EQ(rig.shared->intent.enable.get(), 0u);
  EXPECT_EQ(rig.status().task_state, TaskState::estop);
  rig.run_for(0.1);
  EXPECT_EQ(rig.outcome(run).state, State::aborted);
  EXPECT_EQ(rig.outcome(estop).state, State::done);
  EXPECT_FALSE(rig.pins.out.coolant_flood);
  EXPECT_FALSE(rig.pins.out.user_enable_out);
}

TEST(Abort, tool_change_that_was_aborted_is_made_by_the_next_m6) {
  Rig rig;
  rig.ready();
  rig.pins.changes = false;
  rig.send({"mdi", "T2 M6"});
  rig.run_for(0.5);
  EXPECT_TRUE(rig.pins.out.tool_change);
  rig.does({"abort"});
  rig.pins.changes = true;
  rig.does({"mdi", "M6"});
  EXPECT_EQ(rig.status().tool_in_spindle, 2);
  rig.does({"mdi", "M61 Q1"});
  rig.does({"mdi", "M6"});
  EXPECT_EQ(rig.status().tool_in_spindle, 1) << "M61 said so, and no T came since";
}

TEST(Abort, length_offset_is_not_that_of_a_tool_that_did_not_come) {
  Rig rig;
  rig.ready();
  rig.does({"mdi", "T1 M6 G43"});
  EXPECT_EQ(rig.status().tool_offset.z, 10);
  rig.pins.changes = false;
  rig.send({"mdi", "T2 M6 G43"});
  rig.run_for(0.5);
  EXPECT_TRUE(rig.pins.out.tool_change);
  rig.does({"abort"});
  rig.run_for(0.1);
  EXPECT_EQ(rig.status().tool_in_spindle, 1);
  EXPECT_EQ(rig.status().tool_offset.z, 10);
  rig.does({"mdi", "G0 Z0"});
  EXPECT_EQ(rig.fake->status.pos_cmd.z, 10);
}

TEST(Abort, shutdown_saves_no_offset_that_was_only_read) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  rig.start_text("G0 X10\nG0 X20\nG55\nG92 X3\nG0 X1\nM2\n");
  rig.run_for(0.5);
  rig.stop();
  EXPECT_THAT(rig.folder.read("test.var"), HasSubstr("5220\t1.0"));
  EXPECT_THAT(rig.folder.read("test.var"), HasSubstr("5210\t0.0"));
}

TEST(Abort, g64_survives_and_is_announced_again) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  rig.start_text("G64 P0.25\nG0 X10\nG61.1\nG0 X20\nM2\n");
  rig.run_for(0.5);
  rig.does({"abort"});
  const auto before = rig.fake->done.size();
  rig.fake->move_time = kMillisecond;
  rig.does({"mdi", "G0 X1"});
  bool found = false;
  for (std::size_t i = before; i < rig.fake->done.size(); ++i)
    if (const auto* control = std::get_if<motion::PathControl>(&rig.fake->done[i].body)) {
      found = true;
      EXPECT_EQ(control->mode, motion::PathControl::Mode::continuous);
      EXPECT_DOUBLE_EQ(control->tolerance_mm, 0.25);
    }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace kerf::task::testing
