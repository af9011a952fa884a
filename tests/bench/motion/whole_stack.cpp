#include "bench/motion/whole_stack.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "bench/motion/families.hpp"
#include "bench/motion/seconds.hpp"
#include "harness/machine.hpp"
#include "harness/module_of.hpp"

namespace kerf::bench {
namespace {

namespace fs = std::filesystem;

/// XYZ with the limits of reference_machine(), homed where it stands, position fed back as it is commanded.
constexpr double kVel = 200, kAcc = 1750;
/// At the feed but for that.
constexpr double kAtFeed = 0.999;

void append(std::string& text, const char* format, double a, double b = 0, double c = 0,
            double d = 0) {
  char line[200];
  std::snprintf(line, sizeof line, format, a, b, c, d);
  text += line;
}

std::string ini_text(double jerk) {
  std::string text =
      "[EMC]\nVERSION = 1.1\nMACHINE = bench\n[RS274NGC]\nPARAMETER_FILE = bench.var\n"
      "[EMCMOT]\nEMCMOT = motmod\nSERVO_PERIOD = 1000000\n[TASK]\nTASK = milltask\nCYCLE_TIME = "
      "0.010\n[HAL]\nHALFILE = bench.hal\n[TRAJ]\nCOORDINATES = X Y Z\nLINEAR_UNITS = "
      "mm\nANGULAR_UNITS = degree\nDEFAULT_LINEAR_VELOCITY = 50\nMAX_LINEAR_VELOCITY = 200\n"
      "[KINS]\nKINEMATICS = trivkins coordinates=XYZ\nJOINTS = 3\n[KERF]\nCLOCK = virtual\n";
  for (int j = 0; j < 3; ++j) {
    const char* limits =
        "MIN_LIMIT = -100000\nMAX_LIMIT = 100000\nMAX_VELOCITY = %g\nMAX_ACCELERATION = %g\n";
    text += std::string("[AXIS_") + "XYZ"[j] + "]\n";
    append(text, limits, j == 2 ? 150 : kVel, kAcc);
    if (jerk > 0) append(text, "MAX_JERK = %g\n", jerk);
    append(text, "[JOINT_%g]\nTYPE = LINEAR\nFERROR = 1\nHOME_SEQUENCE = 0\n", j);
    append(text, limits, j == 2 ? 150 : kVel, kAcc);
    if (jerk > 0) append(text, "MAX_JERK = %g\n", jerk);
  }
  return text;
}

std::string hal_text() {
  std::string text =
      "loadrt [KINS]KINEMATICS\nloadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD "
      "num_joints=[KINS]JOINTS\naddf motion-command-handler servo-thread\naddf motion-controller "
      "servo-thread\n";
  for (int j = 0; j < 3; ++j)
    append(text, "net pos%g joint.%g.motor-pos-cmd => joint.%g.motor-pos-fb\n", j, j, j);
  text +=
      "net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in\nnet prep "
      "iocontrol.0.tool-prepare => iocontrol.0.tool-prepared\nnet change iocontrol.0.tool-change "
      "=> iocontrol.0.tool-changed\n";
  return text;
}

class Folder {
 public:
  explicit Folder(double jerk)
      : path_(fs::temp_directory_path() / ("kerf-stack-" + std::to_string(getpid()))) {
    fs::create_directories(path_);
    std::ofstream(path_ / "bench.ini") << ini_text(jerk);
    std::ofstream(path_ / "bench.hal") << hal_text();
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string ini() const { return (path_ / "bench.ini").string(); }
  [[nodiscard]] std::string write(const std::string& text) const {
    std::ofstream(path_ / "program.ngc") << text;
    return (path_ / "program.ngc").string();
  }

 private:
  fs::path path_;
};

double processor_now() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

/// Processor time of a whole session that runs this program; below 0: it failed.
double session(const Folder& folder, const std::string& text) {
  const std::string program = folder.write(text), ini = folder.ini(),
                    instance = "stack-" + std::to_string(getpid());
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (std::freopen("/dev/null", "w", stdout) == nullptr ||
        std::freopen("/dev/null", "w", stderr) == nullptr)
      _exit(126);
    execl(KERF_BUILD_DIR "/bin/kerf", "kerf", ini.c_str(), "--virtual", "--once", "--program",
          program.c_str(), "--instance", instance.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child || status != 0) return -1;
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// What a HAL function takes: one function of this component stands before it in the thread, the other behind it.
struct Watch {
  static constexpr std::size_t kSwept = std::size_t{2} << 20U;  ///< more than a core's own caches

  static Watch& the() {
    static Watch watch;
    return watch;
  }
  void start() {
    if (sweeps)
      for (std::size_t i = 0; i < kSwept; i += 64) other[i] = static_cast<char>(other[i] + 1);
    began = seconds_now();
  }
  void stop() { seconds.push_back(seconds_now() - began); }
  bool sweeps{false};
  double began{0};
  std::vector<char> other{std::vector<char>(kSwept)};
  std::vector<double> seconds;
};

class Stopwatch final : public hal::Component<Stopwatch> {
 public:
  static constexpr hal::Info kInfo{
      .name = "stopwatch", .summary = "Times what lies between two functions", .singleton = true};
  using Component::Component;

 private:
  void start(const hal::Period&) noexcept { Watch::the().start(); }
  void stop(const hal::Period&) noexcept { Watch::the().stop(); }
  hal::Function start_{function<&Stopwatch::start>("start", "Begins")};
  hal::Function stop_{function<&Stopwatch::stop>("stop", "Ends")};
};

constexpr hal::Module kStopwatch = hal::test::module_of<Stopwatch>();

}  // namespace

StackProgram freeform_lines(int lines, bool merges, std::uint64_t seed) {
  const Program program = freeform(lines, 0.01, 100, seed, merges);
  StackProgram out{merges ? "G21 G90 G64 P0.01\nG1 F6000\n" : "G21 G90 G64 P0.01 Q0\nG1 F6000\n"};
  for (const auto& item : program.items)
    if (const auto* line = std::get_if<motion::LinearMove>(&item)) {
      append(out.text, "X%.4f Y%.4f Z%.4f\n", line->end.x, line->end.y, line->end.z);
      ++out.lines;
    }
  out.text += "M2\n";
  return out;
}

StackProgram dense_lines(int lines, bool merges) {
  constexpr double kStep = 0.02, kRadius = 40;
  StackProgram out{merges ? "G21 G90 G64 P0.01\nG1 F6000\n" : "G21 G90 G64 P0.01 Q0\nG1 F6000\n"};
  for (int i = 1; i <= lines; ++i)
    append(out.text, "X%.5f Y%.5f\n", kRadius * std::sin(i * kStep / kRadius),
           kRadius * (1 - std::cos(i * kStep / kRadius)));
  out.text += "M2\n";
  out.lines = static_cast<std::size_t>(lines);
  out.feed_mm_s = 100;
  return out;
}

StackResult run_in_harness(const StackProgram& program, double jerk) {
  StackResult out;
  const Folder folder(jerk);
  harness::MachineOptions options;
  options.ini = folder.ini();
  auto machine = harness::Machine::start(options);
  if (!machine->ready() || !machine->power_on_and_home()) {
    out.error = machine->errors();
    return out;
  }
  double slowest = 1;
  bool at_feed = false;
  if (program.feed_mm_s > 0)
    machine->on_cycle([&](const motion::MotionStatus& s) {
      const double share = s.vel_mm_s / program.feed_mm_s;
      if (share >= kAtFeed) {
        at_feed = true;
        out.slowest = slowest;
      }
      if (at_feed) slowest = std::min(slowest, share);
    });
  const std::string file = machine->write_program(program.text);
  const auto began = machine->now();
  const double start = processor_now();
  const auto reply = machine->run_program(file);
  out.processor_s = processor_now() - start;
  out.seconds = static_cast<double>(machine->now() - began) * 1e-9;
  if (reply.state != task::CommandState::done) out.error = machine->errors() + reply.text.c_str();
  return out;
}

ServoCost servo_function(const StackProgram& program, double jerk, bool sweeps) {
  ServoCost out;
  const Folder folder(jerk);
  harness::MachineOptions options;
  options.ini = folder.ini();
  options.modules = {{"stopwatch", &kStopwatch}};
  options.hal = {"loadrt stopwatch", "addf stopwatch.start servo-thread 2",
                 "addf stopwatch.stop servo-thread"};
  auto machine = harness::Machine::start(options);
  if (!machine->ready() || !machine->power_on_and_home()) {
    out.error = machine->errors();
    return out;
  }
  Watch& watch = Watch::the();
  watch.sweeps = sweeps;
  watch.seconds.clear();
  if (program.lines == 0) {
    machine->run_for(20);
  } else if (const auto reply = machine->run_program(machine->write_program(program.text));
             reply.state != task::CommandState::done) {
    out.error = machine->errors() + reply.text.c_str();
  }
  auto& seconds = watch.seconds;
  // Cycles that the system interrupted are no cost of the function.
  std::erase_if(seconds, [](double s) { return s > kInterrupted; });
  if (seconds.empty()) return out;
  std::sort(seconds.begin(), seconds.end());
  out.cycles = seconds.size();
  for (const double s : seconds) out.mean_us += s * 1e6 / static_cast<double>(out.cycles);
  out.p50_us = seconds[out.cycles / 2] * 1e6;
  out.p99_us = seconds[out.cycles * 99 / 100] * 1e6;
  return out;
}

StackResult run_in_processes(const StackProgram& program, double jerk) {
  StackResult out;
  const Folder folder(jerk);
  const double whole = session(folder, program.text), empty = session(folder, "M2\n");
  if (whole < 0 || empty < 0) out.error = "the session failed";
  out.processor_s = whole - empty;
  return out;
}

}  // namespace kerf::bench
