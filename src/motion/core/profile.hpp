// Profile: motion along one length under an acceleration ceiling, in closed form. Pure arithmetic, @rt.
#pragma once

namespace kerf::motion {

/// Where we are on a piece of length: what is left of it (kept instead of what is done, so that the approach to the end
/// is exact) and the speed, never negative.
struct ProfileState {
  double left{0};
  double speed{0};
};

struct ProfileLimits {
  double speed{0};  ///< wanted speed, at least 0; may change at any time
  double acc{0};    ///< ceiling for speeding up and braking, above 0
  double exit_speed{
      0};  ///< speed wanted at the end of the length; one out of reach becomes the nearest that is
};

/// Moves on for `t` seconds, as fast as the limits allow, and ends at exit_speed: speeds up, cruises and
/// brakes in phases of constant acceleration, joined at exact times, not at cycle ends. So the speed is continuous and
/// piecewise linear, and differences over any sampling period stay within the limits (mean value theorem).
/// Gives the time used: `t`, or less when the end was reached within it; then left is 0.
[[nodiscard]] double advance(ProfileState& state, const ProfileLimits& limits, double t) noexcept;

/// Stops with the acceleration ceiling and nothing else; the distance it takes.
[[nodiscard]] constexpr double stopping_distance(double speed, double acc) noexcept {
  return speed * speed / (2.0 * acc);
}

}  // namespace kerf::motion
