// Prints how often a second the processor's counter ticks (1e9 when it is not used): LinuxCNC tells times in these ticks.
//   tick_rate --reads N   prints how many nanoseconds N reads of it take, and nothing between them
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "rtapi/clock/cycle_counter.hpp"

int main(int argc, char** argv) {
  const auto counter = kerf::rtapi::CycleCounter::calibrated();
  if (argc != 3 || std::strcmp(argv[1], "--reads") != 0) {
    std::printf("%.0f\n", counter.frequency_hz());
    return 0;
  }
  const int reads = std::atoi(argv[2]);
  std::array<std::uint64_t, 201> times{};
  for (auto& time : times) {
    const std::uint64_t begin = counter.ticks();
    std::uint64_t last = begin;
    for (int i = 0; i < reads; ++i) last = counter.ticks();
    time = last - begin;
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  std::printf("%lld\n", static_cast<long long>(counter.ns(times[times.size() / 2])));
}
