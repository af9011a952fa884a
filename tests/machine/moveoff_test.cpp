// moveoff on a whole machine: while a program is held, its joints are moved aside between motion control and the drives, and come back on
// the way that they went.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

constexpr double kVel = 20, kAcc = 100;  ///< mm/s, mm/s2 of the offsets

MachineOptions with_moveoff() {
  MachineOptions o;
  o.hal = {"loadrt moveoff names=mv personality=3", "addf mv.read-inputs servo-thread 1",
           // Behind the controller and before the motors.
           "addf mv.write-outputs servo-thread 4"};
  struct Joint {
    const char *axis, *n;
  };
  for (const auto& [axis, n] : {Joint{"x", "0"}, Joint{"y", "1"}, Joint{"z", "2"}}) {
    for (std::string line :
         {"unlinkp A-motor.pos-cmd", "unlinkp joint.N.motor-pos-fb", "net A-pos-cmd => mv.pos-N",
          "net A-pos-fb => mv.fb-N", "net A-plus mv.pos-plusoffset-N => A-motor.pos-cmd",
          "net A-minus mv.fb-minusoffset-N => joint.N.motor-pos-fb", "setp mv.offset-vel-N 20",
          "setp mv.offset-accel-N 100"}) {
      line = std::regex_replace(line, std::regex("\\bA\\b"), axis);
      o.hal.push_back(std::regex_replace(line, std::regex("\\bN\\b"), n));
    }
  }
  o.hal.emplace_back("net on motion.motion-enabled => mv.power-on");
  o.hal.emplace_back("setp mv.apply-offsets 1");
  return o;
}

class MoveoffMachine : public testing::Test {
 protected:
  void SetUp() override {
    m_ = Machine::start(with_moveoff());
    ASSERT_TRUE(m_->ready()) << m_->errors();
    ASSERT_TRUE(m_->power_on_and_home()) << m_->errors();
    ASSERT_TRUE(m_->mdi("G0 X10 Y10 Z-20"));
  }
  /// Where the drives are sent.
  [[nodiscard]] std::vector<double> sent() const {
    return {m_->get("x-motor.pos-cmd"), m_->get("y-motor.pos-cmd"), m_->get("z-motor.pos-cmd")};
  }
  void hold_in_the_middle() {
    id_ = m_->start_program(m_->write_program("G1 X60 F1200\nG1 Y30\nM2\n"));
    ASSERT_TRUE(m_->run_until([&] { return m_->joint(0) > 30; }, 10));
    ASSERT_TRUE(m_->does({"pause"}));
    m_->run_for(0.5);
  }
  std::unique_ptr<Machine> m_;
  std::uint64_t id_{0};
};

TEST_F(MoveoffMachine, MovesAsideAndComesBackToThePath) {
  hold_in_the_middle();
  const std::vector<double> held = sent();
  const double x = m_->joint(0);
  double fastest = 0, hardest = 0, last = held[2], last_v = 0;
  m_->on_cycle([&](const motion::MotionStatus&) {
    const double z = m_->get("z-motor.pos-cmd"), v = (z - last) * 1000;
    fastest = std::max(fastest, std::fabs(v));
    hardest = std::max(hardest, std::fabs(v - last_v) * 1000);
    last = z;
    last_v = v;
  });
  ASSERT_TRUE(m_->hal("setp mv.offset-in-2 12"));
  ASSERT_TRUE(m_->hal("setp mv.move-enable 1"));
  m_->run_for(2);
  EXPECT_NEAR(sent()[2], held[2] + 12, 1e-9);
  EXPECT_TRUE(m_->bit("mv.offset-applied"));
  ASSERT_TRUE(m_->hal("setp mv.offset-in-0 -7"));
  m_->run_for(2);
  EXPECT_NEAR(sent()[0], held[0] - 7, 1e-9);
  EXPECT_NEAR(m_->joint(0), x, 1e-12) << "motion control knows nothing of it";
  EXPECT_LE(fastest, kVel * 1.0001);
  EXPECT_LE(hardest, kAcc * 1.01);
  EXPECT_GT(m_->get("mv.waypoint-ct"), 10);
  // Back: first along X, then down.
  double lowest_beside = 1e9;
  m_->on_cycle([&](const motion::MotionStatus&) {
    const std::vector<double> at = sent();
    if (std::fabs(at[0] - held[0]) > 0.1) lowest_beside = std::min(lowest_beside, at[2]);
  });
  ASSERT_TRUE(m_->hal("setp mv.move-enable 0"));
  ASSERT_TRUE(m_->run_until([&] { return !m_->bit("mv.offset-applied"); }, 30));
  m_->run_for(1);
  EXPECT_GT(lowest_beside, held[2] + 11.5) << "it came down somewhere else than it went up";
  for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(sent()[j], held[j], 1e-9);
  ASSERT_TRUE(m_->does({"resume"}));
  ASSERT_TRUE(m_->run_until([&] { return m_->outcome(id_).state == task::CommandState::done; }));
  EXPECT_NEAR(m_->joint(0), 60, 1e-9);
  EXPECT_NEAR(sent()[0] - held[0], 60 - x, 1e-9);
  EXPECT_EQ(m_->motion().faults, 0U) << m_->errors();
}

// Off with the joints aside: the drives stay where they are, and nothing moves when they are switched on again.
TEST_F(MoveoffMachine, OffWhileAsideMovesNothing) {
  hold_in_the_middle();
  ASSERT_TRUE(m_->hal("setp mv.offset-in-2 12"));
  ASSERT_TRUE(m_->hal("setp mv.move-enable 1"));
  m_->run_for(2);
  const std::vector<double> aside = sent();
  ASSERT_TRUE(m_->does({"state", "off"}));
  m_->run_for(0.5);
  for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(sent()[j], aside[j], 1e-9);
  ASSERT_TRUE(m_->does({"state", "on"}));
  m_->run_for(0.5);
  for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(sent()[j], aside[j], 1e-9);
  EXPECT_EQ(m_->motion().faults, 0U) << m_->errors();
}

}  // namespace
}  // namespace kerf::harness
