// toggle: push on, push off.
#include "hal/component.hpp"

namespace kerf::components {

class Toggle final : public hal::Component<Toggle> {
 public:
  static constexpr hal::Info kInfo{
      .name = "toggle",
      .summary = "Push-on, push-off switch from a momentary button",
      .notes =
          "Each press of the button turns out over. out may also be set by others, and the next "
          "press turns over what they set. The button counts as pressed or released after it "
          "was so for debounce calls; a debounce of 0 or above 10000 becomes 2."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Button, true while pressed")};
  hal::Io<bool> out_{pin<hal::Io<bool>>("out", "Turned over by each press")};
  static constexpr std::uint32_t kUsualCalls = 2, kMostCalls = 10000;
  hal::Param<std::uint32_t> debounce_{param<hal::Param<std::uint32_t>>(
      "debounce", "Calls that the button must keep its state", kUsualCalls)};
  bool pressed_{false};
  std::uint32_t calls_{0};  // since the button left its state

  void update(const hal::Period&) noexcept {
    if (debounce_ < 1 || debounce_ > kMostCalls) debounce_ = kUsualCalls;
    if (in_ == pressed_) {
      if (calls_ > 0) --calls_;
      return;
    }
    if (++calls_ < debounce_) return;
    calls_ = 0;
    pressed_ = !pressed_;
    if (pressed_) out_ = !out_.get();
  }
  hal::Function update_{function<&Toggle::update>("", "Looks at the button")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Toggle)
