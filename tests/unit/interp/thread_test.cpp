// G33, G33.1, G76 against the limits of the machine (the calls themselves are in tests/golden/interp/threads).
#include <gtest/gtest.h>

#include "rig.hpp"

namespace kerf::interp {
namespace {

/// X and Z may do 50 mm/s.
Settings limited() {
  Settings s;
  s.axis_max_per_s[0] = s.axis_max_per_s[2] = 50;
  return s;
}

TEST(ThreadLimits, PitchTimesSpeedAboveTheAxisLimitIsRefusedBeforeMotion) {
  Rig rig(limited());
  (void)rig.mdi("G18 S1500 M3");
  EXPECT_EQ(rig.mdi("G33 Z-20 K2.0"),
            "START_SPEED_FEED_SYNC(2.000000,0)\nSTRAIGHT_FEED(0.0000, 0.0000, -20.0000, 0.0000, "
            "0.0000, 0.0000)\nSTOP_SPEED_FEED_SYNCH()\n");
  EXPECT_EQ(rig.mdi("G33 Z-40 K2.01"),
            "error: G33 needs 3015.0000 per minute of axis Z at 1500.0 rpm, more than its limit "
            "3000.0000");
  EXPECT_EQ(rig.mdi("G33.1 Z-40 K2.01").substr(0, 18), "error: G33.1 needs");
  EXPECT_EQ(rig.mdi("G76 P2.01 Z-40 I-2 J.5 K1").substr(0, 16), "error: G76 needs");
}

TEST(ThreadLimits, AReturnFasterThanTheWayInCounts) {
  Rig rig(limited());
  (void)rig.mdi("S1000 M3");
  EXPECT_EQ(rig.mdi("G33.1 Z-4 K2 I1.5").find("error"), std::string::npos);
  EXPECT_EQ(rig.mdi("G33.1 Z-4 K2 I1.6").substr(0, 18), "error: G33.1 needs");
}

TEST(ThreadLimits, ATaperedThreadCountsEachAxisForItself) {
  Rig rig(limited());
  (void)rig.mdi("G18 S1500 M3");
  // K counts along the drive line: at 45 degrees each axis does 1/sqrt(2) of it.
  EXPECT_EQ(rig.mdi("G33 X10 Z-10 K2.8").find("error"), std::string::npos);
  EXPECT_NE(rig.mdi("G33 X0 Z-20 K2.9").find("error"), std::string::npos);
}

TEST(ThreadLimits, SurfaceSpeedCountsAtTheSmallestRadius) {
  Rig rig(limited());
  (void)rig.mdi("G18 G0 X10");
  (void)rig.mdi("G96 S100 D3000 M3");  // 1591.5 rpm at X10
  EXPECT_EQ(rig.mdi("G33 Z-5 K1.8").find("error"), std::string::npos);
  EXPECT_NE(rig.mdi("G33 X5 Z-10 K1.8").find("at 3000.0 rpm"), std::string::npos);
  (void)rig.mdi("G96 S100");
  EXPECT_NE(rig.mdi("G33 X0 Z-10 K1.8").find("without a speed limit"), std::string::npos);
  EXPECT_NE(rig.mdi("G33 X-1 Z-10 K1.8").find("without a speed limit"), std::string::npos);
}

TEST(ThreadLimits, TheSpindlesOwnMaximumCounts) {
  Settings s = limited();
  s.spindle_max_rpm[0] = 1000;
  Rig rig(s);
  (void)rig.mdi("G18 S5000 M3");
  EXPECT_EQ(rig.mdi("G33 Z-5 K3").find("error"), std::string::npos);
  EXPECT_NE(rig.mdi("G33 Z-10 K3.1").find("at 1000.0 rpm"), std::string::npos);
}

TEST(Thread, FollowsTheSpindleThatItNames) {
  Settings s;
  s.spindles = 2;
  Rig rig(s);
  (void)rig.mdi("G18 S100 M3 $1");
  EXPECT_EQ(rig.mdi("G33 Z-1 K1"), "error: Spindle not turning in G33");
  EXPECT_EQ(rig.mdi("G33 Z-1 K1 $1").find("error"), std::string::npos);
  EXPECT_EQ(rig.mdi("G76 P1 Z-5 I-1 J.2 K.5 $1").find("error"), std::string::npos);
  EXPECT_EQ(rig.mdi("G76 P1 Z-5 I-1 J.2 K.5"), "error: Chosen spindle (0) not turning in G76");
}

TEST(Thread, WordsThatMeanNothingAreRefused) {
  Rig rig;
  (void)rig.mdi("G18 S0 M3");
  EXPECT_EQ(rig.mdi("G33 Z-1 K1"), "error: Spindle not turning in G33");
  (void)rig.mdi("S100 M3");
  for (const char* line :
       {"G33.1 Z-1 K1 I0", "G33.1 Z-1 K1 I-1", "G33.1 Z-1 A3 K1", "G76 P0 Z-5 I-1 J.2 K.5",
        "G76 P1 Z-5 I-1 J.2 K.5 L4 E1", "G76 P1 Z-5 I-1 J.2 K.5 L1", "G76 P1 Z-5 I-1 J.2 K.5 Q90",
        "G76 P1 Z-5 I-1 J.0001 K.5 R3"})
    EXPECT_EQ(rig.mdi(line).substr(0, 7), "error: ") << line;
}

}  // namespace
}  // namespace kerf::interp
