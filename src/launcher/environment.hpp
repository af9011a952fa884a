// Where the installed parts are, and what children find in their environment.
#pragma once

#include <string>
#include <vector>

namespace kerf::launcher {

/// Folders beside the running program.
struct Installation {
  std::string bin;                  ///< programs
  std::string python;               ///< Python modules
  std::string tcl;                  ///< Tcl packages
  std::string components;           ///< HAL components
  std::string nc_files;             ///< sample programs, "" none
  std::vector<std::string> hallib;  ///< HAL file library, those that exist
};

/// From the folder that has the program `exe` (symbolic links resolved).
[[nodiscard]] Installation find_installation(const std::string& exe);
/// Of this process.
[[nodiscard]] Installation find_installation();

/// Puts `first` before what the variable holds, unless it stands first already.
void prepend_variable(const char* name, const std::string& first, char separator);

struct RunEnvironment {
  std::string instance;
  std::string run_id;
  std::string ini_path;
  std::string ini_dir;
  std::string rt_cpus;
  std::string function_timing;
  int supervisor_fd{-1};
  std::vector<std::string> hal_path{};  ///< HAL files are looked for here before the library
};

/// Sets it all in this process, for every child to inherit.
void set_environment(const Installation& installation, const RunEnvironment& run);

}  // namespace kerf::launcher
