// Every M-code with words that are missing, out of range, not whole or not its own: as a line of MDI and in a program. One message
// begins with what LinuxCNC says, the machine is idle where it was, nothing turns or flows, and the next line works.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

struct Row {
  const char* line;
  const char* text;  ///< in the message's first line
};

// clang-format off
constexpr Row kWrongWords[] = {
    {"M0 M1", "Two m codes used from same modal group"},
    {"M0 P1", "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G8"},
    {"M2 M30", "Two m codes used from same modal group"},
    {"M3 M4", "Two m codes used from same modal group"},
    {"M3 S-1", "Negative spindle speed used"},
    {"M3 $9", "Spindle ($) number out of range in M3 Command"},
    {"M3 $-2", "Spindle ($) number out of range in M3 Command"},
    {"M3 $1.5", "Non integer value for integer"},
    {"M5 M19 R1 Q1", "Two m codes used from same modal group"},
    {"M3 M19 R1 Q1", "Two m codes used from same modal group"},
    {"S-5", "Negative spindle speed used"},
    {"S100 $9", "Invalid spindle ($) number in Spindle speed command"},
    {"S1e400", "E word with no G70, G76, M66, M67 or M68 to use it"},
    {"M6 T99", "Requested tool 99 not found in the tool table"},
    {"T99", "Requested tool 99 not found in the tool table"},
    {"T-1", "Negative tool id (tool not found)"},
    {"T1.5", "Non integer value for integer"},
    {"M6 M61 Q1", "Two m codes used from same modal group"},
    {"M6 Q1", "Q word with no G5, G6, G10, G64, G73, G76, G83, M19, M66, M6"},
    {"M7 M8", "Two m codes used from same modal group"},
    {"M7 M9", "Two m codes used from same modal group"},
    {"M8 M9", "Two m codes used from same modal group"},
    {"M7 M8 M9", "Two m codes used from same modal group"},
    {"M19 R-1 Q1", "R value must be within 0..360 with M19"},
    {"M19 R361 Q1", "R value must be within 0..360 with M19"},
    {"M19 R10 Q-1", "Q word with M19 requires a value > 0"},
    {"M19 R10 Q0", "Q word with M19 requires a value > 0"},
    {"M19 R10 P3 Q1", "P value must be 0,1,or 2 with M19"},
    {"M19 R10 P-1 Q1", "P value must be 0,1,or 2 with M19"},
    {"M19 R10 P7 Q1", "P value must be 0,1,or 2 with M19"},
    {"M19 R10 P1.5 Q1", "P value not an integer with M19 G2 or G3"},
    {"M19 R10 Q1 $5", "Spindle ($) number out of range in M19 Command"},
    {"M19 R10 Q1 $1.5", "Non integer value for integer"},
    {"M19 R10 Q1 $-1", "Spindle ($) number out of range in M19 Command"},
    {"M48 M49", "Two m codes used from same modal group"},
    {"M48 P1", "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G8"},
    {"M48 $7", "Invalid spindle ($) number in M48 command"},
    {"M49 $7", "Invalid spindle ($) number in M49 command"},
    {"M51 P0 $7", "Invalid spindle ($) number in M51 command"},
    {"M61", "Need non-negative Q-word to specify tool number with M61"},
    {"M61 Q-1", "Need non-negative Q-word to specify tool number with M61"},
    {"M61 Q1.5", "Non integer value for integer"},
    {"M61 Q99", "Requested tool 99 not found in the tool table"},
    {"M61 Q1e10", "E word with no G70, G76, M66, M67 or M68 to use it"},
    {"M61 P1", "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G8"},
    {"M62", "No valid P word with M62"},
    {"M62 P-1", "No valid P word with M62"},
    {"M62 P1.5", "Non integer value for integer"},
    {"M62 E1", "E word with no G70, G76, M66, M67 or M68 to use it"},
    {"M62 P1 Q1", "Q word with no G5, G6, G10, G64, G73, G76, G83, M19, M66, M6"},
    {"M63", "No valid P word with M63"},
    {"M63 P-1", "No valid P word with M63"},
    {"M64", "No valid P word with M64"},
    {"M64 P-1", "No valid P word with M64"},
    {"M64 P1.5", "Non integer value for integer"},
    {"M65", "No valid P word with M65"},
    {"M65 P-2", "No valid P word with M65"},
    {"M66", "Need to have either a valid P or a valid E word with M66"},
    {"M66 P0 E0", "Invalid to select both a digital and an analog input with M6"},
    {"M66 P0 E0 L0", "Invalid to select both a digital and an analog input with M6"},
    {"M66 P0 L1", "Zero timeout with wait type != immediate return"},
    {"M66 P0 L3 Q0", "Zero timeout with wait type != immediate return"},
    {"M66 P0 L3 Q-1", "Zero timeout with wait type != immediate return"},
    {"M66 P0 L5 Q1", "Invalid wait mode (L word) with M66"},
    {"M66 P0 L-1 Q1", "Negative l word used"},
    {"M66 P0 L1.5 Q1", "Non integer value for integer"},
    {"M66 P-1 L0", "Need to have either a valid P or a valid E word with M66"},
    {"M66 P1.5 L0", "Non integer value for integer"},
    {"M66 E-1 L0", "Need to have either a valid P or a valid E word with M66"},
    {"M66 E0 L1 Q1", "Can't select analog input with wait type != immediate return"},
    {"M66 E0 L3 Q1", "Can't select analog input with wait type != immediate return"},
    {"M66 L3 Q1", "Need to have either a valid P or a valid E word with M66"},
    {"M67", "Invalid analog index with M67"},
    {"M67 E0", "Q word missing with M67"},
    {"M67 Q1", "Invalid analog index with M67"},
    {"M67 E-1 Q1", "Invalid analog index with M67"},
    {"M67 E1.5 Q1", "Non integer value for integer"},
    {"M67 P0 Q1", "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G8"},
    {"M68", "Invalid analog index with M68"},
    {"M68 E0", "Q word missing with M68"},
    {"M68 E-1 Q1", "Invalid analog index with M68"},
    {"M68 Q1", "Invalid analog index with M68"},
    {"M70 M71", "Two m codes used from same modal group"},
    {"M72", "Cannot restore context from invalid stack frame - missing M7"},
    {"M73 M72", "Two m codes used from same modal group"},
    {"M70 M73", "Two m codes used from same modal group"},
    {"M72 M72", "Two m codes used from same modal group"},
    {"M71 M72", "Two m codes used from same modal group"},
    {"M74", "Unknown m code used: M74"},
    {"M75", "Unknown m code used: M75"},
    {"M97", "Unknown m code used: M97"},
    {"M98", "Found 'm98' code with no P-word"},
    {"M98 P77", "seeking o-word: o<77>"},
    {"M98 P1.5", "Non integer value for integer"},
    {"M98 P-1", "seeking o-word: o<-1>"},
    {"M98 L2", "Found 'm98' code with no P-word"},
    {"M98 P77 L-1", "Negative l word used"},
    {"M98 P77 Q2", "Q word with no G5, G6, G10, G64, G73, G76, G83, M19, M66, M6"},
    {"M99 P1", "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G8"},
    {"M100", "Unknown m code used: M100"},
    {"M100 P1 Q1", "Unknown m code used: M100"},
    {"M150", "Unknown m code used: M150"},
    {"M199", "Unknown m code used: M199"},
    {"M200", "M-code greater than 199: M200"},
    {"M250", "M-code greater than 199: M250"},
    {"M1000", "M-code greater than 199: M1000"},
    {"M-1", "Negative m code used"},
    {"M1.5", "Non integer value for integer"},
    {"M99.5", "Non integer value for integer"},
    {"M3.1", "Non integer value for integer"},
    {"M10", "Unknown m code used: M10"},
    {"M31", "Unknown m code used: M31"},
    {"M40", "Unknown m code used: M40"},
    {"M59", "Unknown m code used: M59"},
    {"M47", "Unknown m code used: M47"},
    {"M110 P", "No characters found in reading real value"},
    {"M110 Q#<_nothere>", "Named parameter #<_nothere> not defined"},
    {"P1", "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G8"},
    {"Q1", "Q word with no G5, G6, G10, G64, G73, G76, G83, M19, M66, M6"},
    {"E1", "E word with no G70, G76, M66, M67 or M68 to use it"},
    {"L1", "L word with no G10, cutter compensation, canned cycle, digit"},
    {"R1", "R word with no g code that uses it"},
    {"$1", "$ (spindle selection) word with no M3, M4, M5, M19, M51, G33"},
    {"M62 P0 M62 P1", "Two m codes used from same modal group"},
    {"M62 P0 M63 P0", "Two m codes used from same modal group"},
    {"M64 P0 M64 P1", "Two m codes used from same modal group"},
    {"M62 P0 M64 P1", "Two m codes used from same modal group"},
    {"M66 P0 L0 M66 P1 L0", "Two m codes used from same modal group"},
    {"M50 P0 M51 P0", "Two m codes used from same modal group"},
    {"M48 M50 P0", "Two m codes used from same modal group"},
    {"M60 M0", "Two m codes used from same modal group"},
    {"M60 M1", "Two m codes used from same modal group"},
    {"M60 P1", "P word with no G2 G3 G4 G10 G64 G5 G5.2 G6, G6.2, G76 G82 G8"},
    {"M30 M99", "Two m codes used from same modal group"},
    {"M6 T1 $1", "$ (spindle selection) word with no M3, M4, M5, M19, M51, G33"},
    {"G10 L1", "P value out of range with G10 L1"},
    {"G10 L1 P1", "G10 L1 without offsets has no effect"},
    {"G10 L1 P1 Q-1", "Invalid tool orientation"},
    {"G10 L1 P1 Q10", "Invalid tool orientation"},
    {"G10 L1 P1 Q1.5", "Q number in G10 is not an integer"},
    {"G10 L1 P-1 Z1", "P value out of range with G10 L1"},
    {"G10 L1 P99 Z1", "Requested tool 99 not found in the tool table"},
    {"G10 L1 P0 Z1", "P value out of range with G10 L1"},
    {"G10 L10", "P value out of range with G10 L10"},
    {"G10 L10 P1", "G10 L1 without offsets has no effect"},
    {"G10 L10 P99 Z0", "Requested tool 99 not found in the tool table"},
    {"G10 L10 P-1 Z1", "P value out of range with G10 L10"},
    {"G10 L11", "P value out of range with G10 L11"},
    {"G10 L11 P77 Z0", "Requested tool 77 not found in the tool table"},
    {"G10 P1", "Line with G10 does not have L0, L1, L10, L11, L2, or L20"},
    {"G10 L5 P1", "Line with G10 does not have L0, L1, L10, L11, L2, or L20"},
    {"G10 L1 P1.5 Z1", "P value not an integer with G10"},
    {"G43 H99", "Requested tool 99 not found in the tool table"},
    {"G43 H-1", "Requested tool -1 not found in the tool table"},
    {"G43 H1.5", "Non integer value for integer"},
};

/// Right as words, but the machine has no such thing.
constexpr Row kNotThere[] = {
    {"M3 $1", "Spindle ($) number out of range in M3"},
    {"S100 $1", "Invalid spindle ($) number"},
    {"M62 P4", "motion.digital-out-04"},
    {"M62 P99", "motion.digital-out-99"},
    {"M63 P63", "motion.digital-out-63"},
    {"M63 P64", "motion.digital-out-64"},
    {"M64 P4", "motion.digital-out-04"},
    {"M64 P2000000", "motion.digital-out-2000000"},
    {"M65 P99", "motion.digital-out-99"},
    {"M66 P4 L0", "no digital input 4"},
    {"M66 P99 L3 Q1", "no digital input 99"},
    {"M66 E4 L0", "no analog input 4"},
    {"M66 E99", "no analog input 99"},
    {"M67 E4 Q1", "motion.analog-out-04"},
    {"M67 E99 Q1", "motion.analog-out-99"},
    {"M68 E9 Q1", "motion.analog-out-09"},
    {"M68 E64 Q1", "motion.analog-out-64"},
};
// clang-format on

class MCodeBadInput : public testing::Test {
 protected:
  void SetUp() override {
    MachineOptions o;
    o.files.emplace_back("M150", "no program");  // not executable
    o.replace = {{"USER_M_PATH = ", "USER_M_PATH = .:"}};
    m = Machine::start(o);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    ASSERT_TRUE(m->mdi("T1 M6") && m->mdi("G0 X5")) << m->errors();
  }
  static std::string first_line(const task::Reply& reply) {
    return reply.text.substr(0, reply.text.find('\n'));
  }
  void expect_idle_and_safe(const char* line, double x) {
    m->run_for(0.02);
    EXPECT_TRUE(m->task().idle) << line;
    EXPECT_EQ(m->task().task_state, task::TaskState::on) << line;
    EXPECT_NEAR(m->joint(0), x, 1e-9) << line;
    EXPECT_FALSE(m->bit("spindle.0.on")) << line;
    EXPECT_FALSE(m->bit("spindle.0.orient")) << line;
    EXPECT_FALSE(m->bit("iocontrol.0.coolant-mist") || m->bit("iocontrol.0.coolant-flood")) << line;
    EXPECT_FALSE(m->bit("iocontrol.0.tool-prepare") || m->bit("iocontrol.0.tool-change")) << line;
    EXPECT_EQ(m->get("iocontrol.0.tool-number"), 1) << line;
    for (const char* pin : {"motion.digital-out-00", "motion.digital-out-03"})
      EXPECT_FALSE(m->bit(pin)) << line << ": " << pin;
    for (const char* pin : {"motion.analog-out-00", "motion.analog-out-03"})
      EXPECT_EQ(m->get(pin), 0) << line << ": " << pin;
  }
  void expect_refused(const Row& row) {
    const auto reply = m->command({"mdi", row.line});
    EXPECT_EQ(reply.state, task::CommandState::error) << row.line;
    EXPECT_NE(first_line(reply).find(row.text), std::string::npos)
        << row.line << ": " << reply.text;
    EXPECT_EQ(first_line(reply).find("test.ngc"), std::string::npos)
        << row.line << ": " << reply.text;
    EXPECT_NE(m->errors().find(row.text), std::string::npos) << row.line << " is not told";
    EXPECT_TRUE(m->mdi("G0 X5")) << row.line << m->errors();
    expect_idle_and_safe(row.line, 5);

    const auto run = m->run_text("G21 G90 G0 X6\n" + std::string(row.line) + "\nG0 X9\nM2\n");
    EXPECT_EQ(run.state, task::CommandState::error) << row.line;
    EXPECT_NE(first_line(run).find(row.text), std::string::npos) << row.line << ": " << run.text;
    EXPECT_NE(first_line(run).find("test.ngc:2"), std::string::npos)
        << row.line << ": " << run.text;
    expect_idle_and_safe(row.line, 6);
    EXPECT_TRUE(m->mdi("G0 X5")) << row.line << m->errors();
  }
  std::unique_ptr<Machine> m;
};

TEST_F(MCodeBadInput, WrongWordsDoNothing) {
  for (const Row& row : kWrongWords) expect_refused(row);
}

TEST_F(MCodeBadInput, WhatTheMachineDoesNotHaveIsNamedByItsPin) {
  for (const Row& row : kNotThere) expect_refused(row);
}

}  // namespace
}  // namespace kerf::harness
