// comp: comparator with hysteresis.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Comp final : public hal::Component<Comp> {
 public:
  static constexpr hal::Info kInfo{
      .name = "comp",
      .summary = "Two-input comparator with hysteresis",
      .notes =
          "out becomes true as in1 rises more than hyst/2 above in0 and false as it falls more "
          "than hyst/2 below it; between the two it keeps its state. With hyst of zero that is "
          "while the inputs are equal. equal needs a hyst above zero to be of use, as floats are "
          "seldom equal."};
  using Component::Component;

 private:
  hal::In<double> in0_{pin<hal::In<double>>("in0", "Inverting input")};
  hal::In<double> in1_{pin<hal::In<double>>("in1", "Non-inverting input")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True while in1 is above in0")};
  hal::Out<bool> equal_{
      pin<hal::Out<bool>>("equal", "True while the inputs differ by no more than hyst/2")};
  hal::Param<double> hyst_{
      param<hal::Param<double>>("hyst", "Distance between the two switching points", 0.0)};

  void update(const hal::Period&) noexcept {
    const double above = in1_ - in0_, half = 0.5 * hyst_;
    if (above > half) out_ = true;
    if (above < -half) out_ = false;
    equal_ = std::fabs(above) <= half;
  }
  hal::Function update_{function<&Comp::update>("", "Compares the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Comp)
