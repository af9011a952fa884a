#include "motion/core/planner/joint_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/planner/ceilings.hpp"

namespace kerf::motion {
namespace {

using path::kNoLimit;
using path::Piece;
using path::Vec;

/// Differences are taken over this much of the axis that moves most (mm, degrees).
constexpr double kStep = 0.01, kCurveStep = 0.001;
constexpr double kVelShare = 0.995, kAccShare = 0.97;
/// Share of the acceleration that is kept for speeding up and braking, when the feed cannot be had whole.
constexpr double kAlongStraights = 0.6, kAlongBlends = 0.35;
/// How far the quadratics may bend, and rates change along one stretch, as parts of the limits.
constexpr double kBend = 0.05, kChange = 0.3;
/// Of what the rates foretell.
constexpr double kSurprise = 0.02;
constexpr double kLongest = 50;         ///< way of the axis that moves most (mm, degrees)
constexpr double kLongestSweep = 0.25;  ///< rad of an arc
constexpr int kPerBlend = 2;            ///< stretches of a blend's piece at least
/// Shorter ones are rests that rounding leaves (sigma): where rates pass through zero they would be halved for ever.
constexpr double kShortest = 1e-6;
constexpr int kMostHalvings = 14;
constexpr int kForSpeed = 3;  ///< of these, such as only make boxes fit better
/// Where nothing fits: the machine creeps (mm/s, mm/s2).
constexpr double kCreep = 0.1, kCreepAcc = 1;
constexpr double kCreepJerk = 10;  ///< mm/s3
/// The same for curves. Less is left to chance there.
constexpr double kCurveVelShare = 0.9995, kCurveAccShare = 0.999, kCurveJerkShare = 0.995;
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

double square(double x) noexcept { return x * x; }

/// No stretch is longer than it can be looked at in one; `per_blend` stretches of each piece of a blend at least.
void shorten(const Piece& piece, int per_blend, double from, double& to) noexcept {
  // sigma is stretched where slow axes decide.
  const double along = max_abs(piece.first(from));
  double most = along > 0 ? kLongest / along : piece.length;
  if (piece.shape == Piece::Shape::arc)
    most = kLongestSweep / std::abs(piece.rate);
  else if (!piece.straight())
    most = piece.length / per_blend;
  // A short rest would be a stretch of its own.
  if (to - from > most) to = to - from < 1.5 * most ? (from + to) / 2 : from + most;
}

}  // namespace

void JointBounds::configure(const MachineConfig& config, const path::AxisLimits& axes) noexcept {
  joints_ = static_cast<std::size_t>(joints_of(kinematics_.joints(), config));
  axes_ = axes;
  // A joint that several axes move has what their external offsets leave; `axes` have it already.
  double rest = 1;
  for (std::size_t i = 0; i < path::kAxes; ++i)
    if ((axes_of(kinematics_.axis_mask(), config) >> i & 1U) != 0)
      rest = std::min(rest, 1 - config.axis[i].offset_av_ratio);
  for (std::size_t j = 0; j < joints_; ++j) {
    const JointConfig& c = config.joint[j];
    limit_[j] = {rest * c.max_vel * kVelShare, rest * c.max_acc * kAccShare};
    low_[j] = c.min_limit;
    high_[j] = c.max_limit;
  }
  mixed_count_ = 0;
  for (std::size_t j = 0; j < joints_; ++j) {
    if (kinematics_.axis_of_joint(static_cast<std::int32_t>(j)) >= 0) continue;
    const JointConfig& c = config.joint[j];
    path::JointCurve::Row& row = mixed_limit_[mixed_count_];
    row.vel = rest * c.max_vel * kCurveVelShare;
    row.acc = rest * c.max_acc * kCurveAccShare;
    row.jerk = c.max_jerk > 0 ? rest * c.max_jerk * kCurveJerkShare : kNoLimit;
    mixed_[mixed_count_++] = j;
  }
  near_ = JointVector{};
}

void JointBounds::look(const Piece& piece, double s, double most_step, Place& out) noexcept {
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
    const double step = most_step / most;
    out.solved = around(out.first, step, before, after);
    if (!out.solved) return;
    for (std::size_t j = 0; j < joints_; ++j) {
      out.rate[j] = (after[j] - before[j]) / (2 * step);
      out.curl[j] = (after[j] - 2 * here[j] + before[j]) / (step * step);
    }
  }
  if (const double most = max_abs(out.second); most > 0) {
    const double step = most_step / most;
    out.solved = around(out.second, step, before, after);
    if (!out.solved) return;
    for (std::size_t j = 0; j < joints_; ++j) out.curl[j] += (after[j] - before[j]) / (2 * step);
  }
}

/// f(rates, curls, limit) of each joint and each axis, at the three places.
template <class F>
void JointBounds::for_each_row(const Place& a, const Place& m, const Place& b, std::size_t joints,
                               const Limit* limit, const path::AxisLimits& axes, F&& f) noexcept {
  for (std::size_t j = 0; j < joints; ++j) {
    const double rate[] = {a.rate[j], m.rate[j], b.rate[j]};
    const double curl[] = {a.curl[j], m.curl[j], b.curl[j]};
    f(rate, curl, limit[j]);
  }
  for (std::size_t i = 0; i < path::kAxes; ++i) {
    if (axes.acc[i] >= kNoLimit && axes.vel[i] >= kNoLimit) continue;
    const double rate[] = {a.first[i], m.first[i], b.first[i]};
    const double curl[] = {a.second[i], m.second[i], b.second[i]};
    f(rate, curl, Limit{axes.vel[i], axes.acc[i] * kAccShare});
  }
}

JointBounds::Box JointBounds::fit(const Piece& piece, const Place& a, const Place& m,
                                  const Place& b, double x_wanted) const noexcept {
  const bool straight = piece.straight();
  // On a line the joints alone bend, and little; within a blend the path does.
  const bool blend = !straight && piece.shape == Piece::Shape::cubic;
  Box out;
  out.cap = path::axis_cap(piece, a.s, b.s, axes_);
  double even_acc = straight ? path::straight_acc(piece, axes_) : kNoLimit;
  const auto rows = [&](auto&& f) {
    for_each_row(a, m, b, joints_, limit_, axes_,
                 [&](const double* rate, const double* curl, const Limit& limit) {
                   // Between the ends a quadratic stays within these three.
                   f(std::abs(rate[0]), std::abs(curl[0]), limit);
                   f(std::abs(2 * rate[1] - (rate[0] + rate[2]) / 2),
                     std::abs(2 * curl[1] - (curl[0] + curl[2]) / 2), limit);
                   f(std::abs(rate[1]), std::abs(curl[1]), limit);
                   f(std::abs(rate[2]), std::abs(curl[2]), limit);
                 });
  };
  rows([&](double rate, double, const Limit& limit) {
    if (!(rate > 0)) return;
    out.cap = std::min(out.cap, square(limit.vel / rate));
    even_acc = std::min(even_acc, limit.acc / rate);
  });
  const double x = std::min(out.cap, x_wanted);
  // Either all of the speed and what it leaves, or a share for speeding up and the speed that this leaves.
  const double share = (blend ? kAlongBlends : kAlongStraights) * even_acc;
  double left = even_acc, most = out.cap;
  rows([&](double rate, double curl, const Limit& limit) {
    if (rate > 0)
      left = std::min(left, (limit.acc - x * curl) / rate);
    else if (x * curl > limit.acc)
      left = 0;
    if (curl > 0) most = std::min(most, (limit.acc - share * rate) / curl);
  });
  if (left >= share) return {x, left};
  return {std::max(most, 0.0), share};
}

/// Whether the rates at two places explain how far the joints come from one to the other, and the curls how the rates change.
bool JointBounds::foretold(const Place& a, const Place& b, const Box& box) const noexcept {
  const double h = b.s - a.s, v = std::sqrt(box.cap);
  // The joint that has most to do on the way says what little is.
  double most = 0;
  for (std::size_t j = 0; j < joints_; ++j)
    most = std::max(most, std::max(std::abs(a.rate[j]), std::abs(b.rate[j])) / limit_[j].vel);
  for (std::size_t j = 0; j < joints_; ++j) {
    const double way = b.joint[j] - a.joint[j];
    const double expected = h * (a.rate[j] + b.rate[j]) / 2 - h * h * (b.curl[j] - a.curl[j]) / 12;
    const double rate = b.rate[j] - a.rate[j] - h * (a.curl[j] + b.curl[j]) / 2;
    if (std::abs(way - expected) > (kSurprise * most * h + 1e-9) * limit_[j].vel) return false;
    if (std::abs(rate) > kSurprise * most * limit_[j].vel &&
        (std::abs(rate) * v > kSurprise * limit_[j].vel ||
         std::abs(rate) * box.acc > kSurprise * limit_[j].acc))
      return false;
  }
  return true;
}

bool JointBounds::even(const Place& a, const Place& m, const Place& b, const Box& box,
                       bool for_speed) const noexcept {
  const double v = std::sqrt(box.cap);
  bool out = true;
  for_each_row(a, m, b, joints_, limit_, axes_,
               [&](const double* rate, const double* curl, const Limit& limit) {
                 const double bent = std::abs(rate[0] - 2 * rate[1] + rate[2]),
                              changed = std::abs(rate[2] - rate[0]),
                              curl_bent = std::abs(curl[0] - 2 * curl[1] + curl[2]),
                              curl_changed = std::abs(curl[2] - curl[0]);
                 out = out && bent * v <= kBend * limit.vel &&
                       bent * box.acc <= kBend * limit.acc &&
                       curl_bent * box.cap <= kBend * limit.acc;
                 // Where all rates pass through zero together they always change by more than they are.
                 if (for_speed)
                   out = out && changed * v <= kChange * limit.vel &&
                         changed * box.acc <= kChange * limit.acc &&
                         curl_changed * box.cap <= kChange * limit.acc;
               });
  return out;
}

JointBounds::Box JointBounds::box_of(const Piece& piece, double from, double& to,
                                     double x_wanted) noexcept {
  shorten(piece, kPerBlend, from, to);
  Place a, m, b;
  look(piece, from, kStep, a);
  look(piece, (from + to) / 2, kStep, m);
  look(piece, to, kStep, b);
  for (int n = 0;; ++n) {
    const bool solved = a.solved && m.solved && b.solved;
    if (solved) {
      const Box box = fit(piece, a, m, b, x_wanted);
      const bool known = to - from <= kShortest || (even(a, m, b, box, n < kForSpeed) &&
                                                    foretold(a, m, box) && foretold(m, b, box));
      if (box.cap > 0 && box.acc > 0 && known) {
        near_ = b.joint;
        return box;
      }
    }
    if (n == kMostHalvings || to - from <= kShortest) {
      // A pole, or the end of the workspace: the servo cycle looks for itself and stops there if need be.
      near_ = b.solved ? b.joint : near_;
      Box box{square(kCreep), kCreepAcc};
      if (solved) {
        const Box fits = fit(piece, a, m, b, x_wanted);
        box = {std::clamp(fits.cap / 4, square(1e-3 * kCreep), square(kCreep)),
               std::clamp(fits.acc / 4, 1e-3 * kCreepAcc, kCreepAcc)};
      }
      return box;
    }
    b = m;
    to = b.s;
    if (a.solved) near_ = a.joint;
    look(piece, (from + to) / 2, kStep, m);
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
  shorten(piece, 1, from, to);
  Place at[kPlaces];
  for (std::size_t i = 0; i < kPlaces; ++i)
    look(piece, from + (to - from) * static_cast<double>(i) / (kPlaces - 1), kCurveStep, at[i]);
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
    look(piece, from + (to - from) / 4, kCurveStep, at[1]);
    look(piece, from + (to - from) * 3 / 4, kCurveStep, at[3]);
  }
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
  JointVector at = near_;
  for (int n = 0; n < kLooks; ++n) {
    if (!kinematics_.inverse(to_pose(piece.point(piece.length * n / (kLooks - 1))), at))
      return false;
    for (std::size_t j = 0; j < joints_; ++j) {
      const double q = at[j] + skew[j];
      if (q < low_[j] - kLimitTolerance || q > high_[j] + kLimitTolerance) return false;
    }
  }
  return true;
}

}  // namespace kerf::motion
