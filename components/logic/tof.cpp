// tof: delay timer that is late to switch off.
#include "hal/component.hpp"

namespace kerf::components {

class Tof final : public hal::Component<Tof> {
 public:
  static constexpr hal::Info kInfo{.name = "tof",
                                   .summary = "Delay timer that is late to switch off",
                                   .notes = "As the off-delay timer of IEC 61131-3."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Input signal")};
  hal::Out<bool> q_{pin<hal::Out<bool>>("q", "True while in is true and for pt after")};
  hal::Out<double> et_{
      pin<hal::Out<double>>("et", "Time since in became false, until pt is over [s]")};
  hal::Param<double> pt_{param<hal::Param<double>>("pt", "Delay [s]", 0.0)};

  void update(const hal::Period& period) noexcept {
    if (in_) {
      et_ = 0.0;
      q_ = true;
      return;
    }
    if (et_.last() < pt_)
      et_ = et_.last() + period.seconds();
    else
      q_ = false;
  }
  hal::Function update_{function<&Tof::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Tof)
