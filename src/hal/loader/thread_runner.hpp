// ThreadRunner: one cycle of one HAL thread. All of it runs on the realtime thread.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/component.hpp"
#include "hal/core/records.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

/// One function in a thread's list, with the items that show what it costs.
struct RunEntry {
  FunctionThunk thunk{nullptr};
  void* object{nullptr};
  FunctionRecord* record{nullptr};
  Offset record_offset{0};
  Out<std::int32_t> time;        ///< NAME.time, ns
  Param<std::int32_t> tmax;      ///< NAME.tmax, ns
  RoParam<bool> tmax_increased;  ///< NAME.tmax-increased
};

/// Immutable once published.
struct RunList {
  const RunEntry* entries{nullptr};
  std::size_t count{0};
};

class ThreadRunner {
 public:
  /// Items of the thread itself: NAME.time, NAME.tmax, NAME.threadbeat.
  struct Items {
    Out<std::int32_t> time;
    Param<std::int32_t> tmax;
    Out<std::int64_t> threadbeat;
  };
  ThreadRunner(Root& root, ThreadRecord& record, const rtapi::Clock& clock, Items items) noexcept
      : root_(root), record_(record), clock_(clock), items_(items), timed_(!clock.is_virtual()) {}
  ThreadRunner(const ThreadRunner&) = delete;
  ThreadRunner& operator=(const ThreadRunner&) = delete;

  /// @rt. Runs the functions if HAL runs. On the virtual clock nothing is timed: two runs stay identical and cost nothing.
  void run_cycle(rtapi::Nanos scheduled, rtapi::Nanos actual) noexcept;
  /// The same, as CyclicThread calls it.
  static void cycle(void* self, rtapi::Nanos scheduled, rtapi::Nanos actual) noexcept {
    static_cast<ThreadRunner*>(self)->run_cycle(scheduled, actual);
  }

  [[nodiscard]] const char* name() const noexcept { return record_.name.c_str(); }
  [[nodiscard]] std::int64_t period_ns() const noexcept { return record_.period_ns; }
  [[nodiscard]] ThreadRecord& record() noexcept { return record_; }
  /// Name of the function that took longest in the last cycle; for CyclicThread's overrun report.
  [[nodiscard]] const char* const* breadcrumb() const noexcept { return &slowest_; }

  /// @nonrt. The old list may be in use until the thread has finished a cycle.
  const RunList* swap_list(const RunList* list) noexcept {
    const RunList* old = list_.get();
    list_.publish(list);
    return old;
  }

 private:
  void run_timed(const RunList& list, const Period& period) noexcept;

  Root& root_;
  ThreadRecord& record_;
  const rtapi::Clock& clock_;
  Items items_;
  bool timed_;
  rtapi::Nanos last_{0};
  const char* slowest_{nullptr};
  Word<const RunList*> list_{nullptr};
};

}  // namespace kerf::hal
