#include "motion/core/path_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::motion {
namespace {

using path::Piece;
using path::Tolerance;
using path::Vec;

/// Noted moves before and behind the one that the machine was near to; dense lines are merged and smoothed over many.
constexpr std::uint64_t kWindow = 160;
/// Of these the exact share is sought before the others are looked at, and of these at last, ...
constexpr std::uint64_t kCareful = 2, kCarefulAtLast = 12;
/// ... and beyond this share nothing is to be won by it.
constexpr double kHopeless = 3;
constexpr double kSomething = 1e-9;  ///< mm or degrees in a radian
constexpr double kUnknown = 1e99;    ///< share: no move was looked at
constexpr int kRounds = 12, kCarefulRounds = 40;
/// Places on a curve that are looked at to find the valley in which the nearest one is.
constexpr double kLeastScan = 24, kMostScan = 240, kScanTurn = 0.25;

Tolerance rounded(const Tolerance& t) noexcept {
  return {t.mm + PathOracle::kRounding, t.deg + PathOracle::kRounding};
}

/// a.b with each axis measured in what it is allowed to be off.
double product(const Vec& a, const Vec& b, const Tolerance& t) noexcept {
  double linear = 0, rotary = 0;
  for (std::size_t i = 0; i < path::kAxes; ++i) (i / 3 == 1 ? rotary : linear) += a[i] * b[i];
  return linear / (t.mm * t.mm) + rotary / (t.deg * t.deg);
}

/// Which turn of an arc, and where in it.
double guess_on_arc(const Piece& p, const Vec& place, const Tolerance& t) noexcept {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double sweep = p.rate * p.length;
  const Vec u = place - p.a;
  const double x = dot(u, p.c), y = dot(u, p.d);
  double phi = std::atan2(y, x) - p.phi0;
  const double b2 = dot(p.b, p.b);
  // Where the straight part or the radius would have it; both may be rounding.
  double whole = phi;
  if (b2 > kSomething * kSomething)
    whole = dot(u, p.b) / b2 - p.phi0;
  else if (std::abs(p.growth) > kSomething)
    whole = (std::hypot(x, y) - p.radius) / p.growth - p.phi0;
  phi += kTurn * std::round((std::clamp(whole, 0.0, sweep) - phi) / kTurn);
  double best = 0, least = kUnknown;
  for (const double turn : {phi - kTurn, phi, phi + kTurn}) {
    const double s = std::clamp(turn, 0.0, sweep) / p.rate;
    const Vec off = place - p.point(s);
    const double far = product(off, off, t);
    if (far >= least) continue;
    least = far;
    best = s;
  }
  return best;
}

/// The nearest place, each axis measured in what it is allowed to be off.
double foot(const Piece& p, const Vec& place, const Tolerance& t) noexcept {
  const bool straight = p.straight();
  double s = 0;
  if (p.shape == Piece::Shape::arc) {
    s = guess_on_arc(p, place, t);
  } else {
    const Vec way = p.point(p.length) - p.a;
    const double square = product(way, way, t);
    if (square > 0) s = std::clamp(product(place - p.a, way, t) / square, 0.0, 1.0) * p.length;
  }
  for (int k = 0; !straight && k < kRounds; ++k) {
    const Vec slope = p.first(s);
    const double square = product(slope, slope, t);
    if (!(square > 0)) break;
    s = std::clamp(s + product(place - p.point(s), slope, t) / square, 0.0, p.length);
  }
  return s;
}

}  // namespace

double share_of(const ProgrammedMove& move, const Vec& place, bool carefully, Vec& off) noexcept {
  const Tolerance t = rounded(move.tolerance);
  const Piece& p = move.piece;
  const double s = foot(p, place, t);
  off = place - p.point(s);
  double share = t.share(off);
  const bool straight = p.straight();
  // On a curve the place that was found may be the wrong one.
  const double hopeless = straight ? kHopeless : kHopeless + p.length / t.mm;
  if (!carefully || share <= 1 || share > hopeless) return share;
  // Convex on a line, and nearly so on a short part of a curve.
  double low = 0, high = p.length;
  if (!straight) {
    // Not where the place is about as far from the curve as the middle of its bend is, next to the middle of a fillet that is small against P;
    // and the turn of a helix may be another one.
    const double turns = p.shape == Piece::Shape::arc ? p.rate * p.length : 0;
    const int parts = static_cast<int>(std::clamp(turns / kScanTurn, kLeastScan, kMostScan));
    const double step = p.length / parts;
    double best = 0, least = kUnknown;
    for (int k = 0; k <= parts; ++k) {
      const double here = t.share(place - p.point(step * k));
      if (here >= least) continue;
      least = here;
      best = step * k;
    }
    low = std::max(0.0, best - step);
    high = std::min(p.length, best + step);
  }
  for (int k = 0; k < kCarefulRounds; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (t.share(place - p.point(a)) < t.share(place - p.point(b)) ? high : low) =
        t.share(place - p.point(a)) < t.share(place - p.point(b)) ? b : a;
  }
  const Vec there = place - p.point((low + high) / 2);
  if (t.share(there) < share) {
    off = there;
    share = t.share(there);
  }
  return share;
}

bool PathOracle::within(const ProgrammedMoves& moves, std::uint64_t number, const Vec& place,
                        bool carefully) noexcept {
  if (held_ != number) {
    held_ = 0;
    if (!moves.read(number, move_)) return false;
    held_ = number;
  }
  Vec off;
  const double share = share_of(move_, place, carefully, off);
  if (share < least_) {
    least_ = share;
    off_ = off;
    least_allowed_ = move_.tolerance;
  }
  if (share > 1) return false;
  near_ = number;
  return true;
}

void PathOracle::follow(const ProgrammedMoves& moves, std::uint64_t newest,
                        std::uint64_t seq) noexcept {
  const std::uint64_t oldest =
      newest > ProgrammedMoves::kSlots ? newest - ProgrammedMoves::kSlots + 1 : 1;
  at_ = std::clamp(at_, oldest, newest);
  // The last one up to `seq`: numbers grow as they are noted. After an abort thousands that nobody drove may lie before it.
  for (std::uint64_t step = 1; step > 0;) {
    const bool goes_on = at_ + step <= newest && moves.seq(at_ + step) <= seq;
    if (goes_on) at_ += step;
    step = goes_on ? 2 * step : step / 2;
  }
  if (near_ + kWindow < at_ || near_ > at_ + kWindow) near_ = at_;
}

void PathOracle::check(const ProgrammedMoves& moves, const Pose& pose, std::uint64_t seq,
                       const SourceTag& tag, FaultList& faults) noexcept {
  const std::uint64_t newest = moves.newest();
  if (broken_ || newest == 0) return;
  follow(moves, newest, seq);
  // Noted before the check was switched on, or overwritten since: nothing is known.
  if (moves.seq(at_) > seq) return;
  const Vec place = path::to_vec(pose);
  least_ = kUnknown;
  const std::uint64_t from = near_;
  const auto look = [&](std::uint64_t reach, bool carefully) {
    for (std::uint64_t k = 0; k <= reach; ++k) {
      if (from + k <= newest && within(moves, from + k, place, carefully)) return true;
      if (k > 0 && from > k && within(moves, from - k, place, carefully)) return true;
    }
    return false;
  };
  if (look(kCareful, false) || look(kCareful, true) || look(kWindow, false) ||
      look(kCarefulAtLast, true))
    return;
  if (!(least_ < kUnknown)) return;
  broken_ = true;
  const Tolerance& t = least_allowed_;
  const double mm = std::max(path::norm3(off_, 0), path::norm3(off_, 6));
  std::int32_t index = 0;
  double value = mm, limit = t.mm;
  for (std::size_t i = 3; i < 6; ++i)
    if (std::abs(off_[i]) / (t.deg + kRounding) > value / (limit + kRounding)) {
      index = static_cast<std::int32_t>(i);
      value = std::abs(off_[i]);
      limit = t.deg;
    }
  raise(faults, Fault::limit_path, index, value, limit, tag);
}

}  // namespace kerf::motion
