// Where a smooth function turns between values of it that are evenly spaced. Pure arithmetic.
#pragma once

#include <cmath>

namespace kerf::motion {

/// Of the parabola through the values at -1, 0 and 1. `doubt`: a bound of how far the function's own turn is from it, for functions that
/// bend about evenly there (ten times what it is for a sine in steps of 0.07 rad).
struct Turn {
  bool within{false};  ///< between -1 and 1
  double at{0}, value{0}, doubt{0};
};

[[nodiscard]] inline Turn turn_of(double before, double here, double after) noexcept {
  const double slope = 0.5 * (after - before), bend = after - 2 * here + before;
  Turn turn;
  if (!(std::abs(slope) <= std::abs(bend)) || bend == 0) return turn;
  turn.within = true;
  turn.at = -slope / bend;
  turn.value = here + 0.5 * slope * turn.at;
  turn.doubt = 0.05 * std::abs(bend);
  return turn;
}

}  // namespace kerf::motion
