// Processes that a run of an instance has left behind.
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

namespace kerf::hal {

/// Processes of this user whose environment has KERF_RUN_ID=run_id, without this one. Zombies do not count.
std::vector<pid_t> processes_of_run(std::string_view run_id);

/// Asks them to end, and after `patience_ms` makes them. Returns when all are gone; gives how many had to be killed.
int end_processes_of_run(std::string_view run_id, int patience_ms);

}  // namespace kerf::hal
