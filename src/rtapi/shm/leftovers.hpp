// Processes that a run of an instance has left behind. Each carries KERF_RUN_ID and KERF_INSTANCE in its environment.
//
// Never among them: the calling process and those it descends from, so that a shell that was started inside a run can clean up
// after it.
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

namespace kerf::rtapi {

/// Processes of this user whose environment has KERF_RUN_ID=run_id, without `except`. Zombies do not count.
std::vector<pid_t> processes_of_run(std::string_view run_id, pid_t except = -1);
/// Those of any run of the instance.
std::vector<pid_t> processes_of_instance(std::string_view instance);

/// Asks them to end, stopped ones too, and after `patience_ms` of real time makes them. Reaps children of this process. Returns
/// when all are gone; gives the names of those that had to be killed.
std::vector<std::string> end_processes_of_run(std::string_view run_id, int patience_ms,
                                              pid_t except = -1);
std::vector<std::string> end_processes_of_instance(std::string_view instance, int patience_ms);

}  // namespace kerf::rtapi
