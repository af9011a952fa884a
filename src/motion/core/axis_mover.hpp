// AxisMover: one joint or axis alone, for jogs and homing. In closed form, limited in acceleration or in jerk too; pure arithmetic, @rt.
#pragma once

#include <algorithm>
#include <cmath>

#include "motion/core/ramp.hpp"

namespace kerf::motion {

class AxisMover {
 public:
  /// At rest at `position`.
  void place(double position) noexcept;
  /// Under way at `position`, with a speed from elsewhere; go_to() says where to.
  void start_at(double position, double velocity) noexcept;
  /// The coordinate of the present place changes by `delta`; the motion goes on.
  void shift(double delta) noexcept;
  /// Takes effect at once; `acc` above 0; `jerk` 0: not limited.
  void set_limits(double acc, double jerk) noexcept {
    acc_ = acc;
    jerk_ = jerk;
  }
  /// Towards `target` with at most `speed`; may be called at any time, also to turn round.
  void go_to(double target, double speed) noexcept;
  /// Drives at this part of the speed that go_to() allows; takes effect at once, and stays until place().
  void set_pace(double pace) noexcept { pace_ = pace; }
  /// Brakes and stays where it comes to rest.
  void stop() noexcept;
  /// Stands at once, whatever the limits say (motion.jog-stop-immediate).
  void stop_dead() noexcept { place(position_); }
  void step(double dt) noexcept;
  /// Where it comes to rest when it brakes now.
  [[nodiscard]] double rest_position() const noexcept;
  /// How long that takes (s).
  [[nodiscard]] double rest_time() const noexcept;

  [[nodiscard]] double position() const noexcept { return position_; }
  [[nodiscard]] double speed() const noexcept { return velocity_; }  ///< signed
  /// Without sign, when the acceleration is let go from now on.
  [[nodiscard]] double fastest() const noexcept {
    const double now = std::abs(velocity_);
    if (!(jerk_ > 0)) return now;
    return std::max(now, std::abs(speed_when_released({velocity_, acceleration_}, jerk_)));
  }
  [[nodiscard]] double target() const noexcept { return target_; }
  [[nodiscard]] double speed_limit() const noexcept { return speed_limit_; }
  [[nodiscard]] double acc() const noexcept { return acc_; }
  [[nodiscard]] double jerk() const noexcept { return jerk_; }
  [[nodiscard]] bool active() const noexcept { return active_; }
  [[nodiscard]] bool stopping() const noexcept { return stopping_; }

 private:
  /// Brakes to rest; gives the time used.
  double brake(double t) noexcept;
  void step_with_jerk(double dt) noexcept;

  double position_{0}, velocity_{0}, target_{0}, speed_limit_{0}, acc_{1}, jerk_{0};
  double acceleration_{0};  ///< with a jerk limit; signed
  double pace_{1};
  bool active_{false}, stopping_{false};
};

}  // namespace kerf::motion
