// near: are two values almost the same?
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Near final : public hal::Component<Near> {
 public:
  static constexpr hal::Info kInfo{
      .name = "near",
      .summary = "Tells whether two values are about equal",
      .notes =
          "Two measures, and either is enough: the ratio of the inputs (scale) or their "
          "distance (difference). With the default values out is true for equal inputs only. "
          "The ratio counts for inputs of the same sign: an at-speed signal works in both "
          "directions."};
  using Component::Component;

 private:
  hal::In<double> in1_{pin<hal::In<double>>("in1", "First value")};
  hal::In<double> in2_{pin<hal::In<double>>("in2", "Second value")};
  hal::Out<bool> out_{pin<hal::Out<bool>>("out", "True while the values are near each other")};
  hal::Param<double> scale_{param<hal::Param<double>>(
      "scale", "Near when in1/scale <= in2 <= in1*scale; mirrored for negative in1", 1.0)};
  hal::Param<double> difference_{
      param<hal::Param<double>>("difference", "Near when |in1 - in2| <= difference", 0.0)};

  void update(const hal::Period&) noexcept {
    const double a = in1_, b = in2_, scale = scale_;
    const double low = a >= 0.0 ? a / scale : a * scale;
    const double high = a >= 0.0 ? a * scale : a / scale;
    out_ = (b >= low && b <= high) || std::fabs(a - b) <= difference_;
  }
  hal::Function update_{function<&Near::update>("", "Compares the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Near)
