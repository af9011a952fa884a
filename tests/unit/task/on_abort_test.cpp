// [RS274NGC]ON_ABORT_COMMAND: runs after an abort with its reason, never at power-on, and moves nothing.
#include <gmock/gmock.h>

#include "rig.hpp"
#include "task/machine_config.hpp"

namespace kerf::task::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using State = CommandState;

std::string with_command(const std::string& keys = "ON_ABORT_COMMAND = O <on_abort> call\n") {
  std::string ini = kMillIni;
  return ini.replace(ini.find("PARAMETER_FILE"), 0, keys);
}

void write_sub(const Rig& rig, const std::string& body) {
  rig.folder.write("subs/on_abort.ngc", "o<on_abort> sub\n" + body + "o<on_abort> endsub\nM2\n");
}

TEST(OnAbort, runs_with_the_reason_and_sets_modes) {
  Rig rig(with_command());
  write_sub(rig, "(debug, reason #1)\nG90 G17\nM64 P3\n");
  rig.fake->move_time = 10 * rtapi::kSecond;
  rig.ready();
  EXPECT_THAT(rig.messages(), Not(HasSubstr("reason"))) << "not at power-on";
  const auto run = rig.start_text("G91 G18\nG0 X1\nM2\n");
  rig.run_for(1);
  rig.does({"abort"});
  EXPECT_EQ(rig.outcome(run).state, State::aborted);
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("reason 8.000000"));
  EXPECT_EQ(rig.status().g_codes[6], 900);
  EXPECT_EQ(rig.status().g_codes[3], 170);
  const auto outputs = rig.fake->executed<motion::OutputChange>();
  ASSERT_EQ(outputs.size(), 1u);
  EXPECT_EQ(outputs[0].index, 3);
}

TEST(OnAbort, never_moves_the_machine) {
  Rig rig(with_command());
  write_sub(rig, "G0 X50\nM3 S100\nG2 X1 I1\nM62 P1\n(debug, end)\n");
  rig.ready();
  EXPECT_EQ(rig.command({"mdi", "G0 X5"}).state, State::done);
  const auto moves = rig.fake->executed<motion::LinearMove>().size();
  const auto spindle = rig.fake->executed<motion::SpindleChange>().size();
  rig.does({"abort"});
  rig.run_for(2);
  EXPECT_EQ(rig.fake->executed<motion::LinearMove>().size(), moves);
  EXPECT_EQ(rig.fake->executed<motion::SpindleChange>().size(), spindle);
  const std::string messages = rig.messages();
  EXPECT_THAT(messages, HasSubstr("an abort does not move the machine"));
  EXPECT_THAT(messages, HasSubstr("an abort starts no spindle"));
  EXPECT_EQ(rig.status().m_codes[2], 5) << "and shows none that turns";
  EXPECT_EQ(rig.command({"mdi", "G91 G0 X1"}).state, State::done);
  EXPECT_NEAR(rig.fake->status.pos_cmd.x, 6, 1e-9) << "the interpreter knows where the machine is";
}

TEST(OnAbort, a_machine_that_is_off_stays_dry) {
  Rig rig(with_command());
  write_sub(rig, "M7\nM8\n");
  rig.ready();
  rig.does({"abort"});
  rig.run_for(0.1);
  EXPECT_TRUE(rig.status().flood && rig.status().mist) << "the machine is on: as it is asked for";
  for (const char* state : {"off", "estop"}) {
    rig.does({"state", state});
    rig.run_for(0.1);
    EXPECT_FALSE(rig.status().flood || rig.status().mist) << state;
    EXPECT_EQ(rig.status().m_codes[4], 9) << state;
  }
}

TEST(OnAbort, reasons_of_errors_and_states) {
  Rig rig(with_command());
  write_sub(rig, "(debug, reason #1)\n");
  rig.ready();
  EXPECT_EQ(rig.run_text("G1 X1\nM2\n").state, State::error);
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("reason 9.000000"));
  EXPECT_EQ(rig.command({"mdi", "G1 X1"}).state, State::error);
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("reason 10.000000"));
  rig.does({"state", "off"});
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("reason 4.000000"));
  rig.does({"state", "on"});
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), Not(HasSubstr("reason")));
  rig.does({"state", "estop"});
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("reason 6.000000"));
}

TEST(OnAbort, what_waits_or_does_not_end_is_left_out) {
  Rig rig(with_command());
  write_sub(rig, "(debug, one)\nM66 P0 L0\n(debug, two)\n");
  rig.ready();
  rig.does({"abort"});
  rig.run_for(0.1);
  std::string messages = rig.messages();
  EXPECT_THAT(messages, HasSubstr("one"));
  EXPECT_THAT(messages, HasSubstr("it asks to wait"));
  EXPECT_THAT(messages, Not(HasSubstr("two")));
  write_sub(rig, "o1 while [1]\no1 endwhile\n");
  rig.does({"abort"});
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("it does not end"));
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
}

int times(const std::string& text, const std::string& what) {
  int n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

/// Each abort has its run, with the machine as that abort left it; one behind another does not pile up, and one that comes while the
/// outputs of the last run are on their way voids what of them has not been done.
TEST(OnAbort, aborts_on_its_heels_run_it_again) {
  Rig rig(with_command());
  write_sub(rig, "(debug, reason #1)\nM64 P3\nM65 P3\n");
  rig.fake->move_time = 10 * rtapi::kSecond;
  rig.ready();
  const auto run = rig.start_text("G0 X1\nM2\n");
  rig.run_for(1);
  for (int n = 0; n < 5; ++n) rig.send({"abort"});
  rig.run_for(1);
  EXPECT_EQ(rig.outcome(run).state, State::aborted);
  const int runs = times(rig.messages(), "reason 8.000000");
  EXPECT_GE(runs, 1);
  EXPECT_LE(runs, 5);
  const auto outputs = rig.fake->executed<motion::OutputChange>();
  ASSERT_GE(outputs.size(), 2U);
  EXPECT_EQ(outputs.back().value, 0) << "the last run went to its end";
  EXPECT_TRUE(rig.status().idle);
  EXPECT_EQ(rig.command({"mdi", "G90 G0 X2"}).state, State::done);
}

/// A sub that is in error says so once, with its place, and is no reason to run it again.
TEST(OnAbort, its_own_error_is_said_once) {
  Rig rig(with_command());
  write_sub(rig, "(debug, begin)\nM64 P3\nG1 X1\n(debug, behind)\n");
  rig.ready();
  rig.does({"abort"});
  rig.run_for(1);
  const std::string messages = rig.messages();
  EXPECT_EQ(times(messages, "begin"), 1);
  EXPECT_EQ(times(messages, "[RS274NGC]ON_ABORT_COMMAND:"), 1);
  EXPECT_THAT(messages, HasSubstr("on_abort.ngc"));
  EXPECT_THAT(messages, Not(HasSubstr("behind")));
  EXPECT_TRUE(rig.status().idle);
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
}

/// Startup codes are for the start: an abort leaves the modes of the block, and what it should reset stands in the command.
TEST(OnAbort, comes_behind_the_modes_of_the_block_and_without_startup_codes) {
  Rig rig(
      with_command("ON_ABORT_COMMAND = O <on_abort> call\n"
                   "RS274NGC_STARTUP_CODE = G18 G91 G64 P0.5\n"));
  write_sub(rig, "(debug, plane #<_plane> distance #<_absolute>)\nG90\n");
  rig.fake->move_time = 10 * rtapi::kSecond;
  rig.ready();
  EXPECT_EQ(rig.status().g_codes[3], 180) << "of the startup code";
  EXPECT_THAT(rig.messages(), Not(HasSubstr("plane"))) << "not at the start";
  (void)rig.start_text("G19 G91 G64 P0.25\nG0 X1\nM2\n");
  rig.run_for(1);
  rig.does({"abort"});
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("plane 190.000000 distance 0.000000"));
  EXPECT_EQ(rig.status().g_codes[3], 190) << "of the block, not of the startup code";
  EXPECT_EQ(rig.status().g_codes[6], 900) << "of the command";
  EXPECT_NEAR(rig.status().settings[3], 0.25, 1e-9);
}

TEST(OnAbort, a_missing_sub_is_said) {
  Rig rig(with_command("ON_ABORT_COMMAND = O <nothing_of_this_name> call\n"));
  rig.ready();
  rig.does({"abort"});
  rig.run_for(0.1);
  EXPECT_THAT(rig.messages(), HasSubstr("ON_ABORT_COMMAND"));
  EXPECT_EQ(rig.command({"mdi", "G0 X1"}).state, State::done);
}

TEST(Remap, runs_on_the_machine) {
  Rig first;  // its folder is not ours; the sub must be there before the INI is read
  std::string ini = kMillIni;
  const std::string folder = first.folder.path;
  first.folder.write("subs/m400.ngc", "o<m400> sub\nG0 X#<p>\nM66 P0 L0\no<m400> endsub\nM2\n");
  ini.replace(
      ini.find("SUBROUTINE_PATH = subs"), 22,
      "SUBROUTINE_PATH = " + folder + "/subs\nREMAP = M400 modalgroup=10 argspec=P ngc=m400");
  Rig rig(ini);
  rig.ready();
  EXPECT_EQ(rig.run_text("M400 P5 G0 Y2\nM2\n").state, State::done) << rig.messages();
  EXPECT_NEAR(rig.fake->status.pos_cmd.x, 5, 1e-9);
  EXPECT_NEAR(rig.fake->status.pos_cmd.y, 2, 1e-9);
  EXPECT_EQ(rig.run_text("M400\nM2\n").state, State::error);
  EXPECT_THAT(rig.messages(), HasSubstr("user-defined M400: missing: P"));
}

TEST(Remap, a_bad_line_keeps_the_machine_from_starting) {
  std::string ini = kMillIni;
  ini.replace(ini.find("PARAMETER_FILE"), 0, "REMAP = M400 ngc=nothing_of_this_name\n");
  const auto loaded = ini::IniFile::parse(ini, "/m/test.ini");
  const SetupResult r = read_machine_setup(loaded.file);
  EXPECT_FALSE(r.ok);
  EXPECT_THAT(r.text(), HasSubstr("NGC file not found: ngc=nothing_of_this_name"));
}

}  // namespace
}  // namespace kerf::task::testing
