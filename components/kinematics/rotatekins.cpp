// rotatekins: X and Y turned against joints 0 and 1 by the angle of C (manual: kins(9), "rotatekins").
#include "kinematics_module.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Rotate final : public KinematicsModule<Rotate> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "rotatekins",
      .summary = "Kinematics of machines whose X and Y turn with C",
      .notes =
          "Joints 0 to 8 are X Y Z A B C U V W; joints 0 and 1 are X and Y turned by joint 5, "
          "degrees.",
      .singleton = true};
  explicit Rotate(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyzabcuvw") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    map().to_pose(joint, world);
    const double s = sine(world.c), c = cosine(world.c);
    world.x = joint[0] * c + joint[1] * s;
    world.y = joint[1] * c - joint[0] * s;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    map().to_joints(world, joint);
    const double s = sine(world.c), c = cosine(world.c);
    joint[0] = world.x * c - world.y * s;
    joint[1] = world.y * c + world.x * s;
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept override {
    const std::int32_t axis = map().axis_of(joint);
    return axis > 1 ? axis : -1;
  }
};

}  // namespace

KERF_HAL_MODULE(Rotate)
