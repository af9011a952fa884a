// The true programs: rtapi_app, halcmd and halrun, also when they are killed.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <vector>

#include "hal/core/view.hpp"
#include "hal/eventually.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal::test {
namespace {

using testing::HasSubstr;

const std::string bin_folder = std::string(KERF_BUILD_DIR) + "/bin/";
const std::string probe_program = std::string(KERF_BUILD_DIR) + "/tests/hal_probe_component";

class ProgramsTest : public testing::Test {
 protected:
  ProgramsTest() {
    instance_ = "test-hal-" + std::to_string(::getpid()) + "-" +
                testing::UnitTest::GetInstance()->current_test_info()->name();
    instance_.resize(std::min<std::size_t>(instance_.size(), 39));
    ::setenv("KERF_INSTANCE", instance_.c_str(), 1);
    ::unsetenv("KERF_RUN_ID");
    folder_ = std::filesystem::temp_directory_path() / instance_;
    std::filesystem::create_directories(folder_);
  }
  ~ProgramsTest() override {
    for (const pid_t pid : children_) {
      ::kill(pid, SIGKILL);
      ::waitpid(pid, nullptr, 0);
    }
    (void)rtapi::end_processes_of_run(run_id_, 0);
    (void)rtapi::end_processes_of_instance(instance_, 0);
    (void)rtapi::Segment::remove(instance_);
    std::filesystem::remove_all(folder_);
  }

  std::string file(const std::string& name, const std::string& text) {
    auto path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  static std::string read(const std::string& path) {
    std::ifstream in(path);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
  }
  /// Starts a program; both outputs go to the file "log".
  pid_t start(const std::vector<std::string>& argv) {
    const pid_t pid = ::fork();
    if (pid == 0) {
      const int log = ::open((folder_ / "log").c_str(), O_CREAT | O_WRONLY | O_APPEND, 0600);
      const int null = ::open("/dev/null", O_RDONLY);
      ::dup2(null, 0);
      ::dup2(log, 1);
      ::dup2(log, 2);
      std::vector<char*> args;
      args.reserve(argv.size() + 1);
      for (const auto& a : argv)
        args.push_back(const_cast<char*>(
            a.c_str()));  // NOLINT(cppcoreguidelines-pro-type-const-cast): exec does not write
      args.push_back(nullptr);
      ::execv(args[0], args.data());
      ::_exit(127);
    }
    children_.push_back(pid);
    return pid;
  }
  /// Exit status of a child, or -1 after `seconds`.
  int wait_for(pid_t pid, int seconds) {
    int status = -1;
    const bool ended = eventually([&] { return ::waitpid(pid, &status, WNOHANG) == pid; }, seconds);
    if (!ended) return -1;
    std::erase(children_, pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  int halrun(const std::string& script) {
    return wait_for(start({bin_folder + "halrun", script}), 60);
  }
  int halcmd(std::vector<std::string> words) {
    words.insert(words.begin(), bin_folder + "halcmd");
    return wait_for(start(words), 60);
  }
  [[nodiscard]] std::string log() const { return read((folder_ / "log").string()); }
  /// Waits until a component is ready in the running instance, and notes the run for the clean-up.
  bool component_ready(const std::string& name) {
    return eventually(
        [&] {
          auto segment = rtapi::Segment::attach(instance_);
          if (!segment.ok()) return false;
          run_id_ = std::string((*segment)->header().run_id.view());
          const auto found = View(**segment).find_component(name);
          return found && found->ready;
        },
        20);
  }
  /// No segment and no process of the instance is left.
  [[nodiscard]] bool nothing_left() const {
    return !rtapi::Segment::attach(instance_).ok() && rtapi::processes_of_run(run_id_).empty();
  }
  /// The same for all runs of the instance.
  [[nodiscard]] bool nothing_of_the_instance() const {
    return ::access(("/dev/shm" + rtapi::segment_name(instance_)).c_str(), F_OK) != 0 &&
           rtapi::processes_of_instance(instance_).empty();
  }
  static void pause_ms(int ms) {
    const auto clock = rtapi::make_real_clock();
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + ms * rtapi::kMillisecond);
    clock->wait(spec);
  }
  /// Notes the run of the instance.
  bool note_run() {
    auto segment = rtapi::Segment::attach(instance_);
    if (segment.ok()) run_id_ = std::string((*segment)->header().run_id.view());
    return segment.ok();
  }
  std::int64_t owner_pid() {
    auto segment = rtapi::Segment::attach(instance_);
    return segment.ok() ? (*segment)->header().owner_pid.get() : 0;
  }

  std::string instance_;
  std::string run_id_;
  std::filesystem::path folder_;
  std::vector<pid_t> children_;
};

TEST_F(ProgramsTest, HalrunRunsAScriptAndTakesAllDown) {
  const auto script =
      file("ok.hal",
           "loadrt threads name1=servo period1=1000000\nloadrt sum2\naddf sum2.0 servo\n"
           "loadusr -Wn probe " +
               probe_program +
               " probe\n"
               "net a sum2.0.out => probe.in\nsetp sum2.0.in0 4.5\nstart\n"
               "loadusr -w halcmd setp sum2.0.offset 1\n"
               "sleep 0.2\ngetp probe.out\nshow comp probe\n"
               "unloadusr probe\nwaitusr probe\nlist pin probe\n");
  EXPECT_EQ(halrun(script), 0) << log();
  EXPECT_THAT(log(), HasSubstr("5.5\n"));
  EXPECT_THAT(log(), HasSubstr("User  probe"));
  EXPECT_TRUE(nothing_left());
}

/// A script as those of user M-codes: halcmd with words of the shell's own, its exit status the shell's.
TEST_F(ProgramsTest, AShellScriptSetsPinsByHalcmd) {
  const auto on = file("M101", "#!/bin/sh\nhalcmd setp and2.0.in0 True\nexit 0\n");
  const auto off = file("M102", "#!/bin/sh\nhalcmd setp and2.0.in0 False\nexit 0\n");
  const auto both =
      file("M100", "#!/bin/sh\nhalcmd setp sum2.0.in0 $1 && halcmd setp sum2.0.in1 $2\n");
  const auto wired = file("M103", "#!/bin/sh\nhalcmd setp and2.0.in1 1\n");
  for (const auto& path : {on, off, both, wired})
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  const auto script = file(
      "m.hal", "loadrt and2\nloadrt sum2\nnet a and2.0.in1\nloadusr -w " + on +
                   "\ngetp and2.0.in0\nloadusr -w " + off + "\ngetp and2.0.in0\nloadusr -w " +
                   both + " 12.5 -3\ngetp sum2.0.in0\ngetp sum2.0.in1\nloadusr -w " + wired + "\n");
  EXPECT_EQ(halrun(script), 1);
  EXPECT_THAT(log(), HasSubstr("TRUE\nFALSE\n12.5\n-3\n"));
  EXPECT_THAT(log(), HasSubstr("<commandline>:0: pin 'and2.0.in1' is connected to a signal"));
  EXPECT_THAT(log(), HasSubstr("M103' failed, returned 1"));
}

/// The statuses that the peer's halcmd ends with.
TEST_F(ProgramsTest, HalcmdEndsWithTheStatusOfItsCommands) {
  std::string text = "loadrt and2 count=1000\n";
  for (int i = 0; i < 999; ++i) {
    const std::string n = std::to_string(i);
    const std::string next = std::to_string(i + 1);
    text.append("net s").append(n).append(" and2.").append(n).append(".out => and2.").append(next);
    text.append(".in0\nnet s").append(n).append(" and2.").append(next).append(".in1\n");
  }
  const auto many = file("many.hal", text);
  const auto bad = file("bad.hal", "newsig x bit\nnewsig x bit\nnewsig y bit\n");
  const auto ini = file("a.ini", "[A]\nB = fromini\n");
  const auto named = file("named.hal", "newsig [A]B bit\n");
  const auto halcmd = bin_folder + "halcmd";
  const std::pair<std::string, int> commands[] = {
      {"-f " + many, 0},
      {"-f " + bad, 1},
      {"gets x", 0},
      {"gets y", 1},
      {"-k -f " + bad, 1},
      {"gets y", 0},
      {"-i " + ini + " -f " + named, 0},
      {"gets fromini", 0},
      {"-i " + ini + " gets x", 1},
      {"nonsense", 1},
      {"-Q nonsense", 1},
      {"setp and2.0.in0", 1},
      {"setp and2.999.in0 1", 1},
      {"show pin and2.[01].in0", 0},
      {"-f /no/such/file", 255},
      {"-i /no/such/file -f " + named, 255},
      {"-z", 255},
      {"-R", 0},
      {"-h net", 0},
      {"debug 6", 1},
      {"debug 1", 0},
      {"source " + bad, 1},
      {"loadusr -w false", 1},
      {"loadusr -wi false", 0},
  };
  std::string script;
  for (const auto& [words, status] : commands) {
    script.append("'").append(halcmd).append("' ").append(words).append(
        " || echo \"status $?\"; echo '# ");
    script.append(words).append("'\n");
  }
  const auto shell = file("all.sh", script);
  EXPECT_EQ(halrun(file("run.hal", "loadusr -w sh " + shell + "\n")), 0) << log();
  std::string seen = log();
  std::size_t from = 0;
  for (const auto& [words, status] : commands) {
    const std::size_t end = seen.find("# " + words + "\n", from);
    ASSERT_NE(end, std::string::npos) << words << "\n" << seen;
    const std::string part = seen.substr(from, end - from);
    const std::string said = "status " + std::to_string(status) + "\n";
    if (status == 0)
      EXPECT_THAT(part, testing::Not(HasSubstr("status "))) << words;
    else
      EXPECT_THAT(part, HasSubstr(said)) << words;
    from = end + 1;
  }
  EXPECT_THAT(seen, HasSubstr("bad.hal:2: newsig failed: duplicate signal 'x'"));
  EXPECT_THAT(seen, HasSubstr("and2.1.in0 <== s0"));
}

/// Tab completes names, and what was typed is there in the next session.
TEST_F(ProgramsTest, ASessionCompletesNamesAndKeepsItsHistory) {
  const auto script = file("wait.hal", "loadrt and2\nloadusr -Wn probe " + probe_program +
                                           " probe\nloadusr -w sleep 100\n");
  start({bin_folder + "halrun", script});
  ASSERT_TRUE(component_ready("probe"));
  int terminal = -1;
  const pid_t pid = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  ASSERT_GE(pid, 0);
  const std::string program = bin_folder + "halcmd";
  if (pid == 0) {
    ::setenv("HOME", folder_.c_str(), 1);
    ::setenv("TERM", "xterm", 1);
    ::execl(program.c_str(), program.c_str(), nullptr);
    ::_exit(127);
  }
  children_.push_back(pid);
  ::fcntl(terminal, F_SETFL, O_NONBLOCK);
  std::string seen;
  const auto says = [&](const char* text) {
    return eventually(
        [&] {
          char bytes[512];
          const ssize_t n = ::read(terminal, bytes, sizeof bytes);
          if (n > 0) seen.append(bytes, static_cast<std::size_t>(n));
          return seen.find(text) != std::string::npos;
        },
        20);
  };
  const auto type = [&](const std::string& text) {
    seen.clear();
    EXPECT_EQ(::write(terminal, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  };
  EXPECT_TRUE(says("halcmd: ")) << seen;
  type("getp and2.0.o\t\n");
  EXPECT_TRUE(says("FALSE")) << seen;
  type("unlinkp and2.9\n");
  EXPECT_TRUE(says("<stdin>:2: unlink failed: pin 'and2.9' not found")) << seen;
  type("quit\n");
  EXPECT_EQ(wait_for(pid, 20), 0) << seen;
  ::close(terminal);
  EXPECT_THAT(read((folder_ / ".halcmd_history").string()), HasSubstr("and2.0.out"));
}

TEST_F(ProgramsTest, AFailedScriptNamesItsLineAndLeavesNothing) {
  const auto script = file("bad.hal", "loadrt and2\nloadusr -Wn probe " + probe_program +
                                          " probe\n\nnet a and2.0.owt\n");
  EXPECT_EQ(halrun(script), 1);
  EXPECT_THAT(log(),
              HasSubstr("bad.hal:4: Pin 'and2.0.owt' does not exist; did you mean 'and2.0.out'?"));
  EXPECT_TRUE(nothing_left());
}

TEST_F(ProgramsTest, LoadusrSaysWhenAProgramCannotServe) {
  const auto script = file(
      "usr.hal", "loadusr -W " + bin_folder +
                     "nothere\nloadusr -Wn never true\nloadusr -w false\nloadusr -w -i false\n");
  EXPECT_EQ(wait_for(start({bin_folder + "halrun", "-k", script}), 60), 1);
  EXPECT_THAT(log(),
              HasSubstr("usr.hal:1: execv(" + bin_folder + "nothere): No such file or directory"));
  EXPECT_THAT(log(), HasSubstr("usr.hal:2: true exited without becoming ready"));
  EXPECT_THAT(log(), HasSubstr("usr.hal:3: program 'false' failed, returned 1"));
  EXPECT_THAT(log(), testing::Not(HasSubstr("usr.hal:4")));
}

TEST_F(ProgramsTest, AKilledHalrunLeavesNothing) {
  const auto script =
      file("long.hal", "loadrt threads name1=servo period1=1000000\nstart\nloadusr -Wn probe " +
                           probe_program + " probe\nloadusr -w sleep 60\n");
  const pid_t pid = start({bin_folder + "halrun", script});
  ASSERT_TRUE(component_ready("probe")) << log();
  ::kill(pid, SIGKILL);
  EXPECT_EQ(wait_for(pid, 5), 128 + SIGKILL);
  EXPECT_TRUE(eventually([&] { return nothing_left(); }, 10));
}

TEST_F(ProgramsTest, AKilledRealtimeHostEndsHalrun) {
  const auto script = file("long.hal", "loadusr -Wn probe " + probe_program +
                                           " probe\nloadusr -w sleep 1\nloadrt and2\n");
  const pid_t pid = start({bin_folder + "halrun", script});
  ASSERT_TRUE(component_ready("probe")) << log();
  ::kill(static_cast<pid_t>(owner_pid()), SIGKILL);
  EXPECT_EQ(wait_for(pid, 20), 1) << log();
  EXPECT_THAT(log(), HasSubstr("the realtime host does not answer"));
  EXPECT_TRUE(nothing_left());
  EXPECT_EQ(halrun(file("again.hal", "loadrt and2\n")), 0);
}

TEST_F(ProgramsTest, AKilledComponentLosesItsPins) {
  const pid_t app = start({bin_folder + "rtapi_app"});
  ASSERT_TRUE(eventually([&] { return halcmd({"-Q", "loadrt", "sum2"}) == 0; }, 10)) << log();
  const pid_t probe = start({probe_program, "probe"});
  ASSERT_TRUE(component_ready("probe"));
  EXPECT_EQ(halcmd({"net", "a", "sum2.0.out", "probe.in"}), 0) << log();
  ::kill(probe, SIGKILL);
  EXPECT_EQ(wait_for(probe, 5), 128 + SIGKILL);
  auto segment = std::move(rtapi::Segment::attach(instance_)).value();
  const View view(*segment);
  EXPECT_TRUE(eventually([&] { return !view.find_pin("probe.in").has_value(); }, 5));
  EXPECT_TRUE(view.find_pin("sum2.0.out").has_value());
  EXPECT_EQ(view.find_signal("a")->readers, 0U);
  ::kill(app, SIGTERM);
  EXPECT_EQ(wait_for(app, 10), 0) << log();
  segment.reset();
  EXPECT_TRUE(nothing_left());
}

TEST_F(ProgramsTest, VirtualTimeIsExactAndFast) {
  const pid_t app = start({bin_folder + "rtapi_app", "--virtual"});
  const auto script =
      file("virtual.hal",
           "loadrt threads name1=servo period1=1000000 name2=slow period2=10000000\nloadrt sum2\n"
           "addf sum2.0 servo\nloadusr -Wn probe " +
               probe_program +
               " probe\nnet a sum2.0.out => probe.in\n"
               "setp sum2.0.in0 2\nstart\nsleep 20\ngetp servo.threadbeat\ngetp slow.threadbeat\n"
               "getp probe.out\nstop\nunloadusr probe\nwaitusr probe\n");
  ASSERT_TRUE(eventually([&] { return halcmd({"-Q", "unlock"}) == 0; }, 10)) << log();
  EXPECT_EQ(halcmd({"-f", script}), 0) << log();
  EXPECT_THAT(log(), HasSubstr("20000\n2000\n2\n"));
  ::kill(app, SIGTERM);
  EXPECT_EQ(wait_for(app, 10), 0);
  EXPECT_TRUE(nothing_left());
}

TEST_F(ProgramsTest, AnUnmodifiedProgramSleepsInVirtualTime) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's runtime would have to be preloaded before the shim";
#endif
  const pid_t app = start({bin_folder + "rtapi_app", "--virtual"});
  const auto script = file("sleeper.hal",
                           "loadrt threads name1=servo period1=1000000\nstart\n"
                           "loadusr -w sh -c \"sleep 100\"\ngetp servo.threadbeat\n");
  ASSERT_TRUE(eventually([&] { return halcmd({"-Q", "unlock"}) == 0; }, 10)) << log();
  EXPECT_EQ(halcmd({"-f", script}), 0) << log();
  // 100 s of the machine, and no more than the shell and its child took to start.
  EXPECT_THAT(log(), testing::ContainsRegex("(^|\n)100000\n"));
  ::kill(app, SIGTERM);
  EXPECT_EQ(wait_for(app, 10), 0);
  EXPECT_TRUE(nothing_left());
}

TEST_F(ProgramsTest, TwoInstancesLiveSideBySide) {
  const pid_t first = start({bin_folder + "rtapi_app", "--instance", instance_ + "a"});
  const pid_t second = start({bin_folder + "rtapi_app", "--instance", instance_ + "b"});
  for (const char* suffix : {"a", "b"}) {
    ::setenv("KERF_INSTANCE", (instance_ + suffix).c_str(), 1);
    EXPECT_TRUE(eventually(
        [&] {
          return halcmd({"-Q", "loadrt", "and2", std::string("names=") + suffix}) == 0;
        },
        10));
    EXPECT_EQ(halcmd({"list", "pin"}), 0);
  }
  EXPECT_THAT(log(), HasSubstr("a.in0 a.in1 a.out a.time \nb.in0 b.in1 b.out b.time \n"));
  ::kill(first, SIGTERM);
  ::kill(second, SIGINT);
  EXPECT_EQ(wait_for(first, 10), 0);
  EXPECT_EQ(wait_for(second, 10), 0);
  EXPECT_FALSE(rtapi::Segment::attach(instance_ + "a").ok());
  EXPECT_FALSE(rtapi::Segment::attach(instance_ + "b").ok());
}

TEST_F(ProgramsTest, WaitusrEndsWhenTheHostDies) {
  const pid_t app = start({bin_folder + "rtapi_app"});
  ASSERT_TRUE(eventually([&] { return halcmd({"-Q", "unlock"}) == 0; }, 10)) << log();
  (void)start({probe_program, "probe"});
  ASSERT_TRUE(component_ready("probe"));
  const pid_t waiting = start({bin_folder + "halcmd", "waitusr", "probe"});
  ASSERT_TRUE(component_ready("halcmd" + std::to_string(waiting))) << log();
  ::kill(app, SIGKILL);
  EXPECT_EQ(wait_for(waiting, 20), 1);
  EXPECT_THAT(log(), HasSubstr("the realtime host died while component 'probe' was waited for"));
}

/// A signal at any moment of the start ends halrun, and nothing stays.
TEST_F(ProgramsTest, ASignalAtTheStartIsNotLost) {
  const auto script = file("long.hal", "loadusr -w sleep 100\n");
  for (const int delay_ms : {0, 1, 2, 4, 8, 16, 32, 64}) {
    const pid_t pid = start({bin_folder + "halrun", script});
    pause_ms(delay_ms);
    ::kill(pid, delay_ms % 3 == 0 ? SIGTERM : SIGINT);
    EXPECT_NE(wait_for(pid, 30), -1) << delay_ms << " ms: " << log();
    EXPECT_TRUE(eventually([&] { return nothing_of_the_instance(); }, 10)) << delay_ms;
  }
}

TEST_F(ProgramsTest, AStartWaitsForTheEndOfTheRunBeforeIt) {
  const auto script =
      file("long.hal", "loadusr -Wn probe " + probe_program + " probe\nloadusr -w sleep 100\n");
  for (const int signal : {SIGKILL, SIGTERM, SIGKILL}) {
    const pid_t pid = start({bin_folder + "halrun", script});
    ASSERT_TRUE(component_ready("probe")) << log();
    ::kill(pid, signal);
    EXPECT_EQ(halrun(file("next.hal", "loadrt and2\n")), 0) << log();
    EXPECT_NE(wait_for(pid, 20), -1);
    EXPECT_TRUE(eventually([&] { return nothing_of_the_instance(); }, 10));
  }
}

TEST_F(ProgramsTest, HalrunUEndsWhateverIsLeft) {
  const auto end_all = [&](const char* what) {
    EXPECT_EQ(wait_for(start({bin_folder + "halrun", "-U"}), 60), 0) << what << log();
    EXPECT_TRUE(nothing_of_the_instance()) << what;
  };
  end_all("nothing at all");
  // Everything stopped, as by Ctrl-Z.
  pid_t app = start({bin_folder + "rtapi_app"});
  ASSERT_TRUE(eventually([&] { return halcmd({"-Q", "unlock"}) == 0; }, 10)) << log();
  ASSERT_TRUE(note_run());
  ::setenv("KERF_RUN_ID", run_id_.c_str(), 1);
  const pid_t probe = start({probe_program, "probe"});
  ::unsetenv("KERF_RUN_ID");
  ASSERT_TRUE(component_ready("probe"));
  ::kill(probe, SIGSTOP);
  ::kill(app, SIGSTOP);
  end_all("stopped processes");
  EXPECT_NE(wait_for(app, 5), -1);
  EXPECT_NE(wait_for(probe, 5), -1);
  // A maker that died half-way, and a program of a run long ago.
  std::ofstream("/dev/shm" + rtapi::segment_name(instance_)) << std::string(100'000, '\0');
  ::setenv("KERF_RUN_ID", "long-ago", 1);
  const pid_t old = start({"/bin/sh", "-c", "trap '' TERM; sleep 100"});
  ::unsetenv("KERF_RUN_ID");
  ASSERT_TRUE(eventually([&] { return !rtapi::processes_of_instance(instance_).empty(); }, 10));
  end_all("a half-made segment and an old program");
  EXPECT_EQ(wait_for(old, 5), 128 + SIGKILL);
  EXPECT_EQ(halrun(file("again.hal", "loadrt and2\n")), 0) << log();
}

TEST_F(ProgramsTest, AHungFunctionIsNamedAndHoldsNothingUp) {
  ::setenv(
      "KERF_COMPONENTS",
      (std::string(KERF_BUILD_DIR) + "/components:" + KERF_BUILD_DIR + "/tests/components").c_str(),
      1);
  const pid_t app = start({bin_folder + "rtapi_app"});
  ::unsetenv("KERF_COMPONENTS");
  ASSERT_TRUE(eventually([&] { return halcmd({"-Q", "unlock"}) == 0; }, 10)) << log();
  EXPECT_EQ(halcmd({"loadrt", "threads", "name1=t", "period1=1000000"}), 0);
  EXPECT_EQ(halcmd({"loadrt", "hang"}), 0) << log();
  EXPECT_EQ(halcmd({"addf", "hang.0", "t"}), 0);
  EXPECT_EQ(halcmd({"start"}), 0);
  EXPECT_TRUE(eventually(
      [&] {
        auto segment = rtapi::Segment::attach(instance_);
        if (!segment.ok()) return false;
        auto pin = View(**segment).find_pin("hang.0.hangs");
        return pin && pin->raw != 0;
      },
      10))
      << log();
  ::kill(app, SIGTERM);
  EXPECT_EQ(wait_for(app, 30), 1);
  EXPECT_THAT(log(), HasSubstr("thread 't' does not end its cycle; it is in function 'hang.0'"));
  EXPECT_TRUE(nothing_of_the_instance());
}

TEST_F(ProgramsTest, ThreadsGetTheirCpusInOrder) {
  EXPECT_EQ(wait_for(start({bin_folder + "rtapi_app", "--cpu", "0-x"}), 20), 1);
  EXPECT_THAT(log(), HasSubstr("processors '0-x': no number in '0-x'"));
  cpu_set_t allowed;
  ASSERT_EQ(::sched_getaffinity(0, sizeof allowed, &allowed), 0);
  if (CPU_ISSET(0, &allowed) == 0 || CPU_ISSET(1, &allowed) == 0)
    GTEST_SKIP() << "processors 0 and 1 are not both there";
  const pid_t app = start({bin_folder + "rtapi_app", "--cpu=1,0"});
  ASSERT_TRUE(eventually([&] { return halcmd({"-Q", "unlock"}) == 0; }, 10)) << log();
  EXPECT_EQ(halcmd({"loadrt", "threads", "name1=first", "period1=1000000", "name2=second",
                    "period2=2000000", "name3=third", "period3=3000000"}),
            0);
  const auto cpu_of = [&](const std::string& thread) -> std::string {
    for (const auto& task :
         std::filesystem::directory_iterator("/proc/" + std::to_string(app) + "/task")) {
      if (read((task.path() / "comm").string()) != thread + "\n") continue;
      std::istringstream status(read((task.path() / "status").string()));
      for (std::string line; std::getline(status, line);) {
        if (line.rfind("Cpus_allowed_list:", 0) == 0) return line.substr(19);
      }
    }
    return "?";
  };
  EXPECT_TRUE(eventually([&] { return cpu_of("first") == "1"; }, 5)) << cpu_of("first");
  EXPECT_TRUE(eventually([&] { return cpu_of("second") == "0"; }, 5)) << cpu_of("second");
  EXPECT_TRUE(eventually([&] { return cpu_of("third") == "0"; }, 5)) << cpu_of("third");
  ::kill(app, SIGTERM);
  EXPECT_EQ(wait_for(app, 20), 0);
}

TEST_F(ProgramsTest, HalcmdWithoutAMachineSaysSo) {
  EXPECT_EQ(halcmd({"show"}), 1);
  EXPECT_THAT(log(), HasSubstr("instance '" + instance_ + "' does not run"));
}

}  // namespace
}  // namespace kerf::hal::test
