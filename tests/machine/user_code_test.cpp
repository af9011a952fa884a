// M100 to M199 that misbehave: the machine is idle and safe, and nothing of them is left.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

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
  /// Gone, or dead and only waiting for init.
  static bool gone(pid_t pid) {
    for (int i = 0; i < 100; ++i) {
      if (::kill(pid, 0) != 0) return true;
      std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
      std::string word, state;
      stat >> word >> word >> state;
      if (state == "Z") return true;
      ::usleep(20000);
    }
    return false;
  }
  pid_t number_in(const std::string& name) const {
    std::ifstream in(m->folder() + "/" + name);
    pid_t pid = 0;
    in >> pid;
    return pid;
  }
  std::unique_ptr<Machine> m;
};

TEST_F(UserCode, OneThatSleepsForEverIsEndedWithAllItsChildren) {
  start({{"M151",
          "cd \"$(dirname \"$0\")\"\ntrap '' TERM\n(trap '' TERM; sleep 1000) &\necho $! >child\n"
          "echo $$ >parent\nwait\n"}});
  const auto run = m->start_program(m->write_program("S500 M3\nG1 X5 F600\nM151\nG0 X50\nM2\n"));
  EXPECT_TRUE(m->run_until([&] { return number_in("parent") > 0; }, 600));
  EXPECT_FALSE(task::is_terminal(m->outcome(run).state));
  m->send({"abort"});
  EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 10));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::aborted);
  EXPECT_TRUE(gone(number_in("parent")));
  EXPECT_TRUE(gone(number_in("child")));
  EXPECT_NEAR(m->joint(0), 5, 1e-9);
  EXPECT_FALSE(m->bit("spindle.0.on"));
  EXPECT_TRUE(m->mdi("G0 X1")) << m->errors();
}

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
