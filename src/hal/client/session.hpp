// Session: how programs ask the realtime host to change HAL, over the socket or, in the harness, by a call.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>

#include "hal/loader/host.hpp"
#include "hal/loader/protocol.hpp"
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
  /// Where to wait for the host from now on: a stop of the clock ends the wait with `cancelled`. On the virtual clock the waiting
  /// participant holds time. nullptr: waits that only a reply ends.
  virtual void use_clock(rtapi::WaitClock* /*clock*/) noexcept {}
  /// For whoever waits for something that only the host can bring: watch() ends the wait when the host dies, alive() tells.
  virtual void watch(rtapi::WaitSpec& /*spec*/) const noexcept {}
  [[nodiscard]] virtual bool alive() { return true; }
};

/// request() whose refusal is an error too.
rtapi::Result<std::string> ask(Session& session, std::initializer_list<std::string> argv);

/// A connection to an instance's realtime host. When it ends, with the process or before, the host removes its components.
class SocketSession final : public Session {
 public:
  /// dead: nobody listens.
  static rtapi::Result<std::unique_ptr<SocketSession>> connect(rtapi::Segment& segment);
  ~SocketSession() override;
  SocketSession(const SocketSession&) = delete;
  SocketSession& operator=(const SocketSession&) = delete;

  using Session::request;
  rtapi::Result<Reply> request(std::span<const std::string> argv) override;
  /// Sends without waiting for the reply; collect() gives the replies in the order of sending. While the host has no room for more,
  /// replies that come are put by, so that any number of requests can be under way.
  rtapi::Status post(std::span<const std::string> argv);
  /// The reply to the oldest request that has none yet. After `cancelled` that reply is given up: the next collect() is for the
  /// request after it.
  rtapi::Result<Reply> collect();
  [[nodiscard]] rtapi::Segment& segment() override { return segment_; }
  [[nodiscard]] bool local() const noexcept override { return false; }
  void use_clock(rtapi::WaitClock* clock) noexcept override { clock_ = clock; }
  void watch(rtapi::WaitSpec& spec) const noexcept override { spec.watch_fd(fd_); }
  [[nodiscard]] bool alive() override;
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  SocketSession(rtapi::Segment& segment, int fd) : segment_(segment), fd_(fd) {}
  /// Until a reply is there, or, with `room`, until there is room to send.
  rtapi::Status wait(bool room);
  /// Puts by what has come; false when nothing had.
  rtapi::Result<bool> take_replies();
  void notify_host();

  rtapi::Segment& segment_;
  int fd_;
  int room_fd_{
      -1};  ///< an epoll that is readable when the socket has room; WaitSpec knows only readable descriptors
  std::uint32_t next_id_{1};
  std::uint32_t next_reply_{1};
  std::deque<ReplyPacket> replies_;
  rtapi::WaitClock* clock_{nullptr};
  rtapi::Cell* inbox_{nullptr};
};

/// Within the host's process and thread.
class LocalSession final : public Session {
 public:
  explicit LocalSession(Host& host, std::uint64_t client = 0) : host_(host), client_(client) {}
  using Session::request;
  rtapi::Result<Reply> request(std::span<const std::string> argv) override {
    return host_.command(argv, {.client = client_});
  }
  [[nodiscard]] rtapi::Segment& segment() override { return host_.segment(); }
  [[nodiscard]] bool local() const noexcept override { return true; }

 private:
  Host& host_;
  std::uint64_t client_;
};

}  // namespace kerf::hal
