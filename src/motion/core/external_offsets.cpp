#include "motion/core/external_offsets.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {
namespace {

constexpr double kLeastAcc = 1e-6;  ///< movers divide by it
constexpr double kSame = 1e-9;      ///< rounding (mm, degrees)
constexpr double kAtLimit = 1e-6;
/// A path may brake with less than its axes can: curvature needs a part of it.
constexpr double kBrakeShare = 0.5, kBrakeShareWithJerk = 0.25;
constexpr double kCyclesAhead = 3;  ///< until a stop begins to work

double stop_way(double speed, double acc, double jerk) noexcept {
  if (speed <= 0) return 0;
  acc = std::max(acc, kLeastAcc);
  return jerk > 0 ? stopping_distance(speed, RampLimits{acc, jerk}) : speed * speed / (2 * acc);
}

}  // namespace

void ExternalOffsets::configure(const AxisConfig* limits, std::uint32_t axes) noexcept {
  possible_ = false;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    Axis& a = axis_[i];
    const AxisConfig& c = limits[i];
    const double share = (axes >> i & 1U) != 0 ? c.offset_av_ratio : 0.0;
    a.limit = {share * c.max_vel, std::max(share * c.max_acc, kLeastAcc), share * c.max_jerk};
    a.path_acc = (1 - share) * c.max_acc;
    a.path_jerk = (1 - share) * c.max_jerk;
    a.low = c.min_limit;
    a.high = c.max_limit;
    a.mover.set_limits(a.limit.acc, a.limit.jerk);
    possible_ = possible_ || a.limit.vel > 0;
  }
  pace_ = OffsetPace{};
  if (possible_) return;
  // Counts that nobody looks at are no news later.
  for (Axis& a : axis_) a.known = a.enabled = false;
}

void ExternalOffsets::reset() noexcept {
  for (Axis& a : axis_) {
    a.mover.place(0);
    a.request = 0;
    a.known = false;
  }
  pose_ = Pose{};
  held_ = 0;
  stopping_ = limited_ = false;
}

void ExternalOffsets::stop_dead() noexcept {
  for (Axis& a : axis_) a.mover.stop_dead();
  limited_ = false;
}

bool ExternalOffsets::at_rest() const noexcept {
  return std::none_of(std::begin(axis_), std::end(axis_),
                      [](const Axis& a) { return a.mover.active(); });
}

bool ExternalOffsets::active() const noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (std::abs(pose_[i]) > kSame) return true;
  return false;
}

void ExternalOffsets::take(const OffsetInputs* in, bool honoured) noexcept {
  if (!possible_) return;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    Axis& a = axis_[i];
    // Unsigned, so that a counter may run over.
    const auto turned = static_cast<std::int32_t>(static_cast<std::uint32_t>(in[i].counts) -
                                                  static_cast<std::uint32_t>(a.counts));
    const bool moved = a.known && turned != 0;
    a.counts = in[i].counts;
    a.known = true;
    a.enabled = honoured && in[i].enable && a.limit.vel > 0;
    if (!honoured || !(a.limit.vel > 0)) continue;
    const double way = turned * in[i].per_count;
    if (moved && a.enabled && std::isfinite(a.request + way)) a.request += way;
    if (in[i].clear) a.request = 0;
    // Cleared, it goes back to 0 also while it is not enabled.
    if (in[i].clear || a.request == 0) a.enabled = true;
  }
}

/// The sum would pass the limit on its way to rest.
bool ExternalOffsets::outward(const Axis& a, double path, double speed, double brake_acc,
                              double brake_jerk, double dt) const noexcept {
  const double offset = a.mover.position(), own = a.mover.speed();
  const double way =
      stop_way(std::abs(speed), brake_acc, brake_jerk) + kCyclesAhead * dt * std::abs(speed);
  const double up = stop_way(std::max(own, 0.0), a.mover.acc(), a.mover.jerk());
  const double down = stop_way(std::max(-own, 0.0), a.mover.acc(), a.mover.jerk());
  return speed > 0 ? path + way + offset + up > a.high && path <= a.high
                   : path - way + offset - down < a.low && path >= a.low;
}

std::uint32_t ExternalOffsets::blocked(const Pose& path, const Pose& before, double dt) noexcept {
  if (!possible_) return held_ = 0;
  bool any = false;
  for (const Axis& a : axis_)
    any = any || (a.limit.vel > 0 && (a.request != 0 || a.mover.position() != 0));
  // The path brakes as hard as the slowest of its axes can.
  double slowest = 1e99, slowest_jerk = 0;
  for (std::size_t i = 0; any && i < rtapi::kAxes; ++i) {
    const Axis& a = axis_[i];
    const double speed = std::abs(path[i] - before[i]) / dt;
    if (speed <= kSame || !(a.path_acc > 0)) continue;
    slowest = std::min(slowest, a.path_acc / speed);
    if (a.path_jerk > 0)
      slowest_jerk =
          slowest_jerk > 0 ? std::min(slowest_jerk, a.path_jerk / speed) : a.path_jerk / speed;
  }
  std::uint32_t now = 0;
  for (std::size_t i = 0; any && i < rtapi::kAxes; ++i) {
    const Axis& a = axis_[i];
    if (!(a.limit.vel > 0) || (a.request == 0 && a.mover.position() == 0)) continue;
    const double speed = (path[i] - before[i]) / dt;
    if (std::abs(speed) <= kSame) continue;
    const double share = slowest_jerk > 0 ? kBrakeShareWithJerk : kBrakeShare;
    if (outward(a, path[i], speed, share * slowest * std::abs(speed),
                share * slowest_jerk * std::abs(speed), dt))
      now |= 1U << i;
  }
  // What stands for want of room goes on when the offset has given way.
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if ((held_ >> i & 1U) != 0 && axis_[i].mover.active()) now |= 1U << i;
  return held_ = now;
}

std::array<OffsetPace::Limits, rtapi::kAxes> ExternalOffsets::in_use() const noexcept {
  std::array<OffsetPace::Limits, rtapi::kAxes> out{};
  // One that is held at a limit may be let go by the path at any time.
  const bool moves = std::any_of(std::begin(axis_), std::end(axis_), [](const Axis& a) {
    return a.mover.active() || a.request != a.mover.position();
  });
  for (std::size_t i = 0; moves && i < rtapi::kAxes; ++i)
    if (axis_[i].enabled || axis_[i].mover.active()) out[i] = axis_[i].limit;
  return out;
}

void ExternalOffsets::set_pace(const OffsetPace& pace) noexcept {
  pace_ = pace;
  for (Axis& a : axis_) {
    if (!(a.limit.vel > 0)) continue;
    a.mover.set_limits(std::max(pace.acc * a.limit.acc, kLeastAcc), pace.jerk * a.limit.jerk);
    if (a.mover.active() && !a.mover.stopping())
      a.mover.go_to(a.mover.target(), pace.vel * a.limit.vel);
  }
}

void ExternalOffsets::step(const Pose& path, const Pose& ahead, double dt) noexcept {
  limited_ = held_ != 0;
  for (std::size_t i = 0; possible_ && i < rtapi::kAxes; ++i) {
    Axis& a = axis_[i];
    if (!(a.limit.vel > 0)) continue;
    // Beside a path that is outside its limits itself only the way back is open.
    const double low = std::min(a.low - std::min(path[i], ahead[i]), 0.0);
    const double high = std::max(a.high - std::max(path[i], ahead[i]), 0.0);
    const double target = std::clamp(a.request, low, high);
    const double at = a.mover.position();
    const bool gives_way = std::clamp(at, low, high) != at;
    if (stopping_ || !(a.enabled || gives_way)) {
      a.mover.stop();
    } else if (a.mover.active() ? a.mover.target() != target : at != target) {
      a.mover.go_to(a.enabled ? target : std::clamp(at, low, high), pace_.vel * a.limit.vel);
    }
    a.mover.step(dt);
    // The path could not stand in time (it follows a spindle): the limit holds whatever it costs.
    const double least = std::min(a.low - path[i], 0.0), most = std::max(a.high - path[i], 0.0);
    const double kept = std::clamp(a.mover.position(), least, most);
    if (kept != a.mover.position()) a.mover.place(kept);
    pose_[i] = kept;
    const bool short_of = std::abs(target - a.request) > kAtLimit;
    limited_ = limited_ || (short_of && std::abs(kept - target) <= kAtLimit);
  }
}

}  // namespace kerf::motion
