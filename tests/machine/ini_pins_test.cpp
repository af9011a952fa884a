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
