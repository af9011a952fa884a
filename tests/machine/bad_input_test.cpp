// Bad input gives one clear message with its place and the nearest valid name, and harms nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::unique_ptr<Machine> refused(const MachineOptions& options) {
  auto m = Machine::start(options);
  EXPECT_FALSE(m->ready()) << "it started";
  return m;
}

TEST(BadInput, MissingIniKeyNamesFileAndKey) {
  MachineOptions options;
  options.replace = {{"MAX_VELOCITY = 100", "MAX_VELOCTIY = 100"}};  // of AXIS_X, the first
  auto m = Machine::start(options);
  EXPECT_THAT(m->errors(),
              AllOf(HasSubstr("mill.ini:"), HasSubstr("MAX_VELOCITY"), HasSubstr("MAX_VELOCTIY")));
}

TEST(BadInput, ValueOutOfRangeNamesLineUnitAndRange) {
  MachineOptions options;
  options.replace = {{"MAX_ACCELERATION = 1000", "MAX_ACCELERATION = -3"}};
  auto m = refused(options);
  EXPECT_THAT(m->errors(),
              AllOf(HasSubstr("mill.ini:"), HasSubstr("MAX_ACCELERATION"), HasSubstr("-3")));
}

TEST(BadInput, UnknownComponent) {
  MachineOptions options;
  options.hal = {"loadrt ad2"};
  auto m = refused(options);
  EXPECT_THAT(m->errors(), AllOf(HasSubstr("ad2"), HasSubstr("and2")));
}

TEST(BadInput, UnknownLoadrtParameter) {
  MachineOptions options;
  options.hal = {"loadrt siggen num_chans=2"};
  EXPECT_THAT(refused(options)->errors(), AllOf(HasSubstr("num_chans"), HasSubstr("num_chan'")));
}

TEST(BadInput, UnknownPinNamesTheNearest) {
  MachineOptions options;
  options.hal = {"net a motion.in-postion"};
  EXPECT_THAT(refused(options)->errors(),
              AllOf(HasSubstr("motion.in-postion"), HasSubstr("motion.in-position")));
}

TEST(BadInput, TypeMismatchInNetNamesBothTypes) {
  MachineOptions options;
  options.hal = {"net mixed spindle.0.speed-out motion.digital-in-00"};
  auto m = refused(options);
  EXPECT_THAT(m->errors(),
              AllOf(HasSubstr("motion.digital-in-00"), HasSubstr("bit"), HasSubstr("float")));
}

TEST(BadInput, SecondWriterNamesBothPins) {
  MachineOptions options;
  options.hal = {"net doubled motion.in-position", "net doubled motion.coord-mode"};
  auto m = refused(options);
  EXPECT_THAT(m->errors(), AllOf(HasSubstr("doubled"), HasSubstr("motion.in-position"),
                                 HasSubstr("motion.coord-mode")));
}

TEST(BadInput, ARefusedNetChangesNothing) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_FALSE(m->hal("net partly motion.in-position motion.digital-in-00 motion.coord-mode"));
  EXPECT_TRUE(m->hal("net other motion.in-position"));  // still free
}

class Homed : public testing::Test {
 protected:
  void SetUp() override {
    m = Machine::start();
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    ASSERT_TRUE(m->mdi("G0 X10 Y10 Z-10")) << m->errors();
    before = m->motion();
  }
  /// The machine is where it was and does what it is told.
  void expect_unharmed() {
    m->run_for(0.5);
    const auto now = m->motion();
    for (int j = 0; j < 3; ++j)
      EXPECT_EQ(now.joint[j].pos_cmd, before.joint[j].pos_cmd) << "joint " << j;
    EXPECT_TRUE(now.enabled);
    EXPECT_FALSE(m->bit("spindle.0.on"));
    EXPECT_TRUE(m->mdi("G0 X11")) << m->errors();
    EXPECT_NEAR(m->joint(0), 11, 1e-9);
  }
  std::unique_ptr<Machine> m;
  motion::MotionStatus before;
};

TEST_F(Homed, SyntaxErrorNamesFileLineAndColumn) {
  const auto reply = m->run_text("G21 G90\nM3 S100\nG1 X1O0 F100\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::error);
  EXPECT_THAT(m->errors(), HasSubstr("test.ngc:3"));
  EXPECT_THAT(m->errors(), HasSubstr("\nG1 X1O0 F100\n     ^"));
  expect_unharmed();
}

TEST_F(Homed, MissingTool) {
  const auto reply = m->run_text("T77 M6\nG0 X50\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::error);
  EXPECT_THAT(m->errors(), AllOf(HasSubstr("test.ngc:1"),
                                 HasSubstr("Requested tool 77 not found in the tool table")));
  expect_unharmed();
}

TEST_F(Homed, SoftLimitNamesAxisValueAndLimit) {
  const auto reply = m->run_text("G21 G90 G54\nG53 G0 X350\nM2\n");
  EXPECT_NE(reply.state, task::CommandState::done);
  EXPECT_THAT(m->errors(),
              AllOf(HasSubstr("350"), HasSubstr("300"), HasSubstr("X"), HasSubstr("test.ngc:2")));
  expect_unharmed();
}

TEST_F(Homed, SoftLimitOfAnArcBetweenItsEnds) {
  const auto reply = m->run_text(
      "G21 G90 G54\nG53 G0 X280 Y50\nG1 F1000 X280\nG2 X280 Y90 I0 J20\nG3 X280 Y50 J-20\nM2\n");
  (void)reply;
  double highest = 0;
  highest = m->motion().joint[0].pos_cmd;
  EXPECT_LE(highest, 300);
  const auto far =
      m->run_text("G21 G90 G54\nG53 G0 X290 Y50\nG3 X290 Y90 I0 J20 F1000\nM2\n");  // out to X310
  EXPECT_NE(far.state, task::CommandState::done);
  EXPECT_THAT(m->errors(), AllOf(HasSubstr("310"), HasSubstr("300")));
}

TEST_F(Homed, MissingProgramFile) {
  const auto reply = m->run_program("/nowhere/none.ngc");
  EXPECT_EQ(reply.state, task::CommandState::error);
  EXPECT_THAT(reply.text, HasSubstr("/nowhere/none.ngc"));
  expect_unharmed();
}

TEST_F(Homed, UnknownUserMCodeNamesTheCause) {
  EXPECT_EQ(m->command({"mdi", "M155"}).state, task::CommandState::error);
  EXPECT_THAT(m->errors(), HasSubstr("Unknown m code used: M155"));
  m->write_program("#!/bin/sh\nexit 0\n", "M156");
  expect_unharmed();
}

TEST(BadInput, MdiBeforeHomingAndPower) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_EQ(m->command({"mdi", "G0 X1"}).state, task::CommandState::error);
  ASSERT_TRUE(m->power_on());
  const auto reply = m->command({"mdi", "G0 X1"});
  EXPECT_EQ(reply.state, task::CommandState::error);
  EXPECT_THAT(reply.text, HasSubstr("not homed"));
}

TEST(BadInput, MisspelledClientCommand) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  const auto reply = m->command({"feed-overide", "1.2"});
  EXPECT_EQ(reply.state, task::CommandState::error);
}

}  // namespace
}  // namespace kerf::harness
