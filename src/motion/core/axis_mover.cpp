#include "motion/core/axis_mover.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/profile.hpp"

namespace kerf::motion {
namespace {
/// A target passed or missed by less than this is met: rounding (mm, degrees).
constexpr double kSamePlace = 1e-9;
/// Phases in one cycle: up, along, down, and turning round.
constexpr int kPhases = 8;
}  // namespace

void AxisMover::place(double position) noexcept {
  position_ = target_ = position;
  velocity_ = acceleration_ = 0;
  pace_ = 1;
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

double AxisMover::rest_position() const noexcept {
  if (velocity_ == 0 && acceleration_ == 0) return position_;
  if (jerk_ > 0)
    return position_ + ramp_distance({velocity_, acceleration_}, 0, RampLimits{acc_, jerk_});
  return position_ + velocity_ * std::abs(velocity_) / (2 * acc_);
}

double AxisMover::rest_time() const noexcept {
  if (jerk_ > 0) return ramp_to({velocity_, acceleration_}, 0, RampLimits{acc_, jerk_}).duration();
  return std::abs(velocity_) / acc_;
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
  if (jerk_ > 0) return step_with_jerk(dt);
  acceleration_ = 0;
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
    rest -= advance(state, {pace_ * speed_limit_, acc_, 0.0}, rest);
    position_ = target_ - sign * state.left;
    velocity_ = sign * state.speed;
    if (state.left > 0) return;
    place(target_);
    return;
  }
}

/// Anew in every phase: what is left, seen in the direction of the target, and the ramp that the target asks for.
void AxisMover::step_with_jerk(double dt) noexcept {
  const RampLimits limits{acc_, jerk_};
  double rest = dt;
  for (int phase = 0; phase < kPhases && rest > 0; ++phase) {
    const RampState state{velocity_, acceleration_};
    if (stopping_) {
      const Ramp ramp = ramp_to(state, 0, limits);
      const double need = ramp.duration();
      RampState next = state;
      position_ += ramp.advance(next, rest);
      velocity_ = next.speed;
      acceleration_ = next.acc;
      if (need <= rest) place(position_);
      return;
    }
    const double way = target_ - position_;
    // What is left to do would be rounding.
    if (std::abs(way) <= kSamePlace &&
        std::abs(velocity_) * ramp_to(state, 0, limits).duration() <= kSamePlace) {
      place(target_);
      return;
    }
    const double sign = way >= 0 ? 1.0 : -1.0;
    RampState along{sign * velocity_, sign * acceleration_};
    const RampBound end{std::abs(way), 0, true};
    bool feasible = true;
    // Infeasible: it has to come back. It stands at once as soon as it can.
    const double goal = ramp_target(along, pace_ * speed_limit_, end, limits, feasible);
    const bool cruises = along.acc == 0 && along.speed == goal && goal > 0;
    double used = 0;
    if (cruises) {
      const double spare = end.left - stopping_distance(goal, limits);
      // Else it is on the brake curve already.
      if (spare > kSamePlace) {
        used = std::min(spare / goal, rest);
        position_ += sign * goal * used;
        rest -= used;
        continue;
      }
    }
    const Ramp ramp = ramp_to(along, cruises ? 0.0 : goal, limits);
    const double need = ramp.duration();
    used = std::min(need, rest);
    position_ += sign * ramp.advance(along, used);
    rest -= used;
    if (need <= used) along = {cruises ? 0.0 : goal, 0};
    velocity_ = sign * along.speed;
    acceleration_ = sign * along.acc;
  }
}

}  // namespace kerf::motion
