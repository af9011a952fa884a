// External offsets on a whole machine: the pins axis.L.eoffset-* and [AXIS_L]OFFSET_AV_RATIO.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

MachineOptions with_offsets() {
  MachineOptions options;
  options.replace = {{"[AXIS_Z]\n", "[AXIS_Z]\nOFFSET_AV_RATIO = 0.2\n"}};
  options.hal = {"setp axis.z.eoffset-enable 1", "setp axis.z.eoffset-scale 0.001"};
  return options;
}

struct Watch {
  explicit Watch(Machine& m) {
    m.on_cycle([this](const motion::MotionStatus& s) {
      const motion::JointStatus& z = s.joint[2];
      vel = std::max(vel, std::abs(z.vel_cmd));
      acc = std::max(acc, std::abs(z.acc_cmd));
    });
  }
  double vel{0}, acc{0};
};

TEST(ExternalOffsetPins, AddToTheAxisBesideTheProgram) {
  auto m = Machine::start(with_offsets());
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X10 Y10 Z-20"));
  m->run_for(0.05);
  Watch watch(*m);
  EXPECT_FALSE(m->bit("motion.eoffset-active"));
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts 1500"));
  m->run_for(2);
  EXPECT_NEAR(m->get("axis.z.eoffset-request"), 1.5, 1e-9);
  EXPECT_NEAR(m->get("axis.z.eoffset"), 1.5, 1e-9);
  EXPECT_TRUE(m->bit("motion.eoffset-active"));
  EXPECT_NEAR(m->get("axis.z.pos-cmd"), -20, 1e-9) << "reported apart from the offset";
  EXPECT_NEAR(m->joint(2), -18.5, 1e-9);
  EXPECT_GT(watch.vel, 0);
  EXPECT_LE(watch.vel, 0.2 * m->get("ini.z.max_velocity") + 1e-6);
  EXPECT_LE(watch.acc, 0.2 * m->get("ini.z.max_acceleration") * 1.001);
  // Programs go on from where they are, without the offset.
  const auto reply = m->run_text("G91 G1 X5 Z1 F600\nG90 G1 Z-25\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->get("axis.z.pos-cmd"), -25, 1e-9);
  EXPECT_NEAR(m->joint(2), -23.5, 1e-9);
  // M2 leaves it; an abort too.
  m->abort();
  m->run_for(0.5);
  EXPECT_NEAR(m->joint(2), -23.5, 1e-9);
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-clear 1"));
  m->run_for(2);
  EXPECT_NEAR(m->joint(2), -25, 1e-9);
  EXPECT_FALSE(m->bit("motion.eoffset-active"));
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(ExternalOffsetPins, OffAndOnForgetsThemWithoutMoving) {
  auto m = Machine::start(with_offsets());
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 Z-20"));
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts 1500"));
  m->run_for(2);
  ASSERT_TRUE(m->does({"state", "off"}));
  m->run_for(0.1);
  EXPECT_NEAR(m->joint(2), -18.5, 1e-9);
  ASSERT_TRUE(m->power_on());
  m->run_for(0.1);
  EXPECT_EQ(m->get("axis.z.eoffset"), 0);
  EXPECT_EQ(m->get("axis.z.eoffset-request"), 0);
  EXPECT_NEAR(m->joint(2), -18.5, 1e-9);
  // The interpreter knows where it is.
  ASSERT_TRUE(m->mdi("G91 G0 Z-1"));
  EXPECT_NEAR(m->joint(2), -19.5, 1e-9);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(ExternalOffsetPins, AtTheSoftLimitTheyAreLimited) {
  auto m = Machine::start(with_offsets());
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 Z-5"));
  const double most = m->get("ini.z.max_limit");
  m->on_cycle([&](const motion::MotionStatus& s) { EXPECT_LE(s.joint[2].pos_cmd, most + 1e-6); });
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts 50000"));
  m->run_for(10);
  EXPECT_NEAR(m->joint(2), most, 1e-5);
  EXPECT_TRUE(m->bit("motion.eoffset-limited"));
  EXPECT_NEAR(m->get("axis.z.eoffset-request"), 50, 1e-9);
  ASSERT_TRUE(m->mdi("G1 Z-1 F3000")) << m->errors();
  EXPECT_NEAR(m->get("axis.z.pos-cmd"), -1, 1e-9);
  ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts 0"));
  m->run_for(5);
  EXPECT_FALSE(m->bit("motion.eoffset-limited"));
  EXPECT_NEAR(m->joint(2), -1, 1e-5);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

/// A sine on the counts while a program runs, as LinuxCNC's dynamic_offsets does.
TEST(ExternalOffsetPins, FollowAWaveUnderAProgram) {
  auto m = Machine::start(with_offsets());
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  const auto program = m->start_program(
      m->write_program("G0 Z-20\nG1 X50 Y20 F1500\nG2 X20 Y20 I-15 J0\nG1 X0\nM2\n"));
  double low = 1e9, high = -1e9;
  for (int i = 0; i < 2000 && !task::is_terminal(m->outcome(program).state); ++i) {
    const int counts = static_cast<int>(std::lround(800 * std::sin(0.05 * i)));
    ASSERT_TRUE(m->hal("setp axis.z.eoffset-counts " + std::to_string(counts)));
    m->run_for(0.02);
    low = std::min(low, m->get("axis.z.eoffset"));
    high = std::max(high, m->get("axis.z.eoffset"));
  }
  EXPECT_EQ(m->outcome(program).state, task::CommandState::done) << m->errors();
  EXPECT_LT(low, -0.7);
  EXPECT_GT(high, 0.7);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

}  // namespace
}  // namespace kerf::harness
