// M codes of the manual sentence by sentence, on a running machine at its pins: spindles, orientation, overrides, inputs
// and outputs, saved state, program end. Names of the tests stand in tests/seeds.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

class MCodePins : public testing::Test {
 protected:
  void start(const MachineOptions& options = {}) {
    m = Machine::start(options);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  }
  static MachineOptions three_spindles() {
    MachineOptions o;
    o.replace = {{"SPINDLES = 1", "SPINDLES = 3"}};
    return o;
  }
  /// The drive's answer to M19 comes from the test.
  static MachineOptions drive_by_hand() {
    MachineOptions o = three_spindles();
    o.hal = {"unlinkp spindle.0.is-oriented"};
    return o;
  }
  static std::string spindle(int n, const char* pin) {
    return "spindle." + std::to_string(n) + "." + pin;
  }
  bool ends(std::uint64_t id, double limit_s) {
    return m->run_until([&] { return task::is_terminal(m->outcome(id).state); }, limit_s);
  }
  bool shows(int code) const {
    const auto t = m->task();
    return std::find(std::begin(t.g_codes), std::end(t.g_codes), code) != std::end(t.g_codes);
  }
  std::unique_ptr<Machine> m;
};

TEST_F(MCodePins, EachSpindleHasItsSpeedAndMinusOneStartsThemAll) {
  start(three_spindles());
  EXPECT_TRUE(m->mdi("S100 $0") && m->mdi("S200 $1") && m->mdi("S300 $2") && m->mdi("M3 $-1"));
  m->run_for(0.1);
  for (int n = 0; n < 3; ++n) {
    EXPECT_NEAR(m->get(spindle(n, "speed-out")), 100.0 * (n + 1), 1e-6) << n;
    EXPECT_TRUE(m->bit(spindle(n, "forward"))) << n;
  }
  EXPECT_TRUE(m->mdi("M4 $1"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 100, 1e-6);
  EXPECT_NEAR(m->get("spindle.1.speed-out"), -200, 1e-6);
  EXPECT_NEAR(m->get("spindle.2.speed-out"), 300, 1e-6);
  EXPECT_TRUE(m->mdi("M5 $2"));
  m->run_for(0.1);
  EXPECT_TRUE(m->bit("spindle.0.on") && m->bit("spindle.1.on"));
  EXPECT_FALSE(m->bit("spindle.2.on"));
  // Without $ the first spindle alone.
  EXPECT_TRUE(m->mdi("M5"));
  m->run_for(0.1);
  EXPECT_FALSE(m->bit("spindle.0.on"));
  EXPECT_TRUE(m->bit("spindle.1.on"));
}

TEST_F(MCodePins, SpindleOverrideAtZeroHoldsItAndTurnedUpStartsIt) {
  MachineOptions o;
  o.replace = {{"MAX_FEED_OVERRIDE = 1.5", "MAX_FEED_OVERRIDE = 1.5\nMIN_SPINDLE_OVERRIDE = 0"}};
  start(o);
  EXPECT_TRUE(m->does({"spindle-override", "0"}));
  for (const char* line : {"M3 S900", "M4"}) {
    EXPECT_TRUE(m->mdi(line));
    m->run_for(0.2);
    EXPECT_EQ(m->get("spindle.0.speed-out"), 0) << line;
  }
  EXPECT_TRUE(m->does({"spindle-override", "0.5"}));
  m->run_for(0.2);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), -450, 1e-6);
}

TEST_F(MCodePins, OrientationTakesRQPAndDollar) {
  start(drive_by_hand());
  struct Row {
    const char* line;
    int spindle;
    double angle;
    int mode;
  };
  for (const Row& row : {Row{"M19 R90 Q5", 0, 90, 0}, Row{"M19 R10 Q5 P0", 0, 10, 0},
                         Row{"M19 R20.5 Q5 P1", 0, 20.5, 1}, Row{"M19 R360 Q5 P2", 0, 360, 2},
                         Row{"M19 R45 Q5 P1 $2", 2, 45, 1}}) {
    const auto id = m->send({"mdi", row.line});
    m->run_for(0.2);
    EXPECT_FALSE(task::is_terminal(m->outcome(id).state)) << row.line;
    for (int n = 0; n < 3; ++n)
      EXPECT_EQ(m->bit(spindle(n, "orient")), n == row.spindle) << row.line << n;
    EXPECT_EQ(m->get(spindle(row.spindle, "orient-angle")), row.angle) << row.line;
    EXPECT_EQ(m->get(spindle(row.spindle, "orient-mode")), row.mode) << row.line;
    EXPECT_FALSE(m->bit(spindle(row.spindle, "locked"))) << row.line;
    m->hal("setp " + spindle(row.spindle, "is-oriented") + " 1");
    EXPECT_TRUE(ends(id, 1)) << row.line;
    EXPECT_FALSE(m->bit(spindle(row.spindle, "orient"))) << row.line;
    EXPECT_TRUE(m->bit(spindle(row.spindle, "locked"))) << row.line;
    EXPECT_TRUE(m->bit(spindle(row.spindle, "brake"))) << row.line;
    m->hal("setp " + spindle(row.spindle, "is-oriented") + " 0");
  }
}

TEST_F(MCodePins, OrientOffsetIsAddedToR) {
  MachineOptions o = drive_by_hand();
  o.replace.emplace_back("[RS274NGC]\n", "[RS274NGC]\nORIENT_OFFSET = 30\n");
  start(o);
  m->send({"mdi", "M19 R15 Q5"});
  m->run_for(0.2);
  EXPECT_EQ(m->get("spindle.0.orient-angle"), 45);
}

TEST_F(MCodePins, OrientationThatDoesNotComeWithinQIsAnError) {
  start(drive_by_hand());
  const auto id = m->send({"mdi", "M19 R90 Q2"});
  m->run_for(1.9);
  EXPECT_FALSE(task::is_terminal(m->outcome(id).state)) << "Q is the longest wait";
  EXPECT_TRUE(ends(id, 0.3));
  EXPECT_EQ(m->outcome(id).state, task::CommandState::error);
  EXPECT_FALSE(m->bit("spindle.0.locked"));
}

TEST_F(MCodePins, FaultOfTheDriveEndsTheOrientation) {
  start(drive_by_hand());
  const auto id = m->send({"mdi", "M19 R90 Q9"});
  m->run_for(0.2);
  m->hal("setp spindle.0.orient-fault 3");
  EXPECT_TRUE(ends(id, 0.2));
  EXPECT_EQ(m->outcome(id).state, task::CommandState::error);
  EXPECT_FALSE(m->bit("spindle.0.locked"));
}

TEST_F(MCodePins, StartingOrStoppingTheSpindleEndsTheOrientationState) {
  for (const char* line : {"M3 S100", "M4 S100", "M5"}) {
    start(drive_by_hand());
    m->hal("setp spindle.0.is-oriented 1");
    EXPECT_TRUE(m->mdi("M19 R90 Q2"));
    EXPECT_TRUE(m->bit("spindle.0.locked"));
    EXPECT_TRUE(m->mdi(line));
    m->run_for(0.05);
    EXPECT_FALSE(m->bit("spindle.0.orient")) << line;
    EXPECT_FALSE(m->bit("spindle.0.locked")) << line;
  }
}

TEST_F(MCodePins, OverridesAreSwitchedBySpindleAndTwiceIsFine) {
  start(three_spindles());
  EXPECT_TRUE(m->does({"spindle-override", "0.5"}));
  EXPECT_TRUE(m->mdi("M3 S1000"));
  EXPECT_TRUE(m->mdi("M49") && m->mdi("M49"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 1000, 1e-6);
  EXPECT_TRUE(m->mdi("M48 $0") && m->mdi("M48 $0"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 500, 1e-6);
  EXPECT_TRUE(m->mdi("M51 P0"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 1000, 1e-6);
  EXPECT_TRUE(m->mdi("M51"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 500, 1e-6);
}

TEST_F(MCodePins, M61NamesTheToolInTheSpindleAndRefusesANegativeNumber) {
  start();
  EXPECT_TRUE(m->mdi("M61 Q2"));
  EXPECT_EQ(m->get("iocontrol.0.tool-number"), 2);
  EXPECT_EQ(m->command({"mdi", "M61 Q-1"}).state, task::CommandState::error);
  EXPECT_EQ(m->get("iocontrol.0.tool-number"), 2);
  EXPECT_EQ(m->run_text("M61 Q1\nM2\n").state, task::CommandState::done);
  EXPECT_EQ(m->get("iocontrol.0.tool-number"), 1);
}

TEST_F(MCodePins, ToolChangeStopsTheSpindleAndLeavesTheCoolantOn) {
  start();
  EXPECT_EQ(m->run_text("M3 S500\nM8\nT2 M6\nM0\nM2\n", 1).state, task::CommandState::running);
  EXPECT_FALSE(m->bit("spindle.0.on"));
  EXPECT_TRUE(m->bit("iocontrol.0.coolant-flood"));
  EXPECT_EQ(m->get("iocontrol.0.tool-number"), 2);
}

TEST_F(MCodePins, FourInputsAndOutputsOfEachKindUnlessMotmodMakesMore) {
  start();
  EXPECT_TRUE(m->mdi("M64 P3") && m->mdi("M68 E3 Q1") && m->mdi("M66 P3 L0") &&
              m->mdi("M66 E3 L0"));
  for (const char* line : {"M64 P4", "M62 P4", "M66 P4 L0", "M66 E4 L0", "M68 E4 Q1", "M67 E4 Q1"})
    EXPECT_NE(m->command({"mdi", line}).state, task::CommandState::done) << line;
}

TEST_F(MCodePins, NumDioAndNumAioSetHowManyThereAre) {
  MachineOptions o;
  o.replace = {{"EMCMOT = motmod", "EMCMOT = motmod num_dio=9 num_aio=7"}};
  start(o);
  EXPECT_TRUE(m->mdi("M64 P8") && m->mdi("M68 E6 Q2.5"));
  EXPECT_TRUE(m->bit("motion.digital-out-08"));
  EXPECT_EQ(m->get("motion.analog-out-06"), 2.5);
  EXPECT_EQ(m->run_text("M62 P7\nM67 E5 Q-3\nG0 X1\nM2\n").state, task::CommandState::done);
  EXPECT_TRUE(m->bit("motion.digital-out-07"));
  EXPECT_EQ(m->get("motion.analog-out-05"), -3);
  m->hal("setp motion.digital-in-08 1");
  m->hal("setp motion.analog-in-06 4.25");
  EXPECT_TRUE(m->mdi("M66 P8 L3 Q1") && m->mdi("G0 X#5399"));
  EXPECT_NEAR(m->joint(0), 1, 1e-9);
  EXPECT_TRUE(m->mdi("M66 E6 L0") && m->mdi("G0 X#5399"));
  EXPECT_NEAR(m->joint(0), 4.25, 1e-9);
}

TEST_F(MCodePins, ImmediateOutputsBreakBlending) {
  for (const char* code : {"M64 P0", "M65 P0", "M68 E0 Q1"}) {
    start();
    double slowest = 1e9;
    m->on_cycle([&](const motion::MotionStatus& s) {
      if (s.joint[0].pos_cmd > 5 && s.joint[0].pos_cmd < 15)
        slowest = std::min(slowest, s.vel_mm_s);
    });
    EXPECT_EQ(m->run_text(std::string("G64\nG1 F600 X10\n") + code + "\nX20\nM2\n").state,
              task::CommandState::done);
    EXPECT_LT(slowest, 0.5) << code;
  }
}

TEST_F(MCodePins, NothingBehindTheProgramEndIsExecuted) {
  for (const char* code : {"M2", "M30"}) {
    start();
    EXPECT_EQ(m->run_text(std::string("G0 X1\n") + code + "\nG0 X50\nM64 P0\n").state,
              task::CommandState::done);
    m->run_for(1);
    EXPECT_NEAR(m->joint(0), 1, 1e-9);
    EXPECT_FALSE(m->bit("motion.digital-out-00"));
  }
}

TEST_F(MCodePins, SavedStateBelongsToItsCallLevel) {
  start();
  // Each call of the sub saves and changes its own; the caller's state is what it was.
  EXPECT_EQ(
      m->run_text("o<s> sub\n"
                  "M70\nG20 F[#1] S[#1*100]\n"
                  "o1 if [#1 LT 4]\no<s> call [#1+1]\no1 endif\n"
                  "o2 if [#<_feed> NE #1 OR #<_rpm> NE [#1*100]]\n(abort,level #1 lost its "
                  "state)\no2 endif\n"
                  "M72\n"
                  "o<s> endsub\n"
                  "G21 F222 S999\nM70\nF333\nM70\no<s> call [1]\n"
                  "o3 if [#<_feed> NE 333]\n(abort,caller changed)\no3 endif\n"
                  "F1\nM72\n"
                  "o4 if [#<_feed> NE 333]\n(abort,the second M70 replaces the first)\no4 endif\n"
                  "M2\n")
          .state,
      task::CommandState::done)
      << m->errors();
}

TEST_F(MCodePins, SavedStateOfASubIsGoneWithIt) {
  start();
  EXPECT_EQ(m->run_text("o<s> sub\nM70\no<s> endsub\no<s> call\nM72\nM2\n").state,
            task::CommandState::error);
}

TEST_F(MCodePins, SingleModesAreKeptInALocalParameter) {
  start();
  EXPECT_EQ(m->run_text("o<s> sub\n#<absolute> = #<_absolute>\nG91\nG0 X1\n"
                        "o1 if [#<absolute>]\nG90\no1 endif\no<s> endsub\n"
                        "G90 G0 X5\no<s> call\nG0 X2\nG91\no<s> call\nG0 X1\nM2\n")
                .state,
            task::CommandState::done)
      << m->errors();
  EXPECT_NEAR(m->joint(0), 4, 1e-9);
}

TEST_F(MCodePins, ProgramEndEndsCutterCompensation) {
  for (const char* code : {"M2", "M30"}) {
    start();
    m->start_program(
        m->write_program(std::string("G0 X5 Y5\nG41.1 D4\nG1 X20 F600\nX60 F300\n") + code + "\n"));
    EXPECT_TRUE(m->run_until([&] { return shows(410); }, 20)) << code;
    EXPECT_TRUE(m->run_until([&] { return shows(400); }, 60)) << code;
    EXPECT_TRUE(m->mdi("G0 X10 Y20")) << code;
    EXPECT_NEAR(m->joint(0), 10, 1e-9) << code;
    EXPECT_NEAR(m->joint(1), 20, 1e-9) << code;
  }
}

TEST_F(MCodePins, CoolantPinsActOnWhatTheyAreConnectedTo) {
  MachineOptions o;
  o.hal = {"net coolant-mist motion.digital-in-02", "unlinkp iocontrol.0.coolant-flood"};
  start(o);
  EXPECT_TRUE(m->mdi("M7") && m->mdi("M8"));
  EXPECT_TRUE(m->bit("motion.digital-in-02"));
  EXPECT_TRUE(m->bit("iocontrol.0.coolant-flood"));
  EXPECT_TRUE(m->mdi("M9"));
  EXPECT_FALSE(m->bit("motion.digital-in-02"));
}

TEST_F(MCodePins, NetConnectsAnInputForM66) {
  MachineOptions o;
  o.hal = {"loadrt or2 names=button", "addf button servo-thread",
           "alias pin button.out parport.0.pin10-in",
           "net stop-signal motion.digital-in-00 <= parport.0.pin10-in"};
  start(o);
  const auto id = m->send({"mdi", "M66 P0 L3 Q9"});
  m->run_for(0.5);
  EXPECT_FALSE(task::is_terminal(m->outcome(id).state));
  m->hal("setp button.in0 1");
  EXPECT_TRUE(ends(id, 0.2));
  EXPECT_EQ(m->outcome(id).state, task::CommandState::done);
  EXPECT_TRUE(m->bit("motion.digital-in-00"));
}

TEST_F(MCodePins, TShowsThePocketOfTheToolNotItsPlaceInTheTable) {
  MachineOptions o;
  o.hal = {"unlinkp iocontrol.0.tool-prepared"};
  start(o);
  m->write_program("T1 P9 Z40 D16\nT20 P5 Z30 D6\nT3 P7 Z50 D5\n", "mill.tbl");
  EXPECT_TRUE(m->does({"tool-table"}));
  const auto id = m->send({"mdi", "T20"});
  EXPECT_TRUE(m->run_until([&] { return m->bit("iocontrol.0.tool-prepare"); }, 1));
  EXPECT_EQ(m->get("iocontrol.0.tool-prep-number"), 20);
  EXPECT_EQ(m->get("iocontrol.0.tool-prep-pocket"), 5);
  m->hal("setp iocontrol.0.tool-prepared 1");
  EXPECT_TRUE(ends(id, 1));
  EXPECT_EQ(m->command({"mdi", "T2.5"}).state, task::CommandState::error) << "an integer";
}

/// The component orient makes of the pins the way that a drive turns: position 0.1 revolutions, target 0.75.
TEST_F(MCodePins, OrientModeSaysWhichWayToTurn) {
  MachineOptions o;
  o.hal = {"unlinkp spindle.0.is-oriented",
           "loadrt orient names=drive",
           "addf drive servo-thread",
           "net spindle-orient drive.enable",
           "net spindle-orient-angle drive.angle",
           "net spindle-orient-mode spindle.0.orient-mode => drive.mode",
           "net drive-oriented drive.is-oriented => spindle.0.is-oriented",
           "setp drive.position 0.1"};
  start(o);
  const std::pair<const char*, double> ways[] = {
      {"M19 R270 Q5 P0", -0.25}, {"M19 R270 Q5 P1", 0.75}, {"M19 R270 Q5 P2", -0.25},
      {"M19 R180 Q5 P0", 0.5},   {"M19 R180 Q5 P2", -0.5}, {"M19 R18 Q5 P1", 1.05}};
  for (const auto& [line, target] : ways) {
    m->hal("setp drive.position 0.1");
    const auto id = m->send({"mdi", line});
    m->run_for(0.2);
    EXPECT_NEAR(m->get("drive.command"), target, 1e-9) << line;
    m->hal("setp drive.position " + std::to_string(target));
    EXPECT_TRUE(ends(id, 0.5)) << line;
    EXPECT_EQ(m->outcome(id).state, task::CommandState::done) << line;
    EXPECT_TRUE(m->bit("spindle.0.locked")) << line;
  }
}

}  // namespace
}  // namespace kerf::harness
