// output_buffer: outputs that change together.
#include "hal/component.hpp"

namespace kerf::components {

class OutputBuffer final : public hal::Component<OutputBuffer> {
 public:
  static constexpr hal::Info kInfo{
      .name = "output-buffer",
      .summary = "Bits that are passed on together",
      .notes =
          "personality= is the number of bits, 1 to 32 (default 8). While update is true the "
          "outputs follow the inputs; while it is false they keep their values, so that all "
          "change in the same cycle. With enable false all are false at once."};
  explicit OutputBuffer(hal::Builder& b) noexcept : Component(b) {
    if (b.personality() < 0 || b.personality() > 32)
      b.fail("personality= must be from 1 to 32: the number of bits");
  }

 private:
  static std::size_t count() noexcept {
    return personality() > 0 && personality() <= 32 ? static_cast<std::size_t>(personality()) : 8;
  }
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "False: all outputs are false", true)};
  hal::In<bool> update_pin_{pin<hal::In<bool>>("update", "True: the outputs follow the inputs")};
  hal::PinArray<hal::In<bool>, 32> in_{pins<hal::In<bool>, 32>("in-##", count(), "Wanted value")};
  hal::PinArray<hal::Out<bool>, 32> out_{
      pins<hal::Out<bool>, 32>("out-##", count(), "The input's value at the last update")};

  void update(const hal::Period&) noexcept {
    const bool enable = enable_;
    if (enable && !update_pin_) return;
    for (std::size_t i = 0; i < out_.size(); ++i) out_[i] = enable && in_[i];
  }
  hal::Function update_{function<&OutputBuffer::update>("", "Passes the bits on")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::OutputBuffer)
