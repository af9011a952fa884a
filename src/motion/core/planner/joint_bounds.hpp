// Joint bounds: how fast a stretch of path may be driven where kinematics mix axes. Pure arithmetic.
//
// Along a path q(sigma) a joint is a function j(sigma) with  j' = J q'  and  j'' = J q'' + q'^T H q' , which come from differences of inverse
// kinematics around the place. With x = (dsigma/dt)^2 and u = x'/2 its velocity is j' sqrt(x) and its acceleration j' u + j'' x, as of any
// axis (path/limits.hpp). A stretch gets a box x <= cap, |u| <= acc which keeps the limits of all joints and axes.
//
// j' and j'' are known at both ends and in the middle; between them they are taken as the quadratics through these. A stretch is short
// enough when that foretells what was found: j' changes by what j'' says, j by what j' says, and the quadratics bend little. So a pole
// passed closely between two places shows too. What is left to chance is covered by a reserve of 3 % in acceleration, and seen by the guard.
//
// With jerk limits j' is taken as the polynomial of fifth degree through what was found at the ends and in the middle (path/joint_curve.hpp), and a
// stretch is short enough when that foretells j' and j'' a quarter of it from both ends, where such a polynomial is off the most.
#pragma once

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/core/path/joint_curve.hpp"
#include "motion/core/path/limits.hpp"

namespace kerf::motion {

class JointBounds {
 public:
  struct Box {
    double cap{0};  ///< of x
    double acc{0};  ///< of |u|
  };

  explicit JointBounds(const Kinematics& kinematics) noexcept : kinematics_(kinematics) {}
  void configure(const MachineConfig& config, const path::AxisLimits& axes) noexcept;
  /// The path begins where the joints stand.
  void begin(const JointVector& here) noexcept { near_ = here; }

  /// The box of a stretch that begins at `from`. `to`: the farthest end; nearer where the joints' motion changes too much on
  /// the way. `x_wanted`: the largest x that anybody may ask for.
  [[nodiscard]] Box box_of(const path::Piece& piece, double from, double& to,
                           double x_wanted) noexcept;
  /// Whether there are no more joints that are not an axis each than a JointCurve has room for.
  [[nodiscard]] bool few_enough() const noexcept { return mixed_count_ <= path::JointCurve::kMost; }
  /// How the joints move along a stretch; `to` as in box_of. False: nothing foretells that, and creep() is all that can be done there.
  [[nodiscard]] bool curve_of(const path::Piece& piece, double from, double& to,
                              path::JointCurve& out) noexcept;
  struct Creep {
    path::Box box;
    double cap{0};  ///< of x
  };
  [[nodiscard]] const Creep& creep() const noexcept { return creep_; }
  /// Of each of the pieces that follow where the path has come to.
  void bends_of(const path::Buffer<path::Piece>& pieces, path::JointBends* out) noexcept;

  /// Whether there are joint positions all along the piece, within the joints' soft limits. `skew`: of each joint, as within_soft_limits.
  [[nodiscard]] bool reaches(const path::Piece& piece, const double* skew) const noexcept;

 private:
  /// At one place of the path.
  struct Place {
    double s{0};
    JointVector joint, rate, curl;  ///< j, j', j''
    path::Vec first, second;        ///< q', q''
    bool solved{false};
  };
  struct Limit {
    double vel, acc;
  };
  static constexpr std::size_t kPlaces = 5;  ///< of a curve, evenly

  /// Differences are taken over `step` of the axis that moves most.
  void look(const path::Piece& piece, double s, double step, Place& out) noexcept;
  [[nodiscard]] bool foretold(const Place& a, const Place& b, const Box& box) const noexcept;
  [[nodiscard]] Box fit(const path::Piece& piece, const Place& a, const Place& m, const Place& b,
                        double x_wanted) const noexcept;
  /// Whether the quadratics bend little; and, for a box that fits, whether rates change little.
  [[nodiscard]] bool even(const Place& a, const Place& m, const Place& b, const Box& box,
                          bool for_speed) const noexcept;
  [[nodiscard]] bool foretold(const path::Piece& piece, const Place (&at)[kPlaces],
                              path::JointCurve& out) const noexcept;
  void set_creep(const Place (&at)[kPlaces], bool solved) noexcept;
  template <class F>
  static void for_each_row(const Place& a, const Place& m, const Place& b, std::size_t joints,
                           const Limit* limit, const path::AxisLimits& axes, F&& f) noexcept;

  const Kinematics& kinematics_;
  std::size_t joints_{0};
  Limit limit_[kMaxJoints]{};
  std::size_t mixed_[kMaxJoints]{}, mixed_count_{0};  ///< joints that are not an axis each
  path::JointCurve::Row mixed_limit_[kMaxJoints]{};   ///< of them
  Creep creep_;
  double low_[kMaxJoints]{}, high_[kMaxJoints]{};
  path::AxisLimits axes_;
  JointVector near_{};  ///< which of several solutions: the one next to the last
};

}  // namespace kerf::motion
