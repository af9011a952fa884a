// Which pins halui has on a machine, from its INI file.
#pragma once

#include "clients/halui/halui.hpp"
#include "ini/ini_file.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::clients::halui {

/// bad_argument: no usable [KINS]JOINTS or [TRAJ]COORDINATES. More than MdiButtons::kMost MDI_COMMANDs is one too, since a pin that
/// a HAL file names would be missing.
[[nodiscard]] rtapi::Result<Layout> read_layout(const ini::IniFile& ini);

}  // namespace kerf::clients::halui
