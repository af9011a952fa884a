// OffsetPace: how fast external offsets may move where joints mix axes. Pure arithmetic and questions to the kinematics, @rt.
//
// Offsets have a share of the limits of their axes ([AXIS_L]OFFSET_AV_RATIO), and of those of joints that several axes move, path and jogs the
// rest. A joint's velocity from an offset o is J o', its acceleration J o'' + 2 J' o', its jerk J o''' + 3 J' o'' + 3 J'' o', where J' comes of what
// the path does meanwhile: nobody knows what, so it is taken at the axes' full speed. Velocity, acceleration and jerk of all offsets
// get a factor each, so that these sums stay within the share; turns of a table leave least of them, a CoreXY has no J' at all.
// How much faster the path moves the joints where an offset has taken it (a table that turns, by the offset times the turn) is not looked at.
#pragma once

#include <array>

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/core/geometry.hpp"

namespace kerf::motion {

struct OffsetPace {
  /// What an offset does where joints do not mind; all 0: there is none on this axis, or none moves.
  struct Limits {
    double vel{0}, acc{0}, jerk{0};
  };
  struct Machine {
    const Kinematics& kinematics;
    const JointConfig* joint;  ///< as many as the kinematics have joints
    const AxisConfig* path;    ///< limits of path and jogs, of each axis
    double share;              ///< of the limits of joints that mix axes
    JointVector near;          ///< where the joints are, for kinematics with several answers
  };

  double vel{1}, acc{1}, jerk{1};

  /// At the place `at` of the machine, offsets included.
  [[nodiscard]] static OffsetPace at(const Pose& at,
                                     const std::array<Limits, rtapi::kAxes>& offsets,
                                     const Machine& machine) noexcept;
};

}  // namespace kerf::motion
