// millturn: a mill whose rotary table A is also the spindle of a lathe (manual: millturn(9)).
#include "switchable.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class MillTurn final : public SwitchableModule<MillTurn> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "millturn",
      .summary = "Kinematics of a mill that turns too: kind 0 XYZA, kind 1 a lathe's Z -Y X",
      .notes =
          "Joints 0 to 3 are X Y Z A of the mill. In kind 1 of motion.switchkins-type, turning, "
          "joint "
          "0 is Z, joint 1 is -Y and joint 2 is X; joint 3 stays A, and its motor is the spindle. "
          "The "
          "pin and the function are not part of the kinematics.",
      .singleton = true};
  explicit MillTurn(kerf::hal::Builder& b) noexcept
      : SwitchableModule(b, {.own = "xyza", .needed = "xyza", .identity_first = true, .kinds = 2}) {
  }

  [[nodiscard]] bool own_forward(const JointVector& joint, Pose& world) const noexcept {
    Pose mill = world;
    map().to_pose(joint, mill);
    world.x = mill.z;
    world.y = -mill.y;
    world.z = mill.x;
    world.a = mill.a;
    return true;
  }
  [[nodiscard]] bool own_inverse(const Pose& world, JointVector& joint) const noexcept {
    Pose mill = world;
    mill.x = world.z;
    mill.y = -world.y;
    mill.z = world.x;
    map().to_joints(mill, joint);
    return true;
  }
  [[nodiscard]] std::int32_t own_axis_of_joint(std::int32_t joint) const noexcept {
    // Y runs the other way, which is no plain axis.
    constexpr std::int32_t kTurned[] = {2, -1, 0, 3};
    const std::int32_t axis = map().axis_of(joint);
    return axis >= 0 && axis < 4 ? kTurned[axis] : axis;
  }

 private:
  kerf::hal::Out<std::int32_t> fpin_{builder(), "millturn.0.fpin", "How often fdemo ran"};
  void demo(const kerf::hal::Period&) noexcept { fpin_ = fpin_.last() + 1; }
  kerf::hal::Function demo_{
      function_named<&MillTurn::demo>("millturn.0.fdemo", "Counts its calls in fpin")};
};

}  // namespace

KERF_HAL_MODULE(MillTurn)
