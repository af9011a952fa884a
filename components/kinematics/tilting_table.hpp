// Mills whose table turns about Z and tilts about X (xyzac-trt-kins) or Y (xyzbc-trt-kins): manual, "5-Axis Kinematics".
#pragma once

#include "spheres.hpp"
#include "switchable.hpp"

namespace kerf::kinematics {

/// `kTilt`: 'a' or 'b', the axis that tilts the table; the other one is C, on top of it.
template <class Derived, char kTilt>
class TiltingTable : public SwitchableModule<Derived> {
 public:
  [[nodiscard]] bool own_forward(const JointVector& joint, Pose& world) const noexcept {
    this->map().to_pose(joint, world);
    const Point r = rotation_point(), d = offset();
    const Point at = Point{world.x, world.y, world.z} - r - d;
    const Point turned = about_z(plus(tilted(at, -angle(world)), d), -world.c);
    put(world, plus(turned, r));
    return true;
  }
  [[nodiscard]] bool own_inverse(const Pose& world, JointVector& joint) const noexcept {
    const Point r = rotation_point(), d = offset();
    const Point at = Point{world.x, world.y, world.z} - r;
    const Point turned = tilted(about_z(at, world.c) - d, angle(world));
    Pose joints = world;
    put(joints, plus(turned, plus(d, r)));
    this->map().to_joints(joints, joint);
    return true;
  }
  /// What turns does not move with the others.
  [[nodiscard]] std::int32_t own_axis_of_joint(std::int32_t joint) const noexcept {
    const std::int32_t axis = this->map().axis_of(joint);
    return axis > 2 ? axis : -1;
  }

 protected:
  explicit TiltingTable(hal::Builder& b) noexcept
      : SwitchableModule<Derived>(b, kTilt == 'a' ? Letters{.own = "xyzac", .needed = "xyzac"}
                                                  : Letters{.own = "xyzbc", .needed = "xyzbc"}) {}

 private:
  using Length = hal::In<double>;
  static Point plus(const Point& l, const Point& r) noexcept {
    return {l.x + r.x, l.y + r.y, l.z + r.z};
  }
  static void put(Pose& pose, const Point& at) noexcept {
    pose.x = at.x;
    pose.y = at.y;
    pose.z = at.z;
  }
  static double angle(const Pose& p) noexcept { return kTilt == 'a' ? p.a : p.b; }
  static Point about_z(const Point& p, double degrees) noexcept {
    const double s = sine(degrees), c = cosine(degrees);
    return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  }
  static Point tilted(const Point& p, double degrees) noexcept {
    const double s = sine(degrees), c = cosine(degrees);
    if constexpr (kTilt == 'a') return {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
    return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
  }
  [[nodiscard]] Point rotation_point() const noexcept {
    return {this->mm(x_rot_point_), this->mm(y_rot_point_), this->mm(z_rot_point_)};
  }
  /// From the tilting axis to the turning one; a longer tool moves both down.
  [[nodiscard]] Point offset() const noexcept {
    const double z = this->mm(z_offset_) + this->mm(tool_offset_);
    return kTilt == 'a' ? Point{0, this->mm(y_offset_), z} : Point{this->mm(x_offset_), 0, z};
  }

  Length x_rot_point_{this->template pin<Length>("x-rot-point", "X of the table's turning axis")};
  Length y_rot_point_{this->template pin<Length>("y-rot-point", "Y of the table's turning axis")};
  Length z_rot_point_{this->template pin<Length>("z-rot-point", "Z of the table's turning axis")};
  Length x_offset_{this->template pin<Length>(
      "x-offset", kTilt == 'a' ? "Without effect" : "X from the tilting axis to the turning axis")};
  Length y_offset_{this->template pin<Length>(
      "y-offset", kTilt == 'b' ? "Without effect" : "Y from the tilting axis to the turning axis")};
  Length z_offset_{
      this->template pin<Length>("z-offset", "Z from the tilting axis to the turning axis")};
  Length tool_offset_{this->template pin<Length>(
      "tool-offset", "Length of the tool; link it to motion.tooloffset.z")};
};

}  // namespace kerf::kinematics
