// What an INI file says of the start of a machine: which programs, which HAL files, in which order.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "ini/ini_file.hpp"
#include "launcher/safe_state.hpp"

namespace kerf::launcher {

/// A HAL file or a single HAL command, and where the INI file asks for it.
struct HalStep {
  bool is_file{true};
  std::string text;  ///< absolute path, or the command
  ini::Position at;
  std::vector<std::string> arguments{};  ///< $argv of a Tcl file
  [[nodiscard]] bool is_tcl() const;     ///< for haltcl
};

struct LaunchPlan {
  std::string ini_path;  ///< absolute
  std::string ini_dir;   ///< working directory of everything that is started
  std::string machine_name;
  bool virtual_time{false};     ///< [KERF]CLOCK
  std::size_t segment_mb{64};   ///< [KERF]SEGMENT_MB
  std::string rt_cpus;          ///< [KERF]RT_CPUS, "" any
  std::string function_timing;  ///< [KERF]FUNCTION_TIMING: every, sampled or off
  std::string record_dir;       ///< [KERF]RECORD_DIR, absolute, "" the user's folder for such
  int record_keep{20};          ///< [KERF]RECORD_KEEP
  std::vector<std::string> record_pins;  ///< [KERF]RECORD_PIN
  std::vector<HalStep> modules;          ///< before the HAL files: [EMCMOT]HOMEMOD
  std::vector<HalStep> hal;              ///< [HAL]HALFILE in order, then [HAL]HALCMD in order
  std::string two_pass;          ///< [HAL]TWOPASS, "" off: how the HALFILEs of `hal` are done
  std::vector<HalStep> postgui;  ///< POSTGUI_HALFILE, then POSTGUI_HALCMD
  std::vector<HalStep> shutdown;
  std::string task_program{"milltask"};                 ///< [TASK]TASK
  std::string halui;                                    ///< [HAL]HALUI, "" none
  std::vector<std::string> display;                     ///< [DISPLAY]DISPLAY in words, empty: none
  std::vector<std::string> applications;                ///< [APPLICATIONS]APP, command lines
  double applications_delay_s{0};                       ///< [APPLICATIONS]DELAY
  std::vector<SafePin> safe_pins;                       ///< [SAFE_STATE]PIN
  std::vector<std::vector<std::string>> safe_commands;  ///< [SAFE_STATE]COMMAND, in words
  std::string open_file;                                ///< [DISPLAY]OPEN_FILE, absolute, "" none
  std::vector<ini::Diagnostic> diagnostics;
  bool ok{false};  ///< no error among the diagnostics
};

/// Where HAL files are looked for besides the INI's folder.
struct HalSearch {
  std::vector<std::string> first;    ///< -H
  std::vector<std::string> library;  ///< for LIB:name, and last for all others
};

/// The steps for "MODULE a=b" of [EMCMOT]HOMEMOD or -m: none for homemod, which is motmod's own homing.
[[nodiscard]] std::vector<HalStep> homing_steps(const std::string& words, const ini::Position& at);

/// Reads the sections that the launcher owns, and holds all keys against the table of keys. Missing files, bad values
/// and unknown keys become diagnostics with file and line.
[[nodiscard]] LaunchPlan make_plan(const ini::IniFile& file, const HalSearch& search);

/// Words of the program that turns a file of this kind into G-code ([FILTER]), without the file itself; empty: it is G-code.
[[nodiscard]] std::vector<std::string> filter_for(const ini::IniFile& file,
                                                  const std::string& program);

/// "~/x", "x" and "/x" as seen from `dir`.
[[nodiscard]] std::string resolve_from(const std::string& dir, const std::string& path);

/// Words of a command line: blanks separate, quotes of both kinds keep blanks.
[[nodiscard]] std::vector<std::string> split_words(const std::string& text);

}  // namespace kerf::launcher
