// mult2: product of two values.
#include "hal/component.hpp"

namespace kerf::components {

class Mult2 final : public hal::Component<Mult2> {
 public:
  static constexpr hal::Info kInfo{
      .name = "mult2", .summary = "Product of two inputs", .notes = "out is in0 times in1."};
  using Component::Component;

 private:
  hal::In<double> in0_{pin<hal::In<double>>("in0", "First factor")};
  hal::In<double> in1_{pin<hal::In<double>>("in1", "Second factor")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "in0 * in1")};

  void update(const hal::Period&) noexcept { out_ = in0_ * in1_; }
  hal::Function update_{function<&Mult2::update>("", "Computes out from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Mult2)
