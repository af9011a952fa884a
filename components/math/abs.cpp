// abs: absolute value and sign of a float.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Abs final : public hal::Component<Abs> {
 public:
  static constexpr hal::Info kInfo{.name = "abs",
                                   .summary = "Absolute value and sign of a float",
                                   .notes = "Zero is neither positive nor negative."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input value")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "The input without its sign")};
  hal::Out<bool> sign_{pin<hal::Out<bool>>("sign", "True while in is negative")};
  hal::Out<bool> is_positive_{pin<hal::Out<bool>>("is-positive", "True while in is above zero")};
  hal::Out<bool> is_negative_{pin<hal::Out<bool>>("is-negative", "True while in is below zero")};

  void update(const hal::Period&) noexcept {
    const double in = in_;
    const bool negative = in < 0.0;
    out_ = std::fabs(in);
    sign_ = negative;
    is_negative_ = negative;
    is_positive_ = in > 0.0;
  }
  hal::Function update_{function<&Abs::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Abs)
