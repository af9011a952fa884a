#include "rtapi/shm/leftovers.hpp"

#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <iterator>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/socket.hpp"

namespace kerf::rtapi {

namespace {

/// Words NAME=VALUE of a process's environment as it was started; empty for other users' processes.
std::vector<std::string> environment_of(pid_t pid) {
  const std::string text = read_process_file(pid, "environ");
  std::vector<std::string> words;
  std::string_view rest(text);
  while (!rest.empty()) {
    const auto length = std::min(rest.find('\0'), rest.size());
    words.emplace_back(rest.substr(0, length));
    rest.remove_prefix(std::min(length + 1, rest.size()));
  }
  return words;
}

std::vector<pid_t> own_line() {
  std::vector<pid_t> line;
  for (std::int64_t pid = ::getpid(); pid > 1 && line.size() < 1000; pid = parent_of(pid))
    line.push_back(static_cast<pid_t>(pid));
  return line;
}

using Match = std::function<bool(const std::vector<std::string>& environment)>;

std::vector<pid_t> processes_that(const Match& match, pid_t except) {
  std::vector<pid_t> out;
  auto ours = own_line();
  ours.push_back(except);
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc", error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    pid_t pid = 0;
    const auto parsed = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (parsed.ptr != name.data() + name.size() || pid <= 1) continue;
    if (std::find(ours.begin(), ours.end(), pid) != ours.end()) continue;
    if (match(environment_of(pid)) && process_lives(pid, 0)) out.push_back(pid);
  }
  return out;
}

bool has_word(const std::vector<std::string>& words, const std::string& wanted) {
  return std::find(words.begin(), words.end(), wanted) != words.end();
}

Match of_run(std::string_view run_id) {
  return [wanted = "KERF_RUN_ID=" + std::string(run_id)](const auto& words) {
    return has_word(words, wanted);
  };
}

/// A user may have put KERF_INSTANCE into the environment of a shell; only started programs have a run besides.
Match of_instance(std::string_view instance) {
  return [wanted = "KERF_INSTANCE=" + std::string(instance)](const auto& words) {
    return has_word(words, wanted) && std::any_of(words.begin(), words.end(), [](const auto& word) {
             return word.size() > 12 && word.compare(0, 12, "KERF_RUN_ID=") == 0;
           });
  };
}

void signal_all(const std::vector<pid_t>& pids, const Match& match,
                std::initializer_list<int> signals) {
  for (const pid_t pid : pids) {
    // The descriptor pins the process: a number that was used again meanwhile is seen by the second look.
    const int fd = open_pidfd(pid);
    if (fd < 0) continue;
    if (match(environment_of(pid))) {
      for (const int number : signals)
        (void)::syscall(SYS_pidfd_send_signal, fd, number, nullptr, 0);
    }
    close_fd(fd);
  }
}

std::vector<std::string> end_all(const Match& match, int patience_ms, pid_t except = -1) {
  constexpr int kLongestStepMs = 16;
  const auto clock = make_real_clock();
  const auto pause = [&](int ms) {
    WaitSpec spec;
    spec.wake_at(clock->now() + ms * kMillisecond);
    clock->wait(spec);
    // Those that are our children would stay as zombies.
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    return processes_that(match, except);
  };
  auto left = processes_that(match, except);
  // A stopped process takes no signal but SIGCONT and SIGKILL.
  signal_all(left, match, {SIGTERM, SIGCONT});
  const Nanos limit = clock->now() + patience_ms * kMillisecond;
  for (int ms = 1; !left.empty() && clock->now() < limit; ms = std::min(2 * ms, kLongestStepMs))
    left = pause(ms);
  std::vector<std::string> killed;
  killed.reserve(left.size());
  for (const pid_t pid : left) killed.push_back(process_name(pid));
  // New ones may have been started by those that were asked to end.
  for (int round = 0; !left.empty() && round < 400; ++round) {
    signal_all(left, match, {SIGKILL});
    left = pause(5);
  }
  return killed;
}

}  // namespace

std::vector<pid_t> processes_of_run(std::string_view run_id, pid_t except) {
  if (run_id.empty()) return {};
  return processes_that(of_run(run_id), except);
}

std::vector<pid_t> processes_of_instance(std::string_view instance) {
  return processes_that(of_instance(instance), -1);
}

std::vector<std::string> end_processes_of_run(std::string_view run_id, int patience_ms,
                                              pid_t except) {
  if (run_id.empty()) return {};
  return end_all(of_run(run_id), patience_ms, except);
}

std::vector<std::string> end_processes_of_instance(std::string_view instance, int patience_ms) {
  return end_all(of_instance(instance), patience_ms);
}

}  // namespace kerf::rtapi
