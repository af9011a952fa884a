// TimeLaw: the least time along a window of path under velocity, acceleration and jerk limits of every axis. Pure arithmetic.
//
// With x = (dsigma/dt)^2, u = x'/2 the acceleration along sigma and w = u': x is a quadratic on each interval and C1 over all of them, so that
// acceleration never jumps. All limits are rows on Bernstein coefficients, true between nodes; a law is certified before it is given out.
// Sources: Verscheure et al., Time-optimal path tracking (2009); Nocedal and Wright, Numerical Optimization, ch. 19.
#pragma once

#include <cstddef>
#include <cstdint>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/law_step.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/time_law_newton.hpp"
#include "motion/core/path/time_law_rows.hpp"
#include "motion/core/path/time_law_stop.hpp"

namespace kerf::motion::path {

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
  [[nodiscard]] Result solve_stop(const Start& start, const LawAlong& law) noexcept;
  /// Braking from node to node (time_law_stop.hpp): cheap. `law` is driven at the start; where braking leads nowhere it goes on for some milliseconds first.
  [[nodiscard]] Result brake_stop(const Start& start, const LawAlong& law) noexcept;
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
  [[nodiscard]] double straight_stop(const Start& start) const noexcept;
  void end_nearer(const Start& start) noexcept;
  [[nodiscard]] bool brake(const Start& from, double way, const LawAlong& law) noexcept;
  [[nodiscard]] bool brake_behind(std::size_t k) noexcept;
  [[nodiscard]] bool brake_on_the_way(double every, double end, double least) noexcept;
  void brake_later() noexcept;
  void keep() noexcept;
  void restore() noexcept;
  void cut() noexcept;
  [[nodiscard]] bool certify(const Start& start) noexcept;
  void write(const Start& start) noexcept;
  void place(std::size_t stretch, double from, double length, LawStep& step) const noexcept;

  LawRows rows_;
  LawNewton newton_;
  LawStop stop_;
  Buffer<LawStep> law_, kept_;
  Buffer<double> x_, sums_, way_;
  double seconds_{0}, kept_seconds_{0};
  int iterations_{0};
  std::uint64_t work_{0};
  int round_{0};  ///< the attempt that succeeded
  static constexpr int kRounds = 4;
  int rounds_{kRounds};  ///< attempts before a window is given up
};

}  // namespace kerf::motion::path
