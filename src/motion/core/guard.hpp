// Guard: checks every joint's commanded motion in every cycle against its limits, by differences. @rt.
#pragma once

#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/core/io.hpp"
#include "motion/core/joint.hpp"

namespace kerf::motion {

/// The oracle. By the mean value theorem differences of a correct motion never pass its limits; the
/// allowances are for rounding only. It reports the first break after each enable, and nothing more until the next. A jump is not let through.
class Guard {
 public:
  static constexpr double kVelocityAllowance = 1.0001;
  static constexpr double kAccelerationAllowance = 1.001;
  static constexpr double kJerkAllowance = 1.01;
  /// A change of speed within a cycle by so many times the largest speed is a jump: no motion leads there, so nobody has sent the joint there.
  static constexpr double kJump = 4;

  /// Forgets the latched break; the present positions are taken as at rest.
  void reset(std::size_t joints, Joint* state) noexcept;
  /// The positions may jump in this cycle (disabled, following feedback).
  void follow(std::size_t joints, Joint* state) noexcept;
  /// Fills in vel_cmd, acc_cmd and jerk_cmd, then checks.
  /// `led`: bits of joints whose jerk is not judged, since a spindle or a pin leads them; `may_jump`: of those that something else than motion may
  /// place. False: one that may not would have jumped; it was left where it is, and the drives have to go off.
  [[nodiscard]] bool check(std::size_t joints, Joint* state, const MachineConfig& config, double dt,
                           std::uint32_t led, std::uint32_t may_jump, const SourceTag& tag,
                           FaultList& faults) noexcept;
  [[nodiscard]] bool broken() const noexcept { return broken_; }

 private:
  bool broken_{false};
};

}  // namespace kerf::motion
