// Vectors in the plane of a spline (G5 to G5.3).
#pragma once

#include <cmath>

namespace kerf::task::spline {

struct Vec {
  double x{0}, y{0};
};
constexpr Vec operator+(Vec a, Vec b) noexcept { return {a.x + b.x, a.y + b.y}; }
constexpr Vec operator-(Vec a, Vec b) noexcept { return {a.x - b.x, a.y - b.y}; }
constexpr Vec operator*(double k, Vec a) noexcept { return {k * a.x, k * a.y}; }
constexpr double dot(Vec a, Vec b) noexcept { return a.x * b.x + a.y * b.y; }
constexpr double cross(Vec a, Vec b) noexcept { return a.x * b.y - a.y * b.x; }
inline double norm(Vec a) noexcept { return std::hypot(a.x, a.y); }

}  // namespace kerf::task::spline
