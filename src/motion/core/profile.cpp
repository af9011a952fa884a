#include "motion/core/profile.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {
namespace {
/// Seconds of braking: a speed above the brake envelope by less than this is rounding, and is taken as on it, so that the end is met exactly.
constexpr double kRounding = 1e-7;
}  // namespace

double advance(ProfileState& state, const ProfileLimits& limits, double t) noexcept {
  const double acc = limits.acc, gain = 2.0 * acc * state.left;
  const double wanted = std::min(limits.exit_speed, limits.speed);
  const double envelope = std::sqrt(wanted * wanted + gain);
  const bool out_of_reach = state.speed > envelope + kRounding * acc;
  const double v = out_of_reach ? state.speed : std::min(state.speed, envelope), x = v * v;
  const double end_x = out_of_reach ? x - gain : std::min(wanted * wanted, x + gain);
  const double end = std::sqrt(end_x);
  // From v to `peak`, along, and to `end`.
  const double fastest = limits.speed;
  const double peak =
      std::max(end, v > fastest ? fastest : std::min(fastest, std::sqrt(0.5 * (x + end_x + gain))));
  const double up = std::abs(peak * peak - x) / (2.0 * acc);
  const double down = (peak * peak - end_x) / (2.0 * acc);
  if (v > fastest && up >= state.left) {
    // Braking all the way.
    const double need = (v - end) / acc;
    if (t >= need) {
      state = {0, end};
      return need;
    }
    state = {std::max(0.0, state.left - t * (v - 0.5 * acc * t)), v - acc * t};
    return t;
  }
  const double t_up = std::abs(peak - v) / acc, t_down = (peak - end) / acc;
  if (peak <= 0) {  // stops before the end, or stands
    const double moving = std::min(t, t_up);
    state = {state.left - moving * (v - 0.5 * acc * moving),
             moving < t_up ? v - acc * moving : 0.0};
    return t;
  }
  const double along = std::max(0.0, state.left - up - down);
  const double total = t_up + along / peak + t_down;
  if (t >= total) {
    state = {0, end};
    return total;
  }
  if (t < t_up) {
    const double a = peak > v ? acc : -acc;
    state = {state.left - t * (v + 0.5 * a * t), v + a * t};
  } else if (total - t >= t_down) {
    state = {state.left - up - peak * (t - t_up), peak};
  } else {
    // Reckoned from the end, so that it is met exactly.
    const double rest = total - t;
    state = {rest * (end + 0.5 * acc * rest), end + acc * rest};
  }
  return t;
}

}  // namespace kerf::motion
