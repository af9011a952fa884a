// invert: one divided by a number.
#include "hal/component.hpp"

namespace kerf::components {

class Invert final : public hal::Component<Invert> {
 public:
  static constexpr hal::Info kInfo{.name = "invert",
                                   .summary = "One divided by a number",
                                   .notes = "A deadband below 1e-8 is taken for 1e-8."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Divisor")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "1 / in, or zero near zero")};
  hal::Param<double> deadband_{param<hal::Param<double>>(
      "deadband", "Values of in not farther from zero than this give zero", 0.0)};

  void update(const hal::Period&) noexcept {
    double deadband = deadband_;
    if (deadband < 1e-8) deadband_ = deadband = 1e-8;
    const double in = in_;
    out_ = in > deadband || in < -deadband ? 1.0 / in : 0.0;
  }
  hal::Function update_{function<&Invert::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Invert)
