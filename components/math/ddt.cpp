// ddt: rate of change.
#include "hal/component.hpp"

namespace kerf::components {

class Ddt final : public hal::Component<Ddt> {
 public:
  static constexpr hal::Info kInfo{
      .name = "ddt",
      .summary = "Rate of change of a value",
      .notes =
          "out is the change of in since the last call, divided by the thread's period. Only "
          "two values are looked at: an input that changes more slowly than the thread runs "
          "gives zeros with single peaks between them. The value before the first call counts "
          "as zero."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Value to differentiate")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Change of in per second")};
  double before_{0.0};

  void update(const hal::Period& period) noexcept {
    const double now = in_;
    out_ = (now - before_) / period.seconds();
    before_ = now;
  }
  hal::Function update_{function<&Ddt::update>("", "Computes out from in and its last value")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Ddt)
