// The record of every servo cycle, for tools that must not miss one: joint-logger writes it, the launcher reads it.
#pragma once

#include <cstdint>

#include "motion/api/limits.hpp"
#include "motion/api/status.hpp"
#include "rtapi/sync/spsc_ring.hpp"

namespace kerf::motion {

/// Service under which motmod offers its MotionShared to components loaded after it (Builder::find_service).
inline constexpr const char* kMotionService = "motion-shared";

/// One servo cycle. Lengths in mm, angles in degrees.
struct JointSample {
  std::uint64_t cycle{0};
  std::int64_t time_ns{0};  ///< instance time of the cycle
  std::uint64_t block{0};   ///< SourceTag::id of the item in execution, or of the last one
  std::int32_t line{0};     ///< and its line; 0: none
  MotionKind kind{MotionKind::none};
  std::int32_t joints{0};
  std::int32_t period_ns{0};     ///< of the servo thread
  double vel_mm_s{0};            ///< along the path
  double requested_vel_mm_s{0};  ///< programmed, before overrides
  double position[3]{};          ///< commanded X Y Z, machine coordinates
  double joint[kMaxJoints]{};    ///< commanded positions
};

/// Room for eight seconds at 1 kHz, in case the reader's process is held up.
struct JointLog {
  rtapi::SpscRing<JointSample, 8192> ring;
  rtapi::Word<std::uint64_t> dropped{0};  ///< cycles that found the ring full
};

inline constexpr const char* kJointLogBlock = "joint-log";
inline constexpr std::uint64_t kJointLogAbi = 1 + sizeof(JointLog) * 0x9e3779b97f4a7c15ULL;

}  // namespace kerf::motion
