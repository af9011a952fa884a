#include "motion/core/profile.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {

double advance(ProfileState& state, const ProfileLimits& limits, double t) noexcept {
  const double acc = limits.acc,
               exit_speed = std::min(limits.exit_speed, std::max(limits.speed, state.speed));
  double rest = t;
  // Speed up, cruise, brake: three phases; some more for rounding. The bound keeps the cycle O(1).
  for (int phase = 0; phase < 8 && rest > 0; ++phase) {
    double& left = state.left;
    double& v = state.speed;
    if (left <= 0) {
      left = 0;
      v = exit_speed;
      return t - rest;
    }
    const double envelope = std::sqrt(exit_speed * exit_speed + 2.0 * acc * left);
    if (v >= envelope * (1.0 - 1e-10)) {
      // On the brake envelope: stay on it, reckoned from the end, so that the end is met exactly.
      double to_end = (envelope - exit_speed) / acc;
      if (rest >= to_end) {
        left = 0;
        v = exit_speed;
        return t - (rest - to_end);
      }
      to_end -= rest;
      v = exit_speed + acc * to_end;
      left = 0.5 * to_end * (v + exit_speed);
      return t;
    }
    if (v > limits.speed) {
      const double need = (v - limits.speed) / acc, dt = std::min(need, rest);
      const double before = v;
      v = dt == need ? limits.speed : v - acc * dt;
      left -= 0.5 * (before + v) * dt;
      rest -= dt;
    } else if (v < limits.speed) {
      // Until the wanted speed or until the envelope is met, whichever comes first.
      const double peak =
          std::min(limits.speed, std::sqrt(0.5 * (v * v + exit_speed * exit_speed) + acc * left));
      const double need = std::max(peak - v, 0.0) / acc, dt = std::min(need, rest);
      const double before = v;
      v = dt == need ? std::max(peak, v) : v + acc * dt;
      left -= 0.5 * (before + v) * dt;
      rest -= dt;
    } else {
      if (v <= 0) return t;
      const double room = left - (v * v - exit_speed * exit_speed) / (2.0 * acc);
      const double dt = std::min(std::max(room, 0.0) / v, rest);
      left -= v * dt;
      rest -= dt;
      if (dt <= 0 && rest > 0) v = std::min(v, envelope) * (1.0 - 1e-15);
    }
  }
  return t;
}

}  // namespace kerf::motion
