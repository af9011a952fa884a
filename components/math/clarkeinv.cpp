// clarkeinv: inverse Clarke transform.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

namespace {
constexpr double kRoot3 = 1.7320508075688772935;
constexpr double kRoot2 = 1.4142135623730950488;
}  // namespace

class Clarkeinv final : public hal::Component<Clarkeinv> {
 public:
  static constexpr hal::Info kInfo{
      .name = "clarkeinv",
      .summary = "Inverse Clarke transform",
      .notes = "The vector is turned by theta before it is split up into phases."};
  using Component::Component;

 private:
  hal::In<double> x_{pin<hal::In<double>>("x", "Component along the first phase")};
  hal::In<double> y_{pin<hal::In<double>>("y", "Component a quarter turn ahead of x")};
  hal::In<double> h_{pin<hal::In<double>>("h", "What is added to all phases")};
  hal::In<double> theta_{pin<hal::In<double>>("theta", "Angle to turn by [revolutions]")};
  hal::Out<double> a_{pin<hal::Out<double>>("a", "First phase")};
  hal::Out<double> b_{pin<hal::Out<double>>("b", "Second phase")};
  hal::Out<double> c_{pin<hal::Out<double>>("c", "Third phase")};

  void update(const hal::Period&) noexcept {
    constexpr double kTwoPi = 6.283185307179586476925;
    const double sine = std::sin(theta_ * kTwoPi), cosine = std::cos(theta_ * kTwoPi);
    const double x = x_ * cosine - y_ * sine, y = x_ * sine + y_ * cosine;
    const double h = h_ / kRoot2, part = y * (kRoot3 / 2.0);
    a_ = x + h;
    b_ = -0.5 * x + part + h;
    c_ = -0.5 * x - part + h;
  }
  hal::Function update_{function<&Clarkeinv::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Clarkeinv)
