#include "launcher/process.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstdlib>

#include "launcher/environment.hpp"
#include "launcher/guard.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {
namespace {

using rtapi::end_processes_of_run;
using rtapi::processes_of_run;

/// Waits up to two seconds.
template <class F>
bool soon(F&& done) {
  for (int i = 0; i < 400; ++i) {
    if (done()) return true;
    pause_ms(5);
  }
  return done();
}

std::string run_name(const char* test) {
  return std::string(test) + "-" + std::to_string(getpid());
}

TEST(Child, TellsHowItEnded) {
  auto child = Child::start({"sh", "-c", "exit 3"});
  ASSERT_TRUE(child.ok());
  ASSERT_TRUE(soon([&] { return !child->running(); }));
  EXPECT_EQ(describe_exit(*child->poll_exit()), "ended with exit code 3");

  auto killed = Child::start({"sleep", "60"});
  ASSERT_TRUE(killed.ok());
  EXPECT_TRUE(killed->running());
  EXPECT_EQ(killed->name(), "sleep");
  killed->signal(SIGKILL);
  ASSERT_TRUE(soon([&] { return !killed->running(); }));
  EXPECT_EQ(describe_exit(*killed->poll_exit()), "was killed by signal 9 (Killed)");
}

TEST(Child, AProgramThatIsNotThereIsAnError) {
  const auto child = Child::start({"no-such-program-here"});
  ASSERT_FALSE(child.ok());
  EXPECT_NE(child.error().message().find("no-such-program-here"), std::string::npos);
}

TEST(Child, HasNoTerminalAndAGroupOfItsOwn) {
  auto child = Child::start(
      {"sh", "-c", "read x && exit 1; [ $(cut -d' ' -f5 /proc/$$/stat) = $$ ] || exit 2"});
  ASSERT_TRUE(child.ok());
  ASSERT_TRUE(soon([&] { return !child->running(); }));
  EXPECT_EQ(child->poll_exit()->number, 0);
}

TEST(Run, StubbornProcessesAndTheirChildrenAreEnded) {
  const std::string run = run_name("stubborn");
  setenv("KERF_RUN_ID", run.c_str(), 1);
  auto polite = Child::start({"sleep", "60"});
  auto stubborn = Child::start({"sh", "-c", "trap '' TERM; sleep 60 & sleep 61"});
  unsetenv("KERF_RUN_ID");
  auto stranger = Child::start({"sleep", "60"});
  ASSERT_TRUE(polite.ok() && stubborn.ok() && stranger.ok());
  ASSERT_TRUE(soon([&] { return processes_of_run(run).size() >= 4; }));
  const auto killed = end_processes_of_run(run, 100);
  EXPECT_TRUE(processes_of_run(run).empty());
  EXPECT_GE(killed.size(), 1U);
  EXPECT_TRUE(stranger->running());
  stranger->signal(SIGKILL);
}

TEST(Run, AnIdThatOnlyBeginsTheSameIsAnother) {
  setenv("KERF_RUN_ID", (run_name("prefix") + "9").c_str(), 1);
  auto child = Child::start({"sleep", "60"});
  unsetenv("KERF_RUN_ID");
  ASSERT_TRUE(child.ok());
  pause_ms(20);
  EXPECT_TRUE(processes_of_run(run_name("prefix")).empty());
  EXPECT_EQ(processes_of_run(run_name("prefix") + "9").size(), 1U);
  child->signal(SIGKILL);
}

/// A launcher that is killed, as a process of its own.
TEST(Guard, CleansUpAfterALauncherThatWasKilled) {
  const std::string instance = "guardtest" + std::to_string(getpid());
  int report[2];
  ASSERT_EQ(pipe(report), 0);
  const pid_t launcher = fork();
  if (launcher == 0) {
    auto segment = rtapi::Segment::create(instance, std::size_t{1} << 24U);
    if (!segment.ok()) _exit(1);
    const std::string run((*segment)->header().run_id.view());
    Guard guard;
    if (!guard.start(instance, run, -1, {}, {}).ok()) _exit(1);
    setenv("KERF_RUN_ID", run.c_str(), 1);
    auto child = Child::start({"sh", "-c", "trap '' TERM; sleep 60"});
    const pid_t pids[2] = {child.ok() ? child->pid() : -1, guard.pid()};
    (void)!write(report[1], pids, sizeof pids);
    pause();
  }
  pid_t pids[2] = {-1, -1};
  ASSERT_EQ(read(report[0], pids, sizeof pids), static_cast<ssize_t>(sizeof pids));
  ASSERT_GT(pids[0], 0);
  EXPECT_EQ(access(("/dev/shm" + rtapi::segment_name(instance)).c_str(), F_OK), 0);
  kill(launcher, SIGKILL);
  EXPECT_TRUE(soon([&] { return !rtapi::process_lives(pids[0], 0); }));
  EXPECT_TRUE(soon([&] { return !rtapi::process_lives(pids[1], 0); }));
  EXPECT_NE(access(("/dev/shm" + rtapi::segment_name(instance)).c_str(), F_OK), 0);
  close(report[0]);
  close(report[1]);
}

TEST(Guard, LeavesEverythingAloneAfterRelease) {
  const std::string run = run_name("release");
  setenv("KERF_RUN_ID", run.c_str(), 1);
  auto child = Child::start({"sleep", "60"});
  unsetenv("KERF_RUN_ID");
  ASSERT_TRUE(child.ok());
  Guard guard;
  ASSERT_TRUE(guard.start("no-such-instance", run, -1, {}, {}).ok());
  guard.release();
  EXPECT_FALSE(rtapi::process_lives(guard.pid(), 0));
  EXPECT_TRUE(child->running());
  child->signal(SIGKILL);
}

TEST(Environment, PrependsOnce) {
  setenv("KERF_TEST_PATH", "/a:/b", 1);
  prepend_variable("KERF_TEST_PATH", "/x", ':');
  prepend_variable("KERF_TEST_PATH", "/x", ':');
  EXPECT_STREQ(getenv("KERF_TEST_PATH"), "/x:/a:/b");
  unsetenv("KERF_TEST_PATH");
  prepend_variable("KERF_TEST_PATH", "/x", ':');
  EXPECT_STREQ(getenv("KERF_TEST_PATH"), "/x");
}

TEST(Environment, FindsThePartsBesideTheProgram) {
  const Installation i = find_installation("/opt/kerf/build/dev/bin/kerf");
  EXPECT_EQ(i.bin, "/opt/kerf/build/dev/bin");
  EXPECT_EQ(i.python, "/opt/kerf/build/dev/python");
  EXPECT_TRUE(i.hallib.empty());
}

}  // namespace
}  // namespace kerf::launcher
