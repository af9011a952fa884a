// What functions and threads cost: histograms that the realtime threads fill and anybody reads.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "rtapi/sync/cell.hpp"

namespace kerf::hal {

/// How much of the functions is timed. [KERF]FUNCTION_TIMING, `halcmd timing every|sampled|off`.
enum class TimingMode : std::uint32_t {
  off = 0,      ///< no clock is read; nothing tells what overran
  sampled = 1,  ///< a function every kSampledEvery cycles, the thread every cycle
  every = 2,    ///< every function every cycle
};

[[nodiscard]] const char* timing_mode_name(TimingMode mode) noexcept;
[[nodiscard]] std::optional<TimingMode> timing_mode_of(std::string_view name) noexcept;

/// What a reader makes of a TimingRecord.
struct FunctionStats {
  std::uint64_t count{0};  ///< runs that were timed
  std::int64_t mean_ns{0};
  std::int64_t p50_ns{0}, p99_ns{0}, p999_ns{0}, max_ns{0};
  std::uint32_t overruns{0};  ///< cycles that overran, blamed on this function; of a thread: all
};

/// Times of one function or thread. One realtime thread writes; each word stands alone, so a reader may be one run off.
///
/// A doubling of the time has 2^kSubBits bins, below that each nanosecond its own, of which the first kSkipped are put together;
/// readers interpolate. A reset only raises the number that all records are held against; each is emptied by its thread at its next run.
template <unsigned kSubBits, unsigned kSkipped>
struct BasicTimingRecord {
  static constexpr std::uint32_t kSubBins = 1U << kSubBits;
  static constexpr std::uint32_t kLongestNs = (1U << 29U) - 1;  ///< longer ones count as this
  static constexpr std::size_t kBins = ((29U - kSubBits + 1) << kSubBits) - kSkipped;

  rtapi::Word<std::uint32_t> epoch{0};  ///< of the reset that it counts from
  rtapi::Word<std::uint32_t> max_ns{0};
  /// What a run takes, in ticks of the thread's counter, times 16: a moving mean over some 16 runs. The thread's own.
  rtapi::Word<std::uint64_t> usual16{0};
  rtapi::Word<std::uint32_t> bins[kBins];
  rtapi::Word<std::uint32_t> overruns{0};

  static constexpr std::size_t bin_of(std::uint32_t ns) noexcept {
    if (ns <= kSkipped) return 0;
    if (ns < kSubBins) return ns - kSkipped;
    const auto octave = static_cast<std::uint32_t>(std::bit_width(ns)) - 1;
    const std::uint32_t place =
        ((octave - kSubBits + 1) << kSubBits) + ((ns >> (octave - kSubBits)) & (kSubBins - 1));
    return place - kSkipped;
  }
  /// Shortest time of a bin.
  static constexpr std::uint32_t bin_begin(std::size_t bin) noexcept {
    if (bin == 0) return 0;
    const auto place = static_cast<std::uint32_t>(bin) + kSkipped;
    if (place < kSubBins) return place;
    return (kSubBins + place % kSubBins) << (place / kSubBins - 1);
  }

  /// @rt. Empties the record when there was a reset since its last run.
  void follow(std::uint32_t now_epoch) noexcept {
    if (epoch.get() != now_epoch) [[unlikely]]
      clear(now_epoch);
  }
  /// @rt. Follow first.
  void add(std::uint32_t ns) noexcept {
    if (ns > kLongestNs) [[unlikely]]
      ns = kLongestNs;
    if (ns > max_ns.get()) [[unlikely]]
      max_ns.set(ns);
    auto& bin = bins[bin_of(ns)];
    const std::uint32_t n = bin.get() + 1;
    bin.set(n);
    if (n == UINT32_MAX) [[unlikely]]
      halve();
  }
  /// @rt. One more cycle that overran for this one's sake.
  void blame() noexcept { overruns.set(overruns.get() + 1); }

  /// All zero when the record is of the time before the reset.
  [[nodiscard]] FunctionStats stats(std::uint32_t now_epoch) const noexcept;

 private:
  [[gnu::noinline, gnu::cold]] void clear(std::uint32_t now_epoch) noexcept {
    for (auto& bin : bins) bin.set(0);
    overruns.set(0);
    max_ns.set(0);
    epoch.set(now_epoch);
  }
  /// Days of runs in one bin: old ones fade, the percentiles stay what they are.
  [[gnu::noinline, gnu::cold]] void halve() noexcept {
    for (auto& bin : bins) bin.set(bin.get() / 2);
  }
};
/// Of a function.
using TimingRecord = BasicTimingRecord<2, 7>;
/// Of a thread: percentiles within 2 %.
using ThreadTimingRecord = BasicTimingRecord<5, 0>;
static_assert(TimingRecord::bin_of(TimingRecord::kLongestNs) == TimingRecord::kBins - 1);
static_assert(ThreadTimingRecord::bin_of(ThreadTimingRecord::kLongestNs) ==
              ThreadTimingRecord::kBins - 1);

/// What is known of a cycle that did not end in time. `functions` stand in a row in the thread's list; 1: it was that one.
struct Overrun {
  std::uint64_t cycle{0};         ///< number of the thread's cycle
  std::int64_t took_ns{0};        ///< from the cycle's start to its end
  std::int64_t woken_late_ns{0};  ///< from the planned to the real start
  std::uint64_t function{
      0};  ///< Offset of the (first) FunctionRecord; 0: the late wake-up is to blame
  std::uint64_t last_function{0};
  std::uint32_t functions{0};
  std::uint32_t function_ns{0};        ///< how long they ran
  std::uint32_t function_usual_ns{0};  ///< and how long they run as a rule
};

}  // namespace kerf::hal
