// What an INI file says to the interpreter: [RS274NGC], [PYTHON], [DISPLAY]PROGRAM_PREFIX and [WIZARD]WIZARD_ROOT.
// One reader for task and for rs274 -i. Manual: "[RS274NGC] Section", "Remap Extending G-code".
//
// The interpreter itself knows no INI file; this is a library beside it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ini/reader.hpp"
#include "interp/environment.hpp"

namespace kerf::interp {

/// Where programs, subs and user M-codes are found, and parameters kept. All absolute.
struct ProgramPaths {
  std::string ini_dir;
  std::string program_prefix;                ///< [DISPLAY]PROGRAM_PREFIX, or INI_DIR/nc_files
  std::vector<std::string> user_m_path;      ///< [RS274NGC]USER_M_PATH
  std::vector<std::string> subroutine_path;  ///< [RS274NGC]SUBROUTINE_PATH
  std::string wizard_root;                   ///< [WIZARD]WIZARD_ROOT, "" without
  std::string parameter_file;                ///< "" without
};

/// [PYTHON]; paths absolute.
struct PythonSettings {
  std::string toplevel;  ///< "": the machine has no Python
  std::vector<std::string> path_prepend, path_append;
  int log_level{0};
  bool reload_on_change{false};
};

struct InterpSetup {
  Settings settings;
  ProgramPaths paths;
  PythonSettings python;
  std::string startup_code;      ///< RS274NGC_STARTUP_CODE
  std::string on_abort_command;  ///< ON_ABORT_COMMAND: an O-word call without arguments
};

/// Complaints go to the reader. `unit_mm`: mm per machine unit. Other members of Settings ([TRAJ], [EMCIO]) stay at their defaults.
[[nodiscard]] InterpSetup read_interp_setup(ini::Reader& reader, double unit_mm);

/// File NAME.ngc that defines a sub: PROGRAM_PREFIX, SUBROUTINE_PATH in its order, WIZARD_ROOT; "" when there is none.
[[nodiscard]] std::string find_sub_file(const ProgramPaths& paths, std::string_view name);

/// "~/x", "x" and "/x" as seen from the INI file's folder.
[[nodiscard]] std::string resolve_path(const std::string& ini_dir, const std::string& path);

}  // namespace kerf::interp
