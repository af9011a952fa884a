// Reach: the steps of the time-optimal profile under velocity and acceleration limits.
//
//   beta_i = largest x at node i from which the rest of the path, to its stop, can be driven   (from the end; largest_x0)
//   x_i+1  = largest x reachable from x_i that is not above beta_i+1                           (from the start; range_of_x1)
// (0, 0) always satisfies every row and the sets are intervals, so the greedy second pass is optimal. The planner makes the first pass, the
// servo cycle the second one as it goes. The least x reachable is the hardest braking that stays on the path.
// Source: Pham and Pham, TOPP-RA (arXiv 1707.07239). Pure arithmetic, @rt.
#pragma once

#include <span>

#include "motion/core/path/limits.hpp"

namespace kerf::motion::path {

/// The largest x0 for which some x1 in [0, most] satisfies the rows.
[[nodiscard]] double largest_x0(std::span<const Row> rows, double most) noexcept;

struct Range {
  double low{0}, high{0};
};
/// The x1 that may follow x0. low below 0: the motion can stop before the end of the stretch.
/// `under_way`: the rows are those of the rest of a stretch that has been entered before.
[[nodiscard]] Range range_of_x1(std::span<const Row> rows, double x0,
                                bool under_way = false) noexcept;

}  // namespace kerf::motion::path
