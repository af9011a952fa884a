// ScriptHost: functions in another language (Python) that a machine may use as bodies of remapped codes, as O-word subs, in
// comments and as named parameters. The interpreter knows only this interface; src/interp/python implements it.
//
// A function runs like a coroutine: it works until it ends, asks for lines of G-code to be executed (`self.execute`) or for all
// queued work to be finished (`yield INTERP_EXECUTE_FINISH`); then the interpreter does that, block by block as always, and lets
// it go on. While a function works it may use `ScriptSelf`, and the interpreter does nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf::interp {

/// One argument of a canonical call made by a function.
struct ScriptArgument {
  double number{0};
  std::string text;
};

/// A number with the type that Python shows.
struct ScriptNumber {
  enum class Kind : std::uint8_t { real, integer, boolean } kind{Kind::real};
  double value{0};
};

struct ScriptTool {
  int number{-1}, pocket{-1};
  double offset[9]{};  ///< as the tool table has them, machine units
  double diameter{0}, front_angle{0}, back_angle{0};
  int orientation{0};
};

/// What a function sees of the interpreter: `self`. Lengths in program units as in the program. Unknown names: nullopt, false.
class ScriptSelf {
 public:
  virtual ~ScriptSelf() = default;
  /// Attribute of the documented name ("current_x"); `index` for arrays ("speed").
  [[nodiscard]] virtual std::optional<ScriptNumber> number(std::string_view name, int index) = 0;
  [[nodiscard]] virtual bool set_number(std::string_view name, int index, double value) = 0;
  [[nodiscard]] virtual std::optional<std::string> text(std::string_view name) = 0;
  /// All names of the attributes.
  [[nodiscard]] virtual std::vector<std::string_view> names() = 0;
  /// Numbered and named parameters.
  [[nodiscard]] virtual std::optional<double> parameter(int index) = 0;
  [[nodiscard]] virtual bool set_parameter(int index, double value) = 0;
  [[nodiscard]] virtual std::optional<double> parameter(std::string_view name) = 0;
  [[nodiscard]] virtual bool set_parameter(std::string_view name, double value) = 0;
  [[nodiscard]] virtual std::vector<std::string> parameter_names() = 0;
  /// Word of the block that holds the remapped code of a level (1 is the outermost), or of the present call (0).
  [[nodiscard]] virtual std::optional<double> word(int level, char letter) = 0;
  /// Of that block: "comment", "o_name", "text".
  [[nodiscard]] virtual std::string block_text(int level, std::string_view what) = 0;
  /// Of that block: "line_number", "n_number", "motion_to_be", "builtin_used"; g_modes and m_modes by `index`.
  [[nodiscard]] virtual std::optional<ScriptNumber> block_number(int level, std::string_view what,
                                                                 int index) = 0;
  /// Of a sub in progress (0 is the main program): "subname", "filename".
  [[nodiscard]] virtual std::optional<std::string> call_text(int level, std::string_view what) = 0;
  [[nodiscard]] virtual std::optional<ScriptTool> tool(int number) = 0;
  [[nodiscard]] virtual ScriptTool tool_in_spindle() = 0;
  /// A canonical function by its name. Returns why it cannot be made, or "".
  [[nodiscard]] virtual std::string canon(std::string_view name,
                                          const std::vector<ScriptArgument>& arguments) = 0;
  /// Names that canon() knows.
  [[nodiscard]] virtual std::vector<std::string_view> canon_names() = 0;
  /// One of the standard glue functions that are built in. Returns the error, or "".
  [[nodiscard]] virtual std::string glue(std::string_view function) = 0;
  virtual void set_error(std::string text) = 0;
  [[nodiscard]] virtual std::string error_text() = 0;
};

struct ScriptCall {
  std::string module;  ///< remap, oword, namedparams
  std::string function;
  std::vector<std::pair<std::string, double>> words;  ///< keyword arguments
  std::vector<double> arguments;                      ///< positional ones
};

/// Where a function has come to.
struct ScriptStep {
  enum class Kind : std::uint8_t {
    done,
    execute,  ///< wants `text` executed; then resume()
    finish,   ///< wants all queued work done and the interpreter synchronised; then resume()
    failed,   ///< ended with the error `text`; `help` tells more (the traceback)
  } kind{Kind::done};
  std::optional<double> value;  ///< done: what it returned
  bool finish_first{false};     ///< done: finish all queued work before going on
  std::string text, help;
  int line{0};  ///< execute: line number to show, 0: none was given
};

/// What became of execute().
struct ScriptAnswer {
  bool good{true};
  std::string error, line_text;
  int line{0};
};

/// Calls nest: the last one that was started goes on first.
class ScriptHost {
 public:
  virtual ~ScriptHost() = default;
  /// The interpreter is ready; runs __init__ of the TOPLEVEL script. The error, or "". `self` must outlive detach().
  [[nodiscard]] virtual std::string attach(ScriptSelf& self) = 0;
  /// Runs __delete__.
  virtual void detach() = 0;
  [[nodiscard]] virtual bool has(std::string_view module, std::string_view function) = 0;
  [[nodiscard]] virtual ScriptStep call(ScriptCall call) = 0;
  [[nodiscard]] virtual ScriptStep resume(const ScriptAnswer& answer) = 0;
  /// A statement (;py,...), at once. It cannot execute G-code.
  [[nodiscard]] virtual ScriptStep run(std::string_view statement) = 0;
  /// Ends all calls in progress, if need be without their consent.
  virtual void abandon() = 0;
};

}  // namespace kerf::interp
