#include "task/interpreter/user_program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "io/own_group.hpp"
#include "rtapi/clock/join_clock.hpp"

extern char** environ;

namespace kerf::task {

using rtapi::Errc;
using rtapi::fail;

namespace {

constexpr std::size_t kKeptError = 4096;
constexpr long kGraceNs = 200'000'000;

void close_one(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

/// Why the system finds "no such file" in a file that is there: the program of its first line.
std::string missing_interpreter(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || line.rfind("#!", 0) != 0) return {};
  if (line.back() == '\r') return "its lines end as on Windows; save it with the line ends of Unix";
  const std::size_t from = line.find_first_not_of(" \t", 2);
  if (from == std::string::npos) return {};
  return "its first line names " + line.substr(from, line.find_first_of(" \t", from) - from) +
         ", which is not there";
}

}  // namespace

/// At most 64 KiB, so that a program that never stops printing keeps nobody here.
bool UserProgram::read_some(int fd, std::string* tail) {
  char buffer[4096];
  for (int i = 0; i < 16; ++i) {
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n == 0) return false;
    if (n < 0) return errno == EAGAIN || errno == EINTR;
    const auto size = static_cast<std::size_t>(n);
    if (tail == nullptr) continue;
    tail->append(buffer, size);
    if (tail->size() > kKeptError) tail->erase(0, tail->size() - kKeptError);
  }
  return true;
}

void UserProgram::drain() {
  if (error_fd_ >= 0 && !read_some(error_fd_, &last_words_)) close_one(error_fd_);
  for (auto at = left_.begin(); at != left_.end();) {
    if (read_some(*at, nullptr)) {
      ++at;
      continue;
    }
    ::close(*at);
    at = left_.erase(at);
  }
}

UserProgram::~UserProgram() {
  if (pid_ > 0) {
    (void)::kill(-pid_, SIGKILL);
    (void)::waitpid(pid_, nullptr, 0);
  }
  close_all();
  for (const int fd : left_) ::close(fd);
}

void UserProgram::close_all() {
  close_one(pidfd_);
  close_one(error_fd_);
  close_one(grace_fd_);
  pid_ = 0;
}

rtapi::Status UserProgram::start(
    const std::string& path, const std::vector<std::string>& arguments,
    const std::vector<std::pair<std::string, std::string>>& environment) {
  if (running()) return fail(Errc::busy, "a user program runs already");
  int ends[2]{-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return fail(Errc::system,
                std::string("cannot read the program's messages: ") + std::strerror(errno));
  error_fd_ = ends[0];
  (void)::fcntl(error_fd_, F_SETFL, O_NONBLOCK);
  last_words_.clear();

  std::vector<std::string> own;
  own.reserve(environment.size());
  for (const auto& [name, value] : environment) own.emplace_back(name).append("=").append(value);
  std::vector<char*> env;
  for (char** e = environ; *e != nullptr; ++e) {
    bool replaced = false;
    for (const auto& [name, value] : environment)
      replaced = replaced ||
                 (std::strncmp(*e, name.c_str(), name.size()) == 0 && (*e)[name.size()] == '=');
    if (!replaced) env.push_back(*e);
  }
  for (auto& e : own) env.push_back(e.data());
  env.push_back(nullptr);

  std::vector<std::string> words{path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (auto& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  const io::OwnGroup group;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t pid = 0;
  int error = ::posix_spawn(&pid, path.c_str(), &actions, group.get(), argv.data(), env.data());
  if (error == ENOEXEC) {
    // A script without #! runs in the shell, as it does when typed at one.
    std::string shell = "/bin/sh";
    argv.insert(argv.begin(), shell.data());
    error = ::posix_spawn(&pid, shell.c_str(), &actions, group.get(), argv.data(), env.data());
  }
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error != 0) {
    close_all();
    const std::string why = error == ENOENT ? missing_interpreter(path) : std::string();
    return fail(Errc::system,
                "cannot run " + path + ": " + (why.empty() ? std::strerror(error) : why));
  }
  pid_ = pid;
  pidfd_ = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
  if (pidfd_ < 0) {
    const std::string why = std::strerror(errno);
    (void)::kill(-pid_, SIGKILL);
    (void)::waitpid(pid_, nullptr, 0);
    close_all();
    return fail(Errc::system, "cannot watch " + path + ": " + why);
  }
  return {};
}

std::optional<UserProgram::Exit> UserProgram::poll() {
  if (pid_ <= 0) return std::nullopt;
  drain();
  int status = 0;
  const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
  if (ended == 0) {
    std::uint64_t expirations = 0;
    if (grace_fd_ >= 0 && ::read(grace_fd_, &expirations, sizeof expirations) > 0)
      (void)::kill(-pid_, SIGKILL);
    return std::nullopt;
  }
  if (grace_fd_ >= 0) (void)::kill(-pid_, SIGKILL);  // its children outlived the polite request
  Exit out;
  out.status = ended < 0 ? 255 : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  drain();  // what is in the pipe; a pipe holds no more than one look takes
  out.error_text = last_words_;
  if (!out.error_text.empty())
    (void)!::write(STDERR_FILENO, out.error_text.data(), out.error_text.size());
  if (error_fd_ >= 0) left_.push_back(std::exchange(error_fd_, -1));
  if (left_.size() > kMostLeft) {
    ::close(left_.front());
    left_.erase(left_.begin());
  }
  drain();
  while (!out.error_text.empty() && (out.error_text.back() == '\n' || out.error_text.back() == ' '))
    out.error_text.pop_back();
  close_all();
  return out;
}

void UserProgram::terminate() {
  if (pid_ <= 0 || grace_fd_ >= 0) return;
  (void)::kill(-pid_, SIGTERM);
  grace_fd_ = ::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
  const itimerspec grace{{0, 0}, {0, kGraceNs}};
  if (grace_fd_ < 0 || ::timerfd_settime(grace_fd_, 0, &grace, nullptr) != 0)
    (void)::kill(-pid_, SIGKILL);
}

void UserProgram::add_to(rtapi::WaitSpec& spec, const rtapi::Segment& segment) const {
  for (const int fd : left_) spec.watch_fd(fd);
  if (pid_ <= 0) return;
  if (error_fd_ >= 0) spec.watch_fd(error_fd_);
  spec.watch_fd(pidfd_);
  if (grace_fd_ >= 0) spec.watch_fd(grace_fd_);
  if (const auto* joins = rtapi::clock_joins(segment); joins != nullptr) spec.watch(*joins);
  spec.holds_time = !rtapi::lives_in_virtual_time(segment, pid_);
}

}  // namespace kerf::task
