// Texts of motion's numbered faults, for operators.
#pragma once

#include <string>

#include "motion/api/status.hpp"
#include "task/machine_config.hpp"

namespace kerf::task {

/// One line: what happened, to which joint, axis or spindle, the value and the limit in machine units.
[[nodiscard]] std::string fault_text(const motion::FaultRecord& fault, const MachineSetup& setup);
/// True for faults after which a running program cannot go on.
[[nodiscard]] bool ends_program(motion::Fault fault) noexcept;

}  // namespace kerf::task
