// trivkins: one joint an axis, or several joints an axis for gantries (manual: kins(9), "trivkins").
#include <cstdint>
#include <string_view>

#include "hal/component.hpp"
#include "motion/api/kinematics.hpp"

namespace {

using kerf::motion::JointVector;
using kerf::motion::kMaxJoints;
using kerf::rtapi::Pose;

class TrivialKinematics final : public kerf::motion::Kinematics {
 public:
  void add(std::int32_t axis) noexcept {
    axis_[joints_++] = axis;
    mask_ |= 1U << static_cast<unsigned>(axis);
  }
  void set_type(kerf::motion::KinematicsType type) noexcept { type_ = type; }

  [[nodiscard]] kerf::motion::KinematicsType type() const noexcept override { return type_; }
  [[nodiscard]] std::int32_t joints() const noexcept override {
    return static_cast<std::int32_t>(joints_);
  }
  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    // Of the joints of one axis the first one says where the axis is.
    for (std::size_t j = joints_; j > 0; --j)
      world[static_cast<std::size_t>(axis_[j - 1])] = joint[j - 1];
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    for (std::size_t j = 0; j < joints_; ++j) joint[j] = world[static_cast<std::size_t>(axis_[j])];
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept override {
    return joint >= 0 && joint < joints() ? axis_[joint] : -1;
  }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return mask_; }

 private:
  std::int32_t axis_[kMaxJoints]{};
  std::size_t joints_{0};
  std::uint32_t mask_{0};
  kerf::motion::KinematicsType type_{kerf::motion::KinematicsType::identity};
};

class Trivkins final : public kerf::hal::Component<Trivkins> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "trivkins",
      .summary = "Kinematics of machines whose joints are their axes",
      .license = "MIT",
      .notes = "Load it before motmod. It has no pins: motmod asks it for the kinematics.",
      .singleton = true};

  explicit Trivkins(kerf::hal::Builder& b) noexcept : Component(b) {
    read_coordinates(
        b, b.arg("coordinates", "xyzabcuvw",
                 "Axis letter of each joint, joint 0 first; a letter may come again (gantry)"));
    read_type(b, b.arg("kinstype", "1", "1: identity, B: both, F: forward only, I: inverse only"));
    kerf::motion::Kinematics* offered = &kinematics_;
    b.provide(kerf::motion::kKinematicsService, offered);
  }

 private:
  void read_coordinates(kerf::hal::Builder& b, std::string_view letters) noexcept {
    std::size_t n = 0;
    for (const char c : letters) {
      if (c == ' ' || c == ',' || c == '\t') continue;
      const int axis = kerf::rtapi::axis_index(c);
      if (axis < 0) {
        b.fail("trivkins: coordinates= takes axis letters of XYZABCUVW only");
        return;
      }
      if (n++ == kMaxJoints) {
        b.fail("trivkins: coordinates= names more than 16 joints");
        return;
      }
      kinematics_.add(axis);
    }
    if (n == 0) b.fail("trivkins: coordinates= names no axis; leave it out for xyzabcuvw");
  }
  void read_type(kerf::hal::Builder& b, std::string_view text) noexcept {
    using Type = kerf::motion::KinematicsType;
    const char c = text.empty() ? '1' : text[0];
    switch (c) {
      case '1': kinematics_.set_type(Type::identity); return;
      case 'b':
      case 'B': kinematics_.set_type(Type::both); return;
      case 'f':
      case 'F': kinematics_.set_type(Type::forward_only); return;
      case 'i':
      case 'I': kinematics_.set_type(Type::inverse_only); return;
      default:
        b.fail(
            "trivkins: kinstype= is 1 (identity), B (both), F (forward only) or I (inverse only)");
    }
  }

  TrivialKinematics kinematics_;
};

}  // namespace

KERF_HAL_MODULE(Trivkins)
