// charge_pump: square wave for a charge pump.
#include "hal/component.hpp"

namespace kerf::components {

class ChargePump final : public hal::Component<ChargePump> {
 public:
  static constexpr hal::Info kInfo{
      .name = "charge-pump",
      .summary = "Square wave for a charge pump",
      .notes = "The wave tells hardware that the computer runs: it ends with the thread.",
      .singleton = true};
  using Component::Component;

 private:
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "Changes at each call while enable is true")};
  hal::Out<bool> out_2_{pin<hal::Out<bool>>("out-2", "Has half the frequency of out")};
  hal::Out<bool> out_4_{pin<hal::Out<bool>>("out-4", "Has a quarter of the frequency of out")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "False: all outputs are false", true)};
  std::uint32_t count_{0};

  void update(const hal::Period&) noexcept {
    const bool enable = enable_;
    if (enable) ++count_;
    out_ = enable && (count_ & 1U) != 0;
    out_2_ = enable && (count_ & 2U) != 0;
    out_4_ = enable && (count_ & 4U) != 0;
  }
  hal::Function update_{function<&ChargePump::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::ChargePump)
