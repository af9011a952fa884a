// 5axiskins: bridge mill with a head that turns (C) and tilts (B) (manual: kins(9), "5axiskins").
#include "switchable.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class FiveAxis final : public SwitchableModule<FiveAxis> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "5axiskins",
      .summary = "Kinematics of a bridge mill with a head that turns about Z and tilts",
      .notes =
          "The tool tip is pivot-length + W away from the tilting axis; W lengthens the tool. "
          "Other letters are joints of their own. Kind 1 of motion.switchkins-type is identity: "
          "each "
          "joint is an axis.",
      .singleton = true};
  explicit FiveAxis(kerf::hal::Builder& b) noexcept
      : SwitchableModule(b, {.own = "xyzbcw", .needed = "xyzbcw"}) {}

  [[nodiscard]] bool own_forward(const JointVector& joint, Pose& world) const noexcept {
    map().to_pose(joint, world);
    shift(world, -1);
    return true;
  }
  [[nodiscard]] bool own_inverse(const Pose& world, JointVector& joint) const noexcept {
    Pose joints = world;
    shift(joints, 1);
    map().to_joints(joints, joint);
    return true;
  }

 private:
  /// From the tip to the pivot (direction 1) or back; B, C and W are the same for both.
  void shift(Pose& p, double direction) const noexcept {
    const double pivot = mm(pivot_length_), radius = pivot + p.w;
    p.x -= direction * radius * sine(p.b) * cosine(p.c);
    p.y -= direction * radius * sine(p.b) * sine(p.c);
    p.z += direction * (radius * cosine(p.b) - pivot);
  }
  using Length = kerf::hal::In<double>;
  Length pivot_length_{pin<Length>(
      "pivot-length", "From the tilting axis to the tip of a tool without length", 250.0)};
};

}  // namespace

KERF_HAL_MODULE(FiveAxis)
