// Single step: one executed block at a time, through subs, loops and waits, in the order of a full run.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

constexpr const char* kNested =
    "G21 G90 G64 P0.5 Q0 F1200\n"       // 1
    "o<leg> sub\n"                      // 2
    "  G1 X[#1+5] Y[#2]\n"              // 3
    "  G1 X[#1+6]\n"                    // 4
    "o<leg> endsub\n"                   // 5
    "#<n> = 0\n"                        // 6
    "o100 while [#<n> LT 3]\n"          // 7
    "  o<leg> call [#<n>*10] [#<n>]\n"  // 8
    "  #<n> = [#<n>+1]\n"               // 9
    "o100 endwhile\n"                   // 10
    "o200 if [#<n> EQ 3]\n"             // 11
    "  G1 X40\n"                        // 12
    "o200 else\n"                       // 13
    "  G1 X99\n"                        // 14
    "o200 endif\n"                      // 15
    "M66 P0 L0\n"                       // 16
    "o300 repeat [2 + #5399]\n"         // 17
    "  G91 G1 X2\n"                     // 18
    "o300 endrepeat\n"                  // 19
    "M64 P1\n"                          // 20
    "G90 G2 X54 I5 J0\n"                // 21
    "M2\n";                             // 22

struct Stop {
  int line;
  double x, y;
};
/// Where a block of kNested ends, each as often as it runs. Lines without a place: 1, 16, 20.
constexpr std::array<Stop, 13> kStops{{{1, 0, 0},
                                       {3, 5, 0},
                                       {4, 6, 0},
                                       {3, 15, 1},
                                       {4, 16, 1},
                                       {3, 25, 2},
                                       {4, 26, 2},
                                       {12, 40, 2},
                                       {16, 40, 2},
                                       {18, 42, 2},
                                       {18, 44, 2},
                                       {20, 44, 2},
                                       {21, 54, 2}}};

std::unique_ptr<Machine> machine() {
  auto m = Machine::start();
  EXPECT_TRUE(m->ready()) << m->errors();
  EXPECT_TRUE(m->power_on_and_home()) << m->errors();
  return m;
}

bool stands_stepped(Machine& m) {
  return m.task().interp_state == task::InterpState::paused && m.motion().vel_mm_s == 0;
}

TEST(Step, EachBlockOfSubsLoopsAndWaitsOnceAndToItsExactEnd) {
  auto m = machine();
  ASSERT_TRUE(m->does({"open", m->write_program(kNested)})) << m->errors();
  for (std::size_t n = 0; n < kStops.size(); ++n) {
    const Stop& stop = kStops[n];
    ASSERT_TRUE(m->does({"step"})) << m->errors();
    ASSERT_TRUE(m->run_until([&] { return stands_stepped(*m); }, 30)) << "step " << n;
    EXPECT_EQ(m->task().current_line, stop.line) << "step " << n;
    EXPECT_EQ(m->task().single_step, 1);
    EXPECT_FALSE(m->task().waiting_for.object.empty()) << "step " << n;
    EXPECT_NEAR(m->joint(0), stop.x, 1e-9) << "step " << n;
    EXPECT_NEAR(m->joint(1), stop.y, 1e-9) << "step " << n;
    EXPECT_EQ(m->bit("motion.digital-out-01"), n >= 11) << "step " << n;
    // It stands until the next step.
    m->run_for(0.3);
    EXPECT_NEAR(m->joint(0), stop.x, 1e-9) << "step " << n;
    EXPECT_FALSE(m->task().idle);
  }
  ASSERT_TRUE(m->does({"step"})) << m->errors();
  EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 10));
  EXPECT_EQ(m->task().programs_ended, 1U);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

/// [KERF]SINGLE_STEP = moves: blocks that move nothing are no steps, also when they stand in the queue of a held program.
TEST(Step, ByMovesAlone) {
  MachineOptions options;
  options.append = "[KERF]\nSINGLE_STEP = moves\n";
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto path = m->write_program(
      "M64 P0\nG21 G61\nG1 X10 F3000\nM65 P0\nG4 P0.05\nF2000\no1 repeat [2]\nM64 P1\n#1=3\nG91 G1 "
      "X2\nG90\no1 endrepeat\nG2 X14 Y0 J3\nM62 P0\nM0\nG1 X20\nM65 P1\nM2\n");
  // Line and X at the end of each; line 13 is a whole circle, line 15 M0.
  const std::vector<std::pair<int, double>> stops{{3, 10},  {10, 12}, {10, 14},
                                                  {13, 14}, {15, 14}, {16, 20}};
  const auto steps = [&] {
    for (std::size_t n = 0; n < stops.size(); ++n) {
      ASSERT_TRUE(m->does({"step"})) << m->errors();
      m->run_for(0.05);
      ASSERT_TRUE(m->run_until([&] { return stands_stepped(*m); }, 30)) << n;
      // A block that asks nothing of motion is done with the one before it.
      EXPECT_EQ(m->motion().current.line, stops[n].first) << n;
      EXPECT_NEAR(m->joint(0), stops[n].second, 1e-9) << n;
    }
    ASSERT_TRUE(m->does({"step"})) << m->errors();
    EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 10));
    EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  };
  EXPECT_EQ(m->branch([&] {
    ASSERT_TRUE(m->does({"open", path})) << m->errors();
    steps();
  }),
            0);
  ASSERT_TRUE(m->does({"mode", "auto"}));
  m->start_program(path);
  ASSERT_TRUE(m->run_until([&] { return m->joint(0) > 5; }, 30));
  ASSERT_TRUE(m->does({"pause"}) && m->run_until([&] { return m->motion().held; }, 5));
  steps();
}

/// Paused in the middle, the queue is full of blocks that blend into each other: no step skips one or stops twice in one.
TEST(Step, AfterAPauseItGoesOnBlockByBlockAndNoneIsLost) {
  auto m = machine();
  const auto path = m->write_program(kNested);
  for (const double pause_at : {1.0, 5.8, 12.0, 25.5, 33.0, 43.0}) {
    EXPECT_EQ(m->branch([&] {
      const auto run = m->start_program(path);
      ASSERT_TRUE(m->run_until([&] { return m->joint(0) > pause_at; }, 30));
      ASSERT_TRUE(m->does({"pause"}) && m->run_until([&] { return m->motion().held; }, 5));
      // The block in execution is the first.
      std::size_t next = 0;
      while (next < kStops.size() &&
             (kStops[next].line != m->task().current_line || kStops[next].x < m->joint(0) - 1e-6))
        ++next;
      ASSERT_LT(next, kStops.size()) << m->joint(0);
      for (; next < kStops.size(); ++next) {
        ASSERT_TRUE(m->does({"step"})) << m->errors();
        m->run_for(0.05);
        ASSERT_TRUE(m->run_until([&] { return stands_stepped(*m); }, 30)) << next;
        EXPECT_EQ(m->task().current_line, kStops[next].line) << next;
        // In a blend the path is kept, so the end of a block is the middle of its corner.
        EXPECT_NEAR(m->joint(0), kStops[next].x, 0.51) << next;
        EXPECT_NEAR(m->joint(1), kStops[next].y, 0.51) << next;
      }
      ASSERT_TRUE(m->does({"step"})) << m->errors();
      EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 10));
      EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
      EXPECT_NEAR(m->joint(0), 54, 1e-9);
    }),
              0)
        << "paused at " << pause_at;
  }
}

/// Steps through the lines X1, X2 ... of a program that is paused at X10, each once and to its own end.
void steps_through_lines(const std::string& words, int lines, double length) {
  auto m = machine();
  std::string text = "G21 G90 " + words + "\n";
  char line[40];
  for (int n = 1; n <= lines; ++n) {
    std::snprintf(line, sizeof line, "G1 X%.3f\n", n * length);
    text += line;
  }
  const auto run = m->start_program(m->write_program(text + "M2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->joint(0) > 10; }, 30));
  ASSERT_TRUE(m->does({"pause"}) && m->run_until([&] { return m->motion().held; }, 5));
  m->run_for(0.05);  // task shows it some cycles later
  // The block in execution is the first.
  int next = m->task().current_line - 1;
  EXPECT_NEAR(m->joint(0), (next - 0.5) * length, length / 2 + 1e-9);
  for (; next <= lines; ++next) {
    ASSERT_TRUE(m->does({"step"})) << m->errors();
    m->run_for(0.02);
    ASSERT_TRUE(m->run_until(
        [&] { return stands_stepped(*m) || task::is_terminal(m->outcome(run).state); }, 30));
    ASSERT_EQ(m->task().current_line, next + 1);
    ASSERT_NEAR(m->joint(0), next * length, 1e-7) << "line " << next + 1;
    EXPECT_EQ(m->motion().distance_to_go, 0) << "line " << next + 1;
  }
  ASSERT_TRUE(m->does({"step"})) << m->errors();
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 10));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

/// Of lines that G64 Q had joined before the pause each is a step all the same.
TEST(Step, LinesThatWereJoinedBeforeThePauseAreAStepEach) {
  steps_through_lines("G64 P0.5 Q0.1 F1200", 60, 1);
}

TEST(Step, LinesOfADenseStreamAreAStepEach) {
  steps_through_lines("G64 P0.05 Q0 F3000", 200, 0.1);
  steps_through_lines("G64 P0.05 F3000", 200, 0.1);
}

/// The lines of one thread are one step, whether the operator steps from the start or pauses before it.
TEST(Step, AThreadOfSeveralBlocksIsOneStep) {
  MachineOptions lathe;
  lathe.ini = std::string(KERF_SOURCE_DIR) + "/configs/sim/lathe/lathe.ini";
  auto m = Machine::start(lathe);
  ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G21 G90 G18 G0 X20 Z5")) << m->errors();
  const auto path = m->write_program(
      "G64 P0.1 F1200\n"        // 1
      "M3 S600\n"               // 2
      "G1 X21\n"                // 3
      "G33 Z-10 K1\n"           // 4
      "G33 Z-14 X22 K1\n"       // 5
      "(in the same groove)\n"  // 6
      "G33 Z-20 X22 K1\n"       // 7
      "G1 X25\n"                // 8
      "M5\n"                    // 9
      "M2\n");
  ASSERT_TRUE(m->does({"open", path})) << m->errors();
  struct Place {
    int line;
    double x, z;
  };
  for (const Place& place :
       {Place{1, 20, 5}, {2, 20, 5}, {3, 21, 5}, {7, 22, -20}, {8, 25, -20}, {9, 25, -20}}) {
    ASSERT_TRUE(m->does({"step"})) << m->errors();
    ASSERT_TRUE(m->run_until([&] { return stands_stepped(*m); }, 60)) << "line " << place.line;
    EXPECT_EQ(m->task().current_line, place.line);
    EXPECT_NEAR(m->motion().pos_cmd.x, place.x, 1e-6) << "line " << place.line;
    EXPECT_NEAR(m->motion().pos_cmd.z, place.z, 1e-6) << "line " << place.line;
  }
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

/// Steps and resumes in turn end where a full run ends, with each output once.
TEST(Step, ResumeBetweenStepsRunsOn) {
  auto m = machine();
  ASSERT_TRUE(m->does({"open", m->write_program(kNested)})) << m->errors();
  for (int n = 0; n < 4; ++n) {
    ASSERT_TRUE(m->does({"step"}));
    ASSERT_TRUE(m->run_until([&] { return stands_stepped(*m); }, 30));
  }
  ASSERT_TRUE(m->does({"resume"}));
  ASSERT_TRUE(m->run_until([&] { return m->joint(0) > 20; }, 30));
  ASSERT_TRUE(m->does({"pause"}));
  m->run_for(1);
  ASSERT_TRUE(m->does({"step"}));
  ASSERT_TRUE(m->run_until([&] { return stands_stepped(*m); }, 30));
  EXPECT_EQ(m->task().current_line, 3);
  ASSERT_TRUE(m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 60));
  EXPECT_NEAR(m->joint(0), 54, 1e-9);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

/// The line shown is that of the block which the axes execute, however deep in calls, and the source is its file.
TEST(Line, IsThatOfTheBlockInExecutionFourCallsDeep) {
  auto m = machine();
  const auto path = m->write_program(
      "o<d> sub\n  G1 X[#1]\no<d> endsub\n"                       // 2: level 4
      "o<c> sub\n  o<d> call [#1+1]\n  G1 Y[#1]\no<c> endsub\n"   // 6: level 3
      "o<b> sub\n  o<c> call [#1+1]\n  G1 Z-[#1]\no<b> endsub\n"  // 10: level 2
      "o<a> sub\n  o<b> call [#1+1]\n  G1 X0\no<a> endsub\n"      // 14: level 1
      "G21 G90 G61 F1200\no<a> call [2]\nG1 Y0\nM2\n");           // 18: level 0
  struct Oracle {
    std::size_t axis;
    double sign;
    int line, level;
  };
  constexpr Oracle kOracle[]{
      {0, 1, 2, 4}, {1, 1, 6, 3}, {2, -1, 10, 2}, {0, -1, 14, 1}, {1, -1, 18, 0}};
  int cycles = 0, at[5]{}, shown[5]{};
  const auto run = m->start_program(path);
  while (!task::is_terminal(m->outcome(run).state) && ++cycles < 20000) {
    m->cycle();
    const auto s = m->motion();
    for (std::size_t n = 0; n < 5; ++n) {
      const Oracle& o = kOracle[n];
      if (s.joint[o.axis].vel_cmd * o.sign < 0.1) continue;
      ++at[n];
      EXPECT_EQ(s.current.line, o.line) << "cycle " << cycles;
      EXPECT_EQ(s.current.call_level, o.level) << "cycle " << cycles;
      // Task follows within a few cycles.
      if (at[n] < 5) continue;
      ++shown[n];
      EXPECT_EQ(m->task().current_line, o.line) << "cycle " << cycles;
      EXPECT_EQ(m->task().source.view(), path) << "cycle " << cycles;
    }
  }
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  for (std::size_t n = 0; n < 5; ++n) EXPECT_GT(shown[n], 50) << "line " << kOracle[n].line;
}

}  // namespace
}  // namespace kerf::harness
