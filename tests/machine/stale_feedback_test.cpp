// A driver that misses cycles: joint.N.fb-stale.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

/// The mill, with a link to the motor of X that keeps its last value while `missed` is true.
std::unique_ptr<Machine> mill_on_a_link() {
  MachineOptions options;
  options.append = "[KERF]\nSTALE_FEEDBACK_CYCLES = 4\nSTALE_FEEDBACK_WINDOW = 100\n";
  options.hal = {"unlinkp joint.0.motor-pos-fb",
                 "loadrt mux2 names=link",
                 "net x-pos-fb link.in0",
                 "net x-read link.out => link.in1 joint.0.motor-pos-fb",
                 "net missed link.sel joint.0.fb-stale",
                 "addf link servo-thread 1"};
  return Machine::start(options);
}

TEST(StaleFeedback, LostPacketsWithinTheBudgetAreNotFelt) {
  auto m = mill_on_a_link();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  int cycle = 0, lost = 0;
  double worst = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    // Two cycles together and two alone in each hundred.
    const int at = ++cycle % 101;
    const bool miss = at == 20 || at == 21 || at == 50 || at == 80;
    EXPECT_TRUE(m->hal(miss ? "sets missed 1" : "sets missed 0"));
    lost += miss ? 1 : 0;
    worst = std::max(worst, std::abs(s.joint[0].ferror));
  });
  const auto reply = m->run_program(KERF_SOURCE_DIR "/nc_files/examples/first_part.ngc");
  m->on_cycle({});
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text;
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  EXPECT_GT(lost, 400);
  EXPECT_NEAR(m->get("joint.0.fb-lost"), lost, 2);
  std::printf(
      "result: first_part.ngc on a link that lost %d packets, 4 of each 100 cycles: no fault, "
      "following error at most %.4f mm\n",
      lost, worst);
}

TEST(StaleFeedback, BeyondTheBudgetItStopsOnThePathAndIsSwitchedOnAgain) {
  auto m = mill_on_a_link();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X0 Y0"));
  const auto run = m->start_program(m->write_program("G1 X80 Y40 F3000\nG1 X0 Y0\nM2\n"));
  m->run_for(1);
  double worst_acc = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.enabled) worst_acc = std::max(worst_acc, std::abs(s.joint[0].acc_cmd));
  });
  ASSERT_TRUE(m->hal("sets missed 1"));
  EXPECT_TRUE(m->run_until([&] { return !m->motion().enabled; }, 1));
  EXPECT_LT(worst_acc, 1001) << "no harder than it can brake";
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 5));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::error);
  for (const char* part :
       {"joint 0", "fb-stale", "4 of 100", "STALE_FEEDBACK_CYCLES", "test.ngc:1:"})
    EXPECT_NE((m->outcome(run).text + m->errors()).find(part), std::string::npos)
        << part << ": " << m->errors();
  m->run_for(0.5);
  EXPECT_NEAR(m->motion().pos_fb.y, m->motion().pos_fb.x / 2, 1.0) << "on the path";
  EXPECT_FALSE(m->power_on()) << "it does not see where X is";
  EXPECT_TRUE(m->bit("joint.0.fb-extrapolated"));
  ASSERT_TRUE(m->hal("sets missed 0"));
  m->run_for(0.01);
  ASSERT_TRUE(m->power_on()) << m->errors();
  EXPECT_TRUE(m->motion().all_homed) << "nothing was moved, nothing is homed again";
  EXPECT_TRUE(m->mdi("G0 X5")) << m->errors();
  EXPECT_NEAR(m->joint(0), 5, 1e-9);
}

}  // namespace
}  // namespace kerf::harness
