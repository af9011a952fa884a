// The least time on a curve under velocity, acceleration and jerk limits, offline: an independent measure for the planner.
//
// x = (dsigma/dt)^2 at the nodes of a fine grid; u = x'/2 between nodes, w = u' at nodes. With p = q', e = q'', c = q''':
//   velocity  x <= cap      acceleration  |p u + e x| <= A      jerk  |p w + 3 e u + c x| <= J x^-1/2
// and the time is the sum of 2 D / (sqrt(x0) + sqrt(x1)). A feasible primal-dual interior-point method: any profile driven slowly enough is feasible, the
// right side of the jerk rows is convex, so that a step within its tangent stays feasible, and the matrix has five diagonals.
// Next to a stop jerk is constant: D = j t^3 / 6. The planner's own sources share nothing with it but the curve.
// Sources: Verscheure et al., Time-optimal path tracking (2009); Nocedal and Wright, Numerical Optimization, ch. 19.
#pragma once

#include <cstddef>
#include <vector>

namespace kerf::bench {

/// Axes and the joints that mix them; what stands still has no rows.
inline constexpr std::size_t kOptimumJoints = 8;

/// The curve at one place of the grid and on the way from there to the next one.
struct CurveNode {
  double p[kOptimumJoints]{}, e[kOptimumJoints]{}, c[kOptimumJoints]{};  ///< q', q'', q'''
  double p_mid[kOptimumJoints]{}, e_mid[kOptimumJoints]{};  ///< half way to the next node
  double way{0};                                            ///< to the next node; 0: the last one
  double cap{0};                                            ///< of x
};

struct JointLimits {
  double acc[kOptimumJoints]{}, jerk[kOptimumJoints]{};
};

struct JerkOptimum {
  double seconds{0};
  double gap_s{0};  ///< by which the interior-point method may still be off
  int iterations{0};
  std::vector<double> x;  ///< at the nodes
};

/// From rest at the first node to rest at the last; at least four nodes.
[[nodiscard]] JerkOptimum jerk_optimum(const std::vector<CurveNode>& nodes,
                                       const JointLimits& limits);

}  // namespace kerf::bench
