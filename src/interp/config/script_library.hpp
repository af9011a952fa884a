// Loads embedded Python when a machine asks for it.
#pragma once

#include <functional>
#include <memory>

#include "interp/config/ini_settings.hpp"
#include "interp/script.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::interp {

/// Null when there is no [PYTHON]TOPLEVEL. `stopped` is asked while a function works, from the thread that called the interpreter:
/// true = the function is abandoned. The library stays loaded.
[[nodiscard]] rtapi::Result<std::unique_ptr<ScriptHost>> open_scripts(
    const PythonSettings& settings, std::function<bool()> stopped);

}  // namespace kerf::interp
