#include "hal/loader/leftovers.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/process.hpp"

namespace kerf::hal {

std::vector<pid_t> processes_of_run(std::string_view run_id) {
  std::vector<pid_t> out;
  if (run_id.empty()) return out;
  const std::string wanted = "KERF_RUN_ID=" + std::string(run_id);
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc", error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    pid_t pid = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), pid).ptr !=
        name.data() + name.size())
      continue;
    if (pid <= 1 || pid == ::getpid()) continue;
    std::ifstream file(it->path() / "environ", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    std::string_view rest(text);
    while (!rest.empty()) {
      const auto length = std::min(rest.find('\0'), rest.size());
      if (rest.substr(0, length) == wanted) {
        if (rtapi::process_lives(pid, 0)) out.push_back(pid);
        break;
      }
      rest.remove_prefix(std::min(length + 1, rest.size()));
    }
  }
  return out;
}

int end_processes_of_run(std::string_view run_id, int patience_ms) {
  constexpr int kStepMs = 5;
  const auto clock = rtapi::make_real_clock();
  const auto pause = [&] {
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + kStepMs * rtapi::kMillisecond);
    clock->wait(spec);
    // Those that are our children would stay as zombies.
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {
    }
  };
  auto left = processes_of_run(run_id);
  for (const pid_t pid : left) ::kill(pid, SIGTERM);
  for (int waited = 0; !left.empty() && waited < patience_ms; waited += kStepMs) {
    pause();
    left = processes_of_run(run_id);
  }
  const int killed = static_cast<int>(left.size());
  // New ones may have been started by those that were asked to end.
  for (int round = 0; !left.empty() && round < 400; ++round) {
    for (const pid_t pid : left) ::kill(pid, SIGKILL);
    pause();
    left = processes_of_run(run_id);
  }
  return killed;
}

}  // namespace kerf::hal
