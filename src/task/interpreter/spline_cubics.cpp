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
constexpr std::size_t kMostPieces = 2048;  ///< in one run
constexpr double kShortestPiece =
    1e-3;                         ///< mm; a bend that needs shorter ones is a cusp to a machine
constexpr double kGrowth = 2.01;  ///< of neighbouring pieces
constexpr int kChecks = 6;        ///< places of each piece that are compared with the curve
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

/// The clamped spline through the curve at `knots` (lengths); false at each piece that is too far from it or not by its length.
class Fit {
 public:
  Fit(const Run& run, const std::vector<double>& knots) : run_(run), knot_(knots) {
    const std::size_t last = knots.size() - 1;
    point_.resize(last + 1);
    bend_.resize(last + 1);
    Vec begin, tangent, end;
    for (std::size_t i = 0; i <= last; ++i) {
      run.place(knots[i], point_[i], tangent);
      if (i == 0) begin = tangent;
      if (i == last) end = tangent;
    }
    // Second derivatives m: h(i-1) m(i-1) + 2 (h(i-1) + h(i)) mi + h(i) m(i+1) = 6 (slope(i) - slope(i-1)), at the ends with the curve's tangents.
    std::vector<double> upper(last + 1);
    for (std::size_t i = 0; i <= last; ++i) {
      const double before = i > 0 ? h(i - 1) : 0.0, behind = i < last ? h(i) : 0.0;
      const Vec right = 6.0 * ((i < last ? slope(i) : end) - (i > 0 ? slope(i - 1) : begin));
      const double pivot = 2 * (before + behind) - (i > 0 ? before * upper[i - 1] : 0.0);
      upper[i] = behind / pivot;
      bend_[i] = (1 / pivot) * (i > 0 ? right - before * bend_[i - 1] : right);
    }
    for (std::size_t i = last; i-- > 0;) bend_[i] = bend_[i] - upper[i] * bend_[i + 1];
  }
  [[nodiscard]] double h(std::size_t i) const { return knot_[i + 1] - knot_[i]; }
  [[nodiscard]] bool is_near(std::size_t i, double tolerance_mm) const {
    const Vec first = this->first(i), third = (1 / h(i)) * (bend_[i + 1] - bend_[i]);
    for (int c = 1; c < kChecks; ++c) {
      const double s = h(i) * c / kChecks;
      Vec there, direction;
      run_.place(knot_[i] + s, there, direction);
      const Vec q = point_[i] + s * first + (s * s / 2) * bend_[i] + (s * s * s / 6) * third;
      const Vec along = first + s * bend_[i] + (s * s / 2) * third;
      if (!(norm(q - there) <= tolerance_mm) || !(std::fabs(norm(along) - 1) <= kEven))
        return false;
    }
    return true;
  }
  [[nodiscard]] CubicPiece piece(std::size_t i) const {
    const Vec first = this->first(i);
    return {point_[i + 1].x, point_[i + 1].y, first.x, first.y, bend_[i].x, bend_[i].y, h(i)};
  }

 private:
  [[nodiscard]] Vec slope(std::size_t i) const { return (1 / h(i)) * (point_[i + 1] - point_[i]); }
  [[nodiscard]] Vec first(std::size_t i) const {
    return slope(i) - (h(i) / 6) * (2.0 * bend_[i] + bend_[i + 1]);
  }

  const Run& run_;
  const std::vector<double>& knot_;
  std::vector<Vec> point_, bend_;
};

/// Pieces that are not near are halved, and those that are more than twice as long as their neighbours, so that a tight bend makes short pieces where
/// it is and nowhere else. False: too many, or too short.
bool fit(const Run& run, double tolerance_mm, std::vector<CubicPiece>& out) {
  std::vector<double> knots{0, run.length()};
  for (;;) {
    const Fit spline(run, knots);
    const std::size_t count = knots.size() - 1;
    std::vector<char> halve(count);
    bool good = true;
    for (std::size_t i = 0; i < count; ++i) {
      if (spline.is_near(i, tolerance_mm)) continue;
      halve[i] = 1;
      good = false;
    }
    if (good) {
      for (std::size_t i = 0; i < count; ++i) out.push_back(spline.piece(i));
      return true;
    }
    const auto length = [&](std::size_t i) { return spline.h(i) / (halve[i] != 0 ? 2 : 1); };
    for (bool more = true; more;) {
      more = false;
      for (std::size_t i = 0; i < count; ++i) {
        const double beside =
            std::min(i > 0 ? length(i - 1) : 1e99, i + 1 < count ? length(i + 1) : 1e99);
        if (halve[i] != 0 || length(i) <= kGrowth * beside) continue;
        halve[i] = 1;
        more = true;
      }
    }
    std::vector<double> next{0};
    for (std::size_t i = 0; i < count; ++i) {
      if (halve[i] != 0 && spline.h(i) < 2 * kShortestPiece) return false;
      if (halve[i] != 0) next.push_back((knots[i] + knots[i + 1]) / 2);
      next.push_back(knots[i + 1]);
    }
    if (next.size() > kMostPieces) return false;
    knots = std::move(next);
  }
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
    if (!fit(run, tolerance_mm, out)) return {};
  }
  return out;
}

}  // namespace kerf::task
