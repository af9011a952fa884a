// Pieces of curves (G5, G5.1, G5.2) on the path.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "property/motion/random_program.hpp"

namespace kerf::motion {
namespace {

using test::Oracle;
using test::Rig;

/// y = x^3 / 5400 up to x = 30, in pieces that agree with each other.
std::vector<CubicMove> curve(int pieces, double feed) {
  constexpr double kThird = 6.0 / 5400;
  std::vector<CubicMove> out;
  const double h = 30.0 / pieces;
  for (int i = 0; i < pieces; ++i) {
    const double x = h * i, end = h * (i + 1);
    CubicMove m;
    m.end = {.x = end, .y = kThird * end * end * end / 6};
    m.first = {.x = 1, .y = kThird * x * x / 2};
    m.second = {.y = kThird * x};
    m.length = h;
    m.vel_mm_s = feed;
    out.push_back(m);
  }
  return out;
}

void drive_through(bool core_xy) {
  SCOPED_TRACE(core_xy ? "joints 0 and 1 move X+Y and X-Y" : "each joint is an axis");
  test::RigKinematics moved_by({0, 1, 2});
  moved_by.core_xy = core_xy;
  Rig rig(moved_by);
  rig.ready();
  rig.push(PathControl{.mode = PathControl::Mode::exact_path});
  for (const CubicMove& m : curve(40, 40)) rig.push(m);
  Oracle oracle;
  double off = 0, least = 1e9;
  ASSERT_GT(rig.run_until([&] {
    oracle.watch(rig);
    const Pose& at = rig.status().pos_cmd;
    off = std::max(off, std::abs(at.y - at.x * at.x * at.x / 5400));
    if (at.x > 5 && at.x < 25) least = std::min(least, rig.status().vel_mm_s);
    return rig.status().executed_seq >= rig.seq && rig.status().path_empty;
  }),
            0);
  EXPECT_EQ(rig.status().pos_cmd.x, 30);
  EXPECT_NEAR(rig.status().pos_cmd.y, 5, 1e-12);
  EXPECT_LE(off, 1e-9);
  EXPECT_GT(least, 39.5) << "slowed down where pieces meet";
  EXPECT_LE(oracle.vel, 1.0001);
  EXPECT_LE(oracle.acc, 1.001);
  EXPECT_TRUE(rig.faults.empty());
}

TEST(Cubic, IsDrivenThroughAtFeedWithinLimits) {
  drive_through(false);
  drive_through(true);
}

TEST(Cubic, WhatIsNoCurveByItsLengthIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const CubicMove good{{.x = 1}, {.x = 1}, {}, 1, 10};
  std::vector<CubicMove> bad(7, good);
  bad[0].end.y = nan;
  bad[1].length = 0;
  bad[2].length = nan;
  bad[3].first = {};
  bad[4].second.x = 1e3;
  bad[5].vel_mm_s = 0;
  bad[6].end = {.x = 100};
  for (const CubicMove& m : bad) {
    Rig rig;
    rig.ready();
    rig.push(m);
    rig.run(100);
    EXPECT_TRUE(rig.saw(Fault::bad_item));
    EXPECT_EQ(rig.status().pos_cmd, Pose{});
  }
}

TEST(Cubic, BeyondASoftLimitIsRefusedBeforeItMoves) {
  Rig rig;
  rig.config.axis[1].max_limit = rig.config.joint[1].max_limit = 0.05;
  rig.apply_config();
  rig.ready();
  // A hump in Y between two ends at 0.
  CubicMove m{{.x = 1}, {.x = 1, .y = 0.4}, {.y = -0.8}, 1, 10};
  rig.push(m);
  rig.run(200);
  EXPECT_TRUE(rig.saw(Fault::axis_soft_limit_max));
  EXPECT_EQ(rig.status().pos_cmd, Pose{});
}

/// Moves that no program should hold, each between two that are as usual: it ends where it should, at rest, with no step on the way.
struct Odd {
  const char* what;
  std::vector<PathItems::Variant> moves;
  bool refused{false};
};

LinearMove to(Pose end, double vel = 50) { return {end, vel, MotionKind::feed}; }

ArcMove arc(double cx, double cy, Pose end, double vel = 50) {
  ArcMove m;
  m.end = end;
  m.centre[0] = cx;
  m.centre[1] = cy;
  m.normal[2] = 1;
  m.vel_mm_s = vel;
  return m;
}

std::vector<Odd> odd_moves() {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  std::vector<PathItems::Variant> specks, reversals, tiny_steps;
  for (int i = 1; i <= 300; ++i) specks.push_back(to({.x = 10 + 1e-9 * i}));
  for (int i = 0; i < 20; ++i) reversals.push_back(to({.x = i % 2 == 0 ? 12.0 : 10.0}));
  for (int i = 1; i <= 200; ++i) tiny_steps.push_back(to({.x = 10 + 1e-7 * i, .y = i % 2 * 1e-7}));
  return {
      {"no length", {to({.x = 10}), to({.x = 10})}},
      {"duplicate points",
       {to({.x = 11}), to({.x = 11}), to({.x = 11, .y = 1}), to({.x = 11, .y = 1})}},
      {"segments of a nanometre", specks},
      {"segments of a tenth of a micrometre", tiny_steps},
      {"reversals", reversals},
      {"a radius of a kilometre", {arc(10, 1e6, {.x = 11, .y = 5e-7})}},
      {"a full circle", {arc(12, 0, {.x = 10})}},
      {"a hundred turns", {[] {
         ArcMove m = arc(10.5, 0, {.x = 10, .z = 5});
         m.turns = 100;
         return m;
       }()}},
      {"a radius of ten nanometres", {arc(10 + 1e-8, 0, {.x = 10})}},
      {"a radius of an atom", {arc(10 + 1e-10, 0, {.x = 10})}, true},
      {"no radius", {arc(10, 0, {.x = 10})}, true},
      {"NaN as end", {to({.x = nan})}, true},
      {"infinite end", {to({.x = inf})}, true},
      {"NaN as speed", {to({.x = 11}, nan)}, true},
      {"no speed", {to({.x = 11}, 0)}, true},
      {"NaN as centre", {arc(nan, 0, {.x = 11})}, true},
  };
}

void drive(const Odd& odd, double p, double jerk) {
  SCOPED_TRACE(odd.what);
  Rig rig;
  for (JointConfig& j : rig.config.joint) j.max_jerk = jerk;
  rig.apply_config();
  rig.ready();
  PathControl control;
  control.mode = p > 0 ? PathControl::Mode::continuous : PathControl::Mode::exact_path;
  control.tolerance_mm = control.naive_cam_tolerance_mm = p;
  rig.push(control);
  rig.push(to({.x = 10}));
  for (const auto& m : odd.moves) rig.push(m);
  const bool refused = odd.refused;
  if (!refused) rig.push(to({.x = 5, .y = 5}));
  Oracle oracle;
  bool finite = true;
  const int cycles = rig.run_until(
      [&] {
        oracle.watch(rig);
        for (std::size_t i = 0; i < 3; ++i)
          finite = finite && std::isfinite(rig.status().pos_cmd[i]);
        return refused ? !rig.faults.empty() && rig.controller->at_rest()
                       : rig.status().executed_seq >= rig.seq && rig.status().path_empty;
      },
      60000);
  EXPECT_GT(cycles, 0) << "stalled";
  EXPECT_TRUE(finite);
  EXPECT_LE(oracle.vel, 1.0001);
  EXPECT_LE(oracle.acc, 1.001);
  EXPECT_LE(oracle.jerk, 1.01);
  if (refused)
    EXPECT_TRUE(rig.saw(Fault::bad_item) || rig.saw(Fault::axis_soft_limit_max))
        << "nothing was said";
  else
    EXPECT_EQ(rig.status().pos_cmd, (Pose{.x = 5, .y = 5}));
  if (!refused) {
    EXPECT_TRUE(rig.faults.empty());
  }
}

TEST(OddMoves, NeverANanAJumpOrAStall) {
  for (const Odd& odd : odd_moves())
    for (const double p : {0.0, 0.05})
      for (const double jerk : {0.0, 20000.0}) {
        drive(odd, p, jerk);
        if (HasFailure()) return;
      }
}

TEST(OddMoves, LimitsOfZeroRefuseTheMoveAndNothingElse) {
  for (const bool velocity : {true, false}) {
    Rig rig;
    (velocity ? rig.config.axis[1].max_vel : rig.config.axis[1].max_acc) = 0;
    rig.apply_config();
    rig.ready();
    rig.line({.x = 5}, 50);
    ASSERT_GT(rig.finish(5000), 0) << "the other axes go on";
    rig.line({.x = 5, .y = 5}, 50);
    EXPECT_GT(rig.run_until([&] { return rig.saw(Fault::bad_item); }, 1000), 0);
    EXPECT_EQ(rig.status().pos_cmd, (Pose{.x = 5}));
  }
}

}  // namespace
}  // namespace kerf::motion
