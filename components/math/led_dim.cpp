// led_dim: brightness as the eye sees it.
#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class LedDim final : public hal::Component<LedDim> {
 public:
  static constexpr hal::Info kInfo{
      .name = "led-dim",
      .summary = "Brightness of a lamp as the eye sees it",
      .notes =
          "out is the share of the time for which the lamp must be lit to look as bright as in "
          "says, by the formula of the CIE of 1931: half as bright needs 0.184. Give it to a "
          "pwmgen."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Wanted brightness, 0 to 1")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Luminance, 0 to 1")};

  void update(const hal::Period&) noexcept {
    const double in = in_;
    const double lightness = in > 0.0 ? rtapi::limited(in, 0.0, 1.0) * 100.0 : 0.0;
    const double root = (lightness + 16.0) / 116.0;
    out_ = lightness <= 8.0 ? lightness / 903.3 : root * root * root;
  }
  hal::Function update_{function<&LedDim::update>("", "Computes the output from the input")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::LedDim)
