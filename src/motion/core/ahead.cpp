#include "motion/core/ahead.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/path/limits.hpp"

namespace kerf::motion {
namespace {

/// Groups that are looked at together at most.
constexpr int kGroups = 3;
/// Spans looked at; the path counts as ending in a stop behind them.
constexpr std::uint64_t kLook = 768;
/// What rounding may take from a bound (mm, degrees; mm/s).
constexpr double kRounding = 1e-9;
/// A group's speed at its end is kept this much below what is possible, so that rounding never closes the way.
constexpr double kReserve = 1.0 - 1e-7;

using Slot = PlanSlots::Ahead;

const Slot& slot_of(const PlanSlots& slots, std::uint64_t n) noexcept {
  return slots.ahead[n % kSpans];
}

RampLimits limits_of(const Slot& s) noexcept { return {s.acc.get(), s.jerk.get()}; }

/// The longest way to brake from `speed` to any lower one. To stop is not the longest: it ends slower.
double longest_brake(double speed, const RampLimits& l) noexcept {
  return stopping_distance(speed, l) + l.acc * l.acc * l.acc / (8 * l.jerk * l.jerk);
}

bool same_group(const Slot& a, const Slot& b) noexcept {
  return a.acc.get() == b.acc.get() && a.jerk.get() == b.jerk.get();
}

/// The x that is wanted on a stretch, at most `cap`: wanted_x for many stretches at one scale.
class Wanted {
 public:
  explicit Wanted(const FeedScale* scale) noexcept : scale_(scale) {
    if (scale == nullptr) return;
    feed_ = scale->feed;
    max_vel_ = std::max(scale->max_vel, 0.0);
  }
  [[nodiscard]] double on(const Slot& s, double cap) const noexcept {
    if (scale_ == nullptr) return cap;
    if (s.rapid.get() != 0 || s.per_rev.get() >= 0 || !(feed_ > 0)) return other(s, cap);
    const double x = std::min(cap, s.feed_cap.get() * feed_ * feed_), slope = s.slope.get();
    // v / slope < sqrt(x), without a division for each stretch.
    if (!(slope > 0) || max_vel_ * max_vel_ >= x * slope * slope) return x;
    const double v = max_vel_ / slope;
    return v * v;
  }

 private:
  [[nodiscard]] double other(const Slot& s, double cap) const noexcept {
    SpeedBounds speed;
    speed.cap = cap;
    speed.feed_cap = s.feed_cap.get();
    speed.slope = s.slope.get();
    speed.rps = s.rps.get();
    speed.rapid = s.rapid.get() != 0;
    speed.per_rev = static_cast<std::int8_t>(s.per_rev.get());
    return std::min(cap, std::max(0.0, wanted_x(speed, *scale_)));
  }

  const FeedScale* scale_;
  double feed_{0}, max_vel_{0};
};

[[nodiscard]] double highest_wanted_start(const PlanSlots& slots, std::uint64_t n,
                                          const FeedScale& scale, double v) noexcept;

/// Calls f(bound, hard speed) for what holds at the end of each span from `n` on, `left` ahead: caps of what follows, and acceleration 0 at
/// the end of the group number `groups` or where the path stands. Of the feeds behind that (`scale`; nullptr: none count) the first one,
/// or with `next_feeds` all of the next group. Ends when f gives false.
template <class F>
void for_each_bound(const PlanSlots& slots, std::uint64_t n, double left, int groups,
                    const FeedScale* scale, bool stops_where_wanted, double horizon,
                    bool next_feeds, F&& f) noexcept {
  const Wanted wants(scale);
  int group = 1;
  double low_cap = path::kNoLimit, low_wanted = path::kNoLimit;  // of x
  for (std::uint64_t k = n; k < n + kLook; ++k) {
    const std::size_t at = k % kSpans;
    const double hard = slots.hard[at].observe(), soft = slots.soft[at].get();
    if (hard <= 0 || (stops_where_wanted && soft <= 0)) {
      (void)f(RampBound{left, 0, true}, 0.0);
      return;
    }
    if (scale != nullptr && soft <= 0) {
      // To stand here is wanted, not needed.
      if (!f(RampBound{left, 0, true}, std::sqrt(hard))) return;
    }
    const Slot& next = slot_of(slots, k + 1);
    const double cap = next.cap.get();
    const double wanted = wants.on(next, cap);
    if (!same_group(slot_of(slots, k), next) && ++group > groups) {
      // Feeds first: where both can't be, what is needed has the last word.
      if (scale != nullptr && left <= horizon) {
        double v = std::sqrt(wanted);
        if (next_feeds) v = highest_wanted_start(slots, k + 1, *scale, v);
        if (!f(RampBound{left, v, false}, std::sqrt(cap))) return;
      }
      const double level = std::sqrt(stops_where_wanted ? std::min(hard, soft) : hard);
      (void)f(RampBound{left, level, true}, level);
      return;
    }
    // What is no lower than what stands before it bears on nothing.
    if (cap < low_cap || wanted < low_wanted || left > horizon) {
      low_cap = std::min(low_cap, cap);
      low_wanted = std::min(low_wanted, wanted);
      const double hard_speed = std::sqrt(cap);
      if (!f(RampBound{left, wanted < cap ? std::sqrt(wanted) : hard_speed, false}, hard_speed))
        return;
    }
    left += next.length.get();
  }
  (void)f(RampBound{left, 0, true}, 0.0);
}

/// The highest speed up to `v` with acceleration 0 at the start of span `n` from which the feeds of its group can be kept.
double highest_wanted_start(const PlanSlots& slots, std::uint64_t n, const FeedScale& scale,
                            double v) noexcept {
  const Slot& first = slot_of(slots, n);
  const RampLimits limits = limits_of(first);
  for_each_bound(slots, n, first.length.get(), 1, &scale, false, longest_brake(v, limits), false,
                 [&](const RampBound& bound, double) {
                   if (bound.left > longest_brake(v, limits)) return false;
                   v = highest_start(v, bound, limits);
                   return true;
                 });
  return v;
}

/// The least limits of the first `groups` groups. False: there are fewer. `first_end`: way to the end of the first one whose acceleration
/// limit is below `acc`.
bool least_limits(const PlanSlots& slots, std::uint64_t n, double left, int groups, double acc,
                  bool stops_where_wanted, double horizon, RampLimits& out,
                  double& first_end) noexcept {
  out = limits_of(slot_of(slots, n));
  first_end = path::kNoLimit;
  int group = 1;
  for (std::uint64_t k = n; k < n + kLook && group < groups; ++k) {
    const bool stands = slots.hard[k % kSpans].observe() <= 0 ||
                        (stops_where_wanted && slots.soft[k % kSpans].get() <= 0);
    if (stands || left > horizon) return false;
    const Slot& next = slot_of(slots, k + 1);
    if (!same_group(slot_of(slots, k), next)) {
      ++group;
      const RampLimits l = limits_of(next);
      if (l.acc < acc && first_end >= path::kNoLimit) first_end = left;
      out.acc = std::min(out.acc, l.acc);
      out.jerk = std::min(out.jerk, l.jerk);
    }
    left += next.length.get();
  }
  return group == groups;
}

Course course_for(const PlanSlots& slots, std::uint64_t n, double left, RampState state, double cap,
                  const FeedScale& scale, double dt, int groups, const RampLimits& limits,
                  bool stops_where_wanted) noexcept {
  CourseFinder finder(state, cap, dt, limits);
  for_each_bound(slots, n, left, groups, &scale, stops_where_wanted, finder.horizon(), true,
                 [&](const RampBound& bound, double hard) { return finder.add(bound, hard); });
  return finder.course();
}

}  // namespace

CourseFinder::CourseFinder(RampState state, double cap, double dt,
                           const RampLimits& limits) noexcept
    : state_(state), none_(path::kNoLimit), lowest_(none_), lowest_hard_(none_) {
  course_.limits = limits;
  course_.target = cap;
  course_.cruise = none_;
  const double released = released_ = speed_when_released(state, limits.jerk);
  // These limits would let it run backwards.
  if (released < -kRounding) course_.feasible = false;
  fastest_ = std::max({cap, released, state.speed});
  horizon_ = ramp_distance(state, fastest_, limits) + longest_brake(fastest_, limits) +
             fastest_ * dt + kRounding;
}

bool CourseFinder::add(const RampBound& bound, double hard) noexcept {
  // Nothing behind can bear on what is done now.
  if (bound.left > horizon_) return false;
  if (bound.level) course_.known = std::min(course_.known, bound.left);
  const RampLimits& limits = course_.limits;
  const bool needed = hard <= bound.speed;
  if (bound.level || bound.speed < std::min(fastest_, lowest_)) {
    lowest_ = std::min(lowest_, bound.speed);
    bool feasible = true;
    // Most bounds are far enough away for the ramp that is wanted and braking behind it.
    bool clear = false;
    if (!bound.level && released_ <= bound.speed && state_.speed <= bound.speed &&
        course_.target > bound.speed) {
      if (first_target_ != course_.target) {
        first_target_ = course_.target;
        first_ = ramp_distance(state_, course_.target, limits);
      }
      clear = first_ + level_distance(course_.target, bound.speed, limits) < bound.left;
    }
    const double target =
        clear ? course_.target : ramp_target(state_, course_.target, bound, limits, feasible);
    if (bound.level && needed) {
      // Braking lower may take longer than there is room before a place that has to be met with acceleration 0.
      if (target > course_.target && target > lowest_hard_) feasible = false;
      course_.target = target;
    } else {
      course_.target = std::min(course_.target, target);
    }
    if (needed) {
      course_.feasible = course_.feasible && feasible;
      lowest_hard_ = std::min(lowest_hard_, hard);
    }
    if (state_.acc == 0 && bound.speed < state_.speed) {
      const double spare = bound.left - level_distance(state_.speed, bound.speed, limits);
      if (spare < course_.cruise) {
        course_.cruise = spare;
        course_.brake_to = bound.speed;
      }
    }
  }
  // What is only wanted may be out of reach; what is needed never is.
  if (hard < std::min(fastest_, lowest_hard_)) {
    lowest_hard_ = hard;
    bool feasible = true;
    (void)ramp_target(state_, std::min(course_.target, hard), {bound.left, hard, false}, limits,
                      feasible);
    course_.feasible = course_.feasible && feasible;
  }
  return true;
}

Course course_ahead(const PlanSlots& slots, std::uint64_t number, double left, RampState state,
                    double cap, const FeedScale& scale, double dt,
                    bool stops_where_wanted) noexcept {
  const RampLimits own = limits_of(slot_of(slots, number));
  Course best = course_for(slots, number, left, state, cap, scale, dt, 1, own, stops_where_wanted);
  const double fastest = std::max(cap, speed_when_released(state, own.jerk));
  // The first way as long as it gives all that is wanted.
  if (best.feasible && best.target >= cap && cap >= state.speed) return best;
  if (best.feasible && best.target <= cap && cap <= state.speed) return best;
  // No end of the group in sight: less of its limits gives nothing more.
  if (best.feasible && best.known >= path::kNoLimit) return best;
  for (int groups = 2; groups <= kGroups; ++groups) {
    RampLimits limits;
    double first_end = 0;
    const double horizon = ramp_distance(state, fastest, own) + 4 * longest_brake(fastest, own);
    if (!least_limits(slots, number, left, groups, std::abs(state.acc), stops_where_wanted, horizon,
                      limits, first_end))
      break;
    if (first_end < path::kNoLimit) {
      // An acceleration that the next group does not bear has to be gone before it begins.
      const double t = (std::abs(state.acc) - limits.acc) / limits.jerk;
      const double way =
          t * (state.speed + t * (0.5 * state.acc - std::copysign(limits.jerk, state.acc) * t / 6));
      if (way > first_end - kRounding) continue;
    }
    const Course other =
        course_for(slots, number, left, state, cap, scale, dt, groups, limits, stops_where_wanted);
    if (!other.feasible) continue;
    if (!best.feasible ||
        (cap < state.speed ? other.target < best.target : other.target > best.target))
      best = other;
  }
  return best;
}

double highest_level_speed(const PlanSlots& slots, std::uint64_t number, bool wanted) noexcept {
  double best = 0;
  const double cap = std::sqrt(slot_of(slots, number).cap.get());
  for (int groups = 1; groups <= kGroups; ++groups) {
    RampLimits limits;
    double first_end = 0;
    const double length = slot_of(slots, number).length.get();
    if (!least_limits(slots, number, length, groups, 0, wanted, path::kNoLimit, limits, first_end))
      break;
    double v = cap;
    for_each_bound(slots, number, length, groups, nullptr, wanted, path::kNoLimit, false,
                   [&](const RampBound& bound, double) {
                     if (bound.left > longest_brake(v, limits)) return false;
                     v = highest_start(v, bound, limits);
                     return v > best;
                   });
    best = std::max(best, v);
    if (best >= cap) break;
  }
  return best * kReserve;
}

}  // namespace kerf::motion
