// Piece: one analytic piece of the path of a program, q(sigma) in nine axes.
//
// sigma is the path parameter. It is *not* arc length: on a straight it is the length in the feed metric, within a blend it only
// runs evenly, so that |q'| may fall below 1 at a corner and even pass through zero at a reversal while sigma goes on at speed.
// Speed along a piece is judged by |q'| * dsigma/dt, so a shallow corner keeps true feed.
// Source: B-spline smoothing seen from the second derivative (de Boor, variation-diminishing splines); see docs/planner.md.
#pragma once

#include <cstdint>

#include "motion/core/path/vec.hpp"

namespace kerf::motion::path {

/// What is programmed for a range of the path.
struct Feed {
  double speed{
      1e99};  ///< mm/s (deg/s when `metric` is 3) at override 1; 1e99: as fast as the limits allow
  std::int8_t metric{
      0};             ///< axes in which `speed` is measured: 0 XYZ, 6 UVW, 3 ABC; -1: sigma itself
  bool rapid{false};  ///< follows the rapid override
  bool sync{false};   ///< runs in step with a spindle: no override, no programmed speed
  std::int8_t per_rev{-1};  ///< the spindle that carries the feed (G95); -1: none
  double rps{0};            ///< its speed at which `speed` counts
  friend constexpr bool operator==(const Feed&, const Feed&) = default;
};

/// cubic: q = a + b s + c s^2/2 + d s^3/6,  s in [0, length].
/// arc:   q = a + b phi + (radius + growth phi)(c cos phi + d sin phi),  phi = phi0 + rate s; a straight in the axes of b, a circle,
///        helix or spiral in those of c and d (unit vectors).
struct Piece {
  enum class Shape : std::int8_t { cubic, arc };
  Shape shape{Shape::cubic};
  bool stop_at_end{false};  ///< the path stands at its end: exact stop
  double length{0};
  Vec a, b, c, d;
  double phi0{0}, rate{0}, radius{0}, growth{0};
  Feed feed;

  [[nodiscard]] bool straight() const noexcept;
  [[nodiscard]] Vec point(double s) const noexcept;
  [[nodiscard]] Vec first(double s) const noexcept;
  [[nodiscard]] Vec second(double s) const noexcept;
  [[nodiscard]] Vec third(double s) const noexcept;
  /// Two of them at once, bit for bit the same: on arcs the angle is turned only once.
  struct Place {
    Vec point, first;
  };
  [[nodiscard]] Place place(double s) const noexcept;
  struct Bend {
    Vec first, second;
  };
  [[nodiscard]] Bend bend(double s) const noexcept;
};

[[nodiscard]] Piece straight_piece(const Vec& from, const Vec& direction, double length,
                                   const Feed& feed) noexcept;
/// The part of `whole` from s0 to s1.
[[nodiscard]] Piece part_of(const Piece& whole, double s0, double s1) noexcept;

}  // namespace kerf::motion::path
