// radiobutton: one of several buttons is down.
#include "hal/component.hpp"

namespace kerf::components {

class Radiobutton final : public hal::Component<Radiobutton> {
 public:
  static constexpr hal::Info kInfo{
      .name = "radiobutton",
      .summary = "Of several buttons the one pressed last stays on",
      .notes =
          "personality= is the number of buttons, 2 to 32 (default 4). A rising edge of in-NN "
          "turns out-NN on and all others off; of several in one call the lowest counts. Until the "
          "first press, and after a rising edge of off, all are off and selected is -1."};
  explicit Radiobutton(hal::Builder& b) noexcept : Component(b) {
    if (b.personality() != 0 && (b.personality() < 2 || b.personality() > 32))
      b.fail("personality= must be from 2 to 32: the number of buttons");
  }

 private:
  static std::size_t count() noexcept {
    return personality() >= 2 && personality() <= 32 ? static_cast<std::size_t>(personality()) : 4;
  }
  hal::In<bool> off_{pin<hal::In<bool>>("off", "A rising edge turns all off")};
  hal::PinArray<hal::In<bool>, 32> in_{pins<hal::In<bool>, 32>("in-##", count(), "Button")};
  hal::PinArray<hal::Out<bool>, 32> out_{
      pins<hal::Out<bool>, 32>("out-##", count(), "True while this button is the one chosen")};
  hal::Out<std::int32_t> selected_{
      pin<hal::Out<std::int32_t>>("selected", "Number of the button chosen, -1 for none", -1)};
  std::uint32_t before_{0};
  bool off_before_{false};

  void update(const hal::Period&) noexcept {
    std::uint32_t now = 0;
    for (std::size_t i = 0; i < in_.size(); ++i) now |= std::uint32_t{in_[i].get()} << i;
    const std::uint32_t pressed = now & ~before_;
    before_ = now;
    const bool off = off_;
    std::int32_t selected = selected_.last();
    if (off && !off_before_) {
      selected = -1;
    } else if (pressed != 0) {
      selected = 0;
      while ((pressed >> selected & 1U) == 0) ++selected;
    }
    off_before_ = off;
    selected_ = selected;
    for (std::size_t i = 0; i < out_.size(); ++i)
      out_[i] = selected == static_cast<std::int32_t>(i);
  }
  hal::Function update_{function<&Radiobutton::update>("", "Looks at the buttons")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Radiobutton)
