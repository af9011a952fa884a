// limit2: bounds a value and its rate of change.
#include "hal/component.hpp"

namespace kerf::components {

class Limit2 final : public hal::Component<Limit2> {
 public:
  static constexpr hal::Info kInfo{
      .name = "limit2",
      .summary = "Keeps a value between min and max and its rate of change below maxv",
      .notes =
          "For a position these are limits of position and velocity. out starts from zero and "
          "walks to in; load makes it jump there. When min or max moves past out, out walks back "
          "within them; with min above max an input below min counts as min, any other as max."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Input within the limits")};
  hal::In<bool> load_{pin<hal::In<bool>>("load", "True: out follows in whatever maxv says")};
  hal::In<double> min_{pin<hal::In<double>>("min", "Lowest value of out", -1e20)};
  hal::In<double> max_{pin<hal::In<double>>("max", "Highest value of out", 1e20)};
  hal::In<double> maxv_{pin<hal::In<double>>("maxv", "Most that out may change in a second", 1e20)};
  double before_{0.0};

  void update(const hal::Period& period) noexcept {
    const double min = min_, max = max_;
    double value = in_;
    if (value < min)
      value = min;
    else if (value > max)
      value = max;
    if (!load_) {
      const double step = maxv_ * period.seconds();
      if (value < before_ - step)
        value = before_ - step;
      else if (value > before_ + step)
        value = before_ + step;
    }
    before_ = value;
    out_ = value;
  }
  hal::Function update_{function<&Limit2::update>("", "Computes out from in and its last value")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Limit2)
