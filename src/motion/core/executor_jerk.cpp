// Stretches with jerk limits: ramps towards what lies ahead.
#include <algorithm>
#include <cmath>

#include "motion/core/ahead.hpp"
#include "motion/core/executor.hpp"

namespace kerf::motion {
namespace {

/// What is left to do would be rounding (sigma).
constexpr double kSamePlace = 1e-9;
/// Phases shorter than this belong to the next one (s).
constexpr double kLeastPhase = 1e-9;
constexpr int kHalvings = 60;

/// When `way` has been driven on the ramp; the speed is never negative on it.
double time_at(const Ramp& ramp, RampState from, double way, double most) noexcept {
  double low = 0, high = most;
  for (int i = 0; i < kHalvings && high - low > 1e-15; ++i) {
    const double middle = 0.5 * (low + high);
    RampState s = from;
    (ramp.advance(s, middle) < way ? low : high) = middle;
  }
  return high;
}

}  // namespace

/// One phase: a ramp, or a part of it, or cruising.
double Executor::run_ramps(const PathSpan& move, double x_wanted, double dt) noexcept {
  RampState state{sigma_speed_, sigma_acc_};
  const double cap = std::sqrt(std::max(0.0, std::min(x_wanted, move.speed.cap)));
  const bool rests = state.speed == 0 && state.acc == 0;
  if (rests && cap <= 0) return dt;
  const Course course = track_.on
                            ? track_course(state, cap, dt)
                            : course_ahead(slots_, move.number, left_, state, cap, scale_, dt);
  double target = course.target;
  if (rests && target <= 0 && left_ > kSamePlace) return dt;
  if (state.acc == 0 && state.speed == target && target > 0) {
    if (course.cruise > kSamePlace) {
      const double way = std::min(left_, course.cruise), need = way / target;
      if (need > dt) {
        left_ -= target * dt;
        return dt;
      }
      left_ = way == left_ ? 0.0 : left_ - way;
      return need;
    }
    target = course.brake_to;
  }
  const Ramp ramp = ramp_to(state, target, course.limits);
  const double whole = ramp.duration();
  // One phase at a time: where it ends another bound may have become the one that counts.
  double phase = 0;
  for (int i = 0; i < 3 && phase < kLeastPhase; ++i) phase += ramp.seconds[i];
  double t = std::min({dt, phase, whole});
  RampState next = state;
  double way = ramp.advance(next, t);
  // A stop is met with acceleration 0: a hair less of way would leave a good part of the last phase out.
  const bool lands = target <= 0 && t == whole && way - left_ <= kSamePlace;
  if (way >= left_ && left_ > 0 && !lands) {
    t = time_at(ramp, state, left_, t);
    next = state;
    (void)ramp.advance(next, t);
    way = left_;
  } else if (t == whole) {
    next = {target, 0};
  }
  left_ = way == left_ ? 0.0 : left_ - way;
  if (lands && left_ <= kSamePlace) left_ = 0;
  if (next.speed < 0) next = {0, 0};
  sigma_speed_ = next.speed;
  sigma_acc_ = next.acc;
  // Nothing lasts no time: the loop over the cycle has to end.
  return std::max(t, rests && t == 0 ? dt : 0.0);
}

/// On what lies behind: all of it is one group, with the least of its limits, and ends in stops. Back at the front the path goes on from rest.
Course Executor::track_course(RampState state, double cap, double dt) const noexcept {
  RampLimits limits{track_.move.even_acc, track_.move.even_jerk};
  const auto least = [&](const PathSpan& span) {
    limits.acc = std::min(limits.acc, span.even_acc);
    limits.jerk = std::min(limits.jerk, span.even_jerk);
  };
  for (std::size_t n = 1; n <= history_.size(); ++n) least(history_.last(n).span);
  if (const Span* front = spans_.front(); started_ && front != nullptr)
    if (const auto* move = std::get_if<PathSpan>(&front->body)) least(*move);
  CourseFinder finder(state, cap, dt, limits);
  double left = left_;
  std::size_t n = track_.behind;
  while (true) {
    // n: the stretch at whose end `left` counts; forwards its end is its own, backwards that of the older one.
    const bool last = track_.back ? n >= history_.size() : n <= 1;
    if (last) break;
    const std::size_t next = track_.back ? n + 1 : n - 1;
    const bool stands = history_.last(track_.back ? next : n).span.stop_at_end;
    if (stands) break;
    const PathSpan& span = history_.last(next).span;
    const double hard = std::sqrt(span.speed.cap);
    const double wanted =
        std::sqrt(std::max(0.0, wanted_x(span.speed, track_.back ? back_scale_ : scale_)));
    if (!finder.add({left, std::min(hard, wanted), false}, hard)) return finder.course();
    left += span.length;
    n = next;
  }
  finder.add({left, 0, true}, 0);
  return finder.course();
}

}  // namespace kerf::motion
