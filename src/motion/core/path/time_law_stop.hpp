// LawStop: braking to rest from a moving state of a law without a solver, for TimeLaw. Pure arithmetic.
//
// From node to node, x and u known, the one unknown of an interval is b2: its rows leave a range of it. The least of that range is taken from which
// the motion can get back to the law or to rest: a law driven slower all along by one factor (x and u by the same) keeps all limits and ends in rest,
// so whatever reaches u / x of the law at its place leads on. Whether it does is tried: up from there as steeply as the rows allow. Near the
// end that finds what leads to rest without a jump of acceleration, and elsewhere it keeps out of places at which no b2 would do. Each interval
// is certified.
#pragma once

#include <cstddef>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/law_step.hpp"
#include "motion/core/path/time_law_rows.hpp"
#include "motion/core/ramp.hpp"

namespace kerf::motion::path {

class LawStop {
 public:
  struct Aim {
    double
        widest[2]{};  ///< longest step; and of another grid, where the stop takes longer than that
    double enough_s{0};  ///< s
    LawExcess most;      ///< over the limits
  };

  [[nodiscard]] bool create(Memory& memory, std::size_t intervals) noexcept;
  /// From (x0 > 0, u0) of `law` at `way` from the start of what was added to the rows, of which it makes the steps. False: no stop was found.
  [[nodiscard]] bool run(LawRows& rows, double way, double x0, double u0, const LawAlong& law,
                         const Aim& aim) noexcept;
  struct Step {
    std::size_t stretch{0};
    double from{0}, length{0};  ///< on its piece
    double b[3]{};              ///< of x
  };
  /// The stop; the last one ends in rest with even jerk.
  [[nodiscard]] const Buffer<Step>& steps() const noexcept { return steps_; }

 private:
  /// Of b2.
  struct Range {
    double low{-kNoLimit}, high{kNoLimit};
    bool whole{true};  ///< it says all that there is to say
    [[nodiscard]] double clamp(double b) const noexcept;
  };
  /// Of the rows [r, end), with this right side.
  void by_rows(std::size_t r, std::size_t end, const double b[3], double share,
               Range& range) const noexcept;
  void by_acc(std::size_t i, const double b[3], double share, Range& range) const noexcept;
  void by_jerk(std::size_t i, const double b[3], double share, Range& range) const noexcept;
  void look_along(std::size_t i) noexcept;
  [[nodiscard]] double slope(std::size_t i) const noexcept;
  [[nodiscard]] double back_at_law(std::size_t i) const noexcept;
  [[nodiscard]] bool holds_law(std::size_t i) const noexcept;
  [[nodiscard]] bool add_step(std::size_t i, double step) noexcept;
  [[nodiscard]] bool step_ahead(std::size_t i) noexcept;
  [[nodiscard]] Ramp straight_stop(std::size_t i) const noexcept;
  [[nodiscard]] double rest_way(std::size_t i) const noexcept;
  [[nodiscard]] bool reach(std::size_t i, double wanted, double share, double& w) noexcept;
  [[nodiscard]] bool leads_on(std::size_t i, double w) noexcept;
  [[nodiscard]] bool go(std::size_t i, bool down, double way, std::size_t& count,
                        double& w) noexcept;
  void take(std::size_t i, const double b[3], double& w) noexcept;
  [[nodiscard]] bool hold(std::size_t i, bool again, std::size_t& back, double& w) noexcept;
  [[nodiscard]] bool go_on_with_best(std::size_t i, double& w) noexcept;
  void brake() noexcept;
  [[nodiscard]] bool kept(std::size_t i) const noexcept;
  [[nodiscard]] bool end_at(std::size_t i) noexcept;
  void coefficients(std::size_t i, double b[3]) const noexcept;

  LawRows* rows_{nullptr};
  Aim aim_;
  LawAlong law_;
  std::size_t law_at_{0};
  double law_begins_{0};   ///< sigma from the start of its first interval to that of `law_at_`
  Buffer<Step> steps_;     ///< of the soonest stop so far
  double best_{kNoLimit};  ///< its time
  double soonest_{0};      ///< of this grid
  double widest_{0};
  bool follows_{false};     ///< what leads on gains speed where the law does
  std::size_t settled_{0};  ///< intervals that are taken, in `t_` seconds
  std::size_t kept_{0};     ///< of them are in the stop
  std::size_t narrow_{0};   ///< where what was tried last came to no end
  double t_{0};
  Buffer<double> at_, x_, u_;  ///< of nodes: sigma from the start, and the state
  Buffer<LawPoint> along_;     ///< of the law there
  Buffer<double> jerk_;        ///< what a straight could do
};

}  // namespace kerf::motion::path
