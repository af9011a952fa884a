#include "motion/core/ramp.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/false_position.hpp"

namespace kerf::motion {
namespace {

/// A bound missed by less than this is met: rounding of where we are (mm, degrees; and a share of the way). Less of it: a stop is met at even jerk, where
/// a way of 1e-13 mm is 3 microseconds that are left out, and that is a jerk too large.
constexpr double kRounding = 1e-15;
/// The same for whether it can be met at all: what was just met stays so.
constexpr double kStillMet = 1e-8;
constexpr double kShare = 1e-14;
constexpr int kHalvings = 52;
constexpr int kTimeSteps = 60;
/// A peak is sought this finely: it costs time only (mm/s).
constexpr double kSameSpeed = 1e-12;

/// A share of the square of an acceleration that is rounding.
constexpr double kSameSquare = 1e-12;
/// A ramp that leads to a bound is at it, whatever rounding says (mm/s).
constexpr double kSameLevel = 1e-9;

double slack(double left) noexcept { return kRounding + kShare * left; }

/// The largest speed in [low, high] for which `holds`; low does.
template <class F>
double largest(double low, double high, F&& holds) noexcept {
  for (int i = 0; i < kHalvings && high - low > kSameSpeed * high; ++i) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

/// Way until the speed has fallen to `speed` while acceleration goes back to 0 from below.
double way_to_cross(RampState s, double speed, double jerk) noexcept {
  const double root = std::sqrt(std::max(0.0, s.acc * s.acc - 2.0 * jerk * (s.speed - speed)));
  const double t = (-s.acc - root) / jerk;
  return t * (s.speed + t * (0.5 * s.acc + t * jerk / 6.0));
}

/// Way until the ramp to `target` has come down to `speed`, which is not below the target.
double way_to_reach(RampState s, double target, double speed, const RampLimits& limits) noexcept {
  const Ramp ramp = ramp_to(s, target, limits);
  double low = 0, high = ramp.duration();
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    RampState at = s;
    (void)ramp.advance(at, middle);
    (at.speed > speed ? low : high) = middle;
  }
  return ramp.advance(s, high);
}

}  // namespace

double Ramp::distance(RampState from) const noexcept {
  double way = 0;
  for (int i = 0; i < 3; ++i) way += motion::advance(from, jerk[i], seconds[i]);
  return way;
}

double Ramp::advance(RampState& state, double t) const noexcept {
  double way = 0;
  for (int i = 0; i < 3 && t > 0; ++i) {
    const double dt = std::min(t, seconds[i]);
    way += motion::advance(state, jerk[i], dt);
    t -= dt;
  }
  return way;
}

/// Newton, kept between bounds.
double time_at(const Ramp& ramp, RampState from, double way, double most) noexcept {
  double low = 0, high = most, t = from.speed > 0 ? std::min(way / from.speed, most) : most;
  for (int i = 0; i < kTimeSteps; ++i) {
    RampState s = from;
    const double off = ramp.advance(s, t) - way;
    (off < 0 ? low : high) = t;
    double next = s.speed > 0 ? t - off / s.speed : -1.0;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - t) <= 1e-15) break;
    t = next;
  }
  return t;
}

Ramp ramp_to(RampState from, double target, const RampLimits& limits) noexcept {
  const double j = limits.jerk;
  // Mirrored so that the speed grows beyond what releasing gives.
  const double sign = target >= speed_when_released(from, j) ? 1.0 : -1.0;
  const double gain = sign * (target - from.speed), a0 = sign * from.acc;
  Ramp out;
  if (a0 > limits.acc) {
    const double back = (a0 * a0 - limits.acc * limits.acc) / (2.0 * j);
    const double last = limits.acc * limits.acc / (2.0 * j);
    out.seconds[0] = (a0 - limits.acc) / j;
    out.jerk[0] = -sign * j;
    out.seconds[1] = std::max(0.0, (gain - back - last) / limits.acc);
    out.seconds[2] = limits.acc / j;
    out.jerk[2] = -sign * j;
    return out;
  }
  // On the last phase of a ramp this is the rounding of two equal numbers; its root would be a detour of many nanometres.
  double square = j * gain + 0.5 * a0 * a0;
  if (square < kSameSquare * a0 * a0) square = 0;
  const double peak = std::min(limits.acc, std::sqrt(square));
  out.seconds[0] = std::max(0.0, (peak - a0) / j);
  out.jerk[0] = sign * j;
  if (peak >= limits.acc) {
    const double first = (peak * peak - a0 * a0) / (2.0 * j), last = peak * peak / (2.0 * j);
    out.seconds[1] = std::max(0.0, (gain - first - last) / peak);
  }
  out.seconds[2] = std::max(peak, 0.0) / j;
  out.jerk[2] = -sign * j;
  return out;
}

double ramp_distance(RampState from, double target, const RampLimits& limits) noexcept {
  return ramp_to(from, target, limits).distance(from);
}

double level_distance(double from, double to, const RampLimits& limits) noexcept {
  const double gain = std::abs(to - from);
  const double seconds = gain * limits.jerk >= limits.acc * limits.acc
                             ? gain / limits.acc + limits.acc / limits.jerk
                             : 2.0 * std::sqrt(gain / limits.jerk);
  return 0.5 * (from + to) * seconds;
}

double stopping_distance(double speed, const RampLimits& limits) noexcept {
  return level_distance(speed, 0, limits);
}

double ramp_target(RampState from, double cap, const RampBound& bound, const RampLimits& limits,
                   bool& feasible) noexcept {
  feasible = true;
  const double allowed = bound.left + slack(bound.left), most = allowed + kStillMet;
  const double released = speed_when_released(from, limits.jerk);
  const auto way = [&](double target) {
    const double first = ramp_distance(from, target, limits);
    return target > bound.speed + kSameLevel ? first + level_distance(target, bound.speed, limits)
                                             : first;
  };
  if (released <= bound.speed + kSameLevel) {
    // It is below the bound already, or will be; what may be wrong is what is left of the acceleration.
    if (!bound.level) {
      if (from.speed > bound.speed && way_to_cross(from, bound.speed, limits.jerk) > most)
        feasible = false;
      if (cap <= bound.speed || ramp_distance(from, bound.speed, limits) >= allowed)
        return std::min(cap, bound.speed);
    } else if (const double goal = std::min(cap, bound.speed); way(goal) > allowed) {
      if (way(released) > most) {
        // Only a stop ends soon enough, if anything does.
        feasible = ramp_distance(from, 0, limits) <= most;
        return feasible ? 0.0 : std::max(released, 0.0);
      }
      if (goal >= released) return largest_within(released, goal, allowed, way);
      // To brake as wanted takes longer than there is room: as far as it goes.
      return -largest_within(-released, -goal, allowed, [&](double v) { return way(-v); });
    }
    if (cap <= bound.speed) return cap;
    if (way(cap) <= allowed) return cap;
    return largest_within(std::max(bound.speed, released), cap, allowed, way);
  }
  // Above it even when released. To stop may take less way than to slow down, since that ends faster; in between it takes more than
  // one of the two.
  const bool slows = ramp_distance(from, bound.speed, limits) <= most;
  const bool stops = !slows && ramp_distance(from, 0, limits) <= most;
  const double brake = stops ? 0.0 : bound.speed;
  feasible = slows || stops;
  if (cap <= bound.speed) {
    if (!bound.level)
      return slows || way_to_reach(from, cap, bound.speed, limits) <= allowed ? cap : brake;
    if (way(cap) <= allowed) return cap;
    if (!slows) return brake;
    return -largest_within(-bound.speed, -cap, allowed, [&](double v) { return way(-v); });
  }
  if (cap <= released) return way(cap) <= allowed ? cap : brake;
  if (way(cap) <= allowed) return cap;
  if (way(released) > allowed) return brake;
  return largest_within(released, cap, allowed, way);
}

double highest_start(double cap, const RampBound& bound, const RampLimits& limits) noexcept {
  const auto holds = [&](double v) {
    return v <= bound.speed || level_distance(v, bound.speed, limits) <= bound.left ||
           stopping_distance(v, limits) <= bound.left;
  };
  if (holds(cap)) return cap;
  return largest(std::min(bound.speed, cap), cap, holds);
}

double level_time(double length, double from, double to, double cap,
                  const RampLimits& limits) noexcept {
  from = std::min(from, cap);
  to = std::min(to, cap);
  const auto way = [&](double peak) {
    return level_distance(from, peak, limits) + level_distance(peak, to, limits);
  };
  const double least = std::max(from, to);
  if (way(least) > length) return 2 * length / std::max(from + to, 1e-9);
  const double peak =
      way(cap) <= length ? cap : largest(least, cap, [&](double v) { return way(v) <= length; });
  return ramp_to({from, 0}, peak, limits).duration() + ramp_to({peak, 0}, to, limits).duration() +
         (peak > 0 ? (length - way(peak)) / peak : 0.0);
}

}  // namespace kerf::motion
