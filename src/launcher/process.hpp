// Child processes of the launcher. Whatever else runs for an instance: rtapi/shm/leftovers.hpp.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::launcher {

/// How a process ended.
struct ExitState {
  bool by_signal{false};
  int number{0};  ///< exit code or signal
};

/// "ended with exit code 3", "was killed by signal 9 (Killed)".
[[nodiscard]] std::string describe_exit(const ExitState& state);

/// Of a child.
struct Surroundings {
  bool terminal{false};             ///< of the launcher; else its input comes from /dev/null
  std::string output{};             ///< file for its standard output; empty: the launcher's
  const cpu_set_t* cores{nullptr};  ///< nullptr: the launcher's
};

/// One child process in a process group of its own, so that Ctrl-C at the terminal reaches the launcher only. A child at the
/// terminal stays in the launcher's group: others may not read there.
class Child {
 public:
  /// Looks for the program as execvp does.
  [[nodiscard]] static rtapi::Result<Child> start(const std::vector<std::string>& words,
                                                  const Surroundings& around = {});
  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;
  /// Does not end the process.
  ~Child();

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] pid_t pid() const { return pid_; }
  /// Readable when the process has ended.
  [[nodiscard]] int pidfd() const { return pidfd_; }
  /// Nothing while it runs. Reaps it.
  [[nodiscard]] std::optional<ExitState> poll_exit();
  [[nodiscard]] bool running() { return !poll_exit().has_value(); }
  /// To its whole process group, but that of the launcher.
  void signal(int number);

 private:
  Child() = default;
  std::string name_;
  bool own_group_{true};
  pid_t pid_{-1};
  int pidfd_{-1};
  std::optional<ExitState> exit_;
};

/// Full path of a program found by PATH, or by itself when it has a slash; "" when it cannot be executed.
[[nodiscard]] std::string find_program(const std::string& name);

/// Waits `ms` of real time.
void pause_ms(int ms);

}  // namespace kerf::launcher
