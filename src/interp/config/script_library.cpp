#include "interp/config/script_library.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "interp/python/python_host.hpp"

namespace kerf::interp {

namespace {

namespace fs = std::filesystem;

constexpr const char* kLibrary = "kerf_interp_python.so";

/// Beside the programs, in ../lib; KERF_LIB names another folder.
std::string library_path() {
  if (const char* folder = std::getenv("KERF_LIB"); folder != nullptr && *folder != '\0')
    return std::string(folder) + "/" + kLibrary;
  std::error_code ec;
  const fs::path program = fs::read_symlink("/proc/self/exe", ec);
  return (program.parent_path().parent_path() / "lib" / kLibrary).string();
}

}  // namespace

rtapi::Result<std::unique_ptr<ScriptHost>> open_scripts(const PythonSettings& settings,
                                                        std::function<bool()> stopped) {
  if (settings.toplevel.empty()) return std::unique_ptr<ScriptHost>();
  const std::string path = library_path();
  // Global: modules in C that Python imports look for its symbols.
  void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
  void* make = library != nullptr ? ::dlsym(library, kMakePythonHost) : nullptr;
  if (make == nullptr) {
    const char* why = ::dlerror();
    return rtapi::fail(rtapi::Errc::not_found,
                       "[PYTHON]TOPLEVEL: Python cannot be loaded: " +
                           std::string(why != nullptr ? why : path.c_str()));
  }
  PythonOptions options;
  options.toplevel = settings.toplevel;
  options.path_prepend = settings.path_prepend;
  options.path_append = settings.path_append;
  options.log_level = settings.log_level;
  options.reload_on_change = settings.reload_on_change;
  options.stopped = std::move(stopped);
  return std::unique_ptr<ScriptHost>(reinterpret_cast<MakePythonHost>(make)(options));
}

}  // namespace kerf::interp
