// corexy_by_hal: coreXY transformation for trivkins.
#include "hal/component.hpp"

namespace kerf::components {

class CorexyByHal final : public hal::Component<CorexyByHal> {
 public:
  static constexpr hal::Info kInfo{
      .name = "corexy-by-hal",
      .summary = "CoreXY transformation for trivkins",
      .notes =
          "The motors of a CoreXY machine turn by half the sum and half the difference of x and y. "
          "With this between trivkins and the motors the joints are x and y, and each can be homed "
          "on its own."};
  using Component::Component;

 private:
  hal::In<double> alpha_fb_{pin<hal::In<double>>("alpha-fb", "Position of the first motor")};
  hal::In<double> beta_fb_{pin<hal::In<double>>("beta-fb", "Position of the second motor")};
  hal::In<double> j0_motor_pos_cmd_{
      pin<hal::In<double>>("j0-motor-pos-cmd", "Commanded x, from joint.0.motor-pos-cmd")};
  hal::In<double> j1_motor_pos_cmd_{
      pin<hal::In<double>>("j1-motor-pos-cmd", "Commanded y, from joint.1.motor-pos-cmd")};
  hal::Out<double> j0_motor_pos_fb_{
      pin<hal::Out<double>>("j0-motor-pos-fb", "Position along x, for joint.0.motor-pos-fb")};
  hal::Out<double> j1_motor_pos_fb_{
      pin<hal::Out<double>>("j1-motor-pos-fb", "Position along y, for joint.1.motor-pos-fb")};
  hal::Out<double> alpha_cmd_{pin<hal::Out<double>>("alpha-cmd", "Command of the first motor")};
  hal::Out<double> beta_cmd_{pin<hal::Out<double>>("beta-cmd", "Command of the second motor")};

  void update(const hal::Period&) noexcept {
    const double x = j0_motor_pos_cmd_, y = j1_motor_pos_cmd_;
    alpha_cmd_ = 0.5 * (x + y);
    beta_cmd_ = 0.5 * (x - y);
    const double alpha = alpha_fb_, beta = beta_fb_;
    j0_motor_pos_fb_ = alpha + beta;
    j1_motor_pos_fb_ = alpha - beta;
  }
  hal::Function update_{function<&CorexyByHal::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::CorexyByHal)
