// Comments that act. Manual: "Comments", "Messages", "Probe Logging", "Logging", "Comment Parameters".
#include <gtest/gtest.h>

#include "interp/parser.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

TEST(Comments, BehindASemicolonOnlyActiveOnesCount) {
  Rig rig;
  EXPECT_EQ(rig.mdi("G4 P1 ; just words, and a ( too"), "DWELL(1.0000)\n");
  EXPECT_EQ(rig.mdi("G4 P1 ; (msg,x)"), "DWELL(1.0000)\n");
  EXPECT_EQ(rig.mdi("G4 P1 ; msg,hello"), "MESSAGE(\"hello\")\nDWELL(1.0000)\n");
  EXPECT_EQ(rig.mdi(";DEBUG,%d#5399"), "MESSAGE(\"0\")\n");
  EXPECT_EQ(rig.mdi("(msg,a) ;Print,b"), "b\n")
      << "the last comment of a line is the one that acts";
  EXPECT_EQ(rig.mdi("(msg,a) ;b"), "MESSAGE(\"a\")\n")
      << "a plain one behind ; is no comment to act";
  EXPECT_EQ(rig.mdi("G4 P1 ;abort,stop"), "error: stop");
}

TEST(Comments, BlanksAndCapitalsMayStandInTheirNames) {
  Rig rig;
  EXPECT_EQ(rig.mdi("( M s G , x)"), "MESSAGE(\" x\")\n");
  EXPECT_EQ(rig.mdi("(MSG)"), "COMMENT(\"MSG\")\n");
  EXPECT_EQ(rig.mdi("(message,x)"), "COMMENT(\"message,x\")\n");
  EXPECT_EQ(rig.mdi("(debug)"), "COMMENT(\"debug\")\n");
}

TEST(Comments, FormatsHoldUntilTheNextOne) {
  Rig rig;
  (void)rig.mdi("#1=3.14159 #2=0.00002 #3=-0.00001");
  EXPECT_EQ(rig.debug("%d#1 %f#1 %.2f#1 #1 %lf#1"), "3 3.1416 3.14 3.14 %lf3.14");
  EXPECT_EQ(rig.debug("%.0f#1 %.9f#1"), "3 3.141590000");
  EXPECT_EQ(rig.debug("%5d#1 100% %"), "%5d3.141590 100% %");
  EXPECT_EQ(rig.debug("%.10f#1 %.3d#1 %."), ".10f3.141590 .3d3.141590 .");
  (void)rig.mdi("#4=[10**21] #5=[10**22]");
  EXPECT_EQ(rig.debug("#4 #5"), "1000000000000000000000.000000 ######");
  EXPECT_EQ(rig.debug("#2 #3"), "0.000000 0.000000");
  EXPECT_EQ(rig.debug("#<nope> #9999 #"), "###### ###### #");
}

TEST(Comments, DebugIsOffWhile5599IsZero) {
  Rig rig;
  EXPECT_EQ(rig.mdi("#5599=0"), "");
  EXPECT_EQ(rig.mdi("(debug,x)"), "");
  EXPECT_EQ(rig.mdi("(print,x)"), "x\n");
}

TEST(Comments, ProbeFileIsNamedBehindABlankOrAComma) {
  EXPECT_EQ(probe_file("probeopen file.txt"), "file.txt");
  EXPECT_EQ(probe_file("PROBEOPEN,  a b.txt "), "a b.txt");
  EXPECT_EQ(probe_file("probeopen  "), "");
  Rig rig;
  EXPECT_EQ(rig.mdi("(probeopen x.txt)"), "COMMENT(\"probeopen x.txt\")\n");
  EXPECT_EQ(rig.mdi("(PROBECLOSE)"), "COMMENT(\"PROBECLOSE\")\n");
}

TEST(Comments, PythonWithoutPythonIsIgnoredWithAWarning) {
  Rig rig;
  EXPECT_EQ(rig.mdi("(py,x=1)"), "");
  EXPECT_EQ(rig.mdi(";py,print(1)"), "");
  ASSERT_EQ(rig.world.warnings.size(), 2U);
  EXPECT_EQ(rig.world.warnings[1],
            "a py comment is ignored: the machine has no Python ([PYTHON]TOPLEVEL)");
}

TEST(Comments, AMistakeInsideIsFoundWhateverTheyAre) {
  Rig rig;
  EXPECT_EQ(rig.mdi("G4 P1 (a (b) c)"), "error: Nested comment found");
  EXPECT_EQ(rig.mdi("G4 P1 (a"), "error: Unclosed comment found");
  EXPECT_EQ(rig.mdi("G4 P1 a)"), "error: bad number format (conversion failed) parsing ')'");
  EXPECT_EQ(rig.mdi("G4 P1 )"), "error: Bad character ')' used");
}

TEST(Comments, AbortWithoutAReasonIsStillAnError) {
  Rig rig;
  EXPECT_EQ(rig.mdi("(abort,)"), "error: (abort,) without a reason");
  EXPECT_EQ(rig.mdi("(abort,no stock)"), "error: no stock");
}

}  // namespace
}  // namespace kerf::interp
