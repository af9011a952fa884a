#include "motion/core/offset_pace.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {
namespace {

/// Differences are taken over so much (mm, degrees).
constexpr double kStep = 0.1;
/// Of J' over a unit of an axis: less is rounding, which limits that mean "none" would make much of.
constexpr double kStraight = 1e-7;
/// Of the share. What is left is for the path, whose own joints' speeds are other ones where the offset has taken it.
constexpr double kAll = 0.8;
/// Of acceleration and jerk, for what the path does to an offset that moves.
constexpr double kMostOfTurns = 0.4, kMostOfTurnsInJerk = 0.25;
/// Where there is no position beside the present one.
constexpr double kCreep = 0.002;
/// An acceleration that is too large from now on is taken away with the jerk limit; J grows meanwhile, for so long at most (s).
constexpr double kLongestLag = 0.05;

/// Sums over all offsets, of a joint.
struct Sums {
  JointVector vel{}, acc{}, jerk{};            ///< J o', J o'', J o'''
  JointVector turns{}, turns_acc{}, speeds{};  ///< J' o', J' o'', J'' o'
};

class Look {
 public:
  Look(const Pose& at, const OffsetPace::Machine& machine) noexcept : at_(at), m_(machine) {}

  /// False: no position.
  bool add(std::size_t axis, const OffsetPace::Limits& o, Sums& s) const noexcept {
    JointVector up, down;
    if (!joints_at(axis, 1, axis, 0, up) || !joints_at(axis, -1, axis, 0, down)) return false;
    JointVector turn{};
    for (std::size_t r = 0; r < rtapi::kAxes; ++r) {
      const AxisConfig& path = m_.path[r];
      if ((m_.kinematics.axis_mask() >> r & 1U) == 0 || !(path.max_vel > 0)) continue;
      JointVector q[4];
      if (!joints_at(axis, 1, r, 1, q[0]) || !joints_at(axis, 1, r, -1, q[1]) ||
          !joints_at(axis, -1, r, 1, q[2]) || !joints_at(axis, -1, r, -1, q[3]))
        return false;
      for (std::size_t j = 0; j < joints(); ++j) {
        const double bend = std::abs(q[0][j] - q[1][j] - q[2][j] + q[3][j]) / (4 * kStep * kStep);
        if (bend < kStraight) continue;
        turn[j] += bend * path.max_vel;
        s.speeds[j] += bend * path.max_acc * o.vel;
      }
    }
    const double lag = o.jerk > 0 ? std::min(o.acc / o.jerk, kLongestLag) : 0.0;
    for (std::size_t j = 0; j < joints(); ++j) {
      const double slope = std::abs(up[j] - down[j]) / (2 * kStep) + turn[j] * lag;
      s.vel[j] += slope * o.vel;
      s.acc[j] += slope * o.acc;
      s.jerk[j] += slope * o.jerk;
      s.turns[j] += turn[j] * o.vel;
      s.turns_acc[j] += turn[j] * o.acc;
    }
    return true;
  }
  [[nodiscard]] std::size_t joints() const noexcept {
    return static_cast<std::size_t>(m_.kinematics.joints());
  }

 private:
  bool joints_at(std::size_t axis, double by, std::size_t other, double by_other,
                 JointVector& q) const noexcept {
    Pose p = at_;
    p[axis] += by * kStep;
    p[other] += by_other * kStep;
    q = m_.near;
    return m_.kinematics.inverse(p, q);
  }

  const Pose& at_;
  const OffsetPace::Machine& m_;
};

/// The factor that brings `use` down to `bound`.
void most(double& factor, double bound, double use) noexcept {
  if (use > 0 && factor * use > bound) factor = std::max(bound, 0.0) / use;
}

}  // namespace

OffsetPace OffsetPace::at(const Pose& at, const std::array<Limits, rtapi::kAxes>& offsets,
                          const Machine& machine) noexcept {
  OffsetPace pace;
  const Look look(at, machine);
  Sums s;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (offsets[i].vel > 0 && !look.add(i, offsets[i], s)) return {kCreep, kCreep, kCreep};
  const auto of = [&](std::size_t j, double limit) {
    // Its axis has given the offset its share already.
    if (machine.kinematics.axis_of_joint(static_cast<std::int32_t>(j)) >= 0) return 1e99;
    return kAll * machine.share * (limit > 0 ? limit : 1e99);
  };
  for (std::size_t j = 0; j < look.joints(); ++j) {
    const JointConfig& c = machine.joint[j];
    most(pace.vel, of(j, c.max_vel), s.vel[j]);
    most(pace.vel, kMostOfTurns * of(j, c.max_acc), 2 * s.turns[j]);
    most(pace.vel, kMostOfTurnsInJerk * of(j, c.max_jerk), 3 * s.speeds[j]);
  }
  for (std::size_t j = 0; j < look.joints(); ++j) {
    const JointConfig& c = machine.joint[j];
    most(pace.acc, of(j, c.max_acc) - 2 * s.turns[j] * pace.vel, s.acc[j]);
    most(pace.acc, kMostOfTurnsInJerk * of(j, c.max_jerk), 3 * s.turns_acc[j]);
  }
  for (std::size_t j = 0; j < look.joints(); ++j)
    most(
        pace.jerk,
        of(j, machine.joint[j].max_jerk) - 3 * (s.speeds[j] * pace.vel + s.turns_acc[j] * pace.acc),
        s.jerk[j]);
  return pace;
}

}  // namespace kerf::motion
