// Span: what the planner hands to the servo cycle, in path order; and what the servo tells the planner.
#pragma once

#include <cstdint>
#include <variant>

#include "motion/api/shared.hpp"
#include "motion/core/geometry.hpp"

namespace kerf::motion {

/// A checked piece of path with everything the servo cycle needs to run it in O(1).
struct MoveSpan {
  Curve curve;
  double speed_ceiling{0};  ///< along the curve, from all joint limits; no override passes it
  double acc{0};            ///< along the curve, speeding up and braking
  double requested{
      0};  ///< programmed speed at override 1; rapids: the ceiling or the programmed cap
  double exit_speed{0};  ///< at the end of the span; 0: exact stop
  MotionKind kind{MotionKind::feed};
  bool probe{false}, probe_until_open{false}, probe_fail_is_error{false};
  bool reserved{false};
};

/// Everything else keeps its place between the moves.
struct Span {
  using Body = std::variant<MoveSpan, Dwell, OutputChange, SpindleChange, PathControl,
                            OverrideEnable, ToolOffset, Marker>;
  std::uint32_t epoch{0};
  std::uint32_t reserved{0};
  std::uint64_t seq{0};
  SourceTag tag;
  Body body{Marker{}};
};

/// Planner -> servo. Both ends live in the realtime host.
using SpanRing = rtapi::SpscRing<Span, 256>;
/// Planner -> servo: items that were refused. The servo numbers and publishes them.
using FaultRing = rtapi::SpscRing<FaultRecord, 16>;

/// Servo -> planner, once a cycle.
struct ServoView {
  std::uint32_t acked_epoch{0};
  std::uint32_t void_epoch{
      0};  ///< items of this epoch and older ones are void: the machine was disabled, or a move failed
  std::uint64_t executed_seq{0};
  std::uint64_t place{
      0};     ///< raised whenever the machine came to stand elsewhere than where the path led
  Pose pose;  ///< commanded position; what a path that begins now begins from
  std::uint64_t config_version{0};  ///< of the limits that the servo goes by; the shell knows it
  bool takes_moves{false};          ///< enabled, in coordinated mode
  bool reserved[7]{};
};

}  // namespace kerf::motion
