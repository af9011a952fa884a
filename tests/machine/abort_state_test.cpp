// What an abort leaves: no spindle that turns before somebody starts it, and a state that is shown, computed with and applied alike.
//
// KERF_COUNT=N machine_test --gtest_filter='AbortLeaves.*' looks at about N blocks, by default 60; of 2000 when N is 500 or more.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

int wanted_cases() {
  const char* given = std::getenv("KERF_COUNT");
  return given != nullptr ? std::max(1, std::atoi(given)) : 60;
}

/// Parts of 20 blocks that save the state, change all of it with the spindle, and restore it.
std::string blocks(bool saves, int parts) {
  std::string text = "G21 G90 G54 G64 P0.05 F6000 S100 M3\n";
  for (int i = 1; i <= parts; ++i) {
    const std::string x = std::to_string(20 + i % 3);
    text += saves ? "M70\n" : "G4 P0\n";
    text.append("S").append(std::to_string(100 + i % 50)).append(i % 2 == 0 ? " M3\n" : " M4\n");
    text += "G55\nG91 G1 X0.1\nX0.1 Y0.1\nM5\nG4 P0.002\nM3\nG90 G54 F4000\n";
    text += saves ? "M72\n" : "S100\n";
    text.append("G1 X").append(x).append("\nY").append(x);
    text.append("\nG2 X").append(x).append(" Y").append(x).append(" I1\n");
    text += saves ? "M73\n" : "G4 P0\n";
    text += "M62 P1\nG1 Z-1\nM63 P1\nZ0\nG61\nG64 P0.05\n";
  }
  return text + "M2\n";
}

void expect_still_spindle(Machine& m, const std::string& where) {
  int turned = 0, cycles = 0;
  m.on_cycle([&](const motion::MotionStatus& s) {
    // The servo cycle in which the abort arrives may still be one of the program.
    if (++cycles > 2 && (s.spindle[0].on || s.spindle[0].speed_rpm != 0)) ++turned;
  });
  EXPECT_EQ(m.abort().state, task::CommandState::done) << where;
  m.run_for(0.1);
  EXPECT_TRUE(m.mdi("G90 G0 X5")) << where << m.errors();
  EXPECT_TRUE(m.mdi("S700")) << where << m.errors();
  EXPECT_EQ(turned, 0) << where << "the spindle turned behind the abort";
  EXPECT_FALSE(m.bit("spindle.0.on")) << where;
  m.on_cycle(nullptr);
  EXPECT_TRUE(m.mdi("M3")) << where << m.errors();
  EXPECT_TRUE(m.bit("spindle.0.on")) << where;
}

TEST(AbortLeaves, NoSpindleThatTurnsBeforeItIsStarted) {
  for (const bool saves : {true, false}) {
    auto m = Machine::start();
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    const std::string text = blocks(saves, std::clamp(wanted_cases() / 5, 10, 100));
    const auto lines = static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    const int every = std::max(1, lines * 2 / wanted_cases());
    const auto run = m->start_program(m->write_program(text));
    int last = 0, cases = 0, failed = 0;
    while (!task::is_terminal(m->outcome(run).state) && failed < 3) {
      m->cycle();
      const int line = m->task().current_line;
      if (line == last || line / every == last / every) continue;
      last = line;
      ++cases;
      const std::string where = "line " + std::to_string(line) + ": ";
      failed += m->branch([&] { expect_still_spindle(*m, where); }) != 0 ? 1 : 0;
    }
    EXPECT_EQ(failed, 0);
    EXPECT_GE(cases, std::min(wanted_cases(), lines) / 4);
    std::printf("[ figures ] spindle behind an abort, %s M70: %d aborts in %d blocks, %d failed\n",
                saves ? "with" : "without", cases, lines, failed);
  }
}

/// A number of the interpreter, by way of an output.
double value_of(Machine& m, const std::string& expression) {
  EXPECT_TRUE(m.mdi("M68 E1 Q[" + expression + "]")) << expression << m.errors();
  return m.motion().analog_out[1];
}

void expect_shown_is_applied(Machine& m, const std::string& where) {
  EXPECT_EQ(m.abort().state, task::CommandState::done) << where;
  m.run_for(0.05);
  const auto t = m.task();
  const auto s = m.motion();
  const double unit = t.program_units == 1 ? 25.4 : 1;
  EXPECT_EQ(t.tool_offset, s.tool_offset) << where;
  EXPECT_EQ(value_of(m, "#5220"), t.g5x_index) << where;
  const int system = 5200 + 20 * t.g5x_index;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto parameter = [&](int number) {
      return value_of(m, "#" + std::to_string(number + axis));
    };
    EXPECT_NEAR(parameter(system + 1), t.g5x_offset[a], 1e-9) << where << axis;
    const bool shifted = value_of(m, "#5210") != 0;
    EXPECT_NEAR(shifted ? parameter(5211) : 0.0, t.g92_offset[a], 1e-9) << where << axis;
    // Where the machine stands, in the coordinates that are shown.
    const double place = s.pos_cmd[a] - t.g5x_offset[a] - t.g92_offset[a] - t.tool_offset[a];
    EXPECT_NEAR(parameter(5420) * unit, place, 1e-9) << where << axis;
  }
  // The codes shown are those computed with.
  const bool incremental =
      std::find(std::begin(t.g_codes), std::end(t.g_codes), 910) != std::end(t.g_codes);
  EXPECT_EQ(value_of(m, "#<_incremental>") != 0, incremental) << where;
  EXPECT_EQ(value_of(m, "#<_imperial>") != 0, t.program_units == 1) << where;
  EXPECT_EQ(value_of(m, "#<_feed>"), t.settings[1]) << where;
  const auto before = m.motion();
  const std::string line = m.line_to_shown_place();
  EXPECT_TRUE(m.mdi(line)) << where << m.errors();
  for (std::size_t j = 0; j < 3; ++j)
    EXPECT_NEAR(m.joint(j), before.joint[j].pos_cmd, 1e-9) << where << line;
}

TEST(AbortLeaves, AStateThatIsShownComputedWithAndApplied) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto run = m->start_program(m->write_program(
      "G21 G90 G54 G64 P0.05 F3000\nG10 L2 P1 X20 Y30 Z-80\nG10 L2 P2 X40 Y10 Z-90\n"
      "G10 L2 P3 X15 Y15 Z-85\n#<n> = 0\no1 while [#<n> LT 6]\n"
      "  T[1 + #<n> MOD 3] M6\n  G43 H[1 + #<n> MOD 3]\n  G0 X5 Y5 Z0\n  G55 G1 X8\n  Y9\n"
      "  G92 X100\n  G1 X103\n  G91 F1500 X1\n  G20 Y0.1\n  G21 G90 G92.1\n  G56 X4\n"
      "  G2 X6 Y6 R2 F2500\n  G49\n  G92 Y-3 Z-50\n  G1 Y-2\n  G92.2\n  G1 X7\n  G92.3\n  G1 Y-1\n"
      "  G92.1 G54\n  #<n> = [#<n> + 1]\no1 endwhile\nM2\n"));
  const int wanted = std::max(wanted_cases(), 200);
  std::mt19937 random(20261123);
  std::uniform_int_distribution<int> gap(1, std::max(2, 2 * 16000 / wanted));
  int cases = 0, failed = 0;
  while (!task::is_terminal(m->outcome(run).state) && failed < 3) {
    for (int n = gap(random); n > 0; --n) m->cycle();
    const std::string where = "line " + std::to_string(m->task().current_line) + " at " +
                              std::to_string(m->now() / rtapi::kMillisecond) + " ms: ";
    if (task::is_terminal(m->outcome(run).state)) break;
    ++cases;
    failed += m->branch([&] { expect_shown_is_applied(*m, where); }) != 0 ? 1 : 0;
  }
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_GE(cases, 100);
  std::printf("[ figures ] state behind an abort: %d random moments, %d failed\n", cases, failed);
}

}  // namespace
}  // namespace kerf::harness
