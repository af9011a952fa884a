// Joint: the running state of one joint.
#pragma once

#include "motion/api/config.hpp"
#include "motion/core/axis_mover.hpp"

namespace kerf::motion {

/// Motor coordinates are joint coordinates plus `motor_offset`, which homing sets, plus what makes good the play of the
/// drive.
struct Joint {
  AxisMover mover;  ///< free mode
  /// [JOINT_n]BACKLASH: half of it towards the side that the joint moves to, reached within limits of its own.
  AxisMover backlash;
  double pos_cmd{0}, pos_fb{0};
  double motor_pos_fb{0}, motor_offset{0};
  double last_pos{0}, last_vel{0};  ///< what the guard saw in the last cycle
  double vel_cmd{0}, acc_cmd{0}, jerk_cmd{0};
  double ferror{0}, ferror_limit{0}, ferror_high{0};
  bool home_switch{false}, neg_limit{false}, pos_limit{false}, amp_fault{false};
  bool homed{false}, homing{false}, faulted{false}, ferrored{false}, error{false};
  bool ignore_limits{false};  ///< while homing on a limit switch
  std::int32_t home_state{0};

  /// The present place gets the coordinate `position` + delta, without any motion.
  void shift(double delta) noexcept {
    pos_cmd += delta;
    pos_fb += delta;
    last_pos += delta;
    motor_offset -= delta;
    mover.shift(delta);
  }
};

}  // namespace kerf::motion
