// HAL files in Tcl: one after the other, or all together in two passes ([HAL]TWOPASS).
//
//   hal::tcl::ScriptRunner runner(words, &ini);
//   if (!runner.run_file({"mill.tcl", {"-spindle", "1"}})) ...            // the error is on stderr, with file and line
//   if (!runner.run_two_pass(files, {.verbose = true})) ...
#pragma once

#include <tcl.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/tcl/tcl_hal.hpp"
#include "ini/ini_file.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal::tcl {

/// A HAL file and, for Tcl, its $argv.
struct HalFile {
  std::string path;
  std::vector<std::string> arguments;
};

/// What [HAL]TWOPASS says besides "on".
struct TwoPassOptions {
  bool verbose{false};
  static TwoPassOptions parse(std::string_view text);
};

/// True for names that end in .tcl.
bool is_tcl_file(std::string_view path);

class Interpreter {
 public:
  /// Tcl with its library, HAL's commands, and the INI file's arrays.
  static rtapi::Result<std::unique_ptr<Interpreter>> create(TclHal& words, const ini::IniFile* ini);
  ~Interpreter();
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  void set_arguments(const std::string& program, const std::vector<std::string>& arguments);
  /// `::tp::passnumber` tells a script in which of two passes it is; without two passes there is no such command.
  void set_pass_number(int number);
  /// `exit` becomes an error: other HAL files are still to be done.
  void forbid_exit();
  /// The error has "FILE:LINE: " before Tcl's message and its trace after it.
  rtapi::Result<void, std::string> run_file(const std::string& path);
  [[nodiscard]] Tcl_Interp* tcl() const { return interpreter_; }

 private:
  explicit Interpreter(Tcl_Interp* interpreter) : interpreter_(interpreter) {}
  Tcl_Interp* interpreter_;
};

class ScriptRunner {
 public:
  /// `ini` may be null. Errors, and what .hal files print, go to `sink`; null: stderr and stdout. All outlive the runner.
  ScriptRunner(TclHal& words, const ini::IniFile* ini, CommandSink* sink = nullptr);

  /// $argv0 of scripts.
  void set_program(std::string name) { program_ = std::move(name); }
  /// `exit` within a script is an error. For programs that go on after it.
  void set_exit_forbidden(bool on) { exit_forbidden_ = on; }

  bool run_file(const HalFile& file);
  /// All files, .hal and .tcl: see HAL files in two passes in docs/configuration.md.
  bool run_two_pass(std::span<const HalFile> files, const TwoPassOptions& options);

 private:
  bool run_pass(std::span<const HalFile> files, Pass pass);
  bool run_excluded(std::span<const HalFile> files);
  bool run_merged();
  rtapi::Status read_hal_file(const std::string& path);
  rtapi::Status do_line(const std::string& line, const Place& at);
  rtapi::Status do_words(std::vector<std::string> words, const std::string& line, const Place& at);
  rtapi::Result<Commander*> halcmd();
  bool failed(const std::string& text);
  void detail(const std::string& text) const;

  TclHal& words_;
  const ini::IniFile* ini_;
  CommandSink default_sink_;
  CommandSink* sink_;
  std::unique_ptr<Commander> halcmd_;  ///< for the lines of .hal files
  std::string program_{"haltcl"};
  bool exit_forbidden_{false};
  bool verbose_{false};
  int depth_{0};
  IniLookup lookup_;
};

}  // namespace kerf::hal::tcl
