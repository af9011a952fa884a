// Tolerance: how far the path may be from what is programmed (G64 P).
#pragma once

#include <algorithm>
#include <cmath>

#include "motion/core/path/vec.hpp"

namespace kerf::motion::path {

struct Tolerance {
  double mm{0};   ///< XYZ together and UVW together each stay within it
  double deg{0};  ///< each of A B C

  /// A deviation as a share of what is allowed: at most 1 is within tolerance.
  [[nodiscard]] double share(const Vec& off) const noexcept {
    double s = std::max(norm3(off, 0), norm3(off, 6)) / mm;
    for (std::size_t i = 3; i < 6; ++i)
      if (off[i] != 0) s = std::max(s, std::abs(off[i]) / deg);
    return s;
  }
};

}  // namespace kerf::motion::path
