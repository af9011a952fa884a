// The command line of kerf.
#pragma once

#include <string>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::launcher {

/// Exit codes of kerf, as --help documents them.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;
inline constexpr int kExitUsage = 2;

struct Options {
  std::string ini;
  std::string program;        ///< G-code file, or "": [DISPLAY]OPEN_FILE with --once
  std::string instance;       ///< "": KERF_INSTANCE or the user's default
  std::string log_joints;     ///< file, or "": none
  std::string homing_module;  ///< -m: module and its parameters, instead of [EMCMOT]HOMEMOD
  std::string svg;            ///< file, or "": toolpath.svg in the current directory
  std::vector<std::string>
      hal_dirs;     ///< -H, searched before the INI's folder, the last given first
  double speed{0};  ///< virtual seconds per real one; 0: as fast as can be
  bool once{false};
  bool virtual_time{false};
  bool check_only{false};         ///< `kerf check INI`
  bool resume{false};             ///< `kerf resume INI`
  bool resume_run{false};         ///< ... --run
  bool ignore_hal_errors{false};  ///< -k
  bool last_used{false};          ///< -l: the INI file of the last start
  bool verbose{false};
};

/// Why there is nothing to run: --help, --version (code 0, text for stdout) or wrong use (code 2, text for stderr).
struct ParseEnd {
  int exit_code{kExitUsage};
  std::string text;
};

/// File that keeps the INI file of the last start, for -l: $XDG_STATE_HOME/kerf/last-ini, ~/.local/state when that is not set.
[[nodiscard]] std::string last_ini_file();
/// Notes it; where that is not possible nothing is noted.
void remember_ini(const std::string& ini);

/// `arguments` without the program's name. File names come out absolute, as seen from the current directory.
[[nodiscard]] rtapi::Result<Options, ParseEnd> parse_options(std::vector<std::string> arguments);

}  // namespace kerf::launcher
