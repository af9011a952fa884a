// invert: one divided by a number.
#include "hal/component.hpp"

namespace kerf::components {

class Invert final : public hal::Component<Invert> {
 public:
  static constexpr hal::Info kInfo{.name = "invert",
                                   .summary = "One divided by a number",
                                   .notes =
                                       "A deadband below 1e-12 is taken for 1e-12. The size of "
                                       "out is 1 / deadband near zero, with the sign of in."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Divisor")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "1 / in, or of the deadband near zero")};
  hal::Param<double> deadband_{param<hal::Param<double>>(
      "deadband", "Values of in nearer to zero than this count as this", 0.0)};

  void update(const hal::Period&) noexcept {
    double deadband = deadband_;
    if (deadband < 1e-12) deadband_ = deadband = 1e-12;
    double in = in_;
    if (in >= 0.0 && in < deadband) in = deadband;
    if (in < 0.0 && in > -deadband) in = -deadband;
    out_ = 1.0 / in;
  }
  hal::Function update_{function<&Invert::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Invert)
