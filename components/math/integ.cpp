// integ: integrator with reset and bounds.
#include "hal/component.hpp"

namespace kerf::components {

class Integ final : public hal::Component<Integ> {
 public:
  static constexpr hal::Info kInfo{.name = "integ",
                                   .summary = "Integrator with reset and bounds",
                                   .notes = "out starts from zero."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::In<double> gain_{pin<hal::In<double>>("gain", "Factor of in", 1.0)};
  hal::Out<double> out_{
      pin<hal::Out<double>>("out", "Integral of gain * in over time since the reset")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "While true out is zero")};
  hal::In<double> max_{pin<hal::In<double>>("max", "Highest value of out", 1e20)};
  hal::In<double> min_{pin<hal::In<double>>("min", "Lowest value of out", -1e20)};

  void update(const hal::Period& period) noexcept {
    double out = reset_ ? 0.0 : out_.last() + gain_ * in_ * period.seconds();
    if (out > max_) out = max_;
    if (out < min_) out = min_;
    out_ = out;
  }
  hal::Function update_{function<&Integ::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Integ)
