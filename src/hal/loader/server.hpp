// Server: the instance's "hal" socket. Hands requests to the Host and never waits for a client.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "hal/loader/host.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

class Server {
 public:
  static constexpr std::size_t kMostClients = 60;  ///< WaitSpec has room for 64 descriptors
  static constexpr std::size_t kMostUnread =
      4096;  ///< replies kept for a client that does not read; then it is cut off

  /// Listens, and makes the inbox cell that clients notify. exists: the instance has a realtime host already.
  static rtapi::Result<std::unique_ptr<Server>> open(Host& host, rtapi::Segment& segment,
                                                     const std::string& instance);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Does all that clients have asked for so far. True when there was something.
  bool serve();
  /// serve() until nothing is left, or until other work of the host must have its turn (false).
  bool serve_all();
  /// What to wait for until serve() has work again.
  void watch(rtapi::Nanos now, rtapi::WaitSpec& spec) const;
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

 private:
  struct Client {
    int fd;
    std::uint64_t number;
    std::int64_t pid;
    std::deque<std::string> unsent;
  };
  Server(Host& host, int listener, rtapi::Cell* inbox)
      : host_(host), listener_(listener), inbox_(inbox) {}
  bool accept_new();
  /// False: the client is gone.
  bool serve_client(Client& client, bool& worked);
  static bool flush(Client& client);

  Host& host_;
  int listener_;
  rtapi::Cell* inbox_;
  std::uint64_t inbox_seen_{0};
  std::uint64_t next_number_{1};
  std::vector<std::unique_ptr<Client>> clients_;
};

}  // namespace kerf::hal
