// sim-axis: motor, encoder, home and limit switches of one simulated joint.
#include <algorithm>
#include <cmath>

#include "contact.hpp"
#include "hal/component.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class SimAxis final : public hal::Component<SimAxis> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-axis",
      .summary = "Simulated joint: motor, encoder, home and limit switches",
      .notes =
          "Stands in for the hardware of one joint. Connect pos-cmd to joint.N.motor-pos-cmd, "
          "pos-fb "
          "to joint.N.motor-pos-fb and the switches to joint.N.home-sw-in, neg-lim-sw-in and "
          "pos-lim-sw-in. With its default values the motor follows exactly and no switch is ever "
          "tripped. lag makes it a first-order lag, so that there is a following error of about "
          "velocity * lag; max-velocity bounds what it can do; stuck makes it stand.\n\n"
          "With an inertia it is a drive that moves a mass instead, and lag and max-velocity count "
          "no "
          "more: force is inertia * (bandwidth^2 * error + 2 * bandwidth * error of the velocity), "
          "at most max-force, against friction and damping * velocity. So there is a following "
          "error of (friction + damping * velocity) / (inertia * bandwidth^2) at a steady speed "
          "and "
          "acceleration / bandwidth^2 more while it speeds up; with too little max-force it falls "
          "behind. Without enable the mass runs out by itself.\n\n"
          "The home switch is at home-switch-pos. With a home-switch-width it is a cam: tripped "
          "within half the width on both sides. With width 0 the whole side beyond it is tripped: "
          "the negative side, or the positive one when home-switch-positive is true. Switches look "
          "at the motor's true position, which an encoder index does not change: with an "
          "index-pitch there is an index at each multiple of it, and when index-enable is true as "
          "the motor passes one, pos-fb and pos-cmd count from there and index-enable is cleared. "
          "switch-bounce makes each switch unsteady after each change, always in the same way. All "
          "lengths are in machine units of the joint. Run it after the motion controller."};
  using Component::Component;

 private:
  hal::In<double> pos_cmd_{pin<hal::In<double>>("pos-cmd", "Commanded motor position")};
  hal::In<bool> enable_{
      pin<hal::In<bool>>("enable", "False: the motor stands, or has no force", true)};
  hal::In<bool> stuck_{pin<hal::In<bool>>("stuck", "True: the motor stands, as if jammed")};
  hal::Out<double> pos_fb_{pin<hal::Out<double>>("pos-fb", "Motor position from the encoder")};
  hal::Out<double> vel_fb_{pin<hal::Out<double>>("vel-fb", "Motor velocity [units per second]")};
  hal::Out<double> force_{
      pin<hal::Out<double>>("force", "Of the drive, where there is an inertia")};
  hal::Out<double> true_pos_{
      pin<hal::Out<double>>("true-pos", "Position since the start, whatever the index did")};
  hal::Out<bool> home_sw_{pin<hal::Out<bool>>("home-sw", "Home switch, true while tripped")};
  hal::Out<bool> neg_lim_sw_{
      pin<hal::Out<bool>>("neg-lim-sw", "Negative limit switch, true while tripped")};
  hal::Out<bool> pos_lim_sw_{
      pin<hal::Out<bool>>("pos-lim-sw", "Positive limit switch, true while tripped")};
  hal::Io<bool> index_enable_{
      pin<hal::Io<bool>>("index-enable", "True asks for pos-fb to be zeroed at the next index")};

  hal::Param<double> lag_s_{
      param<hal::Param<double>>("lag", "Time constant of the motor [s]; 0: follows exactly", 0.0)};
  hal::Param<double> max_velocity_{param<hal::Param<double>>(
      "max-velocity", "What the motor can do [units per second]; 0: no bound", 0.0)};
  hal::Param<double> inertia_{param<hal::Param<double>>(
      "inertia", "Force for an acceleration of 1 unit per second^2; 0: no mass", 0.0)};
  hal::Param<double> bandwidth_{
      param<hal::Param<double>>("bandwidth", "Of the drive's position loop [1/s]", 200.0)};
  hal::Param<double> max_force_{
      param<hal::Param<double>>("max-force", "What the drive can do; 0: no bound", 0.0)};
  hal::Param<double> friction_{
      param<hal::Param<double>>("friction", "Force that it takes to move at all", 0.0)};
  hal::Param<double> damping_{
      param<hal::Param<double>>("damping", "Force for a velocity of 1 unit per second", 0.0)};
  hal::Param<double> bounce_s_{param<hal::Param<double>>(
      "switch-bounce", "Time that a switch is unsteady after a change [s]", 0.0)};
  hal::Param<double> home_pos_{
      param<hal::Param<double>>("home-switch-pos", "Place of the home switch", -1e20)};
  hal::Param<double> home_width_{param<hal::Param<double>>(
      "home-switch-width", "Length of the home cam; 0: the whole side is tripped", 0.0)};
  hal::Param<bool> home_positive_{param<hal::Param<bool>>(
      "home-switch-positive", "With width 0: the positive side is tripped", false)};
  hal::Param<double> home_hysteresis_{param<hal::Param<double>>(
      "home-switch-hysteresis", "Travel past the tripping point until the switch opens", 0.0)};
  hal::Param<double> neg_lim_pos_{param<hal::Param<double>>(
      "neg-limit-pos", "Negative limit switch: tripped at and below this", -1e20)};
  hal::Param<double> pos_lim_pos_{param<hal::Param<double>>(
      "pos-limit-pos", "Positive limit switch: tripped at and above this", 1e20)};
  hal::Param<double> index_pitch_{param<hal::Param<double>>(
      "index-pitch", "Distance of the encoder's index pulses; 0: no index", 0.0)};

  double motor_{0.0};         // true position
  double origin_{0.0};        // true position where pos-fb is zero
  double velocity_{0.0};      // of the mass
  double last_wanted_{0.0};   // true position that was commanded last
  bool home_tripped_{false};  // with its hysteresis, before it bounces
  Contact home_contact_, neg_contact_, pos_contact_;

  void update(const hal::Period& period) noexcept {
    const double dt = period.seconds();
    const double before = motor_;
    if (inertia_ > 0.0)
      push(dt);
    else if (enable_ && !stuck_)
      move(dt);
    watch_index(before);
    pos_fb_ = motor_ - origin_;
    vel_fb_ = (motor_ - before) / dt;
    true_pos_ = motor_;
    update_switches(dt);
  }

  /// The mass, in steps much shorter than the loop is fast; in each the command goes on a straight line.
  void push(double dt) noexcept {
    constexpr double kStepsOfLoop = 20.0, kMostSteps = 200.0;
    const double command = pos_cmd_;
    const double wanted = std::isfinite(command) ? command + origin_ : last_wanted_;
    const double inertia = inertia_, bandwidth = std::max(bandwidth_.get(), 0.0);
    const double coulomb = std::max(friction_.get(), 0.0), damping = std::max(damping_.get(), 0.0);
    const double most = max_force_, from = enable_ ? last_wanted_ : wanted;
    const double rate = std::max(bandwidth, damping / inertia);
    const double count = rtapi::limited(std::ceil(rate * dt * kStepsOfLoop), 1.0, kMostSteps);
    const double h = dt / count, wanted_velocity = (wanted - from) / dt;
    double force = 0.0;
    for (double i = 1.0; i <= count && !stuck_; i += 1.0) {
      const double reference = from + (wanted - from) * ((i - 1.0) / count);
      force = 0.0;
      if (enable_) {
        force = inertia * bandwidth *
                (bandwidth * (reference - motor_) + 2.0 * (wanted_velocity - velocity_));
        if (most > 0.0) force = rtapi::limited(force, -most, most);
      }
      accelerate(force, coulomb, damping, inertia, h);
      motor_ += velocity_ * h;
    }
    if (stuck_) velocity_ = 0.0;
    last_wanted_ = wanted;
    force_ = force;
  }

  /// Friction brakes and never drives: it takes the rest of a velocity, no more.
  void accelerate(double force, double coulomb, double damping, double inertia, double h) noexcept {
    const double driven = velocity_ + h * force / inertia;
    const double held = driven / (1.0 + h * damping / inertia);
    const double brake = h * coulomb / inertia;
    velocity_ = std::fabs(held) <= brake ? 0.0 : held - std::copysign(brake, held);
  }

  void move(double dt) noexcept {
    if (!std::isfinite(pos_cmd_)) return;  // a motor goes nowhere on a command that is no number
    const double lag_s = lag_s_, max_step = max_velocity_ * dt;
    double step = pos_cmd_ + origin_ - motor_;
    const bool exact = !(lag_s > 0.0) && !(max_step > 0.0);
    if (exact) {
      // Not by the step: its rounding would show as a following error.
      motor_ = pos_cmd_ + origin_;
      return;
    }
    if (lag_s > 0.0) step *= -std::expm1(-dt / lag_s);  // exact for a command held over the period
    if (max_step > 0.0 && std::fabs(step) > max_step) step = std::copysign(max_step, step);
    motor_ += step;
  }

  void watch_index(double before) noexcept {
    const double pitch = std::fabs(index_pitch_);
    if (!index_enable_ || !(pitch > 0.0)) return;
    const double pulse_before = std::floor(before / pitch), pulse = std::floor(motor_ / pitch);
    if (pulse == pulse_before) return;
    origin_ = pitch * (motor_ > before ? pulse : pulse + 1.0);
    index_enable_ = false;
  }

  void update_switches(double dt) noexcept {
    const double width = home_width_;
    const double off_centre = motor_ - home_pos_;
    double outside = home_positive_ ? -off_centre : off_centre;  // above zero: not on the switch
    if (width > 0.0) outside = std::fabs(off_centre) - 0.5 * width;
    if (outside <= 0.0) home_tripped_ = true;
    if (outside > home_hysteresis_) home_tripped_ = false;
    const double bounce_s = bounce_s_;
    home_sw_ = home_contact_.step(home_tripped_, dt, bounce_s);
    neg_lim_sw_ = neg_contact_.step(motor_ <= neg_lim_pos_, dt, bounce_s);
    pos_lim_sw_ = pos_contact_.step(motor_ >= pos_lim_pos_, dt, bounce_s);
  }
  hal::Function update_{function<&SimAxis::update>("", "Moves the motor by one period")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimAxis)
