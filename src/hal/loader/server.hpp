// Server: the instance's "hal" socket. Hands requests to the Host and never waits for a client.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hal/loader/host.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::hal {

/// Any number of clients, as far as descriptors go. Each has its turn: a few requests, then the next. Nobody is cut off for not
/// reading; a client with many unread replies is not read from until it has taken some.
class Server {
 public:
  /// Listens, and makes the inbox cell that clients notify. exists: the instance has a realtime host already.
  static rtapi::Result<std::unique_ptr<Server>> open(Host& host, rtapi::Segment& segment,
                                                     const std::string& instance);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// A turn for everybody who has asked for something. True when there was something.
  bool serve();
  /// serve() until nothing is left, or until other work of the host must have its turn (false).
  bool serve_all();
  /// Called between each command and its reply: what a command printed through a ring is out before its client reads that the
  /// command is done, and goes on (or ends the run).
  void before_reply(std::function<void()> hook) { before_reply_ = std::move(hook); }
  /// A client has sent something since serve() was here last. Others may send without telling.
  [[nodiscard]] bool was_told() const noexcept;
  /// What to wait for until serve() has work again.
  void watch(rtapi::Nanos now, rtapi::WaitSpec& spec) const;
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

 private:
  /// A process that has connected, until it is gone and all its connections are closed: only then does nobody hold addresses of
  /// the segment that it was given (a forked child may go on with a connection).
  struct Process {
    std::uint64_t number;
    std::int64_t pid;
    int pidfd;  ///< -1: gone
    int connections;
  };
  struct Client {
    int fd;
    std::uint64_t number;
    std::uint64_t process;
    std::deque<std::string> unsent;
    std::size_t unsent_bytes{0};
    unsigned watched{0};
  };
  Server(Host& host, int listener, rtapi::Cell* inbox, rtapi::Epoll epoll)
      : host_(host), listener_(listener), inbox_(inbox), epoll_(std::move(epoll)) {}
  void accept_new(int& budget);
  void pause_listener(bool paused);
  /// Requests that it may have done in this turn; false: the client is gone.
  bool serve_client(Client& client, int& budget);
  bool flush(Client& client);
  void watch_client(Client& client);
  void drop_client(std::uint64_t number);
  Process& process_of(int fd);
  void look_at_process(std::uint64_t number);
  bool serve_within(int& budget);

  Host& host_;
  int listener_;
  rtapi::Cell* inbox_;
  rtapi::Epoll epoll_;
  std::uint64_t inbox_seen_{0};
  std::uint64_t next_number_{1};
  std::uint64_t last_served_{0};
  bool listener_paused_{false};  ///< no descriptors left
  bool accept_failed_{false};    ///< and that has been said
  std::function<void()> before_reply_;
  std::map<std::uint64_t, Client> clients_;
  std::map<std::uint64_t, Process> processes_;
};

}  // namespace kerf::hal
