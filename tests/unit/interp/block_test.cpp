// What a line may say: errors come before any call and leave no trace.
#include <gtest/gtest.h>

#include "interp/source.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

struct Wrong {
  const char* line;
  const char* text;
};

class RefusedBlocks : public ::testing::TestWithParam<Wrong> {};

TEST_P(RefusedBlocks, MakeNoCallAndKeepTheState) {
  Rig rig;
  rig.world.files.set_tool({1, 1, {}, 6, 0, 0, 0});
  (void)rig.mdi("G0 X3 Z5");
  (void)rig.mdi("#1=4");
  const ModalState before = rig.interp.modal();
  EXPECT_EQ(rig.mdi(GetParam().line), std::string("error: ") + GetParam().text);
  const ModalState& after = rig.interp.modal();
  EXPECT_EQ(after.position, before.position);
  EXPECT_EQ(after.active_g_codes(), before.active_g_codes());
  EXPECT_EQ(after.active_m_codes(), before.active_m_codes());
  EXPECT_EQ(after.frame, before.frame);
  EXPECT_EQ(rig.interp.parameters().get(1), 4);
  EXPECT_EQ(rig.interp.error().file, "");
}

INSTANTIATE_TEST_SUITE_P(
    Peer, RefusedBlocks,
    ::testing::Values(
        Wrong{"G1 X5", "Cannot do g1 with zero feed rate"},
        Wrong{"G81 X1 Z-1 R1", "Cannot feed with zero feed rate"},
        Wrong{"G38.2 X1", "Cannot probe with zero feed rate"},
        Wrong{"G0 G1 X1", "Two g codes used from same modal group"},
        Wrong{"M3 M4", "Two m codes used from same modal group"},
        Wrong{"M3 M19", "Two m codes used from same modal group"},
        Wrong{"G0 X1 X2", "Multiple x words on one line"},
        Wrong{"N12 N13 G0", "Bad character 'n' used"},
        Wrong{"F9 G2 X5", "R i j k words all missing for arc"},
        Wrong{"F9 G3 X4 Y1 R0.2", "Arc radius too small to reach end point"},
        Wrong{"F9 G2 X3 Y0 R1", "Current point same as end point of arc"},
        Wrong{"F9 G2 X1 R1 I1", "Mixed radius ijk format for arc"},
        Wrong{"F9 G19 G2 X1 I1", "I word given for arc in yz plane"},
        Wrong{"F9 G2 I0",
              "Zero-radius arc: start=(X3.0000,Y0.0000) center=(X3.0000,Y0.0000) "
              "end=(X3.0000,Y0.0000) r1=0.0000 r2=0.0000"},
        Wrong{"T1.5", "Non integer value for integer"}, Wrong{"N-1", "Bad format unsigned integer"},
        Wrong{"G999", "G-code out of range"}, Wrong{"G12 X1", "Unknown g code used"},
        Wrong{"G1.5 X1", "Unknown g code used"}, Wrong{"M199", "Unknown m code used: M199"},
        Wrong{"M999", "M-code greater than 199: M999"}, Wrong{"G-1", "Negative g code used"},
        Wrong{"M-1", "Negative m code used"},
        Wrong{"G0 X1 E1", "E word with no G70, G76, M66, M67 or M68 to use it"},
        Wrong{"G0 X1 R1", "R word with no g code that uses it"},
        Wrong{"G0 X1 H1", "H word with no G43 or G76 to use it"},
        Wrong{"S-5", "Negative spindle speed used"}, Wrong{"F-1", "Negative f word used"},

        Wrong{"G80 X1", "Cannot use axis values with g80"},
        Wrong{"G92", "All axes missing with g52 or g92"},
        Wrong{"G38.2 F10", "All axes missing with motion code"},
        Wrong{"G91 G53 G0 X1", "Cannot use g53 incremental"},
        Wrong{"G53 G81 X1 Z-1 R1 F1", "Must use g0 or g1 with g53"},
        Wrong{"G81", "All axes missing with motion code"},
        Wrong{"G92 @1", "Polar coordinates can only be used for motion"},
        Wrong{"G4", "Dwell time missing with g4"},
        Wrong{"G10 L9 P1", "Line with G10 does not have L0, L1, L10, L11, L2, or L20"},
        Wrong{"G10 L2 P10", "P value out of range (0-9) with G10 L2"},
        Wrong{"G10 L20 P11", "P value out of range (0-9) with G10 L20"},
        Wrong{"G10 L1 P0", "P value out of range with G10 L1"},
        Wrong{"G10 L1 P99", "Requested tool 99 not found in the tool table"},
        Wrong{"G10 L1 P1 Q11", "Invalid tool orientation"},
        Wrong{"T99", "Requested tool 99 not found in the tool table"},
        Wrong{"G43 H77", "Requested tool 77 not found in the tool table"},
        Wrong{"M61 Q99", "Requested tool 99 not found in the tool table"},
        Wrong{"T-1", "Negative tool id (tool not found)"},
        Wrong{"M61", "Need non-negative Q-word to specify tool number with M61"},
        Wrong{"M64", "No valid P word with M64"},
        Wrong{"M66", "Need to have either a valid P or a valid E word with M66"},
        Wrong{"M66 P0 L1", "Zero timeout with wait type != immediate return"},
        Wrong{"M66 P0 L3 Q0", "Zero timeout with wait type != immediate return"},
        Wrong{"M66 P0 E0", "Invalid to select both a digital and an analog input with M66"},
        Wrong{"M66 E0 L2 Q1", "Can't select analog input with wait type != immediate return"},
        Wrong{"M19 R400", "R value must be within 0..360 with M19"},
        Wrong{"M68 Q1", "Invalid analog index with M68"},
        Wrong{"F1 G81 X1 R1", "Z value unspecified in xy plane canned cycle"},
        Wrong{"F1 G81 X1 Z5 R1", "R less than z in cycle in xy plane"},
        Wrong{"F1 G81 X1 Z1 R2 L0", "Cannot do zero repeats of cycle"},
        Wrong{"F1 G82 X1 Z1 R2", "Dwell time p word missing with g82"},
        Wrong{"F1 G73 X1 Z1 R2", "Q word missing with g73"},
        Wrong{"F1 G83 X1 Z1 R2 Q0", "Negative or zero q value used"},
        Wrong{"G93 G1 X1", "F word missing with inverse time g1 move"},
        Wrong{"G96", "S word missing with G96"}, Wrong{"(a", "Unclosed comment found"},
        Wrong{"( a ( b )", "Nested comment found"}, Wrong{"G0 X1)", "Bad character ')' used"},
        Wrong{"(abort,stop here)", "stop here"},
        Wrong{"$9 M3", "Spindle ($) number out of range in M3 Command\nnum_spindles =1. $=9"},
        Wrong{"G10 L2 P1 X1 G0", "Cannot use two g codes that both use axis values"},
        Wrong{"o1 endwhile", "1: undefined O-word label: 'o1 endwhile'"},
        Wrong{"o1 return", "1: not in a subroutine definition: 'o1 return'"},
        Wrong{"o1 foo", "Unknown control command in o word"},
        Wrong{"M3 S100 G1 X1", "Cannot do g1 with zero feed rate"},
        Wrong{"#1=5 G1 X1", "Cannot do g1 with zero feed rate"},
        Wrong{"T1 M6 G1 X1", "Cannot do g1 with zero feed rate"},
        Wrong{"G54 G10 L2 P1 X5 M3 M8 (msg,hi) S-1", "Negative spindle speed used"}),
    [](const auto& row) { return "line" + std::to_string(row.index); });

TEST(Block, G80AloneIsNoErrorAndBesideAMoveNothing) {
  Rig rig;
  EXPECT_EQ(rig.mdi("X1"), "error: Cannot use axis values without a g code that uses them");
  EXPECT_EQ(rig.mdi("G80 G0 X1"), rig.mdi("G0 G80 X1"));
  EXPECT_EQ(rig.mdi("G80"), "COMMENT(\"interpreter: motion mode set to none\")\n");
}

TEST(Block, ErrorNamesTheWordsColumn) {
  Rig rig;
  (void)rig.mdi("G0 X1 ( a ) Y2 Q7");
  EXPECT_EQ(rig.interp.error().column, 16);
  EXPECT_NE(rig.interp.error().message().find("MDI:1:16: Q word with no G5"), std::string::npos);
  EXPECT_FALSE(rig.interp.error().help.empty());
}

TEST(Block, UnknownCodesAndNamesGetTheNearestKnownOnes) {
  Rig rig;
  (void)rig.mdi("G12 X1");
  EXPECT_EQ(rig.interp.error().help, "The nearest codes are G10 and G17");
  (void)rig.mdi("M54");
  EXPECT_EQ(rig.interp.error().help, "The nearest codes are M53 and M60");
  (void)rig.mdi("#<depth>=3");
  (void)rig.mdi("#1=#<dpeth>");
  EXPECT_NE(rig.interp.error().help.find("did you mean #<depth>?"), std::string::npos);
  (void)rig.mdi("#1=#<_metrc>");
  EXPECT_NE(rig.interp.error().help.find("#<_metric>"), std::string::npos);
}

TEST(Block, G0AndG1AloneSetTheModeWithAMoveToWhereTheMachineStands) {
  Rig rig;
  EXPECT_EQ(rig.mdi("G0"), "STRAIGHT_TRAVERSE(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(rig.mdi("G1"), "error: Cannot do g1 with zero feed rate");
  EXPECT_EQ(
      rig.mdi("G1 F10"),
      "SET_FEED_RATE(10.0000)\nSTRAIGHT_FEED(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
}

TEST(Block, WordsMayStandInAnyOrderWithBlanksAnywhere) {
  Rig rig;
  const std::string line = "STRAIGHT_TRAVERSE(10.0000, -0.5000, 0.0000, 0.0000, 0.0000, 0.0000)\n";
  EXPECT_EQ(rig.mdi("g0x 1 0 y-.5"), line);
  EXPECT_EQ(rig.mdi("\tY-.5 X10. g 0 0 (c)"), "COMMENT(\"c\")\n" + line);
  EXPECT_EQ(rig.mdi("G0 X10 Y-.5 ; x ( y"), line);
}

TEST(Block, CodesRunInTheDocumentedOrder) {
  Rig rig;
  EXPECT_EQ(rig.mdi("G1 X1 M8 M3 S10 F20 G21 G18 G91 (c) G4 P1 G61 M48"),
            "COMMENT(\"c\")\nSET_FEED_RATE(20.0000)\nSET_SPINDLE_SPEED(0, "
            "10.0000)\nSTART_SPINDLE_CLOCKWISE(0)\nFLOOD_ON()\n"
            "ENABLE_FEED_OVERRIDE()\nENABLE_SPEED_OVERRIDE(0)\nDWELL(1.0000)\nSELECT_PLANE(CANON_"
            "PLANE_XZ)\n"
            "USE_LENGTH_UNITS(CANON_UNITS_MM)\nSET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)\n"
            "COMMENT(\"interpreter: distance mode changed to incremental\")\n"
            "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
}

TEST(Block, BlockDeleteSkipsTheLineOnlyWhileOn) {
  Rig rig;
  EXPECT_NE(rig.mdi("/G0 X1"), "");
  rig.interp.set_block_delete(true);
  EXPECT_EQ(rig.mdi("/G0 X2"), "");
  EXPECT_EQ(rig.mdi("/ this is not even G-code ["), "");
}

TEST(Block, OnlyTheLastCommentActs) {
  Rig rig;
  EXPECT_EQ(rig.mdi("(msg,a)(b)"), "COMMENT(\"b\")\n");
  EXPECT_EQ(rig.mdi("(b) ( mSg , a )"), "MESSAGE(\" a \")\n");
  EXPECT_EQ(rig.mdi("(print,x=%d #5220 %.2f#5220)"), "x= 1 1.00\n");
  EXPECT_EQ(rig.mdi("#5599=0"), "");
  EXPECT_EQ(rig.mdi("(debug,x)"), "");
}

TEST(Block, LongLinesAreRefusedLongCommentsAreNot) {
  Rig rig;
  EXPECT_EQ(rig.mdi("(" + std::string(4000, 'x') + ")").substr(0, 9), "COMMENT(\"");
  EXPECT_EQ(rig.mdi(std::string(kLongestLine + 1, 'x')), "error: Command too long");
}

TEST(Block, MissingAxisIsNamed) {
  Settings s;
  s.axis_mask = 0x7;
  Rig rig(s);
  EXPECT_EQ(rig.mdi("G0 X1 A2"), "error: Bad character 'a' used");
}

}  // namespace
}  // namespace kerf::interp
