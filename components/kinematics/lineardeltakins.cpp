// lineardeltakins: three carriages on columns hold the tool by rods of one length (manual: lineardeltakins(9)).
#include "kinematics_module.hpp"
#include "spheres.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class LinearDelta final : public KinematicsModule<LinearDelta> {
 public:
  static constexpr kerf::hal::Info kInfo{.name = "lineardeltakins",
                                         .summary = "Kinematics of linear delta robots",
                                         .notes =
                                             "Joint 0 is at (0,R), joints 1 and 2 are 120 degrees "
                                             "clockwise from it and from each other; (0,0) is the "
                                             "middle. A B C U V W are joints 3 to 8.",
                                         .singleton = true};
  explicit LinearDelta(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyzabcuvw") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    map().to_pose(joint, world);
    Point centre[3];
    for (int i = 0; i < 3; ++i)
      centre[i] = {column_x(i), column_y(i), joint[static_cast<std::size_t>(i)]};
    const double length = mm(l_);
    Point low, high;
    if (!meet(centre, {length, length, length}, low, high)) return false;
    world.x = low.x;
    world.y = low.y;
    world.z = low.z;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    map().to_joints(world, joint);
    const double length = mm(l_);
    for (int i = 0; i < 3; ++i) {
      const double dx = world.x - column_x(i), dy = world.y - column_y(i);
      const double square = length * length - dx * dx - dy * dy;
      if (!(square >= 0)) return false;
      joint[static_cast<std::size_t>(i)] = world.z + std::sqrt(square);
    }
    return true;
  }

 private:
  [[nodiscard]] double column_x(int i) const noexcept { return -mm(r_) * sine(120.0 * i); }
  [[nodiscard]] double column_y(int i) const noexcept { return mm(r_) * cosine(120.0 * i); }

  using Length = kerf::hal::In<double>;
  Length r_{pin<Length>(
      "R", "Distance of the columns from the middle, less that of the joints on the platform",
      kDefaultR)};
  Length l_{pin<Length>("L", "Length of a rod", kDefaultL)};
  static constexpr double kDefaultR = 130.25, kDefaultL = 269.0;
};

}  // namespace

KERF_HAL_MODULE(LinearDelta)
