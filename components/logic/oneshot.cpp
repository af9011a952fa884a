// oneshot: one pulse of a set length at each trigger.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Oneshot final : public hal::Component<Oneshot> {
 public:
  static constexpr hal::Info kInfo{
      .name = "oneshot",
      .summary = "One-shot pulse generator",
      .notes =
          "A trigger edge at in makes a pulse of width seconds, rounded up to whole periods of "
          "the thread. With retriggerable a trigger during the pulse starts its time anew. "
          "reset ends the pulse; an input that is true as reset goes counts as a rising edge."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Trigger input")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "True ends the pulse and allows none")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True during the pulse")};
  hal::Out<bool> out_not_{pin<hal::Out<bool>>("out-not", "False during the pulse")};
  hal::In<double> width_s_{pin<hal::In<double>>("width", "Length of the pulse [s]", 0.0)};
  hal::Out<double> left_s_{pin<hal::Out<double>>(
      "time-left", "Rest of the running pulse; stands still during reset [s]")};
  hal::Param<bool> retriggerable_{param<hal::Param<bool>>(
      "retriggerable", "True: edges during the pulse make it longer", true)};
  hal::Param<bool> rising_{
      param<hal::Param<bool>>("rising", "True: rising edges of in are triggers", true)};
  hal::Param<bool> falling_{
      param<hal::Param<bool>>("falling", "True: falling edges of in are triggers", false)};
  bool before_{false};
  std::int64_t left_ns_{0};

  void update(const hal::Period& period) noexcept {
    const bool now = in_;
    const bool trigger = (rising_ && now && !before_) || (falling_ && !now && before_);
    before_ = now;
    // An edge in the period in which the pulse ends comes within it.
    const bool takes = retriggerable_ || left_ns_ == 0;
    if (left_ns_ > 0) left_ns_ = left_ns_ > period.nominal_ns ? left_ns_ - period.nominal_ns : 0;
    if (trigger && takes) left_ns_ = width_ns();
    if (reset_) {
      left_ns_ = 0;
      before_ = false;
    } else {
      left_s_ = static_cast<double>(left_ns_) * 1e-9;
    }
    out_ = left_ns_ > 0;
    out_not_ = left_ns_ == 0;
  }

  /// Whole nanoseconds, so that the number of periods does not hang on rounding.
  std::int64_t width_ns() const noexcept {
    const double ns = width_s_ * 1e9;
    if (!(ns > 0.0)) return 0;
    return ns < 9e18 ? std::llround(ns) : INT64_MAX;
  }
  hal::Function update_{function<&Oneshot::update>("", "Makes pulses from triggers")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Oneshot)
