#include "motion/core/path/limits.hpp"

#include <algorithm>

namespace kerf::motion::path {
namespace {

constexpr int kPerCubic = 4;
constexpr double kSharpTurn = 0.1;         ///< of q' within one cubic
constexpr double kArcStep = 0.05;          ///< rad
constexpr double kLongestStretch = 0.02;   ///< s at the programmed feed
constexpr int kLeastPerArc = 4;            ///< an arc between two stops speeds up and brakes
constexpr double kShortestStretch = 5e-4;  ///< s: dividing further buys nothing
constexpr double kLeadsOn = 0.99;  ///< |q'| over the largest: a cubic that turns by 16 degrees

double square(double x) noexcept { return x * x; }

/// The hull of q' on a stretch.
struct Slopes {
  Vec p0, p1, p2;
};

Slopes slopes_of(const Piece& piece, double s0, double s1) noexcept {
  Slopes out;
  out.p0 = piece.first(s0);
  out.p2 = piece.first(s1);
  out.p1 = piece.first((s0 + s1) / 2) * 2.0 - (out.p0 + out.p2) * 0.5;
  return out;
}

double largest(const Slopes& s, std::size_t i) noexcept {
  return std::max({std::abs(s.p0[i]), std::abs(s.p1[i]), std::abs(s.p2[i])});
}
double largest3(const Slopes& s, std::size_t i) noexcept {
  return std::max({norm3(s.p0, i), norm3(s.p1, i), norm3(s.p2, i)});
}
/// On an arc the coefficient in the middle is above the value there; |q'| is even on circles.
double largest3(const Piece& piece, double s0, double s1, std::size_t i) noexcept {
  if (piece.straight()) return norm3(piece.b, i);
  if (piece.shape == Piece::Shape::arc)
    return std::max({norm3(piece.first(s0), i), norm3(piece.first((s0 + s1) / 2), i),
                     norm3(piece.first(s1), i)});
  return largest3(slopes_of(piece, s0, s1), i);
}

}  // namespace

double axis_cap(const Piece& piece, double s0, double s1, const AxisLimits& limits) noexcept {
  double cap = kNoLimit;
  const Slopes s = piece.straight() ? Slopes{piece.b, piece.b, piece.b} : slopes_of(piece, s0, s1);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const double most = largest(s, i);
    if (most > 0) cap = std::min(cap, square(limits.vel[i] / most));
  }
  const double xyz = largest3(piece, s0, s1, 0), uvw = largest3(piece, s0, s1, 6);
  if (xyz > 0) cap = std::min(cap, square(limits.path_vel / xyz));
  if (uvw > 0) cap = std::min(cap, square(limits.path_vel / uvw));
  if (xyz == 0 && uvw == 0) {
    const double abc = largest3(piece, s0, s1, 3);
    if (abc > 0) cap = std::min(cap, square(limits.turn_vel / abc));
  }
  return cap;
}

double feed_cap(const Piece& piece, double s0, double s1) noexcept {
  const Feed& feed = piece.feed;
  if (feed.speed >= kNoLimit) return kNoLimit;
  if (feed.metric < 0) return square(feed.speed);
  double most = largest3(piece, s0, s1, static_cast<std::size_t>(feed.metric));
  // In a blend of a turn with a move that turns back the axes that measure the feed all but stand; the tool keeps it too.
  if (feed.metric > 0) most = std::max(most, largest3(piece, s0, s1, 0));
  return most > 0 ? square(feed.speed / most) : kNoLimit;
}

double slope_of(const Piece& piece, double s0, double s1) noexcept {
  return piece.feed.metric < 0
             ? 1.0
             : largest3(piece, s0, s1, static_cast<std::size_t>(piece.feed.metric));
}

double straight_acc(const Piece& piece, const AxisLimits& limits) noexcept {
  double acc = kNoLimit;
  for (std::size_t i = 0; i < kAxes; ++i)
    if (piece.b[i] != 0) acc = std::min(acc, limits.acc[i] / std::abs(piece.b[i]));
  const double xyz = norm3(piece.b, 0);
  return xyz > 0 ? std::min(acc, limits.path_acc / xyz) : acc;
}

double jerk_slope(const Piece& piece) noexcept {
  const double begin = norm3(piece.first(0), 0);
  if (piece.straight() || piece.shape == Piece::Shape::arc) return begin;
  const double middle = norm3(piece.first(piece.length / 2), 0),
               end = norm3(piece.first(piece.length), 0);
  const double most = std::max({begin, middle, end});
  return std::min({begin, middle, end}) >= kLeadsOn * most ? most : 0.0;
}

void rows_of(const Piece& piece, double s0, double s1, const AxisLimits& limits,
             Rows& out) noexcept {
  const bool arc = piece.shape == Piece::Shape::arc;
  const auto [f0, e0] = piece.bend(s0);
  const auto [f1, e1] = piece.bend(s1);
  Slopes s{f0, f0, f1};
  Vec em;
  if (arc) {
    const Piece::Bend middle = piece.bend((s0 + s1) / 2);
    s.p1 = middle.first * 2.0 - (f0 + f1) * 0.5;
    em = middle.second * 2.0 - (e0 + e1) * 0.5;
  } else {
    s.p1.add((s1 - s0) / 2, e0);
  }
  out.count = 0;
  const double half = 1.0 / (2.0 * (s1 - s0));
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (s.p0[i] == 0 && s.p2[i] == 0 && e0[i] == 0 && e1[i] == 0) continue;
    const double k = 1.0 / limits.acc[i];
    // u = (x1 - x0) / (2 D)
    const double p0 = s.p0[i] * half, p1 = s.p1[i] * half, p2 = s.p2[i] * half;
    const auto row = [&](double p, double on_x0, double on_x1) {
      out.at[out.count++] = {(on_x0 - p) * k, (p + on_x1) * k};
    };
    row(p0, e0[i], 0);
    if (arc) {
      row((p0 + 2 * p1) / 3, 2 * em[i] / 3, e0[i] / 3);
      row((2 * p1 + p2) / 3, e1[i] / 3, 2 * em[i] / 3);
    } else {
      row(p1, e1[i] / 2, e0[i] / 2);
    }
    row(p2, 0, e1[i]);
  }
}

int divisions(const Piece& piece) noexcept {
  if (piece.straight()) return 1;
  const double feed = std::min(piece.feed.speed, 1e6);
  const double seconds = piece.length / feed;
  if (piece.shape == Piece::Shape::arc) {
    const double sweep = std::abs(piece.rate) * piece.length;
    const double n = std::max(sweep / kArcStep, piece.feed.rapid ? 0.0 : seconds / kLongestStretch);
    return std::max(kLeastPerArc, static_cast<int>(std::min(n, 1e5)) + 1);
  }
  // A sharp corner is driven far below the feed.
  const double turn =
      piece.length * std::max(max_abs(piece.second(0)), max_abs(piece.second(piece.length)));
  return piece.feed.rapid || turn > kSharpTurn
             ? kPerCubic
             : std::clamp(static_cast<int>(seconds / kShortestStretch), 1, kPerCubic);
}

}  // namespace kerf::motion::path
