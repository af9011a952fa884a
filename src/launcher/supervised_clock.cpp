#include "launcher/supervised_clock.hpp"

#include <signal.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <utility>

#include "rtapi/clock/real_clock.hpp"
#include "rtapi/clock/virtual_clock.hpp"

namespace kerf::launcher {

using rtapi::Nanos;
using rtapi::WaitSpec;

namespace {

// A signal handler can reach nothing else.
int g_signal_fd = -1;
int g_child_fd = -1;
volatile sig_atomic_t g_signals = 0;
rtapi::WaitClock* volatile g_clock = nullptr;

/// Seconds after which a part that does not let the clock go is left behind.
constexpr unsigned kPatienceS = 5;

/// The launcher may wait for its turn on a virtual clock that somebody else blocks; this ends the wait all the same.
void force_on(int) {
  if (rtapi::WaitClock* clock = g_clock; clock != nullptr) clock->stop();
}

void on_stop_signal(int number) {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(g_signal_fd, &one, sizeof one);
  g_signals = g_signals + 1;
  if (g_signals == 1)
    (void)alarm(kPatienceS);
  else
    force_on(number);
}

void on_child(int) {
  const int error = errno;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(g_child_fd, &one, sizeof one);
  errno = error;
}

void on_broken_pipe(int) {}

bool take(int fd) {
  std::uint64_t count = 0;
  return read(fd, &count, sizeof count) == sizeof count;
}

}  // namespace

int catch_stop_signals() {
  if (g_signal_fd >= 0) return g_signal_fd;
  g_signal_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  g_child_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  action.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaction(number, &action, nullptr);
  action.sa_handler = on_child;
  action.sa_flags = SA_RESTART | SA_NOCLDSTOP;
  sigaction(SIGCHLD, &action, nullptr);
  action.sa_flags = SA_RESTART;
  action.sa_handler = force_on;
  sigaction(SIGALRM, &action, nullptr);
  // A handler, since "ignored" would be inherited by children.
  action.sa_handler = on_broken_pipe;
  sigaction(SIGPIPE, &action, nullptr);
  return g_signal_fd;
}

SupervisedClock::SupervisedClock(rtapi::Segment& segment, std::unique_ptr<rtapi::WaitClock> clock,
                                 int signal_fd)
    : segment_(segment),
      clock_(std::move(clock)),
      signal_fd_(signal_fd),
      tick_fd_(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)) {
  itimerspec every{};
  every.it_value.tv_nsec = every.it_interval.tv_nsec = 1'000'000;
  timerfd_settime(tick_fd_, 0, &every, nullptr);
  g_clock = clock_.get();
}

SupervisedClock::~SupervisedClock() {
  (void)alarm(0);
  g_clock = nullptr;
  close(tick_fd_);
}

void SupervisedClock::wait(const WaitSpec& spec) {
  if (stopped()) return;
  WaitSpec all = spec;
  if (!tearing_down_) {
    all.watch_fd(signal_fd_);
    for (const Watched& watched : children_) all.watch_fd(watched.child->pidfd());
    if (told_) all.watch_fd(g_child_fd);
  }
  if (!spec.holds_time) {
    all.wake_at(next_chore_);
    for (const auto& [at, task] : timers_) all.wake_at(at);
  }
  if (add_) add_(all);
  if (look_at_) look_at_();
  clock_->wait(all);
  if (look_at_) look_at_();
  look();
}

void SupervisedClock::stop() noexcept {
  if (reason_.kind == StopReason::Kind::none) reason_.kind = StopReason::Kind::signal;
}

void SupervisedClock::begin_teardown() {
  tearing_down_ = true;
  reason_ = {};
  timers_.clear();  // one that is due and never called would let no time pass
  (void)alarm(kPatienceS);
}

void SupervisedClock::watch_child(Child& child, bool ends_session) {
  children_.push_back({&child, ends_session});
}

void SupervisedClock::set_chore(std::function<void()> chore, Nanos period) {
  chore_ = std::move(chore);
  chore_period_ = period;
  next_chore_ = chore_ ? clock_->now() : rtapi::kForever;
}

void SupervisedClock::look() {
  if (clock_->stopped()) {
    stop();  // without our turn on the clock nothing else may be done
    return;
  }
  if (chore_ && clock_->now() >= next_chore_) {
    // Whole multiples, so that the moments do not depend on when the machine was started.
    next_chore_ = (clock_->now() / chore_period_ + 1) * chore_period_;
    chore_();
  }
  if (tearing_down_) return;
  // A task may ask for another one, so the list is not walked while it runs.
  for (;;) {
    const auto due = std::find_if(timers_.begin(), timers_.end(),
                                  [&](const auto& timer) { return clock_->now() >= timer.first; });
    if (due == timers_.end()) break;
    const std::function<void()> task = std::move(due->second);
    timers_.erase(due);
    task();
  }
  for (auto at = children_.begin(); at != children_.end();) {
    // One look: an end between two would be left untold.
    at = has_ended(*at) ? children_.erase(at) : std::next(at);
  }
  if (told_ && take(g_child_fd)) look_for_strays();
  if (take(signal_fd_)) stop();
}

bool SupervisedClock::watches(pid_t pid) const {
  for (const Watched& watched : children_)
    if (watched.child->pid() == pid) return true;
  return false;
}

void SupervisedClock::look_for_strays() {
  for (;;) {
    siginfo_t info{};
    // Only looked at first: the end of a watched child belongs to its owner.
    if (waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == 0) return;
    if (watches(info.si_pid)) {
      on_child(SIGCHLD);  // others may have ended behind it: look again
      return;
    }
    const ExitState state{info.si_code != CLD_EXITED, info.si_status};
    told_(info.si_pid, state);
    waitpid(info.si_pid, nullptr, WNOHANG);
  }
}

void SupervisedClock::call_after(Nanos delay, std::function<void()> task) {
  timers_.emplace_back(clock_->now() + delay, std::move(task));
}

void SupervisedClock::watch_strays(std::function<void(pid_t, const ExitState&)> told) {
  told_ = std::move(told);
  if (told_) look_for_strays();
}

bool SupervisedClock::has_ended(Watched& watched) {
  const auto exit = watched.child->poll_exit();
  if (!exit) return false;
  rtapi::VirtualClock::evict(segment_, watched.child->pid());
  if (stopped()) return true;
  const bool regular = !exit->by_signal && exit->number == 0;
  if (watched.ends_session && regular) {
    reason_ = {StopReason::Kind::display_closed, watched.child->name() + " was closed"};
    return true;
  }
  reason_ = {StopReason::Kind::part_died, watched.child->name() + " (process " +
                                              std::to_string(watched.child->pid()) + ") " +
                                              describe_exit(*exit)};
  return true;
}

bool SupervisedClock::poll_until(const std::function<bool()>& done, int limit_ms, bool hold) {
  const Nanos limit = rtapi::monotonic_now() + limit_ms * rtapi::kMillisecond;
  while (!done()) {
    if (stopped() || rtapi::monotonic_now() > limit) return false;
    WaitSpec spec;
    spec.watch_fd(tick_fd_);
    spec.holds_time = hold;
    wait(spec);
    (void)take(tick_fd_);
  }
  return true;
}

bool SupervisedClock::hold_until(const std::function<bool()>& done, int limit_ms) {
  return poll_until(done, limit_ms, true);
}

bool SupervisedClock::wait_until(const std::function<bool()>& done, int limit_ms) {
  return poll_until(done, limit_ms, false);
}

bool SupervisedClock::pass(Nanos duration) {
  const Nanos until = now() + duration;
  while (!stopped() && now() < until) {
    WaitSpec spec;
    spec.wake_at(until);
    wait(spec);
  }
  return !stopped();
}

}  // namespace kerf::launcher
