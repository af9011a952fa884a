// Limits along a path: what the axes can do, as inequalities that hold on the whole of a stretch. Pure arithmetic, @rt.
//
// With x = (dsigma/dt)^2 linear over a stretch of length D, u = x'/2 and q' = p, q'' = e:
//   velocity      |p| sqrt(x)    <= V     ->  x <= cap
//   acceleration  |p u + e x|    <= A     ->  three Bernstein coefficients, each linear in (x0, x1); four on arcs, whose q' and q''
//                                             are taken as the quadratics through three points (error below 1e-6 at 0.05 rad)
// A polynomial lies within the hull of its Bernstein coefficients, so limits hold between the ends too; and differences of positions
// at any sampling keep them as well (mean value theorem).
// Source: Pham and Pham, TOPP-RA (arXiv 1707.07239), with coefficients instead of collocation.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "motion/core/path/piece.hpp"

namespace kerf::motion::path {

inline constexpr double kNoLimit = 1e99;

/// What each axis can do; kNoLimit where it has no limit of that kind.
struct AxisLimits {
  Vec vel, acc, jerk;
  double path_vel{kNoLimit};  ///< mm/s in XYZ (or UVW): [TRAJ]MAX_LINEAR_VELOCITY
  double path_acc{kNoLimit};  ///< mm/s2 along straights in XYZ
  double path_jerk{
      kNoLimit};              ///< mm/s3 along the path in XYZ (`jerk_slope`): [TRAJ]MAX_LINEAR_JERK
  double turn_vel{kNoLimit};  ///< deg/s of moves of rotary axes only
  bool jerks{false};          ///< any jerk is limited: the path is driven by boxes (boxes.hpp)
};

/// -1 <= a x0 + b x1 <= 1
struct Row {
  double a, b;
};
inline constexpr std::size_t kMostJoints = 8;  ///< that are not an axis each
/// Four of an axis; three of a joint; one of the path.
inline constexpr std::size_t kMaxRows = 4 * kAxes + 3 * kMostJoints + 1;

/// Only the first ones are ever written or read: the servo cycle makes some for each stretch that it is on.
struct Rows {
  std::array<Row, kMaxRows> at;
  std::size_t count{0};
  [[nodiscard]] std::span<const Row> all() const noexcept { return {at.data(), count}; }
};

/// Largest x by the axes' velocities on [s0, s1] of the piece.
[[nodiscard]] double axis_cap(const Piece& piece, double s0, double s1,
                              const AxisLimits& limits) noexcept;
/// Largest x by the programmed feed at override 1; kNoLimit when nothing moves in its metric.
[[nodiscard]] double feed_cap(const Piece& piece, double s0, double s1) noexcept;
/// Largest |q'| on [s0, s1] in the axes that the feed is measured in.
[[nodiscard]] double slope_of(const Piece& piece, double s0, double s1) noexcept;
/// Straights only: the largest |u|.
[[nodiscard]] double straight_acc(const Piece& piece, const AxisLimits& limits) noexcept;
/// |q'| in XYZ where a jerk along the path is what sigma's is: on straights and arcs, and on cubics that lead on (splines, short lines that nearly do).
/// 0 elsewhere: in a corner sigma runs on evenly whatever the way does, and what its jerk asks of the machine is the axes' alone.
[[nodiscard]] double jerk_slope(const Piece& piece) noexcept;
/// The acceleration rows of [s0, s1], s1 > s0.
void rows_of(const Piece& piece, double s0, double s1, const AxisLimits& limits,
             Rows& out) noexcept;

/// How many stretches of even length a piece is divided into, so that x may bend where it has to. Straights: 1.
[[nodiscard]] int divisions(const Piece& piece) noexcept;

}  // namespace kerf::motion::path
