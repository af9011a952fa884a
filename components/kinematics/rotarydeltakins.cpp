// rotarydeltakins: three thighs that swing, and shins to the platform (manual: kins(9), "rotarydeltakins").
#include "kinematics_module.hpp"
#include "spheres.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class RotaryDelta final : public KinematicsModule<RotaryDelta> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "rotarydeltakins",
      .summary = "Kinematics of rotary delta robots",
      .notes =
          "Joints 0 to 2 are the angles of the thighs, 0 level and positive downwards; the hips "
          "are at -90, 30 and 150 degrees about "
          "(0,0), at Z0. A B C U V W are joints 3 to 8.",
      .singleton = true};
  explicit RotaryDelta(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyzabcuvw") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    map().to_pose(joint, world);
    Point centre[3];
    for (int i = 0; i < 3; ++i) {
      const double angle = joint[static_cast<std::size_t>(i)];
      // The feet moved into the tool's point, and the knees with them.
      const double out = mm(platform_) - mm(foot_) + mm(thigh_) * cosine(angle);
      centre[i] = {out * cosine(hip(i)), out * sine(hip(i)), -mm(thigh_) * sine(angle)};
    }
    const double shin = mm(shin_);
    Point low, high;
    if (!meet(centre, {shin, shin, shin}, low, high)) return false;
    world.x = low.x;
    world.y = low.y;
    world.z = low.z;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    map().to_joints(world, joint);
    for (int i = 0; i < 3; ++i) {
      const double out =
          world.x * cosine(hip(i)) + world.y * sine(hip(i)) + mm(foot_) - mm(platform_);
      const double aside = world.y * cosine(hip(i)) - world.x * sine(hip(i));
      const double thigh = mm(thigh_), shin = mm(shin_);
      // out cos j - z sin j = k: where the knee is a shin away from the foot.
      const double k =
          (out * out + aside * aside + world.z * world.z + thigh * thigh - shin * shin) /
          (2 * thigh);
      const double far = std::hypot(out, world.z);
      if (!(std::fabs(k) <= far)) return false;
      const double angle = -std::atan2(world.z, out) - std::acos(k / far);
      joint[static_cast<std::size_t>(i)] = nearest_turn(degrees_of(angle), 0.0);
    }
    return true;
  }

 private:
  [[nodiscard]] static double hip(int i) noexcept { return -90.0 + 120.0 * i; }
  using Length = kerf::hal::In<double>;
  Length platform_{pin<Length>("platformradius", "From the middle to a hip", 10.0)};
  Length thigh_{pin<Length>("thighlength", "From hip to knee", 10.0)};
  Length shin_{pin<Length>("shinlength", "From knee to foot", 14.0)};
  Length foot_{pin<Length>("footradius", "From the tool to a foot", 6.0)};
};

}  // namespace

KERF_HAL_MODULE(RotaryDelta)
