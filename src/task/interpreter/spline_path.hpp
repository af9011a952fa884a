// Splines as arcs: motion knows lines and arcs, so a spline becomes arcs that touch each other with one tangent.
#pragma once

#include <vector>

#include "interp/nurbs.hpp"

namespace kerf::task {

/// Largest distance between a spline and the arcs that stand for it (mm). A hundredth of what machines of this kind hold, and
/// still only some ten arcs for a curve of the size of a hand.
inline constexpr double kSplineTolerance = 0.001;

/// A piece from where the one before ends.
struct SplinePiece {
  double x{0}, y{0};    ///< its end
  double cx{0}, cy{0};  ///< centre, of an arc
  int turn{0};          ///< 0: straight; 1: counter-clockwise arc; -1: clockwise
};

/// The spans [first, last) as arcs (straight pieces where the curve is straight) no further than `tolerance_mm` from the curve. Neighbours share the
/// tangent wherever the curve has one; each arc is less than half a circle.
[[nodiscard]] std::vector<SplinePiece> spline_pieces(const interp::NurbsCurve& curve, int first,
                                                     int last,
                                                     double tolerance_mm = kSplineTolerance);

}  // namespace kerf::task
