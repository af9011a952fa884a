// Executor: the blocks of the path, and single step.
//
// The rule is in motion/api/step.hpp. A step begins at rest, so whoever steps while the machine still brakes gets the block in which it comes to
// rest. Most blocks end where a span ends, and the planner has the path stand there (Planner::plan). Others end within one (BlockStart): lines
// that G64 Q has joined, and such as are shorter than a span. It is entered at rest then, and driven from rest to rest up to there, so nothing that was
// planned before the operator paused has to change. No step begins before the planner knows of it (PlanSlots::steps).
#include <algorithm>

#include "motion/core/executor.hpp"

namespace kerf::motion {

/// Once a cycle.
void Executor::begin_step(const PathInputs& in) noexcept {
  between_blocks_ = step_brakes_ = false;
  if (in.stand || !in.single_step) {
    step_.release();
    return;
  }
  if (step_.begun() || track_.on) return;
  step_brakes_ = slots_.steps.observe() == 0;
  if (!started_ || step_brakes_) return;
  if (at_rest() || follows_spindle()) {
    // In the middle of a block: that is the one. Where one ends it is the next (pass_blocks).
    const PathSpan* m = move();
    const BlockStart* next = m != nullptr ? next_block(*m) : nullptr;
    if (next == nullptr || left_ > next->left) step_.begin(current_.id);
  } else {
    step_brakes_ = true;
  }
}

/// Whether the span may begin.
bool Executor::step_allows(const Span& span, bool single_step) noexcept {
  if (!single_step || !at_rest()) return true;
  const auto* move = std::get_if<PathSpan>(&span.body);
  if (move != nullptr && move->sync.per_rev > 0 && !move->sync.first) return true;
  return step_.takes(span.tag.id);
}

const BlockStart* Executor::next_block(const PathSpan& move) const noexcept {
  if (track_.on || block_ >= move.blocks) return nullptr;
  return &slots_.block[(move.first_block + block_) % PlanSlots::kBlocks];
}

/// With the span.
void Executor::begin_blocks(const PathSpan& move) noexcept {
  block_ = 0;
  block_end_ = move.end;
  cut_ = 0;
  if (const BlockStart* own = next_block(move)) begin_block(*own, move);
}

void Executor::begin_block(const BlockStart& block, const PathSpan& move) noexcept {
  current_ = block.tag;
  current_seq_ = block.seq;
  ++block_;
  const BlockStart* next = next_block(move);
  block_end_ =
      next != nullptr ? to_pose(move.piece.point(move.from + move.length - next->left)) : move.end;
}

/// Those that are reached begin. False: the machine stands between two of them, and the next one may not begin.
bool Executor::pass_blocks(const PathSpan& move, const PathInputs& in) noexcept {
  const BlockStart* next = next_block(move);
  for (; next != nullptr && left_ <= next->left; next = next_block(move)) {
    executed_seq_ = std::max(executed_seq_, next->done_seq);
    distance_ = 0;
    if (at_rest() && step_brakes_) return false;
    if (at_rest() && (in.stand || (in.single_step && !step_.takes(next->tag.id)))) {
      blocked(PathWait::hold);
      between_blocks_ = true;
      return false;
    }
    begin_block(*next, move);
  }
  distance_ = next != nullptr ? left_ - next->left : left_ + move.to_move_end;
  return true;
}

/// Single step within a span where blocks end: what is wanted of x, and where to stand (cut_). From rest only; until then it brakes.
double Executor::step_within(const PathSpan& move, const PathInputs& in, double x) noexcept {
  if (!pass_blocks(move, in)) x = 0;
  const BlockStart* next = in.single_step ? next_block(move) : nullptr;
  const bool cuts = next != nullptr && left_ > next->left;
  if (cuts != (cut_ > 0)) {
    if (cuts && !at_rest()) return 0;
    half_way_ = 0;
  }
  cut_ = cuts ? next->left : 0.0;
  return x;
}

}  // namespace kerf::motion
