// Boxes: jerk limits along a path. Pure arithmetic, @rt.
//
// With v = dsigma/dt, a = dv/dt and j = da/dt the jerk of an axis is q' j + 3 q'' v a + q''' v^3, its acceleration q' a + q'' v^2. On a stretch
// the pieces get a box |v| <= V, |a| <= A, |j| <= J such that
//   |q'| A + |q''| V^2 <= acceleration limit        |q'| J + 3 |q''| V A + |q'''| V^3 <= jerk limit
// with the largest |q'|, |q''| and |q'''| on the stretch. So whatever motion stays within the box keeps all limits of all axes on the
// whole stretch, and differences of positions at any sampling keep them too as long as q'' goes on without jumps: the third difference
// is an average of the third derivative. A and J are the same over neighbouring pieces (a region), so that they change seldom; each
// stretch has a V of its own. Long straights and arcs are regions of their own; on a straight A and J are all that the axes can do.
#pragma once

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"

namespace kerf::motion::path {

struct Box {
  double acc{0}, jerk{0};  ///< of sigma
};

/// The largest rates, curls and twists of joints on a stretch (joint_curve.hpp), beside their limits.
struct JointBends {
  struct Row {
    double p{0}, e{0}, c{0}, acc{0}, jerk{0};
  };
  std::size_t count{0};
  Row row[kMostJoints];
  /// Those of another stretch besides.
  void join(const JointBends& other) noexcept;
};
/// Largest v^2 for which the box keeps the acceleration and jerk limits of the joints.
[[nodiscard]] double box_cap(const JointBends& joints, const Box& box) noexcept;

/// Straights only: what all axes can do.
[[nodiscard]] Box straight_box(const Piece& piece, const AxisLimits& limits) noexcept;
/// Largest v^2 on [s0, s1] for which the box keeps the acceleration and jerk limits of all axes (not their velocities).
[[nodiscard]] double box_cap(const Piece& piece, double s0, double s1, const Box& box,
                             const AxisLimits& limits) noexcept;

/// Whether it takes less time to stand between two moves than to drive through a blend that takes `l` of each and may be passed at `speed`.
/// Both moves are taken as if they began and ended alike. `by_law`: by a time law, else in boxes.
[[nodiscard]] bool faster_to_stop(const Piece& a, const Piece& b, double l, double speed,
                                  const AxisLimits& limits, bool by_law) noexcept;
/// The speed at which blend pieces can be passed evenly; in boxes with something left for speeding up.
[[nodiscard]] double even_speed(const Piece* pieces, std::size_t count, const AxisLimits& limits,
                                bool by_law) noexcept;

class Boxes {
 public:
  /// For up to `pieces` pieces.
  [[nodiscard]] bool create(Memory& memory, std::size_t pieces) noexcept {
    return box_.create(memory, pieces) && cap_.create(memory, pieces);
  }
  /// A box for each piece. `joints`: of each piece, where kinematics mix axes.
  void make(const Buffer<Piece>& pieces, const AxisLimits& limits,
            const JointBends* joints) noexcept;
  [[nodiscard]] const Box& operator[](std::size_t piece) const noexcept { return box_[piece]; }

 private:
  void make_region(const Buffer<Piece>& pieces, std::size_t begin, std::size_t end,
                   const AxisLimits& limits) noexcept;
  void make_arc(const Buffer<Piece>& pieces, std::size_t k, const AxisLimits& limits) noexcept;
  [[nodiscard]] double seconds(const Buffer<Piece>& pieces, std::size_t begin, std::size_t end,
                               const Box& box, const AxisLimits& limits) noexcept;
  [[nodiscard]] double joint_cap(std::size_t piece, const Box& box) const noexcept {
    return joints_ != nullptr ? box_cap(joints_[piece], box) : kNoLimit;
  }
  [[nodiscard]] Box straightest(const Buffer<Piece>& pieces, std::size_t begin, std::size_t end,
                                const AxisLimits& limits) const noexcept;

  Buffer<Box> box_;
  Buffer<double> cap_;
  const JointBends* joints_{nullptr};
};

}  // namespace kerf::motion::path
