#include "motion/core/executor.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {
namespace {

/// Spans begun in one cycle; a cycle full of them ends at a corner, where the machine stands anyway.
constexpr int kSpansPerCycle = 32;
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

bool same_place(const Pose& a, const Pose& b) noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (!(std::abs(a[i] - b[i]) <= kSamePlace)) return false;
  }
  return true;
}

}  // namespace

void Executor::place(const Pose& pose) noexcept {
  pose_ = pose;
  run_ = {};
  distance_ = 0;
  started_ = ending_ = failing_ = false;
  kind_ = MotionKind::none;
  ++place_number_;
}

const MoveSpan* Executor::move() const noexcept {
  if (!started_) return nullptr;
  const Span* span = spans_.front();
  return span == nullptr ? nullptr : std::get_if<MoveSpan>(&span->body);
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
  if (started_ && span != nullptr && before(span->epoch, epoch)) place(pose_);
  (void)next();
  sync_digital_mask_ = sync_analog_mask_ = 0;
  dwell_left_ = 0;
  waiting_ = PathWait::none;
  ++place_number_;
}

void Executor::void_epoch(std::uint32_t epoch) noexcept {
  if (void_epoch_ == 0 || before(void_epoch_, epoch)) void_epoch_ = epoch;
  place(pose_);
  (void)next();
  sync_digital_mask_ = sync_analog_mask_ = 0;
  dwell_left_ = 0;
  waiting_ = PathWait::none;
}

void Executor::fail_path(const Span& span) noexcept { void_epoch(span.epoch); }

void Executor::finish(const Span& span) noexcept {
  executed_seq_ = span.seq;
  started_ = ending_ = false;
  kind_ = MotionKind::none;
  run_ = {};
  distance_ = 0;
  spans_.pop();
}

void Executor::step(const PathInputs& in, double dt, FaultList& faults) noexcept {
  waiting_ = PathWait::none;
  waiting_index_ = -1;
  if (in.stand || !in.single_step) step_begun_ = false;
  double rest = dt;
  for (int n = 0; n < kSpansPerCycle && rest > 0; ++n) {
    if (!started_) {
      // Held: nothing new begins, but what is queued stays.
      if (in.stand) {
        if (!spans_.empty()) blocked(PathWait::hold);
        break;
      }
      const Span* span = next();
      if (span == nullptr) break;
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
    if (const auto* move = std::get_if<MoveSpan>(&span->body)) {
      rest -= run_move(*span, *move, in, rest, faults);
      continue;
    }
    if (const auto* change = std::get_if<SpindleChange>(&span->body)) {
      if (!run_orient(*span, *change, in, rest, faults)) break;
      continue;
    }
    if (in.stand) break;
    const double used = std::min(rest, dwell_left_);
    dwell_left_ -= used;
    rest -= used;
    if (dwell_left_ <= 0)
      finish(*span);
    else
      blocked(PathWait::dwell);
  }
  probe_before_ = in.probe;
}

bool Executor::step_allows(const Span& span, bool single_step) noexcept {
  if (!single_step) return true;
  if (!step_begun_) {
    step_begun_ = true;
    step_id_ = span.tag.id;
  }
  return span.tag.id == step_id_;
}

Executor::Outcome Executor::begin(const Span& span, const PathInputs& in,
                                  FaultList& faults) noexcept {
  const auto instant = [&](auto&& act) {
    current_ = span.tag;
    current_seq_ = span.seq;
    act();
    finish(span);
    return Outcome::done;
  };
  return std::visit(
      Overloaded{
          [&](const MoveSpan& m) { return begin_move(span, m, in, faults); },
          [&](const Dwell& m) {
            current_ = span.tag;
            current_seq_ = span.seq;
            dwell_left_ = m.seconds;
            started_ = true;
            return Outcome::busy;
          },
          [&](const OutputChange& m) { return instant([&] { output(m); }); },
          [&](const SpindleChange& m) {
            current_ = span.tag;
            current_seq_ = span.seq;
            const Outcome o = begin_spindle(m);
            if (o == Outcome::done) finish(span);
            return o;
          },
          [&](const PathControl&) { return instant([] {}); },
          [&](const OverrideEnable& m) { return instant([&] { enables_ = m; }); },
          [&](const ToolOffset& m) { return instant([&] { tool_offset_ = m.offset; }); },
          [&](const Marker& m) {
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
    finish(span);
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

Executor::Outcome Executor::begin_move(const Span& span, const MoveSpan& move, const PathInputs& in,
                                       FaultList& faults) noexcept {
  if (!in.may_move) return Outcome::blocked;
  if (!same_place(move.curve.start, pose_)) {
    raise(faults, Fault::path_starved_internal, -1, 0, 0, span.tag);
    fail_path(span);
    return Outcome::done;
  }
  if (move.kind != MotionKind::traverse && move.kind != MotionKind::tool_change) {
    if (after_traverse_) spindles_.wait_after_traverse();
    after_traverse_ = false;
    const std::int32_t waiting = spindles_.not_at_speed();
    if (waiting >= 0) {
      blocked(PathWait::spindle_at_speed, waiting);
      return Outcome::blocked;
    }
  }
  const bool point = move.curve.shape == Curve::Shape::point;
  if (!point && wanted_speed(move, in) <= 0)
    return Outcome::blocked;  // stands; the outputs wait for the move itself
  current_ = span.tag;
  current_seq_ = span.seq;
  fire_synchronised();
  if (move.probe) {
    probe_tripped_ = false;
    if (in.probe != move.probe_until_open) {
      raise(faults, Fault::probe_already_tripped, -1, in.probe ? 1 : 0, 0, span.tag);
      fail_path(span);
      return Outcome::done;
    }
  }
  if (point) {
    pose_ = move.curve.end;
    if (move.probe) ++place_number_;
    finish(span);
    return Outcome::done;
  }
  started_ = true;
  after_traverse_ = move.kind == MotionKind::traverse;
  kind_ = move.kind;
  run_ = {move.curve.length, 0.0};
  return Outcome::busy;
}

double Executor::wanted_speed(const MoveSpan& move, const PathInputs& in) noexcept {
  const bool traverse = move.kind == MotionKind::traverse || move.kind == MotionKind::tool_change;
  double k = traverse        ? factor(in.rapid_override, 1.0)
             : enables_.feed ? factor(in.feed_override, max_override_)
                             : 1.0;
  if (enables_.adaptive) k *= factor(in.adaptive_feed, max_override_);
  k = std::min(k, max_override_);
  requested_ = std::min(move.requested, move.speed_ceiling);
  double speed = k > 0 ? std::min(move.requested * k, move.speed_ceiling) : 0.0;
  if (move.curve.metric != FeedMetric::abc) speed = std::min(speed, std::max(in.max_vel_mm_s, 0.0));
  if (speed <= 0) blocked(PathWait::zero_override);
  if (in.feed_inhibit) {
    speed = 0;
    blocked(PathWait::feed_inhibit);
  } else if (in.feed_hold && enables_.feed_hold) {
    speed = 0;
    blocked(PathWait::feed_hold_pin);
  }
  commanded_feed_ = traverse || speed <= 0 ? 0.0 : move.requested * k;
  return speed;
}

void Executor::watch_probe(const Span& span, const MoveSpan& move, const PathInputs& in,
                           FaultList& faults) noexcept {
  if (ending_ || failing_) return;
  if (move.probe) {
    if (in.probe == move.probe_until_open) return;
    probed_ = in.pose_fb;
    probe_tripped_ = true;
    ending_ = true;
  } else if (in.probe && !probe_before_) {
    raise(faults, Fault::probe_unexpected, -1, 0, 0, span.tag);
    failing_ = true;
  }
}

double Executor::run_move(const Span& span, const MoveSpan& move, const PathInputs& in, double dt,
                          FaultList& faults) noexcept {
  watch_probe(span, move, in, faults);
  double speed = wanted_speed(move, in);
  if (in.stand || ending_ || failing_) speed = 0;
  if (in.stand) blocked(PathWait::hold);
  const double used = advance(run_, {speed, move.acc, move.exit_speed}, dt);
  pose_ = point_at(move.curve, move.curve.length - run_.left);
  distance_ = run_.left;
  if (run_.left <= 0) {
    pose_ = move.curve.end;
    // Nothing of the span may be read after finish() or fail_path(): its place in the ring is free then.
    const bool probe = move.probe, missed = probe && !ending_ && move.probe_fail_is_error;
    if (missed) raise(faults, Fault::probe_no_contact, -1, 0, 0, span.tag);
    if (failing_ || missed)
      fail_path(span);
    else
      finish(span);
    if (probe) ++place_number_;
    return used;
  }
  if (run_.speed <= 0 && failing_) {
    fail_path(span);
    return dt;
  }
  if (run_.speed <= 0 && ending_) {
    finish(span);
    ++place_number_;
    return dt;
  }
  return used;
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
  status.probed = probed_;
  status.probe_tripped = probe_tripped_;
  status.distance_to_go = distance_;
  status.vel_mm_s = run_.speed;
  status.dwell_left_s = dwell_left_;
  status.planned_items = spans_.size();
  const MoveSpan* m = move();
  status.probing = m != nullptr && m->probe;
  status.requested_vel_mm_s = m != nullptr ? requested_ : 0.0;
  status.distance_to_go_axes = m != nullptr ? m->curve.end - pose_ : Pose{};
}

}  // namespace kerf::motion
