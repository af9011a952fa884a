// conv_s32_float: s32 to float.
#include "hal/component.hpp"

namespace kerf::components {

class ConvS32Float final : public hal::Component<ConvS32Float> {
 public:
  static constexpr hal::Info kInfo{.name = "conv-s32-float",
                                   .summary = "Converts a value from s32 to float",
                                   .notes = "Every s32 has an exact float."};
  using Component::Component;

 private:
  hal::In<std::int32_t> in_{pin<hal::In<std::int32_t>>("in", "Value to convert")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "The same number")};

  void update(const hal::Period&) noexcept { out_ = static_cast<double>(in_.get()); }
  hal::Function update_{function<&ConvS32Float::update>("", "Computes out from in")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::ConvS32Float)
