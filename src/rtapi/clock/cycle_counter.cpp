#include "rtapi/clock/cycle_counter.hpp"

#include "rtapi/clock/real_clock.hpp"
#if defined(__x86_64__)
#include <cpuid.h>
#include <time.h>
#endif

namespace kerf::rtapi {

namespace {

std::uint64_t read_monotonic(const void* /*self*/) noexcept {
  return static_cast<std::uint64_t>(monotonic_now());
}

#if defined(__x86_64__)

constexpr Nanos kInterval = 2 * kMillisecond;
/// Two intervals must agree so well; what a disturbed reading of one end costs is far below.
constexpr double kTolerance = 1e-3;

bool counter_is_invariant() noexcept {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  // The bit of "invariant TSC": one rate in all states of power and speed, the same on all processors.
  return __get_cpuid(0x80000007U, &a, &b, &c, &d) != 0 && (d & (1U << 8U)) != 0;
}

std::uint64_t read_processors(const void* /*self*/) noexcept { return __builtin_ia32_rdtsc(); }

struct Moment {
  std::uint64_t ticks;
  Nanos ns;
};

/// Both clocks at one moment: of several tries the one that was disturbed least.
Moment moment() noexcept {
  Moment best{};
  std::uint64_t least = UINT64_MAX;
  for (int i = 0; i < 8; ++i) {
    const std::uint64_t before = __builtin_ia32_rdtsc();
    const Nanos ns = monotonic_now();
    const std::uint64_t took = __builtin_ia32_rdtsc() - before;
    if (took >= least) continue;
    least = took;
    best = {before + took / 2, ns};
  }
  return best;
}

Moment moment_after(const Moment& last) noexcept {
  const timespec pause{0, static_cast<long>(kInterval)};
  (void)::nanosleep(&pause, nullptr);
  for (;;) {
    const Moment now = moment();
    if (now.ns - last.ns >= kInterval / 2) return now;
  }
}

double rate(const Moment& a, const Moment& b) noexcept {
  return static_cast<double>(b.ticks - a.ticks) / static_cast<double>(b.ns - a.ns);
}

#endif

}  // namespace

CycleCounter CycleCounter::monotonic() noexcept {
  CycleCounter counter;
  counter.read_ = &read_monotonic;
  return counter;
}

CycleCounter CycleCounter::calibrated() noexcept {
#if defined(__x86_64__)
  if (!counter_is_invariant()) return monotonic();
  const Moment first = moment();
  const Moment second = moment_after(first);
  const Moment third = moment_after(second);
  const double whole = rate(first, third);
  const double apart = rate(first, second) / rate(second, third) - 1;
  // Below one tick a nanosecond it would tell less than CLOCK_MONOTONIC does.
  if (!(whole >= 1) || apart > kTolerance || apart < -kTolerance) return monotonic();
  CycleCounter counter;
  counter.read_ = &read_processors;
  counter.self_ = &kProcessors;
  counter.ns_per_tick_ = static_cast<std::uint64_t>(4294967296.0 / whole);
  return counter;
#else
  return monotonic();
#endif
}

}  // namespace kerf::rtapi
