// TableKinematics: a mill whose table turns about Z and tilts about X, without HAL: the equations of components/kinematics/tilting_table.hpp with
// fixed offsets.
#pragma once

#include <cmath>
#include <numbers>

#include "motion/api/kinematics.hpp"

namespace kerf::bench {

/// Joints X Y Z A C; XYZ are those of the work.
class TableKinematics final : public motion::Kinematics {
 public:
  [[nodiscard]] motion::KinematicsType type() const noexcept override {
    return motion::KinematicsType::both;
  }
  [[nodiscard]] std::int32_t joints() const noexcept override { return 5; }
  [[nodiscard]] bool forward(const motion::JointVector& q,
                             motion::Pose& p) const noexcept override {
    const double a = q[3] * kRadian, c = q[4] * kRadian;
    const double y = q[1] - kDown * std::sin(a), z = q[2] - kDown * (1 - std::cos(a));
    const double yt = std::cos(a) * y + std::sin(a) * z, zt = -std::sin(a) * y + std::cos(a) * z;
    p.x = std::cos(c) * q[0] + std::sin(c) * yt;
    p.y = -std::sin(c) * q[0] + std::cos(c) * yt;
    p.z = zt;
    p.a = q[3];
    p.c = q[4];
    return true;
  }
  [[nodiscard]] bool inverse(const motion::Pose& p,
                             motion::JointVector& q) const noexcept override {
    const double a = p.a * kRadian, c = p.c * kRadian;
    const double xt = std::cos(c) * p.x - std::sin(c) * p.y;
    const double yt = std::sin(c) * p.x + std::cos(c) * p.y;
    q[0] = xt;
    q[1] = std::cos(a) * yt - std::sin(a) * p.z + kDown * std::sin(a);
    q[2] = std::sin(a) * yt + std::cos(a) * p.z + kDown * (1 - std::cos(a));
    q[3] = p.a;
    q[4] = p.c;
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t j) const noexcept override {
    return j == 3 ? 3 : j == 4 ? 5 : -1;
  }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return 0b101111; }

 private:
  static constexpr double kRadian = std::numbers::pi / 180;
  static constexpr double kDown = 20;  ///< from the tilting axis down to the work [mm]
};

}  // namespace kerf::bench
