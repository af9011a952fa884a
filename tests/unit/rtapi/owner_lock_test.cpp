#include "rtapi/shm/owner_lock.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <vector>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::rtapi {
namespace {

std::string unique_instance(const char* what) {
  return std::string("test-") + what + "-" + std::to_string(getpid());
}

bool name_exists(const std::string& instance) {
  return access(("/dev/shm" + segment_name(instance)).c_str(), F_OK) == 0;
}

void pause_ms(int ms) {
  const auto clock = make_real_clock();
  WaitSpec spec;
  spec.wake_at(clock->now() + ms * kMillisecond);
  clock->wait(spec);
}

/// Runs `body` in a child; gives its pid.
pid_t in_child(const std::function<int()>& body) {
  const pid_t pid = fork();
  if (pid == 0) _exit(body());
  return pid;
}

int status_of(pid_t pid) {
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(OwnerLock, IsTakenOnceAndGoesWithItsProcess) {
  const std::string instance = unique_instance("lock");
  EXPECT_EQ(OwnerLock::taker(instance), 0);
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t owner = in_child([&] {
    auto lock = OwnerLock::take(instance, 0);
    (void)!write(ready[1], "x", 1);
    pause();
    return 0;
  });
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_EQ(OwnerLock::taker(instance), owner);
  EXPECT_FALSE(OwnerLock::held_here(instance));
  const auto second = OwnerLock::take(instance, 10'000);
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.error().message().find(std::to_string(owner)), std::string::npos);
  kill(owner, SIGKILL);
  (void)status_of(owner);
  auto lock = OwnerLock::take(instance, 0);
  ASSERT_TRUE(lock.ok());
  EXPECT_TRUE(OwnerLock::held_here(instance));
  lock->release();
  EXPECT_FALSE(OwnerLock::held_here(instance));
}

TEST(OwnerLock, OfManyThatStartAtOnceOneMakesTheSegment) {
  const std::string instance = unique_instance("race");
  // Something to repair first, so that all come to the dangerous place.
  ASSERT_EQ(status_of(in_child([&] {
              auto made = Segment::create(instance, 4U << 20U);
              return made.ok() ? (made->release(), 0) : 1;
            })),
            0);
  for (int round = 0; round < 10; ++round) {
    int start[2];
    int end[2];
    int tried[2];
    ASSERT_EQ(pipe(start), 0);
    ASSERT_EQ(pipe(end), 0);
    ASSERT_EQ(pipe(tried), 0);
    std::vector<pid_t> children;
    for (int i = 0; i < 8; ++i) {
      children.push_back(in_child([&] {
        close(start[1]);
        close(end[1]);
        char byte = 0;
        (void)!read(start[0], &byte, 1);
        auto made = Segment::create(instance, 4U << 20U);
        (void)!write(tried[1], "x", 1);
        (void)!read(end[0], &byte, 1);  // keep it until all have tried
        if (!made.ok()) return made.error().code == Errc::busy ? 2 : 3;
        return (*made)->header().owner_pid.get() == getpid() ? 0 : 4;
      }));
    }
    close(start[0]);
    close(start[1]);
    char byte = 0;
    for (int i = 0; i < 8; ++i) ASSERT_EQ(read(tried[0], &byte, 1), 1);
    close(end[0]);
    close(end[1]);
    close(tried[0]);
    close(tried[1]);
    int owners = 0;
    for (const pid_t child : children) {
      const int status = status_of(child);
      EXPECT_TRUE(status == 0 || status == 2) << status;
      owners += status == 0 ? 1 : 0;
    }
    EXPECT_EQ(owners, 1);
  }
  EXPECT_TRUE(Segment::remove(instance));
}

TEST(OwnerLock, ASegmentWhoseMakerDiedInTheMiddleIsRepaired) {
  const std::string instance = unique_instance("half");
  for (const off_t size : {off_t{0}, off_t{100}, off_t{1} << 20U, off_t{64} << 20U}) {
    const int fd = shm_open(segment_name(instance).c_str(), O_CREAT | O_RDWR, 0600);
    ASSERT_GE(fd, 0);
    ASSERT_EQ(ftruncate(fd, size), 0);
    close(fd);
    EXPECT_FALSE(Segment::attach(instance).ok());
    {
      auto made = Segment::create(instance, 4U << 20U);
      EXPECT_TRUE(made.ok()) << size << ": " << made.error().message();
    }
    EXPECT_FALSE(name_exists(instance));
  }
  close(shm_open(segment_name(instance).c_str(), O_CREAT | O_RDWR, 0600));
  EXPECT_TRUE(Segment::remove(instance));
  EXPECT_FALSE(name_exists(instance));
}

TEST(OwnerLock, ANewRunEndsTheProcessesOfTheLastAndWaitsForItsGuard) {
  const std::string instance = unique_instance("last");
  int pids[2];
  ASSERT_EQ(pipe(pids), 0);
  const pid_t owner = in_child([&] {
    auto made = Segment::create(instance, 4U << 20U);
    setenv("KERF_RUN_ID", std::string((*made)->header().run_id.view()).c_str(), 1);
    setenv("KERF_INSTANCE", instance.c_str(), 1);
    const pid_t left = fork();
    if (left == 0) execlp("sh", "sh", "-c", "trap '' TERM; sleep 60", nullptr);
    const pid_t guard = fork();
    if (guard == 0) {
      pause_ms(200);
      _exit(0);
    }
    const pid_t both[2] = {left, guard};
    (void)!write(pids[1], both, sizeof both);
    pause();
    return 0;
  });
  pid_t both[2]{};
  ASSERT_EQ(read(pids[0], both, sizeof both), static_cast<ssize_t>(sizeof both));
  // It has the run in its environment once it is the shell.
  for (int i = 0; i < 2000 && processes_of_instance(instance).empty(); ++i) pause_ms(5);
  kill(both[0], SIGSTOP);
  kill(owner, SIGKILL);
  (void)status_of(owner);
  EXPECT_FALSE(Segment::remove(instance));  // that is the guard's business
  {
    auto made = Segment::create(instance, 4U << 20U);
    ASSERT_TRUE(made.ok()) << made.error().message();
    EXPECT_FALSE(process_lives(both[1], 0));
    EXPECT_FALSE(process_lives(both[0], 0));
    EXPECT_TRUE(processes_of_instance(instance).empty());
  }
  EXPECT_FALSE(name_exists(instance));
}

TEST(OwnerLock, RemoveLeavesTheSegmentOfANewRunAlone) {
  const std::string instance = unique_instance("new");
  auto made = Segment::create(instance, 4U << 20U);
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(status_of(in_child([&] {
              // A stranger, with no descriptor of the owner's.
              for (int fd = 3; fd < 64; ++fd) close(fd);
              return Segment::remove(instance) ? 1 : 0;
            })),
            0);
  EXPECT_TRUE(name_exists(instance));
}

TEST(OwnerLock, AStartWaitsForAnOwnerThatIsEnding) {
  const std::string instance = unique_instance("ending");
  int said[2];
  ASSERT_EQ(pipe(said), 0);
  const pid_t owner = in_child([&] {
    auto made = Segment::create(instance, 4U << 20U);
    if (!made.ok()) return 1;
    (*made)->begin_end();
    (void)!write(said[1], "x", 1);
    pause_ms(1500);
    return 0;
  });
  char byte = 0;
  ASSERT_EQ(read(said[0], &byte, 1), 1);
  std::string waited;
  MakeHooks hooks;
  hooks.waits = [&](const std::string& text) { waited += text; };
  auto made = Segment::create(instance, 4U << 20U, hooks);
  ASSERT_TRUE(made.ok()) << made.error().message();
  EXPECT_NE(waited.find("is still being taken down by process " + std::to_string(owner)),
            std::string::npos)
      << waited;
  EXPECT_EQ(status_of(owner), 0);
}

/// A maker that is killed as soon as it has the instance leaves it to whoever it forked for that.
TEST(OwnerLock, WhatIsForkedBeforeTheSegmentKeepsItsName) {
  const std::string instance = unique_instance("taken");
  std::string run;
  MakeHooks hooks;
  hooks.taken = [&](const std::string& id) -> Status {
    run = id;
    EXPECT_FALSE(name_exists(instance));
    EXPECT_TRUE(OwnerLock::held_here(instance));
    return {};
  };
  {
    auto made = Segment::create(instance, 4U << 20U, hooks);
    ASSERT_TRUE(made.ok()) << made.error().message();
    EXPECT_EQ(std::string((*made)->header().run_id.view()), run);
  }
  hooks.taken = [](const std::string&) -> Status { return fail(Errc::system, "no guard"); };
  EXPECT_FALSE(Segment::create(instance, 4U << 20U, hooks).ok());
  EXPECT_FALSE(name_exists(instance));
}

}  // namespace
}  // namespace kerf::rtapi
