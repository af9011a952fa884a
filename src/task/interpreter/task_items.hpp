// TaskItem: one entry of the ordered list between the interpreter and motion: an item for motion's path ring, or something
// that task itself does in its place in the program.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "interp/canon.hpp"
#include "motion/api/path_items.hpp"
#include "task/api/status.hpp"

namespace kerf::task {

// Side things: done when all before them is executed, while the path goes on.
struct PrepareTool {
  int number{0};
};
struct SetCoolant {
  int flood{-1}, mist{-1};
};  ///< -1 leaves as it is
struct ShowMessage {
  std::string text;
  MessageKind kind{MessageKind::display};
};
struct PrintText {
  std::string text;
};
struct LogText {
  enum class Kind : std::uint8_t { open, append, text, close, probe_open, probe_close };
  Kind kind{Kind::text};
  std::string text;
};

// Barriers: begun when all before them is executed; nothing behind them begins before they are done.
struct StartChange {};  ///< M6 begins, for changers that want to know (iov2)
struct ChangeTool {
  int number{-1};  ///< of the last T; -1: there was none
};
struct SetToolNumber {
  int number{0};
};
struct UserMcodeRun {
  int number{0};
  std::string path, p, q;
};
struct ProgramPause {
  bool optional{false}, pallet{false};
};  ///< M0, M60; M1
struct WaitInput {
  int index{0};
  bool analog{false};
  interp::WaitMode mode{interp::WaitMode::immediate};
  double timeout_s{0};
};
struct WaitOrient {
  int spindle{0};
  double timeout_s{0};
};
/// G10 L0, L1, L10, L11.
struct StoreTools {
  std::vector<interp::Tool> tools;
  bool reload{false};
};
struct ProgramEnd {};
struct ProgramError {
  std::string text, file;  ///< no file: at the item's tag
  std::int32_t line{0};
};

using PathBody = motion::PathItems::Variant;
using TaskItemBody =
    std::variant<PathBody, PrepareTool, SetCoolant, ShowMessage, PrintText, LogText, ChangeTool,
                 SetToolNumber, UserMcodeRun, ProgramPause, WaitInput, WaitOrient, ProgramEnd,
                 ProgramError, StoreTools, StartChange>;

struct TaskItem {
  motion::SourceTag tag;
  TaskItemBody body;
};

/// True for items that motion executes.
inline bool is_path(const TaskItem& item) noexcept { return item.body.index() == 0; }
/// True for items that do not hold up what is behind them.
inline bool is_aside(const TaskItem& item) noexcept {
  return item.body.index() >= 1 && item.body.index() <= 5;
}

}  // namespace kerf::task
