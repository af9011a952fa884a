#include "launcher/guard.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "launcher/process.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

namespace {

/// Children of a dead launcher end by themselves; those that do not are ended after this time.
constexpr int kPatienceMs = 400;

constexpr int kDisableMs = 100;  ///< for motion to switch off, which takes a living one a cycle
constexpr int kSettleMs = 20;    ///< for drivers to write

struct Declared {
  std::vector<SafePin> pins;
  std::vector<std::vector<std::string>> commands;
};

bool host_lives(const std::string& run_id) {
  const std::vector<pid_t> pids = rtapi::processes_of_run(run_id);
  return std::any_of(pids.begin(), pids.end(),
                     [](pid_t pid) { return rtapi::process_name(pid) == "rtapi_app"; });
}

/// Motion is off, all other outputs are what is declared, and the realtime process has run on long enough for its drivers to write that.
bool host_reaches_safe_state(const SafeState& safe, const std::string& run_id) {
  for (int waited = 0; waited < kDisableMs && safe.enabled(); ++waited) pause_ms(1);
  if (safe.enabled() || !host_lives(run_id)) return false;
  safe.apply(true);
  pause_ms(kSettleMs);
  return host_lives(run_id);
}

/// The realtime process switches itself off when it sees that the launcher is dead; here it is told too, since it may see that later.
/// It runs on for a second, or until it is ended below.
void reach_safe_state(const std::string& instance, const std::string& run_id,
                      const Declared& declared) {
  auto segment = rtapi::Segment::attach(instance);
  if (segment.ok()) {
    const SafeState safe(**segment, declared.pins);
    safe.disable();
    if (host_reaches_safe_state(safe, run_id)) return;
    safe.apply(false);
  }
  (void)run_safe_commands(declared.commands);  // nobody is there to be told
  pause_ms(kSettleMs);
}

[[noreturn]] void watch(int fd, const std::string& instance, const std::string& run_id,
                        const Declared& declared) {
  (void)setsid();
  (void)prctl(PR_SET_NAME, "kerf-guard");
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE})
    (void)signal(number, SIG_IGN);
  char word = 0;
  ssize_t n = 0;
  do {
    n = read(fd, &word, 1);
  } while (n < 0 && errno == EINTR);
  if (n == 0) {
    reach_safe_state(instance, run_id, declared);
    (void)rtapi::end_processes_of_run(run_id, kPatienceMs);
    (void)rtapi::Segment::remove(instance);
  }
  _exit(0);
}

}  // namespace

rtapi::Status Guard::start(const std::string& instance, const std::string& run_id, int close_fd,
                           const std::vector<SafePin>& safe_pins,
                           const std::vector<std::vector<std::string>>& safe_commands) {
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    return rtapi::fail(rtapi::Errc::system, std::string("no socket: ") + std::strerror(errno));
  const pid_t pid = fork();
  if (pid < 0) {
    close(pair[0]);
    close(pair[1]);
    return rtapi::fail(rtapi::Errc::system, std::string("cannot fork: ") + std::strerror(errno));
  }
  if (pid == 0) {
    close(pair[0]);
    if (close_fd >= 0) close(close_fd);
    watch(pair[1], instance, run_id, {safe_pins, safe_commands});
  }
  close(pair[1]);
  if (fd_ >= 0) close(fd_);  // of one that has died
  pid_ = pid;
  fd_ = pair[0];
  return {};
}

void Guard::release() {
  if (fd_ < 0) return;
  const char word = 'x';
  (void)send(fd_, &word, 1, MSG_NOSIGNAL);
  close(fd_);
  fd_ = -1;
  (void)waitpid(pid_, nullptr, 0);
}

}  // namespace kerf::launcher
