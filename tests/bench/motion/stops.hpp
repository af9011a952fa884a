// Stops limited in jerk, beside the soonest that is known: what braking and the solver find, nearer and farther ends by the solver, and going on with
// the law for a while before any of these.
#pragma once

#include <cstddef>

#include "bench/motion/families.hpp"

namespace kerf::bench {

struct StopsResult {
  std::size_t moments{0};
  std::size_t searched{0};  ///< braking alone found none there
  std::size_t over{0};      ///< take more than 1.1 of the least time that is known
  double mean{0}, worst{0};
};

/// Of the laws of a program, at moments 7 ms apart, `most` of them: stops as the planner makes them (planner/law_maker.hpp). Machines whose joints are axes.
[[nodiscard]] StopsResult stops(const Program& program, double jerk, std::size_t most);

}  // namespace kerf::bench
