// tristate_bit: writes a bit only while it is enabled.
#include "hal/component.hpp"

namespace kerf::components {

class TristateBit final : public hal::Component<TristateBit> {
 public:
  static constexpr hal::Info kInfo{.name = "tristate-bit",
                                   .summary = "Writes a bit only while it is enabled",
                                   .notes =
                                       "Several of them can share one signal, as drivers on a bus "
                                       "do; see that one at a time is enabled."};
  using Component::Component;

 private:
  hal::In<bool> in_{pin<hal::In<bool>>("in", "Value to write")};
  hal::Io<bool> out_{
      pin<hal::Io<bool>>("out", "Gets in while enable is true, and is left alone else")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True writes")};

  void update(const hal::Period&) noexcept {
    if (enable_) out_ = in_.get();
  }
  hal::Function update_{function<&TristateBit::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::TristateBit)
