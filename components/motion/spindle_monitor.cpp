// spindle_monitor: tells whether a spindle has come to its speed and kept it.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class SpindleMonitor final : public hal::Component<SpindleMonitor> {
 public:
  static constexpr hal::Info kInfo{
      .name = "spindle-monitor",
      .summary = "Tells whether a spindle has come to its speed and kept it",
      .notes =
          "After the spindle is switched on the component waits for the speed; once it is there a "
          "drop below it is kept until the spindle is switched off."};
  using Component::Component;

 private:
  hal::In<bool> spindle_is_on_{pin<hal::In<bool>>("spindle-is-on", "True while the spindle is on")};
  hal::In<double> spindle_command_{pin<hal::In<double>>("spindle-command", "Wanted speed")};
  hal::In<double> spindle_feedback_{pin<hal::In<double>>("spindle-feedback", "Speed now")};
  hal::Out<bool> spindle_at_speed_{
      pin<hal::Out<bool>>("spindle-at-speed", "True once the speed has been reached")};
  hal::Out<bool> spindle_underspeed_{
      pin<hal::Out<bool>>("spindle-underspeed", "True once it has fallen below it again")};
  hal::Param<std::uint32_t> level_{param<hal::Param<std::uint32_t>>(
      "level", "State: 0 off, 1 waits for the speed, 2 watches it", 0)};
  hal::Param<double> threshold_{param<hal::Param<double>>(
      "threshold", "Difference from the wanted speed that does not count", 0.0)};

  void update(const hal::Period&) noexcept {
    const double missing = spindle_command_ - spindle_feedback_, threshold = threshold_;
    const std::uint32_t level = level_;
    if (level == 0) {
      spindle_at_speed_ = false;
      spindle_underspeed_ = false;
      if (spindle_is_on_) level_ = 1U;
      return;
    }
    if (!spindle_is_on_) {
      level_ = 0U;
    } else if (level == 1 && std::fabs(missing) < threshold) {
      spindle_at_speed_ = true;
      level_ = 2U;
    } else if (level == 2 && missing > threshold) {
      spindle_underspeed_ = true;
    }
  }
  hal::Function update_{
      function<&SpindleMonitor::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SpindleMonitor)
