// Fillets and chamfers between the moves of a profile.
#include <cmath>

#include "interp/lathe/profile.hpp"

namespace kerf::interp::lathe {

namespace {

/// Rounding of typed numbers: a point this near to the end of a move is on it.
constexpr double kSlack = 1e-6;
constexpr double kTwoPi = 2 * 3.14159265358979323846;

Point operator+(Point a, Point b) { return {a.s + b.s, a.h + b.h}; }
Point operator-(Point a, Point b) { return {a.s - b.s, a.h - b.h}; }
Point operator*(Point a, double k) { return {a.s * k, a.h * k}; }
double length(Point a) { return std::hypot(a.s, a.h); }
double cross(Point a, Point b) { return a.s * b.h - a.h * b.s; }
double dot(Point a, Point b) { return a.s * b.s + a.h * b.h; }
Point unit(Point a) {
  const double l = length(a);
  return l > 0 ? a * (1 / l) : a;
}
Point left_of(Point direction) { return {-direction.h, direction.s}; }

/// Direction of travel at a point of the move.
Point tangent(const Move& m, Point at) {
  if (!m.arc) return unit(m.to - m.from);
  const Point r = unit(at - m.center);
  return m.ccw ? left_of(r) : left_of(r) * -1;
}

/// All points at the distance from the move on one side: a line, or a circle.
struct Beside {
  bool circle;
  Point at, direction;  // a line
  Point center;
  double radius;
};

Beside beside(const Move& m, double distance, bool left) {
  if (!m.arc) {
    const Point t = unit(m.to - m.from);
    return {false, m.from + left_of(t) * (left ? distance : -distance), t, {}, 0};
  }
  const double r = length(m.from - m.center);
  return {true, {}, {}, m.center, m.ccw == left ? r - distance : r + distance};
}

/// The crossing of two of these next to `near`.
std::optional<Point> crossing(const Beside& a, const Beside& b, Point near) {
  std::vector<Point> found;
  if (!a.circle && !b.circle) {
    const double c = cross(a.direction, b.direction);
    if (std::fabs(c) < 1e-12) return std::nullopt;
    found.push_back(a.at + a.direction * (cross(b.at - a.at, b.direction) / c));
  } else if (a.circle && b.circle) {
    const Point d = b.center - a.center;
    const double l = length(d);
    if (l < kNothing) return std::nullopt;
    const double x = (l * l + a.radius * a.radius - b.radius * b.radius) / (2 * l);
    const double y2 = a.radius * a.radius - x * x;
    if (y2 < -kSlack) return std::nullopt;
    const Point along = unit(d), middle = a.center + along * x;
    const double y = std::sqrt(std::fmax(y2, 0));
    found.push_back(middle + left_of(along) * y);
    found.push_back(middle - left_of(along) * y);
  } else {
    const Beside& line = a.circle ? b : a;
    const Beside& circle = a.circle ? a : b;
    const Point foot = line.at + line.direction * dot(circle.center - line.at, line.direction);
    const double off = length(foot - circle.center);
    const double y2 = circle.radius * circle.radius - off * off;
    if (y2 < -kSlack) return std::nullopt;
    const double y = std::sqrt(std::fmax(y2, 0));
    found.push_back(foot + line.direction * y);
    found.push_back(foot - line.direction * y);
  }
  const Point* best = &found[0];
  for (const Point& p : found) {
    if (length(p - near) < length(*best - near)) best = &p;
  }
  return *best;
}

/// The point of the move (its line, its circle) nearest to p.
Point foot_on(const Move& m, Point p) {
  if (!m.arc) {
    const Point t = unit(m.to - m.from);
    return m.from + t * dot(p - m.from, t);
  }
  return m.center + unit(p - m.center) * length(m.from - m.center);
}

double angle_from(const Move& m, Point to) {
  const Point a = m.from - m.center, b = to - m.center;
  double turn = std::atan2(cross(a, b), dot(a, b));
  if (!m.ccw) turn = -turn;
  if (turn < -1e-7) turn += kTwoPi;
  return turn;
}

bool lies_on(const Move& m, Point p) {
  if (!m.arc) {
    const double along = dot(p - m.from, unit(m.to - m.from));
    return along >= -kSlack && along <= length(m.to - m.from) + kSlack;
  }
  const double whole = angle_from(m, m.to);
  return angle_from(m, p) <= (whole < kNothing ? kTwoPi : whole) + 1e-7;
}

}  // namespace

std::optional<Path> round_corners(const Path& moves) {
  Path out;
  for (const Move& m : moves) {
    if (length(m.to - m.from) < kNothing) {
      // A line to where the tool stands; its corner is that of the move before.
      if (m.corner > 0 && !out.empty())
        out.back().corner = m.corner, out.back().chamfer = m.chamfer;
      continue;
    }
    if (!out.empty() && out.back().corner > 0) {
      Move& a = out.back();
      Move b = m;
      const double size = a.corner;
      a.corner = 0;
      const double turn = cross(tangent(a, a.to), tangent(b, b.from));
      if (std::fabs(turn) > 1e-9) {
        const bool left = turn > 0;
        const auto center = crossing(beside(a, size, left), beside(b, size, left), b.from);
        if (!center) return std::nullopt;
        Move round;
        round.from = foot_on(a, *center);
        round.to = foot_on(b, *center);
        if (!lies_on(a, round.from) || !lies_on(b, round.to)) return std::nullopt;
        round.arc = !a.chamfer;
        round.center = *center;
        round.ccw = left;
        a.to = round.from;
        b.from = round.to;
        out.push_back(round);
        out.push_back(b);
        continue;
      }
    }
    out.push_back(m);
  }
  if (!out.empty()) out.back().corner = 0;
  return out;
}

}  // namespace kerf::interp::lathe
