// Mills: the machines of a soak, the sample one and random ones that run the same programs.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::soak {

/// mm, degrees and seconds; 0: no limit.
struct MotionLimits {
  double vel{0}, acc{0}, jerk{0};
  double low{0}, high{0};
};

struct Mill {
  std::string name;
  harness::MachineOptions options;
  std::vector<MotionLimits> joints;
  std::array<MotionLimits, 3> axes;  ///< of X, Y and Z, outside joint mode
  std::string letters;               ///< of its axes, each once
  std::string joint_letters;         ///< of the axes that the joints move; empty: some move several
  double max_vel{120};               ///< [TRAJ]MAX_LINEAR_VELOCITY
  /// Joints without switches are told where they are: homing twice is no measurement.
  bool has_switches{true};
  /// Limit and amplifier inputs and wheels are nobody's: the soak may set them.
  bool has_free_pins{false};
  /// The longest that a joint takes to stand.
  [[nodiscard]] double stop_s() const;
};

/// configs/sim/mill; `max_jerk`: of all joints, 0 none.
[[nodiscard]] Mill sample_mill(double max_jerk);

/// Kinematics, units, servo period and limits by chance. Its files are written into `folder`, which must outlive the machine's start.
[[nodiscard]] Mill random_mill(std::uint64_t seed, const std::filesystem::path& folder);

}  // namespace kerf::soak
