// div2: quotient of two floats.
#include "divisor.hpp"
#include "hal/component.hpp"

namespace kerf::components {

class Div2 final : public hal::Component<Div2> {
 public:
  static constexpr hal::Info kInfo{.name = "div2",
                                   .summary = "Quotient of two floats",
                                   .notes =
                                       "A divisor nearer to zero than deadband "
                                       "counts as deadband, with its own sign. A deadband "
                                       "below 1e-12 is taken for 1e-12."};
  using Component::Component;

 private:
  hal::In<double> in0_{pin<hal::In<double>>("in0", "Dividend")};
  hal::In<double> in1_{pin<hal::In<double>>("in1", "Divisor")};
  hal::Out<double> out_{
      pin<hal::Out<double>>("out", "in0 / in1, or by the deadband near a divisor of zero")};
  hal::Param<double> deadband_{param<hal::Param<double>>(
      "deadband", "Values of in1 nearer to zero than this count as this", 0.0)};

  void update(const hal::Period&) noexcept { out_ = in0_ / divisor(in1_, deadband_); }
  hal::Function update_{function<&Div2::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Div2)
