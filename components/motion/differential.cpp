// differential: kinematics of a differential.
#include "hal/component.hpp"

namespace kerf::components {

class Differential final : public hal::Component<Differential> {
 public:
  static constexpr hal::Info kInfo{.name = "differential",
                                   .summary = "Kinematics of a differential",
                                   .notes =
                                       "Two motors turn and tilt one wrist: both the same way roll "
                                       "it, against each other they pitch it."};
  using Component::Component;

 private:
  hal::In<double> roll_cmd_{pin<hal::In<double>>("roll-cmd", "Commanded roll [degrees]")};
  hal::In<double> pitch_cmd_{pin<hal::In<double>>("pitch-cmd", "Commanded pitch [degrees]")};
  hal::Out<double> roll_fb_{pin<hal::Out<double>>("roll-fb", "Roll, from the motors [degrees]")};
  hal::Out<double> pitch_fb_{pin<hal::Out<double>>("pitch-fb", "Pitch, from the motors [degrees]")};
  hal::Out<double> motor0_cmd_{
      pin<hal::Out<double>>("motor0-cmd", "Command of the first motor [degrees]")};
  hal::Out<double> motor1_cmd_{
      pin<hal::Out<double>>("motor1-cmd", "Command of the second motor [degrees]")};
  hal::In<double> motor0_fb_{
      pin<hal::In<double>>("motor0-fb", "Position of the first motor [degrees]")};
  hal::In<double> motor1_fb_{
      pin<hal::In<double>>("motor1-fb", "Position of the second motor [degrees]")};

  void update(const hal::Period&) noexcept {
    const double roll = roll_cmd_, pitch = pitch_cmd_;
    motor0_cmd_ = roll + pitch;
    motor1_cmd_ = roll - pitch;
    const double first = motor0_fb_, second = motor1_fb_;
    roll_fb_ = 0.5 * (first + second);
    pitch_fb_ = 0.5 * (first - second);
  }
  hal::Function update_{
      function<&Differential::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Differential)
