// Moves that follow a spindle: how the executor drives them. The arithmetic is in synchronised.hpp.
#include <cmath>

#include "motion/core/executor.hpp"

namespace kerf::motion {
namespace {
/// What the path asks for is done for so long before the spindle is asked again (s).
constexpr double kYields = 0.008;
/// A speed that is none (sigma/s), and an acceleration, as a share of what a cycle of jerk changes.
constexpr double kStands = 1e-9, kStill = 1e-3;
}  // namespace

/// Manual, motion(9): holds wait for the end of a synchronised move; before one they count.
bool Executor::held_before_sync(const PathInputs& in) noexcept {
  if (in.feed_inhibit) {
    blocked(PathWait::feed_inhibit);
    return true;
  }
  if (in.feed_hold && enables_.feed_hold) {
    blocked(PathWait::feed_hold_pin);
    return true;
  }
  return false;
}

Executor::Outcome Executor::wait_for_spindle(const Span& span, const Synchroniser::Wish& wish,
                                             FaultList& faults) noexcept {
  PathWait why = PathWait::none;
  switch (sync_.prepare(wish, why, span.tag, faults)) {
    case Synchroniser::Ready::yes: return Outcome::busy;
    case Synchroniser::Ready::waits: blocked(why, wish.spindle); return Outcome::blocked;
    case Synchroniser::Ready::refused: break;
  }
  fail_path(span);
  return Outcome::done;
}

/// A rapid move begins: when it and rapids alone lead to a thread or tap, its index may come meanwhile.
void Executor::foresee_thread() noexcept {
  constexpr std::uint64_t kAhead =
      32;  // moves back to a thread are one to four, a few stretches each
  for (std::uint64_t i = 1; i <= kAhead; ++i) {
    const Span* span = spans_.peek(i);
    if (span == nullptr) return;
    if (const auto* tap = std::get_if<TapSpan>(&span->body)) return sync_.foresee(tap->spindle);
    const auto* move = std::get_if<PathSpan>(&span->body);
    if (move == nullptr && !std::holds_alternative<Marker>(span->body) &&
        !std::holds_alternative<PathControl>(span->body))
      return;
    if (move == nullptr) continue;
    if (move->sync.per_rev > 0) return sync_.foresee(move->sync.spindle);
    if (move->kind != MotionKind::traverse) return;
  }
}

/// busy: the stretch may begin now.
Executor::Outcome Executor::join_thread(const Span& span, const PathSpan& move,
                                        const PathInputs& in, FaultList& faults) noexcept {
  const SyncBounds& sync = move.sync;
  if (sync.first && thread_seq_ != span.seq) {
    sync_.end_thread();
    thread_seq_ = span.seq;
  }
  if (!sync_.following(sync.spindle) || sync.first) {
    if (held_before_sync(in)) return Outcome::blocked;
    thread_yields_s_ = 0;
    Synchroniser::Wish wish;
    wish.per_rev = sync.per_rev;
    wish.acc = sync.acc;
    wish.jerk = sync.jerk;
    wish.speed = sync.speed;
    wish.to_end = sync.to_end;
    wish.mm = sync.mm;
    wish.spindle = sync.spindle;
    const Outcome ready = wait_for_spindle(span, wish, faults);
    if (ready != Outcome::busy) return ready;
  }
  const bool begins = move.even_jerk > 0 ? thread_jerk(span, move, 0, period_, faults) > 0
                                         : sync_.thread_speed(sync, 0, span.tag, faults) > 0;
  if (begins) return Outcome::busy;
  blocked(sync_.moving() ? PathWait::spindle_turning : PathWait::spindle_index, sync.spindle);
  return Outcome::blocked;
}

double Executor::thread_jerk(const Span& span, const PathSpan& move, double done, double dt,
                             FaultList& faults) noexcept {
  const FollowLimits limits{move.even_acc, move.even_jerk, 0, std::sqrt(move.speed.cap)};
  return sync_.thread_jerk(move.sync, done, {sigma_speed_, sigma_acc_}, limits, period_ - dt, dt,
                           span.tag, faults);
}

/// With jerk limits: what the spindle asks for as long as the path ahead can be driven behind it; else what that asks for, for some cycles.
double Executor::run_thread(const Span& span, const PathSpan& move, const PathInputs& in, double dt,
                            FaultList& faults) noexcept {
  requested_ = move.requested;
  commanded_feed_ = 0;
  const bool stops = in.stop || ending_ || failing_;
  if (stops) sync_.lag_is_wanted();
  const double jerk = thread_jerk(span, move, move.length - left_, dt, faults);
  if (in.stop) blocked(PathWait::hold);
  if (stops) return run_ramps(move, 0, dt);
  const RampState from{sigma_speed_, sigma_acc_};
  if (at_rest() && !(jerk > 0)) {
    blocked(PathWait::spindle_turning, move.sync.spindle);
    return dt;
  }
  if (thread_yields_s_ > 0) {
    const double used = run_ramps(move, thread_level_, dt);
    thread_yields_s_ -= used;
    return used;
  }
  Ramp ramp;
  ramp.seconds[0] = dt;
  ramp.jerk[0] = jerk;
  RampState next = from;
  double t = dt, way = ramp.advance(next, t);
  if (way >= left_) {
    t = time_at(ramp, from, left_, dt);
    next = from;
    (void)ramp.advance(next, t);
    way = left_;
  }
  const double left = way == left_ ? 0.0 : left_ - way;
  // Holds and overrides wait for its end.
  const Course course =
      course_ahead(slots_, move.number, left, next, std::sqrt(move.speed.cap), FeedScale{}, dt);
  if (!course.feasible) {
    thread_yields_s_ = kYields;
    const double level = std::max(from.speed, next.speed);
    thread_level_ = level * level;
    return run_ramps(move, thread_level_, dt);
  }
  const bool stands =
      next.speed <= kStands && !(jerk > 0) && std::abs(next.acc) <= kStill * move.even_jerk * dt;
  if (stands || next.speed < 0) next = {};
  left_ = left;
  sigma_speed_ = next.speed;
  sigma_acc_ = next.acc;
  return t;
}

/// x that is wanted in this cycle.
double Executor::wanted_in_thread(const Span& span, const PathSpan& move, const PathInputs& in,
                                  FaultList& faults) noexcept {
  requested_ = move.requested;
  commanded_feed_ = 0;
  const bool stops = in.stop || ending_ || failing_;
  if (stops) sync_.lag_is_wanted();
  const double v = sync_.thread_speed(move.sync, move.length - left_, span.tag, faults);
  if (in.stop) blocked(PathWait::hold);
  if (stops) return 0;
  if (!(v > 0)) blocked(PathWait::spindle_turning, move.sync.spindle);
  return v * v;
}

Executor::Outcome Executor::begin_tap(const Span& span, const TapSpan& tap, const PathInputs& in,
                                      FaultList& faults) noexcept {
  if (!in.may_move) return Outcome::blocked;
  if (thread_seq_ != span.seq) {
    sync_.end_thread();
    thread_seq_ = span.seq;
  }
  if (!stands_at(tap.begin)) {
    raise(faults, Fault::path_starved_internal, -1, 0, 0, span.tag);
    fail_path(span);
    return Outcome::done;
  }
  if (held_before_sync(in)) return Outcome::blocked;
  Synchroniser::Wish wish;
  wish.per_rev = tap.per_rev;
  wish.acc = tap.acc;
  wish.jerk = tap.jerk;
  wish.speed = tap.speed;
  wish.to_end = tap.depth;
  wish.factor = tap.return_factor > 1 ? tap.return_factor : 1;
  wish.spindle = tap.spindle;
  wish.ends = false;
  const Outcome ready = wait_for_spindle(span, wish, faults);
  if (ready != Outcome::busy) return ready;
  current_ = span.tag;
  current_seq_ = span.seq;
  fire_synchronised();
  after_traverse_ = false;
  history_.clear();
  sync_.begin_tap();
  started_ = true;
  kind_ = MotionKind::feed;
  return Outcome::busy;
}

void Executor::run_tap(const Span& span, const TapSpan& tap, const PathInputs& in, double dt,
                       FaultList& faults) noexcept {
  // A tap that stands in a turning hole breaks: the spindle stops first, and the axis with it.
  if (in.stop) spindles_.stop(tap.spindle);
  const Synchroniser::Tap state = sync_.tap(tap, in.stop, dt, span.tag, faults);
  path::Vec at = path::to_vec(tap.begin);
  at.add(sync_.tap_place(), tap.direction);
  pose_ = to_pose(at);
  sigma_speed_ = speed_ = std::abs(sync_.tap_speed());
  distance_ = std::abs(tap.depth - sync_.tap_place());
  if (in.stop) blocked(PathWait::hold);
  if (state != Synchroniser::Tap::done) return;
  pose_ = tap.begin;
  sync_.end();
  finish(span, span.seq);
}

}  // namespace kerf::motion
