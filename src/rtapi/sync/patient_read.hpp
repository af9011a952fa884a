// read_patiently: a SeqCell's value for readers that have time.
#pragma once

#include <sched.h>

#include "rtapi/clock/clock.hpp"
#include "rtapi/sync/seq_cell.hpp"

namespace kerf::rtapi {

/// A participant reads again after this where it had no stable copy, as behind the write there may be nothing new to be told of.
inline constexpr Nanos kReadAgain = kMillisecond;

/// Without realtime priority, or on a computer that is busy, a writer that lives may be stopped in the middle of a write; it gets the processor to
/// end it. False: the writer is dead, which takes some milliseconds to find out. Never from a realtime thread, nor in the
/// step of a participant (kReadAgain).
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
