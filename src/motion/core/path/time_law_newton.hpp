// LawNewton: the interior-point method behind TimeLaw. Pure arithmetic.
//
// Unknown is the middle Bernstein coefficient m of x on each interval; b0 and b2 are means of neighbouring m, so that x is C1 and all rows
// touch three m: the matrix has five diagonals. Limits get a slack s > 0 of their own, which may differ from the true one while the method
// is on its way (infeasible start). Wishes are rows that may be broken at a price above what breaking them is worth.
// Source: Nocedal and Wright, Numerical Optimization, ch. 19.
#pragma once

#include <cstddef>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/time_law_rows.hpp"

namespace kerf::motion::path {

class LawNewton {
 public:
  struct Aim {
    double acc{0.998}, jerk{0.998};  ///< shares of the limits
    double gap{5e-3};                ///< how near to the least time, relative
    double violation{1e-3};
    double mu{1e-2};  ///< first weight of the barrier, relative to the time
    int iterations{60};
  };

  [[nodiscard]] bool create(Memory& memory, std::size_t intervals) noexcept;
  /// x at node 0 is x0 and the first interval begins with u0; x0 0: at rest. `patient`: does not brake for wishes before limits are kept.
  void begin(const LawRows& rows, double x0, double u0, bool patient) noexcept;
  /// Guess of x at node i, 0 < i < intervals.
  void guess(std::size_t i, double x) noexcept { node_[i] = x; }
  /// Takes the guesses as they are, or shrinks them until the rows hold.
  void start(bool shrink, const Aim& aim) noexcept;
  /// False: no result within the tolerances.
  [[nodiscard]] bool run(const Aim& aim) noexcept;
  /// b0, b1, b2 of an interval that is not next to rest.
  void coefficients(std::size_t i, double b[3]) const noexcept;
  /// Next to rest: x at the other end.
  [[nodiscard]] double node(std::size_t i) const noexcept { return i == 0 ? x0_ : node_[i]; }
  [[nodiscard]] int iterations() const noexcept { return iterations_; }

 private:
  /// x <= top; with a length: x - t <= top, where t has a price.
  struct Bound {
    double top{0};
    double length{0}, price{0}, wanted{kNoLimit};
    double s{1}, z{0};
    double t{0}, y{0};
    double at{0}, off{0};  ///< x, and how far the slack is from the true one
    double weight{0}, pull{0};
    double ds{0}, dz{0}, dt{0};
    [[nodiscard]] bool used() const noexcept { return top < kNoLimit; }
  };

  /// The right side of the jerk rows, x^-1/2 by its tangent at the middle of the interval, and its derivatives.
  struct JerkSide {
    double right[3]{};
    double slope[3][3]{};  ///< [coefficient][b]

    JerkSide() = default;
    JerkSide(const double b[3], double share) noexcept;
  };

  [[nodiscard]] static double price_of(const Bound& wish, double x) noexcept;
  static void start_wish(Bound& wish, double x) noexcept;
  void wish_truly(double mu) noexcept;
  void set_nodes() noexcept;
  [[nodiscard]] double seconds() const noexcept;
  void start_slacks(double mu) noexcept;
  void look() noexcept;
  void build(double mu) noexcept;
  [[nodiscard]] bool factor_and_solve() noexcept;
  void step_sizes(double mu) noexcept;
  void move() noexcept;
  void shrink_guess() noexcept;

  const LawRows* rows_{nullptr};
  std::size_t n_{0};                ///< intervals
  std::size_t first_{0}, last_{0};  ///< unknowns m[first_ .. last_)
  double x0_{0};
  bool rests_{false};
  bool waits_{false};  ///< the wishes below the start's speed are still to come
  bool sinks_{false};  ///< they come step by step
  double acc_{1}, jerk_{1};
  int iterations_{0};
  double sum_{0}, worst_{0};  ///< of products of slacks and multipliers; largest relative violation
  double primal_{0}, dual_{0};
  std::size_t terms_{0};

  Buffer<double> m_, dm_, node_, left_, right_;  ///< node i = left m[i-1] + right m[i]
  Buffer<double> d0_, d1_, d2_;
  Buffer<double> v_;                  ///< left side of a row
  Buffer<double> sp_, sm_, zp_, zm_;  ///< slack and multiplier on both sides
  Buffer<double> dsp_, dsm_, dzp_, dzm_;
  Buffer<double> over_p_, over_m_;  ///< 1 over the slacks
  Buffer<JerkSide> side_;           ///< of intervals, where x is
  Buffer<Bound> at_middle_, at_node_, wish_middle_, wish_node_;
};

}  // namespace kerf::motion::path
