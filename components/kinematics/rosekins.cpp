// rosekins: a rose engine: a slide across, a slide along, a spindle that turns (manual: kins(9), "rosekins").
#include "kinematics_module.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Rose final : public KinematicsModule<Rose> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "rosekins",
      .summary = "Kinematics of a rose engine",
      .notes =
          "Joint 0 is the distance of the tool from the turning axis, joint 1 is Z, joint 2 the "
          "angle in degrees, over any number of turns: the inverse takes the turn nearest to where "
          "the machine stands.",
      .singleton = true};
  explicit Rose(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyz") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    remember(joint);
    world.x = joint[0] * cosine(joint[2]);
    world.y = joint[0] * sine(joint[2]);
    world.z = joint[1];
    const double turns = std::round(joint[2] / 360.0);
    theta_ = joint[2] - 360.0 * turns;
    bigtheta_ = joint[2];
    revolutions_ = turns;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    begin_at(joint);
    const double radius = std::hypot(world.x, world.y);
    if (!std::isfinite(radius)) return false;
    joint[0] = radius;
    joint[1] = world.z;
    // In the middle every angle is right.
    if (radius > 0) joint[2] = nearest_turn(degrees_of(std::atan2(world.y, world.x)), joint[2]);
    return true;
  }

 private:
  using Shown = kerf::hal::Out<double>;
  // Shown, and no part of the computation; the motion controller asks for the forward kinematics in each cycle.
  mutable Shown theta_{pin<Shown>("theta_degrees", "Angle within half a turn of 0")};
  mutable Shown bigtheta_{pin<Shown>("bigtheta_degrees", "Angle over all turns")};
  mutable Shown revolutions_{pin<Shown>("revolutions", "Whole turns between the two")};
};

}  // namespace

KERF_HAL_MODULE(Rose)
