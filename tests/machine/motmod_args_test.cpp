// loadrt motmod with each of its parameters: the pins they make (motion(9)), with type and direction, and what those do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

std::unique_ptr<Machine> with(const std::string& args,
                              std::vector<std::pair<std::string, std::string>> more = {}) {
  MachineOptions options;
  options.replace = std::move(more);
  options.replace.emplace_back("EMCMOT = motmod", "EMCMOT = motmod " + args);
  return Machine::start(options);
}

struct Expected {
  std::string name, kind;  ///< "" as kind: there must be no such pin
};

void expect_pins(const Machine& m, const std::vector<Expected>& pins) {
  for (const auto& [name, kind] : pins) EXPECT_EQ(m.pin_kind(name), kind) << name;
}

TEST(MotmodArgs, NumbersOfPins) {
  auto m = with("num_dio=6 num_aio=2 num_misc_error=3");
  ASSERT_TRUE(m->ready()) << m->errors();
  expect_pins(*m, {{"motion.digital-in-05", "bit IN"},
                   {"motion.digital-out-05", "bit OUT"},
                   {"motion.digital-in-06", ""},
                   {"motion.analog-in-01", "float IN"},
                   {"motion.analog-out-01", "float OUT"},
                   {"motion.analog-out-02", ""},
                   {"motion.misc-error-00", "bit IN"},
                   {"motion.misc-error-02", "bit IN"},
                   {"motion.misc-error-03", ""}});
}

TEST(MotmodArgs, NamesAndNumbersForTheDirectionWithFewer) {
  auto m = with(
      "names_din=door,level,part names_dout=lamp names_ain=load names_aout=gauge,valve "
      "names_misc_errors=air,oil");
  ASSERT_TRUE(m->ready()) << m->errors();
  expect_pins(*m, {{"motion.din-door", "bit IN"},
                   {"motion.din-level", "bit IN"},
                   {"motion.din-part", "bit IN"},
                   {"motion.digital-in-00", ""},
                   {"motion.dout-lamp", "bit OUT"},
                   {"motion.digital-out-00", "bit OUT"},
                   {"motion.digital-out-01", "bit OUT"},
                   {"motion.digital-out-02", ""},
                   {"motion.ain-load", "float IN"},
                   {"motion.analog-in-00", "float IN"},
                   {"motion.aout-gauge", "float OUT"},
                   {"motion.aout-valve", "float OUT"},
                   {"motion.err-air", "bit IN"},
                   {"motion.err-oil", "bit IN"},
                   {"motion.misc-error-00", ""}});
  // P and E count through the names, then the numbers.
  ASSERT_TRUE(m->power_on_and_home());
  EXPECT_TRUE(m->mdi("M64 P0"));
  EXPECT_TRUE(m->mdi("M64 P2"));
  EXPECT_TRUE(m->mdi("M68 E1 Q2.5"));
  m->run_for(0.01);
  EXPECT_TRUE(m->bit("motion.dout-lamp"));
  EXPECT_FALSE(m->bit("motion.digital-out-00"));
  EXPECT_TRUE(m->bit("motion.digital-out-01"));
  EXPECT_EQ(m->get("motion.aout-valve"), 2.5);
  ASSERT_TRUE(m->hal("setp motion.din-level 1"));
  EXPECT_TRUE(m->mdi("M66 P1 L3 Q1"));
  EXPECT_TRUE(m->mdi("G0 X[7 * #5399]")) << m->errors();
  EXPECT_NEAR(m->joint(0), 7, 1e-9);
}

TEST(MotmodArgs, AnErrorInputTurnsTheMachineOff) {
  for (const char* pin : {"motion.misc-error-01", "motion.err-oil"}) {
    auto m = with(std::string(pin) == "motion.err-oil" ? "names_misc_errors=air,oil"
                                                       : "num_misc_error=2");
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on());
    ASSERT_TRUE(m->hal(std::string("setp ") + pin + " 1"));
    m->run_for(0.1);
    EXPECT_FALSE(m->motion().enabled) << pin;
    EXPECT_EQ(m->command({"state", "on"}).state, task::CommandState::error) << pin;
    // At the very instant of the refusal: no cycle of motion has seen the machine off in between.
    ASSERT_TRUE(m->hal(std::string("setp ") + pin + " 0"));
    EXPECT_TRUE(m->does({"state", "on"})) << pin;
  }
}

TEST(MotmodArgs, UnlockPinsByTheMask) {
  auto m = with("unlock_joints_mask=0x6");
  ASSERT_TRUE(m->ready()) << m->errors();
  expect_pins(*m, {{"joint.0.unlock", ""},
                   {"joint.1.unlock", "bit OUT"},
                   {"joint.1.is-unlocked", "bit IN"},
                   {"joint.2.unlock", "bit OUT"},
                   {"joint.2.is-unlocked", "bit IN"}});
}

TEST(MotmodArgs, PeriodsMakeThreads) {
  auto m = with("base_period_nsec=100000 traj_period_nsec=2000000 base_thread_fp=1 key=111");
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_EQ(m->pin_kind("base-thread.time"), "s32 OUT");
  EXPECT_EQ(m->pin_kind("servo-thread.time"), "s32 OUT");
  EXPECT_EQ(m->parameter_kind("base-thread.tmax"), "s32 RW");
  EXPECT_TRUE(m->power_on_and_home());
}

TEST(MotmodArgs, WrongOnesAreRefusedWithTheReason) {
  const std::pair<const char*, const char*> cases[]{
      {"num_dio=65", "MOTION: num_dio is 65, must be between 1 and 64"},
      {"num_aio=0", "MOTION: num_aio is 0, must be between 1 and 64"},
      {"num_misc_error=65", "MOTION: num_misc_error is 65, must be between 0 and 64"},
      {"num_dio=2 names_din=a", "MOTION: Can't specify both names and number for digital pins"},
      {"num_aio=2 names_aout=a", "MOTION: Can't specify both names and number for analog pins"},
      {"num_extrajoints=1", "MOTION: nonzero num_extrajoints requires KINEMATICS_BOTH"},
      {"unlock_joints_mask=all", "MOTION: unlock_joints_mask=all is not an integer"},
  };
  for (const auto& [args, text] : cases) {
    auto m = with(args);
    EXPECT_FALSE(m->ready()) << args;
    EXPECT_NE(m->errors().find(text), std::string::npos) << args << ": " << m->errors();
  }
}

/// The mill with a fourth joint that no axis moves.
std::unique_ptr<Machine> with_extra_joint() {
  MachineOptions options;
  options.replace = {{"EMCMOT = motmod", "EMCMOT = motmod num_extrajoints=1"},
                     {"coordinates=XYZ\nJOINTS = 3", "coordinates=XYZ kinstype=BOTH\nJOINTS = 4"}};
  options.append =
      "\n[JOINT_3]\nTYPE = LINEAR\nMIN_LIMIT = -1\nMAX_LIMIT = 50\nMAX_VELOCITY = 20\n"
      "MAX_ACCELERATION = 200\nFERROR = 1\nMIN_FERROR = 1\nHOME = 3\nHOME_OFFSET = 3\n"
      "HOME_SEQUENCE = 0\n";
  options.hal = {"loadrt mux2 names=encoder", "addf encoder servo-thread",
                 "net e-cmd joint.3.motor-pos-cmd => encoder.in0",
                 "net e-fb encoder.out => joint.3.motor-pos-fb", "setp joint.3.posthome-cmd 3"};
  return Machine::start(options);
}

TEST(MotmodArgs, AnExtraJointFollowsItsPinOnceItIsHomed) {
  auto m = with_extra_joint();
  ASSERT_TRUE(m->ready()) << m->errors();
  expect_pins(*m, {{"joint.2.posthome-cmd", ""}, {"joint.3.posthome-cmd", "float IN"}});
  ASSERT_TRUE(m->power_on());
  ASSERT_TRUE(m->hal("setp joint.3.posthome-cmd 10"));
  m->run_for(0.5);
  EXPECT_EQ(m->get("joint.3.pos-cmd"), 0) << "before homing the pin is nothing";
  ASSERT_TRUE(m->hal("setp joint.3.posthome-cmd 3"));
  ASSERT_TRUE(m->does({"home", "-1"})) << m->errors();
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  EXPECT_NEAR(m->get("joint.3.pos-cmd"), 3, 1e-9);

  // A pin that jumps: the joint's own velocity and acceleration.
  double at = 3, vel = 0, peak_vel = 0, peak_acc = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    const double now = s.joint[3].pos_cmd, v = (now - at) / 0.001;
    peak_vel = std::max(peak_vel, std::abs(v));
    peak_acc = std::max(peak_acc, std::abs(v - vel) / 0.001);
    at = now;
    vel = v;
  });
  ASSERT_TRUE(m->hal("setp joint.3.posthome-cmd 30"));
  m->run_for(2.0);
  EXPECT_NEAR(at, 30, 1e-9);
  EXPECT_LE(peak_vel, 20 * 1.0001);
  EXPECT_GT(peak_vel, 15);
  EXPECT_LE(peak_acc, 200 * 1.001);
  EXPECT_NEAR(m->get("joint.3.motor-pos-cmd"), at + m->get("joint.3.motor-offset"), 1e-9);
  // Beyond its limits it does not go.
  ASSERT_TRUE(m->hal("setp joint.3.posthome-cmd 1000"));
  m->run_for(3.0);
  EXPECT_NEAR(at, 50, 1e-9);
  // The axes do not care, and it does not care for a feedback that fails.
  EXPECT_TRUE(m->mdi("G0 X10 Y10")) << m->errors();
  ASSERT_TRUE(m->hal("setp encoder.sel 1"));
  ASSERT_TRUE(m->hal("setp joint.3.posthome-cmd 20"));
  m->run_for(3.0);
  EXPECT_NEAR(at, 20, 1e-9);
  EXPECT_TRUE(m->motion().enabled);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(MotmodArgs, AnAbortIsDoneWhileAnExtraJointMoves) {
  auto m = with_extra_joint();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->hal("setp joint.3.posthome-cmd 45"));
  m->run_for(0.3);
  EXPECT_EQ(m->abort().state, task::CommandState::done);
  EXPECT_LT(m->get("joint.3.pos-cmd"), 30) << "it was done before the joint was there";
  EXPECT_TRUE(m->mdi("G0 X5"));
  // A jog of it is refused: it is the pin's.
  ASSERT_TRUE(m->does({"mode", "manual"}));
  ASSERT_TRUE(m->does({"teleop", "off"}));
  m->run_for(3.0);
  (void)m->command({"jog", "3", "5"});
  m->run_for(0.5);
  EXPECT_NEAR(m->get("joint.3.pos-cmd"), 45, 1e-9);
}

}  // namespace
}  // namespace kerf::harness
