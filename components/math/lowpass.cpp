// lowpass: low-pass filter of the first order.
#include "hal/component.hpp"

namespace kerf::components {

class Lowpass final : public hal::Component<Lowpass> {
 public:
  static constexpr hal::Info kInfo{
      .name = "lowpass",
      .summary = "Low-pass filter of the first order",
      .notes = "For a corner at f Hz and a period of T seconds, gain is 1 - exp(-2 * pi * f * T)."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::Out<double> out_{
      pin<hal::Out<double>>("out", "Filtered input: each call moves it by (in - out) * gain")};
  hal::In<bool> load_{pin<hal::In<bool>>("load", "True: out is in")};
  hal::Param<double> gain_{
      param<hal::Param<double>>("gain", "Share of the difference that a call makes up for", 0.0)};

  void update(const hal::Period&) noexcept {
    const double in = in_, out = out_.last();
    out_ = load_ ? in : out + (in - out) * gain_;
  }
  hal::Function update_{function<&Lowpass::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Lowpass)
