// halrun's and realtime's exit codes, and that nothing is left behind, whatever ends them.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <vector>

#include "hal/eventually.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder with scripts, and programs that run in it for an instance of their own.
class Sandbox {
 public:
  Sandbox() {
    static int count = 0;
    instance = "halrun-" + std::to_string(::getpid()) + "-" + std::to_string(++count);
    folder = fs::temp_directory_path() / instance;
    fs::create_directories(folder);
    write("good.hal", "newsig a bit\n");
    write("bad.hal", "newsig a bit\nsetp nosuch 1\nnewsig b bit\n");
    write("quit.hal", "newsig a bit\nquit\nsetp nosuch 1\n");
    write("sub.hal", "newsig [NAMES]SIGNAL bit\n");
    write("good.tcl", "puts \"ini [info exists ::NAMES(SIGNAL)]\"\nnewsig a bit\n");
    write("bad.tcl", "getp nosuch\nputs after\n");
    write("exit7.tcl", "exit 7\n");
    write("machine.ini", "[NAMES]\nSIGNAL = s\n");
    write("broken.ini", "NAMES]\n");
    write("noending", "newsig a bit\n");
    write("hang.hal", "loadusr -w touch started\nloadusr -w sleep 1000\n");
    write("hang.tcl", "loadusr -w touch started\nwhile 1 {}\n");
    write("wait.tcl", "loadusr -w touch started\nloadusr -w sleep 1000\n");
  }
  ~Sandbox() {
    if (pid > 0) {
      ::kill(pid, SIGKILL);
      ::waitpid(pid, nullptr, 0);
    }
    (void)rtapi::Segment::remove(instance);
    fs::remove_all(folder);
  }
  Sandbox(const Sandbox&) = delete;
  Sandbox& operator=(const Sandbox&) = delete;

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream in(folder / name);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
  }
  void start(std::vector<std::string> words, const std::string& input = "") {
    write("input", input);
    words[0] = std::string(KERF_BUILD_DIR) + "/bin/" + words[0];
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid = ::fork();
    if (pid != 0) return;
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    ::setenv("KERF_INSTANCE", instance.c_str(), 1);
    ::setenv("XDG_STATE_HOME", folder.c_str(), 1);
    ::unsetenv("KERF_RUN_ID");
    ::dup2(::open("input", O_RDONLY), 0);
    ::dup2(::open("log", O_CREAT | O_WRONLY | O_APPEND, 0600), 1);
    ::dup2(1, 2);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int wait() {
    int status = -1;
    if (!eventually([&] { return ::waitpid(pid, &status, WNOHANG) == pid; })) return -1;
    pid = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  int run(const std::vector<std::string>& words, const std::string& input = "") {
    start(words, input);
    return wait();
  }
  [[nodiscard]] bool started() const {
    return eventually([&] { return fs::exists(folder / "started"); });
  }
  /// Processes whose environment names this instance.
  [[nodiscard]] std::vector<std::string> processes(const std::string& name = "") const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator("/proc")) {
      const std::string number = entry.path().filename().string();
      if (number.find_first_not_of("0123456789") != std::string::npos) continue;
      const std::int64_t other = std::stoll(number);
      const std::string environment = rtapi::read_process_file(other, "environ");
      if (environment.find("KERF_INSTANCE=" + instance + std::string(1, '\0')) == std::string::npos)
        continue;
      const std::string own = rtapi::process_name(static_cast<pid_t>(other));
      if (rtapi::process_lives(other, 0) && (name.empty() || own == name)) out.push_back(number);
    }
    return out;
  }
  [[nodiscard]] bool nothing_left() const {
    return eventually([&] { return processes().empty(); }) &&
           !fs::exists("/dev/shm/kerf-" + instance);
  }

  std::string instance;
  fs::path folder;
  pid_t pid{-1};
};

struct ExitCode {
  std::vector<std::string> arguments;
  int status;
  const char* input{""};
  const char* log{""};  ///< part of what is printed
};

/// The peer's codes, but for the last lines, where it stays at 0 or has no such form.
TEST(Halrun, ExitCodes) {
  const ExitCode table[] = {
      {{"good.hal"}, 0},
      {{"bad.hal"}, 1, "", "bad.hal:2: parameter or pin 'nosuch' not found"},
      {{"-k", "bad.hal"}, 1},
      {{"-s", "good.hal"}, 0},
      {{"-v", "good.hal"}, 0},
      {{"quit.hal"}, 0},
      {{"good.tcl"}, 0},
      {{"bad.tcl"}, 1, "", "bad.tcl:1: pin or parameter 'nosuch' not found"},
      {{"-k", "bad.tcl"}, 1},
      {{"-v", "good.tcl"}, 0},
      {{"exit7.tcl"}, 7},
      {{"nosuch.hal"}, 255, "", "nosuch.hal"},
      {{"nosuch.tcl"}, 1, "", "nosuch.tcl"},
      {{"noending"}, 1, "", "'noending': expected a file that ends in .hal or .tcl"},
      {{"-f", "good.hal"}, 0},
      {{"-f", "bad.tcl"}, 1},
      {{"-f"}, 1},
      {{"-x", "good.hal"}, 1, "", "halrun -h"},
      {{"good.hal", "good.hal"}, 1, "", "one file only"},
      {{"-f", "good.hal", "good.hal"}, 1, "", "one file only"},
      {{"-i", "machine.ini", "sub.hal"}, 0},
      {{"sub.hal"}, 1},
      {{"-i", "machine.ini", "good.tcl"}, 0, "", "ini 1"},
      {{"good.tcl"}, 0, "", "ini 0"},
      {{"-i", "nosuch.ini", "good.hal"}, 255, "", "nosuch.ini"},
      {{"-i", "broken.ini", "good.tcl"}, 255, "", "broken.ini:1"},
      {{"-h"}, 0, "", "halrun -T"},
      {{"-U"}, 0},
      {{"-I", "good.hal"}, 0},
      {{"-I", "good.hal"}, 0, "getp nosuch\n", "pin or parameter 'nosuch' not found"},
      {{"-I", "bad.hal"}, 1, "newsig c bit\nlist sig\n", "a c"},
      {{"-I", "good.tcl"}, 0, "list sig\n", "a "},
      {{"-T", "good.tcl"}, 0, "puts [hal list sig]\nexit 5\n", "a "},
      {{"-T", "good.hal"}, 0, "puts \"sum [expr {1 + 1}]\"\n", "sum 2"},
      {{"-T"}, 0, "getp nosuch\nputs next\n", "next"},
      {{"-T", "-i", "machine.ini"}, 0, "puts $::NAMES(SIGNAL)x\n", "sx"},
      {{}, 0, "newsig a bit\nlist sig\n", "a "},
      {{"-"}, 1, "setp nosuch 1\n", "<stdin>:1: "},
  };
  for (const ExitCode& row : table) {
    Sandbox here;
    std::vector<std::string> words{"halrun"};
    words.insert(words.end(), row.arguments.begin(), row.arguments.end());
    std::string line;
    for (const auto& word : words) line += word + " ";
    EXPECT_EQ(here.run(words, row.input), row.status) << line << "\n" << here.read("log");
    EXPECT_THAT(here.read("log"), HasSubstr(row.log)) << line;
    EXPECT_TRUE(here.nothing_left()) << line;
  }
}

class HalrunEnds : public testing::TestWithParam<std::tuple<const char*, int>> {};
TEST_P(HalrunEnds, WithEverythingOnASignal) {
  Sandbox here;
  here.start({"halrun", std::get<0>(GetParam())});
  ASSERT_TRUE(here.started()) << here.read("log");
  ::kill(here.pid, std::get<1>(GetParam()));
  const int status = here.wait();
  EXPECT_NE(status, 0);
  EXPECT_NE(status, -1);
  EXPECT_TRUE(here.nothing_left());
}
INSTANTIATE_TEST_SUITE_P(All, HalrunEnds,
                         testing::Combine(testing::Values("hang.hal", "hang.tcl", "wait.tcl"),
                                          testing::Values(SIGTERM, SIGINT, SIGHUP, SIGKILL)));

TEST(Halrun, AKilledPartEndsIt) {
  for (const char* part : {"haltcl", "rtapi_app"}) {
    Sandbox here;
    here.start({"halrun", "wait.tcl"});
    ASSERT_TRUE(eventually([&] { return !here.processes("sleep").empty(); }));
    const auto found = here.processes(part);
    ASSERT_EQ(found.size(), 1U) << part;
    ::kill(std::stoi(found[0]), SIGKILL);
    EXPECT_NE(here.wait(), 0);
    EXPECT_TRUE(here.nothing_left()) << part;
  }
}

TEST(Halrun, ASignalDuringTheStartLeavesNothing) {
  // At whatever moment it comes.
  for (int round = 0; round < 20; ++round) {
    Sandbox here;
    here.start({"halrun", "wait.tcl"});
    const auto clock = rtapi::make_real_clock();
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + round * 2 * rtapi::kMillisecond);
    clock->wait(spec);
    ::kill(here.pid, round % 2 == 0 ? SIGINT : SIGTERM);
    EXPECT_NE(here.wait(), 0);
    EXPECT_TRUE(here.nothing_left()) << "round " << round;
  }
}

TEST(Realtime, StartsAndStopsAHost) {
  Sandbox here;
  const auto realtime = [&](const char* word) { return here.run({"realtime", word}); };
  EXPECT_EQ(realtime("status"), 1);
  EXPECT_EQ(realtime("verify"), 0);
  EXPECT_EQ(realtime("stop"), 0);
  EXPECT_EQ(realtime("start"), 0) << here.read("log");
  EXPECT_EQ(realtime("status"), 0);
  const auto first = here.processes("rtapi_app");
  EXPECT_EQ(first.size(), 1U);
  EXPECT_EQ(realtime("start"), 0);
  EXPECT_EQ(here.processes("rtapi_app"), first);
  EXPECT_EQ(here.run({"halcmd", "newsig", "a", "bit"}), 0);
  EXPECT_EQ(realtime("restart"), 0);
  EXPECT_NE(here.processes("rtapi_app"), first);
  EXPECT_EQ(here.run({"halcmd", "gets", "a"}), 1);
  EXPECT_EQ(realtime("unload"), 0);
  EXPECT_EQ(realtime("status"), 1);
  EXPECT_TRUE(here.nothing_left());
  EXPECT_EQ(realtime("nonsense"), 1);
  EXPECT_THAT(here.read("log"), HasSubstr("Usage: realtime {start|load|stop|unload|restart"));
}

TEST(Realtime, SaysWhyAHostDoesNotStart) {
  Sandbox here;
  here.instance = "no/name";
  EXPECT_EQ(here.run({"realtime", "start"}), 1);
  EXPECT_THAT(here.read("log"), HasSubstr("is not a name for an instance"));
  here.instance = "none";
}

}  // namespace
}  // namespace kerf::hal::test
