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
    double gap{5e-3};  ///< how near to the least time, relative; of a long one to its first second
    double violation{1e-3};
    double mu{1e-2};  ///< first weight of the barrier, relative to the time
    int iterations{60};
    bool soon{false};  ///< rather no result than many iterations
  };

  [[nodiscard]] bool create(Memory& memory, std::size_t intervals,
                            std::size_t rows_per_interval) noexcept;
  /// x at node 0 is x0 and the first interval begins with u0; x0 0: at rest. `patient`: does not brake for wishes before limits are kept. Rows
  /// that hardly can be reached are left out unless `all` are wanted: who certifies the law looks at them all.
  void begin(const LawRows& rows, double x0, double u0, bool patient, bool all) noexcept;
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
  /// Of two rows that follow each other.
  using Pair [[gnu::vector_size(16)]] = double;
  /// Of all rows, one side: v <= right, or -v <= right.
  struct Side {
    Buffer<double> s, z;  ///< slack and multiplier
    Buffer<double> ds, dz;
    Buffer<double> over;  ///< 1 / s
    Buffer<double> room;  ///< the true slack
  };
  /// x <= top; with a length: x - t <= top, where t has a price.
  struct Bound {
    std::size_t i{0};  ///< of the middle or the node that x belongs to
    double top{0};
    double worth{0}, price{0}, wanted{kNoLimit};  ///< of a wish
    double s{1}, z{0};
    double t{0}, y{0};
    double off{0};                          ///< how far the slack is from the true one
    double weight{0}, push{0}, push_mu{0};  ///< in matrix and right side
    double pull{0}, pull_mu{0};             ///< dz of a wish without a step
    double ds{0}, dz{0}, dt{0};
  };

  /// The right side of the jerk rows, x^-1/2 by its tangent at the middle of the interval, and its derivatives.
  struct JerkSide {
    double right[3]{};
    double slope[3][3]{};  ///< [coefficient][b]

    JerkSide() = default;
    JerkSide(const double b[3], double share) noexcept;
  };
  /// Over the coefficients b of an interval: matrix; right side without mu, and what mu is multiplied by in it.
  struct Quadratic {
    double h00{0}, h01{0}, h02{0}, h11{0}, h12{0}, h22{0};
    double g[3]{}, mu[3]{};
  };
  /// Rows with one right side.
  struct Section {
    double right{0}, relative{0};
    const double* slope{nullptr};  ///< of the right side by b
    bool given{false};             ///< b0 and b1 are those of the start
  };
  struct Look {
    double primal{0}, dual{0};  ///< steps to take
    double sum{0};
    double worst{0};
  };
  /// What rows add up to: one after another, or the odd and the even ones.
  template <class V>
  struct Sums {
    V least, sum{}, h00{}, h01{}, h02{}, h11{}, h12{}, h22{}, g0{}, g1{}, g2{}, m0{}, m1{}, m2{};
    V x0{}, x1{}, x2{}, weights{}, pulls{}, pulls_mu{};
  };
  template <bool kSlopes, class V>
  void add_row(std::size_t r, const double b[3], double right, const Look& look,
               Sums<V>& to) noexcept;
  template <class V>
  void step_row(std::size_t r, const double db[3], double mu, double dright, V& primal,
                V& dual) noexcept;

  void take_rows(bool all) noexcept;
  void take_row(std::size_t r) noexcept;
  [[nodiscard]] double worth_of_node(std::size_t i) const noexcept;
  [[nodiscard]] double worth_of(std::size_t i) const noexcept;
  [[nodiscard]] static double price_of(const Bound& wish, double x) noexcept;
  static void start_wish(Bound& wish, double x) noexcept;
  void raise_multipliers(double mu) noexcept;
  void wish_truly(double mu) noexcept;
  [[nodiscard]] bool make_broken_wishes_dearer() noexcept;
  void set_nodes() noexcept;
  template <class F>
  void each_bound(F&& f) noexcept;
  [[nodiscard]] double seconds() const noexcept;
  void start_slacks(double mu) noexcept;
  [[nodiscard]] static double build_time(double length, const double b[3], Quadratic& q) noexcept;
  template <bool kSlopes>
  void add_rows(std::size_t r, std::size_t end, const double b[3], const Section& section,
                Quadratic& q, Look& look) noexcept;
  void add(std::size_t i, const Quadratic& q) noexcept;
  void add_at_node(std::size_t i, double h, double g, double by_mu) noexcept;
  void prepare(Bound& bound, double x, double primal, double dual) noexcept;
  void look_and_build(double primal, double dual) noexcept;
  [[nodiscard]] bool factor_and_solve(double mu) noexcept;
  void step_rows(std::size_t r, std::size_t end, const double db[3], double mu, bool given,
                 double dright, double& primal, double& dual) noexcept;
  void step_sizes(double mu) noexcept;
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
  double time_{0};            ///< of the law that the unknowns say
  double primal_{0}, dual_{0};
  std::size_t terms_{0};

  Buffer<double> m_, dm_, node_, left_, right_;  ///< node i = left m[i-1] + right m[i]
  Buffer<double> d0_, d1_, d2_;
  Buffer<double> kept_;   ///< m_ of a result that is gone on from
  Buffer<double> by_mu_;  ///< dm_ holds the right side without mu
  Side up_, down_;        ///< v <= right, -v <= right
  /// Of an interval: its rows, accelerations first, then so many for each coefficient of jerk.
  struct Part {
    std::size_t row{0}, accs{0}, jerks{0};
  };
  Buffer<Part> part_;
  Buffer<double> a0_, a1_, a2_;  ///< rows
  Buffer<JerkSide> side_;        ///< of intervals, where x is
  Buffer<Bound> at_middle_, at_node_;
};

}  // namespace kerf::motion::path
