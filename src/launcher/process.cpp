#include "launcher/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "rtapi/shm/socket.hpp"

namespace kerf::launcher {

using rtapi::Errc;

namespace {

/// In the child, between fork and exec: only calls that are safe there.
[[noreturn]] void become(char* const* words, const Surroundings& around, int output_fd,
                         int report_fd) {
  if (!around.terminal) setpgid(0, 0);
  if (around.cores != nullptr) (void)sched_setaffinity(0, sizeof *around.cores, around.cores);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // The guard ignores these, and what is ignored stays so in another program.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE})
    (void)::signal(number, SIG_DFL);
  if (!around.terminal) {
    const int null = open("/dev/null", O_RDONLY);
    if (null >= 0) dup2(null, STDIN_FILENO);
  }
  if (output_fd >= 0) dup2(output_fd, STDOUT_FILENO);
  execvp(words[0], words);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(report_fd, &error, sizeof error);
  _exit(127);
}

}  // namespace

std::string describe_exit(const ExitState& state) {
  if (state.by_signal) {
    return "was killed by signal " + std::to_string(state.number) + " (" +
           std::string(strsignal(state.number)) + ")";
  }
  return "ended with exit code " + std::to_string(state.number);
}

rtapi::Result<Child> Child::start(const std::vector<std::string>& words,
                                  const Surroundings& around) {
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  int output_fd = -1;
  if (!around.output.empty()) {
    output_fd = open(around.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (output_fd < 0)
      return rtapi::fail(Errc::system,
                         "cannot write " + around.output + ": " + std::strerror(errno));
  }
  int report[2];
  if (pipe2(report, O_CLOEXEC) != 0)
    return rtapi::fail(Errc::system, std::string("no pipe: ") + std::strerror(errno));
  const pid_t pid = fork();
  if (pid == 0) become(argv.data(), around, output_fd, report[1]);
  if (output_fd >= 0) close(output_fd);
  close(report[1]);
  int error = pid < 0 ? errno : 0;
  // The pipe closes by itself when exec succeeds.
  if (pid > 0 && read(report[0], &error, sizeof error) != sizeof error) error = 0;
  close(report[0]);
  if (error != 0) {
    if (pid > 0) waitpid(pid, nullptr, 0);
    return rtapi::fail(Errc::not_found,
                       "cannot start '" + words.front() + "': " + std::strerror(error));
  }
  Child child;
  const std::size_t slash = words.front().rfind('/');
  child.name_ = slash == std::string::npos ? words.front() : words.front().substr(slash + 1);
  child.own_group_ = !around.terminal;
  child.pid_ = pid;
  child.pidfd_ = rtapi::open_pidfd(pid);
  return child;
}

Child::Child(Child&& other) noexcept { *this = std::move(other); }

Child& Child::operator=(Child&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(own_group_, other.own_group_);
  std::swap(pid_, other.pid_);
  std::swap(pidfd_, other.pidfd_);
  std::swap(exit_, other.exit_);
  return *this;
}

Child::~Child() {
  if (pidfd_ >= 0) close(pidfd_);
}

std::optional<ExitState> Child::poll_exit() {
  if (exit_ || pid_ <= 0) return exit_;
  int status = 0;
  const pid_t got = waitpid(pid_, &status, WNOHANG);
  if (got == 0) return std::nullopt;
  if (got == pid_ && WIFSIGNALED(status))
    exit_ = ExitState{true, WTERMSIG(status)};
  else
    exit_ = ExitState{false, got == pid_ ? WEXITSTATUS(status) : 0};
  return exit_;
}

void Child::signal(int number) {
  if (pid_ <= 0 || !running()) return;
  // Before the child has made its group there is only the process itself.
  if (!own_group_ || kill(-pid_, number) != 0) kill(pid_, number);
}

std::string find_program(const std::string& name) {
  const auto usable = [](const std::string& path) { return access(path.c_str(), X_OK) == 0; };
  if (name.empty()) return {};
  if (name.find('/') != std::string::npos) return usable(name) ? name : std::string();
  const char* path = std::getenv("PATH");
  std::string rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string dir = rest.substr(0, colon);
    std::string full = dir;
    full.append("/").append(name);
    if (!dir.empty() && usable(full)) return full;
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
  }
  return {};
}

void pause_ms(int ms) { (void)poll(nullptr, 0, ms); }

}  // namespace kerf::launcher
