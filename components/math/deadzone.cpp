// deadzone: takes the middle out of a range.
#include "hal/component.hpp"

namespace kerf::components {

class Deadzone final : public hal::Component<Deadzone> {
 public:
  static constexpr hal::Info kInfo{
      .name = "deadzone",
      .summary = "Takes the middle out of a range",
      .notes = "out is center within the dead zone; outside it goes on from there without a step."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Input without the dead zone")};
  hal::Param<double> center_{param<hal::Param<double>>("center", "Middle of the dead zone", 0.0)};
  hal::Param<double> threshold_{param<hal::Param<double>>(
      "threshold", "Width of the dead zone: half of it on each side", 1.0)};

  void update(const hal::Period&) noexcept {
    const double in = in_, center = center_, half = threshold_ * 0.5;
    double out = center;
    if (in > center + half) out = in - half;
    if (in < center - half) out = in + half;
    out_ = out;
  }
  hal::Function update_{function<&Deadzone::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Deadzone)
