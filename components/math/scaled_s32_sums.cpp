// scaled_s32_sums: weighted sum of four s32.
#include "hal/component.hpp"

namespace kerf::components {

class ScaledS32Sums final : public hal::Component<ScaledS32Sums> {
 public:
  static constexpr hal::Info kInfo{
      .name = "scaled-s32-sums",
      .summary = "Weighted sum of four s32",
      .notes = "The sum comes as float and, without its fraction, as s32."};
  using Component::Component;

 private:
  hal::PinArray<hal::In<std::int32_t>, 4> in_{
      pins<hal::In<std::int32_t>, 4>("in#", 4, "Number to add")};
  hal::PinArray<hal::In<double>, 4> scale_{
      pins<hal::In<double>, 4>("scale#", 4, "Factor of the input of this number", 1.0)};
  hal::Out<std::int32_t> out_s_{pin<hal::Out<std::int32_t>>("out-s", "The sum, whole part")};
  hal::Out<double> out_f_{pin<hal::Out<double>>("out-f", "The sum")};

  void update(const hal::Period&) noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < in_.size(); ++i) sum += in_[i] * scale_[i];
    out_f_ = sum;
    out_s_ = sum >= 2147483647.0   ? INT32_MAX
             : sum > -2147483648.0 ? static_cast<std::int32_t>(sum)
                                   : INT32_MIN;
  }
  hal::Function update_{
      function<&ScaledS32Sums::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::ScaledS32Sums)
