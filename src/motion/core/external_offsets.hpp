// External offsets: what the pins axis.L.eoffset-* add to the position of an axis, beside path and jogs. A layer of its own, limited by its own
// share of the axis' velocity, acceleration and jerk ([AXIS_L]OFFSET_AV_RATIO); path and jogs have the rest. Pure arithmetic, @rt.
//
// Soft limits hold for the sum. An offset keeps as much of what is asked for as fits; where it cannot give way as fast as the path comes,
// the path (or the jog) has to stand until there is room. LinuxCNC's manual, "External Axis Offsets".
#pragma once

#include <array>

#include "motion/api/config.hpp"
#include "motion/core/axis_mover.hpp"
#include "motion/core/io.hpp"
#include "motion/core/offset_pace.hpp"

namespace kerf::motion {

class ExternalOffsets {
 public:
  /// `limits`: of each axis and of the joints that it moves alone, before anything is shared.
  void configure(const AxisConfig* limits, std::uint32_t axes) noexcept;
  /// All offsets and requests are 0; where the machine stands is taken as its position without them.
  void reset() noexcept;
  /// Drives off: everything stands where it stands.
  void stop_dead() noexcept;
  /// Brakes; nothing begins again before reset().
  void stop() noexcept { stopping_ = true; }
  [[nodiscard]] bool at_rest() const noexcept;

  /// Reads the pins. While offsets are not honoured (not homed, joint mode, off) counts are lost.
  void take(const OffsetInputs* in, bool honoured) noexcept;
  /// Before the path moves: where it is, where it was a cycle ago, what it can brake with. Gives the axes (a bit each) that may not
  /// go on in the direction in which they move, since the sum would pass a soft limit.
  [[nodiscard]] std::uint32_t blocked(const Pose& path, const Pose& before, double dt) noexcept;
  /// Where joints mix axes, before each step: what OffsetPace is asked with, of all that may move, so that none is in the way of one that begins
  /// later (all 0 while all rest), and what it answers.
  [[nodiscard]] std::array<OffsetPace::Limits, rtapi::kAxes> in_use() const noexcept;
  void set_pace(const OffsetPace& pace) noexcept;
  /// One cycle, after the path has moved to `path`. `ahead`: where the move in execution leads.
  void step(const Pose& path, const Pose& ahead, double dt) noexcept;

  /// What is added now.
  [[nodiscard]] const Pose& pose() const noexcept { return pose_; }
  [[nodiscard]] double request(std::size_t axis) const noexcept { return axis_[axis].request; }
  [[nodiscard]] bool active() const noexcept;
  [[nodiscard]] bool limited() const noexcept { return limited_; }

 private:
  struct Axis {
    AxisMover mover;
    double request{0};
    std::int32_t counts{0};  ///< of the last cycle
    bool known{false};       ///< there was a last cycle
    bool enabled{false};
    OffsetPace::Limits limit;          ///< of the offset, before pace; vel 0: none on this axis
    double path_acc{0}, path_jerk{0};  ///< what is left to path and jogs
    double low{0}, high{0};
  };
  [[nodiscard]] bool outward(const Axis& a, double path, double speed, double brake_acc,
                             double brake_jerk, double dt) const noexcept;

  Axis axis_[rtapi::kAxes];
  Pose pose_;
  OffsetPace pace_;
  std::uint32_t held_{0};  ///< axes of which the path has to stand until the offset has made room
  bool stopping_{false}, limited_{false};
  bool possible_{false};  ///< some axis has a share of its limits for one
};

}  // namespace kerf::motion
