// Guard: a small process that cleans up when the launcher itself is killed.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "launcher/safe_state.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::launcher {

/// Waits for the launcher's end. If that came without release(), it switches the machine off, sets the declared safe state (with a
/// dead realtime process by [SAFE_STATE]COMMAND), ends all processes of the run and removes the segment's name. Sockets need no care: they are in the abstract namespace.
class Guard {
 public:
  Guard() = default;
  ~Guard() { release(); }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  /// Forks; call it while the process has one thread. `close_fd`: a descriptor that must not live on in the guard.
  rtapi::Status start(const std::string& instance, const std::string& run_id, int close_fd,
                      const std::vector<SafePin>& safe_pins,
                      const std::vector<std::vector<std::string>>& safe_commands);
  /// All is cleaned up: the guard has nothing to do any more. Waits for its end.
  void release();
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  pid_t pid_{-1};
  int fd_{-1};
};

}  // namespace kerf::launcher
