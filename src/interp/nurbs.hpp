// NurbsCurve: the curve that Canon::nurbs_feed means, for task and for lengths in inverse-time mode.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "interp/canon.hpp"

namespace kerf::interp {

/// Highest order (G5.2 L); more has no use and would need memory.
inline constexpr int kHighestOrder = 16;

/// A place on a curve: point and derivative by the parameter.
struct CurvePoint {
  double x{0}, y{0}, dx{0}, dy{0};
};

/// A clamped uniform NURBS; see Canon::nurbs_feed. Needs as many points as its order, 2 <= order <= kHighestOrder.
class NurbsCurve {
 public:
  NurbsCurve(std::span<const SplinePoint> points, int order)
      : points_(points.begin(), points.end()), order_(order) {}

  /// The parameter runs from 0 to spans(); whole numbers are the knots, between them the curve is smooth.
  [[nodiscard]] int spans() const { return static_cast<int>(points_.size()) - order_ + 1; }
  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] CurvePoint at(double u) const;
  /// The same seen from one span, so that derivatives at its ends are those of its side.
  [[nodiscard]] CurvePoint at(double u, int span) const;
  /// Length, to about a millionth of it.
  [[nodiscard]] double length() const;

 private:
  [[nodiscard]] double knot(int i) const;

  std::vector<SplinePoint> points_;
  int order_;
};

}  // namespace kerf::interp
