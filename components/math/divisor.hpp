// What invert and div2 divide by.
#pragma once

#include "hal/component.hpp"

namespace kerf::components {

/// `value`, or the deadband with its sign where it is nearer to zero than that. The parameter shows what is used, 1e-12 at least.
inline double divisor(double value, hal::Param<double>& deadband) noexcept {
  constexpr double kLeast = 1e-12;
  if (deadband < kLeast) deadband = kLeast;
  const double least = deadband;
  if (value >= 0.0 && value < least) return least;
  if (value < 0.0 && value > -least) return -least;
  return value;
}

}  // namespace kerf::components
