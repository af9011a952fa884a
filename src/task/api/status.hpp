// Status of task: one block of the instance's segment that every client reads, and task alone writes.
//
//   auto shared = segment.find<task::TaskShared>(task::kTaskBlock, task::kTaskAbi);
//   task::TaskStatus now;
//   if (shared.ok() && (*shared)->status.read(now)) std::printf("line %d\n", now.current_line);
//
// Numbers of the enumerations are those of the Python module `linuxcnc` (manual: "Python Interface").
// Positions and joints are not repeated here: they stand in motion's status (motion/api/status.hpp).
#pragma once

#include <cstdint>
#include <string>

#include "rtapi/base/fixed_string.hpp"
#include "rtapi/base/pose.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/seq_cell.hpp"

namespace kerf::task {

enum class TaskState : std::int32_t { estop = 1, estop_reset = 2, off = 3, on = 4 };
enum class TaskMode : std::int32_t { manual = 1, automatic = 2, mdi = 3 };
enum class InterpState : std::int32_t { idle = 1, reading = 2, paused = 3, waiting = 4 };
enum class ExecState : std::int32_t {
  error = 1,
  done = 2,
  waiting_for_motion = 3,
  waiting_for_motion_queue = 4,
  waiting_for_io = 5,
  waiting_for_motion_and_io = 7,
  waiting_for_delay = 8,
  waiting_for_system_cmd = 9,
  waiting_for_spindle_oriented = 10,
};

/// What the program waits for beyond motion itself, in words for an operator. `object` empty: nothing.
struct WaitingFor {
  rtapi::FixedString<63> object;  ///< "tool 3 in the spindle", "digital input 0 to go high"
  rtapi::FixedString<63> pin;  ///< HAL pin that ends the wait ("iocontrol.0.tool-changed"), or ""
  rtapi::FixedString<63> net;  ///< the signal that the pin is linked to, or ""
  std::int64_t since_ns{0};    ///< instance time at which the wait began
};

enum class PromptKind : std::int32_t {
  none = 0,
  stop = 1,           ///< M0
  optional_stop = 2,  ///< M1
  pallet = 3,         ///< M60
  tool_change = 4,    ///< M6
};
/// "stop", "optional-stop" ...
[[nodiscard]] constexpr const char* to_string(PromptKind kind) noexcept {
  constexpr const char* kNames[] = {"none", "stop", "optional-stop", "pallet", "tool-change"};
  return kNames[static_cast<int>(kind)];
}

/// What the program asks the operator. The command `answer` answers it, with its number, so that nobody answers another question than the
/// one that he has read; `resume`, `tool-changed` and the pins of tool changers do as well.
struct Prompt {
  std::uint64_t number{0};  ///< 1, 2, 3 ...
  PromptKind kind{PromptKind::none};
  std::int32_t tool{-1};         ///< tool_change: its number
  rtapi::FixedString<127> text;  ///< "M6: tool 3 (drill) into the spindle"
};

/// Terminal outcomes of client commands since start. received = done + errors + aborted + those in progress.
struct CommandCounters {
  std::uint64_t received{0}, done{0}, errors{0}, aborted{0};
};

inline constexpr std::size_t kMaxSpindles = 8;

/// "the tool change: iocontrol.0.tool-changed, net tool-changed", for all clients; "" when nothing is waited for.
[[nodiscard]] inline std::string wait_text(const WaitingFor& wait) {
  std::string text(wait.object.view());
  if (text.empty() || wait.pin.empty()) return text;
  text.append(": ").append(wait.pin.view());
  if (!wait.net.empty()) return text.append(", net ").append(wait.net.view());
  return text.append(", not linked");
}

/// Written on every change. Lengths in mm, angles in degrees, speeds in rpm; `settings` as documented for stat.settings.
struct TaskStatus {
  std::uint64_t version{0};  ///< grows with every write
  std::int64_t time_ns{0};   ///< instance time of the write
  std::int64_t pid{0};       ///< of milltask; 0 in the test harness
  TaskState task_state{TaskState::estop};
  TaskMode mode{TaskMode::manual};
  InterpState interp_state{InterpState::idle};
  ExecState exec_state{ExecState::done};

  // --- program ---
  rtapi::FixedString<255> file;     ///< program as opened; "" without
  rtapi::FixedString<255> source;   ///< file of the line in execution ("" for MDI)
  rtapi::FixedString<127> command;  ///< MDI line in progress, or the last one
  std::int32_t current_line{0};     ///< in execution, from motion; 0: none
  std::int32_t read_line{0};        ///< the interpreter reads next
  std::int32_t call_level{0};       ///< of the line in execution
  std::int32_t queued_mdi{0};       ///< MDI lines accepted and not yet begun
  std::int32_t program_lines{0};    ///< counted once when the file is opened
  std::int32_t single_step{0};      ///< 1 while stepping
  double progress{0};               ///< 0..1, executed lines of the main program over all of them
  std::uint64_t programs_ended{0};  ///< how many program runs have ended, in whatever way
  bool paused{false};               ///< the operator's pause, M0, M1 or M60
  bool optional_stop{false};
  bool block_delete{false};
  bool idle{true};  ///< nothing queued, nothing executing, motion at rest
  bool program_open{false};
  bool override_limits{false};
  bool reserved[2]{};

  // --- modal state, of the line in execution ---
  std::int32_t g_codes[17]{};  ///< tenths, -1 none; order: see interp/modal.hpp
  std::int32_t m_codes[10]{};
  double settings[5]{};           ///< line, F, S, G64 P, G64 Q
  std::int32_t g5x_index{1};      ///< 1 = G54 ... 9 = G59.3
  std::int32_t program_units{2};  ///< 1 inch, 2 mm
  rtapi::Pose g5x_offset, g92_offset, tool_offset;
  double rotation_deg{0};

  // --- tools, coolant, spindles ---
  std::int32_t tool_in_spindle{0};
  std::int32_t tool_from_pocket{0};
  std::int32_t pocket_prepped{-1};  ///< tool table index that is prepared, -1: none
  std::int32_t tool_prepped{-1};    ///< its tool number
  bool flood{false}, mist{false};
  bool emc_enable_in{false};   ///< external estop chain closed
  bool estop_external{false};  ///< of the last one that `estops` counts: not asked for by a client
  bool reserved2[4]{};

  // --- overrides ---
  double feed_override{1}, rapid_override{1};
  double spindle_override[kMaxSpindles]{1, 1, 1, 1, 1, 1, 1, 1};
  double max_vel_mm_s{0};  ///< the operator's limit

  WaitingFor waiting_for;
  Prompt prompt;
  std::uint64_t messages{0};  ///< number of the newest OperatorMessage; 0: none
  std::uint64_t errors{0};    ///< how many of kind `error` there were
  CommandCounters commands;
  std::uint32_t abort_epoch{0};  ///< as in motion's intent
  std::int32_t clients{0};
  std::uint64_t echo_serial{0};  ///< the highest id of a request that was taken (Client::next_id)
  std::int32_t debug{0};         ///< [EMC]DEBUG, and what a client has set since
  std::int32_t interpreter_error{0};  ///< 0 well; 5: the last program or MDI line is in error
  bool input_timeout{false};          ///< the last M66 met no level in its time
  bool last_failed{
      false};  ///< the newest command of a client that has an outcome ended in an error
  bool waiting_tool_prepared{false}, waiting_tool_changed{false};  ///< for iocontrol.0's pins
  /// Estops that stopped something: a program, a jog, homing, a spindle. None when the machine stood idle.
  std::uint32_t estops{0};
};

/// What stays as it is while task runs, from the INI file. Limits, which may change: motion's configuration (motion/api/config.hpp).
struct MachineFacts {
  rtapi::FixedString<511> ini_file;  ///< as given to task
  rtapi::FixedString<127> machine_name;
  double linear_unit_mm{1};    ///< mm in one machine unit
  double angular_unit_deg{1};  ///< degrees in one machine unit
  double joint_unit[16]{};     ///< mm or degrees in one unit of [JOINT_n]UNITS
  double default_vel_mm_s{0}, default_acc_mm_s2{0};  ///< [TRAJ]DEFAULT_LINEAR_...
  double max_acc_mm_s2{0};    ///< [TRAJ]MAX_LINEAR_ACCELERATION; 0: not limited there
  double cycle_time_s{0.01};  ///< [TASK]CYCLE_TIME
  double max_feed_override{1}, min_spindle_override{0}, max_spindle_override{1};
  double spindle_increment_rpm[kMaxSpindles]{};
  bool random_toolchanger{false};
  bool no_force_homing{false};
  bool reserved[6]{};
};

/// One tool. Lengths in mm and degrees.
struct ToolRecord {
  std::int32_t number{-1};  ///< -1: nothing
  std::int32_t pocket{0};
  rtapi::Pose offset;
  double diameter_mm{0}, front_angle_deg{0}, back_angle_deg{0};
  std::int32_t orientation{0};
  std::int32_t reserved{0};
  rtapi::FixedString<119> comment;
};

/// The tool table, in file order from slot 1; slot 0 is the spindle. Written by task when anything of it changes.
struct ToolSlots {
  static constexpr std::size_t kSlots = 1001;
  rtapi::SeqCell<ToolRecord> slot[kSlots];
  rtapi::Word<std::uint32_t> used{0};  ///< slots 0 to used - 1
  rtapi::Word<std::uint64_t> version{
      0};  ///< odd: in the middle of a change; published after the slots
};

/// Numbers as in error_channel of the Python module.
enum class MessageKind : std::int32_t { error = 11, text = 12, display = 13 };

/// One line for the operator.
struct OperatorMessage {
  std::uint64_t number{0};  ///< 1, 2, 3 ...; readers keep a cursor of their own
  std::int64_t time_ns{0};
  MessageKind kind{MessageKind::error};
  std::int32_t line{0};  ///< 0: none
  rtapi::FixedString<160> file;
  rtapi::FixedString<700> text;  ///< complete, with file and line when there are any
};

/// Newest last. A reader that is more than kSlots behind has lost some and sees it from the numbers.
struct MessageLog {
  static constexpr std::size_t kSlots = 256;
  rtapi::SeqCell<OperatorMessage> slot[kSlots];  ///< message n stands in slot n % kSlots
  rtapi::Word<std::uint64_t> newest{0};          ///< published after the slot
};

/// The block. Made by task when it attaches; found again (and reset) by a task that is started anew.
struct TaskShared {
  rtapi::SeqCell<TaskStatus> status;
  rtapi::Cell status_cell;                ///< notified after each write of `status`
  rtapi::Cell reply_cell;                 ///< notified after replies were sent to clients
  rtapi::Cell inbox;                      ///< clients notify it after sending a request
  rtapi::Cell to_command;                 ///< inside task
  rtapi::Cell to_interpreter;             ///< inside task
  rtapi::Cell to_io;                      ///< inside task
  rtapi::Word<std::uint32_t> ready{0};    ///< 1 once clients may connect
  rtapi::Word<std::uint64_t> serials{0};  ///< the last id that a client took
  rtapi::SeqCell<MachineFacts> facts;
  MessageLog messages;
  ToolSlots tools;
};

inline constexpr const char* kTaskBlock = "task.status";
inline constexpr std::uint64_t kTaskAbi = 1 + sizeof(TaskShared) * 0x9e3779b97f4a7c15ULL;
/// Service name of the client socket (rtapi::socket_name).
inline constexpr const char* kTaskService = "task";

}  // namespace kerf::task
