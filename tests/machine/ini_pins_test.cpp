// ini.* pins of a whole machine: limits that change while it runs.
#include <gtest/gtest.h>

#include <cmath>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

/// The highest speed of joint 0 in a rapid to `x`.
double peak_speed(Machine& m, double x) {
  double last = m.joint(0), peak = 0;
  m.on_cycle([&](const motion::MotionStatus& s) {
    peak = std::max(peak, std::abs(s.joint[0].pos_cmd - last) / 0.001);
    last = s.joint[0].pos_cmd;
  });
  EXPECT_TRUE(m.mdi("G0 X" + std::to_string(x))) << m.errors();
  m.on_cycle({});
  return peak;
}

TEST(IniPins, ShowTheIniFile) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_EQ(m->get("ini.0.max_velocity"), 100);
  EXPECT_EQ(m->get("ini.2.max_acceleration"), 600);
  EXPECT_EQ(m->get("ini.z.max_velocity"), 60);
  EXPECT_EQ(m->get("ini.a.max_velocity"), 0);
}

TEST(IniPins, ANewVelocityHoldsFromTheNextCommandOn) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_NEAR(peak_speed(*m, 50), 100, 0.1);
  ASSERT_TRUE(m->hal("setp ini.0.max_velocity 20"));
  m->run_for(0.05);
  EXPECT_NEAR(peak_speed(*m, 0), 20, 0.01);
  ASSERT_TRUE(m->hal("setp ini.0.max_velocity 80"));
  m->run_for(0.05);
  EXPECT_NEAR(peak_speed(*m, 50), 80, 0.1);
  ASSERT_TRUE(m->hal("setp ini.x.max_velocity 30"));
  m->run_for(0.05);
  EXPECT_NEAR(peak_speed(*m, 0), 30, 0.01);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(IniPins, AMoveUnderWayKeepsTheLimitsItWasPlannedWith) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto program = m->start_program(m->write_program("G0 X50\nG0 X0\nG0 X50\nM2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->joint(0) > 20; }, 10));
  ASSERT_TRUE(m->hal("setp ini.0.max_velocity 10"));
  ASSERT_TRUE(m->hal("setp ini.0.max_acceleration 50"));
  ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(program).state); }, 60));
  EXPECT_EQ(m->outcome(program).state, task::CommandState::done) << m->errors();
  m->run_for(0.05);
  EXPECT_NEAR(peak_speed(*m, 40), 10, 0.01);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

/// A change at any moment of moves that follow each other: no limit is ever broken, and all arrive.
TEST(IniPins, ChangesAtAnyCycleBreakNoLimit) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto program = m->start_program(m->write_program("G0 X1\nG4 P0\nG0 X0\nG4 P0\nM2\n"));
  for (int cycle = 0; cycle < 400; ++cycle) {
    m->cycle();
    if (cycle % 20 != 0) continue;
    const int failed = m->branch([&] {
      ASSERT_TRUE(m->hal("setp ini.0.max_velocity 5"));
      ASSERT_TRUE(m->hal("setp ini.0.max_acceleration 20"));
      m->run_for(0.03);
      ASSERT_TRUE(m->hal("setp ini.0.max_velocity 60"));
      ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(program).state); }, 60));
      EXPECT_EQ(m->outcome(program).state, task::CommandState::done) << m->errors();
      EXPECT_TRUE(m->mdi("G0 X3"));
      EXPECT_EQ(m->motion().faults, 0U) << m->errors();
      EXPECT_NEAR(m->joint(0), 3, 1e-9);
    });
    EXPECT_EQ(failed, 0) << "changed in cycle " << cycle;
  }
}

TEST(IniPins, FollowingErrorActsAtOnce) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->hal("setp ini.0.ferror 0.25"));
  ASSERT_TRUE(m->hal("setp ini.0.min_ferror 0.25"));
  m->run_for(0.05);
  EXPECT_NEAR(m->get("joint.0.f-error-lim"), 0.25, 1e-12);
  m->send({"mdi", "G1 F60 X50"});
  m->run_for(1);
  ASSERT_TRUE(m->hal("setp ini.0.ferror 0.5"));
  ASSERT_TRUE(m->hal("setp ini.0.min_ferror 0.5"));
  m->run_for(0.05);
  EXPECT_NEAR(m->get("joint.0.f-error-lim"), 0.5, 1e-12) << "while the path runs";
}

TEST(IniPins, ALimitBehindTheMachineLeavesOnlyTheWayBack) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X40"));
  ASSERT_TRUE(m->hal("setp ini.0.max_limit 30"));
  ASSERT_TRUE(m->hal("setp ini.x.max_limit 30"));
  m->run_for(0.05);
  EXPECT_NE(m->errors().find("joint 0 stands at 40, beyond ini.0.max_limit = 30"),
            std::string::npos)
      << m->errors();
  EXPECT_NEAR(m->joint(0), 40, 1e-9) << "it moved by itself";
  EXPECT_TRUE(m->bit("motion.on-soft-limit"));
  EXPECT_NE(m->command({"mdi", "G0 X45"}).state, task::CommandState::done);
  EXPECT_NEAR(m->joint(0), 40, 1e-9);
  EXPECT_TRUE(m->mdi("G0 X25"));
  EXPECT_NE(m->command({"mdi", "G0 X35"}).state, task::CommandState::done);
}

TEST(IniPins, HomePositionsOfTheNextHoming) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->hal("setp ini.0.home 7"));
  m->run_for(0.05);
  ASSERT_TRUE(m->does({"teleop", "off"}));
  ASSERT_TRUE(m->does({"home", "0"}));
  EXPECT_NEAR(m->joint(0), 7, 1e-6) << m->errors();
}

/// Largest jerk of joint 0 by third differences of its pin, in a rapid to `x`.
double peak_jerk(Machine& m, double x) {
  double p[4]{}, peak = 0;
  int seen = 0;
  m.on_cycle([&](const motion::MotionStatus& s) {
    for (int i = 3; i > 0; --i) p[i] = p[i - 1];
    p[0] = s.joint[0].pos_cmd;
    if (++seen > 3) peak = std::max(peak, std::abs(p[0] - 3 * p[1] + 3 * p[2] - p[3]) / 1e-9);
  });
  EXPECT_TRUE(m.mdi("G0 X" + std::to_string(x))) << m.errors();
  m.run_for(0.01);
  m.on_cycle({});
  return peak;
}

TEST(IniPins, JerkLimitsOfTheIniFileAndOfItsPins) {
  constexpr double kRounding = 20;
  MachineOptions options;
  options.replace = {{"[JOINT_0]\n", "[JOINT_0]\nMAX_JERK = 20000\n"}};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_EQ(m->get("ini.0.max_jerk"), 20000);
  EXPECT_EQ(m->get("ini.traj_planner_type"), 1);
  EXPECT_NEAR(peak_jerk(*m, 50), 20000, kRounding);
  ASSERT_TRUE(m->hal("setp ini.0.max_jerk 5000"));
  m->run_for(0.05);
  EXPECT_NEAR(peak_jerk(*m, 0), 5000, kRounding);
  ASSERT_TRUE(m->hal("setp ini.traj_max_jerk 3000"));
  m->run_for(0.05);
  EXPECT_NEAR(peak_jerk(*m, 50), 3000, kRounding) << "along the path";
  ASSERT_TRUE(m->hal("setp ini.traj_planner_type 0"));
  m->run_for(0.05);
  EXPECT_GT(peak_jerk(*m, 0), 1e5) << "acceleration only";
  ASSERT_TRUE(m->hal("setp ini.traj_planner_type 1"));
  m->run_for(0.05);
  EXPECT_NEAR(peak_jerk(*m, 50), 3000, kRounding);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(IniPins, MaxLinearJerkCountsForJointsWithoutOne) {
  MachineOptions options;
  options.replace = {{"[TRAJ]\n", "[TRAJ]\nMAX_LINEAR_JERK = 8000\n"}};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_EQ(m->get("ini.traj_max_jerk"), 8000);
  EXPECT_EQ(m->get("ini.2.max_jerk"), 8000);
  EXPECT_NEAR(peak_jerk(*m, 50), 8000, 20);
}

TEST(IniPins, PlannerType0SwitchesThemOffAnd1OnAgain) {
  MachineOptions options;
  options.replace = {{"[TRAJ]\n", "[TRAJ]\nMAX_LINEAR_JERK = 8000\nPLANNER_TYPE = 0\n"}};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_EQ(m->get("ini.traj_planner_type"), 0);
  EXPECT_EQ(m->get("ini.0.max_jerk"), 8000);
  EXPECT_GT(peak_jerk(*m, 50), 1e5);
  // While they are off, a new one waits.
  ASSERT_TRUE(m->hal("setp ini.x.max_jerk 4000"));
  m->run_for(0.05);
  EXPECT_GT(peak_jerk(*m, 0), 1e5);
  ASSERT_TRUE(m->hal("setp ini.traj_planner_type 1"));
  m->run_for(0.05);
  EXPECT_NEAR(peak_jerk(*m, 50), 4000, 20);
  ASSERT_TRUE(m->mdi("G0 X0"));
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

/// G5 is driven as one curve, also with jerk limits and G61: it never stands within.
TEST(Curves, SplinesAreDrivenWithoutStopsWithinJerkLimits) {
  MachineOptions options;
  options.replace = {{"[TRAJ]\n", "[TRAJ]\nMAX_LINEAR_JERK = 20000\n"}};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X10 Y10"));
  double p[3][4]{}, peak = 0, least = 1e9;
  int seen = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    ++seen;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t i = 3; i > 0; --i) p[j][i] = p[j][i - 1];
      p[j][0] = s.joint[j].pos_cmd;
      if (seen > 3)
        peak = std::max(peak, std::abs(p[j][0] - 3 * p[j][1] + 3 * p[j][2] - p[j][3]) / 1e-9);
    }
    if (s.pos_cmd.x > 15 && s.pos_cmd.x < 85) least = std::min(least, s.vel_mm_s);
  });
  const auto reply = m->run_text("G61 G17 F1200\nG5 I20 J0 P-20 Q0 X90 Y40\nG64 P0.02\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 90, 1e-9);
  EXPECT_NEAR(m->joint(1), 40, 1e-9);
  EXPECT_LE(peak, 20000 * 1.01);
  EXPECT_GT(least, 19) << "slowed down within the curve";
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(IniPins, BadValuesAreToldToTheOperator) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->hal("setp ini.0.max_velocity -5"));
  m->run_for(0.05);
  EXPECT_NE(m->errors().find("ini.0.max_velocity = -5: expected a number above 0"),
            std::string::npos)
      << m->errors();
  EXPECT_NEAR(peak_speed(*m, 30), 100, 0.5);
}

}  // namespace
}  // namespace kerf::harness
