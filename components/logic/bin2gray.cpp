// bin2gray: binary number to Gray code.
#include "hal/component.hpp"

namespace kerf::components {

class Bin2gray final : public hal::Component<Bin2gray> {
 public:
  static constexpr hal::Info kInfo{
      .name = "bin2gray",
      .summary = "Binary number to Gray code",
      .notes = "Neighbouring numbers differ in one bit of their Gray codes."};
  using Component::Component;

 private:
  hal::In<std::uint32_t> in_{pin<hal::In<std::uint32_t>>("in", "Binary number")};
  hal::Out<std::uint32_t> out_{pin<hal::Out<std::uint32_t>>("out", "Its Gray code")};

  void update(const hal::Period&) noexcept { out_ = in_ ^ (in_ >> 1U); }
  hal::Function update_{function<&Bin2gray::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Bin2gray)
