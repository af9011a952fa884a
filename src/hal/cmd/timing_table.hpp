// What `halcmd timing` prints.
#pragma once

#include <span>
#include <string>

#include "hal/core/view.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// Threads and functions whose names begin with or match one of the patterns. `script`: without titles and remarks.
rtapi::Result<std::string> timing_text(const View& view, std::span<const std::string> patterns,
                                       bool script);
rtapi::Result<std::string> timing_json(const View& view, std::span<const std::string> patterns);

}  // namespace kerf::hal
