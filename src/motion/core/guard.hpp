// Guard: checks every joint's commanded motion in every cycle against its limits, by differences. @rt.
#pragma once

#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/core/io.hpp"
#include "motion/core/joint.hpp"

namespace kerf::motion {

/// The oracle. By the mean value theorem differences of a correct motion never pass its limits; the
/// allowances are for rounding only. It reports the first break after each enable, and nothing more until the next.
class Guard {
 public:
  static constexpr double kVelocityAllowance = 1.0001;
  static constexpr double kAccelerationAllowance = 1.001;
  static constexpr double kJerkAllowance = 1.01;

  /// Forgets the latched break; the present positions are taken as at rest.
  void reset(std::size_t joints, Joint* state) noexcept;
  /// The positions may jump in this cycle (disabled, following feedback).
  void follow(std::size_t joints, Joint* state) noexcept;
  /// Fills in vel_cmd, acc_cmd and jerk_cmd, then checks.
  /// `led`: bits of joints whose jerk is not judged, since a spindle or a pin leads them.
  void check(std::size_t joints, Joint* state, const MachineConfig& config, double dt,
             std::uint32_t led, const SourceTag& tag, FaultList& faults) noexcept;
  [[nodiscard]] bool broken() const noexcept { return broken_; }

 private:
  bool broken_{false};
};

}  // namespace kerf::motion
