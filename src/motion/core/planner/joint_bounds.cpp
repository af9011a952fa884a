#include "motion/core/planner/joint_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/planner/ceilings.hpp"
#include "motion/core/planner/turn.hpp"

namespace kerf::motion {
namespace {

using path::kNoLimit;
using path::Piece;
using path::Vec;

/// Differences are taken over this much of the axis that moves most (mm, degrees).
constexpr double kStep = 0.001;
constexpr double kLongest = 50;         ///< way of the axis that moves most (mm, degrees)
constexpr double kLongestSweep = 0.25;  ///< rad of an arc
/// Shorter ones are rests that rounding leaves (sigma): where rates pass through zero they would be halved for ever.
constexpr double kShortest = 1e-6;
constexpr int kMostHalvings = 14;
/// Where nothing fits: the machine creeps (mm/s, mm/s2).
constexpr double kCreep = 0.1, kCreepAcc = 1;
constexpr double kCreepJerk = 10;  ///< mm/s3
/// What is left to chance.
constexpr double kVelShare = 0.9995, kAccShare = 0.999, kJerkShare = 0.995;
/// How far a curve may be off a quarter from its ends, as shares of the limits; of the way, where another solution would be taken.
constexpr double kVelOff = 2e-4, kAccOff = 2e-4, kJerkOff = 4e-3, kWayOff = 1e-3;
/// The largest second derivative of (t (t - 1/2) (t - 1))^2 over its value there.
constexpr double kTwistOff = 228;
/// What takes less time than that is too short for its twist to be told from rounding, and for a cycle to see (s).
constexpr double kNoTwist = 3e-4;
/// Speeds are judged up to this much above what the curls leave; places at which less than this share of the rates is left for what u may be.
constexpr double kMostX = 1.5, kLeastRate = 0.1;
constexpr double kLimitTolerance = 1e-6;
constexpr int kLooks = 5;
/// Fourth differences at kStep of what is computed in closed form are rounding, some 1e-13 of joints of 1000 mm.
constexpr double kRough = 1e-11, kRoughOf = 100;
/// After so many tries stretches are halved a lot; so few of them fit into what can be asked at once however often that is.
constexpr int kManyTries = 8;
constexpr std::size_t kFew = 4;

double square(double x) noexcept { return x * x; }

/// No stretch is longer than it can be looked at in one.
void shorten(const Piece& piece, double from, double& to) noexcept {
  // sigma is stretched where slow axes decide.
  const double along = max_abs(piece.first(from));
  double most = along > 0 ? kLongest / along : piece.length;
  if (piece.shape == Piece::Shape::arc)
    most = kLongestSweep / std::abs(piece.rate);
  else if (!piece.straight())
    most = piece.length;
  // A short rest would be a stretch of its own.
  if (to - from > most) to = to - from < 1.5 * most ? (from + to) / 2 : from + most;
}

}  // namespace

void JointBounds::configure(const MachineConfig& config, const path::AxisLimits& axes) noexcept {
  joints_ = static_cast<std::size_t>(joints_of(kinematics_.joints(), config));
  axes_ = axes;
  moved_ = axes_of(kinematics_.axis_mask(), config);
  // A joint that several axes move has what their external offsets leave; `axes` have it already.
  const double rest = share_beside_offsets(config, moved_);
  for (std::size_t j = 0; j < joints_; ++j) {
    const JointConfig& c = config.joint[j];
    low_[j] = c.min_limit;
    high_[j] = c.max_limit;
  }
  mixed_count_ = 0;
  for (std::size_t j = 0; j < joints_; ++j) {
    if (kinematics_.axis_of_joint(static_cast<std::int32_t>(j)) >= 0) continue;
    const JointConfig& c = config.joint[j];
    path::JointCurve::Row& row = mixed_limit_[mixed_count_];
    row.vel = rest * c.max_vel * kVelShare;
    row.acc = rest * c.max_acc * kAccShare;
    row.jerk = c.max_jerk > 0 ? rest * c.max_jerk * kJerkShare
               : axes.jerks   ? row.acc / kSoonestAcc
                              : kNoLimit;
    mixed_[mixed_count_++] = j;
  }
  near_ = JointVector{};
}

void JointBounds::look(const Piece& piece, double s, Place& out) noexcept {
  out.s = s;
  out.first = piece.first(s);
  out.second = piece.second(s);
  out.rate = out.curl = JointVector{};
  const Vec at = piece.point(s);
  JointVector here = near_;
  out.solved = kinematics_.inverse(to_pose(at), here);
  if (!out.solved) return;
  out.joint = near_ = here;
  const auto around = [&](const Vec& way, double step, JointVector& before, JointVector& after) {
    before = after = here;
    return kinematics_.inverse(to_pose(at - way * step), before) &&
           kinematics_.inverse(to_pose(at + way * step), after);
  };
  JointVector before, after;
  if (const double most = max_abs(out.first); most > 0) {
    const double step = kStep / most;
    out.solved = around(out.first, step, before, after);
    if (!out.solved) return;
    for (std::size_t j = 0; j < joints_; ++j) {
      out.rate[j] = (after[j] - before[j]) / (2 * step);
      out.curl[j] = (after[j] - 2 * here[j] + before[j]) / (step * step);
    }
  }
  if (const double most = max_abs(out.second); most > 0) {
    const double step = kStep / most;
    out.solved = around(out.second, step, before, after);
    if (!out.solved) return;
    for (std::size_t j = 0; j < joints_; ++j) out.curl[j] += (after[j] - before[j]) / (2 * step);
  }
}

/// The curve through what was found at the first, third and fifth place, and whether it foretells what was found at the others.
bool JointBounds::foretold(const Piece& piece, const Place (&at)[kPlaces],
                           path::JointCurve& out) const noexcept {
  const double length = at[4].s - at[0].s;
  out.from = at[0].s;
  out.length = length;
  out.count = mixed_count_;
  double x = path::axis_cap(piece, at[0].s, at[4].s, axes_), least = kNoLimit, most = 0;
  for (const Place& place : at) {
    double share = 0;  // of the accelerations, at u = 1
    for (std::size_t i = 0; i < path::kAxes; ++i)
      share = std::max(share, std::abs(place.first[i]) / axes_.acc[i]);
    for (std::size_t n = 0; n < mixed_count_; ++n) {
      const path::JointCurve::Row& limit = mixed_limit_[n];
      const double rate = std::abs(place.rate[mixed_[n]]), curl = std::abs(place.curl[mixed_[n]]);
      share = std::max(share, rate / limit.acc);
      if (rate > 0) x = std::min(x, square(limit.vel / rate));
      if (curl > 0) x = std::min(x, kMostX * limit.acc / curl);
    }
    least = std::min(least, share);
    most = std::max(most, share);
  }
  const double u = 1 / std::max({least, kLeastRate * most, 1e-99}), v = std::sqrt(x);
  for (std::size_t n = 0; n < mixed_count_; ++n) {
    const std::size_t j = mixed_[n];
    path::JointCurve::Row& row = out.row[n];
    row = mixed_limit_[n];
    const double r0 = at[0].rate[j], d0 = at[0].curl[j] * length;
    // (j' - r0 - d0 t) / t^2 is a cubic from the middle to the end: its values, slopes there, then coefficients in 2 t - 1.
    const double f0 = 4 * (at[2].rate[j] - r0 - d0 / 2), f1 = at[4].rate[j] - r0 - d0;
    const double m0 = (4 * (at[2].curl[j] * length - d0) - 4 * f0) / 2,
                 m1 = (at[4].curl[j] * length - d0 - 2 * f1) / 2;
    const double c2 = 3 * (f1 - f0) - 2 * m0 - m1, c3 = m0 + m1 - 2 * (f1 - f0);
    row.k[0] = r0;
    row.k[1] = d0;
    row.k[2] = f0 - m0 + c2 - c3;
    row.k[3] = 2 * m0 - 4 * c2 + 6 * c3;
    row.k[4] = 4 * c2 - 12 * c3;
    row.k[5] = 8 * c3;
    for (const Place* place : {&at[1], &at[3]}) {
      const path::JointPlace told = path::place_on(out, n, place->s);
      const double rate = std::abs(told.rate - place->rate[j]),
                   curl = std::abs(told.curl - place->curl[j]);
      if (rate * v > kVelOff * row.vel || rate * u > kAccOff * row.acc ||
          curl * x > kAccOff * row.acc)
        return false;
      if (length > kNoTwist * v && kTwistOff * rate * v * x > kJerkOff * row.jerk * length * length)
        return false;
    }
    double way = 0, steep = 0;
    for (std::size_t i = 0; i < std::size(row.k); ++i)
      way += row.k[i] / static_cast<double>(i + 1) * length;
    for (const Place& place : at) steep = std::max(steep, std::abs(place.rate[j]));
    if (std::abs(at[4].joint[j] - at[0].joint[j] - way) > kWayOff * steep * length + 1e-7)
      return false;
  }
  return true;
}

bool JointBounds::curve_of(const Piece& piece, double from, double& to,
                           path::JointCurve& out) noexcept {
  shorten(piece, from, to);
  Place at[kPlaces];
  for (std::size_t i = 0; i < kPlaces; ++i)
    look(piece, from + (to - from) * static_cast<double>(i) / (kPlaces - 1), at[i]);
  for (int n = 0;; ++n) {
    const bool solved =
        std::all_of(std::begin(at), std::end(at), [](const Place& p) { return p.solved; });
    if (solved && foretold(piece, at, out)) {
      near_ = at[4].joint;
      return true;
    }
    if (n == kMostHalvings || to - from <= kShortest) {
      // A pole, or the end of the workspace: the servo cycle looks for itself and stops there if need be.
      if (at[4].solved) near_ = at[4].joint;
      set_creep(at, solved);
      out.count = 0;
      return false;
    }
    at[4] = at[2];
    at[2] = at[1];
    to = at[4].s;
    if (at[0].solved) near_ = at[0].joint;
    look(piece, from + (to - from) / 4, at[1]);
    look(piece, from + (to - from) * 3 / 4, at[3]);
  }
}

bool JointBounds::tell(const path::Buffer<Piece>& pieces, Cursor& at,
                       path::Buffer<Told>& out) noexcept {
  const JointVector here = near_;
  const std::size_t were = out.size();
  const std::size_t most = were + (at.tries < kManyTries ? kTogether : kFew);
  Cursor next{at.piece, at.from};
  // As if each were foretold: that is so of most, and their answers come together.
  while (next.piece < pieces.size() && out.size() < most) {
    const Piece& piece = pieces[next.piece];
    Told told;
    told.piece = next.piece;
    told.from = next.from;
    told.to = piece.length;
    told.foretold = curve_of(piece, told.from, told.to, told.curve);
    told.creep = creep_;
    out.push_back(told);
    if (told.to < piece.length)
      next.from = told.to;
    else
      next = {next.piece + 1, 0};
  }
  if (kinematics_.complete()) {
    at = next;
    return true;
  }
  near_ = here;
  ++at.tries;
  out.truncate(were);
  return false;
}

bool JointBounds::smooth_at(const Vec& at) noexcept {
  constexpr int kAround = 2;
  constexpr double kWeight[] = {1, -4, 6, -4, 1};
  bool smooth = true;
  for (std::size_t i = 0; i < path::kAxes; ++i) {
    if ((moved_ >> i & 1U) == 0) continue;
    JointVector fourth{}, largest{};
    for (int k = -kAround; k <= kAround; ++k) {
      Vec place = at;
      place[i] += k * kStep;
      JointVector joint = near_;
      if (!kinematics_.inverse(to_pose(place), joint)) smooth = false;
      for (std::size_t j = 0; j < joints_; ++j) {
        fourth[j] += kWeight[k + kAround] * joint[j];
        largest[j] = std::max(largest[j], std::abs(joint[j]));
      }
    }
    for (std::size_t n = 0; n < mixed_count_; ++n) {
      const std::size_t j = mixed_[n];
      smooth = smooth && std::abs(fourth[j]) <= kRough * std::max(1.0, largest[j] / kRoughOf);
    }
  }
  return smooth;
}

void JointBounds::set_creep(const Place (&at)[kPlaces], bool solved) noexcept {
  creep_ = {{kCreepAcc, kCreepJerk}, square(kCreep)};
  for (std::size_t n = 0; n < mixed_count_ && solved; ++n) {
    const path::JointCurve::Row& limit = mixed_limit_[n];
    double rate = 0, curl = 0;
    for (const Place& place : at) {
      rate = std::max(rate, std::abs(place.rate[mixed_[n]]));
      curl = std::max(curl, std::abs(place.curl[mixed_[n]]));
    }
    if (rate > 0) {
      creep_.box.acc = std::min(creep_.box.acc, limit.acc / (4 * rate));
      creep_.box.jerk = std::min(creep_.box.jerk, limit.jerk / (4 * rate));
      creep_.cap = std::min(creep_.cap, square(limit.vel / rate) / 4);
    }
    if (curl > 0) creep_.cap = std::min(creep_.cap, limit.acc / (4 * curl));
  }
  creep_.box.acc = std::max(creep_.box.acc, 1e-3 * kCreepAcc);
  creep_.box.jerk = std::max(creep_.box.jerk, 1e-3 * kCreepJerk);
  creep_.cap = std::max(creep_.cap, square(1e-3 * kCreep));
}

void JointBounds::bends_of(const path::Buffer<Piece>& pieces, path::JointBends* out) noexcept {
  const JointVector here = near_;
  path::JointCurve curve;
  for (const Piece& piece : pieces) {
    path::JointBends& of_piece = *out++;
    of_piece = path::JointBends{};
    for (double from = 0, to = 0; from < piece.length; from = to) {
      to = piece.length;
      if (curve_of(piece, from, to, curve)) of_piece.join(path::bends_of(curve, from, to));
    }
  }
  near_ = here;
}

bool JointBounds::reaches(const Piece& piece, const double* skew) const noexcept {
  JointVector before = near_, here = near_, at = near_;
  const auto inside = [&](std::size_t j, double least, double most) {
    return least + skew[j] >= low_[j] - kLimitTolerance &&
           most + skew[j] <= high_[j] + kLimitTolerance;
  };
  for (int n = 0; n < kLooks; ++n) {
    before = here;
    here = at;
    if (!kinematics_.inverse(to_pose(piece.point(piece.length * n / (kLooks - 1))), at))
      return false;
    for (std::size_t j = 0; j < joints_; ++j) {
      if (!inside(j, at[j], at[j])) return false;
      const Turn turn = n > 1 ? turn_of(before[j], here[j], at[j]) : Turn{};
      if (!turn.within || inside(j, turn.value - turn.doubt, turn.value + turn.doubt)) continue;
      const double place = std::clamp((n - 1 + turn.at) / (kLooks - 1), 0.0, 1.0);
      JointVector there = here;
      if (!kinematics_.inverse(to_pose(piece.point(piece.length * place)), there) ||
          !inside(j, there[j], there[j]))
        return false;
    }
  }
  return true;
}

}  // namespace kerf::motion
