#include "rtapi/shm/socket.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "rtapi/shm/abstract_address.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::rtapi {

namespace {

/// As many may connect at once; on the virtual clock a connect() that waits would keep the host from accepting.
constexpr int kBacklog = 4096;

/// Abstract addresses have no file rights: only this user and root may be at the other end.
bool peer_is_trusted(int fd) {
  ucred peer{};
  socklen_t length = sizeof peer;
  return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 &&
         (peer.uid == geteuid() || peer.uid == 0);
}

Failure<Error> system_error(const std::string& what) {
  return fail(Errc::system, what + ": " + std::strerror(errno));
}

}  // namespace

Result<int> listen_seqpacket(const std::string& address) {
  const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return system_error("cannot make a socket");
  sockaddr_un sun{};
  const socklen_t length = abstract_address(address, sun);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&sun), length) != 0 || listen(fd, kBacklog) != 0) {
    const auto error = system_error("cannot listen on @" + address);
    close(fd);
    return error;
  }
  return fd;
}

Result<int> connect_seqpacket(const std::string& address) {
  const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (fd < 0) return system_error("cannot make a socket");
  const int bytes = static_cast<int>(2 * kMaxPacket);
  (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  sockaddr_un sun{};
  const socklen_t length = abstract_address(address, sun);
  // connect() on a Unix socket is done at once or waits for room in the backlog only.
  if (connect(fd, reinterpret_cast<const sockaddr*>(&sun), length) != 0) {
    const int error = errno;
    close(fd);
    errno = error;
    if (error == ECONNREFUSED || error == ENOENT)
      return fail(Errc::not_found, "nobody listens on @" + address);
    return system_error("cannot connect to @" + address);
  }
  if (!peer_is_trusted(fd)) {
    close(fd);
    return fail(Errc::permission, "another user listens on @" + address);
  }
  (void)fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
  return fd;
}

Result<std::optional<int>> accept_seqpacket(int listener) {
  // accept4() makes a socket before it looks whether anybody waits: twenty times the time of a look.
  if (!is_readable(listener)) return std::optional<int>();
  const int fd = accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (fd >= 0 && !peer_is_trusted(fd)) {
    close(fd);
    return std::optional<int>();
  }
  if (fd >= 0) {
    const int bytes = static_cast<int>(2 * kMaxPacket);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    return std::optional<int>(fd);
  }
  if (errno == EAGAIN || errno == ECONNABORTED || errno == EINTR) return std::optional<int>();
  return system_error("cannot accept a client");
}

Status send_packet(int fd, std::string_view packet) {
  if (packet.size() > kMaxPacket) return fail(Errc::bad_argument, "packet of more than 192 KiB");
  for (;;) {
    const ssize_t n = send(fd, packet.data(), packet.size(), MSG_NOSIGNAL);
    if (n >= 0) return {};
    if (errno == EINTR) continue;
    if (errno == EAGAIN) return fail(Errc::busy, "the other side does not read");
    if (errno == EPIPE || errno == ECONNRESET || errno == ENOTCONN)
      return fail(Errc::dead, "the other side is gone");
    return system_error("cannot send");
  }
}

Result<std::optional<std::string>> receive_packet(int fd) {
  static thread_local std::string buffer(kMaxPacket, '\0');
  for (;;) {
    // MSG_TRUNC gives the length that was sent: half a packet must never pass for a whole one.
    const ssize_t n = recv(fd, buffer.data(), buffer.size(), MSG_DONTWAIT | MSG_TRUNC);
    if (n > static_cast<ssize_t>(buffer.size()))
      return fail(Errc::protocol, "packet of more than 192 KiB");
    if (n > 0)
      return std::optional<std::string>(std::string(buffer.data(), static_cast<std::size_t>(n)));
    if (n == 0) return fail(Errc::dead, "the other side is gone");
    if (errno == EINTR) continue;
    if (errno == EAGAIN) return std::optional<std::string>();
    if (errno == ECONNRESET || errno == ENOTCONN) return fail(Errc::dead, "the other side is gone");
    return system_error("cannot receive");
  }
}

std::int64_t peer_pid(int fd) {
  ucred credentials{};
  socklen_t length = sizeof credentials;
  return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &credentials, &length) == 0 ? credentials.pid : 0;
}

int open_pidfd(std::int64_t pid) noexcept {
  if (pid <= 0) return -1;
  return static_cast<int>(syscall(SYS_pidfd_open, static_cast<pid_t>(pid), 0));
}

bool is_readable(int fd) noexcept {
  pollfd p{fd, POLLIN, 0};
  return fd >= 0 && poll(&p, 1, 0) > 0;
}

Result<int> open_room_watch(int fd) {
  Epoll epoll;
  KERF_TRY(epoll, Epoll::open());
  KERF_CHECK(epoll.add(fd, 0, Epoll::writable));
  return epoll.release();
}

Result<Epoll> Epoll::open() {
  Epoll epoll;
  epoll.fd_ = epoll_create1(EPOLL_CLOEXEC);
  if (epoll.fd_ < 0) return system_error("cannot make an epoll");
  return epoll;
}

namespace {
epoll_event event_of(std::uint64_t tag, unsigned what) {
  epoll_event event{};
  event.events = ((what & Epoll::readable) != 0U ? EPOLLIN : 0U) |
                 ((what & Epoll::writable) != 0U ? EPOLLOUT : 0U);
  event.data.u64 = tag;
  return event;
}
}  // namespace

Status Epoll::add(int fd, std::uint64_t tag, unsigned what) {
  epoll_event event = event_of(tag, what);
  if (epoll_ctl(fd_, EPOLL_CTL_ADD, fd, &event) != 0) return system_error("cannot watch");
  return {};
}

void Epoll::change(int fd, std::uint64_t tag, unsigned what) noexcept {
  epoll_event event = event_of(tag, what);
  (void)epoll_ctl(fd_, EPOLL_CTL_MOD, fd, &event);
}

void Epoll::remove(int fd) noexcept { (void)epoll_ctl(fd_, EPOLL_CTL_DEL, fd, nullptr); }

std::vector<std::uint64_t> Epoll::ready(std::size_t most) const {
  std::vector<epoll_event> events(most);
  const int n = epoll_wait(fd_, events.data(), static_cast<int>(most), 0);
  std::vector<std::uint64_t> tags;
  tags.reserve(static_cast<std::size_t>(std::max(n, 0)));
  for (int i = 0; i < n; ++i) tags.push_back(events[static_cast<std::size_t>(i)].data.u64);
  return tags;
}

void close_fd(int fd) noexcept {
  if (fd >= 0) close(fd);
}

Result<Cell*> make_cell(Segment& segment, const std::string& name) {
  auto found = segment.find<Cell>(name.c_str());
  if (found.ok()) return found;
  return segment.make<Cell>(name.c_str());
}

Result<Cell*> make_inbox(Segment& segment, std::string_view service) {
  return make_cell(segment, "inbox." + std::string(service));
}

Cell* find_inbox(Segment& segment, std::string_view service) {
  auto found = segment.find<Cell>(("inbox." + std::string(service)).c_str());
  return found.ok() ? *found : nullptr;
}

}  // namespace kerf::rtapi
