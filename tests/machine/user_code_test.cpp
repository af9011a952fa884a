// M100 to M199 that misbehave: the machine is idle and safe, and nothing of them is left.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cerrno>
#include <filesystem>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

namespace fs = std::filesystem;

class UserCode : public testing::Test {
 protected:
  void start(const std::vector<std::pair<std::string, std::string>>& scripts) {
    MachineOptions o;
    o.replace = {{"USER_M_PATH = ", "USER_M_PATH = .:"}};
    for (const auto& [name, body] : scripts) o.files.emplace_back(name, "#!/bin/sh\n" + body);
    m = Machine::start(o);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  }
  static std::size_t descriptors() {
    std::size_t n = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator("/proc/self/fd")) ++n;
    return n;
  }
  static bool has_children() { return ::waitpid(-1, nullptr, WNOHANG) >= 0 || errno != ECHILD; }
  std::unique_ptr<Machine> m;
};

TEST_F(UserCode, AHundredInARowLeaveNothing) {
  start({{"M151", "exit 0\n"}});
  EXPECT_TRUE(m->mdi("M151"));
  const std::size_t before = descriptors();
  EXPECT_EQ(m->run_text("o1 repeat [100]\nM151 P1 Q2\no1 endrepeat\nG0 X3\nM2\n").state,
            task::CommandState::done)
      << m->errors();
  EXPECT_EQ(descriptors(), before);
  EXPECT_FALSE(has_children());
  EXPECT_NEAR(m->joint(0), 3, 1e-9);
}

TEST_F(UserCode, OneThatPrintsMegabytesOrCrashesEndsTheProgramWithItsLastWords) {
  start({{"M151", "head -c 5000000 /dev/zero | tr '\\0' x >&2\necho the end >&2\nexit 3\n"},
         {"M152", "kill -SEGV $$\n"},
         {"M153", "echo cannot >&2\nexit 1\n"}});
  EXPECT_EQ(m->run_text("M151\nG0 X9\nM2\n").state, task::CommandState::error);
  EXPECT_NE(m->errors().find("exit status 3"), std::string::npos);
  EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 10));
  EXPECT_EQ(m->run_text("M152\nG0 X9\nM2\n").state, task::CommandState::error);
  EXPECT_NE(m->errors().find("signal 11"), std::string::npos) << m->errors();
  EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 10));
  EXPECT_EQ(m->run_text("M153\nG0 X9\nM2\n").state, task::CommandState::error);
  EXPECT_NE(m->errors().find("cannot"), std::string::npos);
  EXPECT_LT(m->errors().size(), 20000U) << "nobody reads megabytes";
  EXPECT_NEAR(m->joint(0), 0, 1e-9);
  EXPECT_FALSE(has_children());
}

TEST_F(UserCode, OneThatIsDeletedWhileItRunsRunsToItsEnd) {
  start({{"M151", "rm -f -- \"$0\"\nexit 0\n"}});
  EXPECT_EQ(m->run_text("M151\nG0 X2\nM2\n").state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 2, 1e-9);
  EXPECT_EQ(m->run_text("M151\nG0 X9\nM2\n").state, task::CommandState::error);
  EXPECT_NE(m->errors().find("M151"), std::string::npos);
  EXPECT_NEAR(m->joint(0), 2, 1e-9);
}

}  // namespace
}  // namespace kerf::harness
