#include "motion/core/axis_mover.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/profile.hpp"

namespace kerf::motion {

void AxisMover::place(double position) noexcept {
  position_ = target_ = position;
  velocity_ = 0;
  active_ = stopping_ = false;
}

void AxisMover::start_at(double position, double velocity) noexcept {
  place(position);
  velocity_ = velocity;
}

void AxisMover::shift(double delta) noexcept {
  position_ += delta;
  target_ += delta;
}

void AxisMover::go_to(double target, double speed) noexcept {
  target_ = target;
  speed_limit_ = std::max(speed, 0.0);
  active_ = true;
  stopping_ = false;
}

void AxisMover::stop() noexcept {
  if (active_) stopping_ = true;
}

double AxisMover::brake(double t) noexcept {
  const double need = std::abs(velocity_) / acc_, dt = std::min(need, t);
  const double before = velocity_;
  velocity_ = dt == need ? 0.0 : velocity_ - std::copysign(acc_ * dt, velocity_);
  position_ += 0.5 * (before + velocity_) * dt;
  return dt;
}

void AxisMover::step(double dt) noexcept {
  if (!active_) return;
  double rest = dt;
  for (int phase = 0; phase < 6 && rest > 0; ++phase) {
    if (stopping_) {
      rest -= brake(rest);
      if (velocity_ == 0) place(position_);
      return;
    }
    const double way = target_ - position_;
    if (velocity_ == 0 && way == 0) {
      active_ = false;
      return;
    }
    const bool away = velocity_ * way < 0 || way == 0;
    // Room for rounding: on the envelope itself advance() brakes to the end.
    const bool past = stopping_distance(velocity_, acc_) > std::abs(way) * (1.0 + 1e-9);
    if (velocity_ != 0 && (away || past)) {
      rest -= brake(rest);
      continue;
    }
    const double sign = way > 0 ? 1.0 : -1.0;
    ProfileState state{std::abs(way), std::abs(velocity_)};
    rest -= advance(state, {speed_limit_, acc_, 0.0}, rest);
    position_ = target_ - sign * state.left;
    velocity_ = sign * state.speed;
    if (state.left > 0) return;
    place(target_);
    return;
  }
}

}  // namespace kerf::motion
