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
  EXPECT_THAT(rig.messages(), HasSubstr("an abort does not move the machine"));
  EXPECT_EQ(rig.command({"mdi", "G91 G0 X1"}).state, State::done);
  EXPECT_NEAR(rig.fake->status.pos_cmd.x, 6, 1e-9) << "the interpreter knows where the machine is";
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
