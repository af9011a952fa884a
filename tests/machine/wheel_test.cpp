// Jog wheels: joint.N.jog-counts, axis.L.jog-counts.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

struct Wheel {
  explicit Wheel(Machine& machine, std::string pins) : m(machine), pins_(std::move(pins)) {
    set("jog-scale", 0.1);
    set("jog-enable", 1);
    m.run_for(0.01);
  }
  void set(const std::string& pin, double value) {
    std::ostringstream line;
    line << "setp " << pins_ << "." << pin << " " << value;
    EXPECT_TRUE(m.hal(line.str())) << line.str();
  }
  void turn(int counts) {
    counts_ += counts;
    EXPECT_TRUE(m.hal("setp " + pins_ + ".jog-counts " + std::to_string(counts_)));
  }
  bool stands() {
    m.run_for(0.01);
    return m.run_until([&] { return !m.motion().jogging; }, 60);
  }
  [[nodiscard]] bool active() const { return m.bit(pins_ + ".wheel-jog-active"); }
  Machine& m;

 private:
  std::string pins_;
  int counts_{0};
};

TEST(Wheel, EachCountIsWorthTheScale) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->does({"teleop", "on"}));
  const double x = m->joint(0);
  Wheel wheel(*m, "axis.x");
  wheel.turn(50);
  m->run_for(0.01);
  EXPECT_TRUE(wheel.active());
  EXPECT_FALSE(m->bit("axis.x.kb-jog-active"));
  wheel.turn(20);
  EXPECT_TRUE(wheel.stands());
  EXPECT_NEAR(m->joint(0), x + 7, 1e-9);
  EXPECT_FALSE(wheel.active());
  wheel.turn(-70);
  EXPECT_TRUE(wheel.stands());
  EXPECT_NEAR(m->joint(0), x, 1e-9);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(Wheel, CountsWhileNotEnabledOrInAnotherModeAreLost) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->does({"teleop", "off"}));
  const double y = m->joint(1);
  Wheel axis(*m, "axis.y"), joint(*m, "joint.1");
  axis.turn(50);
  m->run_for(0.5);
  EXPECT_EQ(m->joint(1), y) << "axes do not jog in joint mode";
  joint.set("jog-enable", 0);
  m->run_for(0.01);
  joint.turn(50);
  m->run_for(0.5);
  joint.set("jog-enable", 1);
  m->run_for(0.5);
  EXPECT_EQ(m->joint(1), y);
  joint.turn(10);
  EXPECT_TRUE(joint.stands());
  EXPECT_NEAR(m->joint(1), y + 1, 1e-9);
}

TEST(Wheel, VelocityModeStopsWithTheWheel) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->does({"teleop", "on"}));
  const double x = m->joint(0);
  Wheel wheel(*m, "axis.x");
  wheel.set("jog-vel-mode", 1);
  wheel.set("jog-scale", 1);
  m->run_for(0.01);
  wheel.turn(200);
  EXPECT_TRUE(wheel.stands());
  // 100 mm/s and 1000 mm/s^2 need 5 mm to stop.
  EXPECT_LT(m->joint(0), x + 5.01);
  EXPECT_GT(m->joint(0), x + 1);
}

TEST(Wheel, LimitsAndInhibitHold) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->does({"teleop", "on"}));
  Wheel wheel(*m, "axis.x");
  wheel.set("jog-scale", 100);
  m->run_for(0.01);
  wheel.turn(1000);
  EXPECT_TRUE(wheel.stands());
  EXPECT_NEAR(m->joint(0), m->get("ini.x.max_limit"), 1e-6);
  ASSERT_TRUE(m->hal("setp motion.jog-inhibit 1"));
  m->run_for(0.01);
  const double there = m->joint(0);
  wheel.turn(-1);
  m->run_for(0.5);
  EXPECT_EQ(m->joint(0), there);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(Wheel, AFractionOfTheAcceleration) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->does({"teleop", "on"}));
  Wheel wheel(*m, "axis.x");
  wheel.set("jog-scale", 20);
  wheel.set("jog-accel-fraction", 0.1);
  m->run_for(0.01);
  double peak = 0;
  m->on_cycle(
      [&](const motion::MotionStatus& s) { peak = std::max(peak, std::abs(s.joint[0].acc_cmd)); });
  wheel.turn(1);
  EXPECT_TRUE(wheel.stands());
  EXPECT_NEAR(peak, 100, 1);
  // The next jog by button has the whole of it.
  peak = 0;
  m->send({"jog", "x", "50", "distance=-10"});
  EXPECT_TRUE(wheel.stands());
  EXPECT_NEAR(peak, 1000, 5);
}

TEST(Wheel, ButtonsGoFirstAndAbortEndsIt) {
  auto m = Machine::start();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->does({"teleop", "on"}));
  Wheel wheel(*m, "axis.x");
  m->send({"jog", "x", "10", "distance=5"});
  m->run_for(0.1);
  const double x = m->get("axis.x.teleop-pos-cmd");
  wheel.turn(100);
  EXPECT_TRUE(wheel.stands());
  EXPECT_NEAR(m->joint(0), x, 1e-9);
  wheel.turn(1000);
  m->run_for(0.2);
  EXPECT_TRUE(wheel.active());
  (void)m->abort();
  EXPECT_TRUE(wheel.stands());
  EXPECT_LT(m->joint(0), x + 50);
}

}  // namespace
}  // namespace kerf::harness
