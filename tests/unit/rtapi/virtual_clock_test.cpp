#include "rtapi/clock/virtual_clock.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "rtapi/clock/real_clock.hpp"
#include "rtapi/shm/abstract_address.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::rtapi {
namespace {

/// What all processes of a test write into, in order.
struct Trace {
  Word<std::uint32_t> used{0};
  char text[512]{};
  void add(char c) { text[used.add(1) - 1] = c; }
};

struct Fixture {
  std::unique_ptr<Segment> segment;
  Trace* trace{nullptr};
  Cell* cell{nullptr};
  explicit Fixture(const char* what) {
    segment =
        std::move(*Segment::create(std::string("vclock-") + what + "-" + std::to_string(getpid())));
    EXPECT_TRUE(make_clock(*segment, ClockMode::virtual_time).ok());
    trace = *segment->make<Trace>("trace");
    cell = *make_cell(*segment, "cell");
  }
};

/// Runs `body` in a child process with its own mapping and clock.
pid_t spawn(const std::string& instance, Role role, const char* name,
            const std::function<void(Segment&, WaitClock&, Trace&)>& body) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  auto segment = Segment::attach(instance);
  auto clock = join_clock(**segment, role, name);
  if (!clock.ok()) _exit(9);
  body(**segment, **clock, **(*segment)->find<Trace>("trace"));
  clock->reset();
  _exit(0);
}

void sleep_ms(WaitClock& clock, int ms) {
  WaitSpec spec;
  spec.until = clock.now() + ms * kMillisecond;
  clock.wait(spec);
}

int finish(pid_t pid) {
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Waits until `n` participants have joined, without virtual time going by.
void wait_joined(Segment& segment, WaitClock& clock, std::uint32_t n) {
  ClockBlock& block = **segment.find<ClockBlock>(ClockBlock::kName);
  int fds[2];
  ASSERT_EQ(pipe(fds), 0);
  // The launcher's way: it holds time while its children start.
  std::thread poke([&] {
    for (;;) {
      {
        std::uint32_t joined = 0;
        pthread_mutex_lock(&block.mutex);
        joined = block.joined;
        pthread_mutex_unlock(&block.mutex);
        if (joined >= n) break;
      }
      std::this_thread::yield();
    }
    ASSERT_EQ(write(fds[1], "x", 1), 1);
  });
  WaitSpec spec;
  spec.watch_fd(fds[0]);
  spec.holds_time = true;
  clock.wait(spec);
  poke.join();
  close(fds[0]);
  close(fds[1]);
}

TEST(VirtualClock, ProcessesRunInFixedOrderEachTime) {
  std::string first;
  for (int round = 0; round < 3; ++round) {
    Fixture f("order");
    auto clock = join_clock(*f.segment, Role::launcher, "launcher");
    ASSERT_TRUE(clock.ok());
    const auto ticks = [](char c, int period_ms, int n) {
      return [=](Segment&, WaitClock& k, Trace& t) {
        for (int i = 0; i < n; ++i) {
          sleep_ms(k, period_ms);
          t.add(c);
        }
      };
    };
    const pid_t task = spawn(f.segment->instance(), Role::task_command, "task", ticks('t', 2, 5));
    const pid_t host = spawn(f.segment->instance(), Role::realtime_host, "host", ticks('h', 1, 10));
    wait_joined(*f.segment, **clock, 3);
    sleep_ms(**clock, 20);
    EXPECT_EQ((*clock)->now(), 20 * kMillisecond);
    EXPECT_EQ(finish(task), 0);
    EXPECT_EQ(finish(host), 0);
    EXPECT_STREQ(f.trace->text, "hhthhthhthhthht");
  }
}

/// Writes its letter every so many ms, or whenever the cell that it watches was notified, and answers what comes from outside.
class Letter final : public Participant {
 public:
  Letter(char c, Role role, Trace& trace) : c_(c), role_(role), trace_(trace) {}
  [[nodiscard]] const char* name() const noexcept override { return "letter"; }
  [[nodiscard]] Role role() const noexcept override { return role_; }
  void step(Nanos now, WaitSpec& next) override {
    const bool due = now > 0 && (watches_ != nullptr || now >= next_);
    if (watches_ != nullptr) next.watch(*watches_);
    if (fd_ >= 0) next.watch_fd(fd_);
    if (due) {
      trace_.add(c_);
      if (notifies_ != nullptr) notifies_->notify();
    }
    if (period_ > 0 && (due || now == 0)) next_ = now + period_;
    next.wake_at(next_);
    char byte = 0;
    if (fd_ >= 0 && recv(fd_, &byte, 1, MSG_DONTWAIT) == 1) {
      trace_.add('!');
      EXPECT_EQ(send(fd_, "y", 1, 0), 1);
    }
  }
  Letter& every_ms(int ms) { return period_ = ms * kMillisecond, *this; }
  Letter& notifies(Cell& cell) { return notifies_ = &cell, *this; }
  Letter& watches(const Cell& cell) { return watches_ = &cell, *this; }
  Letter& reads(int fd) { return fd_ = fd, *this; }

 private:
  char c_;
  Role role_;
  Trace& trace_;
  Nanos period_{0}, next_{kForever};
  Cell* notifies_{nullptr};
  const Cell* watches_{nullptr};
  int fd_{-1};
};

TEST(VirtualClock, PlacesOfOneThreadHaveTheirTurnsAmongThoseOfOthers) {
  for (const bool shares : {true, false}) {
    Fixture f("shared");
    auto clock = join_clock(*f.segment, Role::launcher, "launcher");
    ASSERT_TRUE(clock.ok());
    int ends[2];
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
    Letter command('c', Role::task_command, *f.trace), io('o', Role::io, *f.trace);
    command.every_ms(2).notifies(*f.cell).reads(ends[0]);
    io.watches(*f.cell);
    Participant* const both[] = {&command, &io};
    // Between them in the order, and before them. Forked while there is no other thread, which might hold a lock of the allocator.
    const auto ticks = [](char c) {
      return [=](Segment&, WaitClock& k, Trace& t) {
        for (int i = 0; i < 6; ++i) {
          sleep_ms(k, 1);
          t.add(c);
        }
      };
    };
    const pid_t middle = spawn(f.segment->instance(), Role::task_interpreter, "middle", ticks('i'));
    const pid_t host = spawn(f.segment->instance(), Role::realtime_host, "host", ticks('h'));
    std::vector<std::unique_ptr<WaitClock>> clocks;
    std::unique_ptr<SharedThread> shared;
    std::vector<std::thread> threads;
    if (shares) {
      shared = std::move(*SharedThread::join(*f.segment, both));
      threads.emplace_back([&] { shared->run(); });
    } else {
      clocks.resize(2);
      for (std::size_t i = 0; i < 2; ++i)
        threads.emplace_back([&, i] {
          clocks[i] = std::move(*join_clock(*f.segment, both[i]->role(), both[i]->name()));
          run_participant(*clocks[i], *both[i]);
        });
    }
    wait_joined(*f.segment, **clock, 5);
    sleep_ms(**clock, 4);
    EXPECT_STREQ(f.trace->text, "hihciohihcio") << shares;
    // Real work outside is seen while time stands, by whoever waits for it.
    ASSERT_EQ(send(ends[1], "x", 1, 0), 1);
    WaitSpec answer;
    answer.watch_fd(ends[1]);
    answer.holds_time = true;
    (*clock)->wait(answer);
    sleep_ms(**clock, 2);
    EXPECT_STREQ(f.trace->text, "hihciohihcio!hihcio") << shares;
    EXPECT_EQ(finish(middle), 0);
    EXPECT_EQ(finish(host), 0);
    if (shares) shared->stop();
    for (auto& k : clocks) k->stop();
    for (std::thread& thread : threads) thread.join();
    // Both places are free, so time is.
    shared.reset();
    clocks.clear();
    sleep_ms(**clock, 5);
    EXPECT_EQ((*clock)->now(), 11 * kMillisecond);
    close(ends[0]);
    close(ends[1]);
  }
}

TEST(VirtualClock, AThreadIsForOneOnTheRealClock) {
  auto segment = std::move(*Segment::create("vclock-real-" + std::to_string(getpid())));
  ASSERT_TRUE(make_clock(*segment, ClockMode::real).ok());
  Trace trace;
  Letter letter('a', Role::io, trace);
  Participant* const both[] = {&letter, &letter};
  EXPECT_EQ(SharedThread::join(*segment, both).error().code, Errc::bad_argument);
  const auto shared = std::move(*SharedThread::join(*segment, {both, 1}));
  std::thread runs([&] { shared->run(); });
  shared->stop();
  runs.join();
}

TEST(VirtualClock, WhoHasNotLookedYetIsNotTakenForDead) {
  Fixture f("full");
  auto clock = join_clock(*f.segment, Role::realtime_host, "main");
  ASSERT_TRUE(clock.ok());
  const pid_t child = spawn(f.segment->instance(), Role::task_command, "child",
                            [](Segment&, WaitClock& k, Trace& t) {
                              for (int i = 0; i < 5; ++i) {
                                sleep_ms(k, 1);
                                t.add('c');
                              }
                            });
  wait_joined(*f.segment, **clock, 2);
  // It is told of more turns than it has room for, as happens where whoever tells it runs on for long.
  ASSERT_EQ(kill(child, SIGSTOP), 0);
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un to{};
  const socklen_t length = abstract_address(socket_name(f.segment->instance(), "clock-1"), to);
  int told = 0;
  while (told < 10000 &&
         sendto(fd, "b", 1, MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&to), length) == 1)
    ++told;
  ASSERT_EQ(errno, EAGAIN);
  close(fd);
  std::thread goes_on([&] {
    const auto real = make_real_clock();
    sleep_ms(*real, 20);
    EXPECT_EQ(kill(child, SIGCONT), 0);
  });
  sleep_ms(**clock, 10);
  goes_on.join();
  EXPECT_STREQ(f.trace->text, "ccccc");
  EXPECT_EQ(finish(child), 0);
}

TEST(VirtualClock, NotifyInOneProcessWakesTheOtherAtTheSameInstant) {
  Fixture f("notify");
  auto clock = join_clock(*f.segment, Role::launcher, "launcher");
  ASSERT_TRUE(clock.ok());
  const pid_t waiter =
      spawn(f.segment->instance(), Role::planner, "waiter", [](Segment& s, WaitClock& k, Trace& t) {
        Cell& cell = **make_cell(s, "cell");
        WaitSpec spec;
        spec.watch(cell);
        k.wait(spec);
        t.add(k.now() == 7 * kMillisecond ? 'y' : 'n');
      });
  wait_joined(*f.segment, **clock, 2);
  sleep_ms(**clock, 7);
  f.cell->notify();
  sleep_ms(**clock, 5);
  EXPECT_EQ(finish(waiter), 0);
  EXPECT_STREQ(f.trace->text, "y");
}

TEST(VirtualClock, TimeGoesOnWithoutADeadParticipant) {
  Fixture f("dead");
  auto clock = join_clock(*f.segment, Role::launcher, "launcher");
  ASSERT_TRUE(clock.ok());
  // It dies while it holds the baton.
  const pid_t victim = spawn(f.segment->instance(), Role::realtime_host, "victim",
                             [](Segment&, WaitClock& k, Trace&) {
                               sleep_ms(k, 3);
                               raise(SIGKILL);
                             });
  wait_joined(*f.segment, **clock, 2);
  std::thread reaper([&] { EXPECT_EQ(finish(victim), -SIGKILL); });
  sleep_ms(**clock, 10);
  EXPECT_EQ((*clock)->now(), 10 * kMillisecond);
  reaper.join();
}

TEST(VirtualClock, EvictedAtOnce) {
  Fixture f("evict");
  auto clock = join_clock(*f.segment, Role::launcher, "launcher");
  ASSERT_TRUE(clock.ok());
  const pid_t victim = spawn(f.segment->instance(), Role::realtime_host, "victim",
                             [](Segment&, WaitClock& k, Trace&) {
                               WaitSpec spec;
                               spec.holds_time = true;
                               k.wait(spec);
                             });
  wait_joined(*f.segment, **clock, 2);
  kill(victim, SIGKILL);
  EXPECT_EQ(finish(victim), -SIGKILL);
  VirtualClock::evict(*f.segment, victim);
  sleep_ms(**clock, 10);
  EXPECT_EQ((*clock)->now(), 10 * kMillisecond);
}

TEST(VirtualClock, StopEndsAWaitAndGivesTheBatonOn) {
  Fixture f("stop");
  auto a = join_clock(*f.segment, Role::launcher, "a");
  ASSERT_TRUE(a.ok());
  StopWord joined;
  std::unique_ptr<WaitClock> b;
  std::thread other([&] {
    b = std::move(*join_clock(*f.segment, Role::planner, "b"));
    joined.request();
    b->wait(WaitSpec{});  // for ever
  });
  while (!joined.requested()) sleep_ms(**a, 1);
  b->stop();
  other.join();
  b.reset();
  const Nanos before = (*a)->now();
  sleep_ms(**a, 2);
  EXPECT_EQ((*a)->now(), before + 2 * kMillisecond);
}

TEST(TimeShim, AnUnmodifiedProgramSleepsInVirtualTime) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's runtime would have to be preloaded before the shim";
#endif
  Fixture f("shim");
  auto clock = join_clock(*f.segment, Role::launcher, "launcher");
  ASSERT_TRUE(clock.ok());
  const std::string before = f.segment->instance();
  const pid_t sleeper = fork();
  if (sleeper == 0) {
    setenv("KERF_INSTANCE", before.c_str(), 1);
    setenv("LD_PRELOAD", KERF_BUILD_DIR "/lib/libkerf_time.so", 1);
    execlp("sleep", "sleep", "3600", nullptr);
    _exit(127);
  }
  wait_joined(*f.segment, **clock, 2);
  sleep_ms(**clock, 3600 * 1000 - 1);
  EXPECT_EQ(waitpid(sleeper, nullptr, WNOHANG), 0);
  sleep_ms(**clock, 2);
  EXPECT_EQ(finish(sleeper), 0);
}

TEST(RealClock, WaitsAndStops) {
  auto clock = make_real_clock();
  const Nanos before = clock->now();
  WaitSpec spec;
  spec.until = before + 2 * kMillisecond;
  clock->wait(spec);
  EXPECT_GE(clock->now(), before + 2 * kMillisecond);
  std::thread stopper([&] { clock->stop(); });
  clock->wait(WaitSpec{});
  stopper.join();
  EXPECT_TRUE(clock->stopped());
}

}  // namespace
}  // namespace kerf::rtapi
