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

/// A child process in a process group of its own, so that what it starts ends with it on abort. Its standard error is read as
/// it comes; the last 4 KiB are kept for the operator's message and go on to ours at its end: however much it prints,
/// nothing grows. What it leaves in the background may go on writing there. Nothing blocks.
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
  /// Reads what has been written to standard error; call it in each step.
  void drain();
  /// Wakes the waiter at its end, and when there is something to drain. Virtual time stands still meanwhile, unless the
  /// program itself waits in it (`halcmd sleep S`).
  void add_to(rtapi::WaitSpec& spec, const rtapi::Segment& segment) const;

 private:
  /// Pipes of that many programs' background processes are read on; the oldest is then closed.
  static constexpr std::size_t kMostLeft = 4;

  void close_all();
  /// False at its end. `tail`: where the last words are kept, or null.
  static bool read_some(int fd, std::string* tail);

  pid_t pid_{0};
  int pidfd_{-1};
  int error_fd_{-1};  ///< a pipe's end
  int grace_fd_{-1};  ///< timerfd, once terminate() was called
  std::string last_words_;
  std::vector<int> left_;  ///< pipes that background processes of ended programs hold
};

}  // namespace kerf::task
