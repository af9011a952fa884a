// Where a nine-axis point is drawn in three dimensions: the [DISPLAY]GEOMETRY of screens.
#pragma once

#include <array>
#include <string_view>

#include "rtapi/base/pose.hpp"

namespace kerf::python {

/// `geometry`: letters of the axes from the work to the tool, each with - when it turns or moves the other way ("XYZ", "AXYZ",
/// "-XYZ"). Other letters are left out.
[[nodiscard]] std::array<double, 3> vertex(std::string_view geometry, const rtapi::Pose& point);

}  // namespace kerf::python
