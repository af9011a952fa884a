// Planner: path items in, checked spans out. Pure arithmetic; the shell gives it its turn and its waits.
//
// First planner: every corner is an exact stop (MoveSpan::exit_speed stays 0).
#pragma once

#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/core/span.hpp"

namespace kerf::motion {

class Planner {
 public:
  /// What must change before run() can do more.
  enum class Waits : std::int32_t {
    items = 0,
    room = 1,
    servo = 2,
    turn = 3 /**< nothing: call again */
  };

  Planner(const Kinematics& kinematics, SpanRing& spans, FaultRing& faults) noexcept
      : kinematics_(kinematics), spans_(spans), faults_(faults) {}

  /// Limits for the items taken from now on.
  void configure(const MachineConfig& config) noexcept { config_ = config; }
  /// How many outputs and spindles the shell has; larger numbers in items are refused.
  void set_counts(std::int32_t digital, std::int32_t analog, std::int32_t spindles) noexcept {
    digital_ = digital;
    analog_ = analog;
    spindles_ = spindles;
  }

  /// Takes items from `in` while that is possible. Items older than `abort_epoch`, void ones and those behind a refused one
  /// are dropped. Moves are taken only while `view.takes_moves`.
  Waits run(PathRing& in, const ServoView& view, std::uint32_t abort_epoch) noexcept;

 private:
  enum class Take { done, wait_room, wait_servo };
  Take take(const PathItem& item, const ServoView& view) noexcept;
  Take take_move(const PathItem& item, Span& span, Curve& curve, bool shaped, double speed,
                 MotionKind kind, const ProbeMove* probe) noexcept;
  /// A move of any kind: finds the start, or says why not now.
  [[nodiscard]] bool may_move(const ServoView& view) noexcept;
  Take push(Span& span) noexcept;
  Take refuse(const PathItem& item, FaultRecord record) noexcept;
  Take bad_item(const PathItem& item, double value) noexcept;
  Take output_change(const PathItem& item, const OutputChange& change, Span& span) noexcept;
  Take spindle_change(const PathItem& item, const SpindleChange& change, Span& span) noexcept;

  const Kinematics& kinematics_;
  SpanRing& spans_;
  FaultRing& faults_;
  MachineConfig config_{};
  std::int32_t digital_{static_cast<std::int32_t>(kMaxDigital)},
      analog_{static_cast<std::int32_t>(kMaxAnalog)};
  std::int32_t spindles_{static_cast<std::int32_t>(kMaxSpindles)};
  Pose end_;                ///< where the path taken so far leads
  std::uint64_t place_{0};  ///< ServoView::place for which end_ is true
  std::uint32_t refused_epoch_{0};
  bool placed_{false}, refusing_{false};
  bool probing_{false};  ///< moves behind a probe move wait until it has ended, wherever that is
};

}  // namespace kerf::motion
