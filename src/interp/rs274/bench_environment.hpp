// BenchEnvironment: files and tools for an interpreter without a machine (rs274, tests).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "interp/environment.hpp"
#include "interp/interpreter.hpp"
#include "interp/program_log.hpp"
#include "interp/text_canon.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::interp {

/// What rs274 starts with when there is no INI file: a machine XYZABC that counts in inches, programs in mm.
[[nodiscard]] Settings bench_settings();

/// What the world did while a block waited, when there is no machine: what was asked for has happened. A probe move from
/// `start` (program coordinates) touches nothing and stops .01 inch before its end, as the peer's rs274 has it.
[[nodiscard]] ExternalState bench_answer(const Interpreter& interpreter, const Pose& start,
                                         TextCanon& canon);

/// Subs are searched as NAME.ngc (as written, then NAME without suffix) in the given directories; there are no
/// M-code programs and no HAL.
class BenchEnvironment final : public Environment {
 public:
  void add_directory(std::string directory) { directories_.push_back(std::move(directory)); }
  /// Reads a tool table in the documented form "T1 P1 X0 Z1 D.25 I0 J0 Q0 ;comment"; lengths times unit_mm are mm.
  [[nodiscard]] rtapi::Status load_tools(const std::string& path, double unit_mm);
  void set_tool(const Tool& tool) { tools_[tool.number] = tool; }

  /// What #<_ini[section]key> reads.
  using IniReader = std::function<std::optional<double>(std::string_view, std::string_view)>;
  void set_ini(IniReader ini) { ini_ = std::move(ini); }

  /// Where log() goes; without: nowhere.
  void set_log(const Settings& settings) { log_ = std::make_unique<ProgramLog>(settings); }
  void log(std::string_view line) override {
    if (log_ != nullptr) log_->write(line);
  }

  void set_scripts(ScriptHost* scripts) { scripts_ = scripts; }
  [[nodiscard]] ScriptHost* scripts() override { return scripts_; }

  [[nodiscard]] std::optional<Tool> find_tool(int number) override;
  [[nodiscard]] std::optional<Tool> find_pocket(int pocket) override;
  [[nodiscard]] std::string find_sub(std::string_view name) override;
  /// To standard error.
  void warning(std::string_view text) override;
  [[nodiscard]] std::optional<double> ini_value(std::string_view section,
                                                std::string_view key) override {
    return ini_ ? ini_(section, key) : std::nullopt;
  }

 private:
  std::vector<std::string> directories_;
  std::map<int, Tool> tools_;
  IniReader ini_;
  ScriptHost* scripts_{nullptr};
  std::unique_ptr<ProgramLog> log_;
};

}  // namespace kerf::interp
