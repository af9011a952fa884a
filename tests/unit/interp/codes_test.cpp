// One test per family of codes; whole programs are in tests/golden/interp.
#include <gtest/gtest.h>

#include "rig.hpp"

namespace kerf::interp {
namespace {

Tool tool(int number, int pocket, double z) {
  Tool t;
  t.number = number;
  t.pocket = pocket;
  t.offset.z = z;
  return t;
}

TEST(Motion, IncrementalAndAbsolute) {
  Rig rig;
  (void)rig.mdi("G0 X1 Y2");
  (void)rig.mdi("G91");
  EXPECT_EQ(rig.mdi("X1 A3"),
            "STRAIGHT_TRAVERSE(2.0000, 2.0000, 0.0000, 3.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(rig.mdi("G90 Y7").substr(0, 8), "COMMENT(");
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.y, 7);
}

TEST(Motion, CanonGetsMillimetresWhateverTheUnits) {
  Rig rig;
  (void)rig.mdi("G20");
  (void)rig.mdi("G1 X1 A90 F2");
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.x, 25.4);
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.a, 90);
  EXPECT_DOUBLE_EQ(rig.interp.modal().feed, 50.8);
  EXPECT_EQ(rig.debug("#5420 #5423 #<_feed>"), "1.000000 90.000000 2.000000");
}

TEST(Motion, InverseTimeGivesEachMoveItsFeed) {
  Rig rig;
  (void)rig.mdi("G93");
  EXPECT_EQ(
      rig.mdi("G1 X10 F3"),
      "SET_FEED_RATE(30.0000)\nSTRAIGHT_FEED(10.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(rig.mdi("A180 F2").substr(0, 24), "SET_FEED_RATE(360.0000)\n");
  EXPECT_EQ(rig.mdi("G2 X20 I5 F1").substr(0, 23), "SET_FEED_RATE(15.7080)\n");
  EXPECT_EQ(rig.mdi("G2 X1 I1"), "error: F word missing with inverse time arc move");
}

TEST(Motion, PerRevolutionNeedsASpindleSpeed) {
  Rig rig;
  (void)rig.mdi("G95 F0.1");
  EXPECT_EQ(rig.mdi("G1 X1"), "error: Cannot feed with zero spindle speed in feed per rev mode");
  EXPECT_EQ(rig.mdi("S100 G1 X1"),
            "SET_SPINDLE_SPEED(0, 100.0000)\nSTRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, "
            "0.0000)\n");
}

TEST(Motion, MachineCoordinatesOnce) {
  Rig rig;
  (void)rig.mdi("G10 L2 P1 X1 Y2 R90");
  (void)rig.mdi("G92 X5 Y5");
  (void)rig.mdi("G43.1 Z3");
  (void)rig.mdi("G53 G0 X10 Z1");
  const ModalState& s = rig.interp.modal();
  const Pose m = s.frame.to_machine(s.position);
  EXPECT_NEAR(m.x, 10, 1e-12);
  EXPECT_NEAR(m.y, 0, 1e-12);
  EXPECT_NEAR(m.z, 1, 1e-12);
}

TEST(Motion, PolarWords) {
  Rig rig;
  EXPECT_EQ(rig.mdi("G0 @2 ^90"),
            "STRAIGHT_TRAVERSE(0.0000, 2.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  (void)rig.mdi("G91");
  (void)rig.mdi("@1 ^-90");
  EXPECT_NEAR(rig.interp.modal().position.x, 3, 1e-12);
  EXPECT_EQ(rig.mdi("@1 X1"), "error: Cannot specify both polar coordinate and X word");
}

TEST(Arcs, CentreAndTurns) {
  Rig rig;
  (void)rig.mdi("F100");
  EXPECT_EQ(rig.mdi("G3 X0 I-5 P2 Z1"),
            "ARC_FEED(0.0000, 0.0000, -5.0000, 0.0000, 2, 1.0000, 0.0000, 0.0000, 0.0000)\n");
  (void)rig.mdi("G18");
  EXPECT_EQ(rig.mdi("G2 X2 I1 Y3"),
            "ARC_FEED(1.0000, 2.0000, 1.0000, 1.0000, -1, 3.0000, 0.0000, 0.0000, 0.0000)\n");
}

TEST(Arcs, RadiusFormTakesTheLongWayForNegativeR) {
  Rig rig;
  (void)rig.mdi("F100");
  EXPECT_EQ(rig.mdi("G2 X1 Y1 R1"),
            "ARC_FEED(1.0000, 1.0000, 1.0000, 0.0000, -1, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  (void)rig.mdi("G0 X0 Y0");
  EXPECT_EQ(rig.mdi("G2 X1 Y1 R-1"),
            "ARC_FEED(1.0000, 1.0000, 0.0000, 1.0000, -1, 0.0000, 0.0000, 0.0000, 0.0000)\n");
}

TEST(Arcs, RadiusErrorNamesItsNumbers) {
  Rig rig;
  EXPECT_EQ(rig.mdi("F9 G2 X5 I2 J1"),
            "error: Radius to end of arc differs from radius to start: start=(X0.0000,Y0.0000) "
            "center=(X2.0000,Y1.0000) "
            "end=(X5.0000,Y0.0000) r1=2.2361 r2=3.1623 abs_err=0.9262 rel_err=29.2893%");
  // Within 0.005 mm nothing is said.
  EXPECT_EQ(rig.mdi("F9 G2 X4.004 I2").substr(0, 4), "SET_");
}

TEST(Offsets, G10L20KeepsTheOtherAxesUnderRotation) {
  Rig rig;
  (void)rig.mdi("G10 L2 P1 X1 Y5 R5");
  (void)rig.mdi("G10 L20 P0 X10");
  EXPECT_NEAR(rig.interp.modal().position.x, 10, 1e-9);
  EXPECT_NEAR(rig.interp.modal().frame.g5x().x, -10.3885, 1e-4);
  EXPECT_NEAR(rig.interp.modal().frame.g5x().y, 4.0036, 1e-4);
}

TEST(Offsets, ParametersAreInMachineUnits) {
  Settings s;
  s.machine_unit_mm = 25.4;
  Rig rig(s);
  (void)rig.mdi("G21");
  (void)rig.mdi("G10 L2 P2 X25.4 A3");
  EXPECT_DOUBLE_EQ(rig.interp.parameters().get(5241), 1);
  EXPECT_DOUBLE_EQ(rig.interp.parameters().get(5244), 3);
  (void)rig.mdi("G55");
  EXPECT_DOUBLE_EQ(rig.interp.modal().frame.g5x().x, 25.4);
  EXPECT_EQ(rig.interp.parameters().get(5220), 2);
}

TEST(Offsets, G92FamilyKeepsParametersInStep) {
  Rig rig;
  (void)rig.mdi("G0 X10");
  (void)rig.mdi("G92 X1");
  EXPECT_EQ(rig.debug("%d#5210 #5211 #5420"), "1 9 1");
  (void)rig.mdi("G92.2");
  EXPECT_EQ(rig.debug("%d#5210 #5211 #5420"), "0 9 10");
  (void)rig.mdi("G92.3");
  EXPECT_EQ(rig.debug("%d#5210 #5211 #5420"), "1 9 1");
  (void)rig.mdi("G92.1");
  EXPECT_EQ(rig.debug("%d#5210 #5211 #5420"), "0 0 10");
  (void)rig.mdi("G52 X3");
  EXPECT_EQ(rig.debug("%d#5210 #5211 #5420"), "1 3 7");
}

TEST(Offsets, ReferencePointByWayOfTheWords) {
  Rig rig;
  (void)rig.mdi("G0 X5 Y6 Z7");
  (void)rig.mdi("G28.1");
  (void)rig.mdi("G0 X0 Y0 Z0");
  EXPECT_EQ(rig.mdi("G91 G28 Z1"),
            "COMMENT(\"interpreter: distance mode changed to incremental\")\n"
            "STRAIGHT_TRAVERSE(0.0000, 0.0000, 1.0000, 0.0000, 0.0000, 0.0000)\n"
            "STRAIGHT_TRAVERSE(0.0000, 0.0000, 7.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(rig.debug("%d#5161 #5162 #5163"), "5 6 7");
}

TEST(Tools, OffsetsMoveTheProgramNotTheMachine) {
  Rig rig;
  rig.world.files.set_tool(tool(2, 5, 10));
  (void)rig.mdi("G0 Z30");
  EXPECT_EQ(rig.mdi("G43 H2"),
            "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 10.0000, 0.0000 0.0000 0.0000, 0.0000 0.0000 "
            "0.0000)\n");
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.z, 20);
  (void)rig.mdi("G43.2 Z1");
  EXPECT_DOUBLE_EQ(rig.interp.modal().frame.tool().z, 11);
  (void)rig.mdi("G43.1 X2");
  EXPECT_DOUBLE_EQ(rig.interp.modal().frame.tool().x, 2);
  EXPECT_EQ(rig.interp.modal().active_g_codes()[9], 431);
  (void)rig.mdi("G49");
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.z, 30);
}

TEST(Tools, ChangeWaitsForTheMachineAndBelievesIt) {
  Rig rig;
  rig.world.files.set_tool(tool(2, 5, 10));
  rig.world.files.set_tool(tool(3, 7, 20));
  ASSERT_EQ(rig.interp.execute_mdi("T2 M6"), Outcome::needs_sync);
  EXPECT_EQ(rig.interp.sync_reason(), SyncReason::tool_change);
  EXPECT_EQ(rig.calls(), "SELECT_TOOL(2)\nSTOP_SPINDLE_TURNING(0)\nCHANGE_TOOL()\n");
  rig.interp.synchronize({.tool_in_spindle = 3, .pocket_in_spindle = 7});
  EXPECT_EQ(rig.interp.execute_next(), Outcome::idle);
  EXPECT_EQ(rig.debug("%d#5400 #5403 #<_current_pocket>"), "3 20 7");
  (void)rig.mdi("G43");
  EXPECT_DOUBLE_EQ(rig.interp.modal().frame.tool().z, 20);
}

TEST(Tools, G10WritesTheTableAndTheToolInTheSpindle) {
  Rig rig;
  rig.world.files.set_tool(tool(2, 5, 10));
  (void)rig.mdi("M61 Q2");
  EXPECT_EQ(rig.mdi("G10 L1 P2 Z12 R3 Q4"),
            "SET_TOOL_TABLE_ENTRY(5, 2, 0.0000 0.0000 12.0000 0.0000 0.0000 0.0000 0.0000 0.0000 "
            "0.0000, 0.0000, 0.0000, 4)\n");
  EXPECT_EQ(rig.debug("%d#5400 #5403 #5410 #5413"), "2 12 6 4");
  (void)rig.mdi("G0 Z50");
  (void)rig.mdi("G10 L10 P2 Z8");
  EXPECT_EQ(rig.debug("%d#5403"), "42");
}

TEST(Cycles, DrillReturnsToTheRPlaneOrTheOldLevel) {
  Rig rig;
  (void)rig.mdi("G0 Z5 F100");
  (void)rig.mdi("G81 X1 Z-1 R1");
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.z, 1);
  (void)rig.mdi("G98 X2");
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.z, 5) << "level before the first cycle";
}

TEST(Cycles, RepeatsAreOneBlockEach) {
  Rig rig;
  (void)rig.mdi("G0 Z5 F100");
  (void)rig.mdi("G91");
  ASSERT_EQ(rig.interp.execute_mdi("G81 X1 R0 Z-1 L1000000000"), Outcome::ok);
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_DOUBLE_EQ(rig.interp.modal().position.x, 2);
  rig.interp.abort();
  EXPECT_EQ(rig.interp.execute_next(), Outcome::idle);
}

TEST(Cycles, PecksAreBounded) {
  Rig rig;
  EXPECT_EQ(rig.mdi("F1 G83 X1 R0 Z-100 Q.000001"), "error: Too many pecks in one cycle");
}

TEST(Spindles, DollarChoosesAndMinusOneIsAll) {
  Settings s;
  s.spindles = 3;
  Rig rig(s);
  EXPECT_EQ(rig.mdi("S100 $1"), "SET_SPINDLE_SPEED(1, 100.0000)\n");
  EXPECT_EQ(rig.mdi("M3 $-1"),
            "START_SPINDLE_CLOCKWISE(0)\nSTART_SPINDLE_CLOCKWISE(1)\nSTART_SPINDLE_CLOCKWISE(2)\n");
  EXPECT_EQ(rig.mdi("M4 $1"), "START_SPINDLE_COUNTERCLOCKWISE(1)\n");
  EXPECT_EQ(rig.mdi("M5"), "STOP_SPINDLE_TURNING(0)\n");
  EXPECT_EQ(rig.interp.modal().direction[1], SpindleDirection::counterclockwise);
  EXPECT_EQ(rig.mdi("M3 $3"),
            "error: Spindle ($) number out of range in M3 Command\nnum_spindles =3. $=3");
}

TEST(Spindles, OrientAddsTheOffset) {
  Settings s;
  s.orient_offset_deg = 300;
  Rig rig(s);
  EXPECT_EQ(rig.mdi("M19 R90 Q2 P1"),
            "ORIENT_SPINDLE(0, 390.0000, 1)\nSPINDLE.0.WAIT_ORIENT_COMPLETE(2.0000)\n");
  EXPECT_EQ(rig.interp.modal().active_m_codes()[2], 19);
  (void)rig.mdi("M5");
  EXPECT_EQ(rig.interp.modal().active_m_codes()[2], 5);
}

TEST(Inputs, M66WaitsAndSetsTheParameter) {
  Rig rig;
  ASSERT_EQ(rig.interp.execute_mdi("M66 P0 L3 Q5"), Outcome::needs_sync);
  EXPECT_EQ(rig.interp.sync_reason(), SyncReason::wait_input);
  rig.interp.synchronize({.input_value = -1});
  EXPECT_EQ(rig.debug("%d#5399"), "-1");
}

TEST(Probe, ResultIsInProgramCoordinates) {
  Rig rig;
  (void)rig.mdi("G10 L2 P1 Z10");
  ASSERT_EQ(rig.interp.execute_mdi("G38.3 Z-20 F50"), Outcome::needs_sync);
  EXPECT_EQ(rig.interp.sync_reason(), SyncReason::probe);
  Pose tripped;
  tripped.z = 3;
  Pose stopped;
  stopped.z = 2.5;
  rig.interp.synchronize(
      {.machine_position = stopped, .probe = ExternalState::Probe{tripped, true}});
  EXPECT_EQ(rig.debug("%.1f#5063 #5070 #5422"), "-7.0 1.0 -7.5");
}

TEST(UserCodes, PassTheirWordsOrMinusOne) {
  Rig rig;
  rig.world.mcodes[101] = {"/x/M101", ""};
  rig.world.mcodes[102] = {"", "/x/M102 is not executable"};
  EXPECT_EQ(rig.mdi("M101 P2.5"), "USER_DEFINED_FUNCTION(101, 2.500000, -1.000000)\n");
  EXPECT_EQ(rig.mdi("M102"), "error: Unknown m code used: M102");
  EXPECT_EQ(rig.interp.error().help, "/x/M102 is not executable");
}

TEST(SavedState, M72BringsAllModesButTheMotionBack) {
  Rig rig;
  const std::string out = rig.run(
      "F100 S50 G64 P.2\nM70\nG20 G18 G91 G93 G55 G43.1 Z1\nG98 G96 D100 S200\nG90.1 G7 G61 G0 X1\n"
      "M3\nM7\nM8\nM51 P0\nM50 P0\nM52\nM53 P0\nM72\n(abort,x)\n");
  const ModalState& s = rig.interp.modal();
  Rig fresh;
  (void)fresh.mdi("F100 S50 G64 P.2");
  auto codes = s.active_g_codes(), expected = fresh.interp.modal().active_g_codes();
  codes[0] = expected[0] = 0;
  expected[1] = 0;  // G0 stays
  EXPECT_EQ(codes, expected);
  auto m = s.active_m_codes(), m_expected = fresh.interp.modal().active_m_codes();
  m[0] = m_expected[0] = 0;
  EXPECT_EQ(m, m_expected);
  EXPECT_EQ(s.feed, 100);
  EXPECT_EQ(s.speed_rpm[0], 50);
  EXPECT_EQ(s.tolerance_mm, 0.2);
  EXPECT_EQ(rig.mdi("M72"),
            "error: Cannot restore context from invalid stack frame - missing M70/M73?")
      << "MDI is a level of its own";
}

TEST(SavedState, M72BringsCutterCompensationBack) {
  struct Row {
    const char* before;
    int code;
  };
  for (const Row& row : {Row{"G40", 400}, Row{"G41.1 D2", 410}, Row{"G42.1 D2", 420},
                         Row{"G41 D7", 410}, Row{"G42 D7", 420}}) {
    for (const char* inside : {"G40\n", "G40\nG42.1 D4\n", "G40\nG41 D7\n"}) {
      Rig rig;
      Tool tool;
      tool.number = 7;
      tool.pocket = 7;
      tool.diameter_mm = 3;
      rig.world.files.set_tool(tool);
      const std::string out =
          rig.run(std::string("G21 F100\n") + row.before + "\nM70\n" + inside + "M72\n(abort,x)\n");
      EXPECT_EQ(out.substr(out.size() - 8), "error: x") << row.before << inside << out;
      EXPECT_EQ(rig.interp.modal().cutter_comp, row.code) << row.before << inside;
    }
  }
}

TEST(SavedState, M72KeepsTheDiameterOfD) {
  for (const char* before : {"G41.1 D2", "G42.1 D5.5", "G41.1 D-2", "G42 D7", "G41", "G42 D0"}) {
    for (const char* inside : {"G40\n", "G40\nG42.1 D4\n", "G40\nG41 D9\n", "G40\nG41\n"}) {
      Rig rig, straight;
      for (const auto& [number, diameter] : {std::pair{7, 3.0}, {9, 8.0}}) {
        Tool tool;
        tool.number = tool.pocket = number;
        tool.diameter_mm = diameter;
        rig.world.files.set_tool(tool);
        straight.world.files.set_tool(tool);
      }
      const std::string out = rig.run(std::string("G21 F100\n") + before + "\nM70\n" + inside +
                                      "M72\nG1 X10\nG1 Y-10\nX-20\nM70\nG40\n(abort,x)\n");
      const std::string expected = straight.run(std::string("G21 F100\n") + before +
                                                "\nG1 X10\nG1 Y-10\nX-20\nM70\nG40\n(abort,x)\n");
      const auto moves = [](const std::string& text) {
        std::string found;
        for (std::size_t at = 0; (at = text.find("STRAIGHT_FEED", at)) != std::string::npos; ++at)
          found += text.substr(at, text.find('\n', at) - at) + "\n";
        return found;
      };
      EXPECT_EQ(moves(out), moves(expected)) << before << inside << out;
      EXPECT_NE(moves(out).find("STRAIGHT_FEED"), std::string::npos) << out;
    }
  }
}

// The example of the manual.
TEST(SavedState, NamedParametersShowTheModesAroundACall) {
  Rig rig;
  const std::string show =
      "(debug,imperial=%d#<_imperial> absolute=%d#<_absolute> feed=%d#<_feed> rpm=%d#<_rpm>)\n";
  const std::string out =
      rig.run("O<showstate> sub\n" + show + "O<showstate> endsub\nO<imperialsub> sub\n" +
              "G20\nG91\nF5\nS300\n(debug,in subroutine, state now:)\no<showstate> call\n" +
              "O<imperialsub> endsub\ng21\ng90\nf200\nS2500\n(debug,in main, state now:)\n" +
              "o<showstate> call\nM70\nO<imperialsub> call\nM72\n(debug,back in main)\n" +
              "o<showstate> call\nm2\n");
  std::string said;
  for (std::size_t at = 0; (at = out.find("MESSAGE(\"", at)) != std::string::npos;) {
    at += 9;
    said += out.substr(at, out.find('"', at) - at) + "\n";
  }
  EXPECT_EQ(said,
            "in main, state now:\nimperial=0 absolute=1 feed=200 rpm=2500\n"
            "in subroutine, state now:\nimperial=1 absolute=0 feed=5 rpm=300\n"
            "back in main\nimperial=0 absolute=1 feed=200 rpm=2500\n");
}

TEST(SavedState, M73RestoresOnReturnAndM71Forgets) {
  const std::string sub = "o1 sub\nM73\nG20 G91\nF5\n%o1 endsub\nG21 F100\no1 call\n(abort,x)\n";
  for (const std::string& extra :
       {std::string(), std::string("o1 return\n"), std::string("M71\n")}) {
    Rig rig;
    std::string program = sub;
    (void)rig.run(program.replace(program.find('%'), 1, extra));
    const bool forgot = extra == "M71\n";
    EXPECT_EQ(rig.interp.modal().units, forgot ? Units::inch : Units::mm) << extra;
    EXPECT_EQ(rig.interp.modal().feed, forgot ? 127 : 100) << extra;
  }
}

TEST(SavedState, AnAbortInTheSubDoesNotRestore) {
  Rig rig;
  (void)rig.run("o1 sub\nM73\nG91\n(abort,x)\no1 endsub\no1 call\n");
  rig.interp.abort();
  EXPECT_EQ(rig.interp.modal().distance, DistanceMode::incremental);
  EXPECT_EQ(rig.interp.call_level(), 0);
}

TEST(ProgramEnd, RestoresTheDocumentedModes) {
  Rig rig;
  const std::string calls = rig.run("G55 G18 G91 G93 M3 S10 M8 M49\nG92 X1\nM2\n");
  const ModalState& s = rig.interp.modal();
  EXPECT_EQ(s.coord_system, 1);
  EXPECT_EQ(s.plane_code, 170);
  EXPECT_EQ(s.distance, DistanceMode::absolute);
  EXPECT_EQ(s.feed_mode, ProgramFeedMode::per_minute);
  EXPECT_EQ(s.motion, 10);
  EXPECT_TRUE(s.feed_override && s.speed_override[0]);
  EXPECT_EQ(s.direction[0], SpindleDirection::stopped);
  EXPECT_FALSE(s.flood);
  EXPECT_TRUE(s.g92_applied) << "G92 stays unless DISABLE_G92_PERSISTENCE";
  EXPECT_NE(calls.find("PROGRAM_END()"), std::string::npos);
}

TEST(ProgramEnd, KeysOfTheIniChangeIt) {
  Settings s;
  s.disable_g92_persistence = s.disable_auto_g54 = true;
  Rig rig(s);
  (void)rig.run("G55\nG92 X1\nM2\n");
  EXPECT_EQ(rig.interp.modal().coord_system, 2);
  EXPECT_FALSE(rig.interp.modal().g92_applied);
}

}  // namespace
}  // namespace kerf::interp
