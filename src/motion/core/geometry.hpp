// Geometry: lines, arcs, helices and spirals in nine axes, by arc length. Pure arithmetic, @rt.
#pragma once

#include <cstdint>

#include "motion/api/path_items.hpp"
#include "rtapi/base/pose.hpp"

namespace kerf::motion {

/// Which axes measure a move (manual "Feed Rate"): XYZ if they move, else UVW, else ABC.
enum class FeedMetric : std::int32_t { none = 0, xyz = 1, uvw = 2, abc = 3 };

/// One piece of path. `length` is its length in the feed metric (mm, or degrees for abc), and the parameter `s` of all
/// functions runs from 0 to it.
struct Curve {
  enum class Shape : std::int32_t { point = 0, line = 1, arc = 2, cubic = 3 };
  Shape shape{Shape::point};
  FeedMetric metric{FeedMetric::none};
  double length{0};
  Pose start, end;
  // Arc: p(phi) = base + axial*phi*normal + (radius + growth*phi) * (radial*cos(phi) + side*sin(phi)); the other axes
  // are linear in phi.
  double base[3]{}, radial[3]{}, side[3]{}, normal[3]{};
  double angle{0};   ///< whole sweep [rad], more than 2 pi for several turns
  double radius{0};  ///< at the start [mm]
  double growth{0};  ///< of the radius [mm/rad]
  double axial{0};   ///< along the normal [mm/rad]
  // Cubic: p(s) = start + first s + second s^2/2 + third s^3/6.
  Pose first, second, third;
};

/// Moves below this length (mm or degrees, in every axis) are points: they take no time.
inline constexpr double kPointLength = 1e-9;

/// Only the axes in `axis_mask` count for the length; the others ride along. False: NaN or infinity.
[[nodiscard]] bool make_line(const Pose& start, const Pose& end, std::uint32_t axis_mask,
                             Curve& out) noexcept;
/// False: NaN or infinity, a radius of zero, a normal that is no unit vector, no turns.
[[nodiscard]] bool make_arc(const Pose& start, const ArcMove& move, Curve& out) noexcept;

/// False: NaN or infinity, no length, a derivative that is not that of a length.
[[nodiscard]] bool make_cubic(const Pose& start, const CubicMove& move, Curve& out) noexcept;

/// Point at s; exactly `start` at 0 and `end` at `length`.
[[nodiscard]] Pose point_at(const Curve& c, double s) noexcept;
/// First and second derivative by s.
void derivatives_at(const Curve& c, double s, Pose& first, Pose& second) noexcept;

/// Arc: the angle at s and the length up to an angle. Exact for spirals: closed form of the length, Newton back.
[[nodiscard]] double arc_angle_at(const Curve& c, double s) noexcept;
[[nodiscard]] double arc_length_to(const Curve& c, double phi) noexcept;
/// Arc: point and first derivative by the angle.
[[nodiscard]] Pose arc_point(const Curve& c, double phi) noexcept;
[[nodiscard]] Pose arc_slope(const Curve& c, double phi) noexcept;

/// Smallest and largest value of each axis over the whole curve, with the extremes inside an arc.
void extent_of(const Curve& c, Pose& low, Pose& high) noexcept;

[[nodiscard]] bool is_finite(const Pose& p) noexcept;

}  // namespace kerf::motion
