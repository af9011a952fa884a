// M100 to M199 that misbehave: the machine is idle and safe, and nothing of them is left.
#include <gtest/gtest.h>
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

/// Much more than is kept of it: the tail is in the message, and neither memory nor a file holds
/// the rest. (It holds virtual time while it lives, so it must end by itself.)
TEST_F(UserCode, OneThatPrintsWithoutMeasureFillsNoMemoryAndEndsWithItsTail) {
  start({{"M151", "head -c 64000000 /dev/zero | tr '\\0' x >&2\necho its tail >&2\nexit 3\n"}});
  const auto high_water_kib = [] {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmHWM:")) return std::stol(line.substr(6));
    return 0L;
  };
  const long before = high_water_kib();
  ASSERT_GT(before, 0);
  EXPECT_EQ(m->run_text("M151\nG0 X9\nM2\n").state, task::CommandState::error);
  EXPECT_NE(m->errors().find("its tail"), std::string::npos);
  EXPECT_LT(m->errors().size(), 20000U);
  EXPECT_LT(high_water_kib() - before, 16'000);
  EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 10));
  EXPECT_FALSE(has_children());
  EXPECT_NEAR(m->joint(0), 0, 1e-9);
  EXPECT_TRUE(m->mdi("G0 X1"));
}

TEST_F(UserCode, WhatIsLeftInTheBackgroundMayGoOnPrinting) {
  start({{"M151", "(sleep 0.3; echo late >&2; touch came) &\nexit 0\n"}});
  const std::size_t before = descriptors();
  EXPECT_EQ(m->run_text("M151\nG0 X2\nM2\n").state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 2, 1e-9);
  const auto printed = [&] { return fs::exists("came") || fs::exists(m->folder() + "/came"); };
  for (int i = 0; i < 500 && !printed(); ++i) {
    m->run_for(0.01);
    ::usleep(10000);
  }
  EXPECT_TRUE(printed()) << "ended by its own words";
  fs::remove("came");
  // In this harness the pipe's end wakes nobody; the next line does.
  for (int i = 0; i < 100 && descriptors() != before; ++i) {
    EXPECT_TRUE(m->mdi("G4 P0.01"));
    ::usleep(10000);
  }
  EXPECT_EQ(descriptors(), before);
}

/// One that cannot be started at all says which of the causes it is, or what the system says.
TEST_F(UserCode, FilesThatAreNoProgramsAreNamed) {
  start({{"M151", "exit 0\n"}});
  const std::string at = m->folder() + "/";
  const auto write = [&](const char* name, const std::string& text, bool executable) {
    std::ofstream(at + name) << text;
    fs::permissions(at + name, executable ? fs::perms::owner_all : fs::perms::owner_read);
  };
  write("M160", "#!/bin/sh\nexit 0\n", false);
  write("M161", "#!/no/such/interpreter\n", true);
  write("M162",
        std::string("\x7f"
                    "ELF\0\0 nothing",
                    14),
        true);
  write("M163", "", true);
  write("M170", "#!/bin/sh\r\nexit 0\r\n", true);
  fs::create_directory(at + "M164");
  fs::create_symlink("nowhere", at + "M165");
  fs::create_symlink("M166", at + "M166");
  write("m167", "#!/bin/sh\nexit 0\n", true);
  write("M168.sh", "#!/bin/sh\nexit 0\n", true);
  struct Row {
    const char* code;
    const char* says;  ///< "" for one that runs
  };
  for (const Row& row : {Row{"M160", "not an executable file"}, Row{"M161", "/no/such/interpreter"},
                         Row{"M162", "M162"}, Row{"M170", "Windows"}, Row{"M163", ""},
                         Row{"M164", "is a directory"}, Row{"M165", "leads nowhere"},
                         Row{"M166", "Unknown m code used: M166"}, Row{"M167", "lower case"},
                         Row{"M168", "extension"}, Row{"M169", "Unknown m code used: M169"}}) {
    const auto reply = m->run_text("G0 X1\n" + std::string(row.code) + "\nG0 X9\nM2\n");
    if (*row.says == 0) {
      EXPECT_EQ(reply.state, task::CommandState::done) << row.code << reply.text;
      continue;
    }
    EXPECT_EQ(reply.state, task::CommandState::error) << row.code;
    EXPECT_NE(reply.text.find(row.says), std::string::npos) << row.code << ": " << reply.text;
    EXPECT_NE(reply.text.find("test.ngc:2"), std::string::npos) << row.code << ": " << reply.text;
    EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 5)) << row.code;
    EXPECT_NEAR(m->joint(0), 1, 1e-9) << row.code;
    EXPECT_TRUE(m->mdi("M151")) << row.code;
  }
  EXPECT_FALSE(has_children());
}

}  // namespace
}  // namespace kerf::harness
