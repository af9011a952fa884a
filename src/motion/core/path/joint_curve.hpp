// JointCurve: how joints move along a stretch of path where kinematics mix axes. Pure arithmetic.
//
// Along q(sigma) a joint is a function of sigma too. Its rate j' is kept as a polynomial of fifth degree over the stretch, so its curl j'' and
// twist j''' are known everywhere on it, and bounds of them by Bernstein coefficients. Who makes it vouches for its error (planner/joint_bounds.hpp).
#pragma once

#include <cstddef>

#include "motion/core/path/boxes.hpp"

namespace kerf::motion::path {

struct JointCurve {
  static constexpr std::size_t kMost = JointBends::kMost;
  struct Row {
    double k[6]{};                   ///< j' = k0 + k1 t + ... with t from 0 to 1 along the stretch
    double vel{0}, acc{0}, jerk{0};  ///< limits
  };
  double from{0}, length{0};  ///< of sigma along its piece
  std::size_t count{0};
  Row row[kMost];
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
/// Largest x by the joints' velocities on [s0, s1].
[[nodiscard]] double velocity_cap(const JointCurve& curve, double s0, double s1) noexcept;
/// The widest part of it whose j'' is a line, but for `share` of the accelerations at x.
[[nodiscard]] double even_step(const JointCurve& curve, double x, double share) noexcept;

}  // namespace kerf::motion::path
