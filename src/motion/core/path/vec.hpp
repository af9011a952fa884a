// Vec: nine numbers, one an axis in XYZABCUVW order; plain array arithmetic for the inner loops of path and profile.
// (rtapi::Pose names its axes; indexing it costs a switch.)
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "rtapi/base/pose.hpp"

namespace kerf::motion::path {

using rtapi::kAxes;

struct Vec {
  std::array<double, kAxes> at{};

  constexpr double& operator[](std::size_t i) noexcept { return at[i]; }
  constexpr double operator[](std::size_t i) const noexcept { return at[i]; }

  friend constexpr bool operator==(const Vec&, const Vec&) = default;
  constexpr Vec& operator+=(const Vec& r) noexcept {
    for (std::size_t i = 0; i < kAxes; ++i) at[i] += r.at[i];
    return *this;
  }
  constexpr Vec& operator-=(const Vec& r) noexcept {
    for (std::size_t i = 0; i < kAxes; ++i) at[i] -= r.at[i];
    return *this;
  }
  constexpr Vec& operator*=(double k) noexcept {
    for (double& v : at) v *= k;
    return *this;
  }
  friend constexpr Vec operator+(Vec l, const Vec& r) noexcept { return l += r; }
  friend constexpr Vec operator-(Vec l, const Vec& r) noexcept { return l -= r; }
  friend constexpr Vec operator*(Vec l, double k) noexcept { return l *= k; }
  friend constexpr Vec operator*(double k, Vec l) noexcept { return l *= k; }

  /// this += k * r
  constexpr void add(double k, const Vec& r) noexcept {
    for (std::size_t i = 0; i < kAxes; ++i) at[i] += k * r.at[i];
  }
};

[[nodiscard]] constexpr double dot(const Vec& a, const Vec& b) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < kAxes; ++i) sum += a[i] * b[i];
  return sum;
}

/// Length in three neighbouring axes: 0 XYZ, 3 ABC, 6 UVW.
[[nodiscard]] inline double norm3(const Vec& v, std::size_t first) noexcept {
  return std::sqrt(v[first] * v[first] + v[first + 1] * v[first + 1] + v[first + 2] * v[first + 2]);
}
[[nodiscard]] inline double max_abs(const Vec& v) noexcept {
  double m = 0;
  for (double x : v.at) m = std::abs(x) > m ? std::abs(x) : m;
  return m;
}

[[nodiscard]] constexpr Vec to_vec(const rtapi::Pose& p) noexcept {
  return {{p.x, p.y, p.z, p.a, p.b, p.c, p.u, p.v, p.w}};
}
[[nodiscard]] constexpr rtapi::Pose to_pose(const Vec& v) noexcept {
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]};
}

}  // namespace kerf::motion::path
