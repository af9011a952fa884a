// Executor: the path backwards, for a negative adaptive feed. "Track" is the stretch in execution while that is not the front of the ring
// driven forwards.
#include <algorithm>

#include "motion/core/executor.hpp"

namespace kerf::motion {

/// At rest, and what stands at the ring's front can be turned on, or what lies before it. Never when no move is to come: an idle machine
/// moves nowhere.
bool Executor::may_turn_back(const PathInputs& in) noexcept {
  if (!at_rest() || indexer_ >= 0 || !(back_scale_.feed > 0) || !history_.bounded() || in.stand ||
      !in.may_move || in.feed_inhibit || (in.feed_hold && enables_.feed_hold) || ending_ ||
      failing_)
    return false;
  const Span* span = next();
  const auto* move = span == nullptr ? nullptr : std::get_if<PathSpan>(&span->body);
  // A thread is cut once, forwards.
  if (move == nullptr || move->probe || move->sync.per_rev > 0) return false;
  if (started_ && move->number == no_way_back_) return false;
  return started_ || (history_.size() > 0 && !in.single_step);
}

void Executor::turn_back() noexcept {
  track_.on = track_.back = true;
  track_.behind = started_ ? 0 : 1;
  half_way_ = cut_ = 0;
  if (started_) {
    const auto& move = std::get<PathSpan>(spans_.front()->body);
    track_.move = path::reversed(move);
    left_ = move.length - left_;
  } else {
    track_.move = path::reversed(history_.last(1).span);
    left_ = track_.move.length;
  }
  show_track();
}

double Executor::run_track(const PathInputs& in, double dt, FaultList& faults) noexcept {
  const Span* front = next();
  if (front == nullptr) {  // can only be a fault of ours: whoever drops the front drops the track
    forget_track();
    return dt;
  }
  watch_probe(*front, track_.move, in, faults);
  if (at_rest() && failing_) {
    fail_path(*front);
    return dt;
  }
  const bool turns = track_.back ? scale_.feed > 0 : back_scale_.feed > 0;
  if (turns && at_rest() && !in.stand && in.may_move) {
    turn_track();
    if (!track_.on) return 0;
  }
  const double x = wanted_under_way(track_.move, in, track_.back ? back_scale_ : scale_);
  double used = dt;
  if (left_ > 0) used = drive(track_.move, track_ends(), x, dt);
  distance_ = left_ + track_.move.to_move_end;
  if (left_ <= 0) {
    const bool begins = track_.back && track_.behind >= history_.size();
    if (begins) sigma_speed_ = sigma_acc_ = 0;  // its bound there is 0
    if (begins) return dt;
    end_of_track();
  }
  return used;
}

Executor::Ends Executor::track_ends() noexcept {
  const bool at_front = track_.behind == 0;
  if (track_.back) {
    const double hard = std::min(history_.back(track_.behind + 1), track_.move.speed.cap);
    if (track_.behind >= history_.size()) return {};
    return {hard,
            std::min(hard, wanted_x(history_.last(track_.behind + 1).span.speed, back_scale_))};
  }
  if (at_front) return ends_of(track_.move);
  const double hard = history_.last(track_.behind).hard;
  double soft = hard;
  if (track_.behind > 1) {
    soft = wanted_x(history_.last(track_.behind - 1).span.speed, scale_);
  } else if (const Span* front = spans_.front()) {
    const auto* move = std::get_if<PathSpan>(&front->body);
    soft = move == nullptr ? 0.0 : wanted_x(move->speed, scale_);
  }
  return {hard, std::min(hard, soft)};
}

/// The line that is driven is the line that is shown.
void Executor::show_track() noexcept {
  kind_ = track_.move.kind;
  if (track_.behind == 0) {
    const Span& front = *spans_.front();
    const auto& move = std::get<PathSpan>(front.body);
    const BlockStart* block =
        block_ > 0 ? &slots_.block[(move.first_block + block_ - 1) % PlanSlots::kBlocks] : nullptr;
    current_ = block != nullptr ? block->tag : front.tag;
    current_seq_ = block != nullptr ? block->seq : front.seq;
  } else {
    current_ = history_.last(track_.behind).tag;
    current_seq_ = history_.last(track_.behind).seq;
  }
}

void Executor::turn_track() noexcept {
  track_.back = !track_.back;
  half_way_ = 0;
  left_ = track_.move.length - left_;
  if (!track_.back && track_.behind == 0) {
    leave_track();
    return;
  }
  const PathSpan& whole = track_.behind == 0 ? std::get<PathSpan>(spans_.front()->body)
                                             : history_.last(track_.behind).span;
  track_.move = track_.back ? path::reversed(whole) : whole;
  show_track();
}

/// On to the next stretch, with the speed it is entered with.
void Executor::end_of_track() noexcept {
  half_way_ = 0;
  if (track_.back) {
    if (history_.last(track_.behind + 1).span.stop_at_end) sigma_speed_ = sigma_acc_ = 0;
    track_.move = path::reversed(history_.last(++track_.behind).span);
  } else {
    if (track_.move.stop_at_end) sigma_speed_ = sigma_acc_ = 0;
    if (--track_.behind == 0) {
      left_ = 0;
      if (started_) left_ = std::get<PathSpan>(spans_.front()->body).length;
      leave_track();
      return;
    }
    track_.move = history_.last(track_.behind).span;
  }
  left_ = track_.move.length;
  show_track();
}

/// Back at the front of the ring; `left_` is right for it.
void Executor::leave_track() noexcept {
  track_.on = false;
  if (started_) {
    show_track();
  } else {
    kind_ = MotionKind::none;
    left_ = 0;
  }
}

void Executor::forget_track() noexcept {
  track_.on = false;
  history_.clear();
}

}  // namespace kerf::motion
