// muxN: one of N values by the bits of its number. The build gives KERF_INPUTS, a power of two.
#include "hal/component.hpp"

namespace kerf::components {

namespace {
constexpr std::size_t kInputs = KERF_INPUTS;
constexpr std::size_t kSelectors = kInputs == 8 ? 3 : 2;
static_assert(std::size_t{1} << kSelectors == kInputs);
// Without linkage: there are several of the name.
class Mux final : public hal::Component<Mux> {
 public:
  static constexpr hal::Info kInfo{
      .name = kInputs == 8 ? "mux8" : "mux4",
      .summary = kInputs == 8 ? "Selects one of eight values" : "Selects one of four values",
      .notes =
          "The sel pins are the bits of the number of the input, sel0 the lowest. The change "
          "from one input to another is a step."};
  using Component::Component;

 private:
  hal::PinArray<hal::In<bool>, kSelectors> sel_{
      pins<hal::In<bool>, kSelectors>("sel#", kSelectors, "Bit of the number of the input")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "The selected input")};
  hal::PinArray<hal::In<double>, kInputs> in_{
      pins<hal::In<double>, kInputs>("in#", kInputs, "Value of out while it is selected")};

  void update(const hal::Period&) noexcept {
    std::size_t selected = 0;
    for (std::size_t i = 0; i < kSelectors; ++i) selected |= std::size_t{sel_[i].get()} << i;
    out_ = in_[selected].get();
  }
  hal::Function update_{function<&Mux::update>("", "Copies the selected input to out")};
};

}  // namespace
}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Mux)
