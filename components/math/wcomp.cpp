// wcomp: window comparator.
#include "hal/component.hpp"

namespace kerf::components {

class Wcomp final : public hal::Component<Wcomp> {
 public:
  static constexpr hal::Info kInfo{
      .name = "wcomp",
      .summary = "Window comparator",
      .notes = "One of the three outputs is true, as long as max is above min."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Value to compare")};
  hal::In<double> min_{pin<hal::In<double>>("min", "Lower end of the window")};
  hal::In<double> max_{pin<hal::In<double>>("max", "Upper end of the window")};
  hal::Out<bool> out_{
      pin<hal::Out<bool>>("out", "True while in is between min and max, and at neither")};
  hal::Out<bool> under_{pin<hal::Out<bool>>("under", "True while in is at or below min")};
  hal::Out<bool> over_{pin<hal::Out<bool>>("over", "True while in is at or above max")};

  void update(const hal::Period&) noexcept {
    const double in = in_;
    const bool under = in <= min_, over = in >= max_;
    under_ = under;
    over_ = over;
    out_ = !under && !over;
  }
  hal::Function update_{function<&Wcomp::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Wcomp)
