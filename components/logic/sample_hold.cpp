// sample_hold: sample and hold.
#include "hal/component.hpp"

namespace kerf::components {

class SampleHold final : public hal::Component<SampleHold> {
 public:
  static constexpr hal::Info kInfo{.name = "sample-hold",
                                   .summary = "Sample and hold",
                                   .notes = "While hold is true out keeps what it has."};
  using Component::Component;

 private:
  hal::In<std::int32_t> in_{pin<hal::In<std::int32_t>>("in", "Input")};
  hal::In<bool> hold_{pin<hal::In<bool>>("hold", "True holds out")};
  hal::Out<std::int32_t> out_{
      pin<hal::Out<std::int32_t>>("out", "The input, or its value as hold became true")};

  void update(const hal::Period&) noexcept {
    if (!hold_) out_ = in_.get();
  }
  hal::Function update_{function<&SampleHold::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SampleHold)
