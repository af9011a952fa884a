// ToolDatabase: the program of [EMCIO]DB_PROGRAM, which keeps the tools (manual: "Tool Database Interface").
//
//   Kerf                      program
//                        <-   v2.1                       one line at its start
//   g                    ->
//                        <-   T10 P10 D6.0 Z12.5 ;...    a line a tool, as in a tool table file
//                        <-   FINI
//   p T10 P10 Z12.6 D6   ->                              G10 L1, L10, L11: the whole line
//   l T10 P0             ->                              T10 in the spindle; u T0 P0: nothing is
//                        <-   anything                   one line for each p, l and u; with NAK in it, the operator is told
//
// Questions (`g`) wait for their answer, tellings never do: their answers are taken by pump(). So a program that hangs or dies costs
// the machine nothing but its messages.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "rtapi/base/result.hpp"

namespace kerf::io {

class ToolDatabase {
 public:
  struct Options {
    std::string
        command;  ///< the program and its arguments, separated by blanks; the program from `folder`, or from PATH
    std::string folder;    ///< that it runs in: the INI file's
    std::string instance;  ///< KERF_INSTANCE for it; "" leaves it as it is
    int timeout_ms{5000};  ///< for each line of an answer; real time
  };

  /// Runs it and takes its version. not_found: there is no such program.
  [[nodiscard]] static rtapi::Result<std::unique_ptr<ToolDatabase>> start(const Options& options);
  /// Ends the program: end of its input, then SIGTERM, then SIGKILL, half a second in all.
  ~ToolDatabase();
  ToolDatabase(const ToolDatabase&) = delete;
  ToolDatabase& operator=(const ToolDatabase&) = delete;

  /// All tools, as the text of a tool table file. Waits; not for the command thread.
  [[nodiscard]] rtapi::Result<std::string> get();
  /// "p T1 ...", "l T1 P0", "u T0 P0". Never waits.
  void tell(std::string line);
  /// Takes answers and gives what the operator must know since the last call. Never waits.
  [[nodiscard]] std::vector<std::string> pump();
  /// Readable when pump() has something to do; -1 when it has ended.
  [[nodiscard]] int answer_fd() const { return socket_; }
  [[nodiscard]] int timer_fd() const { return timer_; }
  [[nodiscard]] bool running() const { return socket_ >= 0; }

 private:
  ToolDatabase() = default;
  rtapi::Status spawn(const Options& options);
  /// The next line; nothing that is no line within the time.
  [[nodiscard]] rtapi::Result<std::string> read_line();
  bool send_waiting();
  void receive();
  void take_answer(const std::string& line);
  void set_timer(bool on);
  /// It has ended; why.
  std::string gone();
  [[nodiscard]] rtapi::Failure<rtapi::Error> failure(const std::string& what) const;

  std::string name_;
  int timeout_ms_{5000};
  bool trace_{false};  ///< environment variable DB_DEBUG
  int pid_{0}, socket_{-1}, timer_{-1};
  std::mutex link_;  ///< for all that talks to the program
  std::string received_;
  std::size_t unanswered_{0};
  std::vector<std::string> complaints_;
  std::mutex queue_;  ///< for waiting_ only
  std::deque<std::string> waiting_;
};

}  // namespace kerf::io
