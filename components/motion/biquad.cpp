// biquad: filter of the second order.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Biquad final : public hal::Component<Biquad> {
 public:
  static constexpr hal::Info kInfo{
      .name = "biquad",
      .summary = "Filter of the second order",
      .notes =
          "H(z) = (n0 + n1/z + n2/z^2) / (1 + d1/z + d2/z^2). A rising edge of enable computes the "
          "coefficients for type and starts from rest."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::Out<double> out_{
      pin<hal::Out<double>>("out", "Filtered input, or in while enable is false")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True filters", false)};
  hal::Out<bool> valid_{pin<hal::Out<bool>>(
      "valid",
      "True while the coefficients are good: Q from 0.5 to 2, f0 up to half the rate of calls",
      false)};
  hal::In<std::uint32_t> type_{pin<hal::In<std::uint32_t>>(
      "type", "0: n0, n1, n2, d1 and d2 are given; 1 low pass; 2 notch", 0)};
  hal::In<double> f0_{pin<hal::In<double>>("f0", "Corner or notch frequency [Hz]", 250.0)};
  hal::In<double> q_{pin<hal::In<double>>("Q", "Quality", 0.7071)};
  hal::Out<double> s1_{pin<hal::Out<double>>("s1", "First state of the filter", 0.0)};
  hal::Out<double> s2_{pin<hal::Out<double>>("s2", "Second state of the filter", 0.0)};
  hal::Param<double> d1_{
      param<hal::Param<double>>("d1", "First coefficient of the denominator", 0.0)};
  hal::Param<double> d2_{
      param<hal::Param<double>>("d2", "Second coefficient of the denominator", 0.0)};
  hal::Param<double> n0_{param<hal::Param<double>>("n0", "Coefficient of the input", 1.0)};
  hal::Param<double> n1_{
      param<hal::Param<double>>("n1", "Coefficient of the input one call ago", 0.0)};
  hal::Param<double> n2_{
      param<hal::Param<double>>("n2", "Coefficient of the input two calls ago", 0.0)};

  bool set_up(double period_s) noexcept {
    if (type_ == 0) return true;
    const double q = q_, f0 = f0_;
    if (type_ > 2 || !(q >= 0.5 && q <= 2.0) || !(f0 >= 0.0 && f0 * period_s <= 0.5)) return false;
    const double w = 6.283185307179586476925 * f0 * period_s;
    const double cosine = std::cos(w), alpha = std::sin(w) / (2.0 * q), unit = 1.0 + alpha;
    d1_ = -2.0 * cosine / unit;
    d2_ = (1.0 - alpha) / unit;
    if (type_ == 1) {
      n0_ = (1.0 - cosine) / 2.0 / unit;
      n1_ = (1.0 - cosine) / unit;
      n2_ = (1.0 - cosine) / 2.0 / unit;
    } else {
      n0_ = 1.0 / unit;
      n1_ = -2.0 * cosine / unit;
      n2_ = 1.0 / unit;
    }
    return true;
  }
  bool before_{false};

  void update(const hal::Period& period) noexcept {
    const double in = in_;
    const bool enable = enable_;
    if (enable && !before_) {
      const bool valid = set_up(period.seconds());
      valid_ = valid;
      if (type_ != 0 && valid) {
        s1_ = 0.0;
        s2_ = 0.0;
      }
    }
    before_ = enable;
    if (!enable) {
      out_ = in;
    } else if (valid_.last()) {
      const double out = in * n0_ + s1_.last();
      s1_ = in * n1_ - out * d1_ + s2_.last();
      s2_ = in * n2_ - out * d2_;
      out_ = out;
    } else {
      out_ = in;
    }
  }
  hal::Function update_{function<&Biquad::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Biquad)
