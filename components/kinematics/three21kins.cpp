// three21kins: arms of the 3-2-1 kind: three joints for the place, two and one for a wrist whose axes meet (John J. Craig,
// "Introduction to Robotics"). pumakins with the height of the base and an offset of the shoulder.
#include "serial_arm.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Three21 final : public SerialModule<Three21> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "three21kins",
      .summary = "Kinematics of six-axis arms of the 3-2-1 kind",
      .notes =
          "Joints 0 to 5 turn; U V W are joints 6 to 8. With all joints at 0 the upper arm is "
          "level and the forearm points down. Kind 1 of motion.switchkins-type is identity.",
      .singleton = true};
  explicit Three21(kerf::hal::Builder& b) noexcept : SerialModule(b) {}

  [[nodiscard]] SerialArm arm() const noexcept {
    constexpr double kQuarter = std::numbers::pi / 2;
    return {.a = {0, mm(a1_), mm(a2_), mm(a3_), 0, 0},
            .alpha_rad = {0, -kQuarter, 0, -kQuarter, kQuarter, -kQuarter},
            .d = {mm(d1_), mm(d2_), 0, mm(d4_), 0, mm(d6_)}};
  }

 private:
  using Length = kerf::hal::In<double>;
  Length a1_{pin<Length>("A1", "From the base's axis to the shoulder", 100.0)};
  Length a2_{pin<Length>("A2", "Length of the upper arm", 300.0)};
  Length a3_{pin<Length>("A3", "Offset of the elbow", 50.0)};
  Length d1_{pin<Length>("D1", "Height of the shoulder", 350.0)};
  Length d2_{pin<Length>("D2", "Offset of the upper arm to the side")};
  Length d4_{pin<Length>("D4", "Length of the forearm", 320.0)};
  Length d6_{pin<Length>("D6", "From the wrist to the tool", 70.0)};
};

}  // namespace

KERF_HAL_MODULE(Three21)
