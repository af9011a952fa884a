// Step: what one step of single stepping is. The one rule of the two that let blocks go.
//
// A step is one block of the program as it is executed, through subroutines and loops: all path items with its SourceTag::id, and all that task does
// itself for it (M0, M6, M66, messages, coolant, user M-codes). After a release the first block that begins, or goes on, is the step; the
// next one waits for another release. A thread is one step, however many blocks cut it (ends_thread): it cannot be stopped in its middle
// and begun again in the same groove.
//
// Two let blocks go, each what only it can stop:
// * Motion (Executor) has what was queued and planned when the operator paused. That can neither be taken back nor be sent again, so motion stands
//   at the ends of its blocks, on the path as it is planned: in a blended corner in its middle. It counts from each release of hold.
// * Task (InterpreterParticipant) has all the others, and is the only one that knows of blocks without an item. It sends one block, waits until
//   that is executed, and reads the next only then: so each block ends at its programmed point, M66 and the operator's switches (block delete, optional
//   stop) count for the next step, and after resume nothing stands in the queue that was planned for stepping. It counts from each resume.
// Task waits until motion has executed all it was sent, so the second begins where the first has ended.
#pragma once

#include <algorithm>
#include <cstdint>

namespace kerf::motion {

/// Blocks are numbered upwards, also by a task that was started anew.
class Step {
 public:
  /// The next block that begins is a new step.
  void release() noexcept { begun_ = false; }
  [[nodiscard]] bool begun() const noexcept { return begun_; }
  /// This block, or the next part of a thread, is the step, with all before it.
  void begin(std::uint64_t id) noexcept {
    begun_ = true;
    allow(id);
  }
  /// All up to this block may begin without being one.
  void allow(std::uint64_t id) noexcept { id_ = std::max(id_, id); }
  /// What belongs to it, and to blocks before it.
  [[nodiscard]] bool covers(std::uint64_t id) const noexcept { return id <= id_; }
  /// Whether block `id` may begin now; if none had, it is the step.
  [[nodiscard]] bool takes(std::uint64_t id) noexcept {
    if (!begun_) begin(id);
    return covers(id);
  }

 private:
  std::uint64_t id_{0};
  bool begun_{false};
};

}  // namespace kerf::motion
