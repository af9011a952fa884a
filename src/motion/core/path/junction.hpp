// Junction: the blend between two pieces of which at least one is an arc or a spline.
//
// With jerk limits a cubic of three spans that takes over position, direction and curvature from both sides; for two straights it is the
// trapezoid of smoothing.hpp. Without them curvature may jump, and there are more to choose from: the programmed path plus the
// kink times D, D'' being even pieces of +k around the vertex and -k on both sides of them. Without the latter D is a parabola on the inside;
// with them the curve swings out before and behind the vertex, uses both sides of the tolerance and bends half as hard on four times the way. The one that is
// passed in the least time is taken: shallow kinks gain from swinging out, sharp ones do not, as the speed has to be low all along.
#pragma once

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/tolerance.hpp"

namespace kerf::motion::path {

struct JunctionSettings {
  Tolerance tolerance;
  double reach_a{0},
      reach_b{
          0};  ///< the most that may be taken from the end of the one and the start of the other (sigma)
  Vec low, high;  ///< no blend leaves this box, which the two pieces keep to themselves
  AxisLimits limits;
};

/// Appends up to four pieces (the middle span is divided at the vertex) that replace the last `l` of `a` and the first `l` of `b`, and
/// gives l; 0 when no blend fits.
double blend_junction(const Piece& a, const Piece& b, const JunctionSettings& settings,
                      Buffer<Piece>& out) noexcept;

}  // namespace kerf::motion::path
