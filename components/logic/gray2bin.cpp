// gray2bin: gray code to binary number.
#include "hal/component.hpp"

namespace kerf::components {

class Gray2bin final : public hal::Component<Gray2bin> {
 public:
  static constexpr hal::Info kInfo{.name = "gray2bin",
                                   .summary = "Gray code to binary number",
                                   .notes = "The inverse of bin2gray."};
  using Component::Component;

 private:
  hal::In<std::uint32_t> in_{pin<hal::In<std::uint32_t>>("in", "Gray code")};
  hal::Out<std::uint32_t> out_{pin<hal::Out<std::uint32_t>>("out", "The number it stands for")};

  void update(const hal::Period&) noexcept {
    std::uint32_t value = in_;
    for (std::uint32_t shift = 1; shift < 32; shift *= 2) value ^= value >> shift;
    out_ = value;
  }
  hal::Function update_{function<&Gray2bin::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Gray2bin)
