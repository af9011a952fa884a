// ilowpass: low-pass filter of counts.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Ilowpass final : public hal::Component<Ilowpass> {
 public:
  static constexpr hal::Info kInfo{
      .name = "ilowpass",
      .summary = "Low-pass filter of counts",
      .notes = "Makes the steps of a handwheel a smooth motion: divide the jog scale by scale."};
  using Component::Component;

 private:
  hal::In<std::int32_t> in_{pin<hal::In<std::int32_t>>("in", "Counts")};
  hal::Out<std::int32_t> out_{pin<hal::Out<std::int32_t>>("out", "in * scale, filtered")};
  hal::Param<double> scale_{
      param<hal::Param<double>>("scale", "Counts of out for one of in", 1024)};
  hal::Param<double> gain_{param<hal::Param<double>>(
      "gain", "Share of the difference that a call makes up for, from 0 to 1", 0.5)};
  double value_{0.0};

  void update(const hal::Period&) noexcept {
    value_ += (in_ * scale_ - value_) * gain_;
    out_ = value_ >= 2147483647.0   ? INT32_MAX
           : value_ > -2147483648.0 ? static_cast<std::int32_t>(std::floor(value_ + 0.5))
                                    : INT32_MIN;
  }
  hal::Function update_{function<&Ilowpass::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Ilowpass)
