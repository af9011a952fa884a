// Executor: locking rotary indexers (LinuxCNC manual, [AXIS_L]LOCKING_INDEXER_JOINT). The joint turns only while joint.N.is-unlocked is
// true, and the path goes on only when it is locked again; whatever ends the path in between locks it too.
#include <bit>

#include "motion/core/executor.hpp"

namespace kerf::motion {

bool Executor::waits_for_lock() noexcept {
  if (locking_ == 0) return false;
  blocked(PathWait::indexer_locked, std::countr_zero(locking_));
  return true;
}

Executor::Outcome Executor::begin_indexer(const Span& span, const IndexerSpan& order) noexcept {
  if (order.unlock && waits_for_lock()) return Outcome::blocked;
  history_.clear();
  current_ = span.tag;
  current_seq_ = span.seq;
  kind_ = MotionKind::index_rotary;
  started_ = true;
  if (order.unlock)
    indexer_ = order.joint;
  else
    lock_again();
  return Outcome::busy;
}

/// False: it goes on.
bool Executor::run_indexer(const Span& span, const IndexerSpan& order,
                           const PathInputs& in) noexcept {
  const bool unlocked = (in.unlocked >> static_cast<std::uint32_t>(order.joint) & 1U) != 0;
  if (unlocked != order.unlock) {
    blocked(order.unlock ? PathWait::indexer_unlocked : PathWait::indexer_locked, order.joint);
    return false;
  }
  finish(span, order.unlock ? 0 : span.seq);
  return true;
}

void Executor::watch_indexer(const Span& span, const PathSpan& move, const PathInputs& in,
                             FaultList& faults) noexcept {
  if (move.kind != MotionKind::index_rotary || failing_ || indexer_ < 0) return;
  if ((in.unlocked >> static_cast<std::uint32_t>(indexer_) & 1U) != 0) return;
  raise(faults, Fault::indexer_locked, indexer_, 0, 0, span.tag);
  failing_ = true;
}

void Executor::lock_again() noexcept {
  if (indexer_ >= 0) locking_ |= 1U << static_cast<std::uint32_t>(indexer_);
  indexer_ = -1;
}

}  // namespace kerf::motion
