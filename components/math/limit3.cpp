// limit3: bounds a value, its rate of change and the rate of that.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class Limit3 final : public hal::Component<Limit3> {
 public:
  static constexpr hal::Info kInfo{
      .name = "limit3",
      .summary = "Bounds a value, its rate of change and the rate of that",
      .notes =
          "For a position these are limits of position, speed and acceleration. An input that "
          "moves "
          "within the limits is followed without lag. With enable false out goes to zero, within "
          "the same limits."};
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
  hal::In<std::uint32_t> smooth_steps_{pin<hal::In<std::uint32_t>>(
      "smooth-steps", "Over so many calls before it comes to rest out slows down evenly", 2)};

  /// The next step of a row that begins behind `step`, gets shorter by at most `change` each time and ends `way` ahead. With all of
  /// the acceleration or none, as LinuxCNC; only within smooth-steps it is spread evenly over the rest.
  [[nodiscard]] double approach(double way, double step, double low, double high,
                                double change) const noexcept {
    if (way < 0.0 || (way == 0.0 && step > 0.0)) return -towards(-way, -step, -high, -low, change);
    return towards(way, step, low, high, change);
  }
  static constexpr double kRounding = 1e-9;
  /// Whether a row that begins with `step` can end within `way`.
  static bool can_rest(double way, double step, double change) noexcept {
    return way - step >= step * (step - change) / (2.0 * change) - kRounding * change;
  }
  [[nodiscard]] double towards(double way, double step, double low, double high,
                               double change) const noexcept {
    // Of a way that is rounding alone nothing tells how long a row it takes.
    if (step <= 0.0 || way < 1e-6 * change) return way <= high ? std::max(way, low) : high;
    if (can_rest(way, high, change)) return high;
    double next = way;
    const double rest = 2.0 * way / step, steps = std::ceil(rest - kRounding);
    // Where less is left than the acceleration of a call takes away, out comes to rest and does not turn back; there the rounding is
    // great beside what is left.
    if (steps > 1.0) {
      const double spread = smooth_steps_ + (step < change * (1.0 - kRounding) ? 1e-6 : 0.0);
      next = rest < spread ? step * (steps - 1.0) / steps : step - change;
    }
    return std::max(low, std::min(next, high));
  }
  double value_{0.0}, step_{0.0}, in_before_{0.0};

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds();
    const double min = min_, max = max_;
    const double in = enable_ ? in_ : 0.0;
    double target = in;
    if (target > max) target = max;
    if (target < min) target = min;
    if (load_) {
      out_ = value_ = target;
      step_ = 0.0;
      in_before_ = in;
      return;
    }
    const double most = std::min(std::fabs(maxv_) * dt, 1e300),
                 change = std::min(std::fabs(maxa_) * dt * dt, 1e300);
    const double low = std::max(step_ - change, -most), high = std::min(step_ + change, most);
    // An input under way is met at its speed, beyond the bounds too, as LinuxCNC; the bounds stand still.
    const double way = in - in_before_;
    double step = way + approach(target - way - value_, step_ - way, low - way, high - way, change);
    in_before_ = in;
    if (step > 0.0 && max >= value_ && !can_rest(max - value_, step, change))
      step = std::min(step, approach(max - value_, step_, low, high, change));
    if (step < 0.0 && min <= value_ && !can_rest(value_ - min, -step, change))
      step = std::max(step, approach(min - value_, step_, low, high, change));
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
