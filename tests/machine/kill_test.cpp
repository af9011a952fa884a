// kill -9 of milltask, rtapi_app or kerf at random points of a program: what is on the disk is whole and never later than the machine,
// the declared safe state is there, and the next start works. KERF_COUNT: how many kills.
#include <cstdio>
#include <cstdlib>
#include <random>
#include <sstream>

#include "hal/core/value_text.hpp"
#include "hal/core/view.hpp"
#include "launcher/resume.hpp"
#include "machine/kerf_process.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/journal.hpp"

namespace kerf::launcher {
namespace {

using test::Kerf;
using test::Mill;

/// Lines of 0.4 mm along X. `tools`: each third one writes the tool table, too, behind which no run may begin.
std::string long_program(bool tools = false) {
  std::ostringstream out;
  out << "G21 G90 G61 F1200\nM64 P3\nM68 E1 Q7\nG0 X0 Y0 Z0\n";
  for (int i = 1; i <= 600; ++i) {
    if (tools && i % 3 == 0) out << "G10 L1 P2 Z" << -i * 0.01 << "\n";
    out << "G1 X" << i * 0.4 << "\n";
  }
  out << "M2\n";
  return out.str();
}

/// The memory of the machine, kept beyond its end.
class Witness {
 public:
  explicit Witness(const std::string& instance) {
    for (int i = 0; i < 4000 && !ready(); ++i) {
      if (!segment_) {
        auto segment = rtapi::Segment::attach(instance);
        if (segment.ok()) segment_ = std::move(*segment);
      }
      if (segment_) look();
      pause_ms(5);
    }
  }
  [[nodiscard]] bool ready() const { return motion_ != nullptr; }
  [[nodiscard]] motion::MotionStatus motion() const {
    motion::MotionStatus s;
    (void)motion_->status.read(s);
    return s;
  }
  [[nodiscard]] std::uint64_t digital() const { return digital_.slot().load(); }
  [[nodiscard]] std::uint64_t analog() const { return analog_.slot().load(); }
  void switch_relay_off() const { relay_.slot().store(0); }
  [[nodiscard]] std::uint64_t relay() const { return relay_.slot().load(); }

 private:
  void look() {
    const hal::View view(*segment_);
    if (!view.attached()) return;
    auto motion = view.block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
    digital_ = view.pin_slot("motion.digital-out-03");
    analog_ = view.pin_slot("motion.analog-out-01");
    relay_ = view.pin_slot("relay.in");
    if (motion.ok() && digital_.link != nullptr && analog_.link != nullptr &&
        relay_.link != nullptr)
      motion_ = *motion;
  }
  std::unique_ptr<rtapi::Segment> segment_;
  motion::MotionShared* motion_{nullptr};
  hal::SlotRef digital_, analog_, relay_;
};

/// Every line of it ends, and has the fields of its kind.
void expect_whole_files(const Mill& mill) {
  std::istringstream tools(test::read_file(mill.path("mill.tbl")));
  int number = 0, count = 0;
  for (std::string line; std::getline(tools, line);) {
    if (line.empty() || line.front() == ';') continue;
    EXPECT_EQ(std::sscanf(line.c_str(), "T%d", &number), 1) << line;
    ++count;
  }
  EXPECT_GE(count, 3);
  const std::string table = test::read_file(mill.path("mill.tbl"));
  EXPECT_TRUE(!table.empty() && table.back() == '\n');
  const std::string parameters = test::read_file(mill.path("mill.var"));
  if (!parameters.empty()) {
    EXPECT_EQ(parameters.back(), '\n');
    EXPECT_NE(parameters.find("5390"), std::string::npos) << "the last one of the list";
  }
  const std::string positions = test::read_file(mill.path("position.txt"));
  std::istringstream in(positions);
  double value = 0;
  int joints = 0;
  while (in >> value) ++joints;
  EXPECT_TRUE(joints == 0 || joints == 3) << positions;
}

int guard_of(const Kerf& kerf) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const int pid = std::atoi(entry.path().filename().c_str());
    if (pid > 1 && rtapi::parent_of(pid) == kerf.pid() && rtapi::process_name(pid) == "kerf-guard")
      return pid;
  }
  return -1;
}

TEST(KillMinusNine, LeavesATrueJournalWholeFilesAndTheSafeState) {
  const char* wanted = std::getenv("KERF_COUNT");
  const int count = wanted != nullptr ? std::max(1, std::atoi(wanted)) : 6;
  Mill mill("kill9");
  mill.change("CLOCK = real", "CLOCK = real\nJOURNAL = job.journal");
  mill.change("[AXIS_X]\n",
              "[SAFE_STATE]\nPIN = motion.digital-out-03 0\nPIN = motion.analog-out-01 0.25\n"
              "PIN = relay.in 1\n\n[AXIS_X]\n");
  mill.change("COORDINATES = X Y Z", "COORDINATES = X Y Z\nPOSITION_FILE = position.txt");
  mill.change("HALCMD = setp spindle-motor.acceleration 100",
              "HALCMD = setp spindle-motor.acceleration 100\nHALCMD = loadrt not names=relay\n"
              "HALCMD = addf relay servo-thread");
  const std::string program = mill.path("job.ngc");
  const std::string journal = mill.path("job.journal");
  std::mt19937 random(20261122);
  const char* const victims[] = {"milltask", "rtapi_app", "kerf"};
  for (int round = 0; round < count; ++round) {
    const std::string victim = victims[round % 3];
    // Only the rounds without kerf run on the real clock. The others need the short time: it is what tells motion of task's death.
    if (victim == "kerf") mill.take_silence();
    const int delay = std::uniform_int_distribution<int>(0, 400)(random);
    SCOPED_TRACE(victim + " after " + std::to_string(delay) + " ms, round " +
                 std::to_string(round));
    std::filesystem::remove(journal);
    mill.write("job.ngc", long_program(round + 1 < count));
    std::vector<std::string> arguments{"--program", program};
    // Without kerf only the real clock has drivers worth an end in order (docs/safety.md).
    if (victim != "kerf") arguments.insert(arguments.end(), {"--speed", "10"});
    Kerf kerf(mill, "kill9", arguments);
    const Witness witness("kill9" + std::to_string(getpid()));
    ASSERT_TRUE(witness.ready()) << kerf.output();
    for (int i = 0; i < 4000 && witness.motion().current.line < 8; ++i) pause_ms(5);
    ASSERT_GE(witness.motion().current.line, 8) << kerf.output();
    EXPECT_EQ(witness.digital(), 1U);
    EXPECT_EQ(witness.relay(), 1U) << "from the start; nobody but its user takes it away";
    witness.switch_relay_off();
    pause_ms(delay);
    if (victim == "kerf") {
      kerf.signal(SIGKILL);
      EXPECT_EQ(kerf.wait_exit(), 128 + SIGKILL);
    } else {
      const auto found = kerf.parts(victim);
      ASSERT_EQ(found.size(), 1U) << kerf.output();
      kill(found[0], SIGKILL);
      EXPECT_EQ(kerf.wait_exit(), 1) << kerf.output();
    }
    EXPECT_EQ(kerf.leftovers(), "");
    // --- the safe state: the memory of the machine says what drivers and programs were told last
    EXPECT_EQ(witness.digital(), 0U);
    EXPECT_EQ(hal::plain_value_text(hal::Type::floating, witness.analog()), "0.25");
    EXPECT_EQ(witness.relay(), 1U);
    // --- the journal
    const auto record = task::read_journal(journal);
    ASSERT_TRUE(record.ok()) << record.error().message();
    const motion::MotionStatus last = witness.motion();
    EXPECT_EQ(record->program, program);
    EXPECT_LE(record->executed, last.executed_seq);
    EXPECT_LE(record->line, last.current.line);
    EXPECT_LE(record->position.x, last.pos_cmd.x + 1e-9);
    EXPECT_GT(record->line, 0);
    // The moves of its line lead to its place: line and position are of one moment.
    EXPECT_TRUE(record->marked && record->mark == *task::mark_file(program));
    EXPECT_TRUE(record->state == task::RunState::running ||
                (victim != "milltask" && record->state == task::RunState::stopped))
        << task::to_string(record->state);
    std::fprintf(stderr, "%s: line %d of %d, X%.3f of %.3f\n", victim.c_str(), record->line,
                 last.current.line, record->position.x, last.pos_cmd.x);
    expect_whole_files(mill);
    if (victim == "kerf") mill.change("HEARTBEAT_TIMEOUT = 10\n", "HEARTBEAT_TIMEOUT = 1\n");
  }
  Options options;
  options.ini = mill.ini();
  Console console(false);
  testing::internal::CaptureStdout();
  EXPECT_EQ(resume(options, console), 0);
  const std::string said = testing::internal::GetCapturedStdout();
  for (const char* part : {"job.ngc", "line ", "position ", "tool ", "unchanged"})
    EXPECT_NE(said.find(part), std::string::npos) << said;
  // A changed file is another program.
  options.resume_run = true;
  const auto says = [&](int code, const char* part) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    EXPECT_EQ(resume(options, console), code);
    const std::string all =
        testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
    EXPECT_NE(all.find(part), std::string::npos) << all;
  };
  mill.write("job.ngc", "(new)\n" + long_program());
  says(1, "has changed since");
  mill.write("job.ngc", long_program());
  // The next start works, and the program goes on when it is told to, from its line.
  options.instance = "kill9" + std::to_string(getpid());
  Kerf next(mill, "kill9", {"--speed", "50"});
  ASSERT_TRUE(next.wait_output("runs; end it with")) << next.output();
  says(1, "turned on");
  const std::string words = "KERF_INSTANCE=" + options.instance + " timeout 60 " + KERF_BUILD_DIR +
                            "/bin/mdi ':state estop-reset' ':state on' ':home' 'M61 Q1' "
                            "'G53 G0 Z-5' >/dev/null 2>&1 </dev/null";
  EXPECT_EQ(std::system(words.c_str()), 0) << next.output();
  const int from = task::read_journal(journal)->line;
  says(0, ("runs from line " + std::to_string(from)).c_str());
  auto record = task::read_journal(journal);
  for (int i = 0; i < 4000 && record->state != task::RunState::ended; ++i) {
    pause_ms(5);
    record = task::read_journal(journal);
  }
  EXPECT_EQ(record->state, task::RunState::ended) << next.output();
  EXPECT_EQ(record->from_line, from);
  EXPECT_NEAR(record->position.x, 240, 1e-6);
  options.resume_run = false;
  says(0, "ran to its end");
  next.signal(SIGTERM);
  EXPECT_EQ(next.wait_exit(), 0) << next.output();
}

/// Of several that die at once: whoever is left stops what only a program of the INI file's can reach (a frequency converter).
TEST(KillMinusNine, WhoeverIsLeftRunsTheCommandsOfTheSafeState) {
  Mill mill("together9");
  const std::string told = mill.path("told");
  mill.change("[AXIS_X]\n", "[SAFE_STATE]\nPIN = relay.in 1\nCOMMAND = /usr/bin/touch " + told +
                                "\n\n[AXIS_X]\n");
  mill.change("HALCMD = setp spindle-motor.acceleration 100",
              "HALCMD = loadrt not names=relay\nHALCMD = addf relay servo-thread");
  mill.take_silence();
  mill.write("job.ngc", long_program());
  const std::vector<std::vector<const char*>> together{
      {"milltask", "rtapi_app"}, {"rtapi_app", "kerf"}, {"milltask", "kerf", "rtapi_app"}};
  for (const auto& victims : together) {
    SCOPED_TRACE(std::string(victims.front()) + " first of " + std::to_string(victims.size()));
    std::filesystem::remove(told);
    Kerf kerf(mill, "together9", {"--program", mill.path("job.ngc")});
    const Witness witness("together9" + std::to_string(getpid()));
    ASSERT_TRUE(witness.ready()) << kerf.output();
    for (int i = 0; i < 4000 && witness.motion().current.line < 8; ++i) pause_ms(5);
    ASSERT_GE(witness.motion().current.line, 8) << kerf.output();
    witness.switch_relay_off();
    std::vector<pid_t> pids;
    for (const std::string name : victims) {
      const auto found = name == "kerf" ? std::vector<pid_t>{kerf.pid()} : kerf.parts(name);
      ASSERT_EQ(found.size(), 1U) << kerf.output();
      pids.push_back(found[0]);
    }
    for (const pid_t pid : pids) kill(pid, SIGKILL);
    (void)kerf.wait_exit();
    EXPECT_EQ(kerf.leftovers(), "");
    EXPECT_TRUE(std::filesystem::exists(told)) << kerf.output();
    EXPECT_EQ(witness.relay(), 1U);
  }
}

/// The guard dies, too: there is a new one, and it knows the safe state.
TEST(KillMinusNine, AGuardThatDiesIsReplacedByOneThatReachesTheSafeState) {
  Mill mill("guard9");
  mill.change("[AXIS_X]\n", "[SAFE_STATE]\nPIN = relay.in 1\n\n[AXIS_X]\n");
  mill.change("HALCMD = setp spindle-motor.acceleration 100",
              "HALCMD = loadrt not names=relay\nHALCMD = addf relay servo-thread");
  Kerf kerf(mill, "guard9", {});
  const Witness witness("guard9" + std::to_string(getpid()));
  ASSERT_TRUE(witness.ready()) << kerf.output();
  ASSERT_TRUE(kerf.wait_output("runs; end it with")) << kerf.output();
  const int first = guard_of(kerf);
  ASSERT_GT(first, 1);
  kill(first, SIGKILL);
  ASSERT_TRUE(kerf.wait_output("there is a new one")) << kerf.output();
  for (int i = 0; i < 4000 && guard_of(kerf) < 0; ++i) pause_ms(5);
  EXPECT_NE(guard_of(kerf), first);
  witness.switch_relay_off();
  kerf.signal(SIGKILL);
  EXPECT_EQ(kerf.wait_exit(), 128 + SIGKILL);
  EXPECT_EQ(kerf.leftovers(), "");
  EXPECT_EQ(witness.relay(), 1U);
}

/// The guard hangs: the realtime process has seen by itself that kerf is dead.
TEST(KillMinusNine, TheDrivesGoOffBeforeTheGuardHasItsTurn) {
  Mill mill("late9");
  mill.change("[AXIS_X]\n", "[SAFE_STATE]\nPIN = motion.digital-out-03 0\n\n[AXIS_X]\n");
  mill.change("HALCMD = setp spindle-motor.acceleration 100",
              "HALCMD = loadrt not names=relay\nHALCMD = addf relay servo-thread");
  mill.take_silence();
  mill.write("job.ngc", long_program());
  Kerf kerf(mill, "late9", {"--program", mill.path("job.ngc")});
  const Witness witness("late9" + std::to_string(getpid()));
  ASSERT_TRUE(witness.ready()) << kerf.output();
  for (int i = 0; i < 4000 && witness.motion().current.line < 8; ++i) pause_ms(5);
  ASSERT_GE(witness.motion().current.line, 8) << kerf.output();
  ASSERT_TRUE(witness.motion().enabled);
  EXPECT_EQ(witness.digital(), 1U);
  const int guard = guard_of(kerf);
  ASSERT_GT(guard, 1);
  kill(guard, SIGSTOP);
  kerf.signal(SIGKILL);
  EXPECT_EQ(kerf.wait_exit(), 128 + SIGKILL);
  for (int i = 0; i < 4000 && !kerf.parts().empty(); ++i) pause_ms(5);
  EXPECT_TRUE(kerf.parts().empty()) << "who is left without a guard ends by itself";
  EXPECT_FALSE(witness.motion().enabled);
  EXPECT_EQ(witness.digital(), 0U);
  kill(guard, SIGCONT);
  EXPECT_EQ(kerf.leftovers(), "");
}

}  // namespace
}  // namespace kerf::launcher
