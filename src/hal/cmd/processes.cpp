#include "hal/cmd/processes.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;

namespace {

/// Value of LD_PRELOAD that puts a program on the instance's virtual clock; "" on the real one.
std::string preload_for(const rtapi::Segment& segment, const std::string& program) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return {};  // the sanitizer's runtime would have to come first, in programs that have none
#endif
  if (rtapi::clock_mode(segment) != rtapi::ClockMode::virtual_time) return {};
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto shim = self.parent_path().parent_path() / "lib" / "libkerf_time.so";
  if (error || !std::filesystem::exists(shim, error)) {
    rtapi::log_message(rtapi::Level::warning,
                       "%s is not deterministic: %s is missing, so it sleeps in real time",
                       program.c_str(), shim.c_str());
    return {};
  }
  const char* before = std::getenv("LD_PRELOAD");
  return before != nullptr && *before != '\0' ? shim.string() + ":" + before : shim.string();
}

/// PYTHONPATH with which a program finds our module hal; "" when it need not change.
std::string python_path() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto folder = self.parent_path().parent_path() / "python";
  if (error || !std::filesystem::exists(folder / "hal", error)) return {};
  const char* set = std::getenv("PYTHONPATH");
  const std::string before = set == nullptr ? "" : set;
  if ((":" + before + ":").find(":" + folder.string() + ":") != std::string::npos) return {};
  return before.empty() ? folder.string() : folder.string() + ":" + before;
}

}  // namespace

Result<pid_t> start_program(std::span<const std::string> argv, const rtapi::Segment& segment) {
  std::vector<char*> args;
  std::vector<std::string> copy(argv.begin(), argv.end());
  args.reserve(copy.size() + 1);
  for (auto& word : copy) args.push_back(word.data());
  args.push_back(nullptr);
  const std::string& instance = segment.instance();
  const std::string run_id(segment.header().run_id.view());
  const std::string preload = preload_for(segment, copy[0]);
  const std::string python = python_path();
  int report[2];
  // The pipe closes by exec; what comes through it is the errno of a failed one.
  if (::pipe2(report, O_CLOEXEC) != 0)
    return fail(Errc::system, std::string("pipe: ") + std::strerror(errno));
  const pid_t pid = ::fork();
  if (pid < 0) {
    const int why = errno;
    ::close(report[0]);
    ::close(report[1]);
    return fail(Errc::system, std::string("fork: ") + std::strerror(why));
  }
  if (pid == 0) {
    ::setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::setenv("KERF_INSTANCE", instance.c_str(), 1);
    if (!run_id.empty()) ::setenv("KERF_RUN_ID", run_id.c_str(), 1);
    if (!python.empty()) ::setenv("PYTHONPATH", python.c_str(), 1);
    if (!preload.empty()) ::setenv("LD_PRELOAD", preload.c_str(), 1);
    ::execvp(args[0], args.data());
    const int why = errno;
    (void)!::write(report[1], &why, sizeof why);
    ::_exit(127);
  }
  ::setpgid(pid, pid);
  ::close(report[1]);
  int why = 0;
  ssize_t n = 0;
  do {
    n = ::read(report[0], &why, sizeof why);
  } while (n < 0 && errno == EINTR);
  ::close(report[0]);
  if (n == sizeof why) {
    ::waitpid(pid, nullptr, 0);
    return fail(Errc::not_found, "execv(" + copy[0] + "): " + std::strerror(why));
  }
  return pid;
}

int child_status(pid_t pid) {
  int status = 0;
  const pid_t done = ::waitpid(pid, &status, WNOHANG);
  if (done == 0) return -1;
  if (done < 0) return errno == ECHILD ? 0 : -1;
  if (WIFSIGNALED(status)) return 128 + WTERMSIG(status);
  return WEXITSTATUS(status);
}

}  // namespace kerf::hal
