#include "interp/nurbs.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::interp {

double NurbsCurve::knot(int i) const { return std::clamp(i - order_ + 1, 0, spans()); }

CurvePoint NurbsCurve::at(double u) const {
  return at(u, std::clamp(static_cast<int>(u), 0, spans() - 1));
}

// De Boor's algorithm on homogeneous points (w x, w y, w). The last two points before the final step give the derivative.
CurvePoint NurbsCurve::at(double u, int span) const {
  struct Homogeneous {
    double x, y, w;
  };
  const int degree = order_ - 1;
  std::array<Homogeneous, kHighestOrder> d;  // NOLINT(*-member-init): filled below
  for (int j = 0; j <= degree; ++j) {
    const SplinePoint& p = points_[static_cast<std::size_t>(span) + static_cast<std::size_t>(j)];
    d[static_cast<std::size_t>(j)] = {p.x * p.weight, p.y * p.weight, p.weight};
  }
  const int k = span + degree;
  double slope_scale = 0;
  Homogeneous slope{0, 0, 0};
  for (int r = 1; r <= degree; ++r) {
    for (int j = degree; j >= r; --j) {
      const double low = knot(k - degree + j), high = knot(k + 1 + j - r);
      const double t = (u - low) / (high - low);
      Homogeneous& b = d[static_cast<std::size_t>(j)];
      const Homogeneous& a = d[static_cast<std::size_t>(j - 1)];
      if (r == degree) {
        slope_scale = degree / (high - low);
        slope = {b.x - a.x, b.y - a.y, b.w - a.w};
      }
      b = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.w + t * (b.w - a.w)};
    }
  }
  const Homogeneous& p = d[static_cast<std::size_t>(degree)];
  CurvePoint c;
  c.x = p.x / p.w;
  c.y = p.y / p.w;
  c.dx = (slope.x - slope.w * c.x) * slope_scale / p.w;
  c.dy = (slope.y - slope.w * c.y) * slope_scale / p.w;
  return c;
}

double NurbsCurve::length() const {
  // Gauss-Legendre with five points on sixteenths of a span.
  constexpr double kAt[] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                            0.9061798459386640};
  constexpr double kWeight[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                0.4786286704993665, 0.2369268850561891};
  constexpr int kParts = 16;
  double sum = 0;
  for (int span = 0; span < spans(); ++span) {
    for (int part = 0; part < kParts; ++part) {
      for (int i = 0; i < 5; ++i) {
        const CurvePoint p = at(span + (part + 0.5 + kAt[i] / 2) / kParts, span);
        sum += kWeight[i] / 2 / kParts * std::hypot(p.dx, p.dy);
      }
    }
  }
  return sum;
}

}  // namespace kerf::interp
