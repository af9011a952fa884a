#include "interp/compensation/look_ahead.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::interp {

namespace {

constexpr double kTwoPi = 6.283185307179586;
/// Programs are written with a few digits: so much nearer (mm, and part of the radius) is none.
constexpr double kRoundingMm = 0.005, kRoundingOfRadius = 0.002;

double dot(Flat p, Flat q) { return p.a * q.a + p.b * q.b; }
double cross(Flat p, Flat q) { return p.a * q.b - p.b * q.a; }
double length(Flat p) { return std::hypot(p.a, p.b); }
double radius_of(const FlatPiece& arc) { return length(arc.start - arc.center); }

/// The direction from the centre to `at` is one of the arc's.
bool covers(const FlatPiece& arc, Flat at) {
  const double whole = std::fabs(arc.sweep);
  if (whole >= kTwoPi) return true;
  const Flat from = arc.start - arc.center, to = at - arc.center;
  double turn = std::atan2(cross(from, to), dot(from, to)) * (arc.sweep < 0 ? -1 : 1);
  if (turn < 0) turn += kTwoPi;
  return turn <= whole;
}

double distance(Flat at, const FlatPiece& p) {
  const double ends = std::min(length(at - p.start), length(at - p.end));
  if (p.is_arc)
    return covers(p, at) ? std::min(ends, std::fabs(length(at - p.center) - radius_of(p))) : ends;
  const Flat way = p.end - p.start;
  const double square = dot(way, way);
  if (square == 0) return ends;
  const double t = std::clamp(dot(at - p.start, way) / square, 0.0, 1.0);
  return length(at - (p.start + way * t));
}

bool lines_cross(const FlatPiece& p, const FlatPiece& q) {
  const Flat d = p.end - p.start, e = q.end - q.start;
  const double before = cross(d, q.start - p.start), behind = cross(d, q.end - p.start);
  const double left = cross(e, p.start - q.start), right = cross(e, p.end - q.start);
  return before * behind < 0 && left * right < 0;
}

bool line_crosses_arc(const FlatPiece& line, const FlatPiece& arc) {
  const Flat way = line.end - line.start, from = line.start - arc.center;
  const double r = radius_of(arc), a = dot(way, way), half_b = dot(from, way);
  const double square = half_b * half_b - a * (dot(from, from) - r * r);
  if (a == 0 || square < 0) return false;
  for (const double root : {-std::sqrt(square), std::sqrt(square)}) {
    const double t = (root - half_b) / a;
    if (t >= 0 && t <= 1 && covers(arc, line.start + way * t)) return true;
  }
  return false;
}

bool arcs_cross(const FlatPiece& p, const FlatPiece& q) {
  const Flat axis = q.center - p.center;
  const double d = length(axis), r = radius_of(p), s = radius_of(q);
  if (d == 0) return false;
  const double along = (r * r - s * s + d * d) / (2 * d), square = r * r - along * along;
  if (square < 0) return false;
  const Flat unit = axis * (1 / d), foot = p.center + unit * along;
  const Flat off = Flat{-unit.b, unit.a} * std::sqrt(square);
  const auto both = [&](Flat at) { return covers(p, at) && covers(q, at); };
  return both(foot + off) || both(foot - off);
}

bool meet(const FlatPiece& p, const FlatPiece& q) {
  if (p.is_arc && q.is_arc) return arcs_cross(p, q);
  if (!p.is_arc && !q.is_arc) return lines_cross(p, q);
  return p.is_arc ? line_crosses_arc(q, p) : line_crosses_arc(p, q);
}

/// The least distance from the points of p that can be next to q.
double from_points_of(const FlatPiece& p, const FlatPiece& q) {
  double least = std::min(distance(p.start, q), distance(p.end, q));
  if (!p.is_arc) {
    const Flat way = p.end - p.start;
    const double square = dot(way, way);
    if (!q.is_arc || square == 0) return least;
    const double t = dot(q.center - p.start, way) / square;
    return t > 0 && t < 1 ? std::min(least, distance(p.start + way * t, q)) : least;
  }
  Flat axis = q.center - p.center;
  if (!q.is_arc) axis = {q.start.b - q.end.b, q.end.a - q.start.a};
  const double size = length(axis);
  if (size == 0) return least;
  axis = axis * (radius_of(p) / size);
  for (const Flat at : {p.center + axis, p.center - axis})
    if (covers(p, at)) least = std::min(least, distance(at, q));
  return least;
}

/// A cheap lower bound: pieces that are further apart than `enough` need no exact answer.
bool far_apart(const FlatPiece& p, const FlatPiece& q, double enough) {
  const auto half = [](const FlatPiece& x) {
    return x.is_arc ? radius_of(x) : length(x.end - x.start) / 2;
  };
  const auto middle = [](const FlatPiece& x) {
    return x.is_arc ? x.center : (x.start + x.end) * 0.5;
  };
  return length(middle(p) - middle(q)) - half(p) - half(q) > enough;
}

/// How near `tool` comes to the contour of `wall`; `enough` when that is far enough.
double nearness(const GuardedMove& tool, const GuardedMove& wall, double enough) {
  if (!wall.wall || tool.low > wall.high) return enough;
  double least = enough;
  if (!far_apart(tool.tool, wall.programmed, enough))
    least = std::min(least, distance(tool.tool, wall.programmed));
  if (tool.corner && !far_apart(*tool.corner, wall.programmed, enough))
    least = std::min(least, distance(*tool.corner, wall.programmed));
  return least;
}

}  // namespace

double distance(const FlatPiece& p, const FlatPiece& q) {
  if (meet(p, q)) return 0;
  return std::min(from_points_of(p, q), from_points_of(q, p));
}

std::optional<LookAhead::Gouge> LookAhead::gouge(const GuardedMove& next, double radius) const {
  const double least = radius - std::max(kRoundingMm, kRoundingOfRadius * radius);
  // The neighbour is CompPath's.
  for (std::size_t i = 0; i + 1 < moves_.size(); ++i) {
    const GuardedMove& m = moves_[i];
    if (const double d = nearness(m, next, least); d < least) return Gouge{m.line, next.line, d};
    if (const double d = nearness(next, m, least); d < least) return Gouge{next.line, m.line, d};
  }
  return std::nullopt;
}

void LookAhead::take(const GuardedMove& next, std::size_t depth) {
  moves_.push_back(next);
  while (moves_.size() > depth) moves_.pop_front();
}

}  // namespace kerf::interp
