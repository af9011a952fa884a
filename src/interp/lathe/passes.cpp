#include "interp/lathe/passes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::interp::lathe {

namespace {

constexpr double kBefore = -std::numeric_limits<double>::infinity();

double radius_of(const Move& m) { return std::hypot(m.from.s - m.center.s, m.from.h - m.center.h); }

/// The part of a move that goes down (or up), in travel order. Nothing: from and to are the same point.
struct Slope {
  Point from, to;
};

Slope falling(const Move& m) {
  if (!m.arc) return m.to.h < m.from.h ? Slope{m.from, m.to} : Slope{m.to, m.to};
  const double r = radius_of(m);
  if (m.ccw) {  // lower half: down to the lowest point, then up
    if (m.from.s >= m.center.s) return {m.to, m.to};
    return {m.from, m.to.s <= m.center.s ? m.to : Point{m.center.s, m.center.h - r}};
  }
  if (m.to.s <= m.center.s) return {m.to, m.to};
  return {m.from.s >= m.center.s ? m.from : Point{m.center.s, m.center.h + r}, m.to};
}

Slope rising(const Move& m) {
  if (!m.arc) return m.to.h > m.from.h ? Slope{m.from, m.to} : Slope{m.to, m.to};
  const double r = radius_of(m);
  if (m.ccw) {
    if (m.to.s <= m.center.s) return {m.to, m.to};
    return {m.from.s >= m.center.s ? m.from : Point{m.center.s, m.center.h - r}, m.to};
  }
  if (m.from.s >= m.center.s) return {m.to, m.to};
  return {m.from, m.to.s <= m.center.s ? m.to : Point{m.center.s, m.center.h + r}};
}

bool falls(const Slope& part) { return part.to.h < part.from.h - kNothing; }
Slope reversed(const Slope& part) { return {part.to, part.from}; }

/// Where the slope of the move has this height, which lies between those of its ends.
Point at_height(const Move& m, const Slope& part, double h) {
  if (std::fabs(part.from.h - h) <= kNothing) return part.from;
  if (std::fabs(part.to.h - h) <= kNothing) return part.to;
  double s = 0;
  if (m.arc) {
    const double r = radius_of(m), d = h - m.center.h;
    const double y = std::sqrt(std::max(0.0, r * r - d * d));
    s = (part.from.s + part.to.s) / 2 < m.center.s ? m.center.s - y : m.center.s + y;
  } else {
    s = m.from.s + (m.to.s - m.from.s) * (h - m.from.h) / (m.to.h - m.from.h);
  }
  return {std::clamp(s, std::min(part.from.s, part.to.s), std::max(part.from.s, part.to.s)), h};
}

class Rougher {
 public:
  Rougher(const Path& path, const Roughing& cycle, Tool& tool)
      : path_(path), cycle_(cycle), tool_(tool) {}

  bool run() {
    const Point begin = path_.front().from;
    entry_ = {std::min(cycle_.start.s, begin.s), cycle_.start.h};
    rapid(entry_);
    if (cycle_.pockets != Pockets::only) entry_passes(begin);
    rapid(begin);
    if (cycle_.pockets == Pockets::none)
      go_across();
    else
      go_into();
    const Point end = path_.back().to;
    if (end.h < cycle_.start.h - kNothing) feed({end.s, cycle_.start.h});
    return moves_ <= kMostMoves;
  }

 private:
  struct Reach {
    std::size_t move;  ///< path_.size(): the end of the path
    Point at;
  };

  void rapid(Point to) {
    place_ = to;
    if (++moves_ <= kMostMoves) tool_.rapid(to);
  }
  void feed(Point to) {
    place_ = to;
    if (++moves_ <= kMostMoves) tool_.feed(to);
  }
  /// Along a move of the path; an arc of no length would be a circle.
  void along(const Move& m, Point from, Point to) {
    if (!m.arc) return feed(to);
    if (std::hypot(to.s - from.s, to.h - from.h) < kNothing) return;
    Move part = m;
    part.from = from;
    part.to = to;
    place_ = to;
    if (++moves_ <= kMostMoves) tool_.arc(part);
  }

  /// The first point from move `first` on that is as high as `level`; in that move only behind s.
  [[nodiscard]] Reach reach(std::size_t first, double s, double level) const {
    for (std::size_t i = first; i < path_.size(); ++i) {
      const Move& m = path_[i];
      if (i > first && m.from.h >= level - kNothing) return {i, {m.from.s, level}};
      const Slope up = rising(m);
      if (up.to.h < level - kNothing || up.from.h > level + kNothing || up.from == up.to) continue;
      const Point p = at_height(m, up, level);
      if (i > first || p.s > s + kNothing) return {i, {p.s, level}};
    }
    return {path_.size(), {path_.back().to.s, level}};
  }

  /// From where the tool has cut to, back to above `from`; the lift stays inside the cut.
  void back_to(Point from) {
    const double lift = std::min(cycle_.retract, place_.s - from.s);
    const double level = from.h + cycle_.retract;
    rapid({place_.s - lift, level});
    rapid({from.s + lift, level});
  }

  void entry_passes(Point begin) {
    for (int k = 0; moves_ <= kMostMoves; ++k) {
      const double level = cycle_.start.h - k * cycle_.cut;
      if (level <= begin.h + kNothing) return;
      const double t = (cycle_.start.h - level) / (cycle_.start.h - begin.h);
      const Point from{entry_.s + t * (begin.s - entry_.s), level};
      rapid(from);
      const Point to = reach(0, kBefore, level).at;
      if (to.s - from.s < kNothing) continue;
      feed(to);
      back_to(from);
      rapid(from);
    }
  }

  /// The layers above each level that the move falls below, counted from `base`; the tool stands at its beginning. Returns
  /// where it stands then.
  Point layers(std::size_t i, const Slope& down, double base) {
    const Move& m = path_[i];
    Point at = m.from;
    double k = std::max(0.0, std::ceil((base - down.from.h - kNothing) / cycle_.cut));
    for (; moves_ <= kMostMoves; ++k) {
      const double level = base - k * cycle_.cut;
      if (level <= down.to.h + kNothing) break;
      const Point edge = at_height(m, down, std::min(level, down.from.h));
      along(m, at, edge);
      at = edge;
      const Point to = reach(i, edge.s, level).at;
      if (to.s - edge.s < kNothing) continue;
      feed(to);
      back_to(edge);
      feed(edge);
    }
    return at;
  }

  /// Moves at the beginning of the path that only fall are open to the entry side: no pocket begins there.
  [[nodiscard]] std::size_t open_moves() const {
    std::size_t i = 0;
    while (i < path_.size() && falls(falling(path_[i])) && !falls(reversed(rising(path_[i])))) ++i;
    return i;
  }

  void go_into() {
    const std::size_t open = cycle_.pockets == Pockets::only ? open_moves() : 0;
    double highest = open > 0 ? path_[open - 1].to.h : path_.front().from.h;
    double base = cycle_.start.h;
    for (std::size_t i = 0; i < path_.size() && moves_ <= kMostMoves; ++i) {
      const Move& m = path_[i];
      const Slope down = falling(m);
      Point at = m.from;
      if (i >= open && falls(down)) {
        if (cycle_.pockets == Pockets::only && down.from.h >= highest - kNothing)
          base = highest = down.from.h;
        at = layers(i, down, base);
      }
      along(m, at, m.to);
      if (i >= open) highest = std::max(highest, m.to.h);
    }
  }

  /// Along the path, straight across what lies lower than before.
  void go_across() {
    const std::size_t open = open_moves();
    for (std::size_t k = 0; k < open; ++k)
      along(path_[k], layers(k, falling(path_[k]), cycle_.start.h), path_[k].to);
    std::size_t i = open;
    Point at = place_;
    bool fresh = true;  // each move is begun from its own beginning, except behind a bridge
    while (i < path_.size() && moves_ <= kMostMoves) {
      const Move& m = path_[i];
      const Slope down = falling(m);
      const bool bridge = falls(down) && down.to.s >= at.s - kNothing && !(down.to == at);
      const Point stop = !bridge ? m.to : down.from.s > at.s ? down.from : at;
      if (fresh && (m.arc || !(stop == at))) feed(at);
      if (!(stop == at)) along(m, at, stop);
      fresh = true;
      at = stop;
      if (!bridge) {
        ++i;
        continue;
      }
      const Reach next = reach(i, at.s, at.h);
      feed(next.at);
      at = next.at;
      i = next.move;
      fresh = false;
    }
    if (fresh && path_.back().to.h < cycle_.start.h - kNothing) feed(place_);
  }

  const Path& path_;
  const Roughing& cycle_;
  Tool& tool_;
  Point entry_, place_;
  int moves_{0};
};

}  // namespace

bool rough(const Path& path, const Roughing& cycle, Tool& tool) {
  return Rougher(path, cycle, tool).run();
}

namespace {
/// Height of one move over s; where it is vertical the highest.
double height_on(const Move& m, double s) {
  if (m.to.s - m.from.s < kNothing) return std::max(m.from.h, m.to.h);
  if (!m.arc) return m.from.h + (m.to.h - m.from.h) * (s - m.from.s) / (m.to.s - m.from.s);
  const double r = radius_of(m), d = s - m.center.s;
  const double y = std::sqrt(std::max(0.0, r * r - d * d));
  return m.center.h + (m.ccw ? -y : y);
}
}  // namespace

bool clear_of(const Path& path, Point a, Point b) {
  if (a.s > b.s) std::swap(a, b);
  const auto line = [&](double s) {
    return b.s - a.s < kNothing ? std::min(a.h, b.h) : a.h + (b.h - a.h) * (s - a.s) / (b.s - a.s);
  };
  for (const Move& m : path) {
    const double from = std::max(m.from.s, a.s), to = std::min(m.to.s, b.s);
    if (from > to) continue;
    const double left = height_on(m, from), right = height_on(m, to);
    if (left > line(from) + kNothing || right > line(to) + kNothing) return false;
    // Between the ends an arc may stand higher.
    const bool over_top = m.arc && !m.ccw && from < m.center.s && m.center.s < to;
    const double top = over_top ? m.center.h + radius_of(m) : std::max(left, right);
    if (m.arc && !m.ccw && top > std::min(line(from), line(to)) + kNothing) return false;
  }
  return true;
}

double highest(const Path& path) {
  double top = path.front().from.h;
  for (const Move& m : path) top = std::max({top, m.to.h, falling(m).from.h});
  return top;
}

void follow(const Path& path, Tool& tool) {
  for (const Move& m : path) {
    if (m.arc)
      tool.arc(m);
    else
      tool.feed(m.to);
  }
}

}  // namespace kerf::interp::lathe
