#include "rtapi/clock/real_clock.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>

namespace kerf::rtapi {

Nanos monotonic_now() noexcept {
  timespec ts{};
  clock_gettime(CLOCK_MONOTONIC, &ts);
  return static_cast<Nanos>(ts.tv_sec) * kSecond + ts.tv_nsec;
}

double wall_time_s() noexcept {
  timespec ts{};
  clock_gettime(CLOCK_REALTIME, &ts);
  return static_cast<double>(ts.tv_sec) + static_cast<double>(ts.tv_nsec) * 1e-9;
}

RealClock::RealClock() : stop_fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

RealClock::~RealClock() { close(stop_fd_); }

Nanos RealClock::now() const noexcept { return monotonic_now(); }

void RealClock::wait(const WaitSpec& spec) {
  pollfd fds[66];
  nfds_t n = 0;
  fds[n++] = {stop_fd_, POLLIN, 0};
  for (const int fd : spec.fds) fds[n++] = {fd, POLLIN, 0};
  for (;;) {
    if (stopped()) return;
    for (const CellWatch& watch : spec.cells)
      if (watch.cell->count() != watch.seen) return;
    const Nanos now_ns = monotonic_now();
    if (now_ns >= spec.until) return;
    Nanos next = spec.until;
    if (!spec.cells.empty()) next = std::min(next, now_ns + kTick);
    timespec timeout{};
    const timespec* maybe_timeout = nullptr;
    if (next != kForever) {
      const Nanos left = next - now_ns;
      timeout = {static_cast<time_t>(left / kSecond), static_cast<long>(left % kSecond)};
      maybe_timeout = &timeout;
    }
    if (ppoll(fds, n, maybe_timeout, nullptr) > 0) return;
  }
}

void RealClock::stop() noexcept {
  stop_.request();
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(stop_fd_, &one, sizeof one);
}

}  // namespace kerf::rtapi
