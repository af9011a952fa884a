// sim_spindle: a spindle with ramp, encoder index, at-speed and orientation.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class SimSpindle final : public hal::Component<SimSpindle> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-spindle",
      .summary = "Simulated spindle with index pulse",
      .notes =
          "velocity-cmd * scale is the wanted speed in revolutions per second: with spindle.N."
          "speed-out, which is in revolutions per minute, scale is 1/60. Without acceleration the "
          "spindle has the wanted speed at once. position-fb counts revolutions; when index-enable "
          "is true as the spindle passes its index (a whole revolution), position-fb starts from "
          "zero there and index-enable is cleared. With encoder-counts position-fb goes in the "
          "steps "
          "that a quadrature encoder of that many counts gives. While orient is true and the "
          "spindle is told to "
          "stand, it turns the short way to orient-angle and then holds."};
  using Component::Component;

 private:
  hal::In<double> velocity_cmd_{pin<hal::In<double>>("velocity-cmd", "Wanted speed, signed")};
  hal::Out<double> position_fb_{
      pin<hal::Out<double>>("position-fb", "Position of the spindle [revolutions]")};
  hal::Io<bool> index_enable_{pin<hal::Io<bool>>(
      "index-enable", "True asks for position-fb to be zeroed at the next index")};
  hal::Out<double> velocity_fb_{
      pin<hal::Out<double>>("velocity-fb", "Actual speed [revolutions per second], signed")};
  hal::Out<bool> at_speed_{
      pin<hal::Out<bool>>("at-speed", "True while the speed is within at-speed-tolerance")};
  hal::In<bool> orient_{pin<hal::In<bool>>("orient",
                                           "True turns the standing spindle to "
                                           "orient-angle")};
  hal::In<double> orient_angle_{
      pin<hal::In<double>>("orient-angle", "Angle from the index to turn to [degrees]")};
  hal::Out<bool> is_oriented_{
      pin<hal::Out<bool>>("is-oriented", "True while orient is true and the angle is reached")};
  hal::Param<double> scale_{param<hal::Param<double>>(
      "scale", "Factor from velocity-cmd to revolutions per second", 1.0)};
  hal::Param<double> acceleration_{param<hal::Param<double>>(
      "acceleration", "Ramp [revolutions per second^2]; 0: none, speed follows at once", 0.0)};
  hal::Param<double> tolerance_{param<hal::Param<double>>(
      "at-speed-tolerance", "Part of the wanted speed that may be missing for at-speed", 0.02)};
  hal::Param<double> orient_speed_{param<hal::Param<double>>(
      "orient-speed", "Speed of turning to orient-angle [revolutions per second]", 1.0)};

  hal::Param<double> encoder_counts_{param<hal::Param<double>>(
      "encoder-counts", "Counts a revolution in which position-fb goes; 0: it is exact", 0.0)};

  double velocity_rev_s_{0.0};
  double angle_rev_{0.0};  // from the index, counted through since the start
  double zero_rev_{0.0};   // angle_rev_ where position-fb is zero: always whole

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds();
    const double wanted = velocity_cmd_ * scale_;
    const double before = angle_rev_;
    ramp(wanted, dt);
    angle_rev_ += velocity_rev_s_ * dt;
    const bool standing = wanted == 0.0 && velocity_rev_s_ == 0.0;
    is_oriented_ = orient_ && standing && turn_to_angle(dt);
    watch_index(before);
    const double turned = angle_rev_ - zero_rev_, counts = encoder_counts_;
    position_fb_ = counts > 0.0 ? std::floor(turned * counts) / counts : turned;
    velocity_fb_ = (angle_rev_ - before) / dt;
    at_speed_ = std::fabs(velocity_rev_s_ - wanted) <= std::fabs(wanted) * tolerance_;
  }

  void ramp(double wanted, double dt) noexcept {
    const double step = acceleration_ * dt;
    const double missing = wanted - velocity_rev_s_;
    if (step <= 0.0 || std::fabs(missing) <= step) {
      velocity_rev_s_ = wanted;
    } else {
      velocity_rev_s_ += std::copysign(step, missing);
    }
  }

  /// True when the angle is reached.
  bool turn_to_angle(double dt) noexcept {
    const double target = orient_angle_ / 360.0;
    // Of all angles that look the same, the nearest.
    const double missing = std::remainder(target - angle_rev_, 1.0);
    const double step = std::fabs(orient_speed_) * dt;
    if (std::fabs(missing) <= step) {
      angle_rev_ += missing;
      return true;
    }
    angle_rev_ += std::copysign(step, missing);
    return false;
  }

  void watch_index(double before) noexcept {
    const double whole_before = std::floor(before), whole = std::floor(angle_rev_);
    if (!index_enable_ || whole == whole_before) return;
    // The index passed last: the lower end of this revolution forwards, its upper end backwards.
    zero_rev_ = angle_rev_ > before ? whole : whole + 1.0;
    index_enable_ = false;
  }
  hal::Function update_{function<&SimSpindle::update>("", "Moves the spindle by one period")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimSpindle)
