// CycleCounter: cheap time stamps, for measuring how long code takes while it runs.
//
//   const auto counter = rtapi::CycleCounter::calibrated();
//   const std::uint64_t begin = counter.ticks();
//   ...
//   const rtapi::Nanos took = counter.ns(counter.ticks() - begin);
//
// It tells durations, never the time: that is the Clock's business.
#pragma once

#include <cstdint>

#include "rtapi/clock/clock.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {

class CycleCounter {
 public:
  /// Counts nothing; false.
  constexpr CycleCounter() = default;

  /// @nonrt. The processor's own counter when it runs at one rate on all processors and in all their sleeping states and keeps pace with
  /// CLOCK_MONOTONIC, as measured over a few milliseconds; else monotonic(). A read costs about 9 ns, of CLOCK_MONOTONIC 22.
  static CycleCounter calibrated() noexcept;
  /// CLOCK_MONOTONIC.
  static CycleCounter monotonic() noexcept;
  /// For tests: the ticks are what the word says, a nanosecond each.
  static CycleCounter manual(const Word<std::uint64_t>& word) noexcept {
    CycleCounter counter;
    counter.read_ = [](const void* self) noexcept {
      return static_cast<const Word<std::uint64_t>*>(self)->get();
    };
    counter.self_ = &word;
    return counter;
  }

  /// True when it counts.
  explicit operator bool() const noexcept { return read_ != nullptr; }
  [[nodiscard]] bool is_processors() const noexcept { return self_ == &kProcessors; }

  /// @rt. Must count.
  [[nodiscard]] std::uint64_t ticks() const noexcept {
#if defined(__x86_64__)
    if (self_ == &kProcessors) return __builtin_ia32_rdtsc();
#endif
    return read_(self_);
  }
  /// @rt. A duration; what is longer than 2^32 ticks (over a second) is given as that.
  [[nodiscard]] Nanos ns(std::uint64_t ticks) const noexcept {
    if (ticks > UINT32_MAX) ticks = UINT32_MAX;
    return static_cast<Nanos>((ticks * ns_per_tick_) >> 32U);
  }
  /// Ticks a second; 1e9 unless the counter is the processor's.
  [[nodiscard]] double frequency_hz() const noexcept {
    return 1e9 * 4294967296.0 / static_cast<double>(ns_per_tick_);
  }

 private:
  using Read = std::uint64_t (*)(const void* self) noexcept;
  static constexpr char kProcessors{0};  ///< its address marks the processor's counter

  Read read_{nullptr};
  const void* self_{nullptr};
  std::uint64_t ns_per_tick_{
      1ULL << 32U};  ///< times 2^32; at most 2^32, so that a product with 32 bits fits
};

}  // namespace kerf::rtapi
