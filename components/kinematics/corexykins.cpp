// corexykins: two motors share X and Y (manual: kins(9), "corexykins").
#include "kinematics_module.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Corexy final : public KinematicsModule<Corexy> {
 public:
  static constexpr kerf::hal::Info kInfo{.name = "corexykins",
                                         .summary = "Kinematics of CoreXY machines",
                                         .notes =
                                             "X = (joint 0 + joint 1) / 2, Y = (joint 0 - joint 1) "
                                             "/ 2; Z A B C U V W are joints 2 to 8.",
                                         .singleton = true};
  explicit Corexy(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyzabcuvw") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    map().to_pose(joint, world);
    world.x = 0.5 * (joint[0] + joint[1]);
    world.y = 0.5 * (joint[0] - joint[1]);
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    map().to_joints(world, joint);
    joint[0] = world.x + world.y;
    joint[1] = world.x - world.y;
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept override {
    return joint >= 2 && joint < joints() ? joint : -1;
  }
};

}  // namespace

KERF_HAL_MODULE(Corexy)
