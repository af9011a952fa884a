// Where three spheres meet: the forward kinematics of machines that hold a point by three rods or struts (trilateration).
#pragma once

#include <cmath>

namespace kerf::kinematics {

struct Point {
  double x{0}, y{0}, z{0};
  friend Point operator-(const Point& l, const Point& r) noexcept {
    return {l.x - r.x, l.y - r.y, l.z - r.z};
  }
};
inline double dot(const Point& a, const Point& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Point cross(const Point& a, const Point& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Point scaled(const Point& a, double k) noexcept { return {a.x * k, a.y * k, a.z * k}; }

/// Both points; `low` is the one with the smaller z. False: they do not meet, or the centres lie on a line.
inline bool meet(const Point (&centre)[3], const double (&radius)[3], Point& low,
                 Point& high) noexcept {
  const Point to1 = centre[1] - centre[0];
  const double d = std::sqrt(dot(to1, to1));
  if (d < 1e-12) return false;
  const Point ex = scaled(to1, 1.0 / d);
  const Point to2 = centre[2] - centre[0];
  const double i = dot(ex, to2);
  Point ey = to2 - scaled(ex, i);
  const double j = std::sqrt(dot(ey, ey));
  if (j < 1e-12) return false;
  ey = scaled(ey, 1.0 / j);
  const Point ez = cross(ex, ey);
  const double r0 = radius[0] * radius[0], r1 = radius[1] * radius[1], r2 = radius[2] * radius[2];
  const double x = (r0 - r1 + d * d) / (2 * d);
  const double y = (r0 - r2 + i * i + j * j) / (2 * j) - i / j * x;
  const double square = r0 - x * x - y * y;
  if (!(square >= 0)) return false;
  const double z = std::sqrt(square);
  const auto at = [&](double height) {
    return Point{centre[0].x + x * ex.x + y * ey.x + height * ez.x,
                 centre[0].y + x * ex.y + y * ey.y + height * ez.y,
                 centre[0].z + x * ex.z + y * ey.z + height * ez.z};
  };
  const Point a = at(z), b = at(-z);
  low = a.z <= b.z ? a : b;
  high = a.z <= b.z ? b : a;
  return true;
}

}  // namespace kerf::kinematics
