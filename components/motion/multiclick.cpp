// multiclick: tells single, double, triple and quadruple clicks.
#include "hal/component.hpp"

namespace kerf::components {

class Multiclick final : public hal::Component<Multiclick> {
 public:
  static constexpr hal::Info kInfo{
      .name = "multiclick",
      .summary = "Tells single, double, triple and quadruple clicks",
      .notes =
          "A click is a press of at most max-hold-ns; clicks belong together when at most "
          "max-space-ns lie between them. The -click pins come at once, the -click-only pins when "
          "it is sure that no further click follows: they are the ones for MDI commands."};

  explicit Multiclick(hal::Builder& b) noexcept : Component(b) {
    constexpr const char* kNames[]{"single", "double", "triple", "quadruple"};
    for (int i = 0; i < 4; ++i) {
      hal::Name name(kNames[i]);
      name.append("-click");
      click_[i].declare(b, b.full_name(name), "Pulse as soon as so many clicks have come");
      name.append("-only");
      only_[i].declare(b, b.full_name(name),
                       "Pulse when so many clicks have come and no further one follows");
    }
  }

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Button")};
  hal::Out<bool> click_[4]{}, only_[4]{};
  hal::Out<std::int32_t> state_{
      pin<hal::Out<std::int32_t>>("state",
                                  "0 idle, odd pressed, even released after as many half clicks, 9 "
                                  "waits for the end of a press that does not count")};
  hal::Param<bool> invert_input_{
      param<hal::Param<bool>>("invert-input", "True: a press is a false input", false)};
  hal::Param<std::uint32_t> max_hold_ns_{
      param<hal::Param<std::uint32_t>>("max-hold-ns", "Longest press of a click [ns]", 250000000)};
  hal::Param<std::uint32_t> max_space_ns_{param<hal::Param<std::uint32_t>>(
      "max-space-ns", "Longest pause between clicks [ns]", 250000000)};
  hal::Param<std::uint32_t> output_hold_ns_{param<hal::Param<std::uint32_t>>(
      "output-hold-ns", "Length of the output pulses [ns]", 100000000)};

  static constexpr std::int32_t kIgnored = 9;
  void pulse(hal::Out<bool>& pin, std::int64_t& left_ns) noexcept {
    pin = true;
    left_ns = output_hold_ns_;
  }
  std::int64_t timer_ns_{0}, click_left_ns_[4]{}, only_left_ns_[4]{};

  void update(const hal::Period& period) noexcept {
    const bool pressed = in_ != invert_input_;
    for (int i = 0; i < 4; ++i) {
      if (click_left_ns_[i] > 0 && (click_left_ns_[i] -= period.nominal_ns) <= 0) click_[i] = false;
      if (only_left_ns_[i] > 0 && (only_left_ns_[i] -= period.nominal_ns) <= 0) only_[i] = false;
    }
    timer_ns_ += period.nominal_ns;
    std::int32_t state = state_.last();
    const bool down = (state & 1) != 0;
    if (state == kIgnored) {
      if (!pressed) state = 0;
    } else if (down && !pressed) {
      ++state;
      timer_ns_ = 0;
      pulse(click_[state / 2 - 1], click_left_ns_[state / 2 - 1]);
    } else if (down) {
      if (timer_ns_ > max_hold_ns_) state = kIgnored;
    } else if (pressed) {
      ++state;
      timer_ns_ = 0;
    } else if (state > 0 && timer_ns_ > max_space_ns_) {
      pulse(only_[state / 2 - 1], only_left_ns_[state / 2 - 1]);
      state = 0;
    }
    state_ = state;
  }
  hal::Function update_{function<&Multiclick::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Multiclick)
