// AxisMover: one joint or axis alone, for jogs and homing. Trapezoid in closed form; pure arithmetic, @rt.
#pragma once

namespace kerf::motion {

class AxisMover {
 public:
  /// At rest at `position`.
  void place(double position) noexcept;
  /// Under way at `position`, with a speed from elsewhere; go_to() says where to.
  void start_at(double position, double velocity) noexcept;
  /// The coordinate of the present place changes by `delta`; the motion goes on.
  void shift(double delta) noexcept;
  /// Takes effect at once; `acc` above 0.
  void set_acc(double acc) noexcept { acc_ = acc; }
  /// Towards `target` with at most `speed`; may be called at any time, also to turn round.
  void go_to(double target, double speed) noexcept;
  /// Brakes and stays where it comes to rest.
  void stop() noexcept;
  /// Stands at once, whatever the acceleration limit says (motion.jog-stop-immediate).
  void stop_dead() noexcept { place(position_); }
  void step(double dt) noexcept;

  [[nodiscard]] double position() const noexcept { return position_; }
  [[nodiscard]] double speed() const noexcept { return velocity_; }  ///< signed
  [[nodiscard]] double target() const noexcept { return target_; }
  [[nodiscard]] double speed_limit() const noexcept { return speed_limit_; }
  [[nodiscard]] bool active() const noexcept { return active_; }

 private:
  /// Brakes to rest; gives the time used.
  double brake(double t) noexcept;

  double position_{0}, velocity_{0}, target_{0}, speed_limit_{0}, acc_{1};
  bool active_{false}, stopping_{false};
};

}  // namespace kerf::motion
