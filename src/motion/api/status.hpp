// What motion says of itself: one cell per servo cycle, and a numbered fault log.
#pragma once

#include <cstdint>

#include "motion/api/intent.hpp"
#include "motion/api/limits.hpp"
#include "motion/api/path_items.hpp"

namespace kerf::motion {

/// Numbered, latched, documented (docs/troubleshooting/<name>.md). Numbers are stable. The text is made by the reader, in
/// faults.hpp: realtime code keeps numbers only.
enum class Fault : std::int32_t {
  none = 0,
  internal = 1,               ///< an assertion of ours; machine off
  joint_soft_limit_min = 10,  ///< value, limit
  joint_soft_limit_max = 11,
  axis_soft_limit_min = 12,
  axis_soft_limit_max = 13,
  joint_hard_limit_min = 14,
  joint_hard_limit_max = 15,
  following_error = 16,  ///< value, limit
  amp_fault = 17,
  enable_lost = 18,  ///< motion.enable went false
  heartbeat_lost = 19,
  not_homed = 20,
  home_failed = 21,  ///< value: homing state
  home_no_switch = 22,
  home_busy = 23,
  jog_while_not_ready = 24,
  jog_beyond_limit = 25,
  no_inverse = 26,          ///< kinematics: no joint position for an axis position
  bad_item = 27,            ///< a path item that cannot be (NaN, radius 0, index out of range)
  kinematics_refused = 28,  ///< value: the kind; limit: 1 none such, 2 no position, 3 for a mode
  indexer_refused = 29,     ///< index: axis, value: IndexerRefusal, limit: joint
  limit_velocity = 30,      ///< the oracle: commanded motion broke a limit (value, limit)
  limit_acceleration = 31,
  limit_jerk = 32,
  limit_continuity = 33,
  indexer_locked = 34,  ///< index: joint; is-unlocked went false while it turned
  limit_path =
      35,  ///< farther from the programmed path than G64 P (mm, P; index 3-5: degrees of that axis)
  probe_no_contact = 40,
  probe_already_tripped = 41,
  probe_unexpected = 42,
  orient_fault = 50,
  spindle_fault = 51,
  sync_too_fast = 52,   ///< pitch times spindle speed is more than the axes can do (mm/s, limit)
  sync_too_short = 53,  ///< run-in and run-out need more than the move (mm, its length)
  sync_no_index = 54,   ///< the spindle turns, but index-enable stays true (value: revolutions)
  sync_behind = 55,     ///< the axes fell behind the spindle (mm, limit); the move goes on
  path_starved_internal = 60,
  overrun =
      61,  ///< a servo cycle came too late (value: ms behind the one before, limit); [KERF]OVERRUN
  stale_feedback = 62,  ///< cycles without feedback (value, limit); limit -1: at a probe contact
};

/// FaultRecord::value of Fault::indexer_refused.
enum class IndexerRefusal : std::int32_t {
  not_alone = 1,  ///< it may only turn in a rapid move of its own
  no_pins = 2,    ///< motmod has no joint.N.unlock (unlock_joints_mask)
  locked = 3,     ///< a jog, and joint.N.is-unlocked is false
};

/// FaultRecord::index of faults of jogs: joints are 0 and up, axes are this and up.
inline constexpr std::int32_t kAxisJog = 100;

/// One entry of the fault log.
struct FaultRecord {
  std::uint64_t number{0};  ///< 1, 2, 3 ... ; readers keep their own cursor
  std::int64_t time_ns{0};
  Fault fault{Fault::none};
  std::int32_t index{-1};  ///< joint, axis or spindle, as the fault says
  double value{0}, limit{0};
  SourceTag tag;
};

struct JointStatus {
  double pos_cmd{0}, pos_fb{0}, vel_cmd{0}, acc_cmd{0}, jerk_cmd{0};
  double ferror{0}, ferror_limit{0}, ferror_high{0};
  double motor_offset{0};
  std::int32_t home_state{0};  ///< 0: not homing
  bool homed{false}, homing{false}, active{true}, enabled{false};
  bool in_position{true}, faulted{false}, error{false}, on_limit_override{false};
  bool min_hard_limit{false}, max_hard_limit{false}, min_soft_limit{false}, max_soft_limit{false};
  std::uint32_t fb_lost{0};  ///< cycles without feedback so far
  bool fb_extrapolated{
      false};  ///< pos_fb is where the joint should be by now, not where it was seen
  bool reserved[3]{};
};

struct SpindleStatus {
  double speed_rpm{0};  ///< commanded, signed by direction, before the override
  double revs{0}, speed_in_rps{0};
  std::int32_t direction{0};     ///< -1, 0, 1
  std::int32_t orient_state{0};  ///< 0 none, 1 in progress, 2 done, 3 fault
  std::int32_t orient_fault{0};
  bool on{false}, at_speed{true}, brake{true}, locked{false};
};

/// What the path waits for, beyond motion itself.
enum class PathWait : std::int32_t {
  none = 0,
  spindle_at_speed = 1,
  orient = 2,
  dwell = 3,
  hold = 4,
  feed_hold_pin = 5,
  feed_inhibit = 6,
  zero_override = 7,
  spindle_index = 8,      ///< spindle.N.index-enable
  spindle_turning = 9,    ///< a move that follows the spindle stands with it
  indexer_unlocked = 10,  ///< joint.N.is-unlocked to be true
  indexer_locked = 11,    ///< ... and to be false again
};

/// Written every servo cycle.
struct MotionStatus {
  std::uint64_t cycle{0};
  std::int64_t time_ns{0};
  std::int64_t servo_period_ns{0};
  std::uint32_t acked_epoch{
      0};  ///< the abort epoch that motion has carried out: at rest, nothing older queued anywhere
  MotionMode mode{MotionMode::free};
  /// Intent::serial of what was in force for the whole cycle before this one: what it asked for has begun, or was refused, or is
  /// over. The words beside it that were set before it was written have been seen too.
  std::uint32_t intent_taken{0};
  std::uint64_t executed_seq{0};  ///< all items up to this one are done
  std::uint64_t current_seq{0};   ///< the item in execution
  SourceTag current;              ///< of the item in execution, or of the last one
  MotionKind kind{MotionKind::none};
  PathWait waiting_for{PathWait::none};
  std::int32_t waiting_index{-1};  ///< spindle or joint, where that says more
  bool enabled{false}, in_position{true}, path_empty{true}, held{false};
  bool all_homed{false}, homing_active{false}, jogging{false}, soft_limit{false};
  bool probe_tripped{false}, probing{false}, input_timeout{false}, amp_ready{false};
  bool probe_input{false};  ///< motion.probe-input
  bool away{false};         ///< beside the path, which is held at `place`
  bool shifts_path{false};  ///< Intent::path_shift may be asked for: each joint moves an axis alone
  bool reverse{false};      ///< a negative adaptive feed runs the path backwards
  bool retraces{false};     ///< it does, or runs forwards over what it has been driven back over
  bool sync_in_step{false};  ///< G33, G33.1, G76: the path is where the spindle wants it
  /// Other kinematics than those in force come as soon as the machine stands: motion.switchkins-type asks for them, or pins of
  /// theirs have changed, or may yet change with a new tool_offset.
  bool kinematics_pending{false};
  Pose pos_cmd,
      pos_fb;  ///< machine coordinates, mm and degrees; the first without external offsets
  Pose external_offset;  ///< what axis.L.eoffset-* add to pos_cmd
  Pose place;            ///< where the path stands: pos_cmd, unless `away`
  Pose path_shift;       ///< Intent::path_shift in force; all positions here have it in them
  Pose tool_offset;
  Pose probed;  ///< where the probe tripped
  Pose distance_to_go_axes;
  double vel_mm_s{0};  ///< actual speed along the path
  double requested_vel_mm_s{0};
  double distance_to_go{0};
  double feed_override{1}, rapid_override{1};
  double dwell_left_s{0};
  double sync_lag_mm{0};           ///< of the path behind the spindle, in G33, G33.1, G76
  double sync_run_in_mm{0};        ///< what the last such move needed to come into step
  std::uint64_t planned_items{0};  ///< items taken by the planner and not yet executed
  std::uint64_t digital_in{0}, digital_out{0};
  std::uint64_t faults{0};  ///< number of the newest FaultRecord; 0: none ever
  double analog_in[kMaxAnalog]{}, analog_out[kMaxAnalog]{};
  std::int32_t digital_count{4}, analog_count{4};
  std::uint64_t misc_error{0};  ///< motion.misc-error-NN, a bit each
  std::int32_t misc_error_count{0};
  std::int32_t kinematics_type{1};  ///< KinematicsType
  std::int32_t joints{0}, spindles{1};
  std::int32_t extra_joints{0};     ///< of `joints`, the last ones: no kinematics move them
  std::int32_t kinematics_kind{0};  ///< which of switchable kinematics is in force
  OverrideEnable enables;           ///< which overrides count now
  double axis_vel[rtapi::kAxes]{};  ///< of axis jogs; mm/s, degrees/s
  JointStatus joint[kMaxJoints];
  SpindleStatus spindle[kMaxSpindles];
};

}  // namespace kerf::motion
