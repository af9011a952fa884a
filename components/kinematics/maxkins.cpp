// maxkins: a mill with a tilting head (B) and a turning table (C); U V W move along the tool (manual: kins(9), "maxkins").
#include "kinematics_module.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Max final : public KinematicsModule<Max> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "maxkins",
      .summary = "Kinematics of a mill with a tilting head and a turning table",
      .notes =
          "Joints 0 to 8 are X Y Z A B C U V W. The tool tip is pivot-length + W away from the "
          "tilting axis; U moves it square to the tool, V along Y. X Y Z are the tip's place on "
          "the table that C turns.",
      .singleton = true};
  explicit Max(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyzabcuvw") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    map().to_pose(joint, world);
    const Tip tip = of(world);
    const double x = world.x + tip.x, y = world.y - world.v;
    world.x = x * cosine(world.c) - y * sine(world.c);
    world.y = x * sine(world.c) + y * cosine(world.c);
    world.z += tip.z;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    Pose joints = world;
    const Tip tip = of(world);
    joints.x = world.x * cosine(world.c) + world.y * sine(world.c) - tip.x;
    joints.y = world.y * cosine(world.c) - world.x * sine(world.c) + world.v;
    joints.z -= tip.z;
    map().to_joints(joints, joint);
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept override {
    const std::int32_t axis = map().axis_of(joint);
    return axis > 2 ? axis : -1;
  }

 private:
  /// Where the tip is, seen from where it would be with the head upright.
  struct Tip {
    double x, z;
  };
  [[nodiscard]] Tip of(const Pose& p) const noexcept {
    const double pivot = mm(pivot_length_), s = sine(p.b), c = cosine(p.b);
    return {(pivot + p.w) * s - p.u * c, pivot - (pivot + p.w) * c - p.u * s};
  }
  using Length = kerf::hal::Io<double>;
  Length pivot_length_{pin<Length>(
      "pivot-length", "From the tilting axis to the tip of a tool without length", 0.666)};
};

}  // namespace

KERF_HAL_MODULE(Max)
