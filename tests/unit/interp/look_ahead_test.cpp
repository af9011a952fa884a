// [RS274NGC]COMPENSATION_LOOK_AHEAD: gouges between moves that are no neighbours, and what waits for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "interp/compensation/look_ahead.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kPi = 3.14159265358979323846;

// --- distances ---

Flat point_of(const FlatPiece& p, double t) {
  if (!p.is_arc) return p.start + (p.end - p.start) * t;
  const Flat from = p.start - p.center;
  const double c = std::cos(p.sweep * t), s = std::sin(p.sweep * t);
  return p.center + Flat{from.a * c - from.b * s, from.a * s + from.b * c};
}

TEST(LookAheadGeometry, DistancesAreThoseOfTheNearestPoints) {
  std::mt19937 random(11);
  const auto in = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const auto piece = [&] {
    FlatPiece p{{in(-5, 5), in(-5, 5)}, {in(-5, 5), in(-5, 5)}};
    p.is_arc = in(0, 1) < 0.6;
    if (!p.is_arc) return p;
    p.center = {in(-5, 5), in(-5, 5)};
    p.sweep = in(-2 * kPi, 2 * kPi);
    p.end = point_of(p, 1);
    return p;
  };
  constexpr int kSteps = 400;
  for (int i = 0; i < 300; ++i) {
    const FlatPiece p = piece(), q = piece();
    double least = 1e9;
    for (int k = 0; k <= kSteps; ++k) {
      const Flat a = point_of(p, static_cast<double>(k) / kSteps);
      for (int m = 0; m <= kSteps; ++m) {
        const Flat d = point_of(q, static_cast<double>(m) / kSteps) - a;
        least = std::min(least, std::hypot(d.a, d.b));
      }
    }
    const double exact = distance(p, q);
    EXPECT_LE(exact, least + 1e-9) << i;
    EXPECT_GT(exact, least - 0.2) << i;  // the steps are up to 0.1 long
    EXPECT_NEAR(exact, distance(q, p), 1e-9) << i;
  }
}

// --- windows ---

/// A wall along y = `y`, the tool `off` above it.
GuardedMove wall(int line, double y, double off, double z = 0) {
  GuardedMove m;
  m.programmed = {{0, y}, {10, y}};
  m.tool = {{0, y + off}, {10, y + off}};
  m.line = line;
  m.low = m.high = z;
  return m;
}

TEST(LookAheadWindow, HoldsEachMoveAgainstAllButItsNeighbour) {
  LookAhead window;
  window.take(wall(1, 0, 2), 3);
  EXPECT_FALSE(window.gouge(wall(2, 1, 2), 2)) << "the neighbour";
  window.take(wall(2, 50, 2), 3);
  const auto next_but_one = window.gouge(wall(3, 1, 2), 2);
  ASSERT_TRUE(next_but_one);
  EXPECT_EQ(next_but_one->tool_line, 1);
  EXPECT_EQ(next_but_one->wall_line, 3);
  EXPECT_NEAR(next_but_one->distance, 1, 1e-12);
  EXPECT_FALSE(window.gouge(wall(3, 0.001, 2), 2)) << "rounding";
  EXPECT_FALSE(window.gouge(wall(3, 4, 2), 2)) << "between two walls";
  EXPECT_TRUE(window.gouge(wall(3, -1, 2), 2)) << "its own way along the wall before";
  window.take(wall(3, 50, 2), 3);
  EXPECT_TRUE(window.gouge(wall(4, 1, 2), 2));
  window.take(wall(4, 50, 2), 3);
  EXPECT_FALSE(window.gouge(wall(5, 1, 2), 2)) << "further back than three";
}

TEST(LookAheadWindow, AToolAboveAWallAndAWallOfG0AreFree) {
  LookAhead window;
  window.take(wall(1, 0, 2, 5), 9);
  window.take(wall(2, 50, 2), 9);
  EXPECT_FALSE(window.gouge(wall(3, 1, 7, 0), 2)) << "the first one is higher than this wall";
  EXPECT_TRUE(window.gouge(wall(3, -1, 1.5, 0), 2)) << "the flank of the tool cuts what is above";
  GuardedMove rapid = wall(3, 1, 7, 5);
  EXPECT_TRUE(window.gouge(rapid, 2));
  rapid.wall = false;
  EXPECT_FALSE(window.gouge(rapid, 2));
}

TEST(LookAheadWindow, TheWayAroundACornerCounts) {
  LookAhead window;
  GuardedMove m = wall(1, 0, 2);
  m.corner = FlatPiece{{0, 3}, {3, 0}, true, {0, 0}, -kPi / 2};
  window.take(m, 9);
  window.take(wall(2, 50, 2), 9);
  GuardedMove next = wall(3, 0, 2);
  next.tool = {{50, 50}, {60, 50}};
  next.programmed = {{2.5, 2.5}, {2.5, 4.6}};
  EXPECT_TRUE(window.gouge(next, 0.6));
  next.programmed = {{2.5, 3.5}, {2.5, 4.6}};
  EXPECT_FALSE(window.gouge(next, 0.6));
}

// --- programs ---

/// The calls of the program, and "error: TEXT"; `help` is what the error advises.
std::string run(int depth, const std::string& program, std::string* help = nullptr) {
  Settings settings;
  settings.compensation_look_ahead = depth;
  Rig rig(settings);
  std::string calls = rig.run("G21 G17 G90 G40 F100\n" + program + "M2\n");
  if (help != nullptr) *help = rig.interp.error().help;
  return calls;
}

/// A slot 4 mm wide and 10 deep in the upper edge of a part, with a chamber below it; the part is on the right.
std::string keyhole(const char* diameter) {
  return std::string("G0 X-30 Y10\nG41.1 D") + diameter +
         "\nG1 X-20 Y0\nX-10\nX0\nY-10 (into the slot)\nX-10\nY-30\nX14\nY-10\nX4\nY0 (out of it)\n"
         "X20\nX30\nG40\nG0 Y10\n";
}

TEST(LookAhead, ASlotThatTheToolDoesNotFitIsRefusedBeforeItIsEntered) {
  std::string help;
  for (int depth = 5; depth < 9; ++depth) {
    const std::string calls = run(depth, keyhole("6"), &help);
    EXPECT_THAT(calls, HasSubstr("error: The tool gouges the contour of line 12 on its way along "
                                 "line 7"))
        << depth;
    EXPECT_THAT(help,
                StartsWith("Its centre comes within 1 mm of that contour, its radius is 3 mm"));
    EXPECT_THAT(calls, Not(HasSubstr("(3.0000, "))) << "the tool never went to the slot";
  }
  // Less foresight finds it late, or not at all.
  EXPECT_THAT(run(4, keyhole("6")), AllOf(HasSubstr("on its way along line 8"),
                                          HasSubstr("STRAIGHT_FEED(3.0000, -10.0000")));
  EXPECT_THAT(run(3, keyhole("6")), Not(HasSubstr("error")));
  EXPECT_THAT(run(0, keyhole("6")), Not(HasSubstr("error")));
}

TEST(LookAhead, ASlotThatTheToolFitsIsCutAsWithoutIt) {
  const std::string plain = run(0, keyhole("3.98"));
  EXPECT_THAT(plain, Not(HasSubstr("error")));
  for (const int depth : {1, 2, 6, 20, 1000})
    EXPECT_EQ(run(depth, keyhole("3.98")), plain) << depth;
}

TEST(LookAhead, AWayOutThroughTheWallIsAGouge) {
  EXPECT_THAT(run(10,
                  "G0 X-40 Y-40\nG42.1 D6\nG1 X-20 Y-30\nX-20 Y-20\nY20\nX20\nY-20\nX-20\nX-30\n"
                  "X-50\nG40\n"),
              HasSubstr("error: The tool gouges the contour of line 9 on its way along line 6"));
}

TEST(LookAhead, ArcsAndLegalPocketsAreNoGouges) {
  const char* const legal[] = {
      // a round pocket with a straight way in and out
      "G0 X0 Y0\nG41.1 D6\nG1 X5 Y-5\nG3 X10 Y0 I0 J5\nX0 Y10 I-10\nX-10 Y0 J-10\nX0 Y-10 I10\n"
      "X10 Y0 J10\nX5 Y5 I-5\nG40\nG1 X0 Y0\n",
      // a rectangle from inside with round corners, the far wall within the window
      "G0 X0 Y0\nG41.1 D6\nG1 X5 Y-14\nG3 X10 Y-19 I5\nG1 X26\nG3 X30 Y-15 J4\nG1 Y15\n"
      "G3 X26 Y19 I-4\nG1 X-6\nG3 X-10 Y15 J-4\nG1 Y-15\nG3 X-6 Y-19 I4\nG1 X10\n"
      "G3 X15 Y-14 J5\nG40\nG1 X0 Y0\n",
      // a boss from outside, right of the path
      "G0 X-50 Y-40\nG42.1 D6\nG1 X-30 Y-20\nX-20\nX20\nY20\nX-20\nY-20\nY-30\nG40\nG0 X-50\n",
      // the same contour twice, deeper the second time
      "G0 X-40 Y-40\nG41.1 D6\nG1 X-20 Y-30\nY-20\nY20\nX20\nY-20\nX-20\nZ-2\nY20\nX20\nY-20\n"
      "X-20\nX-30\nG40\nG0 X-50\n",
      // a thin wall, one side after the other
      "G0 X-10 Y10\nG41.1 D6\nG1 X-5 Y5\nX0 Y0.1\nX20\nY0\nX0\nX-10\nX-20\nG40\nG0 Y20\n",
      // over the part, up high
      "G0 X-30 Y10\nG41.1 D6\nG1 X-20 Y0\nX-10\nX0\nX40\nY30\nG0 Z20\nX10 Y-20\nX60\nG40\n",
  };
  for (const char* const program : legal) {
    const std::string plain = run(0, program);
    EXPECT_THAT(plain, Not(HasSubstr("error"))) << program;
    EXPECT_EQ(run(10, program), plain) << program;
  }
}

TEST(LookAhead, OrderOfCallsAndStopsIsThatOfTheProgram) {
  const std::string program =
      "G0 X-30 Y10\nG41.1 D2\nG1 X-20 Y0\nX-10\n(one)\nX0\nM8\nZ-1\nX10\n(msg,two)\nX20\nM0\nX30\n"
      "F50\nX40\nS100\nX50\nG40\nG1 X60\n";
  Settings settings;
  settings.compensation_look_ahead = 4;
  Rig rig(settings);
  const std::string calls = rig.run("G21 G17 G90 G40 F100\n" + program + "M2\n");
  std::size_t at = 0;
  for (const char* const next :
       {"(-10.0000, 1", "COMMENT(\"one\")", "(0.0000, 1.0000, 0", "FLOOD_ON", "(0.0000, 1.0000, -1",
        "(10.0000, 1", "MESSAGE(\"two\")", "(20.0000, 1", "PROGRAM_STOP", "(30.0000, 1",
        "SET_FEED_RATE(50", "(40.0000, 1", "SET_SPINDLE_SPEED", "(50.0000, 1", "(60.0000, 0"}) {
    const std::size_t found = calls.find(next, at);
    ASSERT_NE(found, std::string::npos) << next << " behind\n" << calls;
    at = found;
  }
}

TEST(LookAhead, AStopLetsAllBeforeItGo) {
  Settings settings;
  settings.compensation_look_ahead = 50;
  Rig rig(settings);
  rig.mdi("G21 F100");
  ASSERT_TRUE(
      rig.interp.open_text("t.ngc", "G41.1 D2\nG1 X20\nX30\nX40\nX50\nM0\nX60\nX70\nM2\n").ok());
  Outcome o = Outcome::ok;
  while (o == Outcome::ok) o = rig.interp.execute_next();
  ASSERT_EQ(o, Outcome::needs_sync);
  EXPECT_EQ(rig.interp.sync_reason(), SyncReason::program_stop);
  EXPECT_THAT(rig.calls(), AllOf(HasSubstr("(50.0000, 1"), HasSubstr("PROGRAM_STOP"),
                                 Not(HasSubstr("(60.0000"))));
  EXPECT_TRUE(rig.interp.waiting());
  // Where it stopped the machine was moved: what waits is forgotten, and the path is entered anew.
  rig.interp.synchronize({.machine_position = Pose{.x = 55, .y = 5}});
  EXPECT_FALSE(rig.interp.waiting());
  while (o != Outcome::program_end) o = rig.interp.execute_next();
  EXPECT_THAT(rig.calls(), Not(HasSubstr("(60.0000")));
}

TEST(LookAhead, AnAbortForgetsWhatWaits) {
  Settings settings;
  settings.compensation_look_ahead = 5;
  Rig rig(settings);
  rig.mdi("G21 F100");
  rig.mdi("G41.1 D2");
  for (const char* const line : {"G1 X20", "X30", "X40", "X50"}) EXPECT_EQ(rig.mdi(line), "");
  EXPECT_TRUE(rig.interp.waiting());
  rig.interp.abort();
  rig.interp.synchronize({.machine_position = Pose{}});
  EXPECT_FALSE(rig.interp.waiting());
  EXPECT_THAT(rig.mdi("G1 X5"), StartsWith("STRAIGHT_FEED(5.0000, 0.0000"));
}

TEST(LookAhead, NeighboursThatDoNotFitNameTheOpenMove) {
  std::string help;
  run(8, "G0 X-30\nG41.1 D8\nG1 X-20\nX-10\nX0\nX0.5 Y0.5\nY30\nX-20\nG40\n", &help);
  EXPECT_THAT(help, HasSubstr("that of line 7")) << help;
}

}  // namespace
}  // namespace kerf::interp
