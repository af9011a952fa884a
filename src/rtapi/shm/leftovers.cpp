#include "rtapi/shm/leftovers.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <iterator>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/process.hpp"

namespace kerf::rtapi {

namespace {

/// Words NAME=VALUE of a process's environment as it was started; empty for other users' processes.
std::vector<std::string> environment_of(const std::filesystem::path& folder) {
  const std::string text =
      read_process_file(std::strtoll(folder.filename().c_str(), nullptr, 10), "environ");
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

std::vector<pid_t> processes_that(const Match& match) {
  std::vector<pid_t> out;
  const auto ours = own_line();
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc", error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    pid_t pid = 0;
    const auto parsed = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (parsed.ptr != name.data() + name.size() || pid <= 1) continue;
    if (std::find(ours.begin(), ours.end(), pid) != ours.end()) continue;
    if (match(environment_of(it->path())) && process_lives(pid, 0)) out.push_back(pid);
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

int end_all(const Match& match, int patience_ms) {
  constexpr int kStepMs = 5;
  const auto clock = make_real_clock();
  const auto pause = [&] {
    WaitSpec spec;
    spec.wake_at(clock->now() + kStepMs * kMillisecond);
    clock->wait(spec);
    // Those that are our children would stay as zombies.
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {
    }
  };
  auto left = processes_that(match);
  for (const pid_t pid : left) {
    ::kill(pid, SIGTERM);
    ::kill(pid, SIGCONT);  // a stopped process takes no signal but this and SIGKILL
  }
  for (int waited = 0; !left.empty() && waited < patience_ms; waited += kStepMs) {
    pause();
    left = processes_that(match);
  }
  const int killed = static_cast<int>(left.size());
  // New ones may have been started by those that were asked to end.
  for (int round = 0; !left.empty() && round < 400; ++round) {
    for (const pid_t pid : left) ::kill(pid, SIGKILL);
    pause();
    left = processes_that(match);
  }
  return killed;
}

}  // namespace

std::vector<pid_t> processes_of_run(std::string_view run_id) {
  if (run_id.empty()) return {};
  return processes_that(of_run(run_id));
}

std::vector<pid_t> processes_of_instance(std::string_view instance) {
  return processes_that(of_instance(instance));
}

int end_processes_of_run(std::string_view run_id, int patience_ms) {
  if (run_id.empty()) return 0;
  return end_all(of_run(run_id), patience_ms);
}

int end_processes_of_instance(std::string_view instance, int patience_ms) {
  return end_all(of_instance(instance), patience_ms);
}

}  // namespace kerf::rtapi
