#include "motion/core/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;
/// Below this XYZ (or UVW) do not count as moving when other axes do, so that rounding never turns a rotary feed into a
/// linear one.
constexpr double kMetricLength = 1e-7;
/// An end on the ray from the centre through the start, within this (mm), is a full turn.
constexpr double kFullCircleAcross = 1e-7;
constexpr double kSmallestRadius = 1e-9;
constexpr double kShortestCubic = 1e-6;
constexpr double kLeastEven = 0.5, kMostEven = 1.5;
/// Arcs that turn farther [rad] get a closed bound of their extent.
constexpr double kClosedBound = 2 * kTwoPi;

double norm3(double x, double y, double z) noexcept { return std::sqrt(x * x + y * y + z * z); }
double dot3(const double* a, const double* b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double group_length(const Pose& d, std::size_t first, std::uint32_t mask) noexcept {
  double sum = 0;
  for (std::size_t i = first; i < first + 3; ++i) {
    if ((mask >> i & 1U) != 0) sum += d[i] * d[i];
  }
  return std::sqrt(sum);
}

/// d(length)/d(angle) at radius r.
double arc_speed(const Curve& c, double r) noexcept {
  return std::sqrt(r * r + c.growth * c.growth + c.axial * c.axial);
}

/// log(1+x)/x, also near 0.
double log1p_over_x(double x) noexcept {
  return std::abs(x) < 1e-8 ? 1.0 - 0.5 * x : std::log1p(x) / x;
}

struct Frame {
  double along[3];   ///< unit vector from the centre to the point
  double across[3];  ///< and its derivative by the angle
};
Frame frame_at(const Curve& c, double phi) noexcept {
  const double cosine = std::cos(phi), sine = std::sin(phi);
  Frame f;
  for (int i = 0; i < 3; ++i) {
    f.along[i] = c.radial[i] * cosine + c.side[i] * sine;
    f.across[i] = c.side[i] * cosine - c.radial[i] * sine;
  }
  return f;
}

/// First derivative by the angle, given the frame there.
Pose slope_in(const Curve& c, const Frame& f, double phi) noexcept {
  const double r = c.radius + c.growth * phi;
  Pose d;
  for (std::size_t i = 0; i < 3; ++i) {
    d[i] = c.axial * c.normal[i] + c.growth * f.along[i] + r * f.across[i];
  }
  for (std::size_t i = 3; i < rtapi::kAxes; ++i) d[i] = (c.end[i] - c.start[i]) / c.angle;
  return d;
}

/// A cubic has its extremes where its first derivative, a quadratic, is 0.
template <class Take>
void take_cubic(const Curve& curve, Take&& take) noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const double a = curve.third[i] / 2, b = curve.second[i], c = curve.first[i];
    const double root = b * b - 4 * a * c;
    if (!(root >= 0)) continue;
    const double q = -0.5 * (b + std::copysign(std::sqrt(root), b));
    for (const double s : {a != 0 ? q / a : -1.0, q != 0 ? c / q : -1.0})
      if (s > 0 && s < curve.length) take(i, point_at(curve, s)[i]);
  }
}

/// Bound of an arc of many turns: its rings all around, at their largest, moved along the axis. O(1), never too small.
template <class Take>
void take_rings(const Curve& c, Take&& take) noexcept {
  const double r = std::max(c.radius, c.radius + c.growth * c.angle);
  for (std::size_t i = 0; i < 3; ++i) {
    const double reach = r * std::hypot(c.radial[i], c.side[i]);
    const double along = c.axial * c.angle * c.normal[i];
    take(i, c.base[i] + std::min(0.0, along) - reach);
    take(i, c.base[i] + std::max(0.0, along) + reach);
  }
}

}  // namespace

bool is_finite(const Pose& p) noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (!std::isfinite(p[i])) return false;
  }
  return true;
}

bool make_cubic(const Pose& start, const CubicMove& move, Curve& out) noexcept {
  if (!is_finite(start) || !is_finite(move.end) || !is_finite(move.first) ||
      !is_finite(move.second) || !std::isfinite(move.length))
    return false;
  out = Curve{};
  out.start = start;
  out.end = move.end;
  const double l = move.length;
  if (!(l > kShortestCubic)) return false;
  out.shape = Curve::Shape::cubic;
  out.metric = FeedMetric::xyz;
  out.length = l;
  out.first = move.first;
  out.second = move.second;
  out.third = (move.end - start - move.first * l - move.second * (l * l / 2)) * (6 / (l * l * l));
  // Whoever says that it is by its length is taken at its word only so far.
  const auto even = [](const Pose& d) {
    const double speed = norm3(d.x, d.y, d.z);
    return speed > kLeastEven && speed < kMostEven;
  };
  const Pose middle = out.first + out.second * (l / 2) + out.third * (l * l / 8);
  return even(out.first) && even(middle) &&
         even(out.first + out.second * l + out.third * (l * l / 2));
}

bool make_line(const Pose& start, const Pose& end, std::uint32_t axis_mask, Curve& out) noexcept {
  if (!is_finite(start) || !is_finite(end)) return false;
  out = Curve{};
  out.start = start;
  out.end = end;
  const Pose d = end - start;
  const double xyz = group_length(d, 0, axis_mask), abc = group_length(d, 3, axis_mask),
               uvw = group_length(d, 6, axis_mask);
  if (std::max({xyz, abc, uvw}) <= kPointLength) return true;
  out.shape = Curve::Shape::line;
  if (xyz > kMetricLength || (xyz >= uvw && xyz >= abc)) {
    out.metric = FeedMetric::xyz;
    out.length = xyz;
  } else if (uvw > kMetricLength || uvw >= abc) {
    out.metric = FeedMetric::uvw;
    out.length = uvw;
  } else {
    out.metric = FeedMetric::abc;
    out.length = abc;
  }
  return true;
}

bool make_arc(const Pose& start, const ArcMove& move, Curve& out) noexcept {
  if (!is_finite(start) || !is_finite(move.end) || move.turns < 1) return false;
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(move.centre[i]) || !std::isfinite(move.normal[i])) return false;
  }
  const double normal_length = norm3(move.normal[0], move.normal[1], move.normal[2]);
  if (std::abs(normal_length - 1.0) > 1e-6) return false;
  out = Curve{};
  out.shape = Curve::Shape::arc;
  out.metric = FeedMetric::xyz;
  out.start = start;
  out.end = move.end;
  double from[3], to[3];
  for (std::size_t i = 0; i < 3; ++i) {
    out.normal[i] = move.normal[i] / normal_length;
    from[i] = start[i] - move.centre[i];
    to[i] = move.end[i] - move.centre[i];
  }
  const double height0 = dot3(from, out.normal), height1 = dot3(to, out.normal);
  for (int i = 0; i < 3; ++i) {
    out.base[i] = move.centre[i] + height0 * out.normal[i];
    from[i] -= height0 * out.normal[i];
    to[i] -= height1 * out.normal[i];
  }
  out.radius = norm3(from[0], from[1], from[2]);
  const double end_radius = norm3(to[0], to[1], to[2]);
  if (out.radius < kSmallestRadius || end_radius < kSmallestRadius) return false;
  for (int i = 0; i < 3; ++i) out.radial[i] = from[i] / out.radius;
  out.side[0] = out.normal[1] * out.radial[2] - out.normal[2] * out.radial[1];
  out.side[1] = out.normal[2] * out.radial[0] - out.normal[0] * out.radial[2];
  out.side[2] = out.normal[0] * out.radial[1] - out.normal[1] * out.radial[0];
  const double across = dot3(to, out.side), along = dot3(to, out.radial);
  double angle = std::atan2(across, along);
  if (along > 0 && std::abs(across) < kFullCircleAcross) {
    angle = kTwoPi;
  } else if (angle <= 0) {
    angle += kTwoPi;
  }
  out.angle = angle + kTwoPi * (move.turns - 1);
  // Radii that differ by rounding only make a circle, which needs no Newton iteration in the servo cycle.
  const double spread = end_radius - out.radius;
  out.growth = std::abs(spread) <= 1e-12 * out.radius ? 0.0 : spread / out.angle;
  out.axial = (height1 - height0) / out.angle;
  out.length = arc_length_to(out, out.angle);
  return std::isfinite(out.length);
}

double arc_length_to(const Curve& c, double phi) noexcept {
  const double r0 = c.radius, s0 = arc_speed(c, r0);
  if (c.growth == 0) return phi * s0;
  // Integral of sqrt(r^2 + m^2) over the angle, r = r0 + growth*phi, arranged so that nothing cancels for small growth.
  const double r1 = r0 + c.growth * phi, s1 = arc_speed(c, r1);
  const double m2 = c.growth * c.growth + c.axial * c.axial;
  const double slope = (r1 + r0) / (s1 + s0);
  const double q = (1.0 + slope) / (r0 + s0);
  return 0.5 * phi * (s1 + r0 * slope + m2 * q * log1p_over_x(q * c.growth * phi));
}

double arc_angle_at(const Curve& c, double s) noexcept {
  if (s <= 0) return 0;
  if (s >= c.length) return c.angle;
  if (c.growth == 0) return c.angle * (s / c.length);
  // First guess: the speed d(length)/d(angle) taken as linear in the angle.
  const double s0 = arc_speed(c, c.radius), s1 = arc_speed(c, c.radius + c.growth * c.angle);
  const double rise = (s1 - s0) / c.angle;
  double phi = 2.0 * s / (s0 + std::sqrt(std::max(s0 * s0 + 2.0 * rise * s, 0.0)));
  phi = std::clamp(phi, 0.0, c.angle);
  for (int i = 0; i < 12; ++i) {
    const double step = (arc_length_to(c, phi) - s) / arc_speed(c, c.radius + c.growth * phi);
    phi = std::clamp(phi - step, 0.0, c.angle);
    if (std::abs(step) <= 1e-14 * c.angle) break;
  }
  return phi;
}

Pose arc_point(const Curve& c, double phi) noexcept {
  const Frame f = frame_at(c, phi);
  const double share = phi / c.angle, r = c.radius + c.growth * phi;
  Pose p = c.start;
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = c.base[i] + c.axial * phi * c.normal[i] + r * f.along[i];
  }
  for (std::size_t i = 3; i < rtapi::kAxes; ++i) p[i] += (c.end[i] - c.start[i]) * share;
  return p;
}

Pose arc_slope(const Curve& c, double phi) noexcept { return slope_in(c, frame_at(c, phi), phi); }

Pose point_at(const Curve& c, double s) noexcept {
  if (s <= 0) return c.start;
  if (s >= c.length) return c.end;
  if (c.shape == Curve::Shape::arc) return arc_point(c, arc_angle_at(c, s));
  if (c.shape == Curve::Shape::cubic)
    return c.start + c.first * s + c.second * (s * s / 2) + c.third * (s * s * s / 6);
  return c.start + (c.end - c.start) * (s / c.length);
}

void derivatives_at(const Curve& c, double s, Pose& first, Pose& second) noexcept {
  second = Pose{};
  if (c.shape == Curve::Shape::cubic) {
    first = c.first + c.second * s + c.third * (s * s / 2);
    second = c.second + c.third * s;
    return;
  }
  if (c.shape != Curve::Shape::arc) {
    first = c.length > 0 ? (c.end - c.start) * (1.0 / c.length) : Pose{};
    return;
  }
  const double phi = arc_angle_at(c, s), r = c.radius + c.growth * phi;
  const double speed = arc_speed(c, r);
  const double rate = 1.0 / speed, rate2 = -r * c.growth / (speed * speed * speed * speed);
  const Frame f = frame_at(c, phi);
  const Pose slope = slope_in(c, f, phi);
  first = slope * rate;
  second = slope * rate2;
  for (std::size_t i = 0; i < 3; ++i) {
    second[i] += (2.0 * c.growth * f.across[i] - r * f.along[i]) * rate * rate;
  }
}

void extent_of(const Curve& c, Pose& low, Pose& high) noexcept {
  const auto take = [&](std::size_t i, double v) {
    low[i] = std::min(low[i], v);
    high[i] = std::max(high[i], v);
  };
  low = high = c.start;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) take(i, c.end[i]);
  if (c.shape == Curve::Shape::cubic) return take_cubic(c, take);
  if (c.shape != Curve::Shape::arc) return;
  if (c.angle > kClosedBound) return take_rings(c, take);
  // Extremes of XYZ: where the slope changes its sign between two samples, found by bisection.
  const int samples = static_cast<int>(c.angle / 0.1) + 2;
  double phi0 = 0;
  Pose slope0 = arc_slope(c, 0);
  for (int k = 1; k <= samples; ++k) {
    const double phi1 = c.angle * k / samples;
    const Pose slope1 = arc_slope(c, phi1);
    for (std::size_t i = 0; i < 3; ++i) {
      if (slope1[i] == 0 && slope0[i] != 0) take(i, arc_point(c, phi1)[i]);
      if (slope0[i] * slope1[i] >= 0) continue;
      double a = phi0, b = phi1;
      for (int n = 0; n < 40; ++n) {
        const double mid = 0.5 * (a + b);
        (arc_slope(c, mid)[i] * slope0[i] > 0 ? a : b) = mid;
      }
      take(i, arc_point(c, 0.5 * (a + b))[i]);
    }
    phi0 = phi1;
    slope0 = slope1;
  }
}

}  // namespace kerf::motion
