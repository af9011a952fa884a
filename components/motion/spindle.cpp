// spindle: spindle with acceleration and gears for drives without position.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class Spindle final : public hal::Component<Spindle> {
 public:
  static constexpr hal::Info kInfo{
      .name = "spindle",
      .summary = "Spindle with acceleration and gears for drives without position",
      .notes =
          "gears= is the number of gears, at most 16: each has its speeds, acceleration, scale and "
          "offset. Without an encoder (simulate-encoder) the speed is that of a spindle that "
          "follows at once. Mind that these are not the pins of the motion controller, which have "
          "similar names."};

  explicit Spindle(hal::Builder& b) noexcept : Component(b) {
    const std::int64_t gears =
        int_arg("gears", int_arg("numgears", 1, "The same as gears="), "Number of gears, 1 to 16");
    if (gears < 1 || gears > 16) {
      b.fail("gears= must be from 1 to 16");
      return;
    }
    gears_ = hal::make_array<Gear>(b, static_cast<std::size_t>(gears), gears == 1);
  }

 private:
  struct Gear {
    Gear(hal::Builder& b, std::size_t index, bool the_only_one) noexcept {
      const auto name = [&](const char* pattern) {
        return b.full_name(hal::numbered(pattern, index));
      };
      select.declare(b, name("select.#"), "True selects this gear; of several the highest",
                     the_only_one);
      scale.declare(b, name("scale.#"), "Output for one rpm, negative to turn the other way", 1.0);
      min.declare(b, name("min.#"), "Lowest speed of this gear [rpm]");
      max.declare(b, name("max.#"), "Highest speed of this gear [rpm], 0 none");
      accel.declare(b, name("accel.#"), "Acceleration [rpm per second], 0 at once");
      decel.declare(b, name("decel.#"), "Deceleration [rpm per second], 0 at once");
      speed_tolerance.declare(b, name("speed-tolerance.#"),
                              "Difference that counts as at speed [rpm]", 20.0);
      zero_tolerance.declare(b, name("zero-tolerance.#"), "Speed that counts as standing [rpm]",
                             20.0);
      offset.declare(b, name("offset.#"), "Added to the speed for the output [rpm]");
    }
    hal::In<bool> select;
    hal::In<double> scale, min, max, accel, decel, speed_tolerance, zero_tolerance, offset;
  };
  double speed_{0.0}, shown_{0.0};

  hal::In<std::uint32_t> select_gear_{
      pin<hal::In<std::uint32_t>>("select-gear", "Gear; 0 leaves it to the select inputs")};
  hal::In<double> commanded_speed_{
      pin<hal::In<double>>("commanded-speed", "Wanted speed, signed [rpm]")};
  hal::In<double> actual_speed_{
      pin<hal::In<double>>("actual-speed", "Speed from an encoder [revolutions per second]")};
  hal::In<bool> simulate_encoder_{
      pin<hal::In<bool>>("simulate-encoder", "True: there is no encoder")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "False stops the spindle")};
  hal::In<double> spindle_lpf_{
      pin<hal::In<double>>("spindle-lpf", "Smoothing of spindle-rpm-abs at speed, 0 none")};
  hal::Out<double> spindle_rpm_{pin<hal::Out<double>>("spindle-rpm", "Speed, signed [rpm]")};
  hal::Out<double> spindle_rpm_abs_{
      pin<hal::Out<double>>("spindle-rpm-abs", "Speed without sign [rpm]")};
  hal::Out<double> output_{pin<hal::Out<double>>("output", "Value for the drive")};
  hal::Out<std::uint32_t> current_gear_{
      pin<hal::Out<std::uint32_t>>("current-gear", "Gear in use")};
  hal::Out<bool> at_speed_{
      pin<hal::Out<bool>>("at-speed", "True while the speed is the wanted one")};
  hal::Out<bool> forward_{pin<hal::Out<bool>>("forward", "True while it is to turn forwards")};
  hal::Out<bool> reverse_{pin<hal::Out<bool>>("reverse", "True while it is to turn backwards")};
  hal::Out<bool> brake_{pin<hal::Out<bool>>("brake", "True while it slows down")};
  hal::Out<bool> zero_speed_{pin<hal::Out<bool>>("zero-speed", "True while it stands")};
  hal::Out<bool> limited_{
      pin<hal::Out<bool>>("limited", "True while the wanted speed is beyond the gear's")};
  hal::Array<Gear> gears_;

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds();
    std::size_t number = std::min<std::size_t>(select_gear_, gears_.size() - 1);
    for (std::size_t i = 0; select_gear_ == 0 && i < gears_.size(); ++i)
      if (gears_[i].select) number = i;
    Gear& gear = gears_[number];
    current_gear_ = static_cast<std::uint32_t>(number);
    const bool simulated = simulate_encoder_;
    const double now = simulated ? speed_ : actual_speed_ * 60.0;
    double size = std::fabs(commanded_speed_.get());
    bool limited = false;
    if (!enable_) size = 0.0;
    if (size > 0.0 && size < gear.min) {
      size = gear.min;
      limited = true;
    }
    if (gear.max > 0.0 && size > gear.max) {
      size = gear.max;
      limited = true;
    }
    limited_ = limited;
    const double wanted = std::copysign(size, commanded_speed_);
    const double base = simulated ? speed_ : now;
    // Beside an encoder the steps are speeds, so that the acceleration depends on the load.
    const double per_step = simulated ? dt : 1.0;
    const auto step_of = [per_step](double rate) noexcept {
      return rate > 0.0 ? rate * per_step : HUGE_VAL;
    };
    // Slowing down ends at standstill: the other direction begins with acceleration.
    const bool slows = (base > 0.0 && wanted < base) || (base < 0.0 && wanted > base);
    // Within the tolerance of the command, whatever its limits make of it, it is at speed, and commanded no more by steps.
    const double asked = enable_ ? commanded_speed_.get() : 0.0;
    const bool at_speed = gear.speed_tolerance > 0.0 &&
                          std::fabs(asked - now) <= gear.speed_tolerance && !(asked * now < 0.0);
    double next = wanted;
    if (!at_speed && slows) {
      const double step = step_of(gear.decel);
      next = base > 0.0 ? std::max(base - step, std::max(wanted, 0.0))
                        : std::min(base + step, std::min(wanted, 0.0));
    } else if (!at_speed) {
      const double step = step_of(gear.accel);
      next = rtapi::limited(wanted, base - step, base + step);
    }
    brake_ = slows && !at_speed;
    // The simulation goes on where the encoder left off.
    speed_ = simulated ? next : now;
    spindle_rpm_ = simulated ? next : now;
    const double size_now = std::fabs(now);
    const bool was_at_speed = at_speed_.last();
    at_speed_ = at_speed;
    zero_speed_ = size_now <= gear.zero_tolerance;
    const double smooth = spindle_lpf_;
    shown_ = was_at_speed && smooth > 0.0 ? shown_ + (size_now - shown_) * smooth * dt : size_now;
    spindle_rpm_abs_ = shown_;
    forward_ = next > 0.0 && (size > 0.0 || forward_.last());
    reverse_ = size > 0.0 && next < 0.0;
    output_ = (std::fabs(next) + gear.offset) * gear.scale;
  }
  hal::Function update_{function<&Spindle::update>("", "Computes the outputs from the inputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Spindle)
