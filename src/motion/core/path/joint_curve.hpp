// JointCurve: how joints move along a stretch of path where kinematics mix axes. Pure arithmetic.
//
// Along q(sigma) a joint is a function of sigma too. Its rate j' is kept as a polynomial of fifth degree over the stretch, so its curl j'' and
// twist j''' are known everywhere on it, and bounds of them by Bernstein coefficients. Who makes it vouches for its error (planner/joint_bounds.hpp).
#pragma once

#include <cstddef>

#include "motion/core/path/boxes.hpp"

namespace kerf::motion::path {

struct JointCurve {
  struct Row {
    double k[6]{};                   ///< j' = k0 + k1 t + ... with t from 0 to 1 along the stretch
    double vel{0}, acc{0}, jerk{0};  ///< limits
  };
  double from{0}, length{0};  ///< of sigma along its piece
  std::size_t count{0};
  Row row[kMostJoints];
};

/// A row from one place to another: Bernstein coefficients of quadratics (p, c) and of a line (e) through what is there, and how far they are off at most.
struct JointPart {
  double p0{0}, p1{0}, p2{0};  ///< of j'
  double e0{0}, e1{0};         ///< of j''
  double c0{0}, c1{0}, c2{0};  ///< of j'''
  double p_off{0}, e_off{0}, c_off{0};
};
[[nodiscard]] JointPart part_of(const JointCurve& curve, std::size_t row, double s0,
                                double s1) noexcept;

/// Rate, curl and twist of a row at a place.
struct JointPlace {
  double rate{0}, curl{0}, twist{0};
};
[[nodiscard]] JointPlace place_on(const JointCurve& curve, std::size_t row, double s) noexcept;

/// The largest rates, curls and twists on [s0, s1].
[[nodiscard]] JointBends bends_of(const JointCurve& curve, double s0, double s1) noexcept;
/// Largest x by the joints' velocities on [s0, s1], at most `cap`.
[[nodiscard]] double velocity_cap(const JointCurve& curve, double s0, double s1,
                                  double cap) noexcept;
/// Largest x at which the joints can be held on their curves, at most `cap`, by some places of it.
[[nodiscard]] double even_x(const JointCurve& curve, double cap) noexcept;
/// What the curl of a joint may be off a line within a step, as a share of its acceleration.
inline constexpr double kJointBend = 3e-4;
/// The widest part of it on which that is so, up to x.
[[nodiscard]] double even_step(const JointCurve& curve, double x) noexcept;
/// The acceleration rows of [s0, s1] for x linear in sigma, behind those of the axes (limits.hpp), for a share of the limits. `turned`: driven
/// from s1 to s0.
void joint_rows(const JointCurve& curve, double s0, double s1, bool turned, double share,
                Rows& out) noexcept;
/// Of the limits, for rows of whole stretches: those of a part of one take j'' as another line.
inline constexpr double kWholeShare = 1 - 3 * kJointBend;

}  // namespace kerf::motion::path
