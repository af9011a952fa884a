// mux16: one of sixteen values, by binary or Gray code.
#include "hal/component.hpp"

namespace kerf::components {

class Mux16 final : public hal::Component<Mux16> {
 public:
  static constexpr hal::Info kInfo{
      .name = "mux16",
      .summary = "One of sixteen values, by binary or Gray code",
      .notes = "After a change the selectors are used once they have differed for debounce-time."};
  using Component::Component;

 private:
  hal::In<bool> use_graycode_{
      pin<hal::In<bool>>("use-graycode", "True: the selectors are a Gray code")};
  hal::In<bool> suppress_no_input_{pin<hal::In<bool>>(
      "suppress-no-input", "True: out stays what it is while no selector is true")};
  hal::In<double> debounce_time_{pin<hal::In<double>>(
      "debounce-time", "Time for which the selectors must differ from those in use [s]")};
  hal::PinArray<hal::In<bool>, 4> sel_{
      pins<hal::In<bool>, 4>("sel#", 4, "Bit of the number of the input")};
  hal::Out<double> out_f_{pin<hal::Out<double>>("out-f", "The selected input")};
  hal::Out<std::int32_t> out_s_{pin<hal::Out<std::int32_t>>(
      "out-s", "The selected input without its fraction, within the range of s32")};
  hal::PinArray<hal::In<double>, 16> in_{
      pins<hal::In<double>, 16>("in##", 16, "Value while it is selected")};
  hal::RoParam<double> elapsed_{param<hal::RoParam<double>>(
      "elapsed", "Time for which other selectors have been waiting [s]")};
  hal::RoParam<std::int32_t> selected_{
      param<hal::RoParam<std::int32_t>>("selected", "Number of the selected input")};
  std::uint32_t in_use_{0};

  void update(const hal::Period& period) noexcept {
    std::uint32_t code = 0;
    for (std::size_t i = 0; i < sel_.size(); ++i) code |= std::uint32_t{sel_[i].get()} << i;
    if (suppress_no_input_ && code == 0) return;
    std::uint32_t number = code;
    if (use_graycode_)
      for (std::uint32_t shift = 1; shift < 4; shift *= 2) number ^= number >> shift;
    // What was selected without a debounce-time is not in use yet for one that comes later.
    if (number != in_use_ && debounce_time_ > 0.0) {
      if (elapsed_.last() < debounce_time_) {
        elapsed_ = elapsed_.last() + period.seconds();
        return;
      }
      in_use_ = number;
      elapsed_ = 0.0;
    }
    selected_ = static_cast<std::int32_t>(number);
    const double value = in_[number];
    out_f_ = value;
    out_s_ = value >= 2147483647.0   ? INT32_MAX
             : value > -2147483647.0 ? static_cast<std::int32_t>(value)
                                     : -INT32_MAX;
  }
  hal::Function update_{function<&Mux16::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Mux16)
