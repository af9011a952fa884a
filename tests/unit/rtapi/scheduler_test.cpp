#include <gtest/gtest.h>
#include <unistd.h>

#include <functional>
#include <string>
#include <vector>

#include "rtapi/clock/local_scheduler.hpp"

namespace kerf::rtapi {
namespace {

/// A participant made of a lambda.
class Script final : public Participant {
 public:
  Script(const char* name, Role role, std::function<void(Nanos, WaitSpec&)> f)
      : name_(name), role_(role), f_(std::move(f)) {}
  [[nodiscard]] const char* name() const noexcept override { return name_; }
  [[nodiscard]] Role role() const noexcept override { return role_; }
  void step(Nanos now, WaitSpec& next) override { f_(now, next); }

 private:
  const char* name_;
  Role role_;
  std::function<void(Nanos, WaitSpec&)> f_;
};

TEST(LocalScheduler, FixedOrderAtOneInstant) {
  LocalScheduler clock;
  std::string trace;
  Script task("task", Role::task_command, [&](Nanos now, WaitSpec& next) {
    trace += 't';
    next.until = now + 2 * kMillisecond;
  });
  Script host("host", Role::realtime_host, [&](Nanos now, WaitSpec& next) {
    trace += 'h';
    next.until = now + kMillisecond;
  });
  clock.add(task);
  clock.add(host);
  clock.run_until(4 * kMillisecond);
  EXPECT_EQ(trace, "hthhthht");
  EXPECT_EQ(clock.now(), 4 * kMillisecond);
}

TEST(LocalScheduler, NotifyRunsTheWaiterAtTheSameInstant) {
  LocalScheduler clock;
  Cell cell;
  std::vector<Nanos> woken;
  Script sleeper("sleeper", Role::planner, [&](Nanos now, WaitSpec& next) {
    next.watch(cell);
    woken.push_back(now);
  });
  Script host("host", Role::realtime_host, [&](Nanos now, WaitSpec& next) {
    if (now == 3 * kMillisecond) cell.notify();
    next.until = now + kMillisecond;
  });
  clock.add(sleeper);
  clock.add(host);
  clock.run_until(5 * kMillisecond);
  EXPECT_EQ(woken, (std::vector<Nanos>{0, 3 * kMillisecond}));
}

TEST(LocalScheduler, OutsideWorkHoldsTime) {
  LocalScheduler clock;
  int pipe_fds[2];
  ASSERT_EQ(pipe(pipe_fds), 0);
  Nanos seen = -1;
  int steps = 0;
  Script outside("outside", Role::task_interpreter, [&](Nanos now, WaitSpec& next) {
    if (++steps == 1) {
      next.watch_fd(pipe_fds[0]);
      next.holds_time = true;
      ASSERT_EQ(write(pipe_fds[1], "x", 1), 1);
      return;
    }
    seen = now;
  });
  Script host("host", Role::realtime_host,
              [&](Nanos now, WaitSpec& next) { next.until = now + kMillisecond; });
  clock.add(host);
  clock.add(outside);
  clock.run_until(5 * kMillisecond);
  EXPECT_EQ(seen, 0);  // no virtual time went by
  close(pipe_fds[0]);
  close(pipe_fds[1]);
}

TEST(LocalScheduler, StuckOutsideWorkIsNamed) {
  LocalScheduler clock;
  clock.set_hold_limit_ms(1);
  int pipe_fds[2];
  ASSERT_EQ(pipe(pipe_fds), 0);
  Script outside("collet-script", Role::task_interpreter, [&](Nanos, WaitSpec& next) {
    next.watch_fd(pipe_fds[0]);
    next.holds_time = true;
  });
  clock.add(outside);
  clock.run_until(kSecond);
  EXPECT_EQ(clock.stuck(), "collet-script");
  EXPECT_EQ(clock.now(), 0);
  close(pipe_fds[0]);
  close(pipe_fds[1]);
}

}  // namespace
}  // namespace kerf::rtapi
