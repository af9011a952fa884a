#include "launcher/environment.hpp"

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace kerf::launcher {

namespace fs = std::filesystem;

Installation find_installation(const std::string& exe) {
  Installation out;
  std::error_code ignored;
  const fs::path bin = fs::weakly_canonical(exe, ignored).parent_path();
  out.bin = bin.string();
  out.python = (bin.parent_path() / "python").string();
  out.tcl = (bin.parent_path() / "tcl").string();
  out.components = (bin.parent_path() / "components").string();
  const fs::path source = bin.parent_path().parent_path().parent_path();
  for (const fs::path& dir : {bin.parent_path() / "nc_files", source / "nc_files"})
    if (out.nc_files.empty() && fs::is_directory(dir, ignored)) out.nc_files = dir.string();
  // Installed: lib/kerf/{bin,hallib}; in the source tree: build/PRESET/bin and configs/hallib.
  for (const fs::path& dir : {bin.parent_path() / "hallib", source / "configs" / "hallib"})
    if (fs::is_directory(dir, ignored)) out.hallib.push_back(dir.string());
  return out;
}

Installation find_installation() {
  std::error_code ignored;
  return find_installation(fs::read_symlink("/proc/self/exe", ignored).string());
}

void prepend_variable(const char* name, const std::string& first, char separator) {
  const char* old = std::getenv(name);
  const std::string rest = old == nullptr ? "" : old;
  if (rest == first || rest.rfind(first + separator, 0) == 0) return;
  setenv(name, (rest.empty() ? first : first + separator + rest).c_str(), 1);
}

void set_environment(const Installation& installation, const RunEnvironment& run) {
  setenv("KERF_INSTANCE", run.instance.c_str(), 1);
  setenv("KERF_RUN_ID", run.run_id.c_str(), 1);
  setenv("KERF_SUPERVISOR_FD", std::to_string(run.supervisor_fd).c_str(), 1);
  if (run.rt_cpus.empty())
    unsetenv("KERF_RT_CPUS");
  else
    setenv("KERF_RT_CPUS", run.rt_cpus.c_str(), 1);
  setenv("KERF_FUNCTION_TIMING", run.function_timing.c_str(), 1);
  setenv("INI_FILE_NAME", run.ini_path.c_str(), 1);
  setenv("CONFIG_DIR", run.ini_dir.c_str(), 1);
  if (!installation.hallib.empty()) setenv("HALLIB_DIR", installation.hallib.front().c_str(), 1);
  std::string hal_path;
  for (const auto* dirs : {&run.hal_path, &installation.hallib})
    for (const std::string& dir : *dirs) hal_path += (hal_path.empty() ? "" : ":") + dir;
  setenv("HALLIB_PATH", hal_path.c_str(), 1);
  // What scripts of LinuxCNC's configurations look up.
  setenv("REALTIME", (installation.bin + "/realtime").c_str(), 1);
  setenv("HAL_RTMOD_DIR", installation.components.c_str(), 1);
  setenv("HALCMD", "halcmd", 1);
  setenv("LINUXCNC_HOME", fs::path(installation.bin).parent_path().c_str(), 1);
  if (!installation.nc_files.empty())
    setenv("LINUXCNC_NCFILES_DIR", installation.nc_files.c_str(), 1);
  prepend_variable("PATH", installation.bin, ':');
  // A configuration's own programs.
  prepend_variable("PATH", run.ini_dir + "/bin", ':');
  prepend_variable("PYTHONPATH", installation.python, ':');
  prepend_variable("TCLLIBPATH", installation.tcl, ' ');
}

}  // namespace kerf::launcher
