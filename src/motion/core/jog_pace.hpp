// JogPace: how fast jogs of axes run where joints mix axes. Pure arithmetic and questions to the kinematics, @rt.
//
// Each axis has a mover that knows the limits of the axis alone. Here their time runs slower than the clock, at a scale s, and
// their speeds get a factor, so that the joints keep their limits too. With a joint's derivatives j', j'', j''' along the jogs at their full speed, and w the part
// of that speed which is driven: velocity j' w, acceleration j'' w^2 and what the movers do, which goes with s^2, jerk j''' w^3, what the movers
// do with s^3, and products of both. Each of these gets a share of the limit; what bends least leaves most to the movers. The derivatives come from differences
// of the inverse kinematics, here and at places ahead up to twice the way to stop. w follows them in every cycle; s is chosen while all stand, for what lies
// on the whole way if it is not much worse than here. Before a place where joints cannot follow at all (the end of the workspace, a pole) a jog ends. Where s would be too much further on, and where another axis joins that leaves less of it, all stand for a moment.
#pragma once

#include <array>
#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/core/axis_mover.hpp"

namespace kerf::motion {

class JogPace {
 public:
  /// What stays the same during a cycle. `joint`: as many limits as the kinematics have joints.
  struct Machine {
    const Kinematics& kinematics;
    const JointConfig* joint;
    double share;      ///< of the limits of joints that mix axes; external offsets have the rest
    JointVector near;  ///< where the joints are, for kinematics with several answers
    Pose offset;       ///< of the joints' place from the axes' (external offsets)
  };
  using Movers = std::array<AxisMover, rtapi::kAxes>;

  /// One cycle of `dt` seconds of all movers, which stand at `pose`. Not `faster`: none gets faster, and none joins.
  void step(Movers& axis, const Pose& pose, const Machine& machine, double dt,
            bool faster = true) noexcept;
  /// All movers stand: what was for the last jog counts no more.
  void rest() noexcept { wanted_ = admitted_ = 0, halts_ = false, needed_ = 1; }
  /// Seconds of the movers in one of the clock.
  [[nodiscard]] double scale() const noexcept { return scale_; }

 private:
  /// What places allow: s and w.
  struct Sight {
    double scale{1}, pace{1};
    bool wall{false};  ///< joints cannot follow there: no position, or next to a pole
  };
  static constexpr std::size_t kSights = 4;

  void take(Movers& axis) noexcept;
  [[nodiscard]] Sight look(const Movers& axis, const Pose& at,
                           const Machine& machine) const noexcept;
  [[nodiscard]] bool goes_deeper(const AxisMover& mover, std::size_t i, const Pose& at,
                                 const Machine& machine) const noexcept;
  [[nodiscard]] Pose ahead(const Movers& axis, const Pose& pose, std::size_t sight) const noexcept;
  [[nodiscard]] double scale_for_the_way(const Movers& axis, const Pose& pose,
                                         const Machine& machine, double here) const noexcept;
  [[nodiscard]] bool admit(const Movers& axis, const Sight& least) const noexcept;

  Sight sight_[kSights];
  double scale_{1};
  double needed_{1};                           ///< s for what lay ahead when all had to stand
  std::size_t next_{0};                        ///< sight that is looked at in the next cycle
  std::uint32_t wanted_{0};                    ///< axes that are to move, a bit each
  std::uint32_t admitted_{0};                  ///< of these, those that may
  std::array<double, rtapi::kAxes> speeds_{};  ///< that are asked for; others are another jog
  bool anew_{false}, halts_{false};
};

}  // namespace kerf::motion
