#include "rtapi/shm/owner_lock.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/abstract_address.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::rtapi {

namespace {

/// Connections that are never accepted stay in the queue; only asking for the taker makes some.
constexpr int kBacklog = 1024;

std::string address_of(const std::string& instance) { return socket_name(instance, "owner"); }

/// A bound socket, -1 when the address is taken, or an error.
Result<int> try_to_bind(const std::string& instance) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return fail(Errc::system, std::string("cannot make a socket: ") + strerror(errno));
  sockaddr_un sun{};
  const socklen_t length = abstract_address(address_of(instance), sun);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&sun), length) == 0 && listen(fd, kBacklog) == 0)
    return fd;
  const int why = errno;
  close(fd);
  if (why == EADDRINUSE) return -1;
  return fail(Errc::system,
              "cannot lock instance '" + instance + "': " + std::string(strerror(why)));
}

}  // namespace

Result<OwnerLock> OwnerLock::take(const std::string& instance, int patience_ms) {
  constexpr Nanos kStep = 5 * kMillisecond;
  const auto clock = make_real_clock();
  const Nanos limit = clock->now() + patience_ms * kMillisecond;
  for (;;) {
    KERF_TRY(const int fd, try_to_bind(instance));
    if (fd >= 0) return OwnerLock(fd);
    const std::int64_t owner = taker(instance);
    if (owner > 0 && process_lives(owner, 0)) {
      return fail(Errc::busy, "instance '" + instance + "' is in use by process " +
                                  std::to_string(owner) + " (" + process_name(owner) +
                                  "); stop it, or choose another name with --instance");
    }
    if (clock->now() >= limit) {
      return fail(Errc::busy, "instance '" + instance +
                                  "' is still being taken down after its end; 'halrun -U' with "
                                  "KERF_INSTANCE=" +
                                  instance + " ends it by force");
    }
    WaitSpec spec;
    spec.wake_at(clock->now() + kStep);
    clock->wait(spec);
  }
}

std::int64_t OwnerLock::taker(const std::string& instance) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return 0;
  sockaddr_un sun{};
  const socklen_t length = abstract_address(address_of(instance), sun);
  ucred credentials{};
  socklen_t size = sizeof credentials;
  // The credentials of a listening socket are those of the process that called listen().
  const bool known = connect(fd, reinterpret_cast<const sockaddr*>(&sun), length) == 0 &&
                     getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &credentials, &size) == 0;
  close(fd);
  return known ? credentials.pid : 0;
}

bool OwnerLock::held_here(const std::string& instance) {
  sockaddr_un wanted{};
  const socklen_t length = abstract_address(address_of(instance), wanted);
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc/self/fd", error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    int fd = -1;
    if (std::from_chars(name.data(), name.data() + name.size(), fd).ec != std::errc()) continue;
    sockaddr_un bound{};
    socklen_t size = sizeof bound;
    int listens = 0;
    socklen_t flag_size = sizeof listens;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &size) != 0 || size != length ||
        std::memcmp(&bound, &wanted, length) != 0)
      continue;
    if (getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &flag_size) == 0 && listens != 0)
      return true;
  }
  return false;
}

void OwnerLock::release() noexcept {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
}

}  // namespace kerf::rtapi
