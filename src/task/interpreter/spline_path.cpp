#include "task/interpreter/spline_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "task/interpreter/spline_vec.hpp"

namespace kerf::task {

namespace {

using spline::Vec;

/// Halvings of one knot span, however odd its weights are.
constexpr int kDeepest = 24;
/// Below this a length says nothing about a direction.
constexpr double kNothing = 1e-9;  ///< mm
/// A larger radius is a line: the centre would be too far away to be exact.
constexpr double kLargestRadius = 1e8;  ///< mm

/// A circular piece from `from` along `tangent` to `to`.
struct Piece {
  Vec from, to, centre;
  double radius{0};  ///< 0: straight
  int turn{0};

  static Piece along(Vec from, Vec tangent, Vec to) {
    Piece p{from, to, {}, 0, 0};
    const Vec chord = to - from;
    const double side = cross(tangent, chord);  // left of the tangent is positive
    const double length2 = dot(chord, chord);
    if (length2 >= 2 * kLargestRadius * std::fabs(side)) return p;
    const double signed_radius = length2 / (2 * side);
    p.centre = from + signed_radius * Vec{-tangent.y, tangent.x};
    p.radius = std::fabs(signed_radius);
    p.turn = side > 0 ? 1 : -1;
    return p;
  }
  /// Less than half a circle, counted from the tangent at its begin.
  static bool is_forward(Vec tangent, Vec from, Vec to) { return dot(tangent, to - from) > 0; }

  [[nodiscard]] double distance(Vec at) const {
    const Vec chord = to - from;
    const double along = dot(at - from, chord) / dot(chord, chord);
    if (along < 0) return norm(at - from);
    if (along > 1) return norm(at - to);
    return turn == 0 ? std::fabs(cross(chord, at - from)) / norm(chord)
                     : std::fabs(norm(at - centre) - radius);
  }
};

class Fitter {
 public:
  Fitter(const interp::NurbsCurve& curve, double tolerance_mm)
      : curve_(curve), tolerance_(tolerance_mm) {}

  std::vector<SplinePiece> run(int first, int last) {
    for (span_ = first; span_ < last; ++span_) fit(span_, span_ + 1.0, 0);
    return std::move(pieces_);
  }

 private:
  static constexpr int kSamples = 15;

  [[nodiscard]] Vec point(double u) const {
    const auto p = curve_.at(u, span_);
    return {p.x, p.y};
  }
  /// Unit tangent; where the derivative vanishes (control points that coincide) the direction to or from a near point.
  [[nodiscard]] Vec tangent(double u, double other) const {
    const auto p = curve_.at(u, span_);
    const double speed = std::hypot(p.dx, p.dy);
    if (speed > kNothing) return {p.dx / speed, p.dy / speed};
    const Vec near = point(u + (other - u) * 1e-3);
    const Vec d = other > u ? near - Vec{p.x, p.y} : Vec{p.x, p.y} - near;
    const double length = norm(d);
    return length > 0 ? (1 / length) * d : Vec{};
  }

  void fit(double u0, double u1, int depth) {
    const Vec p0 = point(u0), p1 = point(u1);
    if (depth >= kDeepest || is_speck(p0, u0, u1)) {
      add(Piece{p0, p1, {}, 0, 0});
      return;
    }
    std::array<Piece, 2> arcs{};
    if (!biarc(p0, tangent(u0, u1), p1, tangent(u1, u0), arcs) || !close(arcs, u0, u1)) {
      const double middle = (u0 + u1) / 2;
      fit(u0, middle, depth + 1);
      fit(middle, u1, depth + 1);
      return;
    }
    for (const Piece& arc : arcs) add(arc);
  }

  /// Two arcs from p0 along t0 to p1 along t1 that meet with one tangent, as far from p0 as from p1 along the tangents.
  static bool biarc(Vec p0, Vec t0, Vec p1, Vec t1, std::array<Piece, 2>& arcs) {
    const Vec v = p1 - p0;
    const Vec t = t0 + t1;
    const double vv = dot(v, v), vt = dot(v, t), a = 2 * (1 - dot(t0, t1));
    if (vv < kNothing * kNothing || dot(t0, v) <= 0 || dot(t1, v) <= 0) return false;
    // d solves a d^2 + 2 (v t) d - v v = 0, written so that a = 0 needs no case of its own.
    const double d = vv / (vt + std::sqrt(vt * vt + a * vv));
    const Vec middle = 0.5 * (p0 + p1 + d * (t0 - t1));
    if (!Piece::is_forward(t0, p0, middle) || !Piece::is_forward(t1, middle, p1)) return false;
    arcs[0] = Piece::along(p0, t0, middle);
    arcs[1] = Piece::along(p1, Vec{-t1.x, -t1.y}, middle);
    std::swap(arcs[1].from, arcs[1].to);
    arcs[1].turn = -arcs[1].turn;
    return true;
  }

  /// Cusps, and curves whose control points coincide: too short to have a shape.
  [[nodiscard]] bool is_speck(Vec p0, double u0, double u1) const {
    for (int i = 1; i <= kSamples + 1; ++i) {
      if (norm(point(u0 + (u1 - u0) * i / (kSamples + 1)) - p0) > tolerance_ / 10) return false;
    }
    return true;
  }

  [[nodiscard]] bool close(const std::array<Piece, 2>& arcs, double u0, double u1) const {
    for (int i = 1; i <= kSamples; ++i) {
      const Vec at = point(u0 + (u1 - u0) * i / (kSamples + 1));
      if (std::min(arcs[0].distance(at), arcs[1].distance(at)) > tolerance_) return false;
    }
    return true;
  }

  void add(const Piece& p) {
    if (norm(p.to - p.from) < kNothing) return;
    pieces_.push_back({p.to.x, p.to.y, p.centre.x, p.centre.y, p.turn});
  }

  const interp::NurbsCurve& curve_;
  double tolerance_;
  int span_{0};
  std::vector<SplinePiece> pieces_;
};

}  // namespace

std::vector<SplinePiece> spline_pieces(const interp::NurbsCurve& curve, int first, int last,
                                       double tolerance_mm) {
  return Fitter(curve, tolerance_mm).run(first, last);
}

}  // namespace kerf::task
