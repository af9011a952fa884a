// Lines that come one by one, as from a serial sender: one line in, one answer out.
#include <gtest/gtest.h>
#include <malloc.h>

#include "interp/core.hpp"
#include "interp/null_canon.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

class Sender : public ::testing::Test {
 protected:
  void SetUp() override { rig.interp.open_stream("sender"); }
  /// The answer to one line: "ok", "error: TEXT", "end", with the calls before.
  std::string send(std::string_view line) {
    EXPECT_TRUE(rig.interp.push_line(line).ok());
    for (;;) {
      switch (rig.interp.execute_next()) {
        case Outcome::ok: continue;
        case Outcome::needs_sync: rig.interp.synchronize({.input_value = 7}); continue;
        case Outcome::needs_line: return rig.calls() + "ok";
        case Outcome::program_end: return rig.calls() + "end";
        case Outcome::idle: return "idle";
        case Outcome::error: return rig.calls() + "error: " + rig.interp.error().text;
      }
    }
  }
  Rig rig;
};

TEST_F(Sender, GetsAnAnswerToEachLineAndTheStateStays) {
  EXPECT_EQ(send("G21 G91"),
            "USE_LENGTH_UNITS(CANON_UNITS_MM)\nCOMMENT(\"interpreter: distance mode changed to "
            "incremental\")\nok");
  EXPECT_EQ(send("G0 X1\r\n"),
            "STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\nok");
  EXPECT_EQ(send(""), "ok");
  EXPECT_EQ(send("#1=5"), "ok");
  EXPECT_EQ(send("G1 X1"), "error: Cannot do g1 with zero feed rate");
  EXPECT_EQ(rig.interp.error().line, 5);
  EXPECT_EQ(rig.interp.error().file, "sender");
  EXPECT_EQ(send("G0 X#1"),
            "STRAIGHT_TRAVERSE(6.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\nok");
  EXPECT_EQ(send("M66 P0 L0"), "ok");
  EXPECT_EQ(rig.interp.parameters().get(5399), 7);
}

TEST_F(Sender, LoopsAndSubsWorkOverLines) {
  EXPECT_EQ(send("o1 while [#1 lt 3]"), "ok");
  EXPECT_EQ(send("#1=[#1+1]"), "ok");
  EXPECT_EQ(send("(debug,%d#1)"), "MESSAGE(\"1\")\nok");
  EXPECT_EQ(send("o1 endwhile"), "MESSAGE(\"2\")\nMESSAGE(\"3\")\nok");
  EXPECT_EQ(send("o<twice> sub"), "ok");
  EXPECT_EQ(send("(debug,%d#1)"), "ok");
  EXPECT_EQ(send("o<twice> endsub [2*#1]"), "ok");
  for (int i = 0; i < 100; ++i) EXPECT_EQ(send("(a line)"), "COMMENT(\"a line\")\nok");
  EXPECT_EQ(send("o<twice> call [4]"), "MESSAGE(\"4\")\nok");
  EXPECT_EQ(send("o<twice> call [#<_value>]"), "MESSAGE(\"8\")\nok");
  EXPECT_EQ(send("o2 if [0]"), "ok");
  EXPECT_EQ(send("(debug,never)"), "ok");
  EXPECT_EQ(send("o2 else"), "ok");
  EXPECT_EQ(send("o<none> call"),
            "error: EOF in file:sender seeking o-word: o<none> from line: 113");
  EXPECT_EQ(send("o2 endif"), "ok");
}

TEST_F(Sender, AProgramsEndAndAnAbortLetTheNextLineCome) {
  EXPECT_EQ(send("G0 X1").substr(0, 17), "STRAIGHT_TRAVERSE");
  EXPECT_TRUE(send("M2").ends_with("end"));
  EXPECT_EQ(send("%"), "ok");
  EXPECT_EQ(send("(debug,again)"), "MESSAGE(\"again\")\nok");
  EXPECT_TRUE(send("%").ends_with("end"));
  // What waits is dropped, and the loop that it was in.
  EXPECT_EQ(send("o1 while [1]"), "ok");
  ASSERT_TRUE(rig.interp.push_line("(debug,first)").ok());
  ASSERT_TRUE(rig.interp.push_line("(debug,second)").ok());
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  rig.interp.abort();
  EXPECT_EQ(rig.calls(), "MESSAGE(\"first\")\n");
  EXPECT_EQ(send("(debug,third)"), "MESSAGE(\"third\")\nok");
  EXPECT_EQ(send("G0 Q1").substr(0, 6), "error:");
  EXPECT_EQ(rig.interp.error().line, 10);
}

TEST_F(Sender, MdiLinesStandBetween) {
  EXPECT_EQ(send("#1=4"), "ok");
  EXPECT_EQ(rig.mdi("(debug,%d#1)"), "MESSAGE(\"4\")\n");
  EXPECT_EQ(send("(debug,%d#1 there)"), "MESSAGE(\"4 there\")\nok");
}

TEST_F(Sender, TheEndOfTheStreamIsThatOfAFile) {
  EXPECT_EQ(send("o1 if [0]"), "ok");
  rig.interp.end_stream();
  EXPECT_EQ(rig.interp.execute_next(), Outcome::error);
  EXPECT_EQ(rig.interp.error().text, "File ended with no percent sign (%) or program end (M2)");
  EXPECT_EQ(rig.interp.error().line, 1);
}

TEST(Stream, OnlyItsOwnLinesAreTaken) {
  Rig rig;
  EXPECT_FALSE(rig.interp.push_line("G0 X1").ok());
  ASSERT_TRUE(rig.interp.open_text("t.ngc", "M2\n").ok());
  EXPECT_FALSE(rig.interp.push_line("G0 X1").ok());
}

TEST(Stream, EndlessOnesTakeNoMemory) {
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  interp.open_stream("endless");
  const auto send = [&](const char* line) {
    ASSERT_TRUE(interp.push_line(line).ok());
    Outcome o = Outcome::ok;
    while (o == Outcome::ok) o = interp.execute_next();
    ASSERT_EQ(o, Outcome::needs_line) << line << interp.error().text;
  };
  std::size_t before = 0;
  for (int i = 0; i < 60000; ++i) {
    if (i == 20000) before = ::mallinfo2().uordblks;
    send("o1 repeat [2]");
    send("G1 X[#1+1] F100");
    send("o1 endrepeat");
  }
  EXPECT_LT(::mallinfo2().uordblks, before + 2000000);
}

TEST(Stream, ALoopThatCannotBeKeptIsRefused) {
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  interp.open_stream("long");
  ASSERT_TRUE(interp.push_line("o1 while [0]").ok());
  const std::string line(100000, 'x');
  int taken = 0;
  while (taken < 1000 && interp.push_line(line).ok()) ++taken;
  EXPECT_GT(taken, 100);
  EXPECT_LT(taken, 170);
  EXPECT_EQ(interp.push_line(line).error().what.view().substr(0, 27),
            "More lines than can be kept");
}

}  // namespace
}  // namespace kerf::interp
