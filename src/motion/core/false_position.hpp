// False position with halved weights (Illinois): a handful of steps where halving takes forty. @rt.
// Source: Dowell and Jarratt, A modified regula falsi method for computing the root of an equation (1971).
#pragma once

#include <cmath>

namespace kerf::motion {

/// How finely it is looked for.
struct Fineness {
  double same{1e-12};      ///< of the argument, as a share of its upper bound
  double rounding{1e-13};  ///< of the value
  int steps{52};
};

/// The largest argument in [low, high] at which `value`, which grows with it, is at most `allowed`; at `low` it is taken to be, also where it
/// misses that by what rounding does.
template <class F>
double largest_within(double low, double high, double allowed, F&& value,
                      const Fineness& fine = {}) noexcept {
  double below = value(low) - allowed, above = value(high) - allowed;
  if (above <= 0) return high;
  int side = 0;
  for (int i = 0; i < fine.steps && high - low > fine.same * std::abs(high); ++i) {
    if (below >= -fine.rounding) break;
    const double middle =
        i % 8 == 7 ? 0.5 * (low + high) : low - below * (high - low) / (above - below);
    const double off = value(middle) - allowed;
    if (off <= 0) {
      low = middle;
      below = off;
      if (side < 0) above *= 0.5;
      side = -1;
    } else {
      high = middle;
      above = off;
      if (side > 0) below *= 0.5;
      side = 1;
    }
  }
  return low;
}

}  // namespace kerf::motion
