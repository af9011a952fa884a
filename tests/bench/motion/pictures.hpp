// Pictures: what the planner does, drawn as SVG for docs/planner.md.
#pragma once

#include <string>

namespace kerf::bench {

/// Writes corner.svg, fractal.svg, stream.svg and profile.svg into the folder. False: it cannot be written to.
[[nodiscard]] bool draw_pictures(const std::string& folder);

}  // namespace kerf::bench
