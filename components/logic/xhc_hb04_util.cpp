// xhc_hb04_util: logic of the XHC-HB04 pendant.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class XhcHb04Util final : public hal::Component<XhcHb04Util> {
 public:
  static constexpr hal::Info kInfo{
      .name = "xhc-hb04-util",
      .summary = "Logic of the XHC-HB04 pendant",
      .notes = "A start/pause button for the pins of halui, and four low-pass filters of counts."};
  using Component::Component;

 private:
  hal::In<bool> start_or_pause_{pin<hal::In<bool>>("start-or-pause", "Button")};
  hal::In<bool> is_paused_{pin<hal::In<bool>>("is-paused", "From halui.program.is-paused")};
  hal::In<bool> is_idle_{pin<hal::In<bool>>("is-idle", "From halui.program.is-idle")};
  hal::In<bool> is_running_{pin<hal::In<bool>>("is-running", "From halui.program.is-running")};
  hal::Out<bool> pause_{pin<hal::Out<bool>>("pause", "For halui.program.pause")};
  hal::Out<bool> resume_{pin<hal::Out<bool>>("resume", "For halui.program.resume")};
  hal::Out<bool> run_{pin<hal::Out<bool>>("run", "For halui.program.run")};
  hal::PinArray<hal::In<std::int32_t>, 4> in_{
      pins<hal::In<std::int32_t>, 4>("in#", 4, "Counts to filter")};
  hal::PinArray<hal::Out<std::int32_t>, 4> out_{
      pins<hal::Out<std::int32_t>, 4>("out#", 4, "Filtered counts")};
  hal::PinArray<hal::In<double>, 4> scale_{
      pins<hal::In<double>, 4>("scale#", 4, "Factor of the filtered counts", 1.0)};
  hal::PinArray<hal::In<double>, 4> coef_{pins<hal::In<double>, 4>(
      "coef#", 4, "Share of the difference that a call makes up for, from 0 to 1", 1.0)};
  hal::In<double> divide_by_k_in_{pin<hal::In<double>>("divide-by-k-in", "Dividend")};
  hal::Out<double> divide_by_k_out_{pin<hal::Out<double>>("divide-by-k-out", "divide-by-k-in / k")};
  hal::In<double> k_{pin<hal::In<double>>("k", "Divisor; zero gives 1e99", 1.0)};
  bool pressed_before_{false};
  double value_[4]{};

  void update(const hal::Period&) noexcept {
    const bool pressed = start_or_pause_;
    if (pressed && !pressed_before_) {
      if (is_idle_)
        run_ = true;
      else if (is_running_)
        pause_ = true;
      else if (is_paused_)
        resume_ = true;
    } else if (!pressed) {
      run_ = false;
      resume_ = false;
      pause_ = false;
    }
    pressed_before_ = pressed;
    for (std::size_t i = 0; i < in_.size(); ++i) {
      value_[i] += (in_[i] - value_[i]) * coef_[i];
      const double out = std::ceil(value_[i] * scale_[i] - 0.5);
      out_[i] = out >= 2147483647.0   ? INT32_MAX
                : out > -2147483648.0 ? static_cast<std::int32_t>(out)
                                      : INT32_MIN;
    }
    divide_by_k_out_ = k_ != 0.0 ? divide_by_k_in_ / k_ : 1e99;
  }
  hal::Function update_{function<&XhcHb04Util::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::XhcHb04Util)
