// TimeLaw: the least time along a window of path under velocity, acceleration and jerk limits of every axis. Pure arithmetic.
//
// With x = (dsigma/dt)^2, u = x'/2 the acceleration along sigma and w = u': x is a quadratic on each interval and C1 over all of them, so that
// acceleration never jumps. All limits are rows on Bernstein coefficients, true between nodes; a law is certified before it is given out.
// Sources: Verscheure et al., Time-optimal path tracking (2009); Nocedal and Wright, Numerical Optimization, ch. 19.
#pragma once

#include <cstddef>
#include <cstdint>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/time_law_newton.hpp"
#include "motion/core/path/time_law_rows.hpp"
#include "motion/core/path/time_law_stop.hpp"

namespace kerf::motion::path {

/// One interval of a law, in closed form: O(1) to evaluate in the servo cycle.
struct LawStep {
  enum class Kind : std::int32_t {
    spline, /**< d2s/dt2 = w s + u with s from the interval's start: exponentials or sines of sqrt|w| t */
    start, /**< from rest: s = length (t / seconds)^3 */
    stop   /**< to rest:   s = length (1 - (1 - t / seconds)^3) */
  };
  double length{0};   ///< sigma
  double x{0}, u{0};  ///< at its start
  double w{0};        ///< du/dsigma, constant (spline)
  double seconds{0};
  std::uint64_t span{0};  ///< as given to add()
  double left{0};         ///< sigma from the end of this interval to the end of its span
  Kind kind{Kind::spline};
  std::int32_t reserved{0};
};

/// Place and speed within an interval `t` seconds after its start.
struct LawState {
  double s{0};      ///< sigma from the interval's start
  double speed{0};  ///< dsigma/dt
  double acc{0};    ///< d2sigma/dt2
};
[[nodiscard]] LawState at(const LawStep& step, double t) noexcept;

class TimeLaw {
 public:
  struct Start {
    double x{0}, u{0};  ///< both 0: at rest
  };
  enum class Result : std::int32_t { ok, failed, full /**< no room for the intervals */ };

  /// Rows of an interval: of six axes; of as many, and the joints of a machine whose kinematics mix them.
  static constexpr std::size_t kRows = 30, kRowsWithJoints = 64;
  /// Room for `intervals`. False: no memory.
  [[nodiscard]] bool create(Memory& memory, std::size_t intervals,
                            std::size_t rows_per_interval = kRows) noexcept;

  /// A window: add() its stretches in path order, then solve. Limits with jerk.
  void begin(const AxisLimits& limits) noexcept;
  /// [from, to] of a piece, a part of span `number` that ends at `span_end` (>= to) of the piece. `cap` bounds x everywhere
  /// (axis velocities; those of `joints` besides), `wish` bounds x softly (feed at the override in force; kNoLimit: none). `fineness` 1: few intervals (dense
  /// streams, 1 on a cubic), 4: as fine as pays. The straight's grid is graded from both ends. False: full.
  [[nodiscard]] bool add(std::uint64_t number, const Piece& piece, double from, double to,
                         double span_end, double cap, double wish, int fineness,
                         const JointCurve* joints = nullptr) noexcept;
  /// Roughly, before solve().
  [[nodiscard]] std::size_t intervals() const noexcept { return rows_.expected(); }

  /// From `start` at the first node to rest at the end of the last interval.
  [[nodiscard]] Result solve(const Start& start) noexcept;
  /// A stop as soon as possible: to rest wherever within the window that is soonest. The window must be long enough (about 1.5 times the
  /// stopping distance on a straight; the caller lengthens it when this fails). By brake_stop(); where that finds none by search_stop().
  [[nodiscard]] Result solve_stop(const Start& start) noexcept;
  /// Braking from node to node (time_law_stop.hpp): cheap. Where that was not easy the solver tries to end nearer.
  [[nodiscard]] Result brake_stop(const Start& start) noexcept;
  /// By the solver: down to a crawl as soon as limits allow, then the nearest end for which it finds a law, of which braking may take over
  /// the rest.
  [[nodiscard]] Result search_stop(const Start& start) noexcept;

  /// The law of the last solve that was ok.
  [[nodiscard]] const Buffer<LawStep>& law() const noexcept { return law_; }
  /// Of it, from start to rest.
  [[nodiscard]] double seconds() const noexcept { return seconds_; }
  [[nodiscard]] int iterations() const noexcept { return iterations_; }
  /// Iterations times intervals since create().
  [[nodiscard]] std::uint64_t work() const noexcept { return work_; }

 private:
  [[nodiscard]] bool is_last_stop(const Start& start) const noexcept;
  [[nodiscard]] Result attempt(const Start& start) noexcept;
  void guess_nodes(const Start& start, bool patient) noexcept;
  void round_off() noexcept;
  void track(const Start& start) noexcept;
  [[nodiscard]] double stop_way(const Start& start) const noexcept;
  [[nodiscard]] double least_stop(const Start& start) const noexcept;
  void end_nearer(const Start& start) noexcept;
  [[nodiscard]] bool brake(const Start& from, double way) noexcept;
  [[nodiscard]] bool brake_behind(std::size_t k) noexcept;
  void brake_later() noexcept;
  void keep() noexcept;
  void restore() noexcept;
  void cut() noexcept;
  [[nodiscard]] bool certify(const Start& start) noexcept;
  void write(const Start& start) noexcept;
  void place(std::size_t i, LawStep& step) const noexcept;

  LawRows rows_;
  LawNewton newton_;
  LawStop stop_;
  Buffer<LawStep> law_, kept_;
  Buffer<double> x_, sums_, way_;
  double seconds_{0}, kept_seconds_{0};
  int iterations_{0};
  int passes_{0};  ///< of braking
  std::uint64_t work_{0};
  int round_{0};  ///< the attempt that succeeded
  static constexpr int kRounds = 4;
  int rounds_{kRounds};  ///< attempts before a window is given up
};

}  // namespace kerf::motion::path
