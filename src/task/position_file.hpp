// [TRAJ]POSITION_FILE: where the joints were when the machine went off, one number a line in the joint's own unit.
#pragma once

#include <string>

#include "motion/api/status.hpp"
#include "rtapi/base/result.hpp"
#include "task/machine_config.hpp"

namespace kerf::task {

/// Sets JointConfig::start of each joint. No file yet: nothing, and no error. A file that does not fit: an error, and no
/// joint gets a position.
[[nodiscard]] rtapi::Status load_positions(const std::string& file, MachineSetup& setup);

[[nodiscard]] rtapi::Status save_positions(const std::string& file, const MachineSetup& setup,
                                           const motion::MotionStatus& status);

}  // namespace kerf::task
