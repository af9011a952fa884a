// pumakins: the Puma 560 and arms of its kind (manual: kins(9), "pumakins"; John J. Craig, "Introduction to Robotics").
#include "serial_arm.hpp"

namespace {

using namespace kerf::kinematics;  // NOLINT(google-build-using-namespace): one file, one module

class Puma final : public SerialModule<Puma> {
 public:
  static constexpr kerf::hal::Info kInfo{
      .name = "pumakins",
      .summary = "Kinematics of Puma robots",
      .notes =
          "Joints 0 to 5 turn; U V W are joints 6 to 8. Kind 1 of "
          "motion.switchkins-type is identity.",
      .singleton = true};
  explicit Puma(kerf::hal::Builder& b) noexcept : SerialModule(b) {}

  [[nodiscard]] SerialArm arm() const noexcept {
    constexpr double kQuarter = std::numbers::pi / 2;
    return {.a = {0, 0, mm(a2_), mm(a3_), 0, 0},
            .alpha_rad = {0, -kQuarter, 0, -kQuarter, kQuarter, -kQuarter},
            .d = {0, 0, mm(d3_), mm(d4_), 0, mm(d6_)}};
  }

 private:
  using Length = kerf::hal::In<double>;
  Length a2_{pin<Length>("A2", "Length of the upper arm", 300.0)};
  Length a3_{pin<Length>("A3", "Offset of the elbow", 50.0)};
  Length d3_{pin<Length>("D3", "Offset of the upper arm from the shoulder", 70.0)};
  Length d4_{pin<Length>("D4", "Length of the forearm", 400.0)};
  Length d6_{pin<Length>("D6", "From the wrist to the tool", 70.0)};
};

}  // namespace

KERF_HAL_MODULE(Puma)
