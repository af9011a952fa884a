// lincurve: straight lines through points.
#include "hal/component.hpp"

namespace kerf::components {

class Lincurve final : public hal::Component<Lincurve> {
 public:
  static constexpr hal::Info kInfo{.name = "lincurve",
                                   .summary = "Straight lines through points",
                                   .notes =
                                       "personality= is the number of points, at most 16 (default "
                                       "2). Below the first and above the last "
                                       "point out stays. The x values must rise."};
  using Component::Component;

 private:
  static std::size_t count() noexcept {
    return personality() > 0 ? static_cast<std::size_t>(personality()) : 2;
  }

  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Value of the curve at in")};
  hal::Io<double> out_io_{pin<hal::Io<double>>(
      "out-io", "The same, for pins of direction io such as the gains of pid")};
  hal::PinArray<hal::Param<double>, 16> x_val_{
      pins<hal::Param<double>, 16>("x-val-##", count(), "Place of this point on the axis of in")};
  hal::PinArray<hal::Param<double>, 16> y_val_{
      pins<hal::Param<double>, 16>("y-val-##", count(), "Value at this point")};

  void update(const hal::Period&) noexcept {
    const std::size_t last = x_val_.size() - 1;
    const double in = in_;
    std::size_t i = 0;
    // The ends are looked at first, the last one before all: so points that do not ascend have a meaning too.
    if (in >= x_val_[last])
      i = last;
    else if (in > x_val_[0])
      while (i < last && in >= x_val_[i + 1]) ++i;
    double out = y_val_[i];
    if (i < last && in > x_val_[i]) {
      const double x0 = x_val_[i], x1 = x_val_[i + 1], y1 = y_val_[i + 1];
      out += (in - x0) * (y1 - out) / (x1 - x0);
    }
    out_ = out;
    out_io_ = out;
  }
  hal::Function update_{function<&Lincurve::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Lincurve)
