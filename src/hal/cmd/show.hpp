// The texts of halcmd's show, list and status. Scripts parse them: the columns are those of the newest LinuxCNC.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "hal/core/view.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// `item` "" or "all": everything. `script`: -s, without titles and padding.
rtapi::Result<std::string> show_text(const View& view, std::string_view item,
                                     std::span<const std::string> patterns, bool script);
rtapi::Result<std::string> list_text(const View& view, std::string_view item,
                                     std::span<const std::string> patterns);
/// `item` "" or "all", "lock", "mem".
rtapi::Result<std::string> status_text(const View& view, std::string_view item);

}  // namespace kerf::hal
