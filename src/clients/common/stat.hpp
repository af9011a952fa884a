// Stat: the whole machine at one moment, in the terms and units of LinuxCNC's `stat` (manual: "Python Interface").
//
// Names, numbers and shapes are those of the Python module's attributes. Lengths are in machine units ([TRAJ]LINEAR_UNITS), angles in
// [TRAJ]ANGULAR_UNITS, joints in [JOINT_n]UNITS; speeds a second; overrides are factors.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "motion/api/limits.hpp"
#include "rtapi/base/pose.hpp"
#include "task/api/status.hpp"

namespace kerf::clients {

/// RCS_DONE, RCS_EXEC, RCS_ERROR
enum class RcsState : std::int32_t { done = 1, exec = 2, error = 3 };

/// Joints that do not exist are shown as this.
struct JointStat {
  int joint_type{1};  ///< 1 LINEAR, 2 ANGULAR
  double units{1};    ///< joint units in 1 mm or 1 degree
  double backlash{0}, min_position_limit{-1}, max_position_limit{1}, max_ferror{1}, min_ferror{1};
  double ferror_current{0}, ferror_highmark{0}, output{0}, input{0}, velocity{0};
  bool inpos{true}, homing{false}, homed{false}, fault{false}, enabled{false};
  bool min_soft_limit{false}, max_soft_limit{false}, min_hard_limit{false}, max_hard_limit{false};
  bool override_limits{false};
};

struct AxisStat {
  double velocity{0}, min_position_limit{0}, max_position_limit{0};
};

struct SpindleStat {
  int brake{1}, direction{0}, enabled{0}, orient_state{0}, orient_fault{0};
  double override_{1}, speed{0};
  bool override_enabled{false}, homed{false};
};

struct ToolStat {
  int id{-1};  ///< -1: nothing
  int pocket{0};
  rtapi::Pose offset;
  double diameter{0}, frontangle{0}, backangle{0};
  int orientation{0};
  std::string comment;
};

struct Stat {
  // --- task ---
  int task_state{1}, task_mode{1}, exec_state{2}, interp_state{1}, interpreter_errcode{0};
  RcsState state{RcsState::done};
  bool estop{true}, task_paused{false}, paused{false}, single_stepping{false};
  bool optional_stop{false}, block_delete{false}, input_timeout{false};
  int call_level{0}, current_line{0}, motion_line{0}, read_line{0}, debug{0};
  std::int64_t motion_id{0};
  int queued_mdi_commands{0}, program_units{2}, g5x_index{1};
  std::uint64_t echo_serial_number{0}, heartbeat{0}, taskbeat{0};
  std::string command, file, ini_filename;
  task::Prompt prompt;  ///< what the program asks the operator
  task::WaitingFor waiting_for;
  std::array<int, 17> gcodes{};
  std::array<int, 10> mcodes{};
  std::array<double, 5> settings{};
  rtapi::Pose g5x_offset, g92_offset, tool_offset;
  double rotation_xy{0}, delay_left{0}, cycle_time{0};

  // --- machine ---
  double linear_units{1}, angular_units{1};  ///< machine units in 1 mm, in 1 degree
  int joints{0}, num_extrajoints{0}, spindles{0}, kinematics_type{1};
  std::uint32_t axis_mask{0};
  double velocity{0};  ///< has no meaning, and is 0
  double acceleration{0}, max_velocity{0}, max_acceleration{0};

  // --- motion ---
  bool enabled{false}, inpos{false}, queue_full{false}, probing{false}, probe_tripped{false};
  bool all_homed{false};
  bool feed_override_enabled{true}, adaptive_feed_enabled{false}, feed_hold_enabled{true};
  int motion_mode{1}, motion_type{0}, probe_val{0};
  int queue{0}, active_queue{0};
  double feedrate{1}, rapidrate{1}, current_vel{0}, distance_to_go{0};
  rtapi::Pose position, actual_position, probed_position, dtg;
  std::array<double, motion::kMaxJoints> joint_position{}, joint_actual_position{};
  std::array<int, motion::kMaxJoints>
      limit{};  ///< bits: 1 min hard, 2 max hard, 4 min soft, 8 max soft
  std::array<int, motion::kMaxJoints> homed{};
  std::array<double, motion::kMaxAnalog> ain{}, aout{};
  std::array<int, motion::kMaxDigital> din{}, dout{}, misc_error{};
  std::array<JointStat, motion::kMaxJoints> joint{};
  std::array<AxisStat, rtapi::kAxes> axis{};
  std::array<SpindleStat, motion::kMaxSpindles> spindle{};

  // --- io ---
  bool flood{false}, mist{false};
  int tool_in_spindle{0}, tool_from_pocket{0}, pocket_prepped{-1};
  /// Entry 0 is the spindle; then the tool table's, in file order.
  std::vector<ToolStat> tool_table;
};

}  // namespace kerf::clients
