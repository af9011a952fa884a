#include "task/interpreter/spline_cubics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "task/interpreter/spline_vec.hpp"

namespace kerf::task {
namespace {

using spline::Vec;

constexpr double kNothing = 1e-6;  ///< mm; shorter than this there is no direction to be had
constexpr int kCells = 64;         ///< of the table of lengths, in each knot span
constexpr std::size_t kMostPieces = 32768;  ///< in one run
constexpr double kShortestPiece =
    1e-3;                         ///< mm; a bend that needs shorter ones is a cusp to a machine
constexpr double kGrowth = 2.01;  ///< of neighbouring pieces
constexpr int kChecks = 6;        ///< places of each piece that are compared with the curve
/// How far |q'| may be from 1: speeds are true within it.
constexpr double kEven = 1e-3;
/// Slower by the parameter than this share of its fastest the curve stands.
constexpr double kStands = 1e-6;
/// Where it stands at an end it has the direction that it has so far behind it (of a cell).
constexpr double kBehind = 1e-4;
/// Spans that bend too tightly are left out of so many runs; what is left of the curve then is no cubics either.
constexpr int kMostTight = 32;

/// The whole curve by its length, and where it stands.
class Lengths {
 public:
  explicit Lengths(const interp::NurbsCurve& curve) : curve_(curve), at_{0} {
    const int spans = curve.spans();
    std::vector<double> slowest(static_cast<std::size_t>(spans), 1e99);
    std::vector<double> at_knot(static_cast<std::size_t>(spans) + 1, 1e99);
    for (int span = 0; span < spans; ++span) {
      for (int i = 0; i < kCells; ++i) {
        const double u = span + 1.0 * i / kCells;
        at_.push_back(at_.back() + length_between(u, u + 1.0 / kCells, span));
        fastest_ = std::max({fastest_, speed(u, span), speed(u + 1.0 / kCells, span)});
        double& slow = slowest[static_cast<std::size_t>(span)];
        if (i > 0) slow = std::min(slow, speed(u, span));
      }
      for (const int knot : {span, span + 1}) {
        double& slow = at_knot[static_cast<std::size_t>(knot)];
        slow = std::min(slow, speed(knot, span));
      }
    }
    for (const double v : slowest) stands_within_.push_back(stands(v));
    for (const double v : at_knot) stands_at_.push_back(stands(v));
  }
  [[nodiscard]] bool stands_within(int span) const {
    return stands_within_[static_cast<std::size_t>(span)];
  }
  [[nodiscard]] bool stands_at(int knot) const {
    return stands_at_[static_cast<std::size_t>(knot)];
  }
  /// From the begin of the curve.
  [[nodiscard]] double at_knot(int knot) const {
    return at_[static_cast<std::size_t>(knot) * kCells];
  }
  [[nodiscard]] int span_of(double s) const { return static_cast<int>(cell_of(s)) / kCells; }

  /// Place and unit tangent at a length, seen from the spans [first, last).
  void place(double s, int first, int last, Vec& point, Vec& tangent) const {
    const std::size_t cell = std::clamp(cell_of(s), static_cast<std::size_t>(first) * kCells,
                                        static_cast<std::size_t>(last) * kCells - 1);
    const int span = static_cast<int>(cell) / kCells;
    const double u0 = static_cast<double>(cell) / kCells, u1 = u0 + 1.0 / kCells;
    const double part = at_[cell + 1] - at_[cell];
    double u = part > 0 ? u0 + (u1 - u0) * (s - at_[cell]) / part : u0;
    for (int i = 0; i < 8; ++i) {
      const double step =
          (at_[cell] + length_between(u0, u, span) - s) / std::max(speed(u, span), 1e-300);
      u = std::clamp(u - step, u0, u1);
      if (std::fabs(step) < 1e-14) break;
    }
    interp::CurvePoint p = curve_.at(u, span);
    point = {p.x, p.y};
    const double behind = kBehind / kCells;
    if (stands(std::hypot(p.dx, p.dy)))
      p = curve_.at(u - u0 < u1 - u ? u + behind : u - behind, span);
    const double v = std::hypot(p.dx, p.dy);
    tangent = {p.dx / v, p.dy / v};
  }

 private:
  [[nodiscard]] bool stands(double v) const { return !(v > kStands * fastest_); }
  [[nodiscard]] std::size_t cell_of(double s) const {
    const auto above = std::upper_bound(at_.begin(), at_.end(), s) - at_.begin();
    return std::clamp<std::size_t>(static_cast<std::size_t>(above), 1, at_.size() - 1) - 1;
  }
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
  std::vector<double> at_;  ///< length at each cell's begin, and the whole
  double fastest_{0};
  std::vector<bool> stands_within_, stands_at_;
};

/// The spans [first, last) of a curve, which has a direction and a curvature everywhere between their ends.
class Run {
 public:
  Run(const Lengths& curve, int first, int last) : curve_(curve), first_(first), last_(last) {}
  [[nodiscard]] double length() const { return curve_.at_knot(last_) - curve_.at_knot(first_); }
  /// Place and unit tangent at a length.
  void place(double s, Vec& point, Vec& tangent) const {
    curve_.place(curve_.at_knot(first_) + s, first_, last_, point, tangent);
  }

 private:
  const Lengths& curve_;
  int first_, last_;
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
/// it is and nowhere else. Else where it bends too tightly for that.
std::optional<double> fit(const Run& run, double tolerance_mm, std::vector<CubicPiece>& out) {
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
      return {};
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
      if (halve[i] != 0 && spline.h(i) < 2 * kShortestPiece) return (knots[i] + knots[i + 1]) / 2;
      if (halve[i] != 0) next.push_back((knots[i] + knots[i + 1]) / 2);
      next.push_back(knots[i + 1]);
    }
    if (next.size() > kMostPieces) return run.length() / 2;
    knots = std::move(next);
  }
}

/// Appends to a curve's parts what its spans [first, last) are.
class Parts {
 public:
  Parts(const interp::NurbsCurve& curve, double tolerance_mm)
      : curve_(curve), length_(curve), tolerance_(tolerance_mm) {}

  std::vector<SplinePart> run() {
    const int spans = curve_.spans();
    // From order 4 on curvature goes on over the knots; below that each span has its own.
    const bool goes_on = curve_.order() >= 4;
    for (int first = 0, last = 1; first < spans; first = last, ++last) {
      if (length_.stands_within(first)) {
        arcs(first, last);
        continue;
      }
      while (goes_on && last < spans && !length_.stands_at(last) && !length_.stands_within(last))
        ++last;
      cubics(first, last);
    }
    return std::move(parts_);
  }

 private:
  void arcs(int first, int last) {
    std::vector<SplinePiece> pieces = spline_pieces(curve_, first, last);
    if (!pieces.empty()) parts_.push_back({{}, std::move(pieces)});
  }
  /// Spans that bend too tightly are arcs, and those before and behind them are tried without.
  void cubics(int first, int last) {
    std::vector<std::pair<int, int>> left{{first, last}};
    while (!left.empty()) {
      std::tie(first, last) = left.back();
      left.pop_back();
      if (first >= last) continue;
      const Run run(length_, first, last);
      if (!(run.length() > kNothing)) continue;
      SplinePart part;
      const auto tight = tight_ < kMostTight ? fit(run, tolerance_, part.cubics) : 0.0;
      if (!tight) {
        parts_.push_back(std::move(part));
      } else if (last - first == 1 || tight_ >= kMostTight) {
        arcs(first, last);
      } else {
        ++tight_;
        const int span =
            std::clamp(length_.span_of(length_.at_knot(first) + *tight), first, last - 1);
        left.emplace_back(span + 1, last);
        left.emplace_back(span, span + 1);
        left.emplace_back(first, span);
      }
    }
  }

  const interp::NurbsCurve& curve_;
  Lengths length_;
  double tolerance_;
  int tight_{0};  ///< spans so far
  std::vector<SplinePart> parts_;
};

}  // namespace

std::vector<SplinePart> spline_parts(const interp::NurbsCurve& curve, double tolerance_mm) {
  return Parts(curve, tolerance_mm).run();
}

}  // namespace kerf::task
