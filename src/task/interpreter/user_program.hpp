// UserProgram: one run of a user's M100-M199 program.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::rtapi {
class Segment;
}

namespace kerf::task {

/// A child process in a process group of its own, so that what it starts ends with it on abort. Its standard error is kept
/// (the last 4 KiB) for the operator's message and goes on to ours when it ends. Nothing blocks.
class UserProgram {
 public:
  struct Exit {
    int status{0};           ///< exit code, or 128 + signal
    std::string error_text;  ///< what it wrote to standard error, trimmed
  };

  UserProgram() = default;
  /// Kills a program that still runs, with its group.
  ~UserProgram();
  UserProgram(const UserProgram&) = delete;
  UserProgram& operator=(const UserProgram&) = delete;

  /// Starts `path` with `arguments`; `environment` (NAME, value) is added to our own.
  rtapi::Status start(const std::string& path, const std::vector<std::string>& arguments,
                      const std::vector<std::pair<std::string, std::string>>& environment);
  [[nodiscard]] bool running() const noexcept { return pid_ > 0; }
  /// Its end, once; nothing while it runs.
  std::optional<Exit> poll();
  /// Asks the group to end; poll() kills it when it has not within 200 ms of real time (the program lives outside of
  /// virtual time).
  void terminate();
  /// Wakes the waiter at its end. Virtual time stands still meanwhile, unless the program itself waits in it (`halcmd sleep S`).
  void add_to(rtapi::WaitSpec& spec, const rtapi::Segment& segment) const;

 private:
  void close_all();

  pid_t pid_{0};
  int pidfd_{-1};
  int error_fd_{-1};  ///< memfd
  int grace_fd_{-1};  ///< timerfd, once terminate() was called
};

}  // namespace kerf::task
