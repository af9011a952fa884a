// The INI file as task reads it, and its complaints.
#include <gmock/gmock.h>

#include <unistd.h>

#include <fstream>
#include <string>

#include "io/tool_table.hpp"
#include "rig.hpp"
#include "task/machine_config.hpp"
#include "task/position_file.hpp"
#include "task/screw_file.hpp"

namespace kerf::task::testing {
namespace {

using ::testing::HasSubstr;

SetupResult read(const std::string& text) {
  const auto loaded = ini::IniFile::parse(text, "/m/test.ini");
  EXPECT_TRUE(loaded.ok);
  return read_machine_setup(loaded.file);
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = kMillIni;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Config, reads_a_plain_mill) {
  const auto r = read(kMillIni);
  ASSERT_TRUE(r.ok) << r.text();
  EXPECT_EQ(r.setup.motion.joints, 3);
  EXPECT_EQ(r.setup.motion.axis_mask, 7u);
  EXPECT_DOUBLE_EQ(r.setup.motion.joint[2].max_vel, 30);
  EXPECT_EQ(r.setup.paths.program_prefix, "/m/nc");
  EXPECT_EQ(r.setup.paths.parameter_file, "/m/test.var");
  EXPECT_DOUBLE_EQ(r.setup.motion.max_feed_override, 1.5);
  EXPECT_EQ(r.text(), "");
}

TEST(Config, screw_files_of_both_types_become_corrections) {
  const std::string path = ::testing::TempDir() + "screw" + std::to_string(::getpid()) + ".comp";
  const auto table = [&](const std::string& text, int type, motion::ScrewTable& out) {
    std::ofstream(path) << text;
    return read_screw_file(path, static_cast<ScrewFileType>(type), 25.4, out);
  };
  motion::ScrewTable t;
  // The manual's examples, in inches.
  EXPECT_EQ(table("-1.000 -1.005 -0.995\n0.000 0.002 -0.003\n\n# end\n1.000 1.003 0.998\n", 0, t),
            "");
  EXPECT_EQ(t.count, 3);
  EXPECT_NEAR(motion::screw_correction(t, -25.4, 1), 0.005 * 25.4, 1e-12);
  EXPECT_NEAR(motion::screw_correction(t, 25.4, -1), 0.002 * 25.4, 1e-12);
  EXPECT_NEAR(motion::screw_correction(t, 12.7, 1), -0.0025 * 25.4, 1e-12);
  EXPECT_NEAR(motion::screw_correction(t, 99, 1), -0.003 * 25.4, 1e-12) << "beyond the end";
  EXPECT_EQ(table("-1.000 0.005 -0.005\n0.000 0.002 -0.003\n", 1, t), "");
  EXPECT_NEAR(motion::screw_correction(t, 0, -1), -0.003 * 25.4, 1e-12);
  EXPECT_EQ(motion::screw_correction(t, 0, 0), 0);
  const auto wrong = [&](const std::string& text, const char* what) {
    EXPECT_THAT(table(text, 0, t), HasSubstr(what)) << text;
    EXPECT_EQ(t.count, 0);
  };
  wrong("0 0 0\n1 1\n", ".comp:2: expected three numbers");
  wrong("0 0 0 0\n", "found more");
  wrong("0 0 zero\n", "'zero' is no number");
  wrong("0 0 nan\n", "no number");
  wrong("1 1 1\n1 1 1\n", "ascend");
  wrong("# nothing\n", "no points");
  std::string many;
  for (int i = 0; i < 257; ++i) many += std::to_string(i) + " 0 0\n";
  wrong(many, ":257: more than 256");
  ::unlink(path.c_str());
  EXPECT_THAT(
      read(with("[JOINT_0]\n", "[JOINT_0]\nCOMP_FILE = gone.comp\nCOMP_FILE_TYPE = 0\n")).text(),
      HasSubstr("cannot open /m/gone.comp"));
}

TEST(Config, inches_become_millimetres) {
  const auto r = read(with("LINEAR_UNITS = mm", "LINEAR_UNITS = inch"));
  ASSERT_TRUE(r.ok) << r.text();
  EXPECT_DOUBLE_EQ(r.setup.motion.joint[0].max_acc, 500 * 25.4);
  EXPECT_DOUBLE_EQ(r.setup.motion.traj_max_vel_mm_s, 50 * 25.4);
  EXPECT_DOUBLE_EQ(r.setup.motion.joint[0].max_limit, 1e99) << "no limit has no unit";
}

TEST(Config, all_complaints_at_once_each_with_its_line) {
  std::string text = with("MAX_VELOCITY = 50\nMAX_ACCELERATION = 500\n[AXIS_Y]",
                          "MAX_VELOCITYY = 50\nMAX_ACCELERATION = fast\n[AXIS_Y]");
  const auto r = read(text);
  EXPECT_FALSE(r.ok);
  EXPECT_THAT(r.text(), HasSubstr("[AXIS_X]"));
  EXPECT_THAT(r.text(), HasSubstr("[AXIS_X]MAX_VELOCITY: is not given"));
  EXPECT_THAT(r.text(), HasSubstr("fast"));
  EXPECT_THAT(r.text(), HasSubstr("test.ini:"));
}

TEST(Config, speeds_that_are_not_given_are_the_defaults_with_a_warning) {
  const auto r = read(with("MAX_VELOCITY = 50\nMAX_ACCELERATION = 500\n[AXIS_Y]",
                           "MAX_ACCELERATION = 500\n[AXIS_Y]"));
  EXPECT_TRUE(r.ok) << r.text();
  EXPECT_DOUBLE_EQ(r.setup.motion.axis[0].max_vel, 1);
  EXPECT_THAT(r.text(), HasSubstr("warning: [AXIS_X]MAX_VELOCITY: is not given: 1 is used"));
}

TEST(PositionFile, keeps_where_the_joints_were) {
  const std::string file = ::testing::TempDir() + "positions_" + std::to_string(::getpid());
  MachineSetup setup;
  setup.motion.joints = 2;
  setup.joint_unit = {25.4, 1};
  EXPECT_TRUE(load_positions(file, setup).ok()) << "no file yet";
  EXPECT_FALSE(setup.motion.joint[0].has_start);
  motion::MotionStatus status;
  status.joint[0].pos_fb = 12.7;
  status.joint[1].pos_fb = -1.0 / 3.0;
  ASSERT_TRUE(save_positions(file, setup, status).ok());
  EXPECT_EQ(*io::read_file(file), "0.50000000000000000\n-0.33333333333333331\n");
  ASSERT_TRUE(load_positions(file, setup).ok());
  EXPECT_TRUE(setup.motion.joint[0].has_start);
  EXPECT_DOUBLE_EQ(setup.motion.joint[0].start, 12.7);
  EXPECT_DOUBLE_EQ(setup.motion.joint[1].start, -1.0 / 3.0);

  MachineSetup other;
  other.motion.joints = 2;
  for (const char* bad : {"1\n", "1\nx\n", "", "1 nan\n"}) {
    ASSERT_TRUE(io::write_file_whole(file, bad).ok());
    const auto loaded = load_positions(file, other);
    ASSERT_FALSE(loaded.ok()) << bad;
    EXPECT_THAT(loaded.error().message(), HasSubstr("position of each of 2 joints"));
    EXPECT_FALSE(other.motion.joint[0].has_start);
  }
  ::unlink(file.c_str());
}

TEST(Config, limits_must_make_sense) {
  EXPECT_THAT(read(with("[JOINT_1]\n", "[JOINT_1]\nMIN_LIMIT = 10\nMAX_LIMIT = -10\n")).text(),
              HasSubstr("is not below MAX_LIMIT"));
  EXPECT_THAT(read(with("[JOINT_1]\n", "[JOINT_1]\nMAX_LIMIT = 10\n")).text(),
              HasSubstr("[AXIS_Y]MAX_LIMIT"));
  EXPECT_THAT(read(with("[JOINT_0]\n", "[JOINT_0]\nHOME_SEARCH_VEL = 5\n")).text(),
              HasSubstr("HOME_LATCH_VEL"));
  EXPECT_THAT(read(with("[JOINT_0]\n", "[JOINT_0]\nHOME_LATCH_VEL = 5\n")).text(),
              HasSubstr("neither a switch"));
  EXPECT_THAT(read(with("[JOINT_0]\n", "[JOINT_0]\nHOME_USE_INDEX = YES\n")).text(),
              HasSubstr("speed towards the index"));
  EXPECT_THAT(read(with("[JOINT_0]\n", "[JOINT_0]\nHOME_SEQUENCE = 3\n")).text(),
              HasSubstr("no joint has "));
  EXPECT_THAT(read(with("COORDINATES = X Y Z", "COORDINATES = X Y Q")).text(),
              HasSubstr("'Q' is no axis"));
  EXPECT_THAT(read(with("TOOL_TABLE", "TOOL_CHANGE_POSITION = 0 0\nTOOL_TABLE")).text(),
              HasSubstr("3, 6 or 9 numbers"));
}

}  // namespace
}  // namespace kerf::task::testing
