#include "motion/motmod/c_kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {

CKinematics::CKinematics(hal::Builder& b, std::int32_t joints) noexcept : joints_(joints) {
  std::fill(std::begin(axis_of_), std::end(axis_of_), -1);
  const auto find = [&b](const char* name, auto& function) {
    function =
        reinterpret_cast<std::remove_reference_t<decltype(function)>>(b.find_c_function(name));
    return function != nullptr;
  };
  // The one that must be there last, so that found() means all.
  if (!find("kinematicsInverse", inverse_) || !find("kinematicsType", type_of_)) return;
  (void)find("kinematicsSwitchable", switchable_);
  (void)find("kinematicsSwitch", switch_);
  if (!find("kinematicsForward", forward_)) return;
  // The first question may be the one in which the module makes its pins.
  struct Asked {
    Number type;
    Number switchable;
    int answer{0}, may_switch{0};
  } asked{type_of_, switchable_};
  b.call_c(
      [](void* object) {
        auto& a = *static_cast<Asked*>(object);
        a.answer = a.type();
        if (a.switchable != nullptr) a.may_switch = a.switchable();
      },
      &asked);
  if (asked.answer < 1 || asked.answer > 4) {
    b.fail(
        "motmod: kinematicsType() of the kinematics module gives a number that is none of 1 to 4");
    return;
  }
  type_ = static_cast<KinematicsType>(asked.answer);
  constexpr std::int32_t kMostKinds = 16;  // which of them there are, kinematicsSwitch() says
  if (asked.may_switch != 0 && switch_ != nullptr) kinds_ = kMostKinds;
  if (type_ == KinematicsType::identity) find_axes();
}

/// Each joint of identity kinematics is an axis; which, the functions tell.
void CKinematics::find_axes() noexcept {
  const JointVector none{};
  Pose zero;
  if (!forward(none, zero)) return;
  for (std::size_t j = 0; j < static_cast<std::size_t>(joints_) && j < kMaxJoints; ++j) {
    // The other way round: of several joints of an axis forward looks at one.
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      Pose moved = zero;
      moved[i] += 1;
      JointVector before{}, after{};
      if (!inverse(zero, before) || !inverse(moved, after)) continue;
      if (std::fabs(after[j] - before[j] - 1) < 1e-9) axis_of_[j] = static_cast<std::int32_t>(i);
    }
  }
}

std::int32_t CKinematics::axis_of_joint(std::int32_t joint) const noexcept {
  return joint >= 0 && joint < joints_ ? axis_of_[joint] : -1;
}

bool CKinematics::forward(const JointVector& joint, Pose& world) const noexcept {
  double joints[kMaxJoints];
  CPose pose;
  for (std::size_t j = 0; j < kMaxJoints; ++j) joints[j] = joint[j] / joint_unit(j);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) pose.axis[i] = world[i] / axis_unit(i);
  if (forward_(joints, &pose, &forward_flags_, &inverse_flags_) < 0) return false;
  for (const double value : pose.axis)
    if (!std::isfinite(value)) return false;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) world[i] = pose.axis[i] * axis_unit(i);
  return true;
}

bool CKinematics::inverse(const Pose& world, JointVector& joint) const noexcept {
  double joints[kMaxJoints];
  CPose pose;
  for (std::size_t j = 0; j < kMaxJoints; ++j) joints[j] = joint[j] / joint_unit(j);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) pose.axis[i] = world[i] / axis_unit(i);
  if (inverse_(&pose, joints, &inverse_flags_, &forward_flags_) < 0) return false;
  for (const double value : joints)
    if (!std::isfinite(value)) return false;
  for (std::size_t j = 0; j < kMaxJoints; ++j) joint[j] = joints[j] * joint_unit(j);
  return true;
}

bool CKinematics::switch_to(std::int32_t kind) noexcept {
  if (kind == kind_) return true;
  if (kind < 0 || kind >= kinds_) return false;
  if (switch_(kind) != 0) {
    (void)switch_(kind_);
    return false;
  }
  kind_ = kind;
  return true;
}

}  // namespace kerf::motion
