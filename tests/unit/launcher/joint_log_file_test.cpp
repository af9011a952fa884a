#include "launcher/joint_log_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "samples.hpp"

namespace kerf::launcher {
namespace {

TEST(JointLogFile, NumbersComeBackExactly) {
  auto s = test::sample(1234, 0.1 + 0.2, -1e-17, 1.0 / 3);
  std::istringstream line(joint_log_line(s));
  std::string word;
  line >> word;
  EXPECT_EQ(word, "1234000000");
  for (int i = 0; i < 3; ++i) {
    line >> word;
    EXPECT_EQ(std::strtod(word.c_str(), nullptr), s.joint[i]);
  }
  EXPECT_FALSE(line >> word);
}

TEST(JointLogFile, HeaderNamesTheColumns) {
  const std::string head = joint_log_header(2);
  EXPECT_NE(head.find("# time joint.0 joint.1\n"), std::string::npos);
  EXPECT_EQ(head[0], '#');
}

TEST(JointLogFile, BeginsWhenThereAreJoints) {
  const std::string path = testing::TempDir() + "joint_log_file_test.log";
  JointLogFile file;
  ASSERT_TRUE(file.open(path).ok());
  auto s = test::sample(1, 0);
  s.joints = 0;
  file.add(s);
  file.add(test::sample(2, 5));
  ASSERT_TRUE(file.close().ok());
  std::ifstream in(path);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_EQ(text, joint_log_header(3) + "2000000 5 0 0\n");
}

TEST(JointLogFile, AFileThatCannotBeMadeIsNamed) {
  JointLogFile file;
  const auto status = file.open("/nonexistent/dir/a.log");
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message().find("/nonexistent/dir/a.log"), std::string::npos);
}

}  // namespace
}  // namespace kerf::launcher
