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

/// A wish that is carried out once: a new `seq` applies the value, and what came later from elsewhere stays.
template <class T>
struct Once {
  std::uint32_t seq{0};
  T value{};
  void wish(T v) noexcept { ++seq, value = v; }
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
  /// Held: axis jogs move the machine beside the path. Ends where it was left, and only there.
  bool away{false};
  /// The path is run backwards, as a negative adaptive feed does; with both it goes forwards.
  bool backwards{false};
  bool reserved[4]{};
  std::uint32_t spindle_stop_seq
      [kMaxSpindles]{};     ///< a new value stops that spindle at once, whatever the path says
  std::uint32_t wishes{0};  ///< grows with each of the wishes below
  std::uint32_t serial{0};  ///< grows with each write; see MotionStatus::intent_taken
  Once<bool> digital_out[kMaxDigital];  ///< immediate outputs from clients
  Once<double> analog_out[kMaxAnalog];
  /// What the operator allows or forbids as programs do with M48 to M53.
  Once<bool> feed_override_enable, adaptive_feed_enable, feed_hold_enable;
  Once<bool> spindle_override_enable[kMaxSpindles];
  /// true engages the brake and stops the spindle; false releases it until the next order.
  Once<bool> brake[kMaxSpindles];
  /// The spindle turns again as the program had it: -1 or 1, at the speed it said last.
  Once<std::int32_t> spindle_restart[kMaxSpindles];
  /// While away: from then on the path is driven this far beside its own coordinates, since the tool has another length. 0 counts
  /// also when no path is left. An abort ends it.
  rtapi::Pose path_shift;
};

/// The cell itself. The words stand alone so that a stop never depends on a whole write being finished.
struct IntentCell {
  rtapi::Word<std::uint32_t> abort_epoch{
      1};  ///< raise to stop now and to void everything queued with an older epoch
  rtapi::Word<std::uint32_t> enable{
      0};  ///< not 0: drives on wanted; another number is another request
  rtapi::Word<std::uint32_t> hold{0};  ///< 1: stop on the path and stay (feed hold, pause)
  rtapi::Word<std::uint64_t> heartbeat{
      0};  ///< task adds 1 at least every third of heartbeat_timeout_s
  rtapi::SeqCell<Intent> values;
};

}  // namespace kerf::motion
