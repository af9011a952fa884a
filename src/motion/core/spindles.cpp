#include "motion/core/spindles.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {

void Spindles::configure(const MachineConfig& config, std::int32_t count) noexcept {
  count_ = std::clamp(count, 0, static_cast<std::int32_t>(kMaxSpindles));
  for (std::size_t i = 0; i < kMaxSpindles; ++i) config_[i] = config.spindle[i];
}

void Spindles::apply(const SpindleChange& change) noexcept {
  if (change.spindle < 0 || change.spindle >= count_) return;
  State& s = state_[change.spindle];
  s.released = false;
  s.factor = 1;
  SpindleOutputs& out = out_[change.spindle];
  using Action = SpindleChange::Action;
  if (change.action == Action::orient) {
    s.direction = 0;
    s.wait = false;
    s.orient_state = kOrientRunning;
    s.orient_fault = 0;
    s.age = 0;
    s.ack_low = false;
    out.orient = true;
    out.locked = false;
    out.orient_angle_deg = change.orient_angle_deg;
    out.orient_mode = change.orient_mode;
    return;
  }
  // S as it was: nothing changes, so nothing is waited for that was not before.
  if (change.action == Action::set_speed && s.speed_rpm == change.speed_rpm &&
      s.css_factor == change.css_factor && s.css_max_rpm == change.css_max_rpm &&
      s.css_center_x_mm == change.css_center_x_mm)
    return;
  s.speed_rpm = change.speed_rpm;
  s.css_factor = change.css_factor;
  s.css_max_rpm = change.css_max_rpm;
  s.css_center_x_mm = change.css_center_x_mm;
  s.age = 0;
  if (change.action != Action::set_speed) {
    s.direction = change.action == Action::forward ? 1 : change.action == Action::reverse ? -1 : 0;
    s.orient_state = kOrientNone;
    out.orient = out.locked = false;
  }
  s.wait = change.wait_at_speed;
}

void Spindles::restart(std::int32_t n, std::int32_t direction) noexcept {
  if (n < 0 || n >= count_ || (direction != 1 && direction != -1)) return;
  State& s = state_[n];
  if (s.orient_state != kOrientNone) return;
  s.direction = direction;
  s.factor = 1;
  s.released = false;
  s.age = 0;
  s.wait = true;
}

void Spindles::stop(std::int32_t n) noexcept {
  if (n < 0 || n >= count_) return;
  state_[n].direction = 0;
  state_[n].factor = 1;
  state_[n].wait = false;
  state_[n].released = false;
  state_[n].orient_state = kOrientNone;
  out_[n].orient = out_[n].locked = false;
}

void Spindles::reverse(std::int32_t n, double factor) noexcept {
  if (n < 0 || n >= count_) return;
  state_[n].direction = -state_[n].direction;
  state_[n].factor = factor;
}

void Spindles::brake(std::int32_t n, bool engage) noexcept {
  if (n < 0 || n >= count_) return;
  if (engage) stop(n);
  state_[n].released = !engage;
}

void Spindles::stop_all() noexcept {
  for (std::int32_t n = 0; n < count_; ++n) stop(n);
}

void Spindles::abort_orient() noexcept {
  for (std::int32_t n = 0; n < count_; ++n) {
    if (state_[n].orient_state != kOrientRunning) continue;
    state_[n].orient_state = kOrientNone;
    out_[n].orient = false;
  }
}

double Spindles::limited(std::size_t n, double rpm) const noexcept {
  const SpindleConfig& c = config_[n];
  if (rpm > 0)
    return std::clamp(rpm, std::min(c.min_forward_rpm, c.max_forward_rpm), c.max_forward_rpm);
  if (rpm < 0) {
    const double most = std::abs(c.max_reverse_rpm),
                 least = std::min(std::abs(c.min_reverse_rpm), most);
    return -std::clamp(-rpm, least, most);
  }
  return 0;
}

void Spindles::step(const SpindleInputs* in, const double* overrides, double x_mm,
                    FaultList& faults) noexcept {
  for (std::size_t n = 0; n < static_cast<std::size_t>(count_); ++n) {
    State& s = state_[n];
    SpindleOutputs& out = out_[n];
    if (s.age < kSettleCycles) ++s.age;
    if (s.orient_state == kOrientRunning) {
      // The answer to an earlier order may still stand: it counts once it fell, or once the drive had time to take it back.
      const bool fresh = s.ack_low || s.age >= kSettleCycles;
      if (!in[n].is_oriented) s.ack_low = true;
      if (in[n].orient_fault != 0) {
        s.orient_state = kOrientFault;
        s.orient_fault = in[n].orient_fault;
        out.orient = false;
        raise(faults, Fault::orient_fault, static_cast<std::int32_t>(n), in[n].orient_fault);
      } else if (in[n].is_oriented && fresh) {
        s.orient_state = kOrientDone;
        out.orient = false;
        out.locked = true;
      }
    }
    double rpm = s.speed_rpm;
    if (s.css_factor > 0) {
      const double radius = std::abs(x_mm - s.css_center_x_mm);
      rpm = s.css_factor < s.css_max_rpm * radius ? s.css_factor / radius : s.css_max_rpm;
    }
    rpm *= s.direction * s.factor;
    out.command_rps = rpm / 60.0;
    out.speed_rpm = in[n].inhibit ? 0.0 : limited(n, rpm * overrides[n]);
    // A drive that is only told its direction must not turn at speed zero either.
    out.on = out.speed_rpm != 0;
    out.forward = out.speed_rpm > 0;
    out.reverse = out.speed_rpm < 0;
    out.brake = s.direction == 0 && s.orient_state != kOrientRunning && !s.released;
    if (s.wait && s.age >= kSettleCycles && in[n].at_speed) s.wait = false;
  }
}

void Spindles::wait_after_traverse() noexcept {
  for (std::int32_t n = 0; n < count_; ++n) {
    State& s = state_[n];
    if (s.css_factor <= 0 || s.direction == 0) continue;
    s.wait = true;
    s.age = 0;
  }
}

std::int32_t Spindles::not_at_speed() const noexcept {
  for (std::int32_t n = 0; n < count_; ++n) {
    if (state_[n].wait && state_[n].direction != 0 &&
        (state_[n].speed_rpm > 0 || state_[n].css_factor > 0))
      return n;
  }
  return -1;
}

std::int32_t Spindles::orienting() const noexcept {
  for (std::int32_t n = 0; n < count_; ++n) {
    if (state_[n].orient_state == kOrientRunning) return n;
  }
  return -1;
}

void Spindles::fill(std::size_t n, const SpindleInputs& in, SpindleStatus& status) const noexcept {
  const State& s = state_[n];
  status.speed_rpm = s.speed_rpm * s.direction;
  status.revs = in.revs;
  status.speed_in_rps = in.speed_in_rps;
  status.direction = s.direction;
  status.orient_state = s.orient_state;
  status.orient_fault = s.orient_fault;
  status.on = s.direction != 0 && (s.speed_rpm > 0 || s.css_factor > 0);
  status.at_speed = in.at_speed;
  status.brake = out_[n].brake;
  status.locked = out_[n].locked;
}

}  // namespace kerf::motion
