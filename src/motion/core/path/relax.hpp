// Relaxer: a smoothed curve is moved within its tolerance so that it asks for less jerk.
//
// Smoothing cuts corners by the tolerance and leaves most of it unused between them. A curve that swings out of the chain there by as much has wider
// corners. Of all curves with the same knots (and more of them where pieces are long) that stay within the tolerance, begin and end as the
// smoothed one (place, direction, curvature) and leave long straights alone, this one has the least
//     integral of |q'''|^2 v^5 / J^2 + |q''|^2 v^3 / A^2,
// the squares of jerk and acceleration as shares of the limits of each axis, over the time at a speed v that the smoothed curve lets expect: what
// is passed slowly counts as much as what is passed fast.
//
// A convex problem: a cubic B-spline is added to the curve; Newton's method on a logarithmic barrier finds its points, in each step by one
// factorisation of a banded matrix (Boyd and Vandenberghe, Convex Optimization, 11.3). What stays within the tolerance are the Bernstein
// coefficients of curve minus chain on every stretch, as in the smoother's own check.
#pragma once

#include <array>
#include <cstdint>

#include "motion/core/path/buffer.hpp"
#include "motion/core/path/limits.hpp"
#include "motion/core/path/piece.hpp"
#include "motion/core/path/smoothing.hpp"

namespace kerf::motion::path {

class Relaxer {
 public:
  /// For chains of up to `lines` lines.
  [[nodiscard]] bool create(Memory& memory, std::size_t lines) noexcept;
  /// The pieces of `out` from `first` on are the curve of the chain, from its beginning on. Leaves in relaxed() a curve over the same sigma, with the
  /// same feeds, in at least as many pieces. An axis that does not bend stays as it is. False: there is none.
  [[nodiscard]] bool relax(const Chain& chain, const SmoothingSettings& settings,
                           const AxisLimits& limits, const Buffer<Piece>& out,
                           std::size_t first) noexcept;
  [[nodiscard]] const Buffer<Piece>& relaxed() const noexcept { return made_; }

 private:
  static constexpr std::size_t kMoved = 3;  ///< axes: XYZ
  static constexpr std::size_t kOrder = 4;  ///< stretches that a spline lies over
  using Place = std::array<double, kMoved>;
  using Block = std::array<double, kMoved * kMoved>;
  /// A B-spline over four stretches from knot j on: its third derivatives there; value and two derivatives at the three knots between.
  struct Hat {
    std::array<double, kOrder> third{};
    std::array<std::array<double, 3>, kOrder - 1> at{};
    /// Value and two derivatives on stretch r of its four, s behind its beginning.
    [[nodiscard]] std::array<double, 3> place(std::size_t r, double s) const noexcept;
  };
  /// A Bernstein coefficient of curve minus chain: off by so much, no farther than `most`; `by` are the shares of the four splines there.
  struct Site {
    std::size_t stretch{0};
    std::array<double, kOrder> by{};
    Place off{}, step{};
    double most{0};
  };

  [[nodiscard]] bool may_move(const Chain& chain, const SmoothingSettings& settings,
                              const Buffer<Piece>& out, std::size_t first) const noexcept;
  [[nodiscard]] bool stays(const Piece& piece) const noexcept;
  [[nodiscard]] double slowness(const Piece& piece) const noexcept;
  void divide(const Buffer<Piece>& out, std::size_t first) noexcept;
  bool relax_part(const Chain& chain, std::size_t from, std::size_t to) noexcept;
  void expect_speeds(std::size_t from, std::size_t to) noexcept;
  void make_hats(std::size_t from) noexcept;
  /// Calls f(piece, line, begin, end) for each stretch of pieces [from, to) along one line of the chain.
  template <class F>
  void each_along(const Chain& chain, std::size_t from, std::size_t to, F&& f) const noexcept;
  void find_sites(const Chain& chain, std::size_t from, std::size_t to) noexcept;
  void add_site(std::size_t stretch, double s, double ahead, const Vec& off, double keeps) noexcept;
  void solve(std::size_t from) noexcept;
  void add_bends(std::size_t from) noexcept;
  void add_barrier(double mu) noexcept;
  [[nodiscard]] bool find_step() noexcept;
  [[nodiscard]] double reach_of_step() noexcept;
  void apply(std::size_t from) noexcept;
  [[nodiscard]] bool within(const Chain& chain, std::size_t from, std::size_t to) const noexcept;
  /// The splines that are not 0 on a stretch: f(which of them, r), where the stretch is its r-th.
  template <class F>
  void each_on(std::size_t stretch, F&& f) const noexcept {
    for (std::size_t r = 0; r < kOrder && r <= stretch; ++r)
      if (stretch - r < splines_) f(stretch - r, r);
  }
  [[nodiscard]] Block& block(std::size_t row, std::size_t back) noexcept {
    return band_[row * kOrder + back];
  }

  Tolerance tolerance_;
  Place by_jerk_{}, by_acc_{};  ///< 1 / limit^2
  double fastest_{0};
  std::size_t splines_{0};
  Buffer<Piece> made_, were_;  ///< the curve; a part of it as it was
  Buffer<double> knot_;        ///< sigma at the beginning of each piece, and at the end
  Buffer<double> slow_;        ///< of each piece of a part: 1 / the speed that is expected
  Buffer<Hat> hat_;
  Buffer<Site> site_;
  Buffer<Place> move_, step_, slope_;  ///< of each spline
  Buffer<Block> band_;     ///< of each spline's row: with itself and with the three before it
  Buffer<Block> inverse_;  ///< of the diagonal
};

}  // namespace kerf::motion::path
