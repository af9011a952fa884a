// clarke2: clarke transform of two phases.
#include "hal/component.hpp"

namespace kerf::components {

namespace {
constexpr double kRoot3 = 1.7320508075688772935;
}

class Clarke2 final : public hal::Component<Clarke2> {
 public:
  static constexpr hal::Info kInfo{
      .name = "clarke2",
      .summary = "Clarke transform of two phases",
      .notes =
          "For three wires, whose currents add up to zero: the third phase need not be measured."};
  using Component::Component;

 private:
  hal::In<double> a_{pin<hal::In<double>>("a", "First phase")};
  hal::In<double> b_{pin<hal::In<double>>("b", "Second phase")};
  hal::Out<double> x_{pin<hal::Out<double>>("x", "Component along the first phase")};
  hal::Out<double> y_{pin<hal::Out<double>>("y", "Component a quarter turn ahead of x")};

  void update(const hal::Period&) noexcept {
    const double a = a_;
    x_ = a;
    y_ = (a + 2.0 * b_) / kRoot3;
  }
  hal::Function update_{function<&Clarke2::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Clarke2)
