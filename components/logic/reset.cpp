// reset: writes values into pins of others at an edge.
#include "hal/component.hpp"

namespace kerf::components {

class Reset final : public hal::Component<Reset> {
 public:
  static constexpr hal::Info kInfo{
      .name = "reset",
      .summary = "Writes values into pins of others at an edge",
      .notes =
          "For pins of direction io that several write, as index-enable or the output of a "
          "toggle. Between edges of trigger the outputs are left alone."};
  using Component::Component;

 private:
  hal::In<bool> trigger_{pin<hal::In<bool>>("trigger", "An edge writes the values")};
  hal::In<bool> reset_bit_{pin<hal::In<bool>>("reset-bit", "Value for out-bit")};
  hal::In<std::int32_t> reset_s32_{pin<hal::In<std::int32_t>>("reset-s32", "Value for out-s32")};
  hal::In<std::uint32_t> reset_u32_{pin<hal::In<std::uint32_t>>("reset-u32", "Value for out-u32")};
  hal::In<double> reset_float_{pin<hal::In<double>>("reset-float", "Value for out-float")};
  hal::Io<bool> out_bit_{pin<hal::Io<bool>>("out-bit", "Is set to reset-bit")};
  hal::Io<std::int32_t> out_s32_{pin<hal::Io<std::int32_t>>("out-s32", "Is set to reset-s32")};
  hal::Io<std::uint32_t> out_u32_{pin<hal::Io<std::uint32_t>>("out-u32", "Is set to reset-u32")};
  hal::Io<double> out_float_{pin<hal::Io<double>>("out-float", "Is set to reset-float")};
  hal::Param<bool> rising_{
      param<hal::Param<bool>>("rising-edge", "True: a rising edge of trigger writes", true)};
  hal::Param<bool> falling_{
      param<hal::Param<bool>>("falling-edge", "True: a falling edge of trigger writes", false)};
  bool before_{false}, first_{true};

  void update(const hal::Period&) noexcept {
    const bool now = trigger_;
    const bool edge = !first_ && now != before_;
    first_ = false;
    before_ = now;
    if (!edge || !(now ? rising_ : falling_)) return;
    out_bit_ = reset_bit_.get();
    out_s32_ = reset_s32_.get();
    out_u32_ = reset_u32_.get();
    out_float_ = reset_float_.get();
  }
  hal::Function update_{function<&Reset::update>("", "Looks at trigger")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Reset)
