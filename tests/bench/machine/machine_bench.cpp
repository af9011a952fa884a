// Virtual over real time of a whole machine that cuts the sample part: in the harness (one thread) and with the true programs.
// Prints ratios of one run on this machine; the goals are 200 and 20.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "harness/machine.hpp"
#include "rtapi/clock/real_clock.hpp"

namespace kerf {
namespace {

constexpr const char* kPart = KERF_SOURCE_DIR "/nc_files/examples/first_part.ngc";

double seconds_since(rtapi::Nanos start) {
  return static_cast<double>(rtapi::monotonic_now() - start) * 1e-9;
}

/// Virtual seconds per real second, or 0 on failure.
double harness_ratio() {
  auto machine = harness::Machine::start();
  if (!machine->ready() || !machine->power_on_and_home()) {
    std::fprintf(stderr, "machine: %s\n", machine->errors().c_str());
    return 0;
  }
  const auto virtual_start = machine->now();
  const auto start = rtapi::monotonic_now();
  if (machine->run_program(kPart).state != task::CommandState::done) {
    std::fprintf(stderr, "machine: %s\n", machine->errors().c_str());
    return 0;
  }
  return static_cast<double>(machine->now() - virtual_start) * 1e-9 / seconds_since(start);
}

/// The whole of `kerf --virtual --once`, start-up and homing included in real time, counted by the joint log's length.
double process_ratio() {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("kerf-bench-" + std::to_string(getpid()));
  fs::create_directories(folder / "configs/sim");
  fs::copy(KERF_SOURCE_DIR "/configs/sim/mill", folder / "configs/sim/mill",
           fs::copy_options::recursive);
  fs::create_directory_symlink(KERF_SOURCE_DIR "/nc_files", folder / "nc_files");
  const std::string log = (folder / "joints.log").string();
  const std::string ini = (folder / "configs/sim/mill/mill.ini").string();
  const std::string instance = "bench-" + std::to_string(getpid());
  const auto start = rtapi::monotonic_now();
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder.c_str()) != 0 || std::freopen("/dev/null", "w", stdout) == nullptr ||
        std::freopen("/dev/null", "w", stderr) == nullptr)
      _exit(126);
    execl(KERF_BUILD_DIR "/bin/kerf", "kerf", ini.c_str(), "--virtual", "--once", "--program",
          kPart, "--log-joints", log.c_str(), "--instance", instance.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const double real_s = seconds_since(start);
  long long first = -1;
  long long last = 0;
  std::ifstream in(log);
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] < '0' || line[0] > '9') continue;
    last = std::atoll(line.c_str());
    if (first < 0) first = last;
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (status != 0 || first < 0) {
    std::fprintf(stderr, "kerf ended with status %d\n", status);
    return 0;
  }
  return static_cast<double>(last) * 1e-9 / real_s;
}

}  // namespace
}  // namespace kerf

int main() {
  double harness = 0;
  double processes = 0;
  for (int round = 0; round < 3; ++round) {
    harness = std::max(harness, kerf::harness_ratio());
    processes = std::max(processes, kerf::process_ratio());
  }
  std::printf("machine  virtual over real time, best of 3\n");
  std::printf("  harness    %8.0f   (goal 200)\n", harness);
  std::printf("  processes  %8.0f   (goal 20; start-up, homing and joint log included)\n",
              processes);
  return harness > 0 && processes > 0 ? 0 : 1;
}
