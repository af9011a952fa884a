// or2: OR of two bits.
#include "hal/component.hpp"

namespace kerf::components {

class Or2 final : public hal::Component<Or2> {
 public:
  static constexpr hal::Info kInfo{.name = "or2",
                                   .summary = "Two-input OR gate",
                                   .notes = "out is false while in0 and in1 are both false."};
  using Component::Component;

 private:
  hal::In<bool> in0_{pin<hal::In<bool>>("in0", "First input")};
  hal::In<bool> in1_{pin<hal::In<bool>>("in1", "Second input")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True while at least one input is true")};

  void update(const hal::Period&) noexcept { out_ = in0_ || in1_; }
  hal::Function update_{function<&Or2::update>("", "Computes out from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Or2)
