// gearchange: speed and direction for two gears.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Gearchange final : public hal::Component<Gearchange> {
 public:
  static constexpr hal::Info kInfo{
      .name = "gearchange",
      .summary = "Speed and direction for two gears",
      .notes =
          "Choose the scale of the drive for the first gear. A scale2 below 1 is taken for 1."};
  using Component::Component;

 private:
  hal::In<bool> sel_{pin<hal::In<bool>>("sel", "False first gear, true second gear")};
  hal::In<double> speed_in_{pin<hal::In<double>>("speed-in", "Wanted speed")};
  hal::Out<double> speed_out_{pin<hal::Out<double>>("speed-out", "Speed for the drive")};
  hal::In<bool> dir_in_{pin<hal::In<bool>>("dir-in", "Wanted direction")};
  hal::Out<bool> dir_out_{pin<hal::Out<bool>>("dir-out", "Direction for the drive")};
  hal::Param<double> min1_{
      param<hal::Param<double>>("min1", "Lowest speed in the first gear", 0.0)};
  hal::Param<double> max1_{
      param<hal::Param<double>>("max1", "Highest speed in the first gear", 100000.0)};
  hal::Param<double> min2_{
      param<hal::Param<double>>("min2", "Lowest speed in the second gear", 0.0)};
  hal::Param<double> max2_{
      param<hal::Param<double>>("max2", "Highest speed in the second gear", 100000.0)};
  hal::Param<double> scale2_{param<hal::Param<double>>(
      "scale2", "Speed of the second gear as a multiple of the first", 1.0)};
  hal::Param<bool> reverse_{
      param<hal::Param<bool>>("reverse", "True: the second gear turns the other way", false)};

  void update(const hal::Period&) noexcept {
    if (scale2_ < 1.0) scale2_ = 1.0;
    const bool second = sel_;
    const double min = second ? min2_ : min1_, max = second ? max2_ : max1_;
    double speed = speed_in_;
    double size = std::fabs(speed);
    if (size > max) size = max;
    if (size < min) size = min;
    speed = speed < 0.0 ? -size : size;
    speed_out_ = second ? speed / scale2_ : speed;
    dir_out_ = dir_in_ != (second && reverse_);
  }
  hal::Function update_{function<&Gearchange::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Gearchange)
