// timedelay: a time-delay relay.
#include "hal/component.hpp"

namespace kerf::components {

class Timedelay final : public hal::Component<Timedelay> {
 public:
  static constexpr hal::Info kInfo{
      .name = "timedelay",
      .summary = "Time-delay relay",
      .notes =
          "out takes the value of in once in has had it for on-delay (to true) or off-delay (to "
          "false). A shorter change of in is not passed on."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Input")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "The input, delayed")};
  hal::In<double> on_delay_s_{pin<hal::In<double>>(
      "on-delay", "Time that in must be true before out becomes true [s]", 0.5)};
  hal::In<double> off_delay_s_{pin<hal::In<double>>(
      "off-delay", "Time that in must be false before out becomes false [s]", 0.5)};
  hal::Out<double> elapsed_s_{
      pin<hal::Out<double>>("elapsed", "Time since in last left out's value [s]")};
  std::int64_t elapsed_ns_{0};

  void update(const hal::Period& period) noexcept {
    const bool now = in_;
    if (now == out_.last()) {
      elapsed_ns_ = 0;  // the pin keeps showing the last delay
      return;
    }
    elapsed_ns_ += period.nominal_ns;
    elapsed_s_ = static_cast<double>(elapsed_ns_) * 1e-9;
    // Half a nanosecond of slack: the delay is a decimal fraction, the clock is whole.
    const double delay_ns = (now ? on_delay_s_ : off_delay_s_) * 1e9;
    if (!(static_cast<double>(elapsed_ns_) + 0.5 < delay_ns)) {
      out_ = now;
      elapsed_ns_ = 0;
    }
  }
  hal::Function update_{function<&Timedelay::update>("", "Passes in on when its time has come")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Timedelay)
