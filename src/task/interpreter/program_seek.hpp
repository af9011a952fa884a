// ProgramSeek: a program that is read from its top to a line, with all that it asks of the machine left out. What remains is the
// state in which that line would have found the machine.
//
// It has an interpreter of its own, so a search that is refused or aborted leaves no trace.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "interp/interpreter.hpp"
#include "interp/parameters.hpp"
#include "task/exchange.hpp"
#include "task/interpreter/canon_to_path.hpp"
#include "task/interpreter/program_lines.hpp"
#include "task/interpreter/task_environment.hpp"

namespace kerf::task {

struct SeekOutput {
  std::optional<double> value;    ///< on the pin
  std::optional<double> pending;  ///< comes with the next move
};

class ProgramSeek {
 public:
  /// `canon` and `list` are those of the participant; the canon's state at the start is kept in `from_canon`.
  struct Parts {
    TaskEnvironment& environment;
    CanonToPath& canon;
    std::deque<TaskItem>& list;
    const MachineSetup& setup;
  };
  enum class Step : std::uint8_t { more, found, refused };

  ProgramSeek(const Parts& parts, interp::Interpreter& now, int tool, int pocket, SeekEnd end);
  ~ProgramSeek();
  ProgramSeek(const ProgramSeek&) = delete;
  ProgramSeek& operator=(const ProgramSeek&) = delete;

  /// False: refusal() says why.
  [[nodiscard]] bool open(const std::string& path, std::int32_t line);
  /// Read to its end instead: Step::found is the end.
  [[nodiscard]] bool open_whole(const std::string& path);
  /// Told of each item that is left out.
  void watch(std::function<void(const TaskItem&)> watcher) { watcher_ = std::move(watcher); }
  /// Executes one block.
  [[nodiscard]] Step step();

  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  [[nodiscard]] std::int32_t line() const { return place_.line; }
  [[nodiscard]] SeekEnd end() const { return end_; }
  [[nodiscard]] interp::Interpreter& interpreter() { return interp_; }
  /// Back to where the canon was; also what a seek that ends does when it was not taken over.
  void put_back();
  /// The canon stays as it is: the state at the line.
  void keep() { kept_ = true; }

  // --- the state at the line ---
  [[nodiscard]] const CanonState& from_canon() const { return from_canon_; }
  [[nodiscard]] const interp::ModalState& from_modal() const { return from_modal_; }
  [[nodiscard]] int tool() const { return tool_; }
  [[nodiscard]] bool tool_by_number() const { return tool_by_number_; }
  [[nodiscard]] const std::map<std::pair<bool, int>, SeekOutput>& outputs() const {
    return outputs_;
  }
  [[nodiscard]] const std::string& log_file() const { return log_file_; }
  [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }
  /// The highest place of this axis on the path, from where the machine stands on.
  [[nodiscard]] double highest(std::size_t axis) const { return highest_[axis]; }

 private:
  bool open_file(const std::string& path);
  bool refuse(const std::string& why);
  bool refuse_here(const std::string& why);
  [[nodiscard]] bool look_at_items();
  [[nodiscard]] bool answer(interp::SyncReason reason);
  [[nodiscard]] bool may_begin_here();

  Parts p_;
  interp::Interpreter interp_;
  LinePlace place_;
  std::uint32_t file_{0};
  SeekEnd end_;
  bool whole_{false};
  std::function<void(const TaskItem&)> watcher_;
  CanonState from_canon_;
  interp::ModalState from_modal_;
  int tool_, pocket_;
  bool tool_by_number_{false};
  bool hal_read_{false};
  bool kept_{false};
  std::int32_t at_{0};          ///< line of the block that was executed last
  std::int32_t input_line_{0};  ///< of an M66 whose result nobody knows
  std::map<std::pair<bool, int>, SeekOutput> outputs_;
  std::vector<std::string> left_out_;
  std::string log_file_;
  rtapi::Pose highest_;
  std::string refusal_;
};

/// What the line wants other than the machine has it, a line each; "" when it has all.
struct MachineNow {
  int tool{0};
  bool flood{false}, mist{false};
  std::uint64_t digital_out{0};
  const double* analog_out{nullptr};
  rtapi::Pose position;
  const std::int32_t* spindle_direction{nullptr};
  const double* spindle_rpm{nullptr};
};
[[nodiscard]] std::vector<std::string> seek_differences(const ProgramSeek& seek,
                                                        const interp::ModalState& wanted,
                                                        const CanonState& canon,
                                                        const MachineNow& now, int spindles);

}  // namespace kerf::task
