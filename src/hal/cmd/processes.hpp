// Programs that loadusr starts.
#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <string_view>

#include "rtapi/base/result.hpp"

namespace kerf::rtapi {
class Segment;
}

namespace kerf::hal {

/// Starts argv[0], searched in PATH, in a process group of its own with KERF_INSTANCE and KERF_RUN_ID in its environment. On the
/// virtual clock its sleeps become virtual (libkerf_time.so is preloaded; Kerf's own programs join the clock themselves).
/// not_found when it could not be executed.
rtapi::Result<pid_t> start_program(std::span<const std::string> argv,
                                   const rtapi::Segment& segment);

/// Exit status of a child that has ended (128 + signal number for a signal), or -1 while it runs.
int child_status(pid_t pid);

}  // namespace kerf::hal
