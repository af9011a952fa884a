// halcmd save: HAL as the commands that make it.
#pragma once

#include <string>
#include <string_view>

#include "hal/core/view.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// `item`: comp, alias, sig (signal), sigu, link, linka, net, neta, netl, netla (netal), param (parameter), unconnectedinpins,
/// thread; "" or "all": comp, alias, sigu, netla, param, thread; allu: also unconnectedinpins.
rtapi::Result<std::string> save_text(const View& view, std::string_view item);

}  // namespace kerf::hal
