// How benchmarks time a servo cycle.
#pragma once

#include <chrono>

namespace kerf::bench {

/// A cycle that took longer was interrupted by the system [s].
inline constexpr double kInterrupted = 50e-6;

inline double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace kerf::bench
