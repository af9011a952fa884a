// What makes good the errors of a joint's screw: [JOINT_n]COMP_FILE. Written by task before the machine's limits, read by motion.
#pragma once

#include <algorithm>
#include <cstdint>

namespace kerf::motion {

/// At the joint's position `at` the motor stands this much farther, when the joint came there going up or down. mm or degrees.
struct ScrewPoint {
  double at{0}, up{0}, down{0};
};

struct ScrewTable {
  static constexpr std::int32_t kMost = 256;
  std::int32_t count{0};  ///< 0: none, and BACKLASH counts
  std::int32_t reserved{0};
  ScrewPoint point[kMost];
};

/// @rt. Between points on a straight line, beyond the ends as at the ends. `direction`: below 0 going down.
[[nodiscard]] inline double screw_correction(const ScrewTable& table, double at,
                                             int direction) noexcept {
  if (table.count <= 0 || direction == 0) return 0;
  const auto value = [direction](const ScrewPoint& p) { return direction > 0 ? p.up : p.down; };
  const ScrewPoint* const begin = table.point;
  const ScrewPoint* const end = begin + std::min(table.count, ScrewTable::kMost);
  const ScrewPoint* const next =
      std::upper_bound(begin, end, at, [](double x, const ScrewPoint& p) { return x < p.at; });
  if (next == begin) return value(*begin);
  if (next == end) return value(*(end - 1));
  const ScrewPoint& before = *(next - 1);
  const double share = (at - before.at) / (next->at - before.at);
  return value(before) + share * (value(*next) - value(before));
}

}  // namespace kerf::motion
