// Facts about processes, told apart from later ones that got the same number.
#pragma once

#include <cstdint>
#include <string>

namespace kerf::rtapi {

/// What the file /proc/PID/`file` says ("stat", "environ"); empty when the process is gone or is another user's. C++ streams throw when
/// a process ends between the opening and the reading of its file.
std::string read_process_file(std::int64_t pid, const char* file);
/// Start time in clock ticks since boot; 0 when there is no such process.
std::uint64_t process_start_time(std::int64_t pid);
/// True while that process lives; a zombie is dead. `start` 0: any process with that number.
bool process_lives(std::int64_t pid, std::uint64_t start);
/// 0 when there is no such process.
std::int64_t parent_of(std::int64_t pid);
/// Command name, or "gone".
std::string process_name(std::int64_t pid);

}  // namespace kerf::rtapi
