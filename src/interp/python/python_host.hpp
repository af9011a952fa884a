// The library kerf_interp_python.so: a ScriptHost over an embedded CPython. It is loaded with dlopen() when a machine has
// [PYTHON]TOPLEVEL; no program links Python. Manual: "Remap Extending G-code".
//
// Python runs on a thread of its own, so that code that hangs can be left alone: the caller waits for it, and goes away when
// `stopped()` says so. One Python per process: several hosts share its modules.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "interp/script.hpp"

namespace kerf::interp {

struct PythonOptions {
  std::string toplevel;  ///< path of the script that imports remap, oword, namedparams
  std::vector<std::string> path_prepend, path_append;
  int log_level{0};
  bool reload_on_change{false};
  std::function<bool()> stopped;  ///< asked while Python works: true = abandon it
};

/// What the library exports as kMakePythonHost.
using MakePythonHost = ScriptHost* (*)(const PythonOptions& options);
inline constexpr const char* kMakePythonHost = "kerf_make_python_host";

}  // namespace kerf::interp
