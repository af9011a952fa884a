// bitwise: bitwise operations on two u32.
#include "hal/component.hpp"

namespace kerf::components {

class Bitwise final : public hal::Component<Bitwise> {
 public:
  static constexpr hal::Info kInfo{
      .name = "bitwise",
      .summary = "Bitwise operations on two u32",
      .notes = "Each bit of an output comes from the bits of the same weight."};
  using Component::Component;

 private:
  hal::In<std::uint32_t> in0_{pin<hal::In<std::uint32_t>>("in0", "First number")};
  hal::In<std::uint32_t> in1_{pin<hal::In<std::uint32_t>>("in1", "Second number")};
  hal::Out<std::uint32_t> out_and_{
      pin<hal::Out<std::uint32_t>>("out-and", "Bits that are set in both")};
  hal::Out<std::uint32_t> out_or_{
      pin<hal::Out<std::uint32_t>>("out-or", "Bits that are set in at least one")};
  hal::Out<std::uint32_t> out_xor_{
      pin<hal::Out<std::uint32_t>>("out-xor", "Bits that are set in one alone")};
  hal::Out<std::uint32_t> out_nand_{
      pin<hal::Out<std::uint32_t>>("out-nand", "The complement of out-and")};
  hal::Out<std::uint32_t> out_nor_{
      pin<hal::Out<std::uint32_t>>("out-nor", "The complement of out-or")};
  hal::Out<std::uint32_t> out_xnor_{
      pin<hal::Out<std::uint32_t>>("out-xnor", "The complement of out-xor")};

  void update(const hal::Period&) noexcept {
    const std::uint32_t a = in0_, b = in1_;
    out_and_ = a & b;
    out_or_ = a | b;
    out_xor_ = a ^ b;
    out_nand_ = ~(a & b);
    out_nor_ = ~(a | b);
    out_xnor_ = ~(a ^ b);
  }
  hal::Function update_{function<&Bitwise::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Bitwise)
