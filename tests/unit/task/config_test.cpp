// The INI file as task reads it, and its complaints.
#include <gmock/gmock.h>

#include "rig.hpp"
#include "task/machine_config.hpp"

namespace kerf::task::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_THAT(r.text(), HasSubstr("MAX_VELOCITYY"));
  EXPECT_THAT(r.text(), HasSubstr("fast"));
  EXPECT_THAT(r.text(), HasSubstr("test.ini:"));
}

TEST(Config, limits_must_make_sense) {
  EXPECT_THAT(read(with("[JOINT_1]\n", "[JOINT_1]\nMIN_LIMIT = 10\nMAX_LIMIT = -10\n")).text(),
              HasSubstr("is not below MAX_LIMIT"));
  EXPECT_THAT(read(with("[JOINT_1]\n", "[JOINT_1]\nMAX_LIMIT = 10\n")).text(),
              HasSubstr("[AXIS_Y]MAX_LIMIT"));
  EXPECT_THAT(read(with("[JOINT_0]\n", "[JOINT_0]\nHOME_SEARCH_VEL = 5\n")).text(),
              HasSubstr("HOME_LATCH_VEL"));
  EXPECT_THAT(read(with("COORDINATES = X Y Z", "COORDINATES = X Y Q")).text(),
              HasSubstr("'Q' is no axis"));
  EXPECT_THAT(read(with("TOOL_TABLE", "TOOL_CHANGE_POSITION = 0 0\nTOOL_TABLE")).text(),
              HasSubstr("3, 6 or 9 numbers"));
}

TEST(Config, unknown_keys_are_warned_of_unless_hal_uses_them) {
  const auto r = read(with("[JOINT_0]\n", "[JOINT_0]\nHOME_SERCH_VEL = 5\nMY_SCALE = 3\n") +
                      "[HAL]\nHALCMD = setp a.b [JOINT_0]MY_SCALE\n");
  EXPECT_TRUE(r.ok);
  EXPECT_THAT(r.text(), HasSubstr("HOME_SEARCH_VEL"));
  EXPECT_THAT(r.text(), Not(HasSubstr("MY_SCALE")));
}

}  // namespace
}  // namespace kerf::task::testing
