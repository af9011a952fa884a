// TaskLink: commands to task, one after the other, and the operator's messages meanwhile.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "launcher/console.hpp"
#include "launcher/supervised_clock.hpp"
#include "rtapi/base/result.hpp"
#include "task/api/client.hpp"

namespace kerf::launcher {

class TaskLink {
 public:
  TaskLink(SupervisedClock& clock, Console& console) : clock_(clock), console_(console) {}

  rtapi::Status connect(rtapi::Segment& segment);
  [[nodiscard]] bool connected() const { return client_ != nullptr && client_->connected(); }

  /// Sends and waits for the outcome. An outcome that is not `done` is an error with its text; cancelled: the machine is being
  /// taken down. `while_waiting` is called at each wake-up, at least every `every` of instance time.
  rtapi::Status perform(const std::vector<std::string>& words,
                        const std::function<void()>& while_waiting = {},
                        rtapi::Nanos every = rtapi::kForever);
  /// Sends; what comes of it is seen in the messages only.
  rtapi::Status send(const std::vector<std::string>& words);

  /// What an idle launcher waits for: messages and the end of the connection.
  void add_to(rtapi::WaitSpec& spec) const;

  /// Shows messages that have come.
  void show_messages();
  /// True when an error with this text, or with its place before this text, was shown already.
  [[nodiscard]] bool was_shown(const std::string& text) const;
  [[nodiscard]] bool status(task::TaskStatus& out) const { return client_->status(out); }
  [[nodiscard]] task::Client& client() { return *client_; }
  void close() { client_.reset(); }

 private:
  SupervisedClock& clock_;
  Console& console_;
  std::unique_ptr<task::Client> client_;
  std::set<std::string> shown_;  ///< errors since the last command was sent
  std::string last_error_;
};

}  // namespace kerf::launcher
