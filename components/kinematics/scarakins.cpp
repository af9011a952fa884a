// scarakins: two arms that turn in the plane, a quill, a wrist (manual: kins(9), "scarakins").
#include "switchable.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Scara final : public SwitchableModule<Scara> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "scarakins",
      .summary = "Kinematics of SCARA robots",
      .notes =
          "Joints 0, 1 and 3 are angles of inner arm, outer arm and wrist, joint 2 lowers the "
          "quill; joints 4 and 5 are A and B. Kind 1 of motion.switchkins-type is identity.",
      .singleton = true};
  explicit Scara(kerf::hal::Builder& b) noexcept
      : SwitchableModule(b, {.own = "xyzcab", .needed = "xyzc", .identity = "xyzabc"}) {}

  [[nodiscard]] bool own_forward(const JointVector& joint, Pose& world) const noexcept {
    remember(joint);
    map().to_pose(joint, world);
    const double inner = joint[0], outer = inner + joint[1], wrist = outer + joint[3];
    world.x = mm(d2_) * cosine(inner) + mm(d4_) * cosine(outer) + mm(d6_) * cosine(wrist);
    world.y = mm(d2_) * sine(inner) + mm(d4_) * sine(outer) + mm(d6_) * sine(wrist);
    world.z = mm(d1_) + mm(d3_) - joint[2] - mm(d5_);
    world.c = wrist;
    return true;
  }
  [[nodiscard]] bool own_inverse(const Pose& world, JointVector& joint) const noexcept {
    begin_at(joint);
    const double base_before = joint[0], before = joint[1];
    map().to_joints(world, joint);
    const double x = world.x - mm(d6_) * cosine(world.c), y = world.y - mm(d6_) * sine(world.c);
    const double inner = mm(d2_), outer = mm(d4_);
    const double bend = (x * x + y * y - inner * inner - outer * outer) / (2 * inner * outer);
    // At the edge of the reach rounding may pass it.
    if (!(std::fabs(bend) <= 1 + 1e-9)) return false;
    double elbow = degrees_of(std::acos(bend > 1 ? 1 : bend < -1 ? -1 : bend));
    // The elbow stays on its side.
    if (before < 0) elbow = -elbow;
    // ... and the arm in its turn: past half a turn it does not go round the other way.
    joint[0] =
        nearest_turn(degrees_of(std::atan2(y, x) -
                                std::atan2(outer * sine(elbow), inner + outer * cosine(elbow))),
                     base_before);
    joint[1] = elbow;
    joint[2] = mm(d1_) + mm(d3_) - mm(d5_) - world.z;
    joint[3] = world.c - joint[0] - joint[1];
    return true;
  }

 private:
  using Length = kerf::hal::In<double>;
  Length d1_{pin<Length>("D1", "Height of the inner arm", 490.0)};
  Length d2_{pin<Length>("D2", "Length of the inner arm", 340.0)};
  Length d3_{pin<Length>("D3", "Height of the outer arm above the inner arm", 50.0)};
  Length d4_{pin<Length>("D4", "Length of the outer arm", 250.0)};
  Length d5_{pin<Length>("D5", "Length of the tool below the end effector", 50.0)};
  Length d6_{pin<Length>("D6", "Distance of the tool from the middle of the end effector", 50.0)};
};

}  // namespace

KERF_HAL_MODULE(Scara)
