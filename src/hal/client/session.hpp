// Session: how programs ask the realtime host to change HAL, over the socket or, in the harness, by a call.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hal/loader/host.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal {

class Session {
 public:
  virtual ~Session() = default;
  /// One command, see Host::command. An error here means that the host could not be asked (dead); a refused command is a Reply.
  virtual rtapi::Result<Reply> request(std::span<const std::string> argv) = 0;
  rtapi::Result<Reply> request(std::initializer_list<std::string> argv) {
    return request(std::span<const std::string>(argv.begin(), argv.size()));
  }
  [[nodiscard]] virtual rtapi::Segment& segment() = 0;
  /// True for a session by a call within the host's process, where no child processes are started.
  [[nodiscard]] virtual bool local() const noexcept = 0;
};

/// request() whose refusal is an error too.
rtapi::Result<std::string> ask(Session& session, std::initializer_list<std::string> argv);

/// A connection to an instance's realtime host. When the process dies, the host removes its components.
class SocketSession final : public Session {
 public:
  /// dead: nobody listens.
  static rtapi::Result<std::unique_ptr<SocketSession>> connect(rtapi::Segment& segment);
  ~SocketSession() override;
  SocketSession(const SocketSession&) = delete;
  SocketSession& operator=(const SocketSession&) = delete;

  using Session::request;
  rtapi::Result<Reply> request(std::span<const std::string> argv) override;
  /// Sends without waiting; collect() gives the replies in the order of sending.
  rtapi::Status post(std::span<const std::string> argv);
  rtapi::Result<Reply> collect();
  [[nodiscard]] rtapi::Segment& segment() override { return segment_; }
  [[nodiscard]] bool local() const noexcept override { return false; }
  /// On the virtual clock a participant waits for replies on its own clock, holding time. Without one the wait is a poll().
  void use_clock(rtapi::WaitClock* clock) noexcept { clock_ = clock; }
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  SocketSession(rtapi::Segment& segment, int fd) : segment_(segment), fd_(fd) {}
  void wait_readable(bool writable);
  rtapi::Segment& segment_;
  int fd_;
  std::uint32_t next_id_{1};
  rtapi::WaitClock* clock_{nullptr};
};

/// Within the host's process and thread.
class LocalSession final : public Session {
 public:
  explicit LocalSession(Host& host, std::uint64_t client = 0) : host_(host), client_(client) {}
  using Session::request;
  rtapi::Result<Reply> request(std::span<const std::string> argv) override {
    return host_.command(argv, client_, 0);
  }
  [[nodiscard]] rtapi::Segment& segment() override { return host_.segment(); }
  [[nodiscard]] bool local() const noexcept override { return true; }

 private:
  Host& host_;
  std::uint64_t client_;
};

}  // namespace kerf::hal
