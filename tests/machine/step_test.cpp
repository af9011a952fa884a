// Single step: one executed block at a time, through subs, loops and waits, in the order of a full run.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

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
const std::vector<Stop> kStops = {{1, 0, 0},   {3, 5, 0},   {4, 6, 0},   {3, 15, 1},  {4, 16, 1},
                                  {3, 25, 2},  {4, 26, 2},  {12, 40, 2}, {16, 40, 2}, {18, 42, 2},
                                  {18, 44, 2}, {20, 44, 2}, {21, 54, 2}};

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

}  // namespace
}  // namespace kerf::harness
