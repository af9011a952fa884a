// simple_tp: trapezoidal planner of one joint.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class SimpleTp final : public hal::Component<SimpleTp> {
 public:
  static constexpr hal::Info kInfo{
      .name = "simple-tp",
      .summary = "Trapezoidal planner of one joint",
      .notes = "For trying out the speed and acceleration of a drive."};
  using Component::Component;

 private:
  hal::In<double> target_pos_{pin<hal::In<double>>("target-pos", "Where to go")};
  hal::In<double> maxvel_{pin<hal::In<double>>("maxvel", "Highest speed [units per second]")};
  hal::In<double> maxaccel_{pin<hal::In<double>>("maxaccel", "Acceleration [units per second^2]")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "False stops with maxaccel")};
  hal::Out<double> current_pos_{pin<hal::Out<double>>("current-pos", "Commanded position")};
  hal::Out<double> current_vel_{
      pin<hal::Out<double>>("current-vel", "Commanded speed [units per second]")};
  hal::Out<bool> active_{pin<hal::Out<bool>>("active", "True while it moves")};

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds(), accel = std::fabs(maxaccel_), step = accel * dt;
    double speed = current_vel_.last(), position = current_pos_.last();
    bool active = false;
    double wanted = 0.0;
    if (enable_) {
      const double missing = target_pos_ - position;
      if (std::fabs(missing) > step * dt * 0.001) {
        // The speed from which it can still stop there.
        wanted = std::copysign(std::sqrt(2.0 * accel * std::fabs(missing) + step * step) - step,
                               missing);
        active = true;
      }
    }
    wanted = rtapi::limited(wanted, -std::fabs(maxvel_), std::fabs(maxvel_));
    speed = rtapi::limited(wanted, speed - step, speed + step);
    if (speed != 0.0) active = true;
    position += speed * dt;
    current_pos_ = position;
    current_vel_ = speed;
    active_ = active;
  }
  hal::Function update_{function<&SimpleTp::update>("update", "Moves by one period")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimpleTp)
