// Exchange: all that passes between the command thread and the interpreter thread of task. Nobody waits in it.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "io/tool_table.hpp"
#include "rtapi/base/fixed_string.hpp"
#include "rtapi/base/pose.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/seq_cell.hpp"
#include "task/api/protocol.hpp"
#include "task/api/status.hpp"

namespace kerf::task {

/// Identifies a client command in progress; unique in a task's life, 0: none.
using Ticket = std::uint64_t;

/// What a run that begins at a line does when the line is found.
enum class SeekEnd : std::uint8_t {
  run,    ///< bring the machine there and go on
  hold,   ///< bring the machine there and wait for resume
  check,  ///< only tell what differs
};

/// Command thread -> interpreter thread. Orders of an epoch older than the present one are answered `aborted`.
struct Order {
  enum class Kind : std::uint8_t {
    open,
    run,
    step,
    mdi,
    reload_tools,
    put_tool,
    reset,
    synch,
    save
  };
  Kind kind{Kind::mdi};
  bool by_hand{false};  ///< of mdi: it moves nothing, so motion may be in any mode
  std::uint32_t epoch{0};
  Ticket ticket{0};
  std::string text;      ///< file or MDI line
  io::ToolEntry tool;    ///< of put_tool
  std::int32_t line{0};  ///< of run: where to begin; 0: at the top
  SeekEnd seek_end{SeekEnd::run};
};

/// Argument of [RS274NGC]ON_ABORT_COMMAND; the numbers are documented.
enum AbortReason : std::uint32_t {
  abort_none = 0,  ///< the command does not run
  abort_exec_error = 1,
  abort_aux_estop = 2,
  abort_motion_error = 3,
  abort_state_off = 4,
  abort_state_estop = 6,
  abort_user = 8,
  abort_interpreter_error = 9,
  abort_interpreter_error_mdi = 10,
};

/// Interpreter thread -> command thread.
struct Report {
  enum class Kind : std::uint8_t {
    begun,     ///< the order of `ticket` is being carried out
    finished,  ///< it has ended as `state` says
    message,   ///< a line for the operator
    failed,  ///< the program is in error: tell the operator, abort, and end `ticket` with the text
    path_shift,  ///< motion shall drive the path `shift` beside its coordinates; ends `ticket` when it does
    program_end,  ///< M2, M30: feed and spindle overrides were set to on by the program itself; nothing to do but count
  };
  Kind kind{Kind::message};
  Ticket ticket{0};
  std::uint32_t epoch{
      0};  ///< of `failed`, `path_shift`: nothing to do when an abort has come since
  std::uint32_t reason{abort_interpreter_error};  ///< of `failed`: for ON_ABORT_COMMAND
  CommandState state{CommandState::done};
  MessageKind message{MessageKind::text};
  std::string text;
  std::string file;
  std::int32_t line{0};
  rtapi::Pose shift;
};

/// Another tool stands in the spindle, in the middle of a held path.
struct ToolExchange {
  Ticket ticket{0};
  std::int32_t tool{-1};  ///< -1: the same number, as the table has it now
};

/// What the interpreter thread shows of itself, for the status block.
struct InterpreterView {
  InterpState interp_state{InterpState::idle};
  ExecState exec_state{ExecState::done};
  rtapi::FixedString<255> file, source;
  rtapi::FixedString<127> command;
  std::int32_t current_line{0}, read_line{0}, call_level{0}, program_lines{0};
  std::int32_t main_line{0};  ///< in execution, of the main program; 0: none
  std::uint64_t block_id{0};  ///< of the block in execution (motion::SourceTag::id)
  std::uint64_t moved_id{0};  ///< of the newest block begun that moves the machine
  double progress{0};
  std::int32_t g_codes[17]{};
  std::int32_t m_codes[10]{};
  double settings[5]{};
  std::int32_t g5x_index{1}, program_units{2};
  rtapi::Pose g5x_offset, g92_offset, tool_offset;
  double rotation_deg{0};
  double spindle_rpm[kMaxSpindles]{};  ///< last S, for spindle commands of clients
  WaitingFor waiting_for;
  Prompt prompt;
  std::uint32_t settled_epoch{0};  ///< the abort epoch that the interpreter has followed
  bool idle{true};                 ///< no order in progress, nothing queued, all executed
  bool running_program{false};
  bool program_open{false};
  bool stopped{false};        ///< at M0, M1, M60 or after a step: waits for resume
  bool failed{false};         ///< the last order ended in an error of the interpreter
  bool input_timeout{false};  ///< of the last M66
};

class Exchange {
 public:
  Exchange(rtapi::Cell& to_command, rtapi::Cell& to_interpreter)
      : to_command_(to_command), to_interpreter_(to_interpreter) {}

  // --- command thread ---
  void post(Order order) {
    {
      const std::lock_guard lock(mutex_);
      orders_.push_back(std::move(order));
    }
    to_interpreter_.notify();
  }
  void ask(const ToolExchange& exchange) {
    {
      const std::lock_guard lock(mutex_);
      tool_exchanges_.push_back(exchange);
    }
    to_interpreter_.notify();
  }
  [[nodiscard]] std::vector<Report> take_reports() {
    const std::lock_guard lock(mutex_);
    std::vector<Report> out;
    out.swap(reports_);
    return out;
  }
  void wake_interpreter() { to_interpreter_.notify(); }

  // --- interpreter thread ---
  [[nodiscard]] bool take(Order& out) {
    const std::lock_guard lock(mutex_);
    if (orders_.empty()) return false;
    out = std::move(orders_.front());
    orders_.pop_front();
    return true;
  }
  [[nodiscard]] bool take(ToolExchange& out) {
    const std::lock_guard lock(mutex_);
    if (tool_exchanges_.empty()) return false;
    out = tool_exchanges_.front();
    tool_exchanges_.pop_front();
    return true;
  }
  void put_back(Order order) {
    const std::lock_guard lock(mutex_);
    orders_.push_front(std::move(order));
  }
  /// Takes the MDI lines of this epoch at the head of the queue.
  [[nodiscard]] std::deque<Order> take_mdi(std::uint32_t epoch) {
    const std::lock_guard lock(mutex_);
    std::deque<Order> out;
    while (!orders_.empty() && orders_.front().kind == Order::Kind::mdi &&
           orders_.front().epoch == epoch) {
      out.push_back(std::move(orders_.front()));
      orders_.pop_front();
    }
    return out;
  }
  void report(Report report) {
    {
      const std::lock_guard lock(mutex_);
      reports_.push_back(std::move(report));
    }
    to_command_.notify();
  }
  void show(const InterpreterView& view) {
    view_.write(view);
    to_command_.notify();
  }

  // --- both ---
  /// Leaves `out` as it is when the interpreter thread is in the middle of a write for long; it wakes the command thread behind it.
  void read_view(InterpreterView& out) const { (void)view_.read(out); }
  [[nodiscard]] std::size_t queued() const {
    const std::lock_guard lock(mutex_);
    return orders_.size();
  }

  // Switches of the operator: each word alone, written by the command thread. The first two are on at the start, as LinuxCNC's are.
  rtapi::Word<std::uint32_t> optional_stop{1};
  rtapi::Word<std::uint32_t> block_delete{1};
  rtapi::Word<std::uint32_t> paused{0};    ///< the operator's pause: begin nothing new
  rtapi::Word<std::uint32_t> resumes{0};   ///< a new value: go on after M0, M1, M60 or a step
  rtapi::Word<std::uint32_t> stepping{0};  ///< stop after each block
  rtapi::Word<std::uint32_t> abort_reason{
      0};  ///< AbortReason of the last abort, written before its epoch
  rtapi::Word<std::uint32_t> task_state{1};  ///< for the environment of user M-codes
  rtapi::Word<std::uint32_t> mode{1};

 private:
  rtapi::Cell& to_command_;
  rtapi::Cell& to_interpreter_;
  mutable std::mutex mutex_;
  std::deque<Order> orders_;
  std::deque<ToolExchange> tool_exchanges_;
  std::vector<Report> reports_;
  rtapi::SeqCell<InterpreterView> view_;
};

}  // namespace kerf::task
