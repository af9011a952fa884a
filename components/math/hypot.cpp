// hypot: length of a vector.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Hypot final : public hal::Component<Hypot> {
 public:
  static constexpr hal::Info kInfo{
      .name = "hypot",
      .summary = "Length of a vector of three components",
      .notes =
          "The velocity on the path from the velocities of three axes is a common use. An input "
          "that is not connected counts as zero."};
  using Component::Component;

 private:
  hal::In<double> in0_{pin<hal::In<double>>("in0", "First component")};
  hal::In<double> in1_{pin<hal::In<double>>("in1", "Second component")};
  hal::In<double> in2_{pin<hal::In<double>>("in2", "Third component")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "sqrt(in0^2 + in1^2 + in2^2)")};

  void update(const hal::Period&) noexcept {
    const double a = in0_, b = in1_, c = in2_;
    out_ = std::sqrt(a * a + b * b + c * c);
  }
  hal::Function update_{function<&Hypot::update>("", "Computes out from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Hypot)
