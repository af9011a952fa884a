// CyclicThread: a realtime thread that calls one function each period.
#pragma once

#include <cstdint>
#include <memory>

#include "rtapi/base/fixed_string.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::rtapi {

/// What has been measured since start or since the last reset. Histogram bin i counts 2^i .. 2^(i+1)-1 microseconds; bin 0 is below 2.
struct Timing {
  static constexpr int kBins = 16;
  std::uint64_t count{0};
  std::int64_t min_ns{0}, max_ns{0};
  double sum_ns{0};
  std::uint64_t bins[kBins]{};
  /// @rt.
  void add(std::int64_t ns) noexcept;
  [[nodiscard]] double mean_ns() const noexcept {
    return count == 0 ? 0 : sum_ns / static_cast<double>(count);
  }
};

struct ThreadStats {
  Timing wake_up;    ///< from the planned to the real start of a cycle
  Timing execution;  ///< from the real start to the end
  std::uint64_t overruns{
      0};  ///< cycles that ended after the next one's start; the cycles lost are skipped, not made up
  std::uint64_t last_overrun_cycle{0};
  std::int64_t last_overrun_ns{0};  ///< how long that cycle took
};

/// Realtime rights of this process. Missing ones cost determinism, never function: they are said once, at start.
struct RightsReport {
  bool scheduler{false};      ///< SCHED_FIFO may be set (RLIMIT_RTPRIO or CAP_SYS_NICE)
  bool locked_memory{false};  ///< mlockall succeeded (RLIMIT_MEMLOCK or CAP_IPC_LOCK)
  bool preempt_rt{false};     ///< /sys/kernel/realtime says 1
  bool no_deep_sleep{false};  ///< /dev/cpu_dma_latency was had: idle processors wake at once
  FixedString<400>
      text;  ///< what is missing, what it costs and how to get it; empty when nothing is
};

/// Tries each right for real and reads it back. Locks memory as a side effect.
RightsReport acquire_realtime_rights();

/// Runs the calling thread before all ordinary programs (SCHED_FIFO, lowest priority), if the right is there; its children run as
/// ordinary ones. For threads that never compute long: a busy computer must not delay an operator's stop. False: no right.
bool prefer_this_thread() noexcept;

/// Where cycles lie on CLOCK_MONOTONIC, counted from a whole multiple of their period. The kernel's tick comes at whole multiples of 1, 4
/// or 10 ms, and a cycle that is due together with it starts some 15 us later.
inline constexpr Nanos kCyclePhase = 387'500;

class CyclicThread {
 public:
  struct Config {
    FixedString<31> name;
    Nanos period_ns{kMillisecond};
    int priority{
        80};      ///< SCHED_FIFO priority; without the right the thread runs as an ordinary one
    int cpu{-1};  ///< [KERF]RT_CPUS; -1: any
    /// @rt. One cycle. `scheduled` is when it should have begun, `actual` when it did.
    void (*cycle)(void* self, Nanos scheduled, Nanos actual) noexcept {nullptr};
    void* self{nullptr};
  };

  explicit CyclicThread(const Config& config);
  ~CyclicThread();
  CyclicThread(const CyclicThread&) = delete;
  CyclicThread& operator=(const CyclicThread&) = delete;

  /// Starts the thread; its first cycle comes one period later. `start_at` aligns several threads, 0: now.
  Status start(Nanos start_at = 0);
  /// Returns after the last cycle has ended.
  void stop();
  /// True when SCHED_FIFO was granted to the running thread.
  [[nodiscard]] bool realtime() const noexcept;
  /// As of the end of the last cycle.
  [[nodiscard]] ThreadStats stats() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kerf::rtapi
