// Clock: the only source of time and the only way to wait.
//
// Everything that runs beside the realtime threads is a Participant: a state machine that does what can be done at this
// instant and then says what it waits for. Three drivers run participants, and a participant cannot tell which one:
//   - real programs on the real clock: a thread each (run_participant with a RealClock);
//   - real programs on the virtual clock: one at a time over all processes (VirtualClock, virtual_clock.hpp), with a thread each or one for
//     several (SharedThread, join_clock.hpp);
//   - tests: all in one thread (LocalScheduler, local_scheduler.hpp).
// So blocking is always `return from step()`, every wait can be ended by a stop, and virtual time is exact.
#pragma once

#include <cstdint>
#include <span>

#include "rtapi/base/static_vector.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {

/// Nanoseconds of instance time. Real: CLOCK_MONOTONIC. Virtual: from 0 at the instance's start.
using Nanos = std::int64_t;
inline constexpr Nanos kForever = INT64_MAX;
inline constexpr Nanos kMillisecond = 1'000'000;
inline constexpr Nanos kSecond = 1'000'000'000;

/// Seconds to Nanos, rounded; anything beyond a hundred years or NaN is kForever.
constexpr Nanos seconds(double s) noexcept {
  return s < 3e9 ? static_cast<Nanos>(s * 1e9 + (s < 0 ? -0.5 : 0.5)) : kForever;
}

/// Order in which participants run at one instant of virtual time. Same role: in order of registration.
enum class Role : std::uint8_t {
  realtime_host = 0,
  planner = 1,
  task_command = 2,
  task_interpreter = 3,
  io = 4,
  user_component = 5,
  launcher = 6,  ///< last: it looks at what the others made of its commands
};

/// A cell and the count that the waiter has seen.
struct CellWatch {
  const Cell* cell{nullptr};
  std::uint64_t seen{0};
};

/// What a participant waits for; the first to come ends the wait.
struct WaitSpec {
  Nanos until{kForever};
  StaticVector<CellWatch, 8> cells;
  StaticVector<int, 64> fds;  ///< readable, or closed by the other end
  /// Virtual clock: time stands still while this wait lasts, because the work goes on outside (a child process, a client in
  /// the middle of its script). Has no meaning in real time.
  bool holds_time{false};

  /// Watches a cell from its present count. Call it before reading the data that the cell guards. In real programs the cell
  /// stands in the segment (make_cell in rtapi/shm/socket.hpp): on the virtual clock other processes look at it.
  void watch(const Cell& cell) noexcept { (void)cells.push_back({&cell, cell.count()}); }
  void watch_fd(int fd) noexcept { (void)fds.push_back(fd); }
  void wake_at(Nanos t) noexcept {
    if (t < until) until = t;
  }
};

class Clock {
 public:
  virtual ~Clock() = default;
  /// @rt.
  [[nodiscard]] virtual Nanos now() const noexcept = 0;
  [[nodiscard]] virtual bool is_virtual() const noexcept = 0;
};

/// One of the things that run beside the realtime threads.
class Participant {
 public:
  virtual ~Participant() = default;
  [[nodiscard]] virtual const char* name() const noexcept = 0;
  [[nodiscard]] virtual Role role() const noexcept = 0;
  /// Does all that can be done at `now` without waiting, then fills in `next`, which comes empty. To be called again at once,
  /// set next.until = now. Spurious calls are normal: look at the state, not at why you were called.
  virtual void step(Nanos now, WaitSpec& next) = 0;
};

/// A clock that a thread of a real program can wait on. One object a participant.
class WaitClock : public Clock {
 public:
  /// Returns when the spec is met or stop() was called (which may be from a signal handler or another thread).
  virtual void wait(const WaitSpec& spec) = 0;
  virtual void stop() noexcept = 0;
  [[nodiscard]] virtual bool stopped() const noexcept = 0;
};

/// Steps `participant` until the clock is stopped.
inline void run_participant(WaitClock& clock, Participant& participant) {
  while (!clock.stopped()) {
    WaitSpec spec;
    participant.step(clock.now(), spec);
    if (clock.stopped()) break;
    clock.wait(spec);
  }
}

}  // namespace kerf::rtapi
