// lut5: any function of five bits.
#include "hal/component.hpp"

namespace kerf::components {

class Lut5 final : public hal::Component<Lut5> {
 public:
  static constexpr hal::Info kInfo{.name = "lut5",
                                   .summary = "Any function of five bits",
                                   .notes =
                                       "Bit n of function is the output for inputs that read as "
                                       "the number n, in-0 being the lowest bit."};
  using Component::Component;

 private:
  hal::PinArray<hal::In<bool>, 5> in_{pins<hal::In<bool>, 5>("in-#", 5, "Input")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "Bit of function that the inputs choose")};
  hal::Param<std::uint32_t> function_{
      param<hal::Param<std::uint32_t>>("function", "Truth table", 0)};

  void update(const hal::Period&) noexcept {
    std::uint32_t row = 0;
    for (std::size_t i = 0; i < in_.size(); ++i) row |= std::uint32_t{in_[i].get()} << i;
    out_ = (function_ >> row & 1U) != 0;
  }
  hal::Function update_{function<&Lut5::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Lut5)
