// The machines of configs/sim: each starts from its INI file, homes to its switches and runs its demo program, with every joint
// inside its limits in every cycle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>
#include <numeric>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "harness/joint_watch.hpp"
#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

constexpr double kDtS = 0.001;
/// In which joints that are limited in jerk reach their acceleration.
constexpr double kRampS = 0.04;

struct Sim {
  std::string folder, ini, program;
  std::vector<double> home;  ///< joints after homing
  rtapi::Pose end;           ///< where the program ends, machine coordinates
};

// The name is GoogleTest's.
// NOLINTNEXTLINE(readability-identifier-naming)
void PrintTo(const Sim& sim, std::ostream* out) { *out << sim.folder; }

std::string config(const std::string& folder, const std::string& file) {
  return std::string(KERF_SOURCE_DIR "/configs/sim/") + folder + "/" + file;
}

Sim sim(const std::string& folder, std::vector<double> home, const rtapi::Pose& end) {
  return {folder, config(folder, folder + ".ini"), config(folder, "demo.ngc"), std::move(home),
          end};
}

class Sims : public testing::TestWithParam<Sim> {};

TEST_P(Sims, StartsHomesAndRunsItsDemo) {
  const Sim& sim = GetParam();
  MachineOptions options;
  options.ini = sim.ini;
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_EQ(m->errors(), "");
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_TRUE(m->motion().all_homed);
  ASSERT_EQ(static_cast<std::size_t>(m->motion().joints), sim.home.size());
  for (std::size_t j = 0; j < sim.home.size(); ++j)
    EXPECT_NEAR(m->joint(j), sim.home[j], 1e-6) << "joint " << j;

  JointWatch watch(sim.ini, sim.home.size());
  m->on_cycle([&](const motion::MotionStatus& s) { (void)watch.look(s); });
  const auto reply = m->run_program(sim.program);
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << "\n" << m->errors();
  watch.check();
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  EXPECT_GT(watch.cycles(), 10000U);
  EXPECT_FALSE(m->motion().spindle[0].on);
  const rtapi::Pose at = m->motion().pos_cmd;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    EXPECT_NEAR(at[i], sim.end[i], 1e-4) << "axis "
                                         << "XYZABCUVW"[i];
}

/// Machines whose kinematics mix axes.
class SimsThatMixAxes : public Sims {};

MachineOptions with_jerk_limits(const Sim& sim, bool jerks, std::vector<double>& jerk) {
  MachineOptions options;
  options.ini = sim.ini;
  jerk.assign(sim.home.size(), 0.0);
  if (jerks) jerk = limit_jerk(options, sim.home.size(), kRampS);
  return options;
}

TEST_P(SimsThatMixAxes, RunTheirDemosLimitedInJerkWithoutStandingAtCorners) {
  const Sim& sim = GetParam();
  double seconds[2]{};
  for (const bool jerks : {false, true}) {
    std::vector<double> jerk;
    auto m = Machine::start(with_jerk_limits(sim, jerks, jerk));
    ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
    JointWatch watch(sim.ini, jerk.size(), jerk);
    m->on_cycle([&](const motion::MotionStatus& s) { (void)watch.look(s); });
    const auto reply = m->run_program(sim.program);
    EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << "\n" << m->errors();
    watch.check();
    EXPECT_EQ(m->motion().faults, 0U) << m->errors();
    seconds[jerks ? 1 : 0] = static_cast<double>(watch.cycles()) * kDtS;
  }
  std::printf("result: demo of %s: %.2f s, with jerk limits %.2f s\n", sim.folder.c_str(),
              seconds[0], seconds[1]);
  EXPECT_LT(seconds[1], 1.45 * seconds[0]);
}

/// Axes jogged at random from where the demo ends, one or two at a time, to and fro and into the ends of the workspace.
TEST_P(SimsThatMixAxes, KeepTheirJointsLimitsInJogsOfAxes) {
  const Sim& sim = GetParam();
  const char* count = std::getenv("KERF_COUNT");
  // The last one creeps to and fro at the edge of the Puma's reach.
  std::vector<unsigned> seeds{1, 2, 15};
  if (count != nullptr) {
    seeds.resize(2 * std::stoul(count));
    std::iota(seeds.begin(), seeds.end(), 1U);
  }
  for (const unsigned seed : seeds) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const bool jerks = seed % 2 == 0;
    std::vector<double> jerk;
    auto m = Machine::start(with_jerk_limits(sim, jerks, jerk));
    ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
    ASSERT_EQ(m->run_program(sim.program).state, task::CommandState::done) << m->errors();
    ASSERT_TRUE(m->does({"mode", "manual"}) && m->does({"teleop", "on"}));
    JointWatch watch(sim.ini, jerk.size(), jerk);
    m->on_cycle([&](const motion::MotionStatus& s) { (void)watch.look(s); });
    std::string letters;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      if (!m->pin_kind(std::string("axis.") + "xyzabcuvw"[i] + ".pos-cmd").empty())
        letters += "xyzabcuvw"[i];
    std::mt19937 dice(seed);
    const auto one_of = [&](unsigned n) { return static_cast<std::size_t>(dice() % n); };
    for (int jogs = 0; jogs < 100; ++jogs) {
      const auto speed = static_cast<int>(one_of(300)) - 150;
      std::vector<std::string> words{
          "jog", std::string(1, letters[one_of(static_cast<unsigned>(letters.size()))]),
          std::to_string(speed == 0 ? 1 : speed)};
      if (one_of(3) > 0) words.push_back(std::to_string(1 + one_of(60)));
      (void)m->send(words);
      m->run_for(0.01 * static_cast<double>(one_of(150)));
      if (one_of(8) == 0) (void)m->send({"jog-stop"});
      if (one_of(30) == 0) (void)m->abort();
    }
    (void)m->does({"jog-stop"});
    EXPECT_TRUE(m->run_until([&] { return !m->motion().jogging; }, 10));
    watch.check();
    EXPECT_TRUE(m->motion().enabled) << m->errors();
  }
}

// At the home of the delta's carriages.
const double delta_z = 500 - std::sqrt(269.0 * 269.0 - 130.25 * 130.25);

std::string name_of(const testing::TestParamInfo<Sim>& tested) {
  std::string name = tested.param.folder;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::vector<Sim> sims_that_mix_axes() {
  return {sim("corexy", {0, 0, 0}, {.z = 12}), sim("delta", {500, 500, 500}, {.z = 220}),
          sim("scara", {0, 90, 0, 0}, {.x = 330, .y = 300, .z = 470, .c = 0}),
          sim("xyzac-trt", {0, 0, 0, 0, 0}, {}),
          sim("puma", {0, -60, 0, 45, 45, -45},
              {.x = 600, .y = 150, .z = 120, .a = -150, .b = -30, .c = 10})};
}

INSTANTIATE_TEST_SUITE_P(ConfigsThatMixAxes, Sims, testing::ValuesIn(sims_that_mix_axes()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Configs, SimsThatMixAxes, testing::ValuesIn(sims_that_mix_axes()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(
    Configs, Sims,
    testing::Values(Sim{"mill",
                        config("mill", "mill.ini"),
                        KERF_SOURCE_DIR "/nc_files/examples/first_part.ngc",
                        {0, 0, 0},
                        {}},
                    sim("mill-4axis", {0, 0, 115, 0}, {.x = 0, .y = 0, .z = 80}),
                    sim("lathe", {70, 40}, {.x = 70, .z = 40}), sim("gantry", {0, 0, 0, 0}, {}),
                    sim("stepper", {0, 0, 0}, {})),
    name_of);

std::unique_ptr<Machine> homed(const std::string& folder) {
  MachineOptions options;
  options.ini = config(folder, folder + ".ini");
  auto m = Machine::start(options);
  if (!m->ready() || !m->power_on_and_home()) {
    ADD_FAILURE() << m->errors();
    return nullptr;
  }
  return m;
}

TEST(SimDetails, TheGantrysSidesGoTogether) {
  MachineOptions options;
  options.ini = config("gantry", "gantry.ini");
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on());
  // Out of square at power-on by the 0.6 mm by which the switches differ; square once homed.
  double worst_skew_mm = 0;
  m->on_cycle([&](const motion::MotionStatus&) {
    worst_skew_mm =
        std::max(worst_skew_mm, std::abs(m->get("motor-1.true-pos") - m->get("motor-2.true-pos")));
  });
  ASSERT_TRUE(m->does({"home", "-1"})) << m->errors();
  EXPECT_NEAR(m->get("motor-1.true-pos") - m->get("motor-2.true-pos"), 0.0, 0.01);
  EXPECT_LT(worst_skew_mm, 3.0);
  std::uint64_t apart = 0, cycles = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.joint[1].pos_cmd != s.joint[2].pos_cmd) ++apart;
    ++cycles;
  });
  ASSERT_TRUE(m->mdi("G0 Y500"));
  EXPECT_GT(cycles, 1000U);
  EXPECT_EQ(apart, 0U);
}

// The motors as their drives have counted them, against what motion commanded half a period before.
TEST(SimDetails, TheSteppersLoseNoStepAndStayWithinOneOfThePath) {
  auto m = homed("stepper");
  ASSERT_NE(m, nullptr);
  struct Motor {
    double last{0}, before{0};
  } motors[3];
  const char* const letters[]{"x", "y", "z"};
  const double steps_per_mm[]{100, 100, 400};
  double worst_steps = 0, worst_following = 0;
  std::uint64_t cycles = 0;
  m->on_cycle([&](const motion::MotionStatus&) {
    ++cycles;
    for (int j = 0; j < 3; ++j) {
      Motor& motor = motors[j];
      const std::string joint = "joint." + std::to_string(j);
      if (cycles > 2) {
        const double steps = m->get(std::string(letters[j]) + "-drive.count");
        worst_steps = std::max(
            worst_steps, std::abs(steps - 0.5 * (motor.last + motor.before) * steps_per_mm[j]));
      }
      worst_following = std::max(worst_following, std::abs(m->get(joint + ".f-error")));
      motor.before = motor.last;
      motor.last = m->get(joint + ".motor-pos-cmd");
    }
  });
  const auto reply = m->run_program(config("stepper", "demo.ngc"));
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
  EXPECT_GT(cycles, 10000U);
  std::printf("result: stepper: motors within %.2f steps of the path, following error %.3f mm\n",
              worst_steps, worst_following);
  EXPECT_LT(worst_steps, 1.0);
  // Half a period at 80 mm/s, and a step.
  EXPECT_LT(worst_following, 0.5e-3 * 80 + 0.01);
  for (int j = 0; j < 3; ++j)
    EXPECT_EQ(m->get(std::string(letters[j]) + "-drive.count"),
              m->get("stepgen." + std::to_string(j) + ".counts"));
}

TEST(SimDetails, TheTableTurnsUnderTheTool) {
  auto m = homed("xyzac-trt");
  ASSERT_NE(m, nullptr);
  ASSERT_TRUE(m->mdi("G21 G90 G64 P0.01 G0 X0 Y42 Z-100 A-30 C0")) << m->errors();
  const double at[3]{m->joint(0), m->joint(1), m->joint(2)};
  // The tilt has moved the slides: the tip stays where it is on the work.
  EXPECT_GT(std::abs(at[1] - 42) + std::abs(at[2] + 100), 10.0);
  double worst_mm = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    for (std::size_t j = 0; j < 3; ++j)
      worst_mm = std::max(worst_mm, std::abs(s.joint[j].pos_cmd - at[j]));
  });
  std::string program = "G90 F1500\n";
  for (int angle = 5; angle <= 360; angle += 5) {
    const double rad = angle * std::numbers::pi / 180;
    char line[80];
    std::snprintf(line, sizeof line, "G1 X%.6f Y%.6f C%d\n", 42 * std::sin(rad), 42 * std::cos(rad),
                  angle);
    program += line;
  }
  const auto reply = m->run_text(program + "M2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
  EXPECT_NEAR(m->joint(4), 360, 1e-6);
  // Only the sagitta of the chords of 5 degrees is left for the slides, and the tolerance.
  EXPECT_LT(worst_mm, 42 * (1 - std::cos(2.5 * std::numbers::pi / 180)) + 0.02);
}

/// The bevel of the demo and the rest of it, with a jerk limit for each joint: it flows around its corners as it does without, and no joint ever passes
/// a limit. The ring's wall is cut with tilt and turn changing all along.
TEST(SimDetails, TheTableIsLimitedInJerkWithoutStandingAtCorners) {
  constexpr double kJerk = 20000;
  std::string wall = "G21 G90 G64 P0.05 F2400\nG0 X40 Y0 Z-100 A-10 C0\n";
  for (int i = 1; i <= 300; ++i) {
    const double s = 0.5 * i;
    char line[100];
    std::snprintf(line, sizeof line, "G1 X%.4f Y%.4f Z%.4f A%.4f C%.4f\n", 40 * std::cos(s / 40),
                  40 * std::sin(s / 40), -100 + 0.5 * std::sin(s / 5), -15 + 5 * std::cos(s / 12),
                  -10 * std::sin(s / 20));
    wall += line;
  }
  const std::string ini = config("xyzac-trt", "xyzac-trt.ini");
  double seconds[2]{};
  for (const bool jerks : {false, true}) {
    MachineOptions options;
    options.ini = ini;
    for (int j = 0; j < 5 && jerks; ++j) {
      const std::string section = "[JOINT_" + std::to_string(j) + "]\n";
      options.replace.push_back(
          {section, section + "MAX_JERK = " + std::to_string(static_cast<int>(kJerk)) + "\n"});
    }
    auto m = Machine::start(options);
    ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
    JointWatch watch(ini, 5, std::vector<double>(5, jerks ? kJerk : 0.0));
    m->on_cycle([&](const motion::MotionStatus& s) { (void)watch.look(s); });
    const auto demo = m->run_program(config("xyzac-trt", "demo.ngc"));
    EXPECT_EQ(demo.state, task::CommandState::done) << demo.text << m->errors();
    const std::uint64_t before = watch.cycles();
    const auto reply = m->run_text(wall + "M2\n");
    EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
    watch.check();
    EXPECT_EQ(m->motion().faults, 0U) << m->errors();
    seconds[jerks ? 1 : 0] = static_cast<double>(watch.cycles() - before) * kDtS;
  }
  std::printf("result: wall on the tilting table: %.2f s, with jerk limits %.2f s\n", seconds[0],
              seconds[1]);
  EXPECT_LT(seconds[1], 1.1 * seconds[0]);
}

TEST(SimDetails, InIdentityTheTableTiltsAlone) {
  auto m = homed("xyzac-trt");
  ASSERT_NE(m, nullptr);
  ASSERT_TRUE(m->mdi("G21 G90 G0 X10 Y20 Z-100 A-20 C0")) << m->errors();
  const double at[3]{m->joint(0), m->joint(1), m->joint(2)};
  EXPECT_TRUE(m->bit("kinstype.is-0"));
  ASSERT_TRUE(m->mdi("M429")) << m->errors();
  EXPECT_TRUE(m->bit("kinstype.is-1"));
  ASSERT_TRUE(m->mdi("G0 A-45")) << m->errors();
  EXPECT_NEAR(m->joint(3), -45, 1e-9);
  ASSERT_TRUE(m->mdi("M428")) << m->errors();
  EXPECT_TRUE(m->bit("kinstype.is-0"));
  for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(m->joint(j), at[j], 1e-9) << "joint " << j;
  // Back in the table's kinematics the tip stands elsewhere on the work.
  EXPECT_GT(std::abs(m->motion().pos_cmd.y - 20), 1.0);
}

TEST(SimDetails, TheLatheKeepsItsSurfaceSpeed) {
  auto m = homed("lathe");
  ASSERT_NE(m, nullptr);
  std::uint64_t cutting = 0, bounded = 0;
  double worst = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.kind != motion::MotionKind::feed || !s.spindle[0].on) return;
    const double radius_mm = s.pos_cmd.x, rpm = m->get("spindle.0.speed-out");
    const double wanted = 150e3 / (2 * std::numbers::pi * std::abs(radius_mm));
    if (wanted >= 2500) {
      if (std::abs(rpm - 2500) < 1e-6) ++bounded;
      return;
    }
    worst = std::max(worst, std::abs(rpm / wanted - 1));
    ++cutting;
  });
  // Facing from 40 mm to the middle.
  const auto reply =
      m->run_text("G21 G18 G90 G7 G96 D2500 S150 M3\nG0 X44 Z0\nG1 X-1 F300\nG0 Z5\nM5\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
  EXPECT_GT(cutting, 1000U);
  EXPECT_GT(bounded, 1000U);
  // The speed is that of the cycle before.
  EXPECT_LT(worst, 0.002);
}

}  // namespace
}  // namespace kerf::harness
