// Intent: what the operator and task want now. Never queued, last writer wins, read at the start of every servo cycle.
#pragma once

#include <cstdint>

#include "motion/api/limits.hpp"
#include "rtapi/base/pose.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/seq_cell.hpp"

namespace kerf::motion {

/// Free: each joint alone (jog, home). Teleop: jog along axes. Coordinated: the path.
/// Values of stat.motion_mode (TRAJ_MODE_*).
enum class MotionMode : std::int32_t { free = 1, coordinated = 2, teleop = 3 };

/// One jog. A new `seq` starts it; kind none stops with the joint's acceleration. Distances and speeds in mm or degrees.
struct JogIntent {
  enum class Kind : std::int32_t { none = 0, continuous = 1, incremental = 2, absolute = 3 };
  std::uint32_t seq{0};
  Kind kind{Kind::none};
  double vel{0};     ///< signed for continuous; magnitude otherwise
  double target{0};  ///< incremental: signed distance; absolute: position
};

/// Values that belong together; see IntentCell.
struct Intent {
  MotionMode mode{MotionMode::free};
  double feed_override{1};
  double rapid_override{1};
  double spindle_override[kMaxSpindles]{1, 1, 1, 1, 1, 1, 1, 1};
  double max_vel_mm_s{1e99};         ///< client's maxvel
  JogIntent joint_jog[kMaxJoints];   ///< used in free mode
  JogIntent axis_jog[rtapi::kAxes];  ///< used in teleop mode
  std::uint32_t home_seq{0};         ///< a new value starts homing of home_joint
  std::int32_t home_joint{-1};       ///< -1: all, by sequence
  std::uint32_t unhome_seq{0};
  std::int32_t unhome_joint{-1};  ///< -1: all; -2: volatile ones
  bool override_limits{false};    ///< jogging off a hard limit
  /// After each release of hold: the items of one block (SourceTag::id), then stand at its end.
  bool single_step{false};
  bool reserved[6]{};
  std::uint32_t spindle_stop_seq
      [kMaxSpindles]{};  ///< a new value stops that spindle at once, whatever the path says
  std::uint64_t digital_out_set_seq{
      0};  ///< immediate outputs from clients: a new value applies the masks once
  std::uint64_t digital_out_on{0}, digital_out_off{0};
};

/// The cell itself. The words stand alone so that a stop never depends on a whole write being finished.
struct IntentCell {
  rtapi::Word<std::uint32_t> abort_epoch{
      1};  ///< raise to stop now and to void everything queued with an older epoch
  rtapi::Word<std::uint32_t> enable{0};  ///< 1: drives on wanted
  rtapi::Word<std::uint32_t> hold{0};    ///< 1: stop on the path and stay (feed hold, pause)
  rtapi::Word<std::uint64_t> heartbeat{
      0};  ///< task adds 1 at least every third of heartbeat_timeout_s
  rtapi::SeqCell<Intent> values;
};

}  // namespace kerf::motion
