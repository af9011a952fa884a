// libkerf_time.so, preloaded into `loadusr` programs of an instance on the virtual clock: their sleeps, poll time-outs and
// CLOCK_MONOTONIC become virtual, and each thread that waits becomes a participant of the clock.
//
// A thread joins at its first wait, or when its component is ready (shim_clock()). From then on it runs only when it has the
// baton, so what it does between two waits takes no virtual time. Waits that this file does not know (a futex, a blocking read)
// keep the baton for a second; then time goes on without the program, which is named as not deterministic. Kerf's own programs
// join the clock themselves and are left alone.
#include <dlfcn.h>
#include <errno.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <memory>
#include <string>

#include "rtapi/clock/clock.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace {

using kerf::rtapi::kSecond;
using kerf::rtapi::Nanos;

/// The C library's own function behind the one that is replaced here.
template <class F>
F* next_function(const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

/// True while this thread is inside Kerf's code, which needs the real functions.
thread_local bool inside = false;  // NOLINT(readability-identifier-naming): not a constant

class Guard {
 public:
  Guard() { inside = true; }
  ~Guard() { inside = before_; }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  const bool before_{inside};
};

/// A thread's clock for Kerf's code outside this library, whose own waits must not come back here.
class GuardedClock final : public kerf::rtapi::WaitClock {
 public:
  explicit GuardedClock(std::unique_ptr<kerf::rtapi::WaitClock> clock) : clock_(std::move(clock)) {}
  ~GuardedClock() override {
    const Guard guard;
    clock_.reset();
  }
  [[nodiscard]] Nanos now() const noexcept override { return clock_->now(); }
  [[nodiscard]] bool is_virtual() const noexcept override { return clock_->is_virtual(); }
  void wait(const kerf::rtapi::WaitSpec& spec) override {
    const Guard guard;
    clock_->wait(spec);
  }
  void stop() noexcept override { clock_->stop(); }
  [[nodiscard]] bool stopped() const noexcept override { return clock_->stopped(); }

 private:
  std::unique_ptr<kerf::rtapi::WaitClock> clock_;
};

/// True for Kerf's own programs: they stand in bin/ beside the folder of this library.
bool is_own_program() {
  Dl_info info{};
  char self[4096];
  const ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  if (n <= 0 || dladdr(reinterpret_cast<void*>(&is_own_program), &info) == 0) return false;
  const std::string program(self, static_cast<std::size_t>(n));
  const std::string library(info.dli_fname);
  const std::string top = library.substr(0, library.rfind('/', library.rfind('/') - 1));
  return program.rfind(top + "/bin/", 0) == 0;
}

kerf::rtapi::Segment* attached_segment() {
  // One mapping for the life of the process: threads may outlive any order of destruction.
  static kerf::rtapi::Segment* const segment = [] {
    if (is_own_program()) return static_cast<kerf::rtapi::Segment*>(nullptr);
    auto found = kerf::rtapi::Segment::attach(kerf::rtapi::default_instance());
    if (!found.ok() || kerf::rtapi::clock_mode(**found) != kerf::rtapi::ClockMode::virtual_time)
      return static_cast<kerf::rtapi::Segment*>(nullptr);
    return found->release();
  }();
  return segment;
}

/// Set when the program joins the clock itself.
bool disabled = false;  // NOLINT(readability-identifier-naming): not a constant

std::unique_ptr<kerf::rtapi::WaitClock>& thread_clock() {
  thread_local std::unique_ptr<kerf::rtapi::WaitClock> clock;
  return clock;
}

/// This thread's clock, or nullptr when the instance runs in real time or is gone.
kerf::rtapi::WaitClock* joined_clock() {
  if (disabled) return nullptr;
  auto& clock = thread_clock();
  if (!clock && attached_segment() != nullptr) {
    auto joined = kerf::rtapi::join_clock(*attached_segment(), kerf::rtapi::Role::user_component,
                                          kerf::rtapi::process_name(getpid()), true);
    if (joined.ok()) clock = std::make_unique<GuardedClock>(std::move(*joined));
  }
  return clock.get();
}

/// Sleeps until `until` in virtual time. False: there is no virtual clock, do it really.
bool virtual_sleep(Nanos until) {
  if (inside) return false;
  const Guard guard;
  kerf::rtapi::WaitClock* clock = joined_clock();
  if (clock == nullptr) return false;
  while (clock->now() < until) {
    kerf::rtapi::WaitSpec spec;
    spec.until = until;
    clock->wait(spec);
  }
  return true;
}

Nanos to_nanos(const timespec& t) { return static_cast<Nanos>(t.tv_sec) * kSecond + t.tv_nsec; }

Nanos virtual_now() {
  if (disabled) return -1;
  const Guard guard;
  kerf::rtapi::Segment* segment = attached_segment();
  return segment == nullptr ? -1 : kerf::rtapi::read_clock(*segment)->now();
}

/// Asks for readiness now, and between asks lets virtual time go by in steps, since descriptors of other kinds than `readable`
/// cannot end a wait of the clock. `ask` gives what the call would return; timeout < 0: for ever.
template <class Ask>
int virtual_poll(Nanos timeout, const pollfd* fds, nfds_t count, Ask ask) {
  const Guard guard;
  kerf::rtapi::WaitClock* clock = joined_clock();
  const Nanos end = timeout < 0 ? kerf::rtapi::kForever : clock->now() + timeout;
  for (;;) {
    const int ready = ask();
    if (ready != 0 || clock->now() >= end) return ready;
    kerf::rtapi::WaitSpec spec;
    spec.until = end;
    for (nfds_t i = 0; i < count; ++i) {
      if ((fds[i].events & POLLIN) != 0 && fds[i].fd >= 0) spec.watch_fd(fds[i].fd);
      if ((fds[i].events & POLLOUT) != 0) spec.wake_at(clock->now() + kerf::rtapi::kMillisecond);
    }
    clock->wait(spec);
  }
}

bool use_virtual() {
  if (inside) return false;
  const Guard guard;
  return joined_clock() != nullptr;
}

}  // namespace

extern "C" {

/// Called by a program that joins the clock itself (VirtualClock::join).
void kerf_time_shim_disable() {
  disabled = true;
  const Guard guard;
  thread_clock().reset();
}

/// What shim_clock() (rtapi/clock/join_clock.hpp) gives.
kerf::rtapi::WaitClock* kerf_time_shim_clock(bool join) {
  if (disabled) return nullptr;
  const Guard guard;
  return join ? joined_clock() : thread_clock().get();
}

int nanosleep(const timespec* wanted, timespec* left) {
  const Nanos now = inside ? -1 : virtual_now();
  if (now >= 0 && wanted != nullptr && virtual_sleep(now + to_nanos(*wanted))) return 0;
  return next_function<decltype(nanosleep)>("nanosleep")(wanted, left);
}

int clock_nanosleep(clockid_t id, int flags, const timespec* wanted, timespec* left) {
  const Nanos now = inside ? -1 : virtual_now();
  if (now >= 0 && wanted != nullptr && (flags == 0 || id == CLOCK_MONOTONIC)) {
    const Nanos until = flags == TIMER_ABSTIME ? to_nanos(*wanted) : now + to_nanos(*wanted);
    if (virtual_sleep(until)) return 0;
  }
  return next_function<decltype(clock_nanosleep)>("clock_nanosleep")(id, flags, wanted, left);
}

int usleep(useconds_t us) {
  const timespec wanted{static_cast<time_t>(us / 1000000), static_cast<long>(us % 1000000) * 1000};
  return nanosleep(&wanted, nullptr);
}

unsigned sleep(unsigned seconds) {
  const timespec wanted{static_cast<time_t>(seconds), 0};
  return nanosleep(&wanted, nullptr) == 0 ? 0 : seconds;
}

int clock_gettime(clockid_t id, timespec* out) {
  if (!inside && id == CLOCK_MONOTONIC) {
    const Nanos now = virtual_now();
    if (now >= 0) {
      out->tv_sec = static_cast<time_t>(now / kSecond);
      out->tv_nsec = static_cast<long>(now % kSecond);
      return 0;
    }
  }
  return next_function<decltype(clock_gettime)>("clock_gettime")(id, out);
}

int poll(pollfd* fds, nfds_t count, int timeout_ms) {
  auto* real = next_function<decltype(poll)>("poll");
  if (timeout_ms == 0 || !use_virtual()) return real(fds, count, timeout_ms);
  const Nanos timeout = timeout_ms < 0 ? -1 : timeout_ms * kerf::rtapi::kMillisecond;
  return virtual_poll(timeout, fds, count, [&] { return real(fds, count, 0); });
}

int ppoll(pollfd* fds, nfds_t count, const timespec* timeout, const sigset_t* mask) {
  auto* real = next_function<decltype(ppoll)>("ppoll");
  if ((timeout != nullptr && to_nanos(*timeout) == 0) || !use_virtual())
    return real(fds, count, timeout, mask);
  const timespec zero{};
  return virtual_poll(timeout == nullptr ? -1 : to_nanos(*timeout), fds, count,
                      [&] { return real(fds, count, &zero, mask); });
}

int select(int count, fd_set* in, fd_set* out, fd_set* except, timeval* timeout) {
  auto* real = next_function<decltype(select)>("select");
  const Nanos limit = timeout == nullptr
                          ? -1
                          : static_cast<Nanos>(timeout->tv_sec) * kSecond + timeout->tv_usec * 1000;
  if (limit == 0 || !use_virtual()) return real(count, in, out, except, timeout);
  pollfd watched[64];
  nfds_t n = 0;
  for (int fd = 0; fd < count && n < 64; ++fd) {
    const bool reads = in != nullptr && FD_ISSET(fd, in);
    const bool writes = out != nullptr && FD_ISSET(fd, out);
    if (reads || writes)
      watched[n++] = {fd, static_cast<short>((reads ? POLLIN : 0) | (writes ? POLLOUT : 0)), 0};
  }
  fd_set none;
  FD_ZERO(&none);
  const fd_set in0 = in != nullptr ? *in : none;
  const fd_set out0 = out != nullptr ? *out : none;
  const fd_set except0 = except != nullptr ? *except : none;
  return virtual_poll(limit, watched, n, [&] {
    if (in != nullptr) *in = in0;
    if (out != nullptr) *out = out0;
    if (except != nullptr) *except = except0;
    timeval zero{};
    return real(count, in, out, except, &zero);
  });
}

}  // extern "C"
