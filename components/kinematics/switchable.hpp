// Modules whose equations can be switched while the machine stands (manual: "Switchable Kinematics"): kind 0 is the module's own,
// kinds 1 and 2 say that each joint is an axis. `sparm=identityfirst` exchanges kinds 0 and 1. motion.switchkins-type chooses;
// kinstype.is-0 to is-2 tell.
//
//   class Scara final : public SwitchableModule<Scara> {
//    public:
//     static constexpr Letters kLetters{.own = "xyzcab", .needed = "xyzc", .identity = "xyzabc"};
//     explicit Scara(kerf::hal::Builder& b) noexcept : SwitchableModule(b, kLetters) {}
//     bool own_forward(const JointVector& j, Pose& p) const noexcept;
//     bool own_inverse(const Pose& p, JointVector& j) const noexcept;
//   };
#pragma once

#include "kinematics_module.hpp"

namespace kerf::kinematics {

struct Letters {
  std::string_view own;     ///< of the module's own equations
  std::string_view needed;  ///< letters that coordinates= must have
  std::string_view
      identity{};  ///< default of coordinates=, which then is of the identity kinds alone; "": of all kinds
  bool identity_first{false};  ///< kind 0 is identity, and sparm= is not asked for
  std::int32_t kinds{3};
};

template <class Derived>
class SwitchableModule : public KinematicsModule<Derived> {
  using Base = KinematicsModule<Derived>;

 public:
  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept final {
    if (!is_identity()) return self().own_forward(joint, world);
    this->remember(joint);
    identity_.to_pose(joint, world);
    self().show(world);
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept final {
    if (!is_identity()) return self().own_inverse(world, joint);
    identity_.to_joints(world, joint);
    return true;
  }
  [[nodiscard]] std::int32_t joints() const noexcept final {
    return is_identity() ? identity_.joints() : Base::joints();
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept final {
    return is_identity() ? identity_.axis_of(joint) : self().own_axis_of_joint(joint);
  }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept final {
    return is_identity() ? identity_.mask() : Base::axis_mask();
  }
  [[nodiscard]] std::int32_t kinds() const noexcept final { return kinds_; }
  [[nodiscard]] std::int32_t kind() const noexcept final { return kind_; }
  bool switch_to(std::int32_t kind) noexcept final {
    if (kind < 0 || kind >= kinds_) return false;
    kind_ = kind;
    is_[0] = kind == 0;
    is_[1] = kind == 1;
    if (kinds_ > 2) is_[2] = kind == 2;
    return true;
  }

  [[nodiscard]] std::int32_t own_axis_of_joint(std::int32_t) const noexcept { return -1; }
  /// For modules with pins that show the position.
  void show(const Pose&) const noexcept {}

 protected:
  SwitchableModule(hal::Builder& b, const Letters& letters) noexcept
      : Base(b, letters.own, letters.needed, letters.identity.empty() ? false : true),
        kinds_(letters.kinds) {
    if (letters.identity.empty()) {
      identity_ = this->map();
    } else if (!identity_.read(b.arg("coordinates", letters.identity,
                                     "Axis letter of each joint while the kinematics are switched "
                                     "to identity, joint 0 first")) ||
               !identity_.has(letters.needed)) {
      b.fail(
          "coordinates= takes axis letters, and none may be left out that these kinematics turn");
    }
    own_kind_ = letters.identity_first ? 1 : 0;
    if (!letters.identity_first) read_sparm(b);
    is_[0].declare(b, "kinstype.is-0", "Kind 0 of the kinematics is in force", true);
    is_[1].declare(b, "kinstype.is-1", "Kind 1 of the kinematics is in force");
    if (kinds_ > 2) is_[2].declare(b, "kinstype.is-2", "Kind 2 of the kinematics is in force");
  }

 private:
  void read_sparm(hal::Builder& b) noexcept {
    const std::string_view text =
        b.arg("sparm", "", "identityfirst: kind 0 is identity, kind 1 the module's own kinematics");
    if (text == "identityfirst")
      own_kind_ = 1;
    else if (!text.empty())
      b.fail("sparm= is identityfirst, or is left out");
  }
  [[nodiscard]] bool is_identity() const noexcept { return kind_ != own_kind_; }
  [[nodiscard]] const Derived& self() const noexcept { return static_cast<const Derived&>(*this); }

  std::int32_t kinds_, kind_{0}, own_kind_{0};
  JointMap identity_;
  hal::Out<bool> is_[3];
};

}  // namespace kerf::kinematics
