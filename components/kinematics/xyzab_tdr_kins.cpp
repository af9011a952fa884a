// xyzab_tdr_kins: mill with two turning tables, B on A (manual: xyzab_tdr_kins(9)).
#include "spheres.hpp"
#include "switchable.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Tdr final : public SwitchableModule<Tdr> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "xyzab_tdr_kins",
      .summary = "Kinematics of a mill with two turning tables, A and B",
      .notes =
          "Kind 0 of motion.switchkins-type is identity: joints 0 to 4 are X Y Z A B. In kind 1 "
          "positions are of the tool on the workpiece.",
      .singleton = true};
  explicit Tdr(kerf::hal::Builder& b) noexcept
      : SwitchableModule(b,
                         {.own = "xyzab", .needed = "xyzab", .identity_first = true, .kinds = 2}) {}

  [[nodiscard]] bool own_forward(const JointVector& joint, Pose& world) const noexcept {
    map().to_pose(joint, world);
    const Point rest = rest_point(), d = offset();
    const Point at = about_y(Point{world.x, world.y, world.z} - rest, world.b) - d;
    const Point turned = about_x(at, world.a);
    world.x = turned.x + d.x + rest.x;
    world.y = turned.y + d.y + rest.y;
    world.z = turned.z + d.z + rest.z;
    return true;
  }
  [[nodiscard]] bool own_inverse(const Pose& world, JointVector& joint) const noexcept {
    const Point rest = rest_point(), d = offset();
    const Point at = about_x(Point{world.x, world.y, world.z} - rest - d, -world.a);
    const Point turned = about_y(at - Point{-d.x, -d.y, -d.z}, -world.b);
    Pose joints = world;
    joints.x = turned.x + rest.x;
    joints.y = turned.y + rest.y;
    joints.z = turned.z + rest.z;
    map().to_joints(joints, joint);
    return true;
  }
  [[nodiscard]] std::int32_t own_axis_of_joint(std::int32_t joint) const noexcept {
    const std::int32_t axis = map().axis_of(joint);
    return axis > 2 ? axis : -1;
  }

 private:
  using Length = kerf::hal::In<double>;
  static Point about_x(const Point& p, double degrees) noexcept {
    const double s = sine(degrees), c = cosine(degrees);
    return {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
  }
  static Point about_y(const Point& p, double degrees) noexcept {
    const double s = sine(degrees), c = cosine(degrees);
    return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
  }
  /// What stays where it is on the table of B; a longer tool moves it up.
  [[nodiscard]] Point rest_point() const noexcept {
    return {mm(x_rot_point_), mm(y_rot_point_), mm(z_rot_point_) + mm(tool_offset_)};
  }
  /// From the axis of B to that of A.
  [[nodiscard]] Point offset() const noexcept { return {mm(x_offset_), 0, mm(z_offset_)}; }

  Length tool_offset_{
      pin<Length>("tool-offset-z", "Length of the tool; link it to motion.tooloffset.z")};
  Length x_offset_{pin<Length>("x-offset", "X from the axis of B to that of A")};
  Length z_offset_{pin<Length>("z-offset", "Z from the axis of B to that of A")};
  Length x_rot_point_{pin<Length>("x-rot-point", "X of the axis of B")};
  Length y_rot_point_{pin<Length>("y-rot-point", "Y of the axis of B")};
  Length z_rot_point_{pin<Length>("z-rot-point", "Z of the axis of B")};
};

}  // namespace

KERF_HAL_MODULE(Tdr)
