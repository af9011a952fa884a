// The true programs: kerf, rtapi_app, milltask as processes with real shared memory and sockets.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "motion/api/shared.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/status.hpp"

namespace kerf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A folder of its own with copies of the sample machine; everything a run writes stays in it.
struct Place {
  fs::path folder;
  std::string instance;
  explicit Place(const std::string& name)
      : instance("mt-" + name + "-" + std::to_string(getpid())) {
    folder = fs::temp_directory_path() / ("kerf-" + instance);
    fs::create_directories(folder / "configs/sim");
    fs::copy(KERF_SOURCE_DIR "/configs/sim/mill", folder / "configs/sim/mill",
             fs::copy_options::recursive);
    fs::create_directory_symlink(KERF_SOURCE_DIR "/nc_files", folder / "nc_files");
    std::error_code none;
    fs::remove(folder / "configs/sim/mill/mill.var", none);
  }
  ~Place() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  [[nodiscard]] std::string ini() const { return (folder / "configs/sim/mill/mill.ini").string(); }
  [[nodiscard]] std::string part() const {
    return (folder / "nc_files/examples/first_part.ngc").string();
  }
};

/// A program of the build, in the background, its output in a file.
struct Program {
  pid_t pid{-1};
  fs::path output;
  Program(const Place& place, const std::vector<std::string>& words)
      : output(place.folder / "output.txt") {
    pid = fork();
    if (pid == 0) {
      if (chdir(place.folder.c_str()) != 0) _exit(126);
      const int out = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      dup2(out, 1);
      dup2(out, 2);
      const int in = open("/dev/null", O_RDONLY);
      dup2(in, 0);
      std::vector<char*> argv;
      std::vector<std::string> copy = words;
      copy[0] = std::string(KERF_BUILD_DIR "/bin/") + copy[0];
      for (auto& w : copy) argv.push_back(w.data());
      argv.push_back(nullptr);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  /// Exit status, -signal, or -1000 when it does not end within `limit_s` (it is then killed).
  int wait(double limit_s = 120) {
    auto clock = rtapi::make_real_clock();
    const auto end = clock->now() + rtapi::seconds(limit_s);
    int status = 0;
    while (waitpid(pid, &status, WNOHANG) == 0) {
      if (clock->now() > end) {
        kill(pid, SIGKILL);
        waitpid(pid, &status, 0);
        return -1000;
      }
      rtapi::WaitSpec spec;
      spec.until = clock->now() + 5 * rtapi::kMillisecond;
      clock->wait(spec);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  [[nodiscard]] std::string text() const { return read_file(output); }
};

/// Processes that carry KERF_INSTANCE=instance in their environment.
std::vector<pid_t> processes_of(const std::string& instance) {
  std::vector<pid_t> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string environment = read_file(entry.path() / "environ");
    const std::string wanted = "KERF_INSTANCE=" + instance;
    const auto at = environment.find(wanted);
    if (at == std::string::npos) continue;
    if (at + wanted.size() < environment.size() && environment[at + wanted.size()] != '\0')
      continue;
    const pid_t pid = std::stoi(name);
    if (rtapi::process_lives(pid, 0)) found.push_back(pid);
  }
  return found;
}

/// What is left of an instance, in words; "" when nothing is.
std::string leftovers(const std::string& instance) {
  std::string text;
  for (const pid_t pid : processes_of(instance))
    text += "process " + std::to_string(pid) + " " + rtapi::process_name(pid) + "; ";
  if (fs::exists("/dev/shm" + rtapi::segment_name(instance))) text += "segment; ";
  if (read_file("/proc/net/unix").find("@kerf-" + instance + "-") != std::string::npos)
    text += "socket; ";
  return text;
}

bool gone_within(const std::string& instance, double limit_s) {
  auto clock = rtapi::make_real_clock();
  const auto end = clock->now() + rtapi::seconds(limit_s);
  while (!leftovers(instance).empty()) {
    if (clock->now() > end) return false;
    rtapi::WaitSpec spec;
    spec.until = clock->now() + 10 * rtapi::kMillisecond;
    clock->wait(spec);
  }
  return true;
}

void pause_ms(int ms) {
  auto clock = rtapi::make_real_clock();
  rtapi::WaitSpec spec;
  spec.until = clock->now() + ms * rtapi::kMillisecond;
  clock->wait(spec);
}

pid_t find_process(const std::string& instance, const std::string& name, const pid_t kerf) {
  if (name == "kerf") return kerf;
  for (const pid_t pid : processes_of(instance))
    if (rtapi::process_name(pid) == name) return pid;
  return -1;
}

TEST(Processes, OneCommandCutsThePartAndLeavesNothing) {
  const Place place("once");
  Program run(place, {"kerf", place.ini(), "--virtual", "--once", "--program", place.part(),
                      "--instance", place.instance});
  EXPECT_EQ(run.wait(), 0) << run.text();
  EXPECT_THAT(run.text(), HasSubstr("machine time"));
  EXPECT_THAT(read_file(place.folder / "toolpath.svg"), HasSubstr("</svg>"));
  EXPECT_EQ(leftovers(place.instance), "");
}

TEST(Processes, TwoVirtualRunsAreByteIdentical) {
  std::string log[2];
  for (auto& text : log) {
    const Place place("same");
    const auto file = place.folder / "joints.log";
    Program run(place, {"kerf", place.ini(), "--virtual", "--once", "--program", place.part(),
                        "--instance", place.instance, "--log-joints", file.string()});
    ASSERT_EQ(run.wait(), 0) << run.text();
    text = read_file(file);
  }
  EXPECT_GT(log[0].size(), 1000000U);
  EXPECT_TRUE(log[0] == log[1]);
}

TEST(Processes, TwoInstancesAtOnceDoNotTouchEachOther) {
  const Place a("two-a"), b("two-b");
  Program run_a(a, {"kerf", a.ini(), "--virtual", "--once", "--program", a.part(), "--instance",
                    a.instance, "--log-joints", "joints.log"});
  Program run_b(b, {"kerf", b.ini(), "--virtual", "--once", "--program", b.part(), "--instance",
                    b.instance, "--log-joints", "joints.log"});
  EXPECT_EQ(run_a.wait(), 0) << run_a.text();
  EXPECT_EQ(run_b.wait(), 0) << run_b.text();
  EXPECT_TRUE(read_file(a.folder / "joints.log") == read_file(b.folder / "joints.log"));
}

TEST(Processes, ASecondStartOfALiveInstanceIsRefusedByName) {
  const Place place("live");
  Program first(place, {"kerf", place.ini(), "--instance", place.instance});
  auto clock = rtapi::make_real_clock();
  for (int i = 0; i < 2000 && !fs::exists("/dev/shm" + rtapi::segment_name(place.instance)); ++i)
    pause_ms(10);
  const Place other("live2");
  Program second(other, {"kerf", other.ini(), "--once", "--instance", place.instance});
  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(second.text(), HasSubstr(std::to_string(first.pid)));
  kill(first.pid, SIGINT);
  EXPECT_GE(first.wait(20), 0) << first.text();
  EXPECT_TRUE(gone_within(place.instance, 10)) << leftovers(place.instance);
}

TEST(Processes, BadIniAndBadProgramExitWithOneMessage) {
  const Place place("bad");
  {
    std::string text = read_file(place.ini());
    const auto at = text.find("MAX_ACCELERATION = 1000");
    text.replace(at, 23, "MAX_ACCELERATION = fast");
    std::ofstream(place.folder / "configs/sim/mill/bad.ini") << text;
    Program run(place, {"kerf", (place.folder / "configs/sim/mill/bad.ini").string(), "--virtual",
                        "--once", "--program", place.part(), "--instance", place.instance});
    EXPECT_EQ(run.wait(), 1);
    EXPECT_THAT(run.text(), HasSubstr("bad.ini:"));
    EXPECT_THAT(run.text(), HasSubstr("MAX_ACCELERATION"));
  }
  std::ofstream(place.folder / "bad.ngc") << "G21\nG1 X5 F100\nG1 Y[1+\nM2\n";
  Program run(place, {"kerf", place.ini(), "--virtual", "--once", "--program",
                      (place.folder / "bad.ngc").string(), "--instance", place.instance});
  EXPECT_EQ(run.wait(), 1) << run.text();
  EXPECT_THAT(run.text(), HasSubstr("bad.ngc:3"));
  EXPECT_EQ(leftovers(place.instance), "");
}

/// kill -9 of each part, at random points of start, homing and program, on both clocks; then the next start works.
TEST(Processes, KilledAnywhereNothingIsLeftAndTheNextStartWorks) {
  const Place place("kill");
  std::mt19937 random(
      20261121);  // NOLINT(bugprone-random-generator-seed): a repeatable choice of points
  const char* const victims[]{"rtapi_app", "milltask", "kerf"};
  for (int round = 0; round < 20; ++round) {
    const std::string victim = victims[round % 3];
    std::vector<std::string> words{"kerf",       place.ini(),  "--once",      "--program",
                                   place.part(), "--instance", place.instance};
    if (round % 2 == 0) words.insert(words.end(), {"--virtual", "--speed", "30"});
    Program run(place, words);
    const int after_ms = 30 + static_cast<int>(random() % 2500);
    pause_ms(after_ms);
    const pid_t pid = find_process(place.instance, victim, run.pid);
    if (pid > 0) kill(pid, SIGKILL);
    const int status = run.wait(20);
    const std::string where = "round " + std::to_string(round) + ", " + victim + " after " +
                              std::to_string(after_ms) + " ms: ";
    EXPECT_NE(status, -1000) << where << "kerf did not end\n" << run.text();
    if (victim == "kerf") {
      EXPECT_EQ(status, -SIGKILL) << where;
    } else if (pid > 0) {
      EXPECT_NE(status, 0) << where << run.text();
      EXPECT_THAT(run.text(), HasSubstr(victim)) << where << "the dead part is not named";
    }
    ASSERT_TRUE(gone_within(place.instance, 10)) << where << leftovers(place.instance);
  }
  Program run(place, {"kerf", place.ini(), "--virtual", "--once", "--program", place.part(),
                      "--instance", place.instance});
  EXPECT_EQ(run.wait(), 0) << run.text();
  EXPECT_EQ(leftovers(place.instance), "");
}

TEST(Processes, MdiMovesARunningMachine) {
  const Place place("mdi");
  setenv("KERF_INSTANCE", "none", 1);  // the option must win
  Program machine(
      place, {"kerf", place.ini(), "--virtual", "--speed", "50", "--instance", place.instance});
  auto ready = [&] {
    auto segment = rtapi::Segment::attach(place.instance);
    if (!segment.ok()) return false;
    auto block = (*segment)->find<task::TaskShared>(task::kTaskBlock, task::kTaskAbi);
    return block.ok() && (*block)->ready.observe() == 1;
  };
  for (int i = 0; i < 2000 && !ready(); ++i) pause_ms(10);
  pause_ms(200);
  Program refused(place, {"mdi", "--instance", place.instance, "G0 X1"});
  EXPECT_EQ(refused.wait(20), 1) << refused.text();
  kill(machine.pid, SIGTERM);
  machine.wait(20);
  EXPECT_TRUE(gone_within(place.instance, 10)) << leftovers(place.instance);
  unsetenv("KERF_INSTANCE");
}

}  // namespace
}  // namespace kerf
