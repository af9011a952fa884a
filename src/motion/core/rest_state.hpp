// The state of a controller that stands still with nothing planned: bytes, for the flight record.
#pragma once

#include "motion/core/controller.hpp"

namespace kerf::motion {

/// What stands between the moves. No track: a replay drives nothing backwards that was driven before it.
struct Executor::Rest {
  FeedScale scale, back_scale;
  Pose pose, tool_offset, probed;
  double distance{0}, requested{0}, commanded_feed{0};
  bool probe_before{false}, after_traverse{false}, probe_tripped{false};
  Step step;
  std::uint64_t executed_seq{0}, current_seq{0}, place_number{0};
  std::uint32_t min_epoch{0}, void_epoch{0};
  SourceTag current;
  OverrideEnable enables;
  std::uint64_t sync_digital_mask{0}, sync_digital{0}, sync_analog_mask{0};
  std::int32_t indexer{-1};
  std::uint32_t locking{0};
  double sync_analog[kMaxAnalog]{};
  SpindleObserver observer[kMaxSpindles];
  double slow_rps[kMaxSpindles]{}, feed_rps[kMaxSpindles]{};
};

struct Controller::Rest {
  MachineConfig config;
  OutputBank outputs;
  Spindles spindles;
  Executor::Rest executor;
  Joint joint[kMaxJoints];
  double skew[kMaxJoints]{};
  AxisMover axis[rtapi::kAxes];
  Wheel joint_wheel[kMaxJoints], axis_wheel[rtapi::kAxes];
  Guard guard;
  bool enabled{false}, armed{true}, closing_down{false}, single_step{false}, away{false},
      start_taken{false};
  bool jog_stop_before{false}, jog_dead_before{false}, probe_before{false};
  std::int32_t kind{0};
  MotionMode mode{MotionMode::free}, refused_mode{MotionMode::free};
  std::uint32_t enable_request{0}, acked_epoch{0};
  Pose pose, pose_fb, pose_before;
  ExternalOffsets offsets;
  AxisConfig axis_limit[rtapi::kAxes];
  std::uint64_t heartbeat{0}, fault_number{0}, cycle{0};
  double heartbeat_age_s{0};
  std::uint32_t joint_jog_seen[kMaxJoints]{}, axis_jog_seen[rtapi::kAxes]{};
  std::uint32_t home_seen{0}, unhome_seen{0}, spindle_stop_seen[kMaxSpindles]{}, wishes_seen{0};
  WishesSeen seen;
};
static_assert(std::is_trivially_copyable_v<Controller::Rest>);

}  // namespace kerf::motion
