// Replay: what a flight record holds, once more: a controller and a planner of its own, from a standstill on, in as little time as it takes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motion/api/flight_file.hpp"
#include "motion/api/kinematics.hpp"

namespace kerf::motion {

struct ReplayResult {
  std::string error;  ///< why it cannot be run; "" it was
  std::uint64_t from_cycle{0}, cycles{0};
  std::int64_t from_ns{0};
  std::uint64_t differs_at{0};  ///< the first cycle with other positions; 0: none
  struct Met {
    std::uint64_t cycle{0};
    FaultRecord fault;
  };
  std::vector<Met> recorded, replayed;
  /// Each fault of the record was met again in its cycle, and no other; and all positions were the same.
  [[nodiscard]] bool same_faults() const;
  [[nodiscard]] bool same() const { return error.empty() && same_faults() && differs_at == 0; }
};

/// `kinematics`: as the machine had loaded it, in machine units that the record says.
[[nodiscard]] ReplayResult replay(const FlightFile& file, Kinematics& kinematics);
/// What it says, for people; several lines.
[[nodiscard]] std::string report(const ReplayResult& result);
/// The status lines of a record, the last `seconds` of it.
[[nodiscard]] std::string show(const FlightFile& file, double seconds);

}  // namespace kerf::motion
