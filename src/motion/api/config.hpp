// What task tells motion about the machine, from the INI file. Written whole, by one writer, at start and on change.
#pragma once

#include <cstdint>

#include "motion/api/limits.hpp"
#include "rtapi/base/pose.hpp"

namespace kerf::motion {

/// [JOINT_n]; lengths in mm (or degrees for a rotary joint), times in s.
struct JointConfig {
  double min_limit{-1e99}, max_limit{1e99};
  double max_vel{1}, max_acc{1}, max_jerk{0};  ///< jerk 0: not limited
  double ferror{1e99}, min_ferror{1e99};
  double backlash{0};
  double home{0}, home_offset{0};
  double home_search_vel{0}, home_latch_vel{0},
      home_final_vel{0};                           ///< signed; search 0 = no switch
  double home_search_dist{0}, home_latch_dist{0};  ///< bounds of the homing moves, 0 = none
  double start{0};                ///< with has_start: the joint's position when motion begins
  std::int32_t home_sequence{0};  ///< [JOINT_n]HOME_SEQUENCE; kNoHomeSequence when absent
  std::int32_t home_flags{0};     ///< bits of HomeFlag
  bool rotary{false};
  bool volatile_home{false};
  bool has_start{false};  ///< [TRAJ]POSITION_FILE knows it
  bool reserved[5]{};
};
inline constexpr std::int32_t kNoHomeSequence = 1000;

/// Values as published for homing modules.
enum HomeFlag : std::int32_t {
  home_ignore_limits = 1,
  home_use_index = 2,
  home_is_shared = 4,
  home_unlock_first = 8,
  home_absolute_encoder = 16,
  home_no_rehome = 32,
  home_no_final_move = 64,
  home_index_no_encoder_reset = 128,
};

/// [AXIS_L]
struct AxisConfig {
  double min_limit{-1e99}, max_limit{1e99};
  double max_vel{1}, max_acc{1}, max_jerk{0};
  double offset_av_ratio{0};
  std::int32_t locking_joint{-1};  ///< [AXIS_L]LOCKING_INDEXER_JOINT; -1: it does not lock
  std::int32_t reserved{0};
};
/// An axis with a locking joint stands unless it goes farther than this (degrees): sums of offsets are not exact.
inline constexpr double kLockedSlack = 1e-6;

/// The smaller of two jerk limits, of which 0 is none.
[[nodiscard]] constexpr double least_jerk(double a, double b) noexcept {
  return a > 0 && (a < b || !(b > 0)) ? a : b;
}

/// [SPINDLE_n], rpm
struct SpindleConfig {
  double max_forward_rpm{1e99}, min_forward_rpm{0}, max_reverse_rpm{1e99}, min_reverse_rpm{0};
  double home_search_rpm{0};
  double increment_rpm{100};
};

/// [SAFE_STATE]PIN: what motion's own outputs are set to whenever the machine goes off, and until it is first on.
struct SafeOutputs {
  std::uint64_t digital_mask{0},
      digital{0};  ///< motion.digital-out-NN: which of them, and their level
  std::uint64_t analog_mask{0};
  double analog[kMaxAnalog]{};
};

/// [KERF]OVERRUN: what a servo cycle that comes too late does. The realtime host always logs it.
enum class OverrunPolicy : std::int32_t { warn = 0, hold = 1, estop = 2 };

struct MachineConfig {
  std::int32_t joints{0};
  std::int32_t spindles{1};
  std::uint32_t axis_mask{0};
  std::int32_t reserved{0};
  double traj_max_vel_mm_s{1};  ///< [TRAJ]MAX_LINEAR_VELOCITY
  double traj_max_ang_vel_deg_s{360};
  double traj_max_acc_mm_s2{1e9};
  double traj_max_jerk_mm_s3{0};   ///< [TRAJ]MAX_LINEAR_JERK; 0: not limited
  double rotary_tolerance_deg{0};  ///< [TRAJ]ROTARY_TOLERANCE; 0: as many degrees as G64 P has mm
  double linear_units_per_mm{
      1};  ///< machine units in 1 mm: pins and parameter files are in machine units
  double max_feed_override{1};      ///< [DISPLAY]MAX_FEED_OVERRIDE, bounds adaptive feed too
  double heartbeat_timeout_s{0.1};  ///< lost task heartbeat: controlled stop, then disable
  bool no_force_homing{false};
  bool probe_error_inhibit_jog{false}, probe_error_inhibit_home{false};
  bool adaptive_only_slows{false};    ///< adaptive feed is bounded by 1, as older manuals say
  bool adaptive_reverses{true};       ///< below 0 it runs the path backwards
  bool lost_heartbeat_is_off{false};  ///< drives off at once, without the controlled stop before
  bool path_check{false};             ///< [KERF]PATH_CHECK: Fault::limit_path is looked for
  bool time_laws{true};  ///< [KERF]TIME_LAWS: the planner makes laws for jerk-limited paths
  OverrunPolicy overrun{OverrunPolicy::warn};
  std::int32_t reserved3{0};
  double overrun_periods{3};  ///< so long after the cycle before, `overrun` acts
  /// [KERF]STALE_FEEDBACK_CYCLES, STALE_FEEDBACK_WINDOW: so many of the last so many may be without feedback of a joint.
  std::int32_t stale_cycles{5}, stale_window{1000};
  SafeOutputs safe;
  JointConfig joint[kMaxJoints];
  AxisConfig axis[rtapi::kAxes];
  SpindleConfig spindle[kMaxSpindles];
};

}  // namespace kerf::motion
