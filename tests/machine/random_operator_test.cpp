// An operator who does anything at any moment: pauses, steps, jogs beside the path, runs it backwards, types lines, switches the
// machine off, homes it, turns all overrides, while programs run. Every cycle of it is looked at.
//   KERF_COUNT=40 KERF_SEED=100 tests/random_operator_test      40 sessions of each machine, seeds from 100 on
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "hal/core/view.hpp"
#include "harness/joint_watch.hpp"
#include "harness/machine.hpp"
#include "machine/operator_programs.hpp"
#include "motion/api/faults.hpp"
#include "motion/api/shared.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::harness {
namespace {

using task::CommandState;
using Words = std::vector<std::string>;

constexpr double kDtS = 0.001;
/// In which joints that are limited in jerk reach their acceleration.
constexpr double kRampS = 0.03;
/// Within which all stops of these machines stand, those of threads behind a pause too.
constexpr double kStandsWithinS = 6;
constexpr auto kStandsWithin = static_cast<std::uint64_t>(kStandsWithinS / kDtS);
/// In which a drive that is switched on stops a motor that turns.
constexpr std::uint64_t kBrakesWithin = 100;

struct Kind {
  std::string folder;
  Room room;
  std::size_t joints{3};
  bool jerk{false};
};

// The name is GoogleTest's.
// NOLINTNEXTLINE(readability-identifier-naming)
void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.folder << (kind.jerk ? " with jerk limits" : "");
}

std::string ini_of(const Kind& kind) {
  return KERF_SOURCE_DIR "/configs/sim/" + kind.folder + "/" + kind.folder + ".ini";
}

MachineOptions options_of(const Kind& kind, std::vector<double>& jerk) {
  MachineOptions options;
  options.ini = ini_of(kind);
  options.replace.push_back({"[AXIS_Z]\n", "[AXIS_Z]\nOFFSET_AV_RATIO = 0.2\n"});
  if (kind.jerk) jerk = limit_jerk(options, kind.joints, kRampS);
  options.append = "\n[KERF]\nPATH_CHECK = 1\n";
  return options;
}

class Operator {
 public:
  /// `jerk`: limits of the joints.
  Operator(Machine& m, const Kind& kind, const std::vector<double>& jerk, unsigned seed)
      : m_(m), kind_(kind), watch_(ini_of(kind), kind.joints, jerk), dice_(seed) {}

  void session() {
    EXPECT_TRUE(m_.hal("setp axis.z.eoffset-scale 0.1"));
    m_.on_cycle([this](const motion::MotionStatus& s) { look(s); });
    for (int i = 0; i < kCommands; ++i) {
      act();
      constexpr int kPauses[]{0, 1, 2, 5, 20, 20, 100, 100, 300, 300, 1000, 2500};
      for (int n = kPauses[one_of(12)] * (1 + one_of(8)) / 4; n > 0; --n) {
        if (swings_ && n % 2 == 0) swing();
        m_.cycle();
        if (testing::Test::HasFailure()) break;
      }
      settle();
      restart();
      if (!testing::Test::HasFailure()) continue;
      // What was wrong is told a moment later.
      const std::size_t known = m_.errors().size();
      m_.run_for(0.1);
      ADD_FAILURE() << "then: " << m_.errors().substr(known);
      return;
    }
  }
  /// Behind it all the machine stops, is in order and nothing is lost.
  void end() {
    does({"abort"});
    pins_at_rest();
    for (const char* what : {"feed-override", "rapid-override", "spindle-override"})
      EXPECT_TRUE(m_.does({what, "1"}));
    (void)m_.does({"max-velocity", "1000"});
    (void)m_.does({"optional-stop", "off"});
    EXPECT_TRUE(m_.does({"abort"})) << story();
    EXPECT_TRUE(m_.run_until([&] { return m_.task().idle; }, kStandsWithinS)) << story();
    // An external offset goes back.
    m_.run_for(2);
    settle();
    for (const auto& [id, words] : open_)
      ADD_FAILURE() << "no outcome: " << text_of(words) << "\n" << story();
    in_order();
  }
  void in_order() {
    machine_pins_at_rest();
    if (m_.task().task_state == task::TaskState::estop) {
      EXPECT_TRUE(m_.does({"state", "estop-reset"})) << story();
    }
    if (m_.task().task_state != task::TaskState::on) {
      EXPECT_TRUE(m_.does({"state", "on"})) << story();
    }
    if (!m_.motion().all_homed) {
      still_from_ = ~0ULL;
      EXPECT_TRUE(m_.does({"home", "-1"}, 60)) << story();
    }
  }
  [[nodiscard]] std::string story() const {
    std::string text = "the last commands:\n";
    const std::size_t first = story_.size() > 40 ? story_.size() - 40 : 0;
    for (std::size_t i = first; i < story_.size(); ++i) text += "  " + story_[i] + "\n";
    std::string errors = m_.errors();
    if (errors.size() > 1500) errors = "..." + errors.substr(errors.size() - 1500);
    return text + "messages:\n" + errors;
  }
  [[nodiscard]] double moved_s() const { return moved_s_; }
  std::map<std::string, int> outcomes;

 private:
  static constexpr int kCommands = 150;
  static std::string text_of(const Words& words) {
    std::string text;
    for (const std::string& w : words) text += (text.empty() ? "" : " ") + w;
    return text;
  }
  int one_of(int n) { return static_cast<int>(dice_() % static_cast<unsigned>(n)); }
  std::string an_axis() {
    const std::string& axes = kind_.room.axes;
    return std::string(1, axes[static_cast<std::size_t>(one_of(static_cast<int>(axes.size())))]);
  }
  std::string a_joint() { return std::to_string(one_of(static_cast<int>(kind_.joints))); }
  std::string number(double low, double high) {
    return std::to_string(low + (high - low) * one_of(1001) / 1000);
  }
  void note(const std::string& what) {
    char when[32];
    std::snprintf(when, sizeof when, "%9.3f ", static_cast<double>(m_.now()) * 1e-9);
    story_.push_back(when + what);
  }
  void does(const Words& words) {
    note(text_of(words));
    const std::string& what = words[0];
    const bool stops =
        what == "abort" || (what == "state" && words[1] != "on" && words[1] != "estop-reset");
    if (stops) {
      // From a while on nothing moves, until somebody asks for it again.
      still_from_ = m_.motion().cycle + kStandsWithin;
      spindle_off_from_ = m_.motion().cycle + 200;
    } else if (moves(what)) {
      still_from_ = spindle_off_from_ = ~0ULL;
    } else if (what == "spindle") {
      spindle_off_from_ = ~0ULL;
    }
    open_.emplace_back(m_.send(words), words);
    if (stops) last_move_ = 0;
    if (moves(what)) last_move_ = open_.back().first;
  }
  static bool moves(const std::string& what) {
    constexpr const char* kMove[]{"run",  "step",   "resume", "mdi",           "jog",
                                  "home", "return", "answer", "exchange-tool", "away"};
    return std::any_of(std::begin(kMove), std::end(kMove),
                       [&](const char* w) { return what == w; });
  }

  void act() {
    const std::string axis = an_axis();
    if (m_.task().idle) {
      // What moves at all comes first.
      const int what = one_of(6);
      if (what < 2) return does({"mdi", mdi()});
      if (what < 4) return does({"run"});
    }
    switch (one_of(30)) {
      case 0: return does({"run"});
      case 1:
        if (one_of(2) == 0) {
          does({"abort"});
          m_.run_for(0.5);
        }
        return does({"mdi", mdi()});
      case 2:
      case 14: return does({"jog", axis, number(-60, 60), number(0.01, 8)});
      case 3: return does({"jog", a_joint(), number(-20, 20)});
      case 4:
      case 5: return does({"pause"});
      case 6:
      case 7:
      case 8: return does({"resume"});
      case 9:
      case 10: return does({"step"});
      case 11: return does({"abort"});
      case 12: return does({"mdi", mdi()});
      case 13: return does({"mdi", "G4 P0.1"});
      case 15: return does({"jog", axis, number(-60, 60)});
      case 16: return does({"jog-stop"});
      case 17: return does({"feed-override", one_of(4) == 0 ? "0" : number(0, 1.5)});
      case 18: return does({"rapid-override", one_of(4) == 0 ? "0" : number(0, 1)});
      case 19: return does({"feed-override", "1"});
      case 20: return does({"away"});
      case 21: return does({"return"});
      case 22: return does({"direction", one_of(2) == 0 ? "reverse" : "forward"});
      case 23: return does({"run", std::to_string(1 + one_of(40))});
      case 24: return one_of(2) == 0 ? rarely() : turn_pins();
      case 25: return does({"max-velocity", number(0.1, 100)});
      case 26: return does({"spindle-override", number(0.5, 1.5)});
      case 27: return does({"mode", one_of(3) == 0 ? "manual" : one_of(2) == 0 ? "auto" : "mdi"});
      case 28: return does({"optional-stop", one_of(2) == 0 ? "on" : "off"});
      default: return does({"rapid-override", "1"});
    }
  }
  /// Off at full speed its motors coast to where the switches are, and nobody here jogs them off.
  [[nodiscard]] bool coasts() const { return kind_.folder == "mill-4axis" && watch_.moves(); }
  void rarely() {
    const int what = one_of(12);
    if (what < 2 && coasts()) return does({"abort"});
    switch (what) {
      case 0: return does({"state", "estop"});
      case 1: return does({"state", "off"});
      // Where an arm has been the switches may lie behind it.
      case 2: {
        const bool arm = kind_.folder == "puma" || kind_.folder == "scara";
        return arm ? does({"abort"}) : does({"home", "-1"});
      }
      case 3: return does({"teleop", one_of(2) == 0 ? "on" : "off"});
      case 4: return does({"spindle", "forward", "500"});
      case 5: return does({"spindle", "off"});
      case 6: return does({"flood", one_of(2) == 0 ? "on" : "off"});
      case 7: return does({"exchange-tool"});
      case 8: return does({"block-delete", one_of(2) == 0 ? "on" : "off"});
      case 9: return does({"answer"});
      case 10: return does({"run", std::to_string(1 + one_of(40)), "hold"});
      default:
        for (const Words& words : {Words{"state", "estop-reset"}, Words{"state", "on"}})
          does(words);
    }
  }
  /// What sensors and other programs do.
  void turn_pins() {
    const auto set = [this](const std::string& pin, const std::string& value) {
      note("setp " + pin + " " + value);
      const bool moves =
          pin.find("eoffset") != std::string::npos || pin.find("jog-") != std::string::npos;
      if (moves) still_from_ = ~0ULL, last_move_ = ~0ULL;
      // Some machines have nets there.
      if (!m_.hal("setp " + pin + " " + value)) note("  it is wired");
    };
    const std::string bit = one_of(2) == 0 ? "1" : "0", seldom = one_of(4) == 0 ? "1" : "0",
                      off = coasts() ? "0" : seldom;
    const std::string axis = "axis." + an_axis(), joint = "joint." + a_joint(),
                      ini = "ini." + a_joint();
    switch (one_of(27)) {
      case 8: return set(axis + ".jog-scale", number(-0.2, 0.5));
      case 9:
      case 10: return set(axis + ".jog-counts", std::to_string(one_of(100)));
      case 11: return set(axis + ".jog-enable", bit);
      case 12: return set(joint + ".jog-scale", number(-0.2, 0.5));
      case 13: return set(joint + ".jog-counts", std::to_string(one_of(100)));
      case 14: return set(joint + ".jog-enable", bit);
      case 15: return set(axis + ".jog-vel-mode", bit);
      case 16: return set("motion.jog-inhibit", seldom);
      case 17: return set("motion.jog-stop", seldom);
      case 18: return set("motion.homing-inhibit", seldom);
      case 19: return set("motion.enable", off == "1" ? "0" : "1");
      case 20: return set(joint + ".amp-fault-in", off);
      case 21: return set("spindle.0.at-speed", bit);
      case 22: return set("spindle.0.inhibit", seldom);
      case 23: return set("spindle.0.amp-fault-in", off);
      case 24: return set("motion.digital-in-00", bit);
      case 25: return set(axis + ".jog-accel-fraction", number(0.1, 1));
      case 26: return set(ini + ".max_velocity", number(20, 60));
      case 0: return set("motion.feed-inhibit", one_of(2) == 0 ? "1" : "0");
      case 1: return set("motion.feed-hold", one_of(2) == 0 ? "1" : "0");
      case 2: return set("motion.adaptive-feed", number(-0.5, 1.2));
      case 3: swings_ = one_of(2) == 0; return set("motion.adaptive-feed", "1");
      case 4: return set("motion.probe-input", one_of(2) == 0 ? "1" : "0");
      case 5: return set("axis.z.eoffset-enable", one_of(4) > 0 ? "1" : "0");
      case 6: return set("axis.z.eoffset-counts", std::to_string(one_of(41) - 20));
      default: return set("axis.z.eoffset-clear", one_of(2) == 0 ? "1" : "0");
    }
  }
  /// What of them bears on homing and switching on.
  void machine_pins_at_rest() {
    std::vector<std::string> lines{"motion.homing-inhibit 0", "motion.enable 1",
                                   "spindle.0.amp-fault-in 0", "motion.jog-inhibit 0"};
    for (std::size_t j = 0; j < kind_.joints; ++j)
      lines.push_back("joint." + std::to_string(j) + ".amp-fault-in 0");
    for (const std::string& line : lines) (void)m_.hal("setp " + line);
  }
  /// The feed follows a load.
  void swing() {
    const double feed = 0.7 + 0.3 * std::sin(static_cast<double>(m_.motion().cycle) * 0.004);
    EXPECT_TRUE(m_.hal("setp motion.adaptive-feed " + std::to_string(feed)));
  }
  void pins_at_rest() {
    machine_pins_at_rest();
    swings_ = false;
    std::vector<std::string> lines{
        "motion.feed-inhibit 0", "motion.feed-hold 0",      "motion.adaptive-feed 1",
        "motion.probe-input 0",  "axis.z.eoffset-counts 0", "axis.z.eoffset-clear 0",
        "spindle.0.at-speed 1",  "spindle.0.inhibit 0",     "motion.jog-stop 0"};
    for (const char axis : kind_.room.axes)
      lines.push_back(std::string("axis.") + axis + ".jog-enable 0");
    for (std::size_t j = 0; j < kind_.joints; ++j)
      lines.push_back("joint." + std::to_string(j) + ".jog-enable 0");
    for (const std::string& line : lines) (void)m_.hal("setp " + line);
  }
  std::string mdi() {
    if (kind_.folder == "xyzac-trt") {
      switch (one_of(9)) {
        case 0: return "G43.1 Z" + number(-30, 30);
        case 1: return "G49";
        case 2: return "M429";
        case 3: return "M428";
        case 4: return "G90 G53 G0 A" + number(-40, 0) + " C" + number(-400, 400);
        case 5: return "G90 G53 G1 F2000 X" + number(-60, 60) + " Y" + number(-60, 60);
        case 6: return "G43 H" + std::to_string(one_of(4)) + " G91 G1 F900 X" + number(-3, 3);
        default: break;
      }
    }
    if (kind_.folder != "mill") return "G91 G1 Z" + number(-2, 2) + " F1200";
    switch (one_of(6)) {
      case 0: return "G90 G53 G1 F3000 X" + number(20, 100) + " Y" + number(20, 90);
      case 1: return "G91 G0 X" + number(-5, 5);
      case 2: return "M3 S900";
      case 3: return "G91 G2 X2 Y0 I1 J0 F900";
      case 4: return "G91 G38.3 Z-1 F200";
      default: return "M5";
    }
  }

  /// Takes the outcomes that have come.
  void settle() {
    std::erase_if(open_, [&](const auto& open) {
      const task::Reply reply = m_.outcome(open.first);
      if (!task::is_terminal(reply.state)) return false;
      ++outcomes[open.second[0] + " " + std::string(task::to_string(reply.state))];
      if (reply.state == CommandState::error && reply.text.empty())
        ADD_FAILURE() << "an error without a reason: " << text_of(open.second) << "\n" << story();
      // A pause holds what there is; where there was nothing, it is refused.
      if (open.second[0] == "pause" && reply.state == CommandState::done && open.first > last_move_)
        still_from_ = std::min(still_from_, m_.motion().cycle + kStandsWithin);
      return true;
    });
  }
  /// On again after a while of being off, and homed.
  void restart() {
    if (m_.task().task_state != task::TaskState::on && one_of(4) == 0) in_order();
    if (m_.task().task_state == task::TaskState::on && !m_.motion().all_homed && one_of(8) == 0)
      does({"home", "-1"});
  }

  void look(const motion::MotionStatus& s) {
    if (testing::Test::HasFailure()) return;
    const std::string broken = watch_.look(s);
    if (!broken.empty()) ADD_FAILURE() << "cycle " << s.cycle << ":" << broken << "\n" << story();
    if (watch_.moves()) moved_s_ += kDtS;
    if (!s.enabled) on_from_ = s.cycle + 1;
    // A machine that is off follows its motors.
    if (s.cycle > still_from_ && s.enabled && watch_.moves())
      ADD_FAILURE() << "cycle " << s.cycle << ": it moves, and nobody asked for it\n" << story();
    if (s.cycle > spindle_off_from_ && s.spindle[0].on)
      ADD_FAILURE() << "cycle " << s.cycle << ": the spindle runs, and nobody asked for it\n"
                    << story();
    if (s.jogging && !s.path_empty && !s.away && !s.held)
      ADD_FAILURE() << "cycle " << s.cycle << ": the path runs beside a jog\n" << story();
    for (; faults_ < s.faults; ++faults_) look_at(fault(faults_ + 1), s);
  }

  motion::FaultRecord fault(std::uint64_t number) {
    auto block = hal::View(m_.segment())
                     .block<motion::MotionShared>(motion::kMotionBlock, motion::kMotionAbi);
    motion::FaultRecord record;
    EXPECT_TRUE(block.ok() &&
                (*block)->faults.slot[number % motion::FaultLog::kSlots].read(record));
    return record;
  }
  /// Nobody but a human can be at fault here: lines and jogs to beyond the limits.
  void look_at(const motion::FaultRecord& fault, const motion::MotionStatus& s) {
    using motion::Fault;
    constexpr Fault kOwn[]{Fault::joint_soft_limit_min,
                           Fault::joint_soft_limit_max,
                           Fault::axis_soft_limit_min,
                           Fault::axis_soft_limit_max,
                           Fault::jog_beyond_limit,
                           Fault::jog_while_not_ready,
                           Fault::not_homed,
                           Fault::probe_already_tripped,
                           Fault::probe_unexpected,
                           Fault::amp_fault,
                           Fault::enable_lost,
                           Fault::spindle_fault};
    // A move to where an arm has no place for its joints is refused before it begins.
    const bool refused = fault.fault == Fault::no_inverse && s.enabled;
    const bool inhibited = fault.fault == Fault::home_failed && m_.bit("motion.homing-inhibit");
    // Motors that coast when they are switched on cannot stand at once.
    const bool coasted =
        fault.fault == Fault::following_error && s.cycle < on_from_ + kBrakesWithin;
    // A taper at the end of a thread is a corner.
    const bool corner = fault.fault == Fault::sync_behind && kind_.folder == "lathe" && kind_.jerk;
    if (!refused && !inhibited && !coasted && !corner &&
        std::find(std::begin(kOwn), std::end(kOwn), fault.fault) == std::end(kOwn))
      ADD_FAILURE() << "cycle " << s.cycle << ": " << motion::fault_name(fault.fault) << " of "
                    << fault.index << ", " << fault.value << "\n"
                    << story();
    ++outcomes[std::string("fault ") + motion::fault_name(fault.fault)];
  }

  Machine& m_;
  const Kind& kind_;
  JointWatch watch_;
  std::mt19937 dice_;
  std::vector<std::pair<std::uint64_t, Words>> open_;
  std::vector<std::string> story_;
  std::uint64_t still_from_{~0ULL}, spindle_off_from_{~0ULL}, faults_{0}, on_from_{0};
  std::uint64_t last_move_{0};  ///< command that may begin a motion
  double moved_s_{0};
  bool swings_{false};  ///< adaptive feed, from cycle to cycle
};

class RandomOperator : public testing::TestWithParam<Kind> {};

std::string program_of(const Kind& kind, Machine& m, std::mt19937& dice) {
  const bool usual = dice() % 2 == 0;
  if (usual && kind.folder == "mill") return m.write_program(mill_program(dice));
  if (usual) return KERF_SOURCE_DIR "/configs/sim/" + kind.folder + "/demo.ngc";
  return m.write_program(RoomProgram(kind.room, dice).text());
}

TEST_P(RandomOperator, GetsNoJointBeyondALimitAndNoMoveThatNobodyAskedFor) {
  const Kind& kind = GetParam();
  const char* const count = std::getenv("KERF_COUNT");
  const char* const from = std::getenv("KERF_SEED");
  const unsigned first = from != nullptr ? static_cast<unsigned>(std::stoul(from)) : 1;
  const unsigned sessions = count != nullptr ? static_cast<unsigned>(std::stoul(count)) : 2;
  std::map<std::string, int> outcomes;
  double moved_s = 0;
  for (unsigned seed = first; seed < first + sessions && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::vector<double> jerk;
    auto m = Machine::start(options_of(kind, jerk));
    ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
    std::mt19937 dice(seed + 7777);
    ASSERT_TRUE(m->does({"open", program_of(kind, *m, dice)})) << m->errors();
    Operator someone(*m, kind, jerk, seed);
    someone.session();
    if (HasFailure()) break;
    someone.end();
    for (const auto& [what, n] : someone.outcomes) outcomes[what] += n;
    moved_s += someone.moved_s();
    // Nothing moves on a line to the place that is shown, and the machine works as ever.
    EXPECT_TRUE(m->mdi(kind.room.lathe ? "G8 G49" : "G49")) << m->errors();
    const motion::MotionStatus before = m->motion();
    const std::string line = m->line_to_shown_place(kind.room.axes);
    EXPECT_TRUE(m->mdi(line)) << m->errors();
    for (std::size_t j = 0; j < kind.joints; ++j)
      EXPECT_NEAR(m->joint(j), before.joint[j].pos_cmd, 1e-6) << "joint " << j << ": " << line;
    if (kind.folder == "mill") {
      EXPECT_TRUE(m->mdi("G21 G90 G54 G53 G0 X50 Y50 Z-20")) << m->errors();
      EXPECT_NEAR(m->joint(0), 50, 1e-9);
    }
  }
  std::string text;
  for (const auto& [what, n] : outcomes) text += ", " + what + " " + std::to_string(n);
  std::printf("result: %u sessions at %s: %.0f s of motion%s\n", sessions,
              testing::PrintToString(kind).c_str(), moved_s, text.c_str());
}

/// Undisturbed: what the operator meets is what the programs do, not their errors.
TEST_P(RandomOperator, HasProgramsThatRunToTheirEnds) {
  const Kind& kind = GetParam();
  std::vector<double> jerk;
  auto m = Machine::start(options_of(kind, jerk));
  ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
  std::mt19937 dice(1);
  for (int n = 0; n < 2; ++n) {
    const std::string program = program_of(kind, *m, dice);
    const std::uint64_t id = m->start_program(program);
    const auto ended = [&] { return task::is_terminal(m->outcome(id).state); };
    // M0 waits for somebody.
    while (!m->run_until([&] { return ended() || m->task().paused; }, 600) || !ended()) {
      ASSERT_TRUE(m->task().paused) << program;
      ASSERT_TRUE(m->does({"resume"})) << m->errors();
    }
    EXPECT_EQ(m->outcome(id).state, CommandState::done) << program << "\n" << m->errors();
  }
}

std::vector<Kind> kinds() {
  std::vector<Kind> all;
  for (const bool jerk : {false, true}) {
    all.push_back({"mill", {"xyz", {60, 40, -20}, {40, 30, 10}}, 3, jerk});
    all.push_back({"corexy", {"xyz", {150, 150, 10}, {60, 60, 8}}, 3, jerk});
    all.push_back({"xyzac-trt", {"xyzac", {0, 0, -140, -15, 0}, {40, 40, 30, 20, 120}}, 5, jerk});
    all.push_back(
        {"puma", {"xyzabc", {600, 150, 120, -150, -30, 10}, {40, 60, 50, 15, 15, 20}}, 6, jerk});
    all.push_back({"lathe", {"xz", {30, -60}, {20, 50}, true}, 2, jerk});
    all.push_back({"gantry", {"xyz", {300, 500, -60}, {200, 200, 40}}, 4, jerk});
    all.push_back({"delta", {"xyz", {0, 0, 100}, {50, 50, 60}}, 3, jerk});
    all.push_back({"scara", {"xyzc", {330, 300, 430, 90}, {50, 60, 30, 60}}, 4, jerk});
    all.push_back({"mill-4axis", {"xyza", {100, 0, 90, 0}, {60, 60, 25, 200}}, 4, jerk});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Sims, RandomOperator, testing::ValuesIn(kinds()), [](const auto& tested) {
  std::string name = tested.param.folder + (tested.param.jerk ? "_jerk" : "");
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace kerf::harness
