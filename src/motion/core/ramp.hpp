// Ramp: changes of speed under an acceleration and a jerk limit, in closed form. Pure arithmetic, @rt.
//
// A ramp leads from (speed, acceleration) to a target speed with acceleration 0 in the least time: at most three phases of constant
// jerk. Everything that is jerk-limited here is made of ramps and of cruising between them, evaluated at exact times, so acceleration is
// continuous and the third difference of positions stays within the limit at any sampling (a difference is an average of the derivative).
// Source: the closed forms behind online trajectory generators, Berscheid and Kroeger, Ruckig (arXiv 2105.04830).
#pragma once

namespace kerf::motion {

struct RampLimits {
  double acc{1}, jerk{1};  ///< both above 0
};

struct RampState {
  double speed{0}, acc{0};  ///< signed
};

/// Constant jerk for `t` seconds; gives the distance.
inline double advance(RampState& state, double jerk, double t) noexcept {
  const double way = t * (state.speed + t * (0.5 * state.acc + t * jerk * (1.0 / 6.0)));
  state.speed += t * (state.acc + 0.5 * t * jerk);
  state.acc += t * jerk;
  return way;
}

struct Ramp {
  double seconds[3]{};
  double jerk[3]{};

  [[nodiscard]] double duration() const noexcept { return seconds[0] + seconds[1] + seconds[2]; }
  /// Distance of the whole ramp.
  [[nodiscard]] double distance(RampState from) const noexcept;
  /// Moves on by t, at most the duration; gives the distance.
  double advance(RampState& state, double t) const noexcept;
};

/// The ramp to `target`. An acceleration above the limit is brought back first.
[[nodiscard]] Ramp ramp_to(RampState from, double target, const RampLimits& limits) noexcept;
[[nodiscard]] double ramp_distance(RampState from, double target,
                                   const RampLimits& limits) noexcept;

/// When `way` has been driven on the ramp, between 0 and `most`; the speed is never negative on it.
[[nodiscard]] double time_at(const Ramp& ramp, RampState from, double way, double most) noexcept;

/// The speed at which acceleration 0 is reached when nothing else is done.
[[nodiscard]] constexpr double speed_when_released(RampState s, double jerk) noexcept {
  return s.speed + (s.acc < 0 ? -s.acc : s.acc) * s.acc / (2.0 * jerk);
}
/// From cruising at `from` to cruising at `to`.
[[nodiscard]] double level_distance(double from, double to, const RampLimits& limits) noexcept;
/// From cruising at `speed` to rest.
[[nodiscard]] double stopping_distance(double speed, const RampLimits& limits) noexcept;

/// What holds at a place ahead.
struct RampBound {
  double left{0};    ///< how far it is
  double speed{0};   ///< at most this there, at least 0
  bool level{true};  ///< with acceleration 0 there; else only the speed counts
};
/// The target speed, at most `cap`, of the ramp to begin or to go on with now so that the bound is kept, as fast as possible: `cap`,
/// a peak from which the bound is just met, or the bound's own speed when braking is due. `feasible`: false when not even
/// braking keeps it.
[[nodiscard]] double ramp_target(RampState from, double cap, const RampBound& bound,
                                 const RampLimits& limits, bool& feasible) noexcept;
/// The highest speed, at most `cap`, with acceleration 0 from which the bound can be kept.
[[nodiscard]] double highest_start(double cap, const RampBound& bound,
                                   const RampLimits& limits) noexcept;

/// Seconds for `length` from cruising at `from` to cruising at `to`, at speeds of at most `cap`; where the length does not suffice for that,
/// an estimate.
[[nodiscard]] double level_time(double length, double from, double to, double cap,
                                const RampLimits& limits) noexcept;

}  // namespace kerf::motion
