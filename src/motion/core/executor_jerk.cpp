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
/// What is left of a stretch and takes less (s) is driven as it comes: a place that is met with acceleration 0 is as near as rounding then, and legs
/// towards it would be many and take no time.
constexpr double kNoTime = 1e-7;
/// A leg goes on that long before what lies ahead is looked at again; changes of override and holds end it at once.
constexpr double kKeep = 0.008;
/// A cap that has risen by less is not worth a look.
constexpr double kWorth = 1.05;

/// What is left of the ramp after t.
void shorten(Ramp& ramp, double t) noexcept {
  for (double& seconds : ramp.seconds) {
    const double used = std::min(t, seconds);
    seconds -= used;
    t -= used;
  }
}

}  // namespace

LawPlace Executor::law_place() const noexcept {
  LawPlace out;
  laws_.place(out);
  out.stands = law_stands_;
  out.moving = sigma_speed_ > 0 && !laws_.on();
  const PathSpan* m = move();
  if (m != nullptr && m->by_law && at_rest() && !track_.on) {
    out.rest_span = m->number;
    out.rest_left = left_;
  }
  return out;
}

/// From rest to rest it is either a law or looking ahead here.
bool Executor::law_drives(const PathSpan& move, double x_wanted) noexcept {
  law_stands_ = x_wanted <= 0;
  if (laws_.on()) return true;
  if (sigma_speed_ != 0 || sigma_acc_ != 0) return false;
  return !(x_wanted > 0) || laws_.start(move.number, left_) != LawRunner::Way::boxes;
}

double Executor::run_law(const PathSpan& move, double x_wanted, double dt) noexcept {
  if (!laws_.on()) return dt;
  const LawRunner::Moved moved = laws_.run(move.number, x_wanted <= 0, dt);
  if (moved.lost) {
    law_lost_ = true;
    sigma_speed_ = sigma_acc_ = 0;
    return dt;
  }
  left_ = moved.span_ended ? 0.0 : moved.left;
  sigma_speed_ = moved.rests ? 0.0 : moved.state.speed;
  sigma_acc_ = moved.rests ? 0.0 : moved.state.acc;
  return moved.used;
}

bool Executor::keeps_leg(RampState state, double x_wanted, double cap) const noexcept {
  const Leg& leg = leg_;
  if (!leg.on || track_.on || !(leg.keep > kLeastPhase) || !(leg.seconds > kLeastPhase) ||
      !(leg.way > kSamePlace))
    return false;
  if (leg.state.speed != state.speed || leg.state.acc != state.acc) return false;
  if ((x_wanted <= 0) != leg.stands || !(leg.scale == scale_)) return false;
  // More has become possible than when it began.
  return leg.stands || leg.target < leg.cap || cap <= leg.cap * kWorth;
}

/// False: it stands for the rest of the cycle.
bool Executor::begin_leg(const PathSpan& move, RampState state, double x_wanted, double cap,
                         double dt) noexcept {
  const bool rests = state.speed == 0 && state.acc == 0;
  const double keep = std::max(dt, kKeep);
  const bool steps = step_.begun() && !move.speed.sync;
  const Course course = track_.on ? track_course(state, cap, keep)
                        : steps   ? step_course(move, state, cap, keep)
                                  : course_ahead(slots_, move.number, left_, state, cap,
                                               move.speed.sync ? FeedScale{} : scale_, keep);
  double target = course.target;
  if (rests && target <= 0 && left_ > kSamePlace) return false;
  leg_ = Leg{};
  leg_.on = true;
  leg_.stands = x_wanted <= 0;
  leg_.way = course.known;
  leg_.cap = cap;
  leg_.keep = keep;
  leg_.scale = scale_;
  if (state.acc == 0 && state.speed == target && target > 0) {
    if (course.cruise > kSamePlace) {
      leg_.target = target;
      leg_.seconds = leg_.ramp.seconds[0] = std::min(course.cruise / target, 1.0);
      leg_.last = true;
      return true;
    }
    target = course.brake_to;
  }
  leg_.target = target;
  leg_.ramp = ramp_to(state, target, course.limits);
  // One phase at a time: where it ends another bound may have become the one that counts. Only speeding up evenly again is one leg.
  const bool whole = state.acc == 0 && target > state.speed;
  int i = 0;
  for (; i < 3 && (whole || leg_.seconds < kLeastPhase); ++i) leg_.seconds += leg_.ramp.seconds[i];
  leg_.last = true;
  for (; i < 3; ++i) leg_.last = leg_.last && leg_.ramp.seconds[i] <= 0;
  return true;
}

/// A leg, or a part of it.
double Executor::run_ramps(const PathSpan& move, double x_wanted, double dt) noexcept {
  const RampState state{sigma_speed_, sigma_acc_};
  const double cap = std::sqrt(std::max(0.0, std::min(x_wanted, move.speed.cap)));
  const bool rests = state.speed == 0 && state.acc == 0;
  if (rests && cap <= 0) return dt;
  if (left_ < state.speed * kNoTime) {
    const double t = std::min(dt, left_ / state.speed);
    left_ = t < dt ? 0.0 : left_ - state.speed * t;
    sigma_speed_ = std::max(state.speed + state.acc * t, 0.0);
    leg_.on = false;
    return t;
  }
  if ((rests || !keeps_leg(state, x_wanted, cap)) && !begin_leg(move, state, x_wanted, cap, dt))
    return dt;
  Leg& leg = leg_;
  double t = std::min({dt, leg.seconds, leg.keep});
  RampState next = state;
  double way = leg.ramp.advance(next, t);
  bool ends = leg.last && t == leg.seconds;
  // A stop is met with acceleration 0: a hair less of way would leave a good part of the last phase out.
  const bool lands = leg.target <= 0 && ends && way - left_ <= kSamePlace;
  if (way >= left_ && left_ > 0 && !lands) {
    t = time_at(leg.ramp, state, left_, t);
    next = state;
    (void)leg.ramp.advance(next, t);
    way = left_;
    ends = leg.last && t == leg.seconds;
  }
  if (ends) next = {leg.target, 0};
  left_ = way == left_ ? 0.0 : left_ - way;
  if (lands && left_ <= kSamePlace) left_ = 0;
  if (next.speed < 0) next = {0, 0};
  sigma_speed_ = next.speed;
  sigma_acc_ = next.acc;
  shorten(leg.ramp, t);
  leg.seconds -= t;
  leg.keep -= t;
  leg.way -= way;
  leg.state = next;
  // Nothing lasts no time: the loop over the cycle has to end.
  return std::max(t, rests && t == 0 ? dt : 0.0);
}

/// Single step: to the end of the block. Within the span it is one box all the way.
Course Executor::step_course(const PathSpan& move, RampState state, double cap,
                             double dt) const noexcept {
  if (cut_ > 0) {
    CourseFinder finder(state, cap, dt, {move.even_acc, move.even_jerk});
    finder.add({left_, 0, true}, 0);
    return finder.course();
  }
  const Course course = course_ahead(slots_, move.number, left_, state, cap, scale_, dt, true);
  // The planner was later with its stops than the step began.
  return course.feasible ? course
                         : course_ahead(slots_, move.number, left_, state, cap, scale_, dt);
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
