// thc: torch height control by the arc voltage.
#include <cmath>

#include "hal/component.hpp"
#include "torch_offset.hpp"

namespace kerf::components {

class Thc final : public hal::Component<Thc> {
 public:
  static constexpr hal::Info kInfo{
      .name = "thc",
      .summary = "Torch height control by the arc voltage",
      .notes =
          "The speed of an encoder that counts the pulses of a THC card is made a voltage. While "
          "the torch cuts at speed, z is offset to keep the voltage near volts-requested. With the "
          "torch off the offset is taken back no faster than z moves up. With enable false z is "
          "passed on without it.",
      .singleton = true};
  using Component::Component;

 private:
  hal::In<double> encoder_vel_{
      pin<hal::In<double>>("encoder-vel", "Speed of the encoder that counts the card's pulses")};
  hal::In<double> current_vel_{pin<hal::In<double>>("current-vel", "From motion.current-vel")};
  hal::In<double> requested_vel_{
      pin<hal::In<double>>("requested-vel", "From motion.requested-vel")};
  hal::In<double> volts_requested_{pin<hal::In<double>>("volts-requested", "Voltage to keep [V]")};
  hal::In<double> vel_tol_{
      pin<hal::In<double>>("vel-tol", "Accepted for the files that set it; see velocity-tol")};
  hal::In<bool> torch_on_{pin<hal::In<bool>>("torch-on", "From spindle.N.on")};
  hal::In<bool> arc_ok_{pin<hal::In<bool>>("arc-ok", "True while the arc burns")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True allows the offset")};
  hal::In<double> z_pos_in_{
      pin<hal::In<double>>("z-pos-in", "Commanded position of z, from the joint's motor-pos-cmd")};
  hal::Out<double> z_pos_out_{pin<hal::Out<double>>("z-pos-out", "Command for the motor of z")};
  hal::Out<double> z_fb_out_{
      pin<hal::Out<double>>("z-fb-out", "Position for the joint's motor-pos-fb")};
  hal::Out<double> volts_{pin<hal::Out<double>>("volts", "Arc voltage [V]")};
  hal::Out<bool> vel_status_{pin<hal::Out<bool>>(
      "vel-status", "True while the speed is within velocity-tol of the requested one")};
  hal::Out<double> offset_value_{pin<hal::Out<double>>("offset-value", "Offset of z")};
  hal::Param<double> vel_scale_{
      param<hal::Param<double>>("vel-scale", "Volts for one unit of encoder-vel", 0.0)};
  hal::Param<double> scale_offset_{
      param<hal::Param<double>>("scale-offset", "encoder-vel at zero volts", 0.0)};
  hal::Param<double> velocity_tol_{param<hal::Param<double>>(
      "velocity-tol", "Missing part of the requested speed that does not count [percent]", 0.0)};
  hal::Param<double> voltage_tol_{param<hal::Param<double>>(
      "voltage-tol", "Difference from volts-requested below which z is left alone [V]", 0.0)};
  hal::Param<double> correction_vel_{
      param<hal::Param<double>>("correction-vel", "Change of the offset in a call", 0.0)};
  TorchOffset offset_;

  void update(const hal::Period&) noexcept {
    const double z = z_pos_in_;
    offset_.follow(z);
    const double volts = std::fmax((encoder_vel_ - scale_offset_) * vel_scale_, 0.0);
    volts_ = volts;
    if (enable_) vel_status_ = at_cutting_speed(current_vel_, requested_vel_, velocity_tol_);
    const bool at_speed = vel_status_.last();
    offset_value_ = offset_.value();
    if (!enable_) {
      // The offset waits; z is passed on without it.
    } else if (torch_on_) {
      offset_.burns();
      if (arc_ok_ && at_speed) {
        if (volts_requested_ - volts >= voltage_tol_) offset_.add(correction_vel_);
        if (volts - volts_requested_ >= voltage_tol_) offset_.add(-correction_vel_);
      }
    } else {
      (void)offset_.take_back();
    }
    z_pos_out_ = enable_ ? z + offset_.value() : z;
    z_fb_out_ = z;
  }
  hal::Function update_{function<&Thc::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Thc)
