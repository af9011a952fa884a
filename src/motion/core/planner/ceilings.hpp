// Ceilings: the speed and the acceleration along a curve that keep every joint and axis within its limits.
#pragma once

#include <algorithm>
#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/api/status.hpp"
#include "motion/core/geometry.hpp"
#include "motion/core/path/limits.hpp"

namespace kerf::motion {

/// The axes that this machine has: of the kinematics, as far as the INI names them.
[[nodiscard]] constexpr std::uint32_t axes_of(std::uint32_t kinematics_mask,
                                              const MachineConfig& config) noexcept {
  return config.axis_mask != 0 ? kinematics_mask & config.axis_mask : kinematics_mask;
}
/// The joints that count: of the kinematics, as far as the machine has them.
[[nodiscard]] constexpr std::int32_t joints_of(std::int32_t kinematics_joints,
                                               const MachineConfig& config) noexcept {
  return config.joints > 0 && config.joints < kinematics_joints ? config.joints : kinematics_joints;
}

/// What a joint that several of these axes move has of its limits beside their external offsets, which get the largest of their shares.
[[nodiscard]] constexpr double share_beside_offsets(const MachineConfig& config,
                                                    std::uint32_t axes) noexcept {
  double share = 1;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if ((axes >> i & 1U) != 0) share = std::min(share, 1 - config.axis[i].offset_av_ratio);
  return share;
}

/// Where other jerks are limited, an axis or a joint without a limit reaches its acceleration within a part of a cycle, not at once (s): ramps without
/// length would end beside those of the others.
inline constexpr double kSoonestAcc = 1e-4;

/// What limits smooth paths of a machine whose joints each move one axis.
struct PathLimits {
  path::AxisLimits
      axes;  ///< of each axis and of the joints that it moves; kNoLimit for axes that are not there
  path::Vec low, high;  ///< soft limits, alike
  bool plain{true};  ///< false: kinematics mix axes, so each move is judged by itself (ceilings_of)
};
[[nodiscard]] PathLimits path_limits_of(const Kinematics& kinematics,
                                        const MachineConfig& config) noexcept;

struct Ceilings {
  double speed{0};  ///< along the curve
  double acc{0};    ///< along the curve, at any speed up to `speed`
  double jerk{0};  ///< the same, at any acceleration up to `acc`; 0: no joint and no axis limits it
};

/// `wanted_speed`: the highest speed anybody may ask for (feed at the largest override). On a curve the acceleration
/// limit of each joint is shared between curvature and speeding up: q' a + q'' v^2. When the whole of `wanted_speed` leaves
/// at least 0.6 of the straight-line acceleration, that is what remains for a; else a takes 0.6 (of which on a circle 0.8
/// remains for the curvature). `joint`: the joints where it begins. False: kinematics without a solution on the curve.
[[nodiscard]] bool ceilings_of(const Curve& curve, const Kinematics& kinematics,
                               const MachineConfig& config, const JointVector& joint,
                               double wanted_speed, Ceilings& out) noexcept;

/// True when the whole curve stays within axis and joint limits. Else the fault, with index, value and limit.
/// A curve may begin outside as long as it only leads inside. `shift`: of the machine from the curve, where each joint moves an axis alone.
/// `joint`: the joints where it begins, then where it ends; of several solutions the one that is met from there counts.
[[nodiscard]] bool within_soft_limits(const Curve& curve, const Kinematics& kinematics,
                                      const MachineConfig& config, const double* skew,
                                      const Pose& shift, JointVector& joint,
                                      FaultRecord& out) noexcept;

}  // namespace kerf::motion
