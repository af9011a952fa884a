// ilowpass: low-pass filter of counts.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Ilowpass final : public hal::Component<Ilowpass> {
 public:
  static constexpr hal::Info kInfo{
      .name = "ilowpass",
      .summary = "Low-pass filter of counts",
      .notes =
          "Makes the steps of a handwheel a smooth motion: divide the jog scale by scale. Like "
          "the counts of an encoder, out wraps around at the ends of its type."};
  using Component::Component;

 private:
  hal::In<std::int32_t> in_{pin<hal::In<std::int32_t>>("in", "Counts")};
  hal::Out<std::int32_t> out_{pin<hal::Out<std::int32_t>>("out", "in, filtered, times scale")};
  hal::Param<double> scale_{
      param<hal::Param<double>>("scale", "Counts of out for one of in", 1024)};
  hal::Param<double> gain_{param<hal::Param<double>>(
      "gain", "Share of the difference that a call makes up for, from 0 to 1", 0.5)};
  static constexpr double kEnd = 9223372036854775808.0;  // of s64
  double value_{0.0};

  void update(const hal::Period&) noexcept {
    value_ += (in_ - value_) * gain_;
    // Whoever counts differences goes on as if nothing were where out wraps around.
    const double whole = std::floor(value_ * scale_ + 0.5);
    const bool fits = whole >= -kEnd && whole < kEnd;
    out_ = fits ? static_cast<std::int32_t>(static_cast<std::int64_t>(whole)) : 0;
  }
  hal::Function update_{function<&Ilowpass::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Ilowpass)
