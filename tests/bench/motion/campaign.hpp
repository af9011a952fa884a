// Campaign: random programs while an operator changes overrides, holds, resumes and aborts, for as many servo cycles as wanted; every joint in
// every cycle against its limits, by differences of the commanded positions.
#pragma once

#include <cstdint>

namespace kerf::bench {

struct CampaignResult {
  std::uint64_t cycles{0}, programs{0}, holds{0}, aborts{0}, overrides{0};
  std::uint64_t exceptions{0};     ///< cycles beyond a limit, faults, and programs that never end
  std::uint64_t bad_seed{0};       ///< of the first program with an exception
  double vel{0}, acc{0}, jerk{0};  ///< largest shares: at most 1.0001, 1.001 and 1.01
};

/// Half of the programs limited in acceleration, half in jerk (5000 to 1e6 mm/s3).
[[nodiscard]] CampaignResult campaign(std::uint64_t cycles, std::uint64_t seed);
void print(const CampaignResult& result);

}  // namespace kerf::bench
