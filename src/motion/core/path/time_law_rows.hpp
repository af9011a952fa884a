// LawRows: the grid of a window and the limits on it, for TimeLaw. Pure arithmetic.
//
// On an interval of length D the square of speed x has the Bernstein coefficients b0, b1, b2; u0 = (b1 - b0)/D and u1 = (b2 - b1)/D are the
// accelerations at its ends, w = (u1 - u0)/D. With the coefficients p of q', e of q'' and c of q''' of an axis
//   acceleration  p0 u0 + e0 b0, (p0 u1 + 2 p1 u0 + 2 e0 b1 + e1 b0)/3, (2 p1 u1 + p2 u0 + e0 b2 + 2 e1 b1)/3, p2 u1 + e1 b2
//   jerk          p0 w + 3 e0 u0 + c b0, p1 w + 3 (e0 u1 + e1 u0)/2 + c b1, p2 w + 3 e1 u1 + c b2, over the speed
// are the Bernstein coefficients of what the axis does: a row each, linear in b and true on the whole interval. Arcs are divided until their
// q'' is linear but for a remainder, which the certificate adds. Where kinematics mix axes the joints have rows like axes do (joint_curve.hpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/joint_curve.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"

namespace kerf::motion::path {

/// A part of a piece as it was given to TimeLaw::add().
struct LawStretch {
  Piece piece;
  double from{0}, to{0}, end{0}, span_end{0};  ///< to: in a shortened window, else end
  double cap{0}, wish{0};
  std::uint64_t number{0};
  const JointCurve* joints{nullptr};  ///< where kinematics mix axes
  int fineness{1};
  double bends{kNoLimit};  ///< the widest step by the joints
  double widest{0},
      step{0};  ///< of its grid, away from its ends: as it would like, and beside its neighbours
  double first{0}, last{0};  ///< steps at its ends
};

struct LawInterval {
  double length{0};
  double cap{0}, wish{0};
  double from{0};  ///< on its piece
  double straight_acc{0},
      straight_jerk{0};  ///< of sigma, as if the path went on straight from its middle
  std::size_t stretch{0};
  std::size_t row{0};     ///< its first row; accelerations first, then jerks by coefficient
  std::int32_t accs{0};   ///< by axis; the last one of each that of its end
  std::int32_t jerks{0};  ///< of each of the three coefficients
  bool bounds_u{false};   ///< of steps: a jerk row in which b2 counts for nothing beside b1
  /// Arcs and joints: what the rows leave out, times the largest b; times the largest |u|; times the largest difference of neighbouring b; times |w|.
  double acc_rest{0}, acc_rest_u{0}, jerk_rest{0}, jerk_rest_u{0}, jerk_rest_b{0}, jerk_rest_w{0};
};

/// Shares of the limits by which a law goes over them at most; 0: within.
struct LawExcess {
  double vel{0}, acc{0}, jerk{0};
};

/// The way on which even jerk makes x from rest.
[[nodiscard]] double way_from_rest(double x, double jerk) noexcept;
/// Acceleration and jerk of sigma at a place as if the path went on straight there.
void straight_limits(const Piece& piece, double s, const AxisLimits& limits, double& acc,
                     double& jerk) noexcept;
/// Of the joints too.
void straight_limits(const LawStretch& stretch, double s, const AxisLimits& limits, double& acc,
                     double& jerk) noexcept;

class LawRows {
 public:
  /// Of one coefficient of an interval: each axis, each joint and the path.
  static constexpr std::size_t kMostJerks = kAxes + kMostJoints + 1;
  [[nodiscard]] bool create(Memory& memory, std::size_t intervals,
                            std::size_t rows_per_interval) noexcept;
  void begin(const AxisLimits& limits) noexcept;
  [[nodiscard]] bool add(const LawStretch& stretch) noexcept;
  /// At least as many as there will be.
  [[nodiscard]] std::size_t expected() const noexcept { return expected_; }
  [[nodiscard]] const AxisLimits& limits() const noexcept { return limits_; }
  [[nodiscard]] const Buffer<LawStretch>& stretches() const noexcept { return stretches_; }

  /// Divides the stretches into `least` intervals or more and makes the rows, for a window that begins with x0, u0 (both 0: at rest).
  /// False: no room.
  [[nodiscard]] bool make(double x0, double u0, std::size_t least) noexcept;
  /// Another grid, made as it is driven from `way` on: add_step() adds one interval of length `most` or less, with its rows. False: the window ends there, or no room.
  void make_stepwise(double way) noexcept;
  [[nodiscard]] bool add_step(double most) noexcept;
  /// All steps from number i on.
  void take_back(std::size_t i) noexcept;
  /// As if the window ended after this way, with no wider steps; kNoLimit: as it is. For the next make().
  void shorten(double way, double widest) noexcept {
    way_ = way;
    widest_ = widest;
  }
  /// No interval is to be driven at more than x, if it can be helped.
  void wish(double x) noexcept {
    for (LawInterval& in : intervals_) in.wish = x < in.cap ? std::min(in.wish, x) : in.wish;
  }

  /// Of all that was added.
  [[nodiscard]] double whole_way() const noexcept {
    double way = 0;
    for (const LawStretch& s : stretches_) way += s.end - s.from;
    return way;
  }
  [[nodiscard]] std::size_t size() const noexcept { return intervals_.size(); }
  [[nodiscard]] const LawInterval& operator[](std::size_t i) const noexcept {
    return intervals_[i];
  }
  /// Largest x at the end of the first interval when it starts at rest, and at the start of the last one, with even jerk.
  [[nodiscard]] double start_cap() const noexcept;
  [[nodiscard]] double stop_cap() const noexcept;
  /// The same for a stop on `way` from the start of an interval; 0: it would leave the stretch.
  [[nodiscard]] double stop_cap(std::size_t i, double way) const noexcept;
  /// The largest x at which a place can be passed evenly, roughly.
  [[nodiscard]] double even_cap(std::size_t i) const noexcept;
  /// What a straight along q' could do there: acceleration and jerk of sigma.
  void straightest(std::size_t i, double& acc, double& jerk) const noexcept {
    acc = intervals_[i].straight_acc;
    jerk = intervals_[i].straight_jerk;
  }

  /// The same, the most of its middle and its ends.
  void most_on(std::size_t i, double& acc, double& jerk) const noexcept;

  /// By how much the interval with these coefficients goes over the true limits. `given`: nothing is said about b[0] and its u, which nobody chose.
  [[nodiscard]] LawExcess excess(std::size_t i, const double b[3], bool given) const noexcept;
  /// Of jerk alone; -1 or more.
  [[nodiscard]] double jerk_excess(std::size_t i, const double b[3]) const noexcept;

  /// Rows: left side over (b0, b1, b2), for a limit of 1.
  Buffer<double> a0, a1, a2;
  /// Of steps: b2 is within `half` of mid0 b0 + mid1 b1 for a right side of 1; kNoLimit: the row hardly depends on it.
  Buffer<double> mid0, mid1, half;

 private:
  void choose_steps(double x0, double u0) noexcept;
  void divide(std::size_t k, double gone) noexcept;
  bool push_node(double at) noexcept;
  void push(std::size_t k, double from, double to) noexcept;
  [[nodiscard]] bool make_rows(std::size_t i) noexcept;
  void turn_rows(LawInterval& in) noexcept;
  [[nodiscard]] bool goes_on(std::size_t i, const Vec& first, const Vec& second) const noexcept;
  [[nodiscard]] double rest_cap(std::size_t i, double way, bool start) const noexcept;

  AxisLimits limits_;
  Buffer<LawStretch> stretches_;
  Buffer<LawInterval> intervals_;
  Buffer<double> nodes_;  ///< of one stretch
  std::size_t most_rows_{0};
  std::size_t expected_{0};
  std::size_t used_{0};  ///< stretches of the window
  double way_{kNoLimit}, widest_{kNoLimit};
  double at_{0};           ///< where the next step begins on the last of them
  double fine_{kNoLimit};  ///< widest step at the start
  bool room_{true};
};

}  // namespace kerf::motion::path
