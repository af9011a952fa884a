// CycleNow: what a realtime function may know of the cycle that runs it, and how it moves the next one: a component that follows the
// clock of a bus corrects its thread's phase by some nanoseconds each cycle.
#pragma once

#include <algorithm>

#include "rtapi/clock/clock.hpp"

namespace kerf::rtapi {

struct CycleNow {
  Nanos reference{0};  ///< when the cycle should have begun
  Nanos period{0};
  Nanos correction{0};  ///< the next cycle comes so much later

  /// @rt. At most a hundredth of the period in one cycle, so that no cycle is lost by it.
  void correct(Nanos by) noexcept { correction = std::clamp(by, -period / 100, period / 100); }
  /// @rt. When the next cycle is due.
  [[nodiscard]] Nanos next() const noexcept { return reference + period + correction; }
};

/// @rt. Of the calling thread; nullptr outside a cycle.
CycleNow*& cycle_now() noexcept;

/// While it lives, the calling thread is in this cycle.
class InCycle {
 public:
  explicit InCycle(CycleNow& cycle) noexcept : before_(cycle_now()) { cycle_now() = &cycle; }
  ~InCycle() { cycle_now() = before_; }
  InCycle(const InCycle&) = delete;
  InCycle& operator=(const InCycle&) = delete;

 private:
  CycleNow* before_;
};

}  // namespace kerf::rtapi
