#include "io/tool_database.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "io/own_group.hpp"

extern char** environ;

namespace kerf::io {

using rtapi::Errc;
using rtapi::fail;

namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr std::size_t kLongestAnswer = 64U << 20;
constexpr int kPoliteMs = 300, kGraceMs = 200;
constexpr std::string_view kVersions = "v2.";

std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = command.find_first_not_of(" \t", at)) != std::string::npos) {
    const std::size_t end = std::min(command.find_first_of(" \t", at), command.size());
    words.push_back(command.substr(at, end - at));
    at = end;
  }
  return words;
}

/// A name without a folder that is none in `folder` is looked for in PATH.
std::string program_path(const std::string& name, const std::string& folder) {
  std::string path = name;
  if (path.rfind("~/", 0) == 0 && std::getenv("HOME") != nullptr)
    path = std::getenv("HOME") + path.substr(1);
  if (path.front() == '/') return path;
  path.insert(0, folder.empty() ? "./" : folder + "/");
  if (name.find('/') != std::string::npos || ::access(path.c_str(), F_OK) == 0) return path;
  return name;
}

/// True when the process has ended within the time, and is no more.
bool ends_within(int pid, int ms) {
  const int fd = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
  if (fd >= 0) {
    pollfd p{fd, POLLIN, 0};
    (void)::poll(&p, 1, ms);
    ::close(fd);
  }
  return ::waitpid(pid, nullptr, WNOHANG) != 0;
}

}  // namespace

rtapi::Failure<rtapi::Error> ToolDatabase::failure(const std::string& what) const {
  return fail(Errc::system, "[EMCIO]DB_PROGRAM " + name_ + ": " + what);
}

rtapi::Result<std::unique_ptr<ToolDatabase>> ToolDatabase::start(const Options& options) {
  std::unique_ptr<ToolDatabase> db(new ToolDatabase);
  KERF_CHECK(db->spawn(options));
  KERF_TRY(const std::string version, db->read_line());
  if (version.rfind(kVersions, 0) != 0)
    return db->failure("its first line is '" + version.substr(0, 60) +
                       "', expected the version of the interface: v2.1");
  return db;
}

rtapi::Status ToolDatabase::spawn(const Options& options) {
  timeout_ms_ = options.timeout_ms;
  trace_ = std::getenv("DB_DEBUG") != nullptr;
  std::vector<std::string> words = words_of(options.command);
  if (words.empty()) return fail(Errc::bad_argument, "[EMCIO]DB_PROGRAM is empty");
  name_ = words[0];
  const std::string path = program_path(words[0], options.folder);
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (auto& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  std::string instance = "KERF_INSTANCE=" + options.instance;
  std::vector<char*> env;
  for (char** e = environ; *e != nullptr; ++e)
    if (options.instance.empty() || std::strncmp(*e, "KERF_INSTANCE=", 14) != 0) env.push_back(*e);
  if (!options.instance.empty()) env.push_back(instance.data());
  env.push_back(nullptr);

  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return failure(std::strerror(errno));
  socket_ = ends[0];
  posix_spawn_file_actions_t actions;
  const OwnGroup group;
  ::posix_spawn_file_actions_init(&actions);
  if (!options.folder.empty())
    ::posix_spawn_file_actions_addchdir_np(&actions, options.folder.c_str());
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  pid_t pid = 0;
  const int error =
      ::posix_spawnp(&pid, path.c_str(), &actions, group.get(), argv.data(), env.data());
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error != 0)
    return fail(error == ENOENT ? Errc::not_found : Errc::system,
                "[EMCIO]DB_PROGRAM: cannot run " + path + ": " + std::strerror(error) +
                    (error == EACCES ? "; is it executable (chmod +x)?" : ""));
  pid_ = pid;
  timer_ = ::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
  return {};
}

ToolDatabase::~ToolDatabase() {
  if (socket_ >= 0) ::close(socket_);
  if (timer_ >= 0) ::close(timer_);
  if (pid_ <= 0) return;
  if (ends_within(pid_, kPoliteMs)) {
    (void)::kill(-pid_, SIGKILL);  // what it has left behind
    return;
  }
  (void)::kill(-pid_, SIGTERM);
  const bool ended = ends_within(pid_, kGraceMs);
  (void)::kill(-pid_, SIGKILL);
  if (!ended) (void)::waitpid(pid_, nullptr, 0);
}

std::string ToolDatabase::gone() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  set_timer(false);
  unanswered_ = 0;
  received_.clear();
  std::string how = "has closed its output";
  int status = 0;
  // Its end comes a moment after that of its output.
  const int fd = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
  if (fd >= 0) {
    pollfd p{fd, POLLIN, 0};
    (void)::poll(&p, 1, kGraceMs);
    ::close(fd);
  }
  if (pid_ > 0 && ::waitpid(pid_, &status, WNOHANG) > 0) {
    (void)::kill(-pid_, SIGKILL);
    pid_ = 0;
    how = WIFEXITED(status) ? "ended with exit status " + std::to_string(WEXITSTATUS(status))
                            : "was ended by signal " + std::to_string(WTERMSIG(status));
  }
  return how + "; G10 L0, or loading the tool table, starts it again";
}

rtapi::Result<std::string> ToolDatabase::read_line() {
  for (;;) {
    if (const auto end = received_.find('\n'); end != std::string::npos) {
      std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (trace_) std::printf("DB <- %s\n", line.c_str());
      return line;
    }
    if (received_.size() > kLongestLine) {
      (void)gone();
      return failure("answers with a line of more than " + std::to_string(kLongestLine) +
                     " characters");
    }
    if (socket_ < 0) return failure("does not run");
    pollfd p{socket_, POLLIN, 0};
    const int ready = ::poll(&p, 1, timeout_ms_);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return failure("no answer within " + std::to_string(timeout_ms_ / 1000) + " s");
    char text[4096];
    const ssize_t n = ::recv(socket_, text, sizeof text, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return failure(gone());
    received_.append(text, static_cast<std::size_t>(n));
  }
}

rtapi::Result<std::string> ToolDatabase::get() {
  const std::lock_guard lock(link_);
  if (!send_waiting()) return failure(gone());
  // Their answers come first.
  while (unanswered_ > 0) {
    KERF_TRY(const std::string line, read_line());
    take_answer(line);
  }
  {
    const std::lock_guard queue(queue_);
    waiting_.push_front("g");
  }
  if (!send_waiting()) return failure(gone());
  unanswered_ = 0;  // of `g` there is more than one line
  set_timer(false);
  std::string out;
  for (;;) {
    KERF_TRY(const std::string line, read_line());
    if (line.rfind("FINI", 0) == 0) return out;
    if (line.find("NAK") != std::string::npos) return failure("answers to g: " + line);
    out += line + '\n';
    if (out.size() > kLongestAnswer) {
      (void)gone();
      return failure("answers without end; a line FINI must end the tools");
    }
  }
}

void ToolDatabase::tell(std::string line) {
  {
    const std::lock_guard queue(queue_);
    waiting_.push_back(std::move(line));
  }
  if (!link_.try_lock()) return;  // whoever talks now, or pump(), sends it
  if (!send_waiting()) complaints_.push_back("[EMCIO]DB_PROGRAM " + name_ + " " + gone());
  link_.unlock();
}

/// False: nobody takes it.
bool ToolDatabase::send_waiting() {
  const std::lock_guard queue(queue_);
  if (socket_ < 0) {
    waiting_.clear();
    return true;  // told before
  }
  while (!waiting_.empty()) {
    const std::string line = waiting_.front() + '\n';
    const ssize_t n = ::send(socket_, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return true;  // it reads nothing; the timer tells
    if (n != static_cast<ssize_t>(line.size())) return false;
    if (trace_) std::printf("DB -> %s", line.c_str());
    waiting_.pop_front();
    if (unanswered_++ == 0) set_timer(true);
  }
  return true;
}

void ToolDatabase::set_timer(bool on) {
  itimerspec time{};
  if (on) time.it_value = {timeout_ms_ / 1000, (timeout_ms_ % 1000) * 1000000L};
  (void)::timerfd_settime(timer_, 0, &time, nullptr);
}

void ToolDatabase::take_answer(const std::string& line) {
  if (unanswered_ > 0) --unanswered_;
  set_timer(unanswered_ > 0);
  if (line.find("NAK") != std::string::npos) complaints_.push_back("tool database: " + line);
}

void ToolDatabase::receive() {
  for (;;) {
    char text[4096];
    const ssize_t n = ::recv(socket_, text, sizeof text, MSG_DONTWAIT);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) break;
    if (n == 0) {
      complaints_.push_back("[EMCIO]DB_PROGRAM " + name_ + " " + gone());
      return;
    }
    received_.append(text, static_cast<std::size_t>(n));
    if (received_.size() > kLongestLine && received_.find('\n') == std::string::npos)
      received_.clear();
    for (auto end = received_.find('\n'); end != std::string::npos; end = received_.find('\n')) {
      const std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      if (trace_) std::printf("DB <- %s\n", line.c_str());
      take_answer(line);
    }
  }
}

std::vector<std::string> ToolDatabase::pump() {
  std::vector<std::string> out;
  if (!link_.try_lock()) return out;
  if (socket_ >= 0) {
    receive();
    if (!send_waiting()) complaints_.push_back("[EMCIO]DB_PROGRAM " + name_ + " " + gone());
    std::uint64_t expirations = 0;
    if (::read(timer_, &expirations, sizeof expirations) > 0 && unanswered_ > 0)
      complaints_.push_back("[EMCIO]DB_PROGRAM " + name_ + " does not confirm changes of tools (" +
                            std::to_string(unanswered_) + "); it may not know them");
  }
  out.swap(complaints_);
  link_.unlock();
  return out;
}

}  // namespace kerf::io
