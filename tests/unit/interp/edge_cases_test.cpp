// Edge cases that users of other controls have met: what was decided here. tests/seeds/edge.tsv lists them all, with their tests.
#include <gtest/gtest.h>

#include "rig.hpp"

namespace kerf::interp {
namespace {

TEST(EdgeCases, UnitsStayAsTheLastProgramLeftThem) {
  // M2 does not touch G20 and G21 (the manual's list has neither), so a program should begin with its own.
  Rig rig;
  const char* const program = "G0 X1\nG20\nM2\n";
  (void)rig.run(program);
  EXPECT_NEAR(rig.interp.modal().position.x, 1, 1e-12);
  EXPECT_EQ(rig.interp.modal().units, Units::inch);
  (void)rig.run(program);
  EXPECT_NEAR(rig.interp.modal().position.x, 25.4, 1e-12);
}

TEST(EdgeCases, ASubCallBehindM66IsMade) {
  Rig rig;
  EXPECT_EQ(rig.run("o1 sub\n(debug,in the sub)\no1 endsub\nM66 P0 L0\no1 call\nM66 P0 L0\n"
                    "(debug,behind)\nM2\n")
                .substr(0, 40),
            "MESSAGE(\"in the sub\")\nMESSAGE(\"behind\")\n");
}

TEST(EdgeCases, InputsAndStopsInALoopOnTheFirstLineLoseNoLine) {
  Rig rig;
  ASSERT_TRUE(
      rig.interp
          .open_text("t.ngc",
                     "o1 while [#1 lt 3]\nM66 P0 L0\n#1=[#1+1]\n(debug,%d#1)\no1 endwhile\nM2\n")
          .ok());
  std::string lines;
  for (Outcome o = Outcome::ok; o == Outcome::ok || o == Outcome::needs_sync;) {
    o = rig.interp.execute_next();
    if (o == Outcome::needs_sync) rig.interp.synchronize({.input_value = 0});
    lines += std::to_string(rig.interp.modal().line);
  }
  EXPECT_EQ(lines, "123451234512345156");
  EXPECT_EQ(rig.calls().substr(0, 39), "MESSAGE(\"1\")\nMESSAGE(\"2\")\nMESSAGE(\"3\")\n");
}

TEST(EdgeCases, TheFirstMoveMayBeAHelix) {
  Rig rig;
  EXPECT_EQ(
      rig.mdi("F100 G2 X2 I1 Z-1"),
      "SET_FEED_RATE(100.0000)\nARC_FEED(2.0000, 0.0000, 1.0000, 0.0000, -1, -1.0000, 0.0000, "
      "0.0000, 0.0000)\n");
}

TEST(EdgeCases, SpeedAndFeedInARepeatBlockCount) {
  Rig rig;
  (void)rig.mdi("G0 Z5 F100 S500");
  (void)rig.mdi("G99 G81 X1 Z-1 R1");
  const std::string calls = rig.mdi("X2 F200 S900");
  const std::size_t feed = calls.find("SET_FEED_RATE(200.0000)");
  const std::size_t speed = calls.find("SET_SPINDLE_SPEED(0, 900.0000)");
  const std::size_t hole = calls.find("STRAIGHT_FEED(2.0000");
  EXPECT_NE(speed, std::string::npos) << calls;
  EXPECT_LT(feed, hole) << calls;
  EXPECT_LT(speed, hole) << calls;
  EXPECT_NE(hole, std::string::npos);
}

TEST(EdgeCases, NothingOfACycleFollowsAnAbort) {
  Rig rig;
  ASSERT_TRUE(
      rig.interp.open_text("t.ngc", "F100 G0 Z5\nG91 G99 G81 X1 Z-1 R-1 L5\nG0 X9\nM2\n").ok());
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  ASSERT_EQ(rig.interp.execute_next(), Outcome::ok);
  (void)rig.calls();
  rig.interp.abort();
  EXPECT_EQ(rig.calls(), "");
  EXPECT_EQ(rig.interp.next_line(), 1);
  EXPECT_EQ(rig.mdi("(debug,next)"), "MESSAGE(\"next\")\n");
}

TEST(EdgeCases, AFeedBeforeAnyPositionIsNoMove) {
  Rig rig;
  const std::string calls = rig.mdi("G1 F10000");
  EXPECT_EQ(calls.find("STRAIGHT_FEED(0.0000, 0.0000, 0.0000"), calls.find("STRAIGHT_FEED"))
      << calls;
  EXPECT_EQ(calls.substr(0, 27), "SET_FEED_RATE(10000.0000)\nS");
}

TEST(EdgeCases, ZeroOffsetsKeepTheirCommandActive) {
  Rig rig;
  Tool zero;
  zero.number = zero.pocket = 4;
  rig.world.files.set_tool(zero);
  (void)rig.mdi("G43 H4");
  EXPECT_EQ(rig.interp.modal().active_g_codes()[9], 430);
  (void)rig.mdi("G49");
  EXPECT_EQ(rig.interp.modal().active_g_codes()[9], 490);
}

TEST(EdgeCases, SwitchingG5210OffByHandIsNotTheEndOfAnOffset) {
  // The parameter belongs to G92; writing it changes what the next start reads, not what is applied.
  Rig rig;
  (void)rig.mdi("G92 X5");
  (void)rig.mdi("#5210=0");
  EXPECT_EQ(rig.mdi("G0 X5"),
            "STRAIGHT_TRAVERSE(5.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_TRUE(rig.interp.modal().g92_applied);
}

TEST(EdgeCases, MessagesAreNoBarriers) {
  Rig rig;
  for (const char* const line : {"(msg,text)", "(debug,text)", "(print,text)", "(log,text)",
                                 "(logopen,/tmp/x)", "(logclose)"})
    EXPECT_EQ(rig.interp.execute_mdi(line), Outcome::ok) << line;
}

TEST(EdgeCases, AnAbortCommentLeavesNothingBehind) {
  Rig rig;
  EXPECT_EQ(rig.mdi("(abort,enough)"), "error: enough");
  EXPECT_EQ(rig.mdi("G0 X1"),
            "STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n");
  EXPECT_EQ(rig.mdi("G4 P-1").substr(0, 6), "error:");
  EXPECT_EQ(rig.interp.error().text.find("enough"), std::string::npos);
}

TEST(EdgeCases, ALetterWithoutANumberIsAnErrorAtItsPlace) {
  Rig rig;
  EXPECT_EQ(rig.mdi("G4 P"), "error: No characters found in reading real value");
  EXPECT_EQ(rig.interp.error().column, 5);
}

TEST(EdgeCases, ATaskKnowsItselfAndAPreviewDoesNot) {
  Settings task;
  task.is_task = true;
  Rig machine(task), preview;
  EXPECT_EQ(machine.debug("%d#<_task>"), "1");
  EXPECT_EQ(preview.debug("%d#<_task>"), "0");
}

}  // namespace
}  // namespace kerf::interp
