// xor2: exclusive OR of two bits.
#include "hal/component.hpp"

namespace kerf::components {

class Xor2 final : public hal::Component<Xor2> {
 public:
  static constexpr hal::Info kInfo{.name = "xor2",
                                   .summary = "Two-input exclusive OR gate",
                                   .notes = "out is true while in0 and in1 differ."};
  using Component::Component;

 private:
  hal::In<bool> in0_{pin<hal::In<bool>>("in0", "First input")};
  hal::In<bool> in1_{pin<hal::In<bool>>("in1", "Second input")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True while the inputs differ")};

  void update(const hal::Period&) noexcept { out_ = in0_.get() != in1_.get(); }
  hal::Function update_{function<&Xor2::update>("", "Computes out from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Xor2)
