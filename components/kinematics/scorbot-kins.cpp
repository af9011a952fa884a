// scorbot-kins: the Scorbot ER-3, whose shoulder and elbow motors set angles against the level (manual: kins(9)).
#include "kinematics_module.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Scorbot final : public KinematicsModule<Scorbot> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "scorbot-kins",
      .summary = "Kinematics of the Scorbot ER-3",
      .notes =
          "Joints 0 to 2 are the angles of base, upper arm and forearm; the last two are against "
          "the level. X Y Z are the place of the wrist. A and B are joints 3 and 4. The elbow is "
          "above the line from shoulder to wrist.",
      .singleton = true};
  explicit Scorbot(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyzab") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    map().to_pose(joint, world);
    const double out = kShoulderOut + kArm * (cosine(joint[1]) + cosine(joint[2]));
    world.x = out * cosine(joint[0]);
    world.y = out * sine(joint[0]);
    world.z = kShoulderUp + kArm * (sine(joint[1]) + sine(joint[2]));
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    const double before = joint[0];
    map().to_joints(world, joint);
    const double out = std::hypot(world.x, world.y) - kShoulderOut, up = world.z - kShoulderUp;
    const double far = std::hypot(out, up);
    // At the edge of the reach rounding may pass it.
    if (!(far <= 2 * kArm * (1 + 1e-12)) || far < 1e-9) return false;
    const double half = far >= 2 * kArm ? 0.0 : degrees_of(std::acos(far / (2 * kArm)));
    const double level = degrees_of(std::atan2(up, out));
    joint[0] = world.x == 0 && world.y == 0
                   ? before
                   : nearest_turn(degrees_of(std::atan2(world.y, world.x)), before);
    joint[1] = level + half;
    joint[2] = level - half;
    return true;
  }

 private:
  static constexpr double kShoulderOut = 16.0, kShoulderUp = 140.0, kArm = 221.0;  // mm
};

}  // namespace

KERF_HAL_MODULE(Scorbot)
