// joyhandle: characteristic of a joystick.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Joyhandle final : public hal::Component<Joyhandle> {
 public:
  static constexpr hal::Info kInfo{
      .name = "joyhandle",
      .summary = "Characteristic of a joystick",
      .notes =
          "out is scale * (a * x^power + b * x) + offset beyond the deadband, with a and b such "
          "that it starts from offset at deadband and ends at scale + offset at 1. The negative "
          "side is the mirror image."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Position of the stick, from -1 to 1")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Value")};
  hal::Param<double> power_{param<hal::Param<double>>("power", "Curvature, 1 or more", 2.0)};
  hal::Param<double> deadband_{param<hal::Param<double>>(
      "deadband", "Values of in nearer to zero than this count as zero", 0.0)};
  hal::Param<double> scale_{
      param<hal::Param<double>>("scale", "Size of the value at full deflection", 1.0)};
  hal::Param<double> offset_{param<hal::Param<double>>("offset", "Added to the value", 0.0)};
  hal::Param<bool> inverse_{param<hal::Param<bool>>(
      "inverse", "True: steep near the middle instead of near the ends", false)};

  void update(const hal::Period&) noexcept {
    double power = power_, deadband = deadband_;
    if (power < 1.0) power = 1.0;
    if (deadband < 0.0) deadband = 0.0;
    if (deadband > 0.99) deadband = 0.99;
    const double in = in_;
    double x = std::fabs(in);
    double value = 0.0;
    if (x > 1.0) x = 1.0;
    if (x > deadband) {
      const double a = power > 1.0 ? 1.0 / (1.0 - std::pow(deadband, power - 1.0))
                                   : 1.0 / (1.0 - deadband),
                   b = power > 1.0 ? 1.0 - a : -a * deadband;
      if (inverse_) x = 1.0 - x + deadband;
      double y = power > 1.0 ? a * std::pow(x, power) + b * x : a * x + b;
      if (inverse_) y = 1.0 - y;
      value = scale_ * y + offset_;
    }
    out_ = in < -deadband ? -value : value;
  }
  hal::Function update_{function<&Joyhandle::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Joyhandle)
