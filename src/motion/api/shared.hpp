// The blocks of the instance's segment through which task and motion talk. Nothing else passes between them.
#pragma once

#include "motion/api/config.hpp"
#include "motion/api/intent.hpp"
#include "motion/api/path_items.hpp"
#include "motion/api/screw.hpp"
#include "motion/api/status.hpp"
#include "rtapi/sync/spsc_ring.hpp"

namespace kerf::motion {

using PathRing = rtapi::SpscRing<PathItem, 1024>;

/// Faults, newest last. The reader keeps a cursor of its own; a reader that is more than the ring behind has lost some and
/// sees it from the numbers.
struct FaultLog {
  static constexpr std::size_t kSlots = 256;
  rtapi::SeqCell<FaultRecord> slot[kSlots];  ///< record n stands in slot n % kSlots
  rtapi::Word<std::uint64_t> newest{0};      ///< published after the slot
};

/// One block named kMotionBlock, made by motmod when it is loaded.
struct MotionShared {
  IntentCell intent;                             ///< task -> servo
  rtapi::SeqCell<MachineConfig> config;          ///< task -> motion
  rtapi::SeqCell<ScrewTable> screw[kMaxJoints];  ///< task -> motion, before `config`
  PathRing path;                                 ///< task -> planner
  rtapi::Cell path_cell;                         ///< notified by task after it pushed
  rtapi::SeqCell<MotionStatus> status;           ///< servo -> everybody, once a cycle
  rtapi::Cell
      status_cell;  ///< notified by servo when task should look: item done, mode, fault, ack
  /// Task -> servo: the item behind which task goes on, and of whose end it is told at once; 0: of each. Relaxed: servo looks in every cycle.
  rtapi::Word<std::uint64_t> awaited_seq{0};
  FaultLog faults;  ///< servo -> everybody
};

inline constexpr const char* kMotionBlock = "motion";
/// Folded into the block's directory entry; a process of another build is refused at attach.
inline constexpr std::uint64_t kMotionAbi =
    PathItems::abi_hash() ^ (sizeof(MotionShared) * 0x9e3779b97f4a7c15ULL);

}  // namespace kerf::motion
