// CanonFrame: the offsets that Canon's set_* calls announced, and program <-> machine coordinates by them.
//
//     machine = R(rotation) * (program + g92) + g5x + tool
//
// Manual: "Coordinate Systems" and "G-code Overview" (the order was confirmed against the peer's G53 and rotation).
#pragma once

#include <array>
#include <cmath>

#include "interp/canon.hpp"

namespace kerf::interp {

/// A direction or a point in x y z.
using Vector3 = std::array<double, 3>;

/// Plain copyable; the owner forwards the Canon calls of the same names. mm and degrees.
class CanonFrame {
 public:
  void set_g5x_offset(const Pose& offset) noexcept { g5x_ = offset; }
  void set_g92_offset(const Pose& offset) noexcept { g92_ = offset; }
  void use_tool_length_offset(const Pose& offset) noexcept { tool_ = offset; }
  void set_xy_rotation(double degrees) noexcept {
    rotation_deg_ = degrees;
    const double rad = degrees * 3.14159265358979323846 / 180.0;
    cos_ = degrees == 0.0 ? 1.0 : std::cos(rad);
    sin_ = degrees == 0.0 ? 0.0 : std::sin(rad);
  }

  [[nodiscard]] const Pose& g5x() const noexcept { return g5x_; }
  [[nodiscard]] const Pose& g92() const noexcept { return g92_; }
  [[nodiscard]] const Pose& tool() const noexcept { return tool_; }
  [[nodiscard]] double rotation_deg() const noexcept { return rotation_deg_; }

  /// Program to machine coordinates (where the carriage goes).
  [[nodiscard]] Pose to_machine(const Pose& program) const noexcept {
    Pose p = program + g92_;
    rotate(p.x, p.y, sin_);
    return p + g5x_ + tool_;
  }
  /// The inverse of to_machine.
  [[nodiscard]] Pose to_program(const Pose& machine) const noexcept {
    Pose p = machine - tool_ - g5x_;
    rotate(p.x, p.y, -sin_);
    return p - g92_;
  }
  /// A point given as x y z, e.g. Arc::center.
  [[nodiscard]] Vector3 to_machine(const Vector3& program) const noexcept {
    Pose p;
    p.x = program[0];
    p.y = program[1];
    p.z = program[2];
    const Pose m = to_machine(p);
    return {m.x, m.y, m.z};
  }
  /// A direction (offsets do not act on it).
  [[nodiscard]] Vector3 direction_to_machine(const Vector3& d) const noexcept {
    Vector3 out = d;
    rotate(out[0], out[1], sin_);
    return out;
  }
  /// Unit normal of an arc plane in machine coordinates: +Z (G17), +Y (G18), +X (G19), turned by the rotation.
  [[nodiscard]] Vector3 normal(Plane plane) const noexcept {
    switch (plane) {
      case Plane::xy: return {0, 0, 1};
      case Plane::xz: return direction_to_machine({0, 1, 0});
      case Plane::yz: return direction_to_machine({1, 0, 0});
      case Plane::uv:
      case Plane::uw:
      case Plane::vw: break;  // no arcs there
    }
    return {0, 0, 1};
  }

  friend bool operator==(const CanonFrame&, const CanonFrame&) = default;

 private:
  void rotate(double& x, double& y, double sine) const noexcept {
    const double x0 = x;
    x = x0 * cos_ - y * sine;
    y = x0 * sine + y * cos_;
  }
  Pose g5x_, g92_, tool_;
  double rotation_deg_{0}, cos_{1}, sin_{0};
};

}  // namespace kerf::interp
