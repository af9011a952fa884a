// Whatever a machine may wait for, held against whatever may end it: abort, estop, and the death of the client that began it. Each
// ends idle within 100 ms, MDI runs next, and the program begins at its top.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "harness/machine.hpp"
#include "task/api/client.hpp"

namespace kerf::harness {
namespace {

using Words = std::vector<std::string>;

struct Wait {
  friend std::ostream& operator<<(std::ostream& out, const Wait& wait) { return out << wait.name; }

  const char* name;
  const char* program;  ///< behind a G0 X2; nullptr: homing
  const char* object;   ///< part of what it says it waits for
  const char* pin;      ///< ... and the pin
  Words blocks{};  ///< so that it does not end by itself: HAL commands, "task ..." for commands
  Words ends{};    ///< takes blocks back; needed where MDI could not run either
  task::PromptKind prompt{task::PromptKind::none};
  bool indexer{false};     ///< the machine with a locking A
  bool holds_time{false};  ///< a program outside runs: virtual time stands
  bool at_x2{true};        ///< X2 is behind it
  std::vector<std::pair<std::string, std::string>> ini{};
};

const Wait waits[] = {
    {"dwell", "G4 P100", "dwell", ""},
    {"input", "M66 P0 L3 Q100", "digital input 0", "motion.digital-in-00"},
    {"input_that_falls", "M66 P1 L2 Q100", "digital input 1", "motion.digital-in-01"},
    {.name = "stop",
     .program = "M0",
     .object = "resume",
     .pin = "",
     .prompt = task::PromptKind::stop},
    {.name = "optional_stop",
     .program = "M1",
     .object = "resume",
     .pin = "",
     .prompt = task::PromptKind::optional_stop},
    {.name = "pallet",
     .program = "M60",
     .object = "resume",
     .pin = "",
     .prompt = task::PromptKind::pallet},
    {"at_speed",
     "S1000 M3\nG1 X5 F100",
     "at speed",
     "spindle.0.at-speed",
     {"unlinkp spindle.0.at-speed", "setp spindle.0.at-speed 0"}},
    {"orient", "M19 R90", "oriented", "spindle.0.is-oriented", {"unlinkp spindle.0.is-oriented"}},
    {"probe", "G38.2 Z-60 F60", "the probe", "motion.probe-input"},
    {"index",
     "S100 M3\nG33 X5 K1",
     "index",
     "spindle.0.index-enable",
     {"unlinkp spindle.0.index-enable"}},
    {"turning",
     "S100 M3\nG95 F0.1\nG1 X5",
     "to turn",
     "spindle.0.revs, spindle.0.speed-in",
     {"unlinkp spindle.0.speed-in", "setp spindle.0.speed-in 0"}},
    {.name = "tool_change",
     .program = "T1 M6",
     .object = "tool change",
     .pin = "iocontrol.0.tool-changed",
     .blocks = {"unlinkp iocontrol.0.tool-changed"},
     .prompt = task::PromptKind::tool_change,
     .ini = {{"TOOL_CHANGE_POSITION = 0 0 0\n", ""}}},
    {"tool_prepare",
     "T1\nG4 P1\nM6",
     "tool 1",
     "iocontrol.0.tool-prepared",
     {"unlinkp iocontrol.0.tool-prepared"}},
    {.name = "start_change",
     .program = "T1\nG4 P1\nM6",
     .object = "ready for M6",
     .pin = "iocontrol.0.start-change-ack",
     .blocks = {"net abort iocontrol.0.emc-abort iocontrol.0.emc-abort-ack"},
     .ini = {{"TOOL_TABLE = mill.tbl",
              "EMCIO = iov2 -support-start-change\nTOOL_TABLE = mill.tbl"}}},
    {.name = "abort_ack",
     .program = "T1 M6",
     .object = "acknowledge an abort",
     .pin = "iocontrol.0.emc-abort-ack",
     .blocks = {"unlinkp iocontrol.0.emc-abort-ack", "setp iocontrol.0.emc-abort-ack 0",
                "task abort"},
     .ends = {"net abort iocontrol.0.emc-abort iocontrol.0.emc-abort-ack"},
     .ini = {{"TOOL_TABLE = mill.tbl",
              "EMCIO = iov2 -support-start-change\nTOOL_TABLE = mill.tbl"}}},
    {.name = "user_code",
     .program = "M110",
     .object = "M110 to end",
     .pin = "",
     .holds_time = true,
     .ini = {{"USER_M_PATH = ", "USER_M_PATH = .:"}}},
    {"feed_hold",
     "M53 P1\nG1 X20 F100",
     "feed hold",
     "motion.feed-hold",
     {"setp motion.feed-hold 1"},
     {"setp motion.feed-hold 0"}},
    {.name = "feed_inhibit",
     .program = "G1 X20 F100",
     .object = "feed inhibit",
     .pin = "motion.feed-inhibit",
     .blocks = {"setp motion.feed-inhibit 1"},
     .ends = {"setp motion.feed-inhibit 0"},
     .at_x2 = false},
    {"feed_override",
     "G1 X20 F100",
     "feed override above 0",
     "",
     {"task feed-override 0"},
     {"task feed-override 1"}},
    {"adaptive_feed",
     "M52 P1\nG1 X20 F100",
     "adaptive feed above 0",
     "motion.adaptive-feed",
     {"setp motion.adaptive-feed 0"},
     {"setp motion.adaptive-feed 1"}},
    {.name = "home_switch",
     .program = nullptr,
     .object = "the home switch of joint 2",
     .pin = "joint.2.home-sw-in",
     .blocks = {"setp z-motor.home-switch-pos 1e6", "setp z-motor.pos-limit-pos 1e6"},
     .ends = {"setp z-motor.home-switch-pos 30", "setp z-motor.pos-limit-pos 35"}},
    {.name = "home_index",
     .program = nullptr,
     .object = "the encoder's index of joint 2",
     .pin = "joint.2.index-enable",
     .ends = {"setp joint.2.index-enable 0"},
     .ini = {{"[JOINT_2]\n", "[JOINT_2]\nHOME_USE_INDEX = YES\n"}}},
    {.name = "home_unlock",
     .program = nullptr,
     .object = "unlocking of joint 3",
     .pin = "joint.3.is-unlocked",
     .blocks = {"unlinkp joint.3.is-unlocked", "setp joint.3.is-unlocked 0"},
     .ends = {"net unlocked joint.3.is-unlocked"},
     .indexer = true},
    {.name = "home_lock",
     .program = nullptr,
     .object = "locking of joint 3",
     .pin = "joint.3.is-unlocked",
     .blocks = {"unlinkp joint.3.is-unlocked", "setp joint.3.is-unlocked 1"},
     .ends = {"net unlocked joint.3.is-unlocked"},
     .indexer = true},
    {.name = "unlock",
     .program = "G0 A90",
     .object = "unlocking of joint 3",
     .pin = "joint.3.is-unlocked",
     .blocks = {"unlinkp joint.3.is-unlocked", "setp joint.3.is-unlocked 0"},
     .ends = {"net unlocked joint.3.is-unlocked"},
     .indexer = true},
    {.name = "lock",
     .program = "G91 G0 A90\nG90",
     .object = "locking of joint 3",
     .pin = "joint.3.is-unlocked",
     .blocks = {"unlinkp joint.3.is-unlocked", "setp joint.3.is-unlocked 1"},
     .ends = {"net unlocked joint.3.is-unlocked"},
     .indexer = true},
};

/// What the table found, for the line of figures.
struct Tally {
  int waits{0}, cases{0}, idle{0}, mdi{0}, restarts{0};
  double slowest_s{0};
};
Tally tally;

class StopInWait : public testing::TestWithParam<Wait> {
 public:
  static void TearDownTestSuite() {
    std::printf(
        "[ figures ] %zu waits by abort, estop and the death of a client: %d cases, %d idle after "
        "at most %.0f ms, %d then did MDI, %d began again at the top\n",
        std::size(waits), tally.cases, tally.idle, tally.slowest_s * 1000, tally.mdi,
        tally.restarts);
  }

 protected:
  void begin() {
    ++tally.cases;
    MachineOptions options;
    options.clients = true;
    options.replace = wait_.ini;
    options.files = {{"M110", "#!/bin/sh\ntrap '' TERM\nsleep 300 &\nsleep 300\n"}};
    if (wait_.indexer) {
      options.ini = KERF_SOURCE_DIR "/configs/sim/mill-4axis/mill-4axis.ini";
      options.replace = {{"EMCMOT = motmod", "EMCMOT = motmod unlock_joints_mask=0x8"},
                         {"[AXIS_A]\n", "[AXIS_A]\nLOCKING_INDEXER_JOINT = 3\n"},
                         {"[JOINT_3]\n", "[JOINT_3]\nLOCKING_INDEXER = 1\n"}};
      options.hal = {"loadrt timedelay names=cylinder",
                     "addf cylinder servo-thread",
                     "setp cylinder.on-delay 0.2",
                     "setp cylinder.off-delay 0.1",
                     "net unlock joint.3.unlock cylinder.in",
                     "net unlocked cylinder.out joint.3.is-unlocked"};
    }
    m = Machine::start(options);
    ASSERT_TRUE(m->ready()) << m->errors();
    if (wait_.program == nullptr) {
      ASSERT_TRUE(m->power_on()) << m->errors();
    } else {
      ASSERT_TRUE(m->power_on_and_home()) << m->errors();
      path = m->write_program("G90 G94 M52 P0\nM53 P0\nG0 X2\n" + std::string(wait_.program) +
                              "\nG0 X50\nM2\n");
      ASSERT_TRUE(m->does({"open", path}));
    }
    wait();
  }
  void tell(const Words& lines) {
    for (const std::string& line : lines) {
      if (line.rfind("task ", 0) != 0) {
        EXPECT_TRUE(m->hal(line)) << line << m->errors();
        continue;
      }
      std::istringstream rest(line.substr(5));
      Words words;
      for (std::string word; rest >> word;) words.push_back(word);
      EXPECT_TRUE(m->does(words)) << line;
    }
  }
  /// From the top to the wait.
  void wait() {
    tell(wait_.blocks);
    begun = wait_.program == nullptr ? m->send({"home", "-1"}) : m->send({"run"});
    is_there();
  }
  void is_there() {
    const auto says = [&] { return std::string(m->task().waiting_for.object.view()); };
    EXPECT_TRUE(m->run_until(
        [&] {
          return says().find(wait_.object) != std::string::npos &&
                 (wait_.program == nullptr || wait_.holds_time || m->motion().path_empty ||
                  m->motion().waiting_for != motion::PathWait::none || m->motion().probing);
        },
        60))
        << "it waits for \"" << says() << "\"\n"
        << m->errors();
    pass(0.1);
    EXPECT_NE(says().find(wait_.object), std::string::npos) << says();
    const auto waiting = m->task().waiting_for;
    EXPECT_EQ(waiting.pin.view(), wait_.pin);
    // A pin of a wait names its net, and says so when it has none.
    if (!waiting.pin.empty()) {
      EXPECT_NE(task::wait_text(waiting).find(waiting.net.empty() ? "not linked" : ", net "),
                std::string::npos)
          << task::wait_text(waiting);
    }
    EXPECT_EQ(m->task().prompt.kind, wait_.prompt);
    EXPECT_FALSE(m->task().idle && !m->motion().homing_active);
    if (wait_.program != nullptr && wait_.at_x2) {
      EXPECT_NEAR(m->joint(0), 2, 0.003) << "a move that is held at once brakes from its feed";
    }
  }
  void pass(double seconds) {
    if (!wait_.holds_time) m->run_for(seconds);
  }
  /// `how` has been asked for.
  void ends_idle() {
    const auto asked = m->now();
    const double x = m->joint(0);
    const bool idle = m->run_until(
        [&] { return m->task().idle && !m->motion().homing_active && m->motion().path_empty; },
        0.1);
    EXPECT_TRUE(idle) << m->task().waiting_for.object.c_str();
    tally.idle += idle ? 1 : 0;
    tally.slowest_s = std::max(tally.slowest_s, static_cast<double>(m->now() - asked) * 1e-9);
    EXPECT_TRUE(m->task().waiting_for.object.empty()) << m->task().waiting_for.object.c_str();
    EXPECT_EQ(m->task().prompt.kind, task::PromptKind::none);
    EXPECT_EQ(m->task().interp_state, task::InterpState::idle);
    // Its motors have masses: without drives they run out, and their place is what the encoders say.
    m->run_for(wait_.indexer ? 15 : 0.1);
    if (wait_.program != nullptr) {
      EXPECT_NEAR(m->joint(0), x, wait_.indexer ? 0.001 : 1e-9)
          << "no wait is in the middle of a move of X";
    }
    std::array<double, motion::kMaxJoints> rest{};
    for (std::size_t j = 0; j < rest.size(); ++j) rest[j] = m->joint(j);
    m->run_for(0.5);
    for (std::size_t j = 0; j < rest.size(); ++j) EXPECT_EQ(m->joint(j), rest[j]) << "joint " << j;
    for (const char* pin :
         {"spindle.0.on", "spindle.0.orient", "iocontrol.0.tool-change", "iocontrol.0.tool-prepare",
          "spindle.0.index-enable", "joint.2.index-enable"})
      EXPECT_FALSE(m->bit(pin)) << pin;
    if (wait_.indexer) {
      EXPECT_FALSE(m->bit("joint.3.unlock"));
    }
  }
  void was_aborted() const {
    EXPECT_EQ(m->outcome(begun).state, task::CommandState::aborted) << m->outcome(begun).text;
  }
  /// MDI next, then the same again from its top.
  void goes_on() {
    const bool homes = wait_.program == nullptr;
    tell(wait_.ends);
    if (homes) end_of_homing();
    const bool did =
        m->mdi("G90 G0 X1", 30) && std::abs(m->joint(0) - 1) < 1e-9 && m->motion().path_empty;
    EXPECT_TRUE(did) << m->errors();
    tally.mdi += did ? 1 : 0;
    const int failed_before = failures();
    wait();
    tally.restarts += failures() == failed_before ? 1 : 0;
    EXPECT_EQ(m->abort().state, task::CommandState::done);
  }
  /// The index has to come when it is asked for.
  void end_of_homing() {
    const auto id = m->send({"home", "-1"});
    EXPECT_TRUE(m->run_until(
        [&] {
          if (m->motion().joint[2].home_state == kIndexState) {
            EXPECT_TRUE(m->hal("setp joint.2.index-enable 0"));
          }
          return task::is_terminal(m->outcome(id).state);
        },
        120));
    EXPECT_EQ(m->outcome(id).state, task::CommandState::done) << m->errors();
    EXPECT_TRUE(m->motion().all_homed);
  }
  static int failures() {
    return testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
  }
  static constexpr std::int32_t kIndexState = 9;
  const Wait& wait_{GetParam()};
  std::unique_ptr<Machine> m;
  std::string path;
  std::uint64_t begun{0};
};

TEST_P(StopInWait, AbortEndsIdleWithin100Ms) {
  begin();
  m->send({"abort"});
  ends_idle();
  was_aborted();
  goes_on();
}

TEST_P(StopInWait, EstopEndsIdleWithin100Ms) {
  begin();
  m->send({"state", "estop"});
  ends_idle();
  was_aborted();
  EXPECT_EQ(m->task().task_state, task::TaskState::estop);
  ASSERT_TRUE(m->does({"state", "estop-reset"})) << m->errors();
  ASSERT_TRUE(m->does({"state", "on"})) << m->errors();
  goes_on();
}

/// Whoever began it is gone; it waits on, anybody else sees for what, and ends it.
TEST_P(StopInWait, DeathOfItsClientLeavesItToTheOthers) {
  begin();
  EXPECT_EQ(m->abort().state, task::CommandState::done);
  pass(0.5);
  tell(wait_.ends);
  tell(wait_.blocks);
  auto starter = m->connect();
  ASSERT_NE(starter, nullptr);
  const auto sent =
      wait_.program == nullptr ? starter->send({"home", "-1"}) : starter->send({"run"});
  ASSERT_TRUE(sent.ok());
  is_there();
  const std::string waits_for(m->task().waiting_for.object.view());
  const double x = m->joint(0);
  starter.reset();
  pass(0.2);
  EXPECT_TRUE(m->run_until([&] { return m->task().clients == 0; }, 0.1));
  EXPECT_EQ(m->task().waiting_for.object.view(), waits_for);
  EXPECT_TRUE(m->motion().homing_active || m->task().interp_state != task::InterpState::idle);
  if (wait_.program != nullptr) {
    EXPECT_EQ(m->joint(0), x);
  }
  auto other = m->connect();
  ASSERT_NE(other, nullptr);
  const auto abort = other->send({"abort"});
  ASSERT_TRUE(abort.ok());
  EXPECT_TRUE(m->run_until(
      [&] {
        (void)other->poll();
        return other->finished(*abort);
      },
      0.1));
  ends_idle();
  goes_on();
}

INSTANTIATE_TEST_SUITE_P(Waits, StopInWait, testing::ValuesIn(waits),
                         [](const auto& wait) { return wait.param.name; });

}  // namespace
}  // namespace kerf::harness
