// Junction: the blend between two pieces of which at least one is an arc or a spline: a cubic of three spans that takes over position,
// direction and curvature from both sides. For two straights it is the trapezoid of smoothing.hpp.
//
// Of several shapes the one that is passed fastest is taken. Most swing out before and behind the vertex, so that both sides of the tolerance are
// used and they bend less: on more of the way, which pays where the kink is shallow, or in a core about the vertex, where it is sharp.
#pragma once

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/tolerance.hpp"

namespace kerf::motion::path {

inline constexpr std::size_t kJunctionPieces = 8;

struct JunctionSettings {
  Tolerance tolerance;
  double reach_a{0},
      reach_b{
          0};  ///< the most that may be taken from the end of the one and the start of the other (sigma)
  /// A whole short move between the two that the blend takes the place of too; nullptr: they meet.
  const Piece* over{nullptr};
  Vec low, high;  ///< no blend leaves this box, which the two pieces keep to themselves
  AxisLimits limits;
  bool by_law{true};  ///< as in PathSettings
};

/// Appends up to kJunctionPieces pieces (one ends at the vertex, or in the middle of `over`) that replace the last `l` of `a` and the first `l` of
/// `b`, and gives l; 0 when no blend fits.
double blend_junction(const Piece& a, const Piece& b, const JunctionSettings& settings,
                      Buffer<Piece>& out) noexcept;

}  // namespace kerf::motion::path
