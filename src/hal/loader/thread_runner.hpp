// ThreadRunner: one cycle of one HAL thread. All of it runs on the realtime thread.
//
// A cycle calls the functions of its list in order and stores, before each call, which one it is (ThreadRecord::running).
// Reading the clock costs as much as three small functions, so by default the functions are timed in turn: the list is cut into at
// most 16 chunks, the clock is read after each, and in each cycle one chunk has its functions timed one by one. When a cycle does not end in time, the function (or the chunk) that exceeded its usual time by
// most is named, and the thread is timed in full for a while, so that the next time names the function.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/component.hpp"
#include "hal/core/records.hpp"
#include "hal/core/timing.hpp"
#include "rtapi/clock/cycle_counter.hpp"

namespace kerf::hal {

/// What a call of a function needs, and no more: the loop over these is the cost of HAL.
struct RunEntry {
  FunctionThunk thunk{nullptr};
  void* object{nullptr};
  Offset record_offset{0};
};

/// Functions of a thread in order. Once published, the host only adds at the end, beyond `count`, or makes another list.
struct RunList {
  const RunEntry* entries{nullptr};
  std::size_t count{0};
};

class ThreadRunner {
 public:
  static constexpr std::size_t kSampledEvery = 16;
  /// Cycles that are timed in full after one that overran.
  static constexpr std::uint64_t kWatchedCycles = 8192;

  /// Items of the thread itself: NAME.time, NAME.tmax, NAME.threadbeat.
  struct Items {
    Out<std::int32_t> time;
    Param<std::int32_t> tmax;
    Out<std::int64_t> threadbeat;
  };
  /// Without a counter nothing is timed: on the virtual clock two runs stay identical and cost nothing.
  ThreadRunner(rtapi::Segment& segment, Root& root, ThreadRecord& record,
               rtapi::CycleCounter counter = {}) noexcept
      : segment_(segment), root_(root), record_(record), counter_(counter) {}
  ThreadRunner(const ThreadRunner&) = delete;
  ThreadRunner& operator=(const ThreadRunner&) = delete;

  /// @rt. Runs the functions if HAL runs. The cycle should have begun at `scheduled` and did at `actual`.
  void run_cycle(rtapi::Nanos scheduled, rtapi::Nanos actual) noexcept;
  /// The same, as CyclicThread calls it.
  static void cycle(void* self, rtapi::Nanos scheduled, rtapi::Nanos actual) noexcept {
    static_cast<ThreadRunner*>(self)->run_cycle(scheduled, actual);
  }

  [[nodiscard]] const char* name() const noexcept { return record_.name.c_str(); }
  [[nodiscard]] std::int64_t period_ns() const noexcept { return record_.period_ns; }
  [[nodiscard]] ThreadRecord& record() noexcept { return record_; }
  /// @nonrt. They must be made before the first cycle.
  [[nodiscard]] Items& items() noexcept { return items_; }

  /// @nonrt. The old list may be in use until the thread has finished a cycle.
  const RunList* swap_list(const RunList* list) noexcept {
    const RunList* old = list_.get();
    list_.publish(list);
    return old;
  }

 private:
  /// The part of a cycle that exceeded its usual time by most, so far.
  struct Suspect {
    std::uint64_t excess{0};  ///< ticks
    std::uint64_t took{0};
    std::uint64_t usual{0};
    std::uint32_t functions{0};
    std::size_t first{0};
  };

  /// What is known in a cycle that is timed.
  struct Timed {
    const RunList& list;
    const Period& period;
    const std::uint32_t epoch;
    std::uint64_t last;  ///< end of what ran last
    Suspect suspect;
  };

  void run_plain(const RunList& list, const Period& period) noexcept;
  /// Functions `first` to `end`, each timed, and as one.
  void time_each(Timed& timed, std::size_t first, std::size_t end) noexcept;
  void time_together(Timed& timed, std::size_t first, std::size_t end,
                     std::uint64_t& usual16) noexcept;
  void run_timed(const RunList& list, const Period& period, TimingMode mode, rtapi::Nanos scheduled,
                 rtapi::Nanos actual) noexcept;
  void note_overrun(const RunList& list, const Suspect& suspect, rtapi::Nanos took,
                    rtapi::Nanos woken_late) noexcept;

  rtapi::Segment& segment_;
  Root& root_;
  ThreadRecord& record_;
  Items items_;
  rtapi::CycleCounter counter_;
  rtapi::Nanos last_{0};
  std::uint64_t watched_until_{0};  ///< in cycles
  Word<const RunList*> list_{nullptr};
  /// What the chunks of the list usually take, in ticks, times 16; a list of another length begins anew.
  static constexpr std::size_t kChunks = kSampledEvery;
  std::uint64_t usual16_[kChunks]{};
  std::size_t usual_count_{0};
};

}  // namespace kerf::hal
