// Draws a tool path: top, front and isometric view in one SVG picture.
#pragma once

#include <string>
#include <vector>

#include "launcher/toolpath.hpp"

namespace kerf::launcher {

struct DrawingInfo {
  std::string title;     ///< name of the program
  std::string subtitle;  ///< what the run was, one line
};

/// The whole file. Feed moves are coloured by their programmed feed, rapids are thin, grey and dashed. Without pieces the
/// picture says that nothing moved.
[[nodiscard]] std::string draw_toolpath(const std::vector<PathPiece>& pieces,
                                        const DrawingInfo& info);

/// 1, 2 or 5 times a power of ten, so that about `count` steps make up `range` (> 0).
[[nodiscard]] double nice_step(double range, int count);

/// Colour of t in 0..1 as "#rrggbb": from dark blue by green to orange, of even brightness steps.
[[nodiscard]] std::string feed_colour(double t);

/// Text as it may stand in XML.
[[nodiscard]] std::string escape_xml(const std::string& text);

}  // namespace kerf::launcher
