#include "task/interpreter/spline_cubics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "task/interpreter/spline_vec.hpp"

namespace kerf::task {
namespace {

using spline::Vec;

constexpr double kNothing = 1e-6;  ///< mm; shorter than this there is no direction to be had
constexpr int kCells = 64;         ///< of the table of lengths, in each knot span
constexpr int kMostPieces = 2048;  ///< in one run
constexpr int kChecks = 6;         ///< places of each piece that are compared with the curve
/// How far |q'| may be from 1: speeds are true within it.
constexpr double kEven = 1e-3;

/// Part of a curve between two knots that has a direction and a curvature everywhere, by its length.
class Run {
 public:
  Run(const interp::NurbsCurve& curve, int first, int last) : curve_(curve), first_(first) {
    at_.push_back(0);
    double lowest = 1e99, highest = 0;
    for (int span = first; span < last; ++span) {
      for (int i = 0; i < kCells; ++i) {
        const double u0 = span + 1.0 * i / kCells;
        at_.push_back(at_.back() + length_between(u0, u0 + 1.0 / kCells, span));
        const double v = speed(u0, span);
        lowest = std::min({lowest, v, speed(u0 + 1.0 / kCells, span)});
        highest = std::max(highest, v);
      }
    }
    cusp_ = !(lowest > 1e-6 * highest);
  }
  [[nodiscard]] double length() const { return at_.back(); }
  [[nodiscard]] bool has_cusp() const { return cusp_; }

  /// Place and unit tangent at a length.
  void place(double s, Vec& point, Vec& tangent) const {
    s = std::clamp(s, 0.0, length());
    auto cell = static_cast<std::size_t>(std::upper_bound(at_.begin(), at_.end(), s) - at_.begin());
    cell = std::clamp<std::size_t>(cell, 1, at_.size() - 1) - 1;
    const int span = first_ + static_cast<int>(cell) / kCells;
    const double u0 = first_ + static_cast<double>(cell) / kCells, u1 = u0 + 1.0 / kCells;
    const double part = at_[cell + 1] - at_[cell];
    double u = part > 0 ? u0 + (u1 - u0) * (s - at_[cell]) / part : u0;
    for (int i = 0; i < 8; ++i) {
      const double step =
          (at_[cell] + length_between(u0, u, span) - s) / std::max(speed(u, span), 1e-300);
      u = std::clamp(u - step, u0, u1);
      if (std::fabs(step) < 1e-14) break;
    }
    const interp::CurvePoint p = curve_.at(u, span);
    point = {p.x, p.y};
    const double v = std::hypot(p.dx, p.dy);
    tangent = {p.dx / v, p.dy / v};
  }

 private:
  [[nodiscard]] double speed(double u, int span) const {
    const interp::CurvePoint p = curve_.at(u, span);
    return std::hypot(p.dx, p.dy);
  }
  /// Gauss-Legendre with five places.
  [[nodiscard]] double length_between(double u0, double u1, int span) const {
    constexpr std::array<double, 5> kAt{-0.9061798459386640, -0.5384693101056831, 0,
                                        0.5384693101056831, 0.9061798459386640};
    constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665,
                                            0.5688888888888889, 0.4786286704993665,
                                            0.2369268850561891};
    double sum = 0;
    for (std::size_t i = 0; i < 5; ++i)
      sum += kWeight[i] / 2 * speed((u0 + u1) / 2 + (u1 - u0) / 2 * kAt[i], span);
    return sum * (u1 - u0);
  }

  const interp::NurbsCurve& curve_;
  int first_;
  std::vector<double> at_;  ///< length at each cell's begin, and the whole
  bool cusp_{false};
};

/// The clamped spline of n pieces of even length. False: too far from the curve.
bool fit(const Run& run, int n, double tolerance_mm, std::vector<CubicPiece>& out) {
  const auto count = static_cast<std::size_t>(n);
  const double h = run.length() / n;
  std::vector<Vec> point(count + 1), tangent(count + 1), bend(count + 1);
  for (std::size_t i = 0; i <= count; ++i)
    run.place(h * static_cast<double>(i), point[i], tangent[i]);
  // Second derivatives m: 2 m0 + m1 = r0, m(i-1) + 4 mi + m(i+1) = ri, and like the first at the end.
  std::vector<double> upper(count + 1);
  const double k = 6 / h;
  upper[0] = 0.5;
  bend[0] = 0.5 * (k * ((1 / h) * (point[1] - point[0]) - tangent[0]));
  for (std::size_t i = 1; i <= count; ++i) {
    const bool last = i == count;
    const Vec right = last ? k * (tangent[i] - (1 / h) * (point[i] - point[i - 1]))
                           : (k / h) * (point[i + 1] - 2.0 * point[i] + point[i - 1]);
    const double pivot = (last ? 2.0 : 4.0) - upper[i - 1];
    upper[i] = 1 / pivot;
    bend[i] = (1 / pivot) * (right - bend[i - 1]);
  }
  for (std::size_t i = count; i-- > 0;) bend[i] = bend[i] - upper[i] * bend[i + 1];
  const std::size_t before = out.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec first = (1 / h) * (point[i + 1] - point[i]) - (h / 6) * (2.0 * bend[i] + bend[i + 1]);
    const Vec third = (1 / h) * (bend[i + 1] - bend[i]);
    for (int c = 1; c < kChecks; ++c) {
      const double s = h * c / kChecks;
      Vec there, direction;
      run.place(h * static_cast<double>(i) + s, there, direction);
      const Vec q = point[i] + s * first + (s * s / 2) * bend[i] + (s * s * s / 6) * third;
      const Vec slope = first + s * bend[i] + (s * s / 2) * third;
      if (!(norm(q - there) <= tolerance_mm) || !(std::fabs(norm(slope) - 1) <= kEven)) {
        out.resize(before);
        return false;
      }
    }
    out.push_back({point[i + 1].x, point[i + 1].y, first.x, first.y, bend[i].x, bend[i].y, h});
  }
  return true;
}

}  // namespace

std::vector<CubicPiece> spline_cubics(const interp::NurbsCurve& curve, double tolerance_mm) {
  std::vector<CubicPiece> out;
  // From order 4 on curvature goes on over the knots; below that each span has its own.
  const int step = curve.order() >= 4 ? curve.spans() : 1;
  for (int first = 0; first < curve.spans(); first += step) {
    const Run run(curve, first, std::min(first + step, curve.spans()));
    if (!(run.length() > kNothing)) continue;
    if (run.has_cusp()) return {};
    int n = 1;
    while (n <= kMostPieces && !fit(run, n, tolerance_mm, out)) n *= 2;
    if (n > kMostPieces) return {};
  }
  return out;
}

}  // namespace kerf::task
