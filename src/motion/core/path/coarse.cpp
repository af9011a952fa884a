#include "motion/core/path/coarse.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/path/boxes.hpp"
#include "motion/core/path/reach.hpp"
#include "motion/core/ramp.hpp"

namespace kerf::motion::path {
namespace {

/// Of an arc, for each of its tangents (rad).
constexpr double kMostTurn = 1.8;
constexpr int kSamples = 12;
constexpr double kBetween = 1.05;  ///< between samples it may be off by this much more
/// Only corners are joined: the directions before and behind differ at least so much; they lead on by this many of the short line at most.
constexpr double kLeastTurn = 0.3, kMostAhead = 4;
/// Of straighten_lines(): three times as many sweeps win 0.1 %.
constexpr int kSweeps = 30;
constexpr double kOverRelaxed = 1.5, kLeastSlope = 0.02;
constexpr double kParallel = 1e-6;
/// Of the tolerance: lines that are off each other by less are in one direction.
constexpr double kStraight = 1e-3;
/// Of pairs, the same.
constexpr double kPair = 0.05;

double size(const Vec& v) noexcept { return std::sqrt(dot(v, v)); }

/// Of lines [first, last). `pairs`: no line stands for more than two, as what is off would add up, which does not matter where it is next to nothing.
double join_within(const Tolerance& tolerance, double most, bool pairs, std::size_t first,
                   std::size_t last, Buffer<CoarseLine>& lines) noexcept {
  double worst = 0;
  std::size_t done = first;
  bool joined = false;
  for (std::size_t k = done + 1; k < lines.size(); ++k) {
    CoarseLine& a = lines[done];
    const CoarseLine& b = lines[k];
    const Vec way = a.way + b.way;
    const double la = size(a.way), square = dot(way, way), along = dot(a.way, way) / square;
    const double off = tolerance.share(a.way - way * along);
    const bool stays = off > most || k >= last || (pairs && joined);
    joined = !stays && along > 0 && along < 1 && la > 0 && a.feed == b.feed;
    if (!joined) {
      lines[++done] = b;
      continue;
    }
    worst = std::max(worst, off);
    a.way = way;
    a.sigma += b.sigma;
  }
  if (lines.size() > done) lines.truncate(done + 1);
  return worst;
}

/// How far the lines are off the arc, as a share of the tolerance.
double off_arc(const Piece& arc, const Tolerance& tolerance, const CoarseLine* lines,
               std::size_t count) noexcept {
  double worst = 0, begin = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const CoarseLine& line = lines[i];
    for (int k = 0; k <= kSamples; ++k) {
      Vec q = line.from;
      q.add(static_cast<double>(k) / kSamples, line.way);
      worst = std::max(
          worst, kBetween * tolerance.share(q - arc.point(begin + line.sigma * k / kSamples)));
    }
    begin += line.sigma;
  }
  return worst;
}

}  // namespace

double chords_of(const Piece& arc, const Tolerance& tolerance, double most, int parts,
                 Buffer<CoarseLine>& out) noexcept {
  const std::size_t before = out.size();
  for (int n = 1; n <= parts; ++n) {
    out.truncate(before);
    const double part = arc.length / n;
    for (int k = 0; k < n; ++k) {
      const Vec from = arc.point(part * k);
      if (!out.push_back({from, arc.point(part * (k + 1)) - from, part, arc.feed})) return -1;
    }
    const double off = off_arc(arc, tolerance, out.begin() + before, out.size() - before);
    if (off <= most) return off;
  }
  out.truncate(before);
  return -1;
}

double tangents_of(const Piece& arc, const Tolerance& tolerance, double most,
                   Buffer<CoarseLine>& out) noexcept {
  const std::size_t before = out.size();
  for (int n = 1; n <= kMostTangents; ++n) {
    const double turn = arc.rate * arc.length / n, part = arc.length / n;
    if (turn > kMostTurn) continue;
    out.truncate(before);
    const double ahead = std::tan(turn / 2) / arc.rate;
    Vec at = arc.point(0);
    for (int k = 0; k <= n; ++k) {
      Vec to;
      if (k == n) {
        to = arc.point(arc.length);
      } else {
        to = arc.point(part * k);
        to.add(ahead, arc.first(part * k));
        // What goes along straight is not ahead of where it would be.
        to.add(turn / 2 - std::tan(turn / 2), arc.b);
      }
      if (!out.push_back({at, to - at, k == 0 || k == n ? part / 2 : part, arc.feed})) return -1;
      at = to;
    }
    const double worst = off_arc(arc, tolerance, out.begin() + before, out.size() - before);
    if (worst <= most) return worst;
  }
  out.truncate(before);
  return -1;
}

double join_lines(const Tolerance& tolerance, double most, Buffer<CoarseLine>& lines) noexcept {
  const double straight = join_within(tolerance, kStraight, false, 0, lines.size(), lines);
  double worst = 0;
  for (std::size_t k = 1; k + 1 < lines.size(); ++k) {
    CoarseLine &a = lines[k - 1], &b = lines[k + 1];
    const CoarseLine s = lines[k];
    const double la = size(a.way), lb = size(b.way), ls = size(s.way);
    if (!(la > ls && lb > ls && ls > 0)) continue;
    if (!(a.feed == s.feed && b.feed == s.feed)) continue;
    const Vec da = a.way * (1 / la), db = b.way * (1 / lb);
    // Where a leads on and b comes from: s = x da + y db, nearly.
    const double c = dot(da, db), sa = dot(s.way, da), sb = dot(s.way, db), det = 1 - c * c;
    if (c > std::cos(kLeastTurn) || det < kParallel) continue;
    const double x = (sa - c * sb) / det, y = (sb - c * sa) / det;
    if (!(x > 0 && y > 0) || std::max(x, y) > kMostAhead * ls) continue;
    // They pass each other by `left`.
    Vec left = s.way;
    left.add(-x, da);
    left.add(-y, db);
    Vec corner = da * x;
    corner.add(0.5, left);
    const double along = std::clamp(dot(corner, s.way) / (ls * ls), 0.0, 1.0);
    const double off = tolerance.share(corner - s.way * along) + tolerance.share(left);
    if (straight + off > most) continue;
    worst = std::max(worst, off);
    a.way += corner;
    a.sigma += s.sigma * along;
    b.from = a.from + a.way;
    b.way += s.way - corner;
    b.sigma += s.sigma * (1 - along);
    // What is line k now is not joined again: what is off would add up.
    for (std::size_t i = k; i + 1 < lines.size(); ++i) lines[i] = lines[i + 1];
    lines.truncate(lines.size() - 1);
  }
  return straight + worst;
}

double join_pairs(const Tolerance& tolerance, std::size_t first, std::size_t last,
                  Buffer<CoarseLine>& lines) noexcept {
  return join_within(tolerance, kPair, true, first, last, lines);
}

double straighten_lines(const Tolerance& tolerance, double most, bool taut,
                        Buffer<CoarseLine>& lines, Buffer<Vec>& work) noexcept {
  const std::size_t n = lines.size();
  if (n < 5) return 0;
  // Where line k begins, and the end of the last one.
  work.clear();
  for (const CoarseLine& line : lines)
    if (!work.push_back(line.from)) return 0;
  if (!work.push_back(lines[n - 1].from + lines[n - 1].way)) return 0;
  const auto length = [&](std::size_t k) { return lines[k].sigma; };
  const auto kink = [&](std::size_t v) {
    return (work[v + 1] - work[v]) * (1 / length(v)) -
           (work[v] - work[v - 1]) * (1 / length(v - 1));
  };
  const auto weight = [&](std::size_t v) { return 1 / (length(v - 1) + length(v)); };
  double worst = 0;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    worst = 0;
    for (std::size_t i = 2; i + 1 < n; ++i) {
      const std::size_t v = sweep % 2 == 0 ? i : n - i;
      const double before = 1 / length(v - 1), behind = 1 / length(v), both = before + behind;
      Vec to = kink(v);
      double steep = both;
      if (!taut) {
        // The sum of kink^2 over length, by this place alone.
        const double w0 = weight(v - 1) * before, w1 = weight(v) * both,
                     w2 = weight(v + 1) * behind;
        to = to * w1;
        to.add(-w0, kink(v - 1));
        to.add(-w2, kink(v + 1));
        steep = w0 * before + w1 * both + w2 * behind;
      }
      Vec off = work[v] + to * (kOverRelaxed / steep) - lines[v].from;
      const double share = tolerance.share(off);
      if (share > most) off = off * (most / share);
      worst = std::max(worst, std::min(share, most));
      work[v] = lines[v].from + off;
    }
  }
  // What all but stands, or turns back on itself, has no direction to be driven in.
  for (std::size_t k = 0; k < n; ++k)
    if (size(work[k + 1] - work[k]) < kLeastSlope * lines[k].sigma) return 0;
  for (std::size_t k = 0; k < n; ++k) {
    lines[k].from = work[k];
    lines[k].way = work[k + 1] - work[k];
  }
  return worst;
}

double least_seconds(const Piece* pieces, std::size_t count, const AxisLimits& limits,
                     Buffer<double>& x) noexcept {
  x.assign(1, kNoLimit);
  Rows rows;
  const auto cap_of = [&](const Piece& p, double from, double to) {
    const double cap = std::min(axis_cap(p, from, to, limits), feed_cap(p, from, to));
    return limits.jerks ? std::min(cap, box_cap(p, from, to, Box{}, limits)) : cap;
  };
  // From the end, x is in the order of the ends of stretches from there.
  for (std::size_t i = count; i-- > 0;) {
    const Piece& p = pieces[i];
    const int n = divisions(p);
    if (p.stop_at_end) x.back() = 0;
    for (int k = n; k-- > 0;) {
      const double from = p.length * k / n, to = p.length * (k + 1) / n;
      const double cap = cap_of(p, from, to);
      x.back() = std::min(x.back(), cap);
      double x0 = 0;
      if (p.straight()) {
        x0 = x.back() + 2 * straight_acc(p, limits) * (to - from);
      } else {
        rows_of(p, from, to, limits, rows);
        x0 = largest_x0(rows.all(), x.back());
      }
      if (!x.push_back(std::min(x0, cap))) return kNoLimit;
    }
  }
  double seconds = 0, here = x.back();
  std::size_t node = x.size() - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const Piece& p = pieces[i];
    const int n = divisions(p);
    for (int k = 0; k < n; ++k) {
      const double from = p.length * k / n, to = p.length * (k + 1) / n, way = to - from;
      const double most = x[--node];
      double next = 0;
      if (p.straight()) {
        const double acc = straight_acc(p, limits);
        next = std::min(most, here + 2 * acc * way);
        const double cap = cap_of(p, from, to);
        if (limits.jerks) {
          const Box box = straight_box(p, limits);
          seconds += level_time(way, std::sqrt(here), std::sqrt(next), std::sqrt(cap),
                                {box.acc, box.jerk});
          here = next;
          continue;
        }
        const double peak = std::min(cap, acc * way + (here + next) / 2);
        const double ramps = (2 * peak - here - next) / (2 * acc);
        const double fastest = std::sqrt(peak);
        seconds += (2 * fastest - std::sqrt(here) - std::sqrt(next)) / acc;
        if (way > ramps) seconds += (way - ramps) / std::max(fastest, 1e-9);
      } else {
        rows_of(p, from, to, limits, rows);
        next = std::clamp(range_of_x1(rows.all(), here).high, 0.0, most);
        seconds += 2 * way / (std::sqrt(here) + std::sqrt(next) + 1e-9);
      }
      here = next;
    }
  }
  return seconds;
}

}  // namespace kerf::motion::path
