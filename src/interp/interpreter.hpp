// Interpreter: RS274NGC programs and MDI lines, executed block by block into a Canon.
//
//     Interpreter interp(environment, canon, settings);
//     interp.init();                                   // announces offsets and units
//     interp.open("part.ngc");                         // Status
//     for (;;) {
//       const Outcome o = interp.execute_next();       // ONE block
//       if (o == Outcome::error) { show(interp.error().message()); break; }
//       if (o == Outcome::program_end || o == Outcome::idle) break;
//       if (o == Outcome::needs_sync) {                // finish all queued canon work, then:
//         interp.synchronize({.machine_position = ..., .input_value = ...});
//       }
//     }
//
// The library has no threads, clock or globals, never blocks and never recurses with the program. To stop, just do not
// call execute_next() again; then abort() and, with the state of the item at which motion stopped, restore().
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "interp/canon.hpp"
#include "interp/environment.hpp"
#include "interp/modal.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::interp {

class Core;
class ParameterTable;
struct Dialect;

enum class Outcome : std::uint8_t {
  ok,  ///< a block was executed (or skipped); call again
  needs_sync,  ///< wait until all canon work is done, then synchronize(), then call again; why: sync_reason()
  program_end,  ///< M2, M30 or the closing %; the program is rewound
  needs_line,  ///< all lines of the stream are done: answer the sender, push_line(), then call again
  idle,   ///< nothing to execute: no program open, or the MDI line (and the sub it called) is done
  error,  ///< nothing of the block was done; see error(). The next call goes on with the next line
};

enum class SyncReason : std::uint8_t {
  none,
  wait_input,  ///< M66: needs input_value
  probe,       ///< G38.x: needs machine_position and probe
  tool_change,  ///< M6: needs tool_in_spindle, pocket_in_spindle, machine_position (the changer may move)
  user_mcode,    ///< M100-M199
  script,        ///< a function in Python asked for it
  program_stop,  ///< M0, M1, M60: the operator may have changed offsets or jogged
};

/// What the world did while the queue ran empty. Members without a value leave the interpreter's as it is.
struct ExternalState {
  struct Probe {
    Pose machine_position;  ///< at the trip, or at the end of the move
    bool tripped{false};
  };
  std::optional<Pose> machine_position{};  ///< commanded position of the axes, mm and degrees
  std::optional<int> tool_in_spindle{};    ///< tool number, 0 = none
  std::optional<int> pocket_in_spindle{};
  std::optional<double> input_value{};     ///< -> #5399
  std::optional<Probe> probe{};            ///< -> #5061-#5070
  std::optional<int> toolchanger_fault{};  ///< -> #5600 (0/1) and #5601 (the reason)
};

/// One error: the peer's text, where, and what to do.
struct InterpError {
  std::string text;    ///< the documented message, e.g. "Cannot do g1 with zero feed rate"
  std::string help;    ///< next step, "" when the text says it all
  std::string file;    ///< "" for MDI
  std::string source;  ///< the line as written
  std::int32_t line{0};
  std::int32_t column{0};  ///< counts from 1, 0 unknown
  std::int32_t call_level{0};

  /// "FILE:LINE:COLUMN: text" and, on a second line, the help.
  [[nodiscard]] std::string message() const;
  /// What to print below `source` so that a ^ stands under the word to blame; "" when it is the whole line.
  [[nodiscard]] std::string caret() const;
};

class Interpreter {
 public:
  /// Both references must outlive the interpreter.
  Interpreter(Environment& environment, Canon& canon, const Settings& settings = {});
  /// With a dialect that has no name in the INI; it must outlive the interpreter too.
  Interpreter(Environment& environment, Canon& canon, const Settings& settings,
              const Dialect& dialect);
  ~Interpreter();
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  /// Default modes; work offset, rotation and G92 from the parameters; announces them to the canon.
  /// Call once after the parameters are loaded, and to start from scratch.
  void init();

  /// Opens a program; it is read in chunks as it runs. Keeps modal state. Closes a program that is open.
  [[nodiscard]] rtapi::Status open(const std::string& path);
  /// The same with the text in memory; `name` is shown as its file.
  [[nodiscard]] rtapi::Status open_text(const std::string& name, std::string text);
  /// Lines that come one by one, each answered before the next: push_line(), then execute_next() until `needs_line` (the line is
  /// done: ok), `error` (it did nothing; the next line may be pushed) or `program_end` (the stream goes on). Modes, parameters,
  /// subs and loops work over lines as in a file. abort() drops lines that wait.
  void open_stream(const std::string& name);
  /// One line of the stream. Error: no stream is open, or a loop or sub is too long to be kept.
  [[nodiscard]] rtapi::Status push_line(std::string_view line);
  /// No more lines come: what is unfinished becomes an error as at the end of a file.
  void end_stream();
  void close();
  [[nodiscard]] bool is_open() const;

  /// Executes one block of the MDI line in progress, else of the program.
  [[nodiscard]] Outcome execute_next();
  /// Executes one MDI line. When it calls a sub the result is `ok`: go on with execute_next() until `idle`
  /// (always do so; a line that is done at once gives `idle` at the next call). An open program stays where it is.
  [[nodiscard]] Outcome execute_mdi(std::string_view text);
  /// An MDI line is not yet finished.
  [[nodiscard]] bool mdi_active() const;
  [[nodiscard]] SyncReason sync_reason() const;
  /// After needs_sync, and after anything else moved the machine (jog, homing, abort). Makes no canon call.
  void synchronize(const ExternalState& state);

  /// Forgets subs, loops and the MDI line in progress and rewinds the program. Modal state stays. No canon call.
  void abort();
  /// Calls wait for the end of a compensated move; the next block that moves, G40 or the end of the program delivers them.
  [[nodiscard]] bool waiting() const;
  /// The tool has another length than it had: the program's place stays, and what the machine's place is follows. Also of modes that
  /// M70 and the like have saved under the same offset.
  void replace_tool_offset(const Pose& offset);
  /// The last block named or noted a place in machine coordinates (G53, G28, G30 and their .1).
  [[nodiscard]] bool used_machine_place() const;
  /// The machine stands beside modal().position: compensation is on, or G40 still waits for a move.
  [[nodiscard]] bool beside_path() const;
  /// State after the last block; while canon calls are delivered that after the block which they belong to.
  [[nodiscard]] const ModalState& modal() const;
  /// Takes back modes and offsets (parameters 5210-5220 too) as they were at `state`. No canon call; follow with
  /// synchronize({.machine_position}) since the position is that of the machine.
  void restore(const ModalState& state);

  [[nodiscard]] const InterpError& error() const;
  /// Why Environment::scripts() cannot be used, or ""; after init().
  [[nodiscard]] const std::string& script_problem() const;
  /// Numbered and named parameters; load it with ParameterFile before init().
  [[nodiscard]] ParameterTable& parameters();

  /// Lines that begin with / are skipped while on.
  void set_block_delete(bool on);
  /// Each goes on where the other was. Both need the same environment, canon and settings.
  void swap(Interpreter& other) noexcept { core_.swap(other.core_); }
  /// Tool number and pocket in the spindle (as synchronize(), for start-up).
  void set_tool_in_spindle(int number, int pocket);

  [[nodiscard]] int call_level() const;
  /// The next call of execute_next() reads a line: no repeat (L), no remapped code and no search for a branch is under way.
  [[nodiscard]] bool at_line_start() const;
  /// Line that execute_next() will read next in the current file, and that file's id.
  [[nodiscard]] int next_line() const;
  [[nodiscard]] std::uint32_t current_file() const;
  /// Path of a file by SourceLine::file_id; "" for MDI.
  [[nodiscard]] const std::string& file_name(std::uint32_t file_id) const;

 private:
  std::unique_ptr<Core> core_;
};

}  // namespace kerf::interp
