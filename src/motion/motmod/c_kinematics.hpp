// Kinematics of modules in C: those that export kinematicsForward and its companions (src/hal/capi/include/kinematics.h). Such
// functions know nothing of threads, so only the servo cycle calls them; the planner's questions go there and come back (AskedKinematics).
#pragma once

#include <cstdint>

#include "hal/component.hpp"
#include "motion/api/kinematics.hpp"

namespace kerf::motion {

/// The functions of a loaded module, with lengths in machine units as such modules have them. For the servo cycle alone.
class CKinematics final : public Kinematics {
 public:
  /// Found or not, see found(). `joints`: those that kinematics move.
  CKinematics(hal::Builder& b, std::int32_t joints) noexcept;
  [[nodiscard]] bool found() const noexcept { return forward_ != nullptr; }

  [[nodiscard]] KinematicsType type() const noexcept override { return type_; }
  [[nodiscard]] std::int32_t joints() const noexcept override { return joints_; }
  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override;
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override;
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept override;
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return axes_; }
  [[nodiscard]] std::int32_t kinds() const noexcept override { return kinds_; }
  [[nodiscard]] std::int32_t kind() const noexcept override { return kind_; }
  bool switch_to(std::int32_t kind) noexcept override;
  void use_unit(double unit_mm) noexcept override { unit_mm_ = unit_mm; }
  void use_machine(std::uint32_t rotary_joints, std::uint32_t axes) noexcept override {
    rotary_ = rotary_joints;
    if (axes != 0) axes_ = axes;
  }

 private:
  static constexpr std::uint32_t kAllAxes = 0x1FF;
  using Flags = unsigned long;  // NOLINT(google-runtime-int): the published type
  /// As struct EmcPose is laid out.
  struct CPose {
    double axis[rtapi::kAxes];
  };
  using Forward = int (*)(const double*, CPose*, const Flags*, Flags*);
  using Inverse = int (*)(const CPose*, double*, const Flags*, Flags*);
  using Number = int (*)();
  using Switch = int (*)(int);

  void find_axes() noexcept;
  [[nodiscard]] double joint_unit(std::size_t j) const noexcept {
    return (rotary_ >> j & 1U) != 0 ? 1.0 : unit_mm_;
  }
  [[nodiscard]] double axis_unit(std::size_t i) const noexcept {
    return rtapi::is_rotary(i) ? 1.0 : unit_mm_;
  }

  Forward forward_{nullptr};
  Inverse inverse_{nullptr};
  Number type_of_{nullptr}, switchable_{nullptr};
  Switch switch_{nullptr};
  KinematicsType type_{KinematicsType::both};
  std::int32_t joints_, kinds_{1}, kind_{0};
  std::int32_t axis_of_[kMaxJoints];  ///< of identity kinematics
  std::uint32_t rotary_{0}, axes_{kAllAxes};
  double unit_mm_{1};
  // What the functions tell each other about several solutions.
  mutable Flags forward_flags_{0}, inverse_flags_{0};
};

}  // namespace kerf::motion
