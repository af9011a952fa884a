// read_patiently: a SeqCell's value for readers that have time.
#pragma once

#include <sched.h>

#include "rtapi/sync/seq_cell.hpp"

namespace kerf::rtapi {

/// Without realtime priority, or on a computer that is busy, a writer that lives may be stopped in the middle of a write; it gets the processor to
/// end it. False: the writer is dead, which takes some milliseconds to find out. Never from a realtime thread. A participant with a thread of its own that
/// reads again soon anyway does without (WaitSpec::wake_at after a read that failed).
template <class T>
[[nodiscard]] bool read_patiently(const SeqCell<T>& cell, T& out) noexcept {
  constexpr int kPatience = 5000;
  for (int n = 0; n < kPatience; ++n) {
    if (cell.read(out)) return true;
    (void)::sched_yield();
  }
  return false;
}

}  // namespace kerf::rtapi
