// and2: AND of two bits.
#include "hal/component.hpp"

namespace kerf::components {

class And2 final : public hal::Component<And2> {
 public:
  static constexpr hal::Info kInfo{.name = "and2",
                                   .summary = "Two-input AND gate",
                                   .notes = "out is true while in0 and in1 are both true."};
  using Component::Component;

 private:
  hal::In<bool> in0_{pin<hal::In<bool>>("in0", "First input")};
  hal::In<bool> in1_{pin<hal::In<bool>>("in1", "Second input")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True while both inputs are true")};

  void update(const hal::Period&) noexcept { out_ = in0_ && in1_; }
  hal::Function update_{function<&And2::update>("", "Computes out from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::And2)
