// The programs `inivalue` and `inivar`: INI values for scripts. Their output, messages and exit
// codes are an interface that users' scripts parse; they follow the newest LinuxCNC's.
#pragma once

#include <string>
#include <vector>

namespace kerf::ini {

/// Exit codes of both programs.
enum class InivalueExit : int {
  found = 0,
  bad_call = 1,   ///< a bad option, or a file that cannot be read or has an error
  not_found = 2,  ///< no such section, key or instance
  bad_value = 3,  ///< there, but not convertible to --type or out of range
};

/// What a run prints and returns.
struct CommandOutput {
  int exit_code{0};
  std::string out;
  std::string err;
};

/// `inivalue [--var=V] [--sec=S] [--num=N | --all] [--type=i|u|r|s|b] ... FILE`; `args` without the
/// program's name.
[[nodiscard]] CommandOutput run_inivalue(const std::vector<std::string>& args);

/// `inivar -var V [-sec S] [-num N] [-ini FILE] [-tildeexpand]`; FILE defaults to emc.ini.
[[nodiscard]] CommandOutput run_inivar(const std::vector<std::string>& args);

}  // namespace kerf::ini
