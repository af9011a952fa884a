#include "clients/rsh/server.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace kerf::rsh {

using rtapi::Errc;
using rtapi::fail;

namespace {

constexpr std::size_t kMaxUnread = 1U << 20U;  ///< of a client that does not read: it is dropped
constexpr int kReadsPerStep = 4;               ///< of one client, so that the others get their turn
constexpr rtapi::Nanos kAcceptPause = 100 * rtapi::kMillisecond;  ///< after a failed accept
/// Conditions that no cell tells of are looked at so often.
constexpr rtapi::Nanos kLook = 10 * rtapi::kMillisecond;

}  // namespace

Server::~Server() {
  for (auto& [number, c] : connections_) rtapi::close_fd(c.fd);
  rtapi::close_fd(listener_);
}

rtapi::Status Server::listen(const Options& options) {
  options_ = options;
  KERF_TRY(epoll_, rtapi::Epoll::open());
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
  const bool any = options.address == "any";
  if (any) hints.ai_family = AF_INET;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(options.port);
  if (const int error =
          getaddrinfo(any ? nullptr : options.address.c_str(), port.c_str(), &hints, &found);
      error != 0)
    return fail(Errc::bad_argument, "address '" + options.address + "': " + gai_strerror(error) +
                                        ": expected a numeric address of this computer, or any");
  const std::string where = options.address + " port " + port;
  listener_ = ::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int one = 1;
  if (listener_ >= 0) (void)setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
  const bool bound = listener_ >= 0 && ::bind(listener_, found->ai_addr, found->ai_addrlen) == 0 &&
                     ::listen(listener_, SOMAXCONN) == 0;
  const int error = errno;
  freeaddrinfo(found);
  if (!bound)
    return fail(error == EADDRINUSE ? Errc::busy : Errc::system,
                "cannot listen on " + where + ": " + std::strerror(error) +
                    (error == EADDRINUSE ? " (choose another one with --port)" : ""));
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  (void)getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length);
  port_ = ntohs(address.ss_family == AF_INET6
                    ? reinterpret_cast<const sockaddr_in6*>(&address)->sin6_port
                    : reinterpret_cast<const sockaddr_in*>(&address)->sin_port);
  place_ = options.address + " port " + std::to_string(port_);
  return epoll_.add(listener_, 0, rtapi::Epoll::readable);
}

void Server::accept_clients(rtapi::Nanos now) {
  if (now < accept_again_) return;
  for (;;) {
    const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) {
      // Out of descriptors, say: the client waits in the queue.
      if (errno != EAGAIN && errno != EINTR && errno != ECONNABORTED)
        accept_again_ = now + kAcceptPause;
      if (errno == EINTR || errno == ECONNABORTED) continue;
      return;
    }
    const int one = 1;
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    const int number = ++last_number_;
    std::string refusal;
    if (options_.max_sessions >= 0 &&
        connections_.size() >= static_cast<std::size_t>(options_.max_sessions))
      refusal = "error: Too many sessions, at most " + std::to_string(options_.max_sessions);
    Connection c;
    c.fd = fd;
    if (refusal.empty()) {
      auto machine = make_machine_();
      if (machine.ok())
        c.machine = std::move(*machine);
      else
        refusal = "error: " + machine.error().message();
    }
    if (refusal.empty() &&
        !epoll_.add(fd, static_cast<std::uint64_t>(number), rtapi::Epoll::readable).ok())
      refusal = "error: Too many sessions";
    if (!refusal.empty()) {
      refusal += "\r\n";
      (void)::send(fd, refusal.data(), refusal.size(), MSG_NOSIGNAL);
      rtapi::close_fd(fd);
      continue;
    }
    c.watched = rtapi::Epoll::readable;
    c.session = std::make_unique<Session>(shell_, *c.machine, number);
    connections_.emplace(number, std::move(c));
  }
}

void Server::read(Connection& c, rtapi::Nanos now) {
  char buffer[4096];
  for (int n = 0; n < kReadsPerStep && !c.input_over && c.session->takes_input(); ++n) {
    const ssize_t got = ::recv(c.fd, buffer, sizeof buffer, 0);
    if (got > 0) {
      c.session->feed({buffer, static_cast<std::size_t>(got)}, now);
      continue;
    }
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return;
    c.input_over = true;
    // The end of the input may be the end of a script, which is carried out. A connection that broke, or one that leaves a jog
    // behind, ends here.
    if (got < 0 || c.session->jogs) c.dead = true;
  }
}

void Server::write(Connection& c) {
  c.output += c.session->take_output();
  while (!c.output.empty()) {
    const ssize_t sent = ::send(c.fd, c.output.data(), c.output.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      if (errno != EAGAIN || c.output.size() > kMaxUnread) c.dead = true;
      return;
    }
    c.output.erase(0, static_cast<std::size_t>(sent));
  }
}

bool Server::is_over(const Connection& c) const {
  if (c.dead) return true;
  if (!c.output.empty()) return false;
  return c.session->ended() || (c.input_over && c.session->idle());
}

void Server::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  const bool waiting = [this] {
    for (const auto& [number, c] : connections_)
      if (c.session->waits()) return true;
    return false;
  }();
  if (waiting) {
    if (status_cell_ != nullptr) next.watch(*status_cell_);
    if (reply_cell_ != nullptr) next.watch(*reply_cell_);
  }
  next.watch_fd(epoll_.fd());
  accept_clients(now);
  bool waits = false;
  for (auto at = connections_.begin(); at != connections_.end();) {
    Connection& c = at->second;
    read(c, now);
    c.session->step(now);
    write(c);
    if (is_over(c)) {
      epoll_.remove(c.fd);
      rtapi::close_fd(c.fd);
      at = connections_.erase(at);
      continue;
    }
    unsigned what = c.output.empty() ? 0U : rtapi::Epoll::writable;
    if (!c.input_over && c.session->takes_input()) what |= rtapi::Epoll::readable;
    if (what != c.watched)
      epoll_.change(c.fd, static_cast<std::uint64_t>(at->first), c.watched = what);
    waits = waits || c.session->waits();
    next.wake_at(c.session->wake_at());
    ++at;
  }
  if (accept_again_ > now) next.wake_at(accept_again_);
  // Watched cells must have been counted before the machine was looked at; who began to wait just now is looked at once more.
  if (waits) next.wake_at(waiting ? now + kLook : now);
}

}  // namespace kerf::rsh
