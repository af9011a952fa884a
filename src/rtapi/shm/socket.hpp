// Packet sockets between the processes of an instance: SOCK_SEQPACKET in the abstract namespace, so nothing is left behind
// and the end of a process is an end of file at its peers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rtapi/base/result.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {

class Segment;

/// Largest packet that is sent or received.
inline constexpr std::size_t kMaxPacket = 192U << 10U;

/// All descriptors are non-blocking and close-on-exec. `address` comes from socket_name().
Result<int> listen_seqpacket(const std::string& address);
Result<int> connect_seqpacket(const std::string& address);
/// nullopt: nobody waits to be accepted.
Result<std::optional<int>> accept_seqpacket(int listener);
/// busy: the peer does not read (try later); dead: it is gone.
Status send_packet(int fd, std::string_view packet);
/// nullopt: nothing there at present; dead: closed by the peer.
Result<std::optional<std::string>> receive_packet(int fd);
/// 0 when unknown.
std::int64_t peer_pid(int fd);
void close_fd(int fd) noexcept;

/// A descriptor that becomes readable when the process ends; -1 when there is no such process.
int open_pidfd(std::int64_t pid) noexcept;
[[nodiscard]] bool is_readable(int fd) noexcept;
/// A descriptor that is readable while `fd` has room to send.
Result<int> open_room_watch(int fd);

/// Any number of descriptors behind one, which is readable when one of them is ready: a WaitSpec has room for 64 only.
class Epoll {
 public:
  enum What : unsigned { readable = 1, writable = 2 };
  static Result<Epoll> open();
  Epoll() = default;
  ~Epoll() { close_fd(fd_); }
  Epoll(Epoll&& other) noexcept : fd_(other.release()) {}
  Epoll& operator=(Epoll&& other) noexcept {
    if (this != &other) {
      close_fd(fd_);
      fd_ = other.release();
    }
    return *this;
  }
  Epoll(const Epoll&) = delete;
  Epoll& operator=(const Epoll&) = delete;

  [[nodiscard]] int fd() const noexcept { return fd_; }
  int release() noexcept { return std::exchange(fd_, -1); }
  /// `tag` comes back from ready(). The end of the other side makes a descriptor ready whatever is watched.
  Status add(int fd, std::uint64_t tag, unsigned what);
  void change(int fd, std::uint64_t tag, unsigned what) noexcept;
  void remove(int fd) noexcept;
  /// Tags of those that are ready now, `most` at most. Never waits.
  [[nodiscard]] std::vector<std::uint64_t> ready(std::size_t most) const;

 private:
  int fd_{-1};
};

/// Cell that whoever sends to a service notifies after sending, so that on the virtual clock the service runs at the same
/// instant. The service makes it; nullptr from find_inbox when it did not (yet).
Result<Cell*> make_inbox(Segment& segment, std::string_view service);
Cell* find_inbox(Segment& segment, std::string_view service);
/// A cell with a name of its own in the segment; made on first use, by a process that may make blocks.
Result<Cell*> make_cell(Segment& segment, const std::string& name);

}  // namespace kerf::rtapi
