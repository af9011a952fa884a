// conv_float_s32: float to s32.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class ConvFloatS32 final : public hal::Component<ConvFloatS32> {
 public:
  static constexpr hal::Info kInfo{
      .name = "conv-float-s32",
      .summary = "Converts a value from float to s32",
      .notes =
          "The fraction is cut off (towards zero). What does not fit into an s32 sets "
          "out-of-range; it is brought to the nearest s32 with clamp, and wraps around without. "
          "Not-a-number gives zero and out-of-range."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Value to convert")};
  hal::Out<std::int32_t> out_{pin<hal::Out<std::int32_t>>("out", "The whole part of in")};
  hal::Out<bool> out_of_range_{
      pin<hal::Out<bool>>("out-of-range", "True while in does not fit into an s32")};
  hal::Param<bool> clamp_{param<hal::Param<bool>>(
      "clamp", "True: stop at the ends of the range. False: wrap around", false)};

  void update(const hal::Period&) noexcept {
    constexpr double kMin = -2147483648.0, kMax = 2147483647.0;
    const double whole = std::trunc(in_);
    const bool fits = whole >= kMin && whole <= kMax;
    out_of_range_ = !fits;
    if (fits) {
      out_ = static_cast<std::int32_t>(whole);
    } else if (std::isnan(whole)) {
      out_ = 0;
    } else if (clamp_ || std::isinf(whole)) {
      out_ = whole < 0.0 ? INT32_MIN : INT32_MAX;
    } else {
      const double turns = std::fmod(whole, 4294967296.0);
      out_ =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(turns)));
    }
  }
  hal::Function update_{function<&ConvFloatS32::update>("", "Computes out from in")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::ConvFloatS32)
