// What the INI file says of the machine, read once, with every complaint at once.
//
// Lengths in the file are in machine units ([TRAJ]LINEAR_UNITS, ANGULAR_UNITS); here they are mm and degrees.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "interp/config/ini_settings.hpp"
#include "interp/environment.hpp"
#include "motion/api/config.hpp"
#include "motion/api/screw.hpp"

namespace kerf::task {

/// Bounds of what the operator may choose ([DISPLAY]); factors, 1 = as programmed.
struct OperatorLimits {
  double max_feed_override{1.0};
  double min_spindle_override{0.5};
  double max_spindle_override{1.0};
};

/// [EMCIO]
struct ToolConfig {
  std::string table_file;  ///< absolute; "" without a tool table
  std::string database;    ///< DB_PROGRAM as written, "" without
  bool random_changer{false};
  bool v2_pins{false};                             ///< EMCIO = iov2
  bool v2{false};                                  ///< with PROTOCOL_VERSION 2
  bool start_change{false};                        ///< -support-start-change
  std::string fault_text{"toolchanger error %d"};  ///< [TASK]IO_ERROR
  std::int64_t servo_period_ns{1000000};           ///< questions of io stand for two of them
  bool quill_up{false};
  bool at_g30{false};
  bool has_position{false};
  rtapi::Pose position{};  ///< TOOL_CHANGE_POSITION; axes in position_mask
  std::uint32_t position_mask{0};
};

using interp::ProgramPaths;
using interp::resolve_path;

/// The INI file's jerk limits, [TRAJ]MAX_LINEAR_JERK put in where a linear joint or axis has none. 0: not limited.
struct JerkLimits {
  double traj_mm_s3{0};
  std::array<double, motion::kMaxJoints> joint{};
  std::array<double, rtapi::kAxes> axis{};
};

struct MachineSetup {
  std::string ini_file;      ///< as it was given
  std::string machine_name;  ///< [EMC]MACHINE
  std::string journal;       ///< [KERF]JOURNAL
  motion::MachineConfig motion;
  JerkLimits jerks;  ///< those of `motion`, which has none while [TRAJ]PLANNER_TYPE is 0
  interp::Settings interp;
  OperatorLimits limits;
  ToolConfig tools;
  ProgramPaths paths;
  interp::PythonSettings python;
  std::vector<motion::ScrewTable> screws;  ///< [JOINT_n]COMP_FILE; of no joint, or of each
  std::string position_file;               ///< [TRAJ]POSITION_FILE, absolute; "" none
  std::string startup_code;                ///< [RS274NGC]RS274NGC_STARTUP_CODE
  std::string on_abort_command;            ///< [RS274NGC]ON_ABORT_COMMAND
  int mdi_queue{10};                       ///< [TASK]MDI_QUEUED_COMMANDS
  bool step_by_moves{false};               ///< [KERF]SINGLE_STEP = moves
  double linear_unit_mm{1};                ///< mm per machine unit
  double angular_unit_deg{1};
  std::array<double, motion::kMaxJoints> joint_unit{};  ///< mm or degrees per unit of [JOINT_n]
  /// [KINS]: the axis that the joint moves alone; -1: none, or only the kinematics module knows.
  std::array<int, motion::kMaxJoints> joint_axis{-1, -1, -1, -1, -1, -1, -1, -1,
                                                 -1, -1, -1, -1, -1, -1, -1, -1};
  bool check_limits{true};                           ///< [KERF]CHECK_LIMITS
  double default_vel_mm_s{0}, default_acc_mm_s2{0};  ///< [TRAJ]DEFAULT_LINEAR_...
  double task_cycle_s{0.01};                         ///< [TASK]CYCLE_TIME
  int debug{0};                                      ///< [EMC]DEBUG

  /// Axis along which the tool leaves the work: Z; X of a machine without Y, a lathe. -1: none.
  [[nodiscard]] int retract_axis() const {
    const auto has = [this](unsigned a) { return (motion.axis_mask >> a & 1U) != 0; };
    if (has(0) && has(2) && !has(1)) return 0;
    return has(2) ? 2 : -1;
  }
};

struct SetupResult {
  MachineSetup setup;
  std::vector<ini::Diagnostic>
      diagnostics;  ///< errors and warnings, in file order of the sections read
  bool ok{false};   ///< no error among them; else do not run this machine

  /// All of them, a line each.
  [[nodiscard]] std::string text() const;
};

/// Reads all of it. Unknown keys are the business of ini::check_keys, which the launcher asks.
[[nodiscard]] SetupResult read_machine_setup(const ini::IniFile& file);

}  // namespace kerf::task
