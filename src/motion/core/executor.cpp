#include "motion/core/executor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/core/path/reach.hpp"
#include "motion/core/profile.hpp"
#include "rtapi/base/fetch.hpp"

namespace kerf::motion {
namespace {

/// Spans begun in one cycle. More would be stretches far below what a cycle drives; the rest of the cycle is lost then, which is a jerk, not the path.
constexpr int kSpansPerCycle = 512;
/// Stretches behind the machine whose bounds backwards are made in one cycle: all of them in 64 cycles, while it brakes to turn back.
constexpr std::size_t kBoundsPerCycle = 8;
/// Stretches shorter than this (sigma) are passed at the speed they are entered with.
constexpr double kNoStretch = 1e-10;
/// An x below this is a standstill that rounding has missed (1e-7 mm/s).
constexpr double kNoSpeed = 1e-14;
/// A stretch lingers that takes longer than so many seconds, and is slow when its speeds at both ends together are below this share of what is wanted.
constexpr double kLingers = 0.05, kSlow = 0.5;
constexpr double kRestSpeed = 1e-6;  ///< sigma/s
constexpr int kStopRounds = 4;
constexpr double kStopReserve = 1.01;
/// Share of a cycle for which braking to a stand is decided at once. In a bend that takes all of the acceleration what is braked first counts most.
constexpr double kBrakeStep = 0.25;
/// A span that begins elsewhere than where the machine stands is a fault of ours (mm, degrees).
constexpr double kSamePlace = 1e-6;
/// Fault::orient_fault: no answer in time. Above zero it is the drive's own number, zero is a spindle stopped.
constexpr double kOrientTimedOut = -1;

bool before(std::uint32_t a, std::uint32_t b) noexcept {
  return static_cast<std::int32_t>(a - b) < 0;
}

double factor(double value, double most) noexcept {
  // NaN compares false: an override that is no number stands the machine still.
  return value > 0 ? std::min(value, most) : 0.0;
}

}  // namespace

void Executor::place(const Pose& pose) noexcept {
  pose_ = pose;
  sigma_speed_ = sigma_acc_ = speed_ = left_ = half_way_ = 0;
  distance_ = 0;
  laws_.leave();
  law_lost_ = false;
  started_ = probing_ = ending_ = failing_ = arriving_ = false;
  kind_ = MotionKind::none;
  forget_track();
  sync_.end();
  ++place_number_;
}

void Executor::fold(const Pose& shift) noexcept {
  tool_offset_ = tool_offset_ + shift;
  place(pose_ + shift);
}

const PathSpan* Executor::move() const noexcept {
  if (!started_) return nullptr;
  const Span* span = spans_.front();
  return span == nullptr ? nullptr : std::get_if<PathSpan>(&span->body);
}

bool Executor::follows_spindle() const noexcept {
  const Span* span = started_ ? spans_.front() : nullptr;
  if (span == nullptr) return false;
  const auto* move = std::get_if<PathSpan>(&span->body);
  return move != nullptr ? move->sync.per_rev > 0 : std::holds_alternative<TapSpan>(span->body);
}

void Executor::blocked(PathWait why, std::int32_t index) noexcept {
  waiting_ = why;
  waiting_index_ = index;
}

const Span* Executor::next() noexcept {
  while (const Span* span = spans_.front()) {
    if (!before(span->epoch, min_epoch_) && (void_epoch_ == 0 || before(void_epoch_, span->epoch)))
      return span;
    spans_.pop();
  }
  return nullptr;
}

void Executor::drop_before(std::uint32_t epoch) noexcept {
  min_epoch_ = epoch;
  const Span* span = spans_.front();
  if (span != nullptr && before(span->epoch, epoch)) {
    if (started_ || track_.on) place(pose_);
    forget_track();
  }
  if (!started_) probing_ = ending_ = false;  // between two stretches of a probe move
  sync_.end();
  lock_again();
  (void)next();
  sync_digital_mask_ = sync_analog_mask_ = 0;
  dwell_left_ = 0;
  waiting_ = PathWait::none;
  ++place_number_;
}

void Executor::void_epoch(std::uint32_t epoch) noexcept {
  if (void_epoch_ == 0 || before(void_epoch_, epoch)) void_epoch_ = epoch;
  place(pose_);
  lock_again();
  (void)next();
  sync_digital_mask_ = sync_analog_mask_ = 0;
  dwell_left_ = 0;
  waiting_ = PathWait::none;
}

void Executor::fail_path(const Span& span) noexcept { void_epoch(span.epoch); }

void Executor::finish(const Span& span, std::uint64_t done_seq) noexcept {
  (void)span;
  if (done_seq > executed_seq_) executed_seq_ = done_seq;
  started_ = false;
  half_way_ = left_ = 0;
  kind_ = MotionKind::none;
  if (sigma_speed_ == 0) {
    distance_ = 0;
    speed_ = 0;
  }
  spans_.pop();
}

void Executor::fetch() const noexcept {
  spans_.fetch(started_ ? 1 : 0);
  history_.fetch();
  if (const PathSpan* m = move())
    rtapi::fetch(&slots_.block[(m->first_block + m->blocks) % PlanSlots::kBlocks],
                 sizeof(BlockStart));
}

void Executor::step(const PathInputs& in, double dt, FaultList& faults) noexcept {
  waiting_ = PathWait::none;
  waiting_index_ = -1;
  law_stands_ = false;
  laws_.look(in.plan_passes);
  if (in.spindle != nullptr) sync_.observe(in.spindle, dt);
  set_scale(in);
  ready_way_back(kBoundsPerCycle);
  locking_ &= in.unlocked;
  begin_step(in);
  period_ = dt;
  double rest = dt;
  for (int n = 0; n < kSpansPerCycle && rest > 0; ++n) {
    if (!track_.on && may_turn_back(in)) turn_back();
    if (track_.on) {
      rest -= run_track(in, rest, faults);
      continue;
    }
    if (!started_) {
      if (ending_ && at_rest()) {
        if (!pass_over_probe()) break;
        continue;
      }
      // Held: nothing new begins at rest, but what is queued stays.
      if (in.stand && at_rest()) {
        if (!spans_.empty()) blocked(PathWait::hold);
        break;
      }
      const Span* span = next();
      if (span == nullptr) {
        // The planner's plan ends in a stop; nothing behind it is a fault of ours, and standing is all that is left.
        if (!at_rest()) raise(faults, Fault::path_starved_internal, -1, speed_, 0, current_);
        sigma_speed_ = sigma_acc_ = speed_ = 0;
        sync_.end();
        break;
      }
      if (step_brakes_ && at_rest()) break;
      if (!step_allows(*span, in.single_step)) {
        blocked(PathWait::hold);
        break;
      }
      const Outcome outcome = begin(*span, in, faults);
      if (outcome == Outcome::blocked) break;
      if (outcome == Outcome::done) continue;
    }
    const Span* span = spans_.front();
    if (span == nullptr) break;
    if (const auto* move = std::get_if<PathSpan>(&span->body)) {
      rest -= run_move(*span, *move, in, rest, faults);
      continue;
    }
    if (const auto* tap = std::get_if<TapSpan>(&span->body)) {
      run_tap(*span, *tap, in, rest, faults);
      break;
    }
    if (const auto* change = std::get_if<SpindleChange>(&span->body)) {
      if (!run_orient(*span, *change, in, rest, faults)) break;
      continue;
    }
    if (const auto* order = std::get_if<IndexerSpan>(&span->body)) {
      if (!run_indexer(*span, *order, in)) break;
      continue;
    }
    if (in.stand) break;
    const double used = std::min(rest, dwell_left_);
    dwell_left_ -= used;
    rest -= used;
    if (dwell_left_ <= 0)
      finish(*span, span->seq);
    else
      blocked(PathWait::dwell);
  }
  probe_before_ = in.probe;
}

Executor::Outcome Executor::begin(const Span& span, const PathInputs& in,
                                  FaultList& faults) noexcept {
  const auto instant = [&](auto&& act) {
    current_ = span.tag;
    current_seq_ = span.seq;
    act();
    finish(span, span.seq);
    return Outcome::done;
  };
  return std::visit(
      Overloaded{
          [&](const PathSpan& m) { return begin_move(span, m, in, faults); },
          [&](const TapSpan& m) {
            return waits_for_lock() ? Outcome::blocked : begin_tap(span, m, in, faults);
          },
          [&](const IndexerSpan& m) { return begin_indexer(span, m); },
          [&](const Dwell& m) {
            history_.clear();
            current_ = span.tag;
            current_seq_ = span.seq;
            dwell_left_ = m.seconds;
            started_ = true;
            return Outcome::busy;
          },
          // Braking for an abort may reach over the end of its move: what stands there does not happen any more.
          [&](const OutputChange& m) {
            return instant([&] {
              if (!in.stop) output(m);
            });
          },
          [&](const SpindleChange& m) {
            current_ = span.tag;
            current_seq_ = span.seq;
            if (m.action != SpindleChange::Action::set_speed) history_.clear();
            const bool late = in.stop && m.action != SpindleChange::Action::stop;
            const Outcome o = late ? Outcome::done : begin_spindle(m);
            if (o == Outcome::done) finish(span, span.seq);
            return o;
          },
          [&](const PathControl&) { return instant([] {}); },
          [&](const OverrideEnable& m) { return instant([&] { enables_ = m; }); },
          [&](const ToolOffset& m) { return instant([&] { tool_offset_ = m.offset; }); },
          [&](const Marker& m) {
            history_.clear();
            return instant([&] {
              if (m.drop_outputs) sync_digital_mask_ = sync_analog_mask_ = 0;
            });
          },
      },
      span.body);
}

Executor::Outcome Executor::begin_spindle(const SpindleChange& change) noexcept {
  spindles_.apply(change);
  if (change.action != SpindleChange::Action::orient) return Outcome::done;
  started_ = true;  // ends when the spindle says so
  orient_left_s_ = change.orient_timeout_s;
  return Outcome::busy;
}

/// False: it goes on.
bool Executor::run_orient(const Span& span, const SpindleChange& change, const PathInputs& in,
                          double dt, FaultList& faults) noexcept {
  const std::int32_t n = change.spindle;
  if (spindles_.orienting() >= 0) {
    blocked(PathWait::orient, spindles_.orienting());
    if (in.stand || !(change.orient_timeout_s > 0)) return false;
    orient_left_s_ -= dt;
    if (orient_left_s_ > 0) return false;
    raise(faults, Fault::orient_fault, n, kOrientTimedOut, change.orient_timeout_s, span.tag);
    spindles_.abort_orient();
    fail_path(span);
    return true;
  }
  if (spindles_.oriented(n)) {
    finish(span, span.seq);
    return true;
  }
  if (!spindles_.orient_failed(n)) {
    // Stopped from outside. With an abort, which drops the span, that is no news.
    if (in.stand) {
      blocked(PathWait::hold);
      return false;
    }
    raise(faults, Fault::orient_fault, n, 0, 0, span.tag);
  }
  fail_path(span);
  return true;
}

bool Executor::stands_at(const Pose& place) const noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (!(std::abs(place[i] - pose_[i]) <= kSamePlace)) return false;
  }
  return true;
}

Executor::Outcome Executor::begin_move(const Span& span, const PathSpan& move, const PathInputs& in,
                                       FaultList& faults) noexcept {
  const bool rests = at_rest();
  if (rests) {
    if (!in.may_move || waits_for_lock()) return Outcome::blocked;
    if (move.kind == MotionKind::index_rotary && !move.point &&
        (indexer_ < 0 || (in.unlocked >> static_cast<std::uint32_t>(indexer_) & 1U) == 0)) {
      blocked(PathWait::indexer_unlocked, indexer_);
      return Outcome::blocked;
    }
    // A point leads nowhere and the planner goes on from before it: it may stand beside the place, as a blend or a sliver of path have it.
    const bool leads = !move.point || move.probe;
    if (leads && !stands_at(move.point ? move.end : to_pose(move.piece.point(move.from)))) {
      raise(faults, Fault::path_starved_internal, -1, 0, 0, span.tag);
      fail_path(span);
      return Outcome::done;
    }
    if (move.kind != MotionKind::traverse && move.kind != MotionKind::tool_change &&
        move.kind != MotionKind::index_rotary && move.sync.per_rev <= 0) {
      if (after_traverse_) spindles_.wait_after_traverse();
      after_traverse_ = false;
      const std::int32_t waiting = spindles_.not_at_speed();
      if (waiting >= 0) {
        blocked(PathWait::spindle_at_speed, waiting);
        return Outcome::blocked;
      }
    }
    if (move.sync.per_rev > 0) {
      const Outcome joined = join_thread(span, move, in, faults);
      if (joined != Outcome::busy) return joined;
    } else {
      sync_.end_thread();
      // Stands; the outputs wait for the move itself.
      if (!move.point && wanted(move, in, scale_) <= 0) return Outcome::blocked;
    }
  }
  current_ = span.tag;
  current_seq_ = span.seq;
  if (!in.stop) fire_synchronised();
  if (move.probe) {
    const bool goes_on = probing_;
    probing_ = true;
    if (!goes_on) probe_tripped_ = false;
    if (!probe_tripped_)
      probed_ = move.end + in.shift;  // the programmed point, until something is met
    if (!goes_on && !move.point && in.probe != move.probe_until_open)
      return probe_is_there(span, move, in, faults);
  }
  if (move.point) {
    if (move.probe) {
      if (rests) pose_ = move.end;
      end_probe(span, move);
    } else
      finish(span, move.done_seq);
    return Outcome::done;
  }
  started_ = true;
  after_traverse_ = move.kind == MotionKind::traverse || move.kind == MotionKind::index_rotary;
  kind_ = move.kind;
  if (kind_ == MotionKind::traverse) foresee_thread();
  left_ = move.length;
  half_way_ = 0;
  begin_blocks(move);
  return Outcome::busy;
}

void Executor::set_scale(const PathInputs& in) noexcept {
  const double feed = enables_.feed ? factor(in.feed_override, max_override_) : 1.0;
  const double rapid = factor(in.rapid_override, 1.0);
  const auto set = [&](FeedScale& scale, double adaptive) {
    scale.feed = std::min(feed * adaptive, max_override_);
    scale.rapid = std::min(rapid * adaptive, 1.0);
    scale.max_vel = in.max_vel_mm_s;
    sync_.feed_speeds(scale.rps);
  };
  FeedScale &ahead = in.backwards ? back_scale_ : scale_,
            &back = in.backwards ? scale_ : back_scale_;
  set(ahead, enables_.adaptive ? factor(in.adaptive_feed, max_adaptive_) : 1.0);
  set(back, reverses() ? factor(-in.adaptive_feed, max_adaptive_) : 0.0);
}

double Executor::wanted(const PathSpan& move, const PathInputs& in,
                        const FeedScale& scale) noexcept {
  requested_ = move.requested;
  double x = wanted_x(move.speed, scale);
  if (!(x > 0) || (move.by_law && at_rest() && awaits_feed(move.speed, x))) {
    x = 0;
    const bool turns = move.speed.per_rev < 0 || scale_.rps[move.speed.per_rev] > 0;
    if (turns)
      blocked(PathWait::zero_override);
    else
      blocked(PathWait::spindle_turning, move.speed.per_rev);
  }
  if (in.feed_inhibit) {
    x = 0;
    blocked(PathWait::feed_inhibit);
  } else if (in.feed_hold && enables_.feed_hold) {
    x = 0;
    blocked(PathWait::feed_hold_pin);
  }
  commanded_feed_ = move.speed.rapid || x <= 0 ? 0.0 : move.requested * scale.feed;
  return x;
}

double Executor::wanted_under_way(const PathSpan& move, const PathInputs& in,
                                  const FeedScale& scale) noexcept {
  double x = wanted(move, in, scale);
  if (in.stand || step_brakes_ || ending_ || failing_) x = 0;
  if (in.stand) blocked(PathWait::hold);
  // It turned out slower than it should: the path waits for the spindle where that can still be done.
  if (x > 0 && !at_rest() && !move.speed.rapid) {
    const std::int32_t waiting = spindles_.not_at_speed();
    if (waiting >= 0) {
      x = 0;
      blocked(PathWait::spindle_at_speed, waiting);
    }
  }
  return x;
}

/// What the probe move goes for is so already: an error, or for G38.3 and G38.5 (as LinuxCNC does it) a result without a move.
Executor::Outcome Executor::probe_is_there(const Span& span, const PathSpan& move,
                                           const PathInputs& in, FaultList& faults) noexcept {
  if (move.probe_fail_is_error) {
    raise(faults, Fault::probe_already_tripped, -1, in.probe ? 1 : 0, 0, span.tag);
    fail_path(span);
    return Outcome::done;
  }
  probed_ = in.pose_fb;
  probe_tripped_ = ending_ = true;
  end_probe(span, move);
  return Outcome::done;
}

/// A probe move may be several stretches, where joints bend along it. It is over with the last of them.
void Executor::end_probe(const Span& span, const PathSpan& move) noexcept {
  const bool last = move.point || move.stop_at_end;
  finish(span, move.done_seq);
  if (!last) return;
  probing_ = ending_ = false;
  ++place_number_;
}

/// Of a stretch behind the contact nothing is driven. False: it is not there yet.
bool Executor::pass_over_probe() noexcept {
  const Span* span = next();
  if (span == nullptr) return false;
  const auto* move = std::get_if<PathSpan>(&span->body);
  if (move != nullptr && move->probe)
    end_probe(*span, *move);
  else
    probing_ = ending_ = false;
  return true;
}

void Executor::watch_probe(const Span& span, const PathSpan& move, const PathInputs& in,
                           FaultList& faults) noexcept {
  if (ending_ || failing_) return;
  if (move.probe) {
    if (in.probe == move.probe_until_open) return;
    if (in.unseen_joint >= 0) {
      // The contact may be as old as the feedback.
      raise(faults, Fault::stale_feedback, in.unseen_joint, 1, -1, span.tag);
      failing_ = true;
      return;
    }
    probed_ = in.pose_fb;
    probe_tripped_ = true;
    ending_ = true;
  } else if (in.probe && !probe_before_) {
    raise(faults, Fault::probe_unexpected, -1, 0, 0, span.tag);
    failing_ = true;
  }
}

Executor::Ends Executor::ends_of(const PathSpan& move) const noexcept {
  const std::size_t slot = move.number % kSpans;
  const double hard = slots_.hard[slot].observe();  // acquire, before `soft`
  return {hard, slots_.soft[slot].get()};
}

/// The bound of x is the same all along. The end is met at what is wanted there as far as braking can; that is never more than `hard`.
double Executor::run_even(const PathSpan& move, const Ends& ends, double x_wanted,
                          double dt) noexcept {
  const double end = std::min(ends.hard, ends.soft);
  ProfileState state{left_, sigma_speed_};
  const double used = advance(
      state, {std::sqrt(std::min(x_wanted, move.speed.cap)), move.even_acc, std::sqrt(end)}, dt);
  left_ = state.left;
  sigma_speed_ = state.speed;
  return used;
}

/// Up in the first half of what was left of a stretch, down in the second: x where they meet, as it is wanted now. `end_x`: what the stretch may end with.
double Executor::half_way_x(const PathSpan& move, double end_x, double x_wanted) const noexcept {
  const double end = move.from + move.length - cut_, x = sigma_speed_ * sigma_speed_;
  if (!(left_ - half_way_ > kNoStretch)) return x;
  path::Rows rows;
  rows_of(move, end - half_way_, end, limits_, rows);
  const double most = path::largest_x0(rows.all(), end_x);
  rows_of(move, end - left_, end - half_way_, limits_, rows);
  const path::Range range = path::range_of_x1(rows.all(), x, x > 0);
  const double high = range.high * (1.0 - 1e-6);
  return std::max(
      0.0, std::clamp(std::min({most, x_wanted, move.speed.cap}), std::min(range.low, high), high));
}

/// x is linear to the end of the stretch; what it is there is decided anew every cycle, by the rows of what is left.
double Executor::run_curved(const PathSpan& move, const Ends& ends, double x_wanted,
                            double dt) noexcept {
  const double hard = ends.hard;
  const double soft = x_wanted > 0 ? std::min(ends.soft, x_wanted) : 0.0,
               low_end = std::min(soft, hard);
  const double end = move.from + move.length - cut_;
  const double x = sigma_speed_ * sigma_speed_;
  if (x <= 0 && half_way_ <= 0 && low_end <= kNoSpeed) {
    if (x_wanted <= 0) return dt;
    // From rest to rest within one stretch.
    half_way_ = left_ / 2;
  }
  if (x_wanted <= 0) half_way_ = 0;
  double stretch = left_ - half_way_;
  double x1 = 0;
  if (half_way_ > 0) {
    x1 = half_way_x(move, low_end, x_wanted);
  } else if (stretch > kNoStretch) {
    // To stand, as hard as the limits allow on the next bit of the way: over the whole stretch a bend still to come would count now. It stays
    // possible: braking over the whole stretch is one of the ways to brake here, and whatever a speed can do, a lower one can.
    if (x_wanted <= 0 && x > 0)
      stretch = std::min(stretch, std::max(sigma_speed_ * period_ * kBrakeStep, kNoStretch));
    path::Rows rows;
    rows_of(move, end - left_, end - left_ + stretch, limits_, rows);
    const path::Range range = path::range_of_x1(rows.all(), x, left_ < move.length);
    if (x_wanted <= 0 && range.low < 0) return stop_within(move, range.low, stretch, dt);
    x1 = std::clamp(soft, std::min(range.low, range.high), range.high);
    // `hard` can always be met; that range.low is a rounding above it sometimes must not leave speed at a stop.
    x1 = std::min(x1, move.speed.cap);
    if (stretch >= left_) x1 = std::min(x1, hard);
    // Slow at both ends of it (the feed was low, or 0, until now): not at that pace all along.
    const double pace = sigma_speed_ + std::sqrt(x1);
    if (x_wanted > 0 && x1 < range.high && 2.0 * stretch > kLingers * pace &&
        pace < kSlow * std::sqrt(std::min(x_wanted, move.speed.cap))) {
      half_way_ = left_ / 2;
      stretch = left_ - half_way_;
      x1 = half_way_x(move, low_end, x_wanted);
    }
  } else {
    x1 = x;
  }
  const double v1 = std::sqrt(x1), sum = sigma_speed_ + v1;
  const double need = sum > 0 ? 2.0 * stretch / sum : 0.0;
  if (!(sum > 0)) return dt;  // stands
  if (need <= dt) {
    left_ = half_way_ > 0 || stretch >= left_ ? half_way_ : left_ - stretch;
    half_way_ = 0;
    sigma_speed_ = x1 <= kNoSpeed ? 0.0 : v1;
    return need;
  }
  const double acc = (x1 - x) / (2.0 * stretch);
  left_ -= dt * (sigma_speed_ + 0.5 * acc * dt);
  sigma_speed_ += acc * dt;
  return dt;
}

/// The hardest braking ends within `distance`: `low` is where it would bring x at its end. Each round takes the stopping distance of
/// the last one, which the rows of that shorter stretch then confirm.
double Executor::stop_within(const PathSpan& move, double low, double distance,
                             double dt) noexcept {
  const double begin = move.from + move.length - cut_ - left_, x = sigma_speed_ * sigma_speed_;
  for (int round = 0; round < kStopRounds; ++round) {
    const double next = distance * x / (x - low) * kStopReserve;
    if (!(next < distance)) break;
    // As good as standing: over the whole stretch it would creep for seconds.
    if (next < kNoStretch) {
      distance = next;
      break;
    }
    path::Rows rows;
    rows_of(move, begin, begin + next, limits_, rows);
    const double next_low = path::range_of_x1(rows.all(), x, true).low;
    if (next_low > 0) break;
    distance = next;
    low = next_low;
    if (low > -0.05 * x) break;
  }
  if (!(x > 0)) return dt;
  const double need = 2.0 * distance / sigma_speed_;
  if (need <= dt) {
    left_ -= distance;
    sigma_speed_ = 0;
    if (left_ < kNoStretch) left_ = 0;
    return need;
  }
  const double acc = -x / (2.0 * distance);
  left_ -= dt * (sigma_speed_ + 0.5 * acc * dt);
  sigma_speed_ += acc * dt;
  return dt;
}

/// One step along the stretch; gives the time used.
double Executor::drive(const PathSpan& move, const Ends& ends, double x_wanted,
                       double dt) noexcept {
  left_ -= cut_;
  const bool by_law = move.by_law && !track_.on && cut_ <= 0 && law_drives(move, x_wanted);
  const double used = by_law               ? run_law(move, x_wanted, dt)
                      : move.even_jerk > 0 ? run_ramps(move, x_wanted, dt)
                      : move.even_acc > 0  ? run_even(move, ends, x_wanted, dt)
                                           : run_curved(move, ends, x_wanted, dt);
  if (cut_ > 0) {
    left_ = std::max(left_, 0.0) + cut_;
    if (left_ <= cut_) sigma_speed_ = sigma_acc_ = 0;
  }
  show_place(move);
  return used;
}

void Executor::show_place(const PathSpan& move) noexcept {
  const double at = move.from + move.length - left_;
  const path::Piece::Place place = move.piece.place(at);
  pose_ = left_ <= 0 && move.at_end_exactly ? move.end : to_pose(place.point);
  speed_ = sigma_speed_ *
           (move.piece.feed.metric >= 0
                ? path::norm3(place.first, static_cast<std::size_t>(move.piece.feed.metric))
                : 1.0);
}

double Executor::run_move(const Span& span, const PathSpan& move, const PathInputs& in, double dt,
                          FaultList& faults) noexcept {
  watch_probe(span, move, in, faults);
  watch_indexer(span, move, in, faults);
  double used = 0;
  Ends ends;
  if (move.sync.per_rev > 0 && move.even_jerk > 0) {
    used = run_thread(span, move, in, dt, faults);
    show_place(move);
  } else {
    const double x = move.sync.per_rev > 0
                         ? wanted_in_thread(span, move, in, faults)
                         : step_within(move, in, wanted_under_way(move, in, scale_));
    if (cut_ <= 0) ends = ends_of(move);
    used = drive(move, ends, x, dt);
  }
  (void)pass_blocks(move, in);
  if (law_lost_) {
    raise(faults, Fault::path_starved_internal, -1, 0, 0, span.tag);
    failing_ = true;
  } else if (left_ <= 0) {
    // Rounding in the last bit of a stop must not begin the next block.
    if (in.single_step && !move.speed.sync && ends.soft <= 0 && sigma_speed_ <= kRestSpeed)
      sigma_speed_ = sigma_acc_ = 0;
    end_span(span, move, faults);
    return used;
  }
  if (at_rest() && failing_) {
    fail_path(span);
    return dt;
  }
  if (at_rest() && ending_) {
    history_.clear();
    end_probe(span, move);
    return dt;
  }
  return used;
}

/// Nothing of the span may be read after finish() or fail_path(): its place in the ring is free then.
void Executor::end_span(const Span& span, const PathSpan& move, FaultList& faults) noexcept {
  if (move.stop_at_end) sigma_speed_ = sigma_acc_ = 0;
  sync_.passed(move.length);
  if (move.probe || ending_ || move.sync.per_rev > 0 || indexer_ >= 0 ||
      move.number == no_way_back_)
    history_.clear();
  else
    history_.add(span, move, ends_of(move).hard);
  ready_way_back(1);
  const bool missed = move.probe && move.stop_at_end && !ending_ && move.probe_fail_is_error;
  if (missed) raise(faults, Fault::probe_no_contact, -1, 0, 0, span.tag);
  if ((failing_ && at_rest()) || missed)
    fail_path(span);
  else if (move.probe)
    end_probe(span, move);
  else
    finish(span, move.done_seq);
}

void Executor::output(const OutputChange& change) noexcept {
  if (change.index < 0 || change.index >= static_cast<std::int32_t>(kMaxDigital)) return;
  const auto i = static_cast<std::size_t>(change.index);
  const std::uint64_t bit = std::uint64_t{1} << i;
  if (change.synchronised) {
    (change.analog ? sync_analog_mask_ : sync_digital_mask_) |= bit;
    if (change.analog)
      sync_analog_[i] = change.value;
    else
      sync_digital_ = change.value != 0 ? sync_digital_ | bit : sync_digital_ & ~bit;
    return;
  }
  if (change.analog)
    outputs_.analog[i] = change.value;
  else
    outputs_.digital = change.value != 0 ? outputs_.digital | bit : outputs_.digital & ~bit;
}

void Executor::fire_synchronised() noexcept {
  outputs_.digital =
      (outputs_.digital & ~sync_digital_mask_) | (sync_digital_ & sync_digital_mask_);
  for (std::size_t i = 0; sync_analog_mask_ != 0 && i < kMaxAnalog; ++i) {
    if ((sync_analog_mask_ >> i & 1U) != 0) outputs_.analog[i] = sync_analog_[i];
  }
  sync_digital_mask_ = sync_analog_mask_ = 0;
}

void Executor::fill(MotionStatus& status) const noexcept {
  status.executed_seq = executed_seq_;
  status.current_seq = current_seq_;
  status.current = current_;
  status.kind = kind_;
  status.waiting_for = waiting_;
  status.waiting_index = waiting_index_;
  status.pos_cmd = pose_;
  status.tool_offset = tool_offset_;
  status.reverse = track_.on && track_.back;
  status.retraces = track_.on;
  status.probed = probed_;
  status.probe_tripped = probe_tripped_;
  status.distance_to_go = distance_;
  status.vel_mm_s = speed_;
  status.dwell_left_s = dwell_left_;
  status.sync_lag_mm = sync_.lag_mm();
  status.sync_in_step = sync_.in_step();
  status.sync_run_in_mm = sync_.run_in_mm();
  status.planned_items = spans_.size();
  const PathSpan* m = move();
  status.probing = m != nullptr && m->probe;
  status.requested_vel_mm_s = m != nullptr ? requested_ : 0.0;
  status.distance_to_go_axes = m != nullptr ? block_end_ - pose_ : Pose{};
}

}  // namespace kerf::motion
