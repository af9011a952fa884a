// What the kinematics modules beside trivkins share: assignment of letters to joints, angles, and the component around it all.
//
//   class Corexy final : public KinematicsModule<Corexy> {
//    public:
//     static constexpr kerf::hal::Info kInfo{.name = "corexykins", ..., .singleton = true};
//     explicit Corexy(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyz") {}
//     bool forward(const JointVector& j, Pose& p) const noexcept override;   // joints 0.. -> what the module itself turns
//     bool inverse(const Pose& p, JointVector& j) const noexcept override;
//   };
//
// Pins of lengths are in machine units, as those of all HAL; Kerf computes in mm. use_unit() tells how long a unit is.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "hal/component.hpp"
#include "motion/api/kinematics.hpp"
#include "rtapi/sync/seq_cell.hpp"

namespace kerf::kinematics {

using motion::JointVector;
using motion::KinematicsType;
using motion::kMaxJoints;
using rtapi::Pose;

inline constexpr double kDegree = std::numbers::pi / 180.0;
inline double sine(double degrees) noexcept { return std::sin(degrees * kDegree); }
inline double cosine(double degrees) noexcept { return std::cos(degrees * kDegree); }
inline double degrees_of(double radians) noexcept { return radians / kDegree; }

/// The angle that differs from `angle` by whole turns and is nearest to `to`.
inline double nearest_turn(double angle, double to) noexcept {
  return angle + 360.0 * std::round((to - angle) / 360.0);
}

/// 3 by 3 matrix of a rotation.
struct Rotation {
  double m[3][3];
  /// By the angles A about X, then B about Y, then C about Z, all about fixed axes (roll, pitch, yaw).
  static Rotation of_abc(double a, double b, double c) noexcept {
    const double sa = sine(a), ca = cosine(a), sb = sine(b), cb = cosine(b), sc = sine(c),
                 cc = cosine(c);
    return {{{cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa},
             {sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa},
             {-sb, cb * sa, cb * ca}}};
  }
  /// The angles again, in degrees; where B is 90 degrees A is 0.
  void to_abc(double& a, double& b, double& c) const noexcept {
    b = degrees_of(std::atan2(-m[2][0], std::hypot(m[0][0], m[1][0])));
    if (std::hypot(m[0][0], m[1][0]) < 1e-9) {
      a = 0;
      c = degrees_of(m[2][0] < 0 ? std::atan2(-m[0][1], m[1][1]) : std::atan2(-m[0][1], m[1][1]));
      return;
    }
    a = degrees_of(std::atan2(m[2][1], m[2][2]));
    c = degrees_of(std::atan2(m[1][0], m[0][0]));
  }
};

/// Which joint each axis letter has.
class JointMap {
 public:
  /// Letters in the order of joints. False: a letter that is no axis, or too many.
  bool read(std::string_view letters) noexcept {
    joints_ = 0;
    mask_ = 0;
    for (const char c : letters) {
      if (c == ' ' || c == ',' || c == '\t') continue;
      const int axis = rtapi::axis_index(c);
      if (axis < 0 || joints_ == static_cast<std::int32_t>(kMaxJoints)) return false;
      axis_[joints_++] = axis;
      mask_ |= 1U << static_cast<unsigned>(axis);
    }
    return joints_ > 0;
  }
  [[nodiscard]] std::int32_t joints() const noexcept { return joints_; }
  [[nodiscard]] std::uint32_t mask() const noexcept { return mask_; }
  /// -1: no such joint.
  [[nodiscard]] std::int32_t axis_of(std::int32_t joint) const noexcept {
    return joint >= 0 && joint < joints_ ? axis_[joint] : -1;
  }
  [[nodiscard]] bool has(std::string_view letters) const noexcept {
    for (const char c : letters)
      if ((mask_ & (1U << static_cast<unsigned>(rtapi::axis_index(c)))) == 0) return false;
    return true;
  }
  /// Of the joints of one axis the first says where it is.
  void to_pose(const JointVector& joint, Pose& pose) const noexcept {
    for (std::int32_t j = joints_; j > 0; --j)
      pose[static_cast<std::size_t>(axis_[j - 1])] = joint[static_cast<std::size_t>(j - 1)];
  }
  void to_joints(const Pose& pose, JointVector& joint) const noexcept {
    for (std::int32_t j = 0; j < joints_; ++j)
      joint[static_cast<std::size_t>(j)] = pose[static_cast<std::size_t>(axis_[j])];
  }

 private:
  std::int32_t axis_[kMaxJoints]{};
  std::int32_t joints_{0};
  std::uint32_t mask_{0};
};

template <class Derived>
class KinematicsModule : public hal::Component<Derived>, public motion::Kinematics {
 public:
  [[nodiscard]] KinematicsType type() const noexcept override { return KinematicsType::both; }
  [[nodiscard]] std::int32_t joints() const noexcept override { return map_.joints(); }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t) const noexcept override { return -1; }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return map_.mask(); }
  void use_unit(double unit_mm) noexcept override { unit_mm_ = unit_mm; }

 protected:
  /// `letters`: coordinates= when the user gives none; `fixed`: they cannot be given. `needed`: letters that must be among them.
  KinematicsModule(hal::Builder& b, std::string_view letters, std::string_view needed = {},
                   bool fixed = true) noexcept
      : hal::Component<Derived>(b) {
    const std::string_view wanted =
        fixed ? letters
              : b.arg("coordinates", letters,
                      "Axis letter of each joint, joint 0 first; a letter may come again");
    if (!map_.read(wanted))
      b.fail("coordinates= takes axis letters of XYZABCUVW only, 16 at most");
    else if (!map_.has(needed))
      b.fail("coordinates= leaves out a letter that these kinematics turn");
    motion::Kinematics* offered = this;
    b.provide(motion::kKinematicsService, offered);
  }
  [[nodiscard]] const JointMap& map() const noexcept { return map_; }
  /// Called by forward(): where the machine stands, for kinematics with several solutions.
  void remember(const JointVector& joint) const noexcept { stands_.write(joint); }
  /// Where the search for a solution begins: at `joint`, or where the machine stands when that says nothing.
  void begin_at(JointVector& joint) const noexcept {
    for (std::int32_t j = 0; j < map_.joints(); ++j)
      if (joint[static_cast<std::size_t>(j)] != 0.0) return;
    if (JointVector last; stands_.version() > 0 && stands_.read(last, 4)) joint = last;
  }
  /// Millimetres in one machine unit.
  [[nodiscard]] double unit() const noexcept { return unit_mm_; }
  /// A pin's length in mm.
  template <class Pin>
  [[nodiscard]] double mm(const Pin& pin) const noexcept {
    return pin.get() * unit_mm_;
  }

 private:
  JointMap map_;
  double unit_mm_{1.0};
  // Written by who asks for forward kinematics, the motion controller; read by the planner too.
  mutable rtapi::SeqCell<JointVector> stands_;
};

}  // namespace kerf::kinematics
