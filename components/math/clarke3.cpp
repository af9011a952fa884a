// clarke3: clarke transform of three phases.
#include "hal/component.hpp"

namespace kerf::components {

namespace {
constexpr double kRoot3 = 1.7320508075688772935;
constexpr double kRoot2 = 1.4142135623730950488;
}  // namespace

class Clarke3 final : public hal::Component<Clarke3> {
 public:
  static constexpr hal::Info kInfo{.name = "clarke3",
                                   .summary = "Clarke transform of three phases",
                                   .notes =
                                       "h is the sum of the phases times a third of the root of "
                                       "two, and zero where they add up to zero."};
  using Component::Component;

 private:
  hal::In<double> a_{pin<hal::In<double>>("a", "First phase")};
  hal::In<double> b_{pin<hal::In<double>>("b", "Second phase")};
  hal::In<double> c_{pin<hal::In<double>>("c", "Third phase")};
  hal::Out<double> x_{pin<hal::Out<double>>("x", "Component along the first phase")};
  hal::Out<double> y_{pin<hal::Out<double>>("y", "Component a quarter turn ahead of x")};
  hal::Out<double> h_{pin<hal::Out<double>>("h", "What the three phases have in common")};

  void update(const hal::Period&) noexcept {
    const double a = a_, b = b_, c = c_;
    x_ = (2.0 * a - b - c) / 3.0;
    y_ = (b - c) / kRoot3;
    h_ = (a + b + c) * (kRoot2 / 3.0);
  }
  hal::Function update_{function<&Clarke3::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Clarke3)
