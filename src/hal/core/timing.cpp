#include "hal/core/timing.hpp"

#include <algorithm>

namespace kerf::hal {

const char* timing_mode_name(TimingMode mode) noexcept {
  switch (mode) {
    case TimingMode::off: return "off";
    case TimingMode::sampled: return "sampled";
    case TimingMode::every: return "every";
  }
  return "?";
}

std::optional<TimingMode> timing_mode_of(std::string_view name) noexcept {
  for (const auto mode : {TimingMode::off, TimingMode::sampled, TimingMode::every}) {
    if (name == timing_mode_name(mode)) return mode;
  }
  return std::nullopt;
}

template <unsigned kSubBits, unsigned kSkipped>
FunctionStats BasicTimingRecord<kSubBits, kSkipped>::stats(std::uint32_t now_epoch) const noexcept {
  FunctionStats out;
  if (epoch.get() != now_epoch) return out;
  std::uint32_t copy[kBins];
  double sum_ns = 0;
  // The runs of a bin are taken to be spread evenly over it.
  const auto end_of = [](std::size_t bin) {
    return bin + 1 < kBins ? bin_begin(bin + 1) : kLongestNs + 1;
  };
  for (std::size_t i = 0; i < kBins; ++i) {
    copy[i] = bins[i].get();
    out.count += copy[i];
    sum_ns += copy[i] * (static_cast<double>(bin_begin(i)) + end_of(i)) / 2;
  }
  out.max_ns = max_ns.get();
  out.overruns = overruns.get();
  if (out.count == 0) return out;
  const auto total = static_cast<double>(out.count);
  out.mean_ns = std::min(static_cast<std::int64_t>(sum_ns / total), out.max_ns);
  const auto percentile = [&](double share) {
    const double wanted = share * total;
    double below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      const double here = copy[i];
      if (copy[i] == 0 || below + here < wanted) {
        below += here;
        continue;
      }
      const double begin = bin_begin(i);
      const double ns = begin + (end_of(i) - begin) * (wanted - below) / here;
      return std::min(static_cast<std::int64_t>(ns), out.max_ns);
    }
    return out.max_ns;
  };
  out.p50_ns = percentile(0.5);
  out.p99_ns = percentile(0.99);
  out.p999_ns = percentile(0.999);
  return out;
}

template struct BasicTimingRecord<2, 7>;
template struct BasicTimingRecord<5, 0>;

}  // namespace kerf::hal
