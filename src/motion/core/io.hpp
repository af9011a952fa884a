// What one servo cycle reads and leaves behind, as plain values in mm, degrees and rpm: the shell copies pins to and from.
#pragma once

#include <cstdint>

#include "motion/api/intent.hpp"
#include "motion/api/limits.hpp"
#include "motion/api/status.hpp"
#include "rtapi/base/static_vector.hpp"

namespace kerf::motion {

/// A jog wheel: joint.N.jog-*, axis.L.jog-*.
struct WheelInputs {
  bool enable{false};
  bool velocity_mode{false};  ///< stand when the wheel stands, wherever that is
  std::int32_t counts{0};
  double per_count{0};       ///< mm or degrees
  double accel_fraction{1};  ///< of the acceleration limit
};

/// axis.L.eoffset-*
struct OffsetInputs {
  bool enable{false}, clear{false};
  std::int32_t counts{0};
  double per_count{0};  ///< mm or degrees
};

struct JointInputs {
  double motor_pos_fb{0};
  double posthome_cmd{0};  ///< of an extra joint
  bool home_switch{false}, neg_limit{false}, pos_limit{false}, amp_fault{false};
  bool index_enable{false}, is_unlocked{false};
  bool fb_stale{false};  ///< motor_pos_fb is older than this cycle
};

struct SpindleInputs {
  double revs{0}, speed_in_rps{0};
  std::int32_t orient_fault{0};
  bool amp_fault{false}, at_speed{true}, inhibit{false}, is_oriented{false};
  bool index_enable{false};
};

struct Inputs {
  bool enable{true}, feed_hold{false}, feed_inhibit{false}, homing_inhibit{false};
  bool jog_inhibit{false}, jog_stop{false}, jog_stop_immediate{false}, probe{false};
  std::uint64_t misc_errors{0};  ///< motion.misc-error-NN, a bit each
  double adaptive_feed{1};
  /// PlanGate::done() at the beginning of the cycle: what can be seen of the planner.
  std::uint64_t plan_passes{~std::uint64_t{0}};
  double since_last_s{0};  ///< from the start of the cycle before to that of this one; 0: not known
  JointInputs joint[kMaxJoints];
  SpindleInputs spindle[kMaxSpindles];
  WheelInputs joint_wheel[kMaxJoints];
  WheelInputs axis_wheel[rtapi::kAxes];
  OffsetInputs offset[rtapi::kAxes];
};

/// The intent cell as read at the start of the cycle.
struct Orders {
  std::uint32_t abort_epoch{1};
  bool enable{false}, hold{false};
  std::uint32_t enable_request{0};  ///< number of the request that enable stands for
  bool path_ring_empty{true};       ///< nothing waits before the planner
  std::uint64_t heartbeat{0};
  const Intent* values{nullptr};
};

/// motion.digital-out-NN, motion.analog-out-NN.
struct OutputBank {
  std::uint64_t digital{0};
  double analog[kMaxAnalog]{};
};

/// Faults of this cycle, not yet numbered.
using FaultList = rtapi::StaticVector<FaultRecord, 32>;

inline void raise(FaultList& list, Fault fault, std::int32_t index = -1, double value = 0,
                  double limit = 0, const SourceTag& tag = {}) noexcept {
  FaultRecord r;
  r.fault = fault;
  r.index = index;
  r.value = value;
  r.limit = limit;
  r.tag = tag;
  (void)list.push_back(r);  // 32 new faults in one cycle: the first ones tell the story
}

}  // namespace kerf::motion
