// demux: sets one of many bits by number.
#include <algorithm>

#include "hal/component.hpp"

namespace kerf::components {

class Demux final : public hal::Component<Demux> {
 public:
  static constexpr hal::Info kInfo{
      .name = "demux",
      .summary = "Sets one of many bits by number",
      .notes =
          "personality= is the number of outputs, at most 32 (default 32). The number is that of "
          "the sel-bit pins plus sel-u32; a number past the last output is that of the last."};
  using Component::Component;

 private:
  static std::size_t count() noexcept {
    return personality() > 0 ? static_cast<std::size_t>(personality()) : 32;
  }

  hal::PinArray<hal::In<bool>, 5> sel_bit_{
      pins<hal::In<bool>, 5>("sel-bit-##", 5, "Bit of the number")};
  hal::In<std::uint32_t> sel_u32_{
      pin<hal::In<std::uint32_t>>("sel-u32", "Added to the number of the bits")};
  hal::PinArray<hal::Out<bool>, 32> out_{
      pins<hal::Out<bool>, 32>("out-##", count(), "True while it is selected")};
  hal::Param<bool> bargraph_{param<hal::Param<bool>>(
      "bargraph", "True: all outputs below the number are true, like the bars of a gauge", false)};

  void update(const hal::Period&) noexcept {
    // 2^31 and more are below zero, as in LinuxCNC: no output at all.
    std::uint32_t number = sel_u32_;
    for (std::size_t i = 0; i < sel_bit_.size(); ++i)
      number += std::uint32_t{sel_bit_[i].get()} << i;
    const bool bargraph = bargraph_;
    const auto count = static_cast<std::int32_t>(out_.size());
    const std::int32_t selected = std::min(static_cast<std::int32_t>(number), count - 1);
    for (std::int32_t i = 0; i < count; ++i)
      out_[static_cast<std::size_t>(i)] = bargraph ? i < selected : i == selected;
  }
  hal::Function update_{function<&Demux::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Demux)
