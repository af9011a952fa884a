#include "rtapi/shm/socket.hpp"

#include <fcntl.h>
#include <sys/socket.h>
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
  if (bind(fd, reinterpret_cast<const sockaddr*>(&sun), length) != 0 || listen(fd, 64) != 0) {
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
    const ssize_t n = recv(fd, buffer.data(), buffer.size(), MSG_DONTWAIT);
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
