// select8: one of eight bits.
#include "hal/component.hpp"

namespace kerf::components {

class Select8 final : public hal::Component<Select8> {
 public:
  static constexpr hal::Info kInfo{.name = "select8",
                                   .summary = "One of eight bits",
                                   .notes = "Other values of sel leave all outputs false."};
  using Component::Component;

 private:
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "False: all outputs are false", true)};
  hal::In<std::int32_t> sel_{
      pin<hal::In<std::int32_t>>("sel", "Number of the output that is true")};
  hal::PinArray<hal::Out<bool>, 8> out_{
      pins<hal::Out<bool>, 8>("out#", 8, "True while it is selected")};

  void update(const hal::Period&) noexcept {
    const std::int64_t selected = enable_ ? std::int64_t{sel_} : -1;
    for (std::size_t i = 0; i < out_.size(); ++i)
      out_[i] = static_cast<std::int64_t>(i) == selected;
  }
  hal::Function update_{function<&Select8::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Select8)
