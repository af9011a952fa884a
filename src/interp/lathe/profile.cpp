// Profiles as functions of s: forward check, and the envelope that leaves an allowance.
#include "interp/lathe/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::interp::lathe {

namespace {

constexpr double kLowest = -std::numeric_limits<double>::infinity();
/// How far an arc may bulge backwards because its numbers are rounded, mm.
constexpr double kBulge = 1e-5;
/// Backward steps of s below this come from rounding.
constexpr double kStep = 1e-6;

/// A height over s: a line, or the upper or lower half of a circle.
struct Curve {
  bool arc{false};
  bool upper{false};
  double slope{0};
  Point point{};  ///< of the line; centre of the circle
  double radius{0};

  [[nodiscard]] double at(double s) const {
    if (!arc) return point.h + slope * (s - point.s);
    const double d = s - point.s;
    const double y = std::sqrt(std::max(0.0, radius * radius - d * d));
    return point.h + (upper ? y : -y);
  }
  friend bool operator==(const Curve&, const Curve&) = default;
};

struct Span {
  double from, to;
  Curve curve;
};

double radius_of(const Move& m) {
  return (std::hypot(m.from.s - m.center.s, m.from.h - m.center.h) +
          std::hypot(m.to.s - m.center.s, m.to.h - m.center.h)) /
         2;
}

Curve curve_of(const Move& m) {
  if (m.arc) return {true, !m.ccw, 0, m.center, radius_of(m)};
  return {false, false, (m.to.h - m.from.h) / (m.to.s - m.from.s), m.from, 0};
}

bool vertical(const Move& m) { return m.to.s - m.from.s < kNothing; }

/// Unit normal on the upper side (left of travel).
Point normal(const Move& m, Point at) {
  if (m.arc) {
    const double r = std::hypot(at.s - m.center.s, at.h - m.center.h);
    const double k = (m.ccw ? -1 : 1) / r;
    return {(at.s - m.center.s) * k, (at.h - m.center.h) * k};
  }
  const double l = std::hypot(m.to.s - m.from.s, m.to.h - m.from.h);
  return {-(m.to.h - m.from.h) / l, (m.to.s - m.from.s) / l};
}

/// Where two curves have the same height, in lo..hi, ascending; at most two.
int crossings(const Curve& a, const Curve& b, double lo, double hi, double found[2]) {
  int n = 0;
  const auto add = [&](double s) {
    if (s > lo + kNothing && s < hi - kNothing) found[n++] = s;
  };
  if (!a.arc && !b.arc) {
    const double turn = a.slope - b.slope;
    if (std::fabs(turn) > 1e-14) add(a.point.s + (b.at(a.point.s) - a.point.h) / turn);
  } else if (a.arc && b.arc) {
    const double ds = b.point.s - a.point.s, dh = b.point.h - a.point.h;
    const double l = std::hypot(ds, dh);
    if (l < kNothing) return 0;
    const double x = (l * l + a.radius * a.radius - b.radius * b.radius) / (2 * l);
    const double y2 = a.radius * a.radius - x * x;
    if (y2 < 0) return 0;
    const double y = std::sqrt(y2);
    for (const double side : {-1.0, 1.0}) {
      const double s = a.point.s + (ds * x - side * dh * y) / l;
      if (std::fabs(a.at(s) - b.at(s)) < 1e-6) add(s);
    }
  } else {
    const Curve& line = a.arc ? b : a;
    const Curve& circle = a.arc ? a : b;
    const double m = line.slope, k = line.at(circle.point.s) - circle.point.h;
    const double q = 1 + m * m;
    const double root = q * circle.radius * circle.radius - k * k;
    if (root < 0) return 0;
    for (const double side : {-1.0, 1.0}) {
      const double s = circle.point.s + (-m * k + side * std::sqrt(root)) / q;
      if (std::fabs(a.at(s) - b.at(s)) < 1e-6) add(s);
    }
  }
  if (n == 2 && found[0] > found[1]) std::swap(found[0], found[1]);
  return n;
}

/// The highest of many curves, each over its own part of s.
class Envelope {
 public:
  void add(double from, double to, const Curve& c) {
    if (to - from < kNothing) return;
    fresh_.clear();
    // Spans before and behind stay; those that overlap are cut up.
    auto first = std::partition_point(spans_.begin(), spans_.end(),
                                      [&](const Span& x) { return x.to <= from; });
    auto last =
        std::partition_point(first, spans_.end(), [&](const Span& x) { return x.from < to; });
    double at = from;
    for (auto i = first; i != last; ++i) {
      if (i->from < from) put({i->from, from, i->curve});
      if (i->from > at) put({at, i->from, c});
      higher(std::max(i->from, from), std::min(i->to, to), i->curve, c);
      at = i->to;
      if (i->to > to) put({to, i->to, i->curve});
    }
    if (at < to) put({at, to, c});
    const auto place = spans_.erase(first, last);
    spans_.insert(place, fresh_.begin(), fresh_.end());
  }
  [[nodiscard]] const std::vector<Span>& spans() const { return spans_; }

 private:
  void put(const Span& x) {
    if (!fresh_.empty() && fresh_.back().curve == x.curve && fresh_.back().to == x.from)
      fresh_.back().to = x.to;
    else if (x.to > x.from)
      fresh_.push_back(x);
  }
  void higher(double lo, double hi, const Curve& old, const Curve& c) {
    if (hi <= lo) return;
    double cut[2];
    const int n = crossings(old, c, lo, hi, cut);
    double from = lo;
    for (int i = 0; i <= n; ++i) {
      const double to = i < n ? cut[i] : hi;
      const double middle = (from + to) / 2;
      put({from, to, c.at(middle) > old.at(middle) + kNothing ? c : old});
      from = to;
    }
  }
  std::vector<Span> spans_, fresh_;
};

/// A curve over from..to as a move.
Move move_of(const Span& x) {
  Move m;
  m.from = {x.from, x.curve.at(x.from)};
  m.to = {x.to, x.curve.at(x.to)};
  m.arc = x.curve.arc;
  m.ccw = m.arc && !x.curve.upper;
  if (m.arc) m.center = x.curve.point;
  return m;
}

void append_line(Path& path, Point to) {
  const Point from = path.empty() ? to : path.back().to;
  if (std::hypot(to.s - from.s, to.h - from.h) > kNothing) path.push_back({from, to});
}

Envelope envelope(const Path& moves, double d) {
  Envelope e;
  for (const Move& m : moves) {
    if (vertical(m)) continue;
    Curve c = curve_of(m);
    const Point a = normal(m, m.from), b = normal(m, m.to);
    if (c.arc) {
      c.radius += c.upper ? d : -d;
      if (c.radius <= kNothing) continue;
    } else {
      c.point = {m.from.s + a.s * d, m.from.h + a.h * d};
    }
    e.add(m.from.s + a.s * d, m.to.s + b.s * d, c);
  }
  // Round the corners that the tool goes around.
  for (std::size_t i = 0; i + 1 < moves.size(); ++i) {
    const Point a = normal(moves[i], moves[i].to), b = normal(moves[i + 1], moves[i + 1].from);
    const double turn = a.s * b.h - a.h * b.s;
    if (turn > -1e-9 && a.s * b.s + a.h * b.h > 0) continue;
    const Point p = moves[i].to;
    e.add(p.s - d, p.s + d, {true, true, 0, p, d});
  }
  return e;
}

}  // namespace

bool runs_forward(const Path& moves) {
  for (const Move& m : moves) {
    if (m.to.s < m.from.s - kStep) return false;
    if (!m.arc) continue;
    if (vertical(m)) return false;
    // Left to right over the top is clockwise; the ends may lie beside the widest place by rounding only.
    const double slack = std::sqrt(2 * radius_of(m) * kBulge);
    const double a = m.from.h - m.center.h, b = m.to.h - m.center.h;
    if (m.ccw ? a > slack || b > slack : a < -slack || b < -slack) return false;
  }
  return !moves.empty() && moves.back().to.s - moves.front().from.s > kNothing;
}

Path allowance(const Path& moves, double distance) {
  if (distance < kNothing) return moves;
  const Envelope e = envelope(moves, distance);
  const Point n0 = normal(moves.front(), moves.front().from);
  const Point n1 = normal(moves.back(), moves.back().to);
  const Point start{moves.front().from.s + n0.s * distance, moves.front().from.h + n0.h * distance};
  const Point end{moves.back().to.s + n1.s * distance, moves.back().to.h + n1.h * distance};
  if (end.s - start.s < kNothing) return {};
  Path path;
  path.push_back({start, start});  // the place to append to
  for (const Span& whole : e.spans()) {
    const Span x{std::max(whole.from, start.s), std::min(whole.to, end.s), whole.curve};
    if (x.to - x.from < kNothing) continue;
    const Move m = move_of(x);
    if (path.size() == 1 && m.from.h > start.h)
      path[0] = {m.from, m.from};  // a later part of the profile stands over the beginning
    append_line(path, m.from);
    path.push_back(m);
    path.back().from = path[path.size() - 2].to;
  }
  if (end.h > path.back().to.h || path.back().to.s < end.s - kNothing || vertical(moves.back()))
    append_line(path, {std::max(end.s, path.back().to.s), end.h});
  path.erase(path.begin());
  return path;
}

double height_at(const Path& path, double s) {
  double highest = kLowest;
  for (const Move& m : path) {
    if (s < m.from.s - kNothing || s > m.to.s + kNothing) continue;
    if (vertical(m))
      highest = std::max({highest, m.from.h, m.to.h});
    else
      highest = std::max(highest, curve_of(m).at(std::clamp(s, m.from.s, m.to.s)));
  }
  return highest;
}

}  // namespace kerf::interp::lathe
