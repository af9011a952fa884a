// LawStop: braking to rest from a moving state without a solver, for TimeLaw. Pure arithmetic.
//
// From node to node, x and u known, the one unknown of an interval is b2: its rows leave a range of it. Forwards the least of that range is taken
// that leads on. What leads on follows from a pass backwards over the motion of the pass before, as bounds on u from below:
//   u >= what acceleration allows,  u_i >= u_i+1 - w D with the largest w that jerk allows there,  u >= -sqrt(2 j sqrt(x)),
// the last one the states from which the even jerk j leads to rest. A pass ends where nothing keeps the limits: the next one knows of that place.
// A few passes settle; each interval is certified.
#pragma once

#include <cstddef>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/time_law_rows.hpp"

namespace kerf::motion::path {

class LawStop {
 public:
  struct Aim {
    double widest{0};        ///< longest step
    double acc{0}, jerk{0};  ///< shares of the limits that are used where nothing forces more
    LawExcess most;          ///< over the limits
  };

  [[nodiscard]] bool create(Memory& memory, std::size_t intervals) noexcept;
  /// From (x0 > 0, u0) at `way` from the start of what was added to the rows, of which it makes the steps. False: no stop was found.
  [[nodiscard]] bool run(LawRows& rows, double way, double x0, double u0, const Aim& aim) noexcept;
  /// Intervals before the last one, which ends in rest after `way` of even jerk.
  [[nodiscard]] std::size_t size() const noexcept { return end_; }
  [[nodiscard]] double way() const noexcept { return way_; }
  void coefficients(std::size_t i, double b[3]) const noexcept;
  /// Passes before the last one of the last run.
  [[nodiscard]] int passes() const noexcept { return passes_; }

 private:
  /// Of b2; the slopes are those of its ends by b1.
  struct Range {
    double low{-kNoLimit}, high{kNoLimit};
    double low_slope{0}, high_slope{0};
    [[nodiscard]] double clamp(double b) const noexcept;
  };
  /// The right side of the jerk rows: a tangent that is safe everywhere, or what it is in the middle.
  enum class Side { safe, middle };
  void by_acc(std::size_t i, const double b[3], Range& range) const noexcept;
  void by_jerk(std::size_t i, const double b[3], double share, Side side,
               Range& range) const noexcept;
  [[nodiscard]] double acc_bound(std::size_t i, double x) const noexcept;
  [[nodiscard]] bool step_ahead(std::size_t i, double rest_way) noexcept;
  void hold_back(std::size_t i) noexcept;
  [[nodiscard]] bool take(std::size_t i, double& w) noexcept;
  [[nodiscard]] bool forwards() noexcept;
  void backwards() noexcept;
  void learn(std::size_t i) noexcept;
  void remember() noexcept;
  [[nodiscard]] bool kept(std::size_t i) const noexcept;
  [[nodiscard]] bool certified() const noexcept;

  LawRows* rows_{nullptr};
  Aim aim_;
  int passes_{0};
  std::size_t reached_{0};  ///< intervals of the last pass
  std::size_t end_{0};
  double way_{0};
  Buffer<double> at_, x_, u_;                   ///< of nodes: sigma from the start, and the state
  Buffer<double> low_;                          ///< of u
  Buffer<double> even_;                         ///< jerk of sigma that is there on the way to rest
  Buffer<double> old_at_, old_low_, old_even_;  ///< of the pass before
  std::size_t seen_{0};                         ///< of these
};

}  // namespace kerf::motion::path
