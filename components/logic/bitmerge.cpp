// bitmerge: makes a u32 of bits.
#include "hal/component.hpp"

namespace kerf::components {

class Bitmerge final : public hal::Component<Bitmerge> {
 public:
  static constexpr hal::Info kInfo{.name = "bitmerge",
                                   .summary = "Makes a u32 of bits",
                                   .notes =
                                       "personality= is the number of bits, at most 32 (default "
                                       "16). bitslice does the inverse."};
  using Component::Component;

 private:
  static std::size_t count() noexcept {
    return personality() > 0 ? static_cast<std::size_t>(personality()) : 16;
  }

  hal::Out<std::uint32_t> out_{pin<hal::Out<std::uint32_t>>("out", "The number")};
  hal::PinArray<hal::In<bool>, 32> in_{
      pins<hal::In<bool>, 32>("in-##", count(), "Bit of this weight")};

  void update(const hal::Period&) noexcept {
    std::uint32_t out = 0;
    for (std::size_t i = 0; i < in_.size(); ++i) out |= std::uint32_t{in_[i].get()} << i;
    out_ = out;
  }
  hal::Function update_{function<&Bitmerge::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Bitmerge)
