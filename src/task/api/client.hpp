// Client: how any process talks to task. Single-threaded; nothing here blocks but wait().
//
//   auto client = task::Client::connect(segment);
//   if (!client.ok()) ...
//   const auto id = (*client)->send({"mdi", "G0 X10"});
//   const auto outcome = (*client)->wait(*id, clock);          // or, in a Participant: poll(), outcome(), add_to(spec)
//   for (const auto& m : (*client)->new_messages()) std::fprintf(stderr, "%s\n", m.text.c_str());
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/sync/patient_read.hpp"
#include "task/api/protocol.hpp"
#include "task/api/status.hpp"

namespace kerf::task {

class Client {
 public:
  /// Connects to the task of the segment's instance. not_found: task does not run (yet); protocol: another build made it.
  [[nodiscard]] static rtapi::Result<std::unique_ptr<Client>> connect(rtapi::Segment& segment);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Sends a command given as words ({"mdi", "G0 X1"}, {"jog", "x", "speed=10"}); gives its id. bad_argument: the words do not fit
  /// the table (nothing was sent); busy: task does not take packets; dead: the connection has ended.
  rtapi::Result<std::uint64_t> send(const std::vector<std::string>& words);
  /// Sends a whole request; its "id" must come from next_id().
  rtapi::Status send_json(const std::string& json);
  /// Unique among all clients of the instance, and growing.
  [[nodiscard]] std::uint64_t next_id() noexcept { return shared_->serials.add(1); }

  /// Takes in all replies that are there. dead: task has closed the connection; commands in progress are then `error`.
  rtapi::Status poll();
  /// The newest reply to a command, or nothing. Terminal ones are kept until forget() (the last 1000).
  [[nodiscard]] std::optional<Reply> outcome(std::uint64_t id) const;
  [[nodiscard]] bool finished(std::uint64_t id) const;
  void forget(std::uint64_t id) { replies_.erase(id); }
  /// Waits until the command has its terminal outcome or `limit` (instance time) has come: error `busy`.
  rtapi::Result<Reply> wait(std::uint64_t id, rtapi::WaitClock& clock,
                            rtapi::Nanos limit = rtapi::kForever);

  /// What to wait for so as to be woken by replies and by status changes. Call it before poll().
  void add_to(rtapi::WaitSpec& spec) const;
  /// By replies only.
  void add_replies_to(rtapi::WaitSpec& spec) const;

  /// False when task died in the middle of a write.
  [[nodiscard]] bool status(TaskStatus& out) const {
    return rtapi::read_patiently(shared_->status, out);
  }
  /// Messages since the last call (since connecting, at first); `lost` says how many had been overwritten.
  [[nodiscard]] std::vector<OperatorMessage> new_messages(std::uint64_t* lost = nullptr);
  [[nodiscard]] bool connected() const noexcept { return fd_ >= 0; }
  [[nodiscard]] int fd() const noexcept { return fd_; }
  [[nodiscard]] const TaskShared& shared() const noexcept { return *shared_; }

 private:
  Client() = default;
  void end_connection(const char* why);

  TaskShared* shared_{nullptr};
  int fd_{-1};
  std::uint64_t cursor_{0};
  std::map<std::uint64_t, Reply> replies_;
};

}  // namespace kerf::task
