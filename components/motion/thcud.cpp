// thcud: torch height control by up and down signals.
#include "hal/component.hpp"
#include "torch_offset.hpp"

namespace kerf::components {

class Thcud final : public hal::Component<Thcud> {
 public:
  static constexpr hal::Info kInfo{
      .name = "thcud",
      .summary = "Torch height control by up and down signals",
      .notes =
          "While the torch cuts at speed, the offset of z follows the two signals. With the torch "
          "off it is taken back no faster than z moves up. With enable false z is passed on "
          "without it.",
      .singleton = true};
  using Component::Component;

 private:
  hal::In<bool> torch_up_{pin<hal::In<bool>>("torch-up", "True raises the torch")};
  hal::In<bool> torch_down_{pin<hal::In<bool>>("torch-down", "True lowers the torch")};
  hal::In<double> current_vel_{pin<hal::In<double>>("current-vel", "From motion.current-vel")};
  hal::In<double> requested_vel_{
      pin<hal::In<double>>("requested-vel", "From motion.requested-vel")};
  hal::In<bool> torch_on_{pin<hal::In<bool>>("torch-on", "From spindle.N.on")};
  hal::In<bool> arc_ok_{pin<hal::In<bool>>("arc-ok", "True while the arc burns")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True allows the offset")};
  hal::In<double> z_pos_in_{
      pin<hal::In<double>>("z-pos-in", "Commanded position of z, from the joint's motor-pos-cmd")};
  hal::Out<double> z_pos_out_{pin<hal::Out<double>>("z-pos-out", "Command for the motor of z")};
  hal::Out<double> z_fb_out_{
      pin<hal::Out<double>>("z-fb-out", "Position for the joint's motor-pos-fb")};
  hal::Out<double> cur_offset_{pin<hal::Out<double>>("cur-offset", "Offset of z")};
  hal::Out<bool> vel_status_{pin<hal::Out<bool>>(
      "vel-status", "True while the speed is within velocity-tol of the requested one")};
  hal::Out<bool> removing_offset_{
      pin<hal::Out<bool>>("removing-offset", "True while the offset is taken back")};
  hal::Param<double> velocity_tol_{param<hal::Param<double>>(
      "velocity-tol", "Missing part of the requested speed that does not count [percent]", 0.0)};
  hal::In<double> correction_vel_{
      pin<hal::In<double>>("correction-vel", "Change of the offset in a call", 0.0)};
  TorchOffset offset_;

  void update(const hal::Period&) noexcept {
    const double z = z_pos_in_;
    offset_.follow(z);
    if (enable_) vel_status_ = at_cutting_speed(current_vel_, requested_vel_, velocity_tol_);
    const bool at_speed = vel_status_.last();
    bool removing = false;
    if (!enable_) {
      // The offset waits; z is passed on without it.
    } else if (torch_on_) {
      offset_.burns();
      if (arc_ok_ && at_speed) {
        if (torch_up_) offset_.add(correction_vel_);
        if (torch_down_) offset_.add(-correction_vel_);
      }
    } else {
      removing = offset_.take_back();
    }
    removing_offset_ = removing;
    cur_offset_ = offset_.value();
    z_pos_out_ = enable_ ? z + offset_.value() : z;
    z_fb_out_ = z;
  }
  hal::Function update_{function<&Thcud::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Thcud)
