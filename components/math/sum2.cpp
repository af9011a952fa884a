// sum2: weighted sum of two values and an offset.
#include "hal/component.hpp"

namespace kerf::components {

class Sum2 final : public hal::Component<Sum2> {
 public:
  static constexpr hal::Info kInfo{.name = "sum2",
                                   .summary = "Sum of two inputs, each with a gain, and an offset",
                                   .notes = "A gain of -1 makes it a difference."};
  using Component::Component;

 private:
  hal::In<double> in0_{pin<hal::In<double>>("in0", "First input")};
  hal::In<double> in1_{pin<hal::In<double>>("in1", "Second input")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "in0 * gain0 + in1 * gain1 + offset")};
  hal::Param<double> gain0_{param<hal::Param<double>>("gain0", "Factor of in0", 1.0)};
  hal::Param<double> gain1_{param<hal::Param<double>>("gain1", "Factor of in1", 1.0)};
  hal::Param<double> offset_{param<hal::Param<double>>("offset", "Added to the sum", 0.0)};

  void update(const hal::Period&) noexcept { out_ = in0_ * gain0_ + in1_ * gain1_ + offset_; }
  hal::Function update_{function<&Sum2::update>("", "Computes out from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Sum2)
