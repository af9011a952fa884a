// minmax: lowest and highest value that an input has had.
#include "hal/component.hpp"

namespace kerf::components {

class Minmax final : public hal::Component<Minmax> {
 public:
  static constexpr hal::Info kInfo{
      .name = "minmax",
      .summary = "Lowest and highest value that an input has had",
      .notes = "Both outputs start from zero: set reset for a cycle to start from in."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Value to watch")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "While true max and min are in")};
  hal::Out<double> max_{pin<hal::Out<double>>("max", "Highest value since the reset")};
  hal::Out<double> min_{pin<hal::Out<double>>("min", "Lowest value since the reset")};

  void update(const hal::Period&) noexcept {
    const double in = in_;
    if (reset_ || in > max_.last()) max_ = in;
    if (reset_ || in < min_.last()) min_ = in;
  }
  hal::Function update_{function<&Minmax::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Minmax)
