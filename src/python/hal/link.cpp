#include "python/hal/link.hpp"

#include <pthread.h>
#include <pybind11/pybind11.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace kerf::python {

namespace py = pybind11;
using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;

namespace {

/// All under the GIL; the fork handler runs in the child's only thread. Never destroyed: objects that Python forgets to give
/// back may outlive any destructor.
struct State {
  std::shared_ptr<Link> link;
  std::uint64_t forks{0};
  int fd{-1};
};
State& state() {
  static auto* const the_state = new State();
  return *the_state;
}

void in_child() {
  State& s = state();
  ++s.forks;
  // An open copy would keep the host from seeing the parent's death.
  if (s.fd >= 0) ::close(s.fd);
  s.fd = -1;
  // The old connection's destructor would close the number again; its memory stays, as pins may point there.
  if (s.link) new std::shared_ptr<Link>(std::move(s.link));
  s.link.reset();
}

}  // namespace

std::uint64_t Link::forks() noexcept { return state().forks; }

void Link::watch_forks() {
  (void)state();
  ::pthread_atfork(nullptr, nullptr, in_child);
}

Link::Link(std::unique_ptr<rtapi::Segment> segment, std::unique_ptr<hal::SocketSession> session)
    : segment_(std::move(segment)), session_(std::move(session)), fork_count_(forks()) {}

bool Link::host_is_there() const {
  char byte = 0;
  const ssize_t n = ::recv(session_->fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
}

Result<std::shared_ptr<Link>> Link::get() {
  State& s = state();
  if (s.link && s.link->usable()) {
    // Between two requests the host sends nothing, so a look at the socket tells whether it lives.
    const std::unique_lock<std::mutex> free(s.link->mutex_, std::try_to_lock);
    const bool same =
        s.link->components > 0 || s.link->segment().instance() == rtapi::default_instance();
    if (same && (!free.owns_lock() || s.link->host_is_there())) return s.link;
  }
  end();
  // The text of either error names the instance and says how to start it.
  const auto not_running = [](const std::string& why) {
    return fail(Errc::dead, "HAL is not running: " + why);
  };
  auto segment = rtapi::Segment::attach(rtapi::default_instance());
  if (!segment.ok()) return not_running(segment.error().message());
  auto session = hal::SocketSession::connect(**segment);
  if (!session.ok()) {
    return not_running("the realtime host of instance '" + (*segment)->instance() +
                       "' does not answer (" + session.error().message() +
                       "); `halrun -U` clears away what is left of it");
  }
  s.fd = (*session)->fd();
  s.link.reset(new Link(std::move(*segment), std::move(*session)));
  return s.link;
}

std::shared_ptr<Link> Link::present() { return state().link; }

void Link::end() {
  State& s = state();
  const std::shared_ptr<Link> link = std::exchange(s.link, nullptr);
  if (!link) return;
  s.fd = -1;
  link->ended_.set(1);
  const py::gil_scoped_release no_gil;
  const std::lock_guard<std::mutex> turn(
      link->mutex_);  // whoever waits for a reply has his turn out
  link->session_.reset();
}

Result<std::string> Link::ask(const std::vector<std::string>& argv) {
  if (!usable()) return fail(Errc::dead, "the connection to HAL has ended");
  const py::gil_scoped_release no_gil;
  const std::lock_guard<std::mutex> turn(mutex_);
  if (!session_) return fail(Errc::dead, "the connection to HAL has ended");
  auto reply = session_->request(std::span<const std::string>(argv));
  if (!reply.ok()) {
    ended_.set(1);
    return fail(Errc::dead, "HAL has ended: " + reply.error().message());
  }
  if (!reply->ok()) return fail(static_cast<Errc>(reply->status), reply->text);
  return std::move(reply->text);
}

}  // namespace kerf::python
