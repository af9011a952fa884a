#include "motion/core/jog_pace.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {
namespace {

/// Differences are taken over so much (mm, degrees).
constexpr double kStep = 0.1;
/// Shares of a joint's limits. What is left is for what is not looked at: places between those that are, and differences.
constexpr double kAll = 0.93, kOfVelocity = 0.97;
constexpr double kMostOfBend = 0.35;    ///< of acceleration, for j''
constexpr double kMostOfTwist = 0.12;   ///< of jerk, for j'''
constexpr double kMostOfProduct = 0.3;  ///< of jerk, for j'' times what the movers do
constexpr double kStraight = 1e-3;      ///< of the acceleration; what bends less is straight
constexpr double kSpare = 1.05;
constexpr double kLeastScale = 0.05, kLeastPace = 1e-3;
/// Where there is no position or none beside it.
constexpr double kCreep = 0.002;
/// By so much more from step to step joints go at a wall where it leads deeper.
constexpr double kDeeper = 1.05;
/// What moves is slow enough for one that joins.
constexpr double kSlowEnough = 1.02;
constexpr double kStands = 1e-9;  ///< mm/s, degrees/s
/// s that a place asks for is met by one a little above.
constexpr double kSameScale = 1.0001;
/// The way to the end is looked at so finely, so far (mm, degrees); what it asks for counts as long as it is so much of what is asked for here.
constexpr std::size_t kPlaces = 6;
constexpr double kFarthest = 500, kMuchWorse = 0.5;
/// What is asked for here may grow a little on the way.
constexpr double kReserve = 0.97;
constexpr double kLooksAhead = 2, kLooksAheadAtLeast = 0.05;  ///< times the way to stop; s

/// A joint along one way: derivatives for what the way is measured in.
struct Rates {
  JointVector first{}, second{}, third{};
};

/// What jogs have of a joint's limits.
struct Bounds {
  double vel, acc, jerk;
  bool alone;  ///< it moves one axis alone, whose limits are not above its own
};
Bounds bounds_of(const JogPace::Machine& m, std::size_t j) noexcept {
  const JointConfig& c = m.joint[j];
  if (m.kinematics.axis_of_joint(static_cast<std::int32_t>(j)) >= 0)
    return {c.max_vel, c.max_acc, c.max_jerk, true};
  return {m.share * c.max_vel, m.share * c.max_acc, m.share * c.max_jerk, false};
}

/// `by`: from the middle point to the next. False: no position there.
bool rates_along(const JogPace::Machine& m, const Pose& at, const Pose& by, double step,
                 Rates& out) noexcept {
  std::array<JointVector, 5> q;
  for (std::size_t n = 0; n < q.size(); ++n) {
    Pose p = at;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) p[i] += (static_cast<double>(n) - 2) * by[i];
    q[n] = m.near;
    if (!m.kinematics.inverse(p, q[n])) return false;
  }
  for (std::size_t j = 0; j < static_cast<std::size_t>(m.kinematics.joints()); ++j) {
    out.first[j] = (q[3][j] - q[1][j]) / (2 * step);
    out.second[j] = (q[3][j] - 2 * q[2][j] + q[1][j]) / (step * step);
    out.third[j] = (q[4][j] - 2 * q[3][j] + 2 * q[1][j] - q[0][j]) / (2 * step * step * step);
  }
  return true;
}

}  // namespace

JogPace::Sight JogPace::look(const Movers& axis, const Pose& at, const Machine& m) const noexcept {
  Sight sight;
  const auto joints = static_cast<std::size_t>(m.kinematics.joints());
  // Of all axes at their full speed and acceleration; with signs, and without.
  JointVector vel{}, acc{}, jerk{}, bend{}, bends{}, twist{}, twists{};
  double hurry = 0, fastest = 0;
  int moving = 0;
  Pose together;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if ((wanted_ >> i & 1U) == 0) continue;
    const AxisMover& mover = axis[i];
    const double v = mover.speed_limit();
    Pose by;
    by[i] = kStep;
    Rates r;
    if (!rates_along(m, at, by, kStep, r)) return {kLeastScale, kCreep, true};
    for (std::size_t j = 0; j < joints; ++j) {
      const double slope = std::abs(r.first[j]);
      vel[j] += slope * v;
      acc[j] += slope * mover.acc();
      jerk[j] += slope * mover.jerk();
      bend[j] += r.second[j] * v * v;
      bends[j] += std::abs(r.second[j]) * v * v;
      twist[j] += r.third[j] * v * v * v;
      twists[j] += std::abs(r.third[j]) * v * v * v;
    }
    hurry = std::max(hurry, mover.acc() / v);
    fastest = std::max(fastest, v);
    ++moving;
    together[i] = mover.target() >= mover.position() ? v : -v;
  }
  if (moving > 1) {
    const double step = kStep / fastest;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) together[i] *= step;
    Rates r;
    if (!rates_along(m, at, together, step, r)) return {kLeastScale, kCreep, true};
    // What the axes do to each other, whichever way they go.
    for (std::size_t j = 0; j < joints; ++j) {
      bends[j] += std::abs(r.second[j] - bend[j]);
      twists[j] += std::abs(r.third[j] - twist[j]);
    }
  }
  const auto most = [](double& value, double bound) { value = std::min(value, bound); };
  JointVector for_product{};
  for (std::size_t j = 0; j < joints; ++j) {
    const Bounds c = bounds_of(m, j);
    if (vel[j] <= 0) continue;
    if (!c.alone) most(sight.pace, kOfVelocity * c.vel / vel[j]);
    const double bent = bends[j] / c.acc * kSpare;
    const double for_bend = c.alone ? 0 : std::min(bent, kMostOfBend) + kStraight;
    if (bent > kStraight) most(sight.pace, std::sqrt(for_bend * kSpare / bent));
    most(sight.scale, std::sqrt(((c.alone ? 1 : kAll) - for_bend) * c.acc / acc[j]));
  }
  for (std::size_t j = 0; j < joints; ++j) {
    const Bounds c = bounds_of(m, j);
    if (vel[j] <= 0 || !(c.jerk > 0)) continue;
    const double twisted = twists[j] / c.jerk * kSpare;
    const double product = 3 * bends[j] * hurry * sight.scale * sight.scale / c.jerk * kSpare;
    const double for_twist = c.alone ? 0 : std::min(twisted, kMostOfTwist) + kStraight;
    for_product[j] = c.alone ? 0 : std::min(product, kMostOfProduct) + kStraight;
    if (twisted > kStraight) most(sight.pace, std::cbrt(for_twist * kSpare / twisted));
    const double rest = (c.alone ? 1 : kAll) - for_twist - for_product[j];
    if (jerk[j] > 0) most(sight.scale, std::cbrt(rest * c.jerk / jerk[j]));
  }
  for (std::size_t j = 0; j < joints; ++j)
    if (for_product[j] > 2 * kStraight)
      most(sight.pace, for_product[j] * bounds_of(m, j).jerk /
                           (3 * bends[j] * hurry * sight.scale * sight.scale));
  sight.wall = sight.pace < kLeastPace || sight.scale < kLeastScale;
  sight.scale = std::max(sight.scale, kLeastScale);
  sight.pace = std::max(sight.pace, kLeastPace);
  return sight;
}

/// At a wall: joints go faster and faster along the next steps of this jog, or there is no position.
bool JogPace::goes_deeper(const AxisMover& mover, std::size_t i, const Pose& at,
                          const Machine& m) const noexcept {
  const double by = std::copysign(kStep, mover.target() - mover.position());
  std::array<JointVector, 3> q;
  for (std::size_t n = 0; n < q.size(); ++n) {
    Pose p = at;
    p[i] += static_cast<double>(n) * by;
    q[n] = m.near;
    if (!m.kinematics.inverse(p, q[n])) return n > 0;
  }
  double first = 0, second = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(m.kinematics.joints()); ++j) {
    first = std::max(first, std::abs(q[1][j] - q[0][j]) / m.joint[j].max_acc);
    second = std::max(second, std::abs(q[2][j] - q[1][j]) / m.joint[j].max_acc);
  }
  return second > kDeeper * first;
}

/// Where the jogs may be by the time they stand, if they stop now, and once more as far; the first sight is here.
Pose JogPace::ahead(const Movers& axis, const Pose& pose, std::size_t sight) const noexcept {
  Pose p = pose;
  const double part = static_cast<double>(sight) / (kSights - 1);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if ((admitted_ >> i & 1U) == 0) continue;
    const AxisMover& mover = axis[i];
    const double here = mover.position(), to = mover.target() - here;
    double way =
        kLooksAhead * (mover.rest_position() - here) + kLooksAheadAtLeast * mover.speed() * scale();
    // Not farther than it will go.
    if (way * to > 0 && std::abs(way) > std::abs(to)) way = to;
    p[i] += part * way;
  }
  return p;
}

double JogPace::scale_for_the_way(const Movers& axis, const Pose& pose, const Machine& machine,
                                  double here) const noexcept {
  double least = here * kReserve;
  for (std::size_t n = 1; n <= kPlaces; ++n) {
    const double part = static_cast<double>(n) / kPlaces;
    Pose at = pose + machine.offset;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      if ((wanted_ >> i & 1U) != 0)
        at[i] += part * std::clamp(axis[i].target() - axis[i].position(), -kFarthest, kFarthest);
    const double there = look(axis, at, machine).scale * kReserve;
    if (there > kMuchWorse * here) least = std::min(least, there);
  }
  return least;
}

void JogPace::take(Movers& axis) noexcept {
  std::uint32_t wanted = 0;
  std::array<double, rtapi::kAxes> speeds{};
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    AxisMover& mover = axis[i];
    // One that waits and is stopped stands already.
    if ((admitted_ >> i & 1U) == 0 && mover.active() && mover.stopping())
      mover.place(mover.position());
    if (!mover.active()) continue;
    wanted |= 1U << i;
    speeds[i] = mover.speed_limit();
  }
  anew_ = wanted != wanted_ || speeds != speeds_;
  wanted_ = wanted;
  speeds_ = speeds;
  admitted_ &= wanted;
}

/// All that moves is slow enough for all that is to move.
bool JogPace::admit(const Movers& axis, const Sight& least) const noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if ((admitted_ >> i & 1U) != 0 &&
        axis[i].fastest() * scale_ > least.pace * axis[i].speed_limit() * kSlowEnough)
      return false;
  return true;
}

void JogPace::step(Movers& axis, const Pose& pose, const Machine& machine, double dt,
                   bool faster) noexcept {
  take(axis);
  if (wanted_ == 0) return;
  for (std::size_t n = 0; n < (anew_ ? kSights : 1); ++n) {
    next_ = (next_ + 1) % kSights;
    sight_[next_] = look(axis, ahead(axis, pose, next_) + machine.offset, machine);
  }
  // Into what joints cannot follow nothing goes; from within it creeps what does not lead deeper.
  if (std::any_of(std::begin(sight_), std::end(sight_), [](const Sight& s) { return s.wall; }))
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      if (!sight_[0].wall || ((wanted_ >> i & 1U) != 0 && !axis[i].stopping() &&
                              goes_deeper(axis[i], i, pose + machine.offset, machine)))
        axis[i].stop();
  Sight least = sight_[0];
  for (const Sight& s : sight_) {
    if (s.wall && !sight_[0].wall) continue;
    least = {std::min(least.scale, s.scale), std::min(least.pace, s.pace)};
  }
  bool stands = true;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    stands = stands && ((admitted_ >> i & 1U) == 0 || axis[i].fastest() < kStands);
  if (stands && (admitted_ == 0 || halts_)) {
    scale_ = scale_for_the_way(axis, pose, machine, std::min(least.scale, needed_));
    needed_ = 1;
    halts_ = false;
  } else if (halts_ || scale_ > least.scale * kSameScale) {
    halts_ = true;
    needed_ = std::min(needed_, least.scale);
  }
  const bool all = faster && !halts_ && admit(axis, least);
  if (all) admitted_ = wanted_;
  const double pace = halts_ ? 0 : least.pace / scale_;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if ((admitted_ >> i & 1U) == 0) continue;
    // Before all are slow enough none gets faster.
    const double speed = axis[i].fastest() / axis[i].speed_limit();
    axis[i].set_pace(all ? pace : std::min(pace, std::max(speed, kLeastPace)));
    axis[i].step(scale_ * dt);
  }
}

}  // namespace kerf::motion
