// limit3: bounds a value, its rate of change and the rate of that.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class Limit3 final : public hal::Component<Limit3> {
 public:
  static constexpr hal::Info kInfo{
      .name = "limit3",
      .summary = "Bounds a value, its rate of change and the rate of that",
      .notes =
          "For a position these are limits of position, speed and acceleration. out stops on in "
          "exactly, without passing it, when in stands still. With enable false it goes to zero, "
          "within the same limits."};
  using Component::Component;

 private:
  hal::In<double> in_{pin<hal::In<double>>("in", "Input")};
  hal::In<bool> enable_{
      pin<hal::In<bool>>("enable", "True: out follows in; false: out goes to zero", true)};
  hal::Out<double> out_{pin<hal::Out<double>>("out", "Input within the limits")};
  hal::In<bool> load_{pin<hal::In<bool>>("load", "True: out is in at once", false)};
  hal::In<double> min_{pin<hal::In<double>>("min", "Lowest value of out", -1e20)};
  hal::In<double> max_{pin<hal::In<double>>("max", "Highest value of out", 1e20)};
  hal::In<double> maxv_{pin<hal::In<double>>("maxv", "Most that out may change in a second", 1e20)};
  hal::In<double> maxa_{
      pin<hal::In<double>>("maxa", "Most that the rate of change may change in a second", 1e7)};
  hal::In<std::uint32_t> smooth_steps_{
      pin<hal::In<std::uint32_t>>("smooth-steps", "Accepted; out comes to rest without this", 2)};

  /// The longest first step of a row that gets shorter by `change` each time and ends at `way`.
  static double stopping_step(double way, double change) noexcept {
    const double size = std::fabs(way);
    if (size == 0.0 || size <= change) return way;
    const double steps =
        std::max(1.0, std::ceil((std::sqrt(1.0 + 8.0 * size / change) - 1.0) / 2.0 - 1e-9));
    return std::copysign(size / steps + change * (steps - 1.0) / 2.0, way);
  }
  double value_{0.0}, step_{0.0}, target_{0.0};

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds();
    const double min = min_, max = max_;
    double target = enable_ ? in_ : 0.0;
    if (target > max) target = max;
    if (target < min) target = min;
    if (load_) {
      out_ = value_ = target;
      step_ = 0.0;
      target_ = target;
      return;
    }
    const double most = std::min(std::fabs(maxv_) * dt, 1e300),
                 change = std::min(std::fabs(maxa_) * dt * dt, 1e300);
    // An input under way is met at its speed; the bounds stand still.
    const double way = rtapi::limited(target - target_, -most, most);
    target_ = target;
    double step = way + stopping_step(target - value_ - way, change);
    if (max >= value_) step = std::min(step, stopping_step(max - value_, change));
    if (min <= value_) step = std::max(step, stopping_step(min - value_, change));
    step = rtapi::limited(step, -most, most);
    // The bounds of the value are never broken, not even for maxa.
    step = rtapi::limited(step, step_ - change, step_ + change);
    double value = value_ + step;
    if (value > max && step > 0.0) value = std::max(max, std::min(value_, value));
    if (value < min && step < 0.0) value = std::min(min, std::max(value_, value));
    step_ = value - value_;
    out_ = value_ = value;
  }
  hal::Function update_{function<&Limit3::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Limit3)
