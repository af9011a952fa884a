// M100-M199: found, run, waited for, refused. Manual: "User Defined Commands M100-M199".
#include <gmock/gmock.h>

#include <filesystem>
#include <utility>

#include "rig.hpp"
#include "task/interpreter/task_environment.hpp"

namespace kerf::task::testing {
namespace {

using ::testing::HasSubstr;
using State = CommandState;

TEST(UserMcode, passes_p_and_q_as_text_and_the_place) {
  Rig rig;
  rig.folder.write(
      "nc/M101",
      "#!/bin/sh\necho \"$1|$2|$KERF_LINE|$KERF_X|$KERF_STATE|$(basename $KERF_FILE)\" >> " +
          rig.folder.path + "/log\n",
      true);
  rig.ready();
  EXPECT_EQ(rig.run_text("G0 X12.5\nM101 P123.456 Q-2\nM101\nM2\n").state, State::done);
  EXPECT_EQ(rig.folder.read("log"),
            "123.456000|-2.000000|2|12.500000|auto|test.ngc\n-1.000000|-1.000000|3|12.500000|auto|"
            "test.ngc\n");
}

TEST(UserMcode, motion_before_it_is_done_and_behind_it_waits_at_no_virtual_time) {
  Rig rig;
  rig.folder.write("nc/M102", "#!/bin/sh\nsleep 0.3\nexit 0\n", true);
  rig.ready();
  const double begin = rig.seconds();
  const auto run = rig.start_text("G0 X1\nM102\nG0 X2\nM2\n");
  EXPECT_EQ(rig.wait(run).state, State::done);
  EXPECT_LT(rig.seconds() - begin, 0.2) << "the program outside costs no time of the machine";
  EXPECT_EQ(rig.fake->executed<motion::LinearMove>().size(), 2u);
}

TEST(UserMcode, exit_status_stops_the_program_with_the_script_s_words) {
  Rig rig;
  rig.folder.write("nc/M103", "#!/bin/sh\necho 'no air pressure' >&2\nexit 3\n", true);
  rig.ready();
  const Reply r = rig.run_text("M103\nG0 X1\nM2\n");
  EXPECT_EQ(r.state, State::error);
  EXPECT_THAT(r.text, HasSubstr("exit status 3"));
  EXPECT_THAT(r.text, HasSubstr("no air pressure"));
  EXPECT_THAT(r.text, HasSubstr("test.ngc:1"));
  EXPECT_EQ(rig.fake->executed<motion::LinearMove>().size(), 0u);
}

TEST(UserMcode, what_it_leaves_in_the_background_does_not_hold_the_program) {
  Rig rig;
  rig.folder.write("nc/M104", "#!/bin/sh\nsleep 2 &\nexit 0\n", true);
  rig.ready();
  EXPECT_EQ(rig.run_text("M104\nG0 X1\nM2\n").state, State::done);
}

TEST(UserMcode, any_executable_file_will_do) {
  Rig rig;
  std::filesystem::create_directories(rig.folder.path + "/mcodes");
  for (const auto& [name, program] :
       {std::pair{"M150", "/bin/true"}, std::pair{"M151", "/bin/false"}})
    std::filesystem::copy_file(program, rig.folder.path + "/mcodes/" + name);
  rig.ready();
  EXPECT_EQ(rig.run_text("M150\nG0 X1\nM2\n").state, State::done);
  EXPECT_EQ(rig.run_text("M151\nG0 X2\nM2\n").state, State::error);
}

TEST(UserMcode, holds_the_program_until_it_ends) {
  // A program that shows a window ends when the window is closed.
  Rig rig;
  const std::string mark = rig.folder.path + "/mark";
  rig.folder.write("nc/M107", "#!/bin/sh\nsleep 0.2\ntouch " + mark + "\n", true);
  rig.folder.write("nc/M108", "#!/bin/sh\ntest -e " + mark + "\n", true);
  rig.ready();
  EXPECT_EQ(rig.run_text("M107\nM108\nM2\n").state, State::done);
}

TEST(UserMcode, added_while_the_machine_runs_is_found) {
  Rig rig;
  rig.ready();
  EXPECT_THAT(rig.command({"mdi", "M105"}).text, HasSubstr("does not exist"));
  rig.folder.write("mcodes/M105", "#!/bin/sh\nexit 0\n", true);
  EXPECT_EQ(rig.command({"mdi", "M105"}).state, State::done);
}

TEST(UserMcode, script_without_interpreter_line_runs_in_the_shell) {
  Rig rig;
  rig.folder.write("nc/M106", "exit 0\n", true);
  rig.ready();
  EXPECT_EQ(rig.command({"mdi", "M106"}).state, State::done);
}

TEST(UserMcode, search_order_and_the_five_causes) {
  TempFolder folder;
  ProgramPaths paths;
  paths.program_prefix = folder.path + "/prefix";
  paths.user_m_path = {folder.path + "/m1", folder.path + "/m2"};
  paths.subroutine_path = {folder.path + "/subs"};
  for (const char* where : {"prefix", "m1", "m2", "subs"})
    folder.write(std::string(where) + "/keep", "");
  EXPECT_THAT(find_user_mcode(paths, 110).cause, HasSubstr("does not exist"));
  const auto in_subs = folder.write("subs/M110", "", true);
  EXPECT_EQ(find_user_mcode(paths, 110).path, in_subs);
  const auto in_m2 = folder.write("m2/M110", "", true);
  EXPECT_EQ(find_user_mcode(paths, 110).path, in_m2);
  const auto in_prefix = folder.write("prefix/M110", "", true);
  EXPECT_EQ(find_user_mcode(paths, 110).path, in_prefix);
  folder.write("m1/M111", "", false);
  EXPECT_THAT(find_user_mcode(paths, 111).cause, HasSubstr("not an executable file"));
  folder.write("m1/M112.sh", "", true);
  EXPECT_THAT(find_user_mcode(paths, 112).cause, HasSubstr("has an extension"));
  folder.write("m1/m113", "", true);
  EXPECT_THAT(find_user_mcode(paths, 113).cause, HasSubstr("lower case m"));
  EXPECT_THAT(find_user_mcode(paths, 99).cause, HasSubstr("not M100 to M199"));
  // One that cannot run does not hide one that can.
  folder.write("prefix/M114", "", false);
  const auto good = folder.write("subs/M114", "", true);
  EXPECT_EQ(find_user_mcode(paths, 114).path, good);
}

}  // namespace
}  // namespace kerf::task::testing
