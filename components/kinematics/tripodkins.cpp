// tripodkins: three struts from fixed points to the tool (manual: kins(9), "tripodkins").
#include "kinematics_module.hpp"
#include "spheres.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Tripod final : public KinematicsModule<Tripod> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "tripodkins",
      .summary = "Kinematics of tripods: joints are distances of the tool from three points",
      .notes =
          "The points are (0,0), (Bx,0) and (Cx,Cy), all at Z0; the tool stays on the side of Z0 "
          "on which it is.",
      .singleton = true};
  explicit Tripod(kerf::hal::Builder& b) noexcept : KinematicsModule(b, "xyz") {}

  [[nodiscard]] bool forward(const JointVector& joint, Pose& world) const noexcept override {
    const Point centre[3]{{}, {mm(bx_), 0, 0}, {mm(cx_), mm(cy_), 0}};
    Point low, high;
    if (!meet(centre, {joint[0], joint[1], joint[2]}, low, high)) return false;
    const Point& at = world.z < 0 ? low : high;
    world.x = at.x;
    world.y = at.y;
    world.z = at.z;
    return true;
  }
  [[nodiscard]] bool inverse(const Pose& world, JointVector& joint) const noexcept override {
    const auto way = [&](double x, double y) {
      return std::sqrt((world.x - x) * (world.x - x) + (world.y - y) * (world.y - y) +
                       world.z * world.z);
    };
    joint[0] = way(0, 0);
    joint[1] = way(mm(bx_), 0);
    joint[2] = way(mm(cx_), mm(cy_));
    return true;
  }

 private:
  using Length = kerf::hal::Io<double>;
  Length bx_{pin<Length>("Bx", "X of the second point", 1.0)};
  Length cx_{pin<Length>("Cx", "X of the third point", 1.0)};
  Length cy_{pin<Length>("Cy", "Y of the third point", 1.0)};
};

}  // namespace

KERF_HAL_MODULE(Tripod)
