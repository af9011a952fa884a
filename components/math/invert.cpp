// invert: one divided by a number.
#include "divisor.hpp"
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

  void update(const hal::Period&) noexcept { out_ = 1.0 / divisor(in_, deadband_); }
  hal::Function update_{function<&Invert::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Invert)
