// G40-G42.1: what waits, in which order it comes, with which line and state, and what a refused block leaves behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "interp/null_canon.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string feed(double x, double y, double z = 0) {
  char text[100];
  std::snprintf(text, sizeof text, "STRAIGHT_FEED(%.4f, %.4f, %.4f, 0.0000, 0.0000, 0.0000)\n", x,
                y, z);
  return text;
}

/// A square corner is next: the tool of radius 1 on its left.
void begin(Rig& rig) {
  rig.mdi("G21 G0 X-10 F100");
  rig.mdi("G41.1 D2");
  EXPECT_EQ(rig.mdi("G1 X0"), "") << "the end of the move is not known yet";
}

TEST(Compensation, a_move_comes_with_the_next_one) {
  Rig rig;
  begin(rig);
  EXPECT_TRUE(rig.interp.waiting());
  EXPECT_EQ(rig.mdi("X10"), feed(0, 1));
  EXPECT_EQ(rig.mdi("Y10"), feed(9, 1));
  EXPECT_EQ(rig.mdi("G40"),
            feed(9, 10) + "COMMENT(\"interpreter: cutter radius compensation off\")\n");
  EXPECT_FALSE(rig.interp.waiting());
  EXPECT_EQ(rig.mdi("G1 X20"), feed(20, 10));
}

TEST(Compensation, calls_behind_a_move_wait_and_messages_overtake) {
  Rig rig;
  begin(rig);
  rig.mdi("X10");
  EXPECT_EQ(rig.mdi("(said)"), "");
  EXPECT_EQ(rig.mdi("M8"), "");
  EXPECT_EQ(rig.mdi("G4 P1"), "");
  EXPECT_EQ(rig.mdi("Z5"), "") << "stays at the corner, so it moves with it";
  EXPECT_EQ(rig.mdi("(msg,now)"), "MESSAGE(\"now\")\n");
  EXPECT_EQ(rig.mdi("(debug,#<_x> #<_y>)"), "MESSAGE(\"10.000000 1.000000\")\n");
  EXPECT_EQ(rig.mdi("F7 Y10"), feed(9, 1) + "COMMENT(\"said\")\nFLOOD_ON()\nDWELL(1.0000)\n" +
                                   feed(9, 1, 5) + "SET_FEED_RATE(7.0000)\n");
}

TEST(Compensation, a_refused_block_changes_nothing) {
  for (const char* wrong : {"G1 X9.5 Y0.2", "G2 X12 Y5 R1", "G41.1 D2", "M62 P0", "G92 X1",
                            "G0 X#5420", "G53 G1 X0", "G81 X1 Z-1 R1", "G38.2 Z-1"}) {
    Rig rig;
    begin(rig);
    rig.mdi("X10");
    rig.mdi("(kept)");
    const ModalState before = rig.interp.modal();
    const std::string refused = rig.mdi(wrong);
    // The first move that turns back is found with the move behind it.
    if (refused.find("error: ") == std::string::npos) {
      EXPECT_THAT(rig.mdi("Y20"), StartsWith("error: Straight feed in concave corner")) << wrong;
      continue;
    }
    EXPECT_THAT(refused, StartsWith("error: ")) << wrong << ": no call before it";
    EXPECT_EQ(rig.interp.modal().position, before.position) << wrong;
    EXPECT_EQ(rig.interp.modal().cutter_comp, 410) << wrong;
  }
}

TEST(Compensation, an_error_leaves_what_waits) {
  Rig rig;
  begin(rig);
  ASSERT_TRUE(rig.interp.open_text("t.ngc", "X10\n(kept)\nM62 P0\nY10\nM2\n").ok());
  for (int i = 0; i < 2; ++i) EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  (void)rig.calls();
  EXPECT_EQ(rig.interp.execute_next(), Outcome::error);
  EXPECT_EQ(rig.calls(), "");
  EXPECT_EQ(rig.interp.error().text, "Cannot set motion output with cutter radius compensation on");
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.calls(), feed(9, 1) + "COMMENT(\"kept\")\n");
}

/// Line and modal state that each call comes with.
class Witness final : public NullCanon {
 public:
  void next_block(const SourceLine& source) override {
    line = source.line;
    text = std::string(source.text);
  }
  void straight_feed(const Pose& end) override { note(end); }
  void arc_feed(const Arc& arc) override { note(arc.end); }
  void set_flood(bool) override { note({}); }
  void note(const Pose& end) {
    const ModalState& m = interp->modal();
    char word[200];
    std::snprintf(word, sizeof word, "%d:%d:%s:F%g:x%.1f ", line, m.line, text.c_str(), m.feed,
                  end.x);
    seen += word;
  }
  Interpreter* interp{nullptr};
  int line{0};
  std::string text, seen;
};

TEST(Compensation, each_call_shows_its_own_line_and_state) {
  {
    BenchEnvironment world;
    Witness canon;
    Interpreter interp(world, canon);
    canon.interp = &interp;
    interp.init();
    ASSERT_TRUE(interp
                    .open_text("t.ngc",
                               "G21 G0 X-10 F1\nG41.1 D2\nG1 X0 F2\nX10 F3\nM8\nF4\n"
                               "Y-10 F5\nG40 F6\nM2\n")
                    .ok());
    while (interp.execute_next() == Outcome::ok) {
    }
    EXPECT_THAT(canon.seen, StartsWith("3:3:G1 X0 F2:F2:x0.0 "
                                       "4:4:X10 F3:F3:x10.0 "
                                       "5:5:M8:F3:x0.0 "
                                       "7:7:Y-10 F5:F5:x11.0 "
                                       "7:7:Y-10 F5:F5:x11.0 "));
  }
}

TEST(Compensation, a_pause_waits_for_its_place_and_then_for_the_machine) {
  Rig rig;
  begin(rig);
  ASSERT_TRUE(rig.interp.open_text("t.ngc", "X10\nM0\nY10\nG40\nM2\n").ok());
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok) << "nothing to wait for yet";
  (void)rig.calls();
  EXPECT_EQ(rig.interp.execute_next(), Outcome::needs_sync);
  EXPECT_EQ(rig.interp.sync_reason(), SyncReason::program_stop);
  EXPECT_EQ(rig.calls(), feed(9, 1) + "PROGRAM_STOP()\n");
  rig.interp.synchronize({});
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_THAT(rig.calls(), StartsWith(feed(9, 10)));
}

TEST(Compensation, abort_forgets_what_waits_and_turns_it_off) {
  Rig rig;
  begin(rig);
  rig.mdi("X10");
  const ModalState then = rig.interp.modal();
  rig.interp.abort();
  EXPECT_FALSE(rig.interp.waiting());
  rig.interp.restore(then);
  EXPECT_EQ(rig.interp.modal().cutter_comp, 400);
  EXPECT_EQ(rig.mdi("G1 X3"), feed(3, 0));
}

TEST(Compensation, a_moved_machine_enters_again) {
  Rig rig;
  begin(rig);
  rig.mdi("X10");
  rig.interp.synchronize({.machine_position = Pose{.x = 50}});
  EXPECT_FALSE(rig.interp.waiting());
  EXPECT_EQ(rig.mdi("X50.5"),
            "error: Length of cutter compensation entry move is not greater than the tool radius");
  EXPECT_EQ(rig.mdi("X60"), "");
  EXPECT_EQ(rig.mdi("G40"),
            feed(60, 1) + "COMMENT(\"interpreter: cutter radius compensation off\")\n");
}

TEST(Compensation, program_end_delivers_the_last_move_where_it_stands) {
  Rig rig;
  const std::string calls = rig.run("G21 G0 X-10 F100\nG41.1 D2\nG1 X0\nX10\nM2\n");
  EXPECT_THAT(calls, HasSubstr(feed(10, 1)));
  EXPECT_EQ(rig.interp.modal().cutter_comp, 400);
  EXPECT_EQ(rig.interp.modal().position.y, 1) << "the program is where the machine is";
  EXPECT_THAT(rig.run("F1 G2 X20 I5 J-1\nM2\n"), HasSubstr("ARC_FEED(20.0000")) << "no way out";
}

TEST(Compensation, a_percent_file_delivers_its_last_move) {
  Rig rig;
  EXPECT_THAT(rig.run("%\nG21 G0 X-10 F100\nG41.1 D2\nG1 X0\nX10\n%\n"),
              EndsWith(feed(10, 1) + "FINISH()\n"));
}

TEST(Compensation, g40_in_a_block_lets_the_rest_of_it_pass) {
  Rig rig;
  begin(rig);
  EXPECT_EQ(rig.mdi("G40 G49 G54 G64").find("error"), std::string::npos);
  begin(rig);
  EXPECT_THAT(rig.mdi("G49"), HasSubstr("Cannot change tool offset"));
}

TEST(Compensation, without_a_radius_nothing_waits) {
  Rig rig;
  rig.mdi("G21 G0 X-10 F100");
  rig.mdi("G41.1 D0");
  EXPECT_EQ(rig.mdi("G1 X0"), feed(0, 0));
  EXPECT_EQ(rig.mdi("Z5"), feed(0, 0, 5));
  EXPECT_THAT(rig.mdi("#1=#5420"), HasSubstr("Cannot read current position"));
}

TEST(Compensation, position_parameters_are_hidden_and_named_ones_tell_the_tool) {
  Rig rig;
  begin(rig);
  EXPECT_THAT(rig.mdi("#1=#5421"), HasSubstr("Cannot read current position"));
  EXPECT_THAT(rig.mdi("#1=#[5400+21]"), HasSubstr("Cannot read current position"));
  EXPECT_EQ(rig.debug("#<_y> #5421"), "1.000000 1.000000");
  rig.mdi("G40");
  EXPECT_EQ(rig.debug("#<_y>"), "0.000000");
}

TEST(Compensation, a_full_circle_behind_a_slight_corner_stays_one) {
  Rig rig;
  begin(rig);
  rig.mdi("X10");
  rig.mdi("G3 X10 Y0 I0.1 J5");  // 1.1 degrees beside the tangent
  const std::string circle = rig.mdi("G40");
  EXPECT_THAT(circle, StartsWith("ARC_FEED(10.0200, 0.9998, 10.1000, 5.0000, 2,"));
}

TEST(Compensation, an_arc_that_turns_back_is_refused_always) {
  Rig rig;
  EXPECT_THAT(rig.run("G21 F100\nG0 X0 Y0\nG42.1 D1\nG1 X-4.027 Y-8.4969\nX-1.803 Y-4.2683\n"
                      "G3 X-1.59753 Y-4.45166 I1.24606 J1.18953\n"
                      "G3 X10.98088 Y4.85296 I3.17339 J8.86441\nM2\n"),
              EndsWith("error: Arc move in concave corner cannot be reached by the tool without "
                       "gouging"));
}

TEST(Compensation, an_entry_arc_of_a_lathe_tool_begins_where_the_machine_stands) {
  Rig rig;
  const std::string calls =
      rig.run("G21 G18 F100\nG0 X0 Z0\nG42.1 D2 L3\nG2 X10 Z10 I10\nG40\nM2\n");
  // Controlled point (1, -1) from the centre in x and z; start, end and centre shift together.
  EXPECT_THAT(calls, HasSubstr("ARC_FEED(8.0000, 11.0000, "));
  double z = 0, x = 0, cz = 0, cx = 0;
  const std::size_t at = calls.find("ARC_FEED(");
  ASSERT_EQ(std::sscanf(calls.c_str() + at, "ARC_FEED(%lf, %lf, %lf, %lf", &z, &x, &cz, &cx), 4);
  EXPECT_NEAR(std::hypot(z - cz, x - cx), std::hypot(cz, cx), 1e-3);
}

}  // namespace
}  // namespace kerf::interp
