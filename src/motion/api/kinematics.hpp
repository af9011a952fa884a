// Kinematics: what turns joint positions into axis positions and back.
#pragma once

#include <array>
#include <cstdint>

#include "motion/api/limits.hpp"
#include "rtapi/base/pose.hpp"

namespace kerf::motion {

using rtapi::Pose;
using JointVector = std::array<double, kMaxJoints>;  ///< mm or degrees, joint 0 first

/// The values of KINEMATICS_TYPE (manual: "Kinematics").
enum class KinematicsType : std::int32_t {
  identity = 1,
  forward_only = 2,
  inverse_only = 3,
  both = 4
};

/// Native kinematics: functions of their arguments, of constants fixed at load, of the module's own HAL pins, which are not
/// to change while the machine moves, and of the kind of equations in force. Callable from any thread (@rt).
class Kinematics {
 public:
  [[nodiscard]] virtual KinematicsType type() const noexcept = 0;
  /// How many joints they use.
  [[nodiscard]] virtual std::int32_t joints() const noexcept = 0;
  /// Joint positions to axis positions. Axes without a joint keep what `world` held. False: no solution.
  [[nodiscard]] virtual bool forward(const JointVector& joint, Pose& world) const noexcept = 0;
  /// Axis positions to joint positions. Joints without an axis keep what `joint` held. False: no solution.
  [[nodiscard]] virtual bool inverse(const Pose& world, JointVector& joint) const noexcept = 0;
  /// How many kinds of equations there are to switch between (manual: "Switchable Kinematics"); 1: not switchable.
  [[nodiscard]] virtual std::int32_t kinds() const noexcept { return 1; }
  /// The kind in force, from 0.
  [[nodiscard]] virtual std::int32_t kind() const noexcept { return 0; }
  /// Puts another kind in force; it may change axis_of_joint() and axis_mask() too. Only while nothing moves and nobody else
  /// calls. False: there is no such kind, and all is as before.
  virtual bool switch_to(std::int32_t kind) noexcept { return kind == 0; }
  /// Told before the first cycle: mm in one machine unit, for modules whose HAL pins are lengths.
  virtual void use_unit(double /*unit_mm*/) noexcept {}
  /// Told with it: which joints turn, and which axes the machine has (a bit each); for modules that cannot know.
  virtual void use_machine(std::uint32_t /*rotary_joints*/, std::uint32_t /*axes*/) noexcept {}
  /// For who asks inverse() many times over: true when all answers since the last complete() were real. False: some have yet to be
  /// worked out, and the same must be asked again later. Only for the planner; false only for modules in C.
  [[nodiscard]] virtual bool complete() const noexcept { return true; }
  /// False: inverse() needs the servo cycle's help (complete()), and many questions take long.
  [[nodiscard]] virtual bool answers_at_once() const noexcept { return true; }
  /// The axis that joint j moves alone (index in XYZABCUVW), or -1 when it moves several.
  [[nodiscard]] virtual std::int32_t axis_of_joint(std::int32_t joint) const noexcept = 0;
  /// Bit i: axis i of XYZABCUVW exists.
  [[nodiscard]] virtual std::uint32_t axis_mask() const noexcept = 0;

 protected:
  ~Kinematics() = default;
};

/// Name under which a kinematics module offers its object and motmod asks for it.
inline constexpr const char* kKinematicsService = "kinematics";

}  // namespace kerf::motion
