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

struct Kind {
  std::string folder, axes, program;
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

/// Of everything a little, on the mill.
std::string mill_program(std::mt19937& dice) {
  const std::vector<std::string> parts{
      "G1 X60 Y40 F1500\nG1 X62 Y41\nG1 X60.5 Y43\nG1 X59 Y41.5\nG1 X60 Y40\n",
      "G2 X70 Y40 I5 J0 F2400\nG3 X60 Y40 R6\n",
      "G91\no101 repeat [12]\nG1 X0.3 Y0.1 F1200\nG1 X-0.1 Y-0.05\no101 endrepeat\nG90\n",
      "G3 X60 Y40 Z-30 I-6 J2 P3 F3000\nG0 Z-20\n",
      "M62 P0\nG1 X80 Y60 F4000\nM63 P0\nG1 X60 Y40\n",
      "S1500 M3\nG1 X55 F800\nM5\nG1 X60\n",
      "S800 M4\nG4 P0.15\nM5\n",
      "M8\nM7\nG0 X90 Y20\nM9\nG0 X60 Y40\n",
      "T2 M6\nG43\nG0 Z-25\nG49\nG0 Z-20\n",
      "G81 X70 Y50 Z-24 R-21 F600\nX72 Y52\nG80\nG0 X60 Y40 Z-20\n",
      "S600 M3\nG33 Z-26 K1.5\nM5\nG0 Z-20\n",
      "S600 M3\nG33.1 Z-26 K1\nM5\nG0 Z-20\n",
      "G38.3 Z-22 F300\nG0 Z-20\n",
      "G93\nG1 X65 Y45 F30\nG1 X60 Y40 F40\nG94 F1000\n",
      "G95 S900 M3 F0.5\nG1 X64\nG1 X60\nM5\nG94 F1000\n",
      "G5 I3 J5 P-2 Q-4 X70 Y44 F1800\nG0 X60 Y40\n",
      "G61\nG1 X63 Y41 F2000\nG1 X62 Y44\nG1 X60 Y40\nG64 P0.02\n",
      "M66 P0 L3 Q0.1\nG1 X61\nG1 X60\n",
      "M1\nG1 X58 F1000\nG1 X60\n",
      "M0\n",
      "/G1 X57 F1500\nG1 X60\n",
      "M19 R45 Q2\nM5\n",
      "G10 L2 P2 X1 Y1 Z0\nG55\nG1 X60 Y40 F2500\nG54\nG1 X60 Y40\n",
      "G64 P0.5\no102 repeat [10]\nG1 X61 Y40.4 F3000\nG1 X60 Y40\no102 endrepeat\nG64 P0.02\n",
  };
  std::string text = "M52 P1 M53 P1\nG21 G90 G17 G40 G49 G54 G80 G94 G64 P0.02\nG0 X60 Y40 Z-20\n";
  for (int i = 0; i < 14; ++i) text += parts[dice() % parts.size()];
  return text + "M5 M9\nG49 G54 G0 X60 Y40 Z-20\nM2\n";
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
        m_.cycle();
        if (testing::Test::HasFailure()) break;
      }
      settle();
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
    EXPECT_TRUE(m_.does({"abort"})) << story();
    EXPECT_TRUE(m_.run_until([&] { return m_.task().idle; }, kStandsWithinS)) << story();
    m_.run_for(0.5);
    settle();
    for (const auto& [id, words] : open_)
      ADD_FAILURE() << "no outcome: " << text_of(words) << "\n" << story();
    in_order();
    for (const char* what : {"feed-override", "rapid-override", "spindle-override"})
      EXPECT_TRUE(m_.does({what, "1"}));
    (void)m_.does({"max-velocity", "1000"});
    (void)m_.does({"optional-stop", "off"});
  }
  void in_order() {
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
    const std::string axis(
        1, kind_.axes[static_cast<std::size_t>(one_of(static_cast<int>(kind_.axes.size())))]);
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
      case 3:
        return does(
            {"jog", std::to_string(one_of(static_cast<int>(kind_.joints))), number(-20, 20)});
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
  void rarely() {
    switch (one_of(12)) {
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
      if (pin.find("eoffset") != std::string::npos) still_from_ = ~0ULL, last_move_ = ~0ULL;
      EXPECT_TRUE(m_.hal("setp " + pin + " " + value)) << story();
    };
    switch (one_of(8)) {
      case 0: return set("motion.feed-inhibit", one_of(2) == 0 ? "1" : "0");
      case 1: return set("motion.feed-hold", one_of(2) == 0 ? "1" : "0");
      case 2: return set("motion.adaptive-feed", number(-0.5, 1.2));
      case 3: return set("motion.adaptive-feed", "1");
      case 4: return set("motion.probe-input", one_of(2) == 0 ? "1" : "0");
      case 5: return set("axis.z.eoffset-enable", one_of(4) > 0 ? "1" : "0");
      case 6: return set("axis.z.eoffset-counts", std::to_string(one_of(41) - 20));
      default: return set("axis.z.eoffset-clear", one_of(2) == 0 ? "1" : "0");
    }
  }
  void pins_at_rest() {
    for (const char* line : {"setp motion.feed-inhibit 0", "setp motion.feed-hold 0",
                             "setp motion.adaptive-feed 1", "setp motion.probe-input 0",
                             "setp axis.z.eoffset-counts 0", "setp axis.z.eoffset-clear 0"})
      EXPECT_TRUE(m_.hal(line)) << line;
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

  /// Outcomes, and the machine on again after a while of being off.
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
    if (m_.task().task_state != task::TaskState::on && one_of(4) == 0) in_order();
    if (m_.task().task_state == task::TaskState::on && !m_.motion().all_homed && one_of(8) == 0)
      does({"home", "-1"});
  }

  void look(const motion::MotionStatus& s) {
    if (testing::Test::HasFailure()) return;
    const std::string broken = watch_.look(s);
    if (!broken.empty()) ADD_FAILURE() << "cycle " << s.cycle << ":" << broken << "\n" << story();
    if (watch_.moves()) moved_s_ += kDtS;
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
                           Fault::probe_unexpected};
    // A move to where an arm has no place for its joints is refused before it begins.
    const bool refused = fault.fault == Fault::no_inverse && s.enabled;
    if (!refused && std::find(std::begin(kOwn), std::end(kOwn), fault.fault) == std::end(kOwn))
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
  std::uint64_t still_from_{~0ULL}, spindle_off_from_{~0ULL}, faults_{0};
  std::uint64_t last_move_{0};  ///< command that may begin a motion
  double moved_s_{0};
};

class RandomOperator : public testing::TestWithParam<Kind> {};

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
    const std::string program =
        kind.program.empty() ? m->write_program(mill_program(dice)) : kind.program;
    ASSERT_TRUE(m->does({"open", program})) << m->errors();
    Operator someone(*m, kind, jerk, seed);
    someone.session();
    if (HasFailure()) break;
    someone.end();
    for (const auto& [what, n] : someone.outcomes) outcomes[what] += n;
    moved_s += someone.moved_s();
    // Nothing moves on a line to the place that is shown, and the machine works as ever.
    const double at[2]{m->joint(0), m->joint(1)};
    if (kind.folder == "mill") {
      EXPECT_TRUE(m->mdi("G49 " + m->line_to_shown_place())) << m->errors();
      EXPECT_NEAR(m->joint(0), at[0], 1e-6);
      EXPECT_NEAR(m->joint(1), at[1], 1e-6);
      EXPECT_TRUE(m->mdi("G21 G90 G54 G49 G53 G0 X50 Y50 Z-20")) << m->errors();
      EXPECT_NEAR(m->joint(0), 50, 1e-9);
    }
  }
  std::string text;
  for (const auto& [what, n] : outcomes) text += ", " + what + " " + std::to_string(n);
  std::printf("result: %u sessions at %s: %.0f s of motion%s\n", sessions,
              testing::PrintToString(kind).c_str(), moved_s, text.c_str());
}

std::string demo(const std::string& folder) {
  return KERF_SOURCE_DIR "/configs/sim/" + folder + "/demo.ngc";
}

std::vector<Kind> kinds() {
  std::vector<Kind> all;
  for (const bool jerk : {false, true}) {
    all.push_back({"mill", "xyz", "", 3, jerk});
    all.push_back({"corexy", "xyz", demo("corexy"), 3, jerk});
    all.push_back({"xyzac-trt", "xyzac", demo("xyzac-trt"), 5, jerk});
    all.push_back({"puma", "xyzabc", demo("puma"), 6, jerk});
    all.push_back({"lathe", "xz", demo("lathe"), 2, jerk});
    all.push_back({"gantry", "xyz", demo("gantry"), 4, jerk});
    all.push_back({"delta", "xyz", demo("delta"), 3, jerk});
    all.push_back({"scara", "xyzc", demo("scara"), 4, jerk});
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
