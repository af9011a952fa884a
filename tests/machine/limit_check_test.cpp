// A program that leads beyond the soft limits is told when it is opened: file, line, axis and joint, value, limit.
#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

std::unique_ptr<Machine> homed(const std::string& append = {}) {
  MachineOptions options;
  options.append = append;
  auto m = Machine::start(options);
  if (m->ready()) (void)m->power_on_and_home();
  return m;
}

std::string opened(Machine& m, const std::string& program) {
  const std::string before = m.errors();
  EXPECT_TRUE(m.does({"open", m.write_program(program)}));
  m.run_for(0.1);
  return m.errors().substr(before.size());
}

TEST(LimitCheck, NamesTheFirstMoveBeyondEachLimitWhenTheProgramIsOpened) {
  auto m = homed();
  ASSERT_TRUE(m->ready()) << m->errors();
  const auto at = m->motion().pos_cmd;
  const std::string said = opened(*m,
                                  "G21 G90\nG0 X10 Y10\no100 repeat [3]\n  G91 G1 X4000 F1000\n"
                                  "o100 endrepeat\nG90 G1 X0\nG1 Z-3000\nM2\n");
  for (const char* part : {"test.ngc:4:", "axis X (joint 0)", "to 4010", "above its MAX_LIMIT of",
                           "test.ngc:7:", "axis Z (joint 2)", "to -3000", "below its MIN_LIMIT of"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in: " << said;
  EXPECT_EQ(said.find("8010"), std::string::npos) << "the first of each: " << said;
  EXPECT_EQ(m->motion().pos_cmd, at) << "nothing moved";
  EXPECT_EQ(m->motion().faults, 0U);
  // And again when it runs, before the move begins.
  const auto reply = m->run_program(m->folder() + "/test.ngc");
  EXPECT_EQ(reply.state, task::CommandState::error);
  EXPECT_NE(reply.text.find("MAX_LIMIT"), std::string::npos) << reply.text;
  EXPECT_LE(m->joint(0), 10);
}

TEST(LimitCheck, SeesArcsWorkOffsetsAndSubsAndIsSilentOtherwise) {
  auto m = homed();
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_EQ(opened(*m, "G21 G90\nG0 X100 Y50\nG2 X100 Y50 I20 F500\nM2\n"), "");
  ASSERT_TRUE(m->does({"mdi", "G0 G53 X290 Y100"}, 60)) << m->errors();
  // Ends within, bulges beyond: a half circle of radius 20 about X290.
  const std::string arc = opened(*m, "G21 G90\nG0 G53 X290 Y100\nG91 G2 Y-40 J-20 F500\nM2\n");
  EXPECT_NE(arc.find("axis X (joint 0) to 310, above its MAX_LIMIT of 300"), std::string::npos)
      << arc;
  EXPECT_NE(arc.find("test.ngc:3:"), std::string::npos) << arc;
  ASSERT_TRUE(m->mdi("G10 L2 P1 X250")) << m->errors();
  const std::string offset = opened(*m, "G21 G90 G54\nG0 X100\nM2\n");
  EXPECT_NE(offset.find("to 350"), std::string::npos) << offset;
  ASSERT_TRUE(m->mdi("G10 L2 P1 X0"));
  // What a run alone finds out ends the look, without a word.
  EXPECT_EQ(opened(*m, "G21 G90\nG38.3 Z-5 F100\nG0 X#5061\nG0 X5000\nM2\n"), "");
}

TEST(LimitCheck, WaitsForHomingAndCanBeSwitchedOff) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_EQ(opened(*m, "G21 G90\nG0 X5000\nM2\n"), "") << "where is it?";
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  m->run_for(0.1);
  EXPECT_NE(m->errors().find("test.ngc:2:"), std::string::npos) << m->errors();
  auto off = homed("[KERF]\nCHECK_LIMITS = 0\n");
  ASSERT_TRUE(off->ready()) << off->errors();
  EXPECT_EQ(opened(*off, "G21 G90\nG0 X5000\nM2\n"), "");
}

TEST(LimitCheck, EndsInAProgramWithoutEnd) {
  auto m = homed();
  ASSERT_TRUE(m->ready()) << m->errors();
  EXPECT_EQ(opened(*m, "G21 G90 F1000\no1 while [1]\nG1 X1\nG1 X2\no1 endwhile\nM2\n"), "");
  m->run_for(1);
  EXPECT_TRUE(m->mdi("G0 X3", 5)) << m->errors();
}

/// A long program is read beside all else: orders are carried out at once, and it is read anew afterwards.
TEST(LimitCheck, NeverKeepsAnOrderWaiting) {
  auto m = homed();
  ASSERT_TRUE(m->ready()) << m->errors();
  std::ostringstream text;
  text << "G21 G90 F1000\n";
  constexpr int kLines = 100000;
  for (int i = 0; i < kLines; ++i) text << "G1 X" << i % 100 << " Y" << (i * 7) % 100 << '\n';
  text << "G1 X5000\nM2\n";
  const std::string before = m->errors();
  ASSERT_TRUE(m->does({"open", m->write_program(text.str())}));
  m->cycle();
  ASSERT_EQ(m->errors(), before) << "still at work";
  EXPECT_TRUE(m->mdi("G0 X1", 5)) << m->errors();
  EXPECT_NEAR(m->joint(0), 1, 1e-9);
  EXPECT_TRUE(m->run_until([&] { return m->errors() != before; }, 5));
  EXPECT_NE(m->errors().find("test.ngc:100002:"), std::string::npos) << m->errors();
  std::printf(
      "result: soft limits of a program of %d lines checked when it was opened; an MDI line "
      "between "
      "was carried out at once\n",
      kLines);
}

}  // namespace
}  // namespace kerf::harness
