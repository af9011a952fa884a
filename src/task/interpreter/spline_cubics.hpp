// Splines as cubics of their own length, and as arcs where they have none: what motion::CubicMove carries. The curvature of the spline is kept, so the machine need not slow down
// where two pieces meet, and the pieces follow the curve within a ten-thousandth of a millimetre.
// Source: clamped cubic splines through points at known lengths (de Boor, A Practical Guide to Splines).
#pragma once

#include <vector>

#include "interp/nurbs.hpp"
#include "task/interpreter/spline_path.hpp"

namespace kerf::task {

/// Largest distance between a spline and the cubics that stand for it (mm).
inline constexpr double kCubicTolerance = 1e-4;

/// A piece from where the one before ends; s is its length and runs from 0 to `length`.
struct CubicPiece {
  double x{0}, y{0};      ///< its end
  double dx{0}, dy{0};    ///< derivative by s at its begin: the unit tangent, within a thousandth
  double ddx{0}, ddy{0};  ///< second derivative there: the curvature
  double length{0};
};

/// Of a curve, in its order: cubics, or arcs (spline_path.hpp) where it has no direction (a cusp) or bends too tightly for them. One of both is empty.
struct SplinePart {
  std::vector<CubicPiece> cubics;
  std::vector<SplinePiece> arcs;
};

/// A part ends where the curve has no direction, or no curvature that goes on. What is a point has no parts.
[[nodiscard]] std::vector<SplinePart> spline_parts(const interp::NurbsCurve& curve,
                                                   double tolerance_mm = kCubicTolerance);

}  // namespace kerf::task
