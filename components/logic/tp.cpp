// tp: a pulse of set length at a rising edge.
#include "hal/component.hpp"

namespace kerf::components {

class Tp final : public hal::Component<Tp> {
 public:
  static constexpr hal::Info kInfo{.name = "tp",
                                   .summary = "Pulse of set length at a rising edge",
                                   .notes =
                                       "As the pulse timer of IEC 61131-3: what in does "
                                       "during the pulse changes nothing."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Input signal")};
  hal::Out<bool> q_{pin<hal::Out<bool>>("q", "True for pt from a rising edge of in on")};
  hal::Out<double> et_{pin<hal::Out<double>>(
      "et", "Time since the pulse began; after it, pt until in is false [s]")};
  hal::Param<double> pt_{param<hal::Param<double>>("pt", "Length of the pulse [s]", 0.0)};
  bool before_{false}, runs_{false};

  void update(const hal::Period& period) noexcept {
    const bool in = in_;
    if (!runs_ && in && !before_) runs_ = true;
    before_ = in;
    if (runs_) {
      if (et_.last() < pt_) {
        q_ = true;
        et_ = et_.last() + period.seconds();
      } else if (q_.last()) {
        q_ = false;
      } else {
        // Over, and in may still be true: the next pulse begins at its next rising edge.
        et_ = 0.0;
        runs_ = false;
      }
    }
  }
  hal::Function update_{function<&Tp::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Tp)
