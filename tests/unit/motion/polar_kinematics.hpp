// PolarKinematics: a slide over a turntable, for tests.
#pragma once

#include <cmath>

#include "motion/api/kinematics.hpp"

namespace kerf::motion::test {

/// A slide over a turntable: joints r, angle, Z. Through its pole the table would turn by half a turn in no time.
class PolarKinematics final : public Kinematics {
 public:
  /// `radius`: of the place X0; the pole is at X-radius.
  constexpr explicit PolarKinematics(double radius = 8) : radius_(radius) {}
  [[nodiscard]] KinematicsType type() const noexcept override { return KinematicsType::both; }
  [[nodiscard]] std::int32_t joints() const noexcept override { return 3; }
  [[nodiscard]] bool forward(const JointVector& q, Pose& p) const noexcept override {
    p = Pose{};
    p.x = (radius_ + q[0]) * std::cos(q[1] / kDegrees) - radius_;
    p.y = (radius_ + q[0]) * std::sin(q[1] / kDegrees);
    p.z = q[2];
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& p, JointVector& q) const noexcept override {
    const double x = p.x + radius_, angle = std::atan2(p.y, x) * kDegrees;
    q[0] = std::hypot(x, p.y) - radius_;
    q[1] = angle + 360 * std::round((q[1] - angle) / 360);
    q[2] = p.z;
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t j) const noexcept override {
    return j == 2 ? 2 : -1;
  }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return 0b111; }

 private:
  static constexpr double kDegrees = 180 / 3.14159265358979323846;
  double radius_;
};

}  // namespace kerf::motion::test
