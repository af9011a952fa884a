// bitslice: takes a u32 to pieces.
#include "hal/component.hpp"

namespace kerf::components {

class Bitslice final : public hal::Component<Bitslice> {
 public:
  static constexpr hal::Info kInfo{.name = "bitslice",
                                   .summary = "Takes a u32 to pieces",
                                   .notes =
                                       "personality= is the number of bits, at most 32 (default "
                                       "16). weighted_sum does the inverse."};
  using Component::Component;

 private:
  static std::size_t count() noexcept {
    return personality() > 0 ? static_cast<std::size_t>(personality()) : 16;
  }

  hal::In<std::uint32_t> in_{pin<hal::In<std::uint32_t>>("in", "Number to take apart")};
  hal::PinArray<hal::Out<bool>, 32> out_{
      pins<hal::Out<bool>, 32>("out-##", count(), "Bit of this weight")};

  void update(const hal::Period&) noexcept {
    const std::uint32_t in = in_;
    for (std::size_t i = 0; i < out_.size(); ++i) out_[i] = (in >> i & 1U) != 0;
  }
  hal::Function update_{function<&Bitslice::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Bitslice)
