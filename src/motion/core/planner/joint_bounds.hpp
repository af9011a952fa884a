// Joint bounds: how joints move along the path where kinematics mix axes. Pure arithmetic.
//
// Along a path q(sigma) a joint is a function j(sigma) with  j' = J q'  and  j'' = J q'' + q'^T H q' , which come from differences of inverse
// kinematics around a place. With x = (dsigma/dt)^2 and u = x'/2 its velocity is j' sqrt(x) and its acceleration j' u + j'' x, as of any
// axis (path/limits.hpp); jerk has the third derivative besides.
//
// On a stretch j' is taken as the polynomial of fifth degree through what was found at the ends and in the middle (path/joint_curve.hpp), and a
// stretch is short enough when that foretells j' and j'' a quarter of it from both ends, where such a polynomial is off the most. So a pole
// passed closely between two places shows too. What is left to chance is covered by a small reserve, and seen by the guard.
#pragma once

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/core/path/joint_curve.hpp"
#include "motion/core/path/limits.hpp"

namespace kerf::motion {

class JointBounds {
 public:
  explicit JointBounds(const Kinematics& kinematics) noexcept : kinematics_(kinematics) {}
  void configure(const MachineConfig& config, const path::AxisLimits& axes) noexcept;
  /// The path begins where the joints stand.
  void begin(const JointVector& here) noexcept { near_ = here; }

  /// Whether there are no more joints that are not an axis each than a JointCurve has room for.
  [[nodiscard]] bool few_enough() const noexcept { return mixed_count_ <= path::kMostJoints; }
  /// How the joints move along a stretch that begins at `from`. `to`: the farthest end; nearer where the joints' motion changes too much on
  /// the way. False: nothing foretells that, and creep() is all that can be done there.
  [[nodiscard]] bool curve_of(const path::Piece& piece, double from, double& to,
                              path::JointCurve& out) noexcept;
  struct Creep {
    path::Box box;
    double cap{0};  ///< of x
  };
  [[nodiscard]] const Creep& creep() const noexcept { return creep_; }

  /// A stretch of a path, as curve_of() has it.
  struct Told {
    std::size_t piece{0};
    double from{0}, to{0};
    bool foretold{false};
    path::JointCurve curve;
    Creep creep;
  };
  /// How far tell() has come.
  struct Cursor {
    std::size_t piece{0};
    double from{0};
    int tries{0};
  };
  /// Appends the stretches of a path that follow, at most kTogether, for kinematics that answer later (Kinematics::complete). False: answers are
  /// awaited, nothing was appended, and the same is to be asked again.
  static constexpr std::size_t kTogether = 32;
  [[nodiscard]] bool tell(const path::Buffer<path::Piece>& pieces, Cursor& at,
                          path::Buffer<Told>& out) noexcept;
  /// Whether differences tell anything of these kinematics around a place. Answers that come from a search are as rough as its last step, and next to
  /// a pole they change too much.
  [[nodiscard]] bool smooth_at(const path::Vec& at) noexcept;

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
  static constexpr std::size_t kPlaces = 5;  ///< of a curve, evenly

  void look(const path::Piece& piece, double s, Place& out) noexcept;
  [[nodiscard]] bool foretold(const path::Piece& piece, const Place (&at)[kPlaces],
                              path::JointCurve& out) const noexcept;
  void set_creep(const Place (&at)[kPlaces], bool solved) noexcept;

  const Kinematics& kinematics_;
  std::size_t joints_{0};
  std::uint32_t moved_{0};                            ///< axes
  std::size_t mixed_[kMaxJoints]{}, mixed_count_{0};  ///< joints that are not an axis each
  path::JointCurve::Row mixed_limit_[kMaxJoints]{};   ///< of them
  Creep creep_;
  double low_[kMaxJoints]{}, high_[kMaxJoints]{};
  path::AxisLimits axes_;
  JointVector near_{};  ///< which of several solutions: the one next to the last
};

}  // namespace kerf::motion
