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
  /// With a COMP_FILE, and homed, what its table says in place of it.
  AxisMover backlash;
  std::int8_t direction{0};  ///< of the last motion
  double pos_cmd{0}, pos_fb{0};
  double motor_pos_fb{0}, motor_offset{0};
  double lag{0};  ///< of the motor behind its command, when it was last seen
  bool fb_known{false}, fb_stale{false},
      fb_was_stale{false};          ///< seen ever; not in this cycle; nor in the last
  std::uint32_t fb_lost{0};         ///< cycles without feedback so far
  double last_pos{0}, last_vel{0};  ///< what the guard saw in the last cycle
  double vel_cmd{0}, acc_cmd{0}, jerk_cmd{0};
  double ferror{0}, ferror_limit{0}, ferror_high{0};
  bool home_switch{false}, neg_limit{false}, pos_limit{false}, amp_fault{false};
  bool homed{false}, homing{false}, faulted{false}, ferrored{false}, error{false};
  bool ignore_limits{false};   ///< while homing on a limit switch
  bool index_enable{false};    ///< joint.N.index-enable as read; false while armed: the index came
  bool index_armed{false};     ///< homing waits for the index
  std::int8_t index_order{0};  ///< in this cycle: 1 makes index-enable true, -1 false
  bool unlock{false}, is_unlocked{false};  ///< of a locking indexer
  std::int32_t home_state{0};

  /// The present place gets the coordinate `position` + delta, without any motion.
  void shift(double delta) noexcept {
    rename(delta);
    pos_fb += delta;
    motor_offset -= delta;
  }
  /// The same for the command alone, whose motor coordinate then changes too.
  void rename(double delta) noexcept {
    pos_cmd += delta;
    last_pos += delta;
    mover.shift(delta);
  }
};

}  // namespace kerf::motion
