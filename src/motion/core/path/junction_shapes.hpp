// Shapes of the blend where two curves meet, for the least jerk within the tolerance. Pure arithmetic.
//
// Over a blend from -l to l, x = u/l, q'' is that of the two curves without their jump, plus kink E(x)/l + jump O(x): `kink` is the jump of q', which an
// even function E of area 1 spreads, and `jump` that of q'', which an odd function O leads from -1/2 to 1/2 with the step's first moment. So place, direction
// and curvature go on at both ends. Both are linear between five knots, so jerk is the steepest part of them. A kink and a jump together have the
// least jerk within P with functions that go to and fro about the programmed path as often as pays; which they are depends on the two and on the room.
// Those of the table are the solutions of a linear program for many of these (tests/bench/motion/junction_shapes.py), of which these are
// passed at 0.97 of the best speed at worst and at all of it in the mean; with as many knots as one likes another 1 to 4 % could be had.
#pragma once

#include <array>
#include <cstddef>

namespace kerf::motion::path {

/// x of the knots from the vertex on.
inline constexpr std::array<double, 5> kJunctionKnots{0, 0.2, 0.5, 0.8, 1};

/// E and O at the knots.
struct JunctionShape {
  std::array<double, kJunctionKnots.size()> even{}, odd{};
};

/// What meets, each as a share of what is allowed: `kink` times mm are deviations as shares of the tolerance, and so on.
struct JunctionNeeds {
  double kink_off{0}, jump_off{0};
  double kink_acc{0}, jump_acc{0}, bend_acc{0};  ///< bend: of the curves themselves
  double kink_jerk{0}, jump_jerk{0};
  double reach{0};  ///< l at most
};

struct JunctionChoice {
  JunctionShape shape;
  double l{0};
};

/// The shape that is passed fastest, and the l at which it uses up the tolerance. Kink and jump are taken to point the same way.
[[nodiscard]] JunctionChoice choose_junction_shape(const JunctionNeeds& needs) noexcept;

}  // namespace kerf::motion::path
