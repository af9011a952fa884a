// matrixkins: three joints that are not quite square, by a matrix of what was measured (manual: matrixkins(9)).
#include "kinematics_module.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

using Factor = kerf::hal::Io<double>;

class Matrix final : public KinematicsModule<Matrix> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "matrixkins",
      .summary = "Kinematics of three-axis machines whose axes are not square, by a matrix",
      .notes =
          "Joint x = C_xx X + C_xy Y + C_xz Z, and so on; without setp it is identity. A B C U V W "
          "are joints 3 to 8. A matrix that cannot be inverted has no position.",
      .singleton = true};
  explicit Matrix(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyzabcuvw") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    const double a = xx_.get(), b = xy_.get(), c = xz_.get();
    const double d = yx_.get(), e = yy_.get(), f = yz_.get();
    const double g = zx_.get(), h = zy_.get(), i = zz_.get();
    const double det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
    if (!(std::fabs(det) > 1e-9)) return false;
    map().to_pose(joint, world);
    const double x = joint[0], y = joint[1], z = joint[2];
    world.x = ((e * i - f * h) * x + (c * h - b * i) * y + (b * f - c * e) * z) / det;
    world.y = ((f * g - d * i) * x + (a * i - c * g) * y + (c * d - a * f) * z) / det;
    world.z = ((d * h - e * g) * x + (b * g - a * h) * y + (a * e - b * d) * z) / det;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    map().to_joints(world, joint);
    joint[0] = xx_.get() * world.x + xy_.get() * world.y + xz_.get() * world.z;
    joint[1] = yx_.get() * world.x + yy_.get() * world.y + yz_.get() * world.z;
    joint[2] = zx_.get() * world.x + zy_.get() * world.y + zz_.get() * world.z;
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t joint) const noexcept override {
    const std::int32_t axis = map().axis_of(joint);
    return axis > 2 ? axis : -1;
  }

 private:
  Factor xx_{pin<Factor>("C_xx", "Joint x for 1 of X", 1.0)};
  Factor xy_{pin<Factor>("C_xy", "Joint x for 1 of Y")};
  Factor xz_{pin<Factor>("C_xz", "Joint x for 1 of Z")};
  Factor yx_{pin<Factor>("C_yx", "Joint y for 1 of X")};
  Factor yy_{pin<Factor>("C_yy", "Joint y for 1 of Y", 1.0)};
  Factor yz_{pin<Factor>("C_yz", "Joint y for 1 of Z")};
  Factor zx_{pin<Factor>("C_zx", "Joint z for 1 of X")};
  Factor zy_{pin<Factor>("C_zy", "Joint z for 1 of Y")};
  Factor zz_{pin<Factor>("C_zz", "Joint z for 1 of Z", 1.0)};
};

}  // namespace

KERF_HAL_MODULE(Matrix)
