// Positions as a program's words mean them.
#pragma once

#include <cmath>

#include "clients/common/stat.hpp"

namespace kerf::clients {

/// A machine position (stat.position, stat.actual_position) without the offsets that are in force: work coordinate system and its
/// rotation, G92, tool.
[[nodiscard]] inline rtapi::Pose work_position(const Stat& stat, const rtapi::Pose& position) {
  rtapi::Pose p = position - stat.g5x_offset - stat.tool_offset;
  const double angle = -stat.rotation_xy * M_PI / 180;
  const double x = p.x * std::cos(angle) - p.y * std::sin(angle);
  const double y = p.x * std::sin(angle) + p.y * std::cos(angle);
  p.x = x;
  p.y = y;
  return p - stat.g92_offset;
}

}  // namespace kerf::clients
