// limit1: bounds a value.
#include "hal/component.hpp"

namespace kerf::components {

class Limit1 final : public hal::Component<Limit1> {
 public:
  static constexpr hal::Info kInfo{
      .name = "limit1",
      .summary = "Keeps a value between min and max",
      .notes =
          "Bounds the value only: for the rate of change too, see limit2. With min above max, "
          "max wins."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Input, but not beyond min and max")};
  hal::In<double> min_{pin<hal::In<double>>("min", "Lowest value of out", -1e20)};
  hal::In<double> max_{pin<hal::In<double>>("max", "Highest value of out", 1e20)};

  void update(const hal::Period&) noexcept {
    double value = in_;
    const double min = min_, max = max_;
    if (value < min) value = min;
    if (value > max) value = max;
    out_ = value;
  }
  hal::Function update_{function<&Limit1::update>("", "Computes out from in")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Limit1)
