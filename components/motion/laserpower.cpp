// laserpower: power of a laser that moves.
#include <cmath>

#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class Laserpower final : public hal::Component<Laserpower> {
 public:
  static constexpr hal::Info kInfo{
      .name = "laserpower",
      .summary = "Power of a laser by velocity and distance to go",
      .notes =
          "power is power-request, and in proportion less while current-velocity is below "
          "requested-velocity, so that corners do not burn. It lies between min-power and "
          "max-power while the laser is on, and is 0 while enable is false or power-request is 0. "
          "While the machine stands, and within distance-off of the end of the move, it is 0. In "
          "raster-mode it is raster-power within the same bounds."};
  using Component::Component;

 private:
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "False: the power is 0")};
  hal::In<double> request_{pin<hal::In<double>>("power-request", "Power at the wanted velocity")};
  hal::In<double> current_velocity_{
      pin<hal::In<double>>("current-velocity", "Velocity, from motion.current-vel")};
  hal::In<double> requested_velocity_{pin<hal::In<double>>(
      "requested-velocity", "Velocity of the move, from motion.requested-vel")};
  hal::In<double> distance_to_go_{
      pin<hal::In<double>>("distance-to-go", "Rest of the move, from motion.distance-to-go")};
  hal::In<double> distance_off_{
      pin<hal::In<double>>("distance-off", "Rest of the move without power, 0 for none")};
  hal::In<double> min_power_{
      pin<hal::In<double>>("min-power", "Least power while the laser is on")};
  hal::In<double> max_power_{pin<hal::In<double>>("max-power", "Most power", 100.0)};
  hal::In<bool> raster_mode_{pin<hal::In<bool>>("raster-mode", "True: raster-power counts")};
  hal::In<double> raster_power_{pin<hal::In<double>>("raster-power", "Power of the picture")};
  hal::Out<double> power_{pin<hal::Out<double>>("power", "Power for the laser")};

  void update(const hal::Period&) noexcept {
    const double velocity = std::fabs(current_velocity_), wanted = std::fabs(requested_velocity_);
    const bool raster = raster_mode_;
    double power = raster ? raster_power_.get() : request_.get();
    const double ratio = wanted > 0.0 ? rtapi::limited(velocity / wanted, 0.0, 1.0) : 0.0;
    const bool ends = !raster && distance_off_ > 0.0 && distance_to_go_ < distance_off_;
    if (!enable_ || !(power > 0.0) || !(max_power_ > 0.0) || ends || !(velocity > 0.0)) {
      power_ = 0.0;
      return;
    }
    if (!raster) power *= ratio;
    const double most = max_power_, least = rtapi::limited(min_power_.get(), 0.0, most);
    power_ = rtapi::limited(power, least, most);
  }
  hal::Function update_{function<&Laserpower::update>("", "Computes the power")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Laserpower)
