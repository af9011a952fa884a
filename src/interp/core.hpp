// Core: the state machine behind Interpreter. Handlers of codes work on it; see docs in interpreter.hpp.
#pragma once

#include <array>
#include <cstdarg>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "interp/block.hpp"
#include "interp/canon_buffer.hpp"
#include "interp/compensation/compensation.hpp"
#include "interp/dialect.hpp"
#include "interp/dialects/compat.hpp"
#include "interp/interpreter.hpp"
#include "interp/modal_store.hpp"
#include "interp/parameters.hpp"
#include "interp/parser.hpp"
#include "interp/predefined.hpp"
#include "interp/program.hpp"
#include "interp/script.hpp"

namespace kerf::interp {

/// Codes on one line, modal motion included.
inline constexpr int kRowSlots = 24;
/// The integer next to v; false when v is none.
[[nodiscard]] bool near_integer(double v, double& rounded);

/// A block with its numbers computed.
struct Block {
  LetterMask mask{0};
  std::array<double, kLetters> value{};
  std::array<std::uint32_t, kLetters> at{};
  std::array<const CodeRow*, kRowSlots> rows{};
  std::array<std::int16_t, kRowSlots> codes{};  ///< the code of each row (rows may be ranges)
  int row_count{0};
  const CodeRow* motion{nullptr};  ///< explicit or modal group 1 row that takes the axis words
  int motion_code{-1};
  bool motion_is_modal{false};
  bool axis_by_other{false};  ///< a group 0 or 8 code takes the axis words
  bool g53{false};
  std::string_view quoted;  ///< the text in quotes, as long as its code runs
  const ParsedBlock* source{nullptr};

  [[nodiscard]] bool has(char c) const { return (mask >> letter_index(c) & 1U) != 0; }
  [[nodiscard]] double operator[](char c) const {
    return value[static_cast<std::size_t>(letter_index(c))];
  }
  [[nodiscard]] double get(char c, double otherwise) const {
    return has(c) ? (*this)[c] : otherwise;
  }
  [[nodiscard]] bool has_axis(std::size_t axis) const {
    return (mask >> kAxisLetter[axis] & 1U) != 0;
  }
  [[nodiscard]] double axis(std::size_t axis) const {
    return value[static_cast<std::size_t>(kAxisLetter[axis])];
  }
  [[nodiscard]] bool has_axes() const { return (mask & kAxisMask) != 0; }
  [[nodiscard]] int code_of(char letter, int group) const {
    for (int i = 0; i < row_count; ++i) {
      const auto n = static_cast<std::size_t>(i);
      if (rows[n]->letter == letter && rows[n]->group == group) return codes[n];
    }
    return -1;
  }
};

/// One thing that a block does.
struct Step {
  std::int16_t order;
  std::int16_t code;
  const CodeRow* row;  ///< null: the word of `code` (f, s, t)
};
/// What a block does, in the order of execution.
struct Steps {
  std::array<Step, kRowSlots + 4> list;  // filled up to count
  int count{0}, next{0};
};

/// A block that waits for the body of a remapped code, or for what it asked before: copied, since lines are read meanwhile.
struct RemapCall {
  const Remap* remap{nullptr};
  BlockCache memory;
  ParsedBlock parsed;  ///< shows what `memory` holds
  Block block;
  Steps steps;
  bool builtin_used{false};  ///< the body used the built-in code that it replaces
};

class Core;
class CoreSelf;

/// A canned cycle block in progress: each execute_next does one repeat.
struct Repeats {
  std::int64_t left{0};
  Block block;
  SourceLine source;
  std::string file, text;
  int code{0};
};

/// M72, and the return from a sub with M73: all modes but the motion mode (codes/state.cpp). `tool_then`: number of the tool in the
/// spindle when they were saved.
[[nodiscard]] bool restore_modes(Core& c, const ModalState& was, int tool_then);

class Core {
 public:
  Core(Environment& environment, Canon& sink, const Settings& config, const Dialect& rows);
  ~Core();
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  // --- what Interpreter offers ---
  void init();
  [[nodiscard]] Outcome execute_next();
  [[nodiscard]] Outcome execute_mdi(std::string_view text);
  void open_main(const std::string& path, std::unique_ptr<LineSource> source);
  void open_stream(const std::string& name);
  /// The main program, when it is a stream.
  [[nodiscard]] LineStream* stream() const;
  void close_main();
  void synchronize(const ExternalState& external);
  void abort();
  void restore(const ModalState& state);

  // --- for handlers (codes/) ---
  Environment& env;
  Canon& canon;
  const Settings settings;
  const Dialect& dialect;
  const CompatRow& compat;
  ModalState state;
  ParameterTable params;
  CanonBuffer out;
  Compensation compensation{*this};
  const ModalState* shown{nullptr};  ///< state of the block in delivery when it is an earlier one
  Tool spindle_tool{0, 0, {}, 0, 0, 0, 0};  ///< row of the tool in the spindle
  std::vector<Tool> tool_changes;           ///< by G10 in this block
  std::vector<Tool> changed_tools;          ///< by G10, until the tool table is heard of again
  InterpError error;
  SyncReason sync{SyncReason::none};
  bool block_delete{false};
  bool ended{false};  ///< M2, M30 or % in this block
  Flows flows;
  Repeats repeats;
  bool machine_place{false};       ///< Interpreter::used_machine_place()
  std::vector<SplinePoint> nurbs;  ///< of G5.2; ModalState::nurbs_points says how many count
  double sub_value{0};             ///< #<_value>
  bool sub_value_returned{false};

  /// Remembers the error of this block; always false. `letter`: the word to blame, 0 for the whole line.
  bool fail(char letter, const char* help, const char* format, ...)
      __attribute__((format(printf, 4, 5)));
  bool fail_at(std::size_t normalised, const char* help, const char* format, ...)
      __attribute__((format(printf, 4, 5)));
  /// The word as an integer; error when it is none. Absent: `otherwise`.
  [[nodiscard]] bool integer(const Block& b, char letter, int otherwise, int& value);
  /// Tool by number: as G10 left it, else as the tool table has it.
  [[nodiscard]] std::optional<Tool> find_tool(int number) const;
  /// An axis word in mm or degrees; X is a diameter in G7.
  [[nodiscard]] double axis_word(const Block& b, std::size_t axis) const {
    if (rtapi::is_rotary(axis)) return b.axis(axis);
    const double v = mm(b.axis(axis));
    return axis == 0 && state.lathe_diameter ? v / 2 : v;
  }
  /// mm of a length in program units.
  [[nodiscard]] double mm(double length) const { return length * state.unit_mm(); }
  /// Program coordinates that the axis words ask for (G90/G91, G53, polar). Error: axis not there.
  [[nodiscard]] bool target(const Block& b, Pose& end);
  [[nodiscard]] bool check_axes(const Block& b);
  void comment(std::string_view text) { out.call<&Canon::comment>(out.keep(text)); }
  void ask_sync(SyncReason reason) { sync = reason; }
  [[nodiscard]] Pose machine_position() const { return state.frame.to_machine(state.position); }
  /// Program coordinates of the tool, which cutter compensation keeps beside the programmed position.
  [[nodiscard]] Pose tool_position() const { return compensation.tool_position(state.position); }
  /// What #5420-#5428 and #<_x> are: tool_position(), or in the sub of a lathe cycle the end of its last move.
  [[nodiscard]] Pose shown_position() const;
  /// Offsets changed: the machine stands where it stood, its program coordinates are others.
  void set_frame(const CanonFrame& frame);
  /// Value of #number as the program sees it.
  [[nodiscard]] double parameter(int index) const;
  [[nodiscard]] bool evaluate(const ParsedBlock& b, const Expr& e, double& value);
  [[nodiscard]] bool read_named(std::uint32_t id, Value& value, bool& exists);
  [[nodiscard]] const CodeRow* row(char letter, int code) const;

  [[nodiscard]] bool logs(LogLevel level) const { return settings.log_level >= level; }
  /// "FILE:LINE: WHAT"; line 0: without.
  void log(std::string_view what, std::int32_t line = 0);
  /// A block in error.
  Outcome log_error();

  // --- program flow (flow.cpp) ---
  [[nodiscard]] Outcome run_flow(ParsedBlock& b);
  [[nodiscard]] Outcome continue_skip();
  [[nodiscard]] Outcome land(ParsedBlock& b);
  [[nodiscard]] Outcome skip_failed();
  [[nodiscard]] Outcome found(ParsedBlock& b);
  void search(ParsedBlock& b, Jump& jump, Label label, FlowMask stop_at);
  void start_skip(ParsedBlock& b, Label label, FlowMask stop_at);
  [[nodiscard]] bool flow_label(const ParsedBlock& b, Label& label);
  [[nodiscard]] bool flow_step(ParsedBlock& b, Label label, double condition);
  // --- statements without O-words (statements.cpp) ---
  [[nodiscard]] bool nested_step(ParsedBlock& b, bool condition);
  void enter_nested(const ParsedBlock& b, Flow kind);
  [[nodiscard]] Outcome look_for_line();
  void pass_line(std::string_view line);
  /// The part of an IF THEN ELSE that its condition chooses; null: core.fail() was called.
  [[nodiscard]] ParsedBlock* chosen_part(ParsedBlock& b);
  [[nodiscard]] bool run_while(ParsedBlock& b, Label label, bool condition);
  [[nodiscard]] bool loop_end_step(ParsedBlock& b, Label label);
  [[nodiscard]] bool label_problem(const char* help, const std::string& text);
  [[nodiscard]] LabelUse* label_use(Label label);
  [[nodiscard]] bool begin_label(ParsedBlock& b, Label label);
  [[nodiscard]] bool inside_label(ParsedBlock& b, Label label, FlowMask kinds);
  [[nodiscard]] bool undefined_label(const ParsedBlock& b);
  [[nodiscard]] bool right_use(ParsedBlock& b, Label label);
  [[nodiscard]] bool nested_sub();
  [[nodiscard]] bool passed_over(ParsedBlock& b);
  [[nodiscard]] bool define_sub(ParsedBlock& b, Label label);
  [[nodiscard]] bool end_sub(const ParsedBlock& b, double value);
  [[nodiscard]] bool call_sub(ParsedBlock& b, Label label);
  [[nodiscard]] bool right_call(const FileAndPlace& where);
  [[nodiscard]] bool find_and_enter(const ParsedBlock& b, Label label);
  bool not_found(const char* help, std::string_view file);
  [[nodiscard]] Outcome run_numbered(ParsedBlock& b);
  [[nodiscard]] bool numbered_alone(const Block& b);
  [[nodiscard]] bool call_numbered(ParsedBlock& b);
  [[nodiscard]] bool return_numbered();
  [[nodiscard]] bool end_or_restart();
  [[nodiscard]] bool enter_file_sub(std::uint32_t program);
  /// `link`: where to remember the sub's first block.
  [[nodiscard]] bool enter_sub(const Sub& sub, ParsedBlock** link);
  void leave_sub(bool has_value, double value);
  /// leave_sub(), and the modes of M73 again.
  [[nodiscard]] bool return_from_sub(bool has_value, double value);
  /// Interpreter::replace_tool_offset().
  void replace_tool_offset(const Pose& offset);
  void drop_frames();
  [[nodiscard]] Program* open_program(const std::string& path);
  std::uint32_t add_program(std::string path, std::unique_ptr<LineSource> source);
  [[nodiscard]] LineRead read_block(ParsedBlock*& b);
  [[nodiscard]] LineRead parse_line(std::uint32_t program, const Place& place, ParsedBlock& b);
  /// A lasting copy; null when there is no room.
  [[nodiscard]] ParsedBlock* cache_block(const ParsedBlock& b);
  void forget_blocks(std::uint32_t program);
  void forget_lines();

  // --- lathe cycles (codes/lathe.cpp) ---
  /// G70-G72: begins to read the profile from its sub.
  [[nodiscard]] bool begin_profile(const Block& b, int code);

  // --- remapped codes (remap_call.cpp) ---
  /// Bodies of remapped codes in progress: #<_remap_level>.
  [[nodiscard]] int remap_level() const;
  [[nodiscard]] bool feed_word(const Block& b);
  [[nodiscard]] bool speed_word(const Block& b);
  [[nodiscard]] bool tool_word(const Block& b);
  [[nodiscard]] bool set_local(std::string_view name, double value);
  [[nodiscard]] double local(std::string_view name, double otherwise);
  // --- functions in Python (script_run.cpp) ---
  ScriptHost* const scripts;  ///< null: the machine has none
  [[nodiscard]] bool is_script(std::string_view module, std::string_view function) const;
  /// Enters an O-word sub that is a function.
  [[nodiscard]] bool enter_function(const ParsedBlock& b, Label label);
  [[nodiscard]] bool run_statement(std::string_view text);
  /// Value of a named parameter that is a function.
  [[nodiscard]] bool script_parameter(const std::string& name, Value& value);

  /// Words of cycles made with cycle_prolog that stay from block to block, by code.
  std::map<int, std::array<std::optional<double>, kLetters>> sticky_words;

  const ParsedBlock* current{nullptr};
  [[nodiscard]] std::string_view current_file() const;
  [[nodiscard]] bool run_comment(const ParsedBlock& b);

 private:
  [[nodiscard]] Outcome execute_block(ParsedBlock& b);
  [[nodiscard]] bool build(const ParsedBlock& p, Block& b);
  [[nodiscard]] bool read_words(const ParsedBlock& p, Block& b);
  /// One block of a profile's sub, or the cycle when the sub is done.
  [[nodiscard]] Outcome profile_step();
  [[nodiscard]] bool profile_move(const Block& b);
  [[nodiscard]] Outcome run_profile();
  [[nodiscard]] Outcome next_compensated();
  [[nodiscard]] Outcome finish_cycle(const ProfileReading& p, bool good);
  [[nodiscard]] bool add_code(Block& b, char letter, double value, int code);
  [[nodiscard]] bool undefined_name(std::uint32_t id, std::size_t at);
  [[nodiscard]] bool position_unknown(std::size_t at);
  [[nodiscard]] bool no_number(std::size_t at, double value);
  [[nodiscard]] std::string nearest_codes(char letter, int code) const;
  [[nodiscard]] bool check_word(char name, double v);
  /// Some code of the block takes the text in quotes.
  [[nodiscard]] bool check_quoted(const ParsedBlock& p, Block& b);
  [[nodiscard]] std::shared_ptr<const std::string> quoted_text(std::uint32_t text) const;
  [[nodiscard]] bool assign(const ParsedBlock& p);
  [[nodiscard]] bool store(const ParsedBlock& p);
  [[nodiscard]] bool choose_motion(Block& b);
  [[nodiscard]] bool check_indexers(const Block& b);
  [[nodiscard]] bool check_letters(const Block& b);
  [[nodiscard]] bool run_rows(const Block& b);
  /// Does steps.next and what follows; `call`: the block goes on after a remapped code.
  [[nodiscard]] bool run_steps(const Block& b, Steps& steps, std::shared_ptr<RemapCall> call);
  void add_remaps();
  [[nodiscard]] std::shared_ptr<RemapCall> keep_block(const Block& b, const Steps& steps) const;
  [[nodiscard]] const Remap* remap_of(const Step& s) const;
  /// The innermost body of this remap that runs; null: none.
  [[nodiscard]] RemapCall* body_of(const Remap& r) const;
  [[nodiscard]] static bool has_builtin(const Step& s);
  [[nodiscard]] bool begin_remap(const Remap& r, const std::shared_ptr<RemapCall>& call);
  [[nodiscard]] bool check_remap_words(const Remap& r, const Block& b);
  void pass_remap_words(const Remap& r, const RemapCall& call);
  [[nodiscard]] bool enter_remap_sub(const Remap& r);
  [[nodiscard]] bool end_remap(Frame& body);
  [[nodiscard]] bool glue(const std::string& function, RemapCall& call);
  [[nodiscard]] Outcome resume_block();
  [[nodiscard]] Outcome execute_one();
  [[nodiscard]] Outcome execute_scripted();
  [[nodiscard]] Outcome go_on_script();
  [[nodiscard]] Outcome end_script(const ScriptStep& step, const std::shared_ptr<RemapCall>& call);
  [[nodiscard]] ScriptCall make_call(const Frame& f) const;
  [[nodiscard]] bool script_failed(const ScriptStep& step);
  void push_execute(const ScriptStep& step);
  [[nodiscard]] Outcome answer_error();
  [[nodiscard]] bool finish_return(bool has_value, double value);
  [[nodiscard]] Outcome finish_block(const ParsedBlock& p);
  [[nodiscard]] Outcome block_done();
  [[nodiscard]] Outcome next_repeat();
  [[nodiscard]] Outcome read_problem(LineRead r);
  [[nodiscard]] Outcome end_of_file();
  void expand_text(std::string_view text, std::string& result);
  void begin_block();
  /// For a block that changes modes in no case, or only after save_modes().
  void begin_flow();
  void save_modes();
  void undo_block();
  /// What an abort may write of the state: no way leads from it to `canon`.
  [[nodiscard]] ModalStore store() { return {state, params, settings.machine_unit_mm}; }
  bool set_error(std::size_t at, bool known, const char* help, const char* format,
                 std::va_list args);

  Parser parser_;
  Predefined predefined_;
  std::array<const CodeRow*, 1000> g_rows_{};
  std::array<const CodeRow*, 1000> m_rows_{};
  std::vector<CodeRow> remap_rows_;
  std::array<const Remap*, 3> remap_words_{};  ///< of f, s, t
  std::array<const char*, kLetters> unused_{};
  std::uint32_t block_program_{0};  ///< where the block in progress stands
  std::int32_t block_level_{0};
  std::int32_t main_line_{0};  ///< of the main program, executed last
  bool modes_saved_{false};
  std::int32_t line_before_{0};
  ModalState saved_;
  Tool saved_tool_;
  Block block_;
  ParsedBlock scratch_, chosen_;
  std::size_t cached_bytes_{0};
  std::string message_, held_text_;
  std::unique_ptr<CoreSelf> self_;
  ScriptAnswer answer_;
  bool attached_{false};
  std::string script_problem_;  ///< why the scripts cannot be used
  std::vector<std::pair<int, Value>> assigned_;
  friend class Interpreter;
};

}  // namespace kerf::interp
