// Splines as cubics of their own length: what motion::CubicMove carries. The curvature of the spline is kept, so the machine need not slow down
// where two pieces meet, and the pieces follow the curve within a ten-thousandth of a millimetre.
// Source: clamped cubic splines through points at known lengths (de Boor, A Practical Guide to Splines).
#pragma once

#include <vector>

#include "interp/nurbs.hpp"

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

/// Empty when the curve cannot be had so: a point, or a cusp, where it has no direction.
[[nodiscard]] std::vector<CubicPiece> spline_cubics(const interp::NurbsCurve& curve,
                                                    double tolerance_mm = kCubicTolerance);

}  // namespace kerf::task
