// ton: delay timer that is late to switch on.
#include "hal/component.hpp"

namespace kerf::components {

class Ton final : public hal::Component<Ton> {
 public:
  static constexpr hal::Info kInfo{.name = "ton",
                                   .summary = "Delay timer that is late to switch on",
                                   .notes = "As the on-delay timer of IEC 61131-3."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Input signal")};
  hal::Out<bool> q_{pin<hal::Out<bool>>("q", "True once in has been true for pt")};
  hal::Out<double> et_{
      pin<hal::Out<double>>("et", "Time that in has been true, until pt is over [s]")};
  hal::Param<double> pt_{param<hal::Param<double>>("pt", "Delay [s]", 0.0)};

  void update(const hal::Period& period) noexcept {
    if (!in_) {
      et_ = 0.0;
      q_ = false;
      return;
    }
    if (et_.last() < pt_)
      et_ = et_.last() + period.seconds();
    else
      q_ = true;
  }
  hal::Function update_{function<&Ton::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Ton)
