// The check of the travelled path against the program, beside the planner's own.
#include "motion/core/path_oracle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "rig.hpp"

namespace kerf::motion {
namespace {

using path::Piece;
using path::Vec;

ProgrammedMove line(const Vec& from, const Vec& to, path::Tolerance t) {
  path::Vec fast;
  for (double& v : fast.at) v = 1000;
  return {path::line_move(from, to, 10, false, fast), t};
}

/// About the origin in XY from (radius, 0).
ProgrammedMove arc(double radius, double sweep, double rise, double growth, double mm) {
  Piece p;
  p.shape = Piece::Shape::arc;
  p.c[0] = p.d[1] = 1;
  p.b[2] = rise / sweep;
  p.radius = radius;
  p.growth = growth;
  p.length = radius * sweep;
  p.rate = sweep / p.length;
  return {p, {mm, mm}};
}

double share(const ProgrammedMove& m, const Vec& at, bool carefully = false) {
  Vec off;
  return share_of(m, at, carefully, off);
}

TEST(PathOracle, DistancesFromMovesOfAllShapes) {
  const ProgrammedMove straight = line({}, {{10, 0, 0}}, {0.1, 0.1});
  EXPECT_NEAR(share(straight, {{4, 0.05, 0}}), 0.5, 1e-4);
  EXPECT_NEAR(share(straight, {{10.03, 0.04, 0}}), 0.5, 1e-4) << "beyond its end";
  EXPECT_NEAR(share(straight, {{4, 0, 0, 0.2}}), 2, 1e-3) << "A";
  constexpr double kTurn = 2 * std::numbers::pi;
  // Three turns that rise by 1 each: the second one.
  const ProgrammedMove helix = arc(5, 3 * kTurn, 3, 0, 0.1);
  EXPECT_LT(share(helix, {{5.05 * std::cos(1), 5.05 * std::sin(1), 1 + 1 / kTurn}}), 0.51);
  EXPECT_GT(share(helix, {{5 * std::cos(1), 5 * std::sin(1), 1.5 + 1 / kTurn}}), 4);
  const ProgrammedMove spiral = arc(5, 3 * kTurn, 0, 1 / kTurn, 0.1);
  EXPECT_LT(share(spiral, {{0, 6.25 + 0.05, 0}}), 0.51);
  EXPECT_GT(share(spiral, {{0, 6.75, 0}}), 4);
  const ProgrammedMove quarter = arc(5, kTurn / 4, 0, 0, 0.1);
  EXPECT_NEAR(share(quarter, {{-0.06, 5, 0}}), 0.6, 1e-3) << "just beyond its end";
  EXPECT_NEAR(share(quarter, {{5, -0.06, 0}}), 0.6, 1e-3) << "just before its start";
  // mm and degrees at their bounds together: the place of both together is not the one of the least share.
  const ProgrammedMove both = line({}, {{10, 0, 0, 10}}, {0.1, 0.1});
  const Vec beside{{4 + 0.09, 0, 0, 4 - 0.09}};
  EXPECT_LE(share(both, beside, true), 1);
}

class Watched : public testing::Test {
 protected:
  void add(const ProgrammedMove& m) { moves->add(m, ++seq); }
  void at(const Pose& p, std::uint64_t item) {
    SourceTag tag;
    tag.line = static_cast<std::int32_t>(100 + item);
    faults = FaultList{};
    oracle.check(*moves, p, item, tag, faults);
  }
  std::unique_ptr<ProgrammedMoves> moves = std::make_unique<ProgrammedMoves>();
  PathOracle oracle;
  FaultList faults;
  std::uint64_t seq{0};
};

TEST_F(Watched, TheFirstBreakIsToldWithItsLineAndNoMore) {
  for (int i = 0; i < 40; ++i) add(line({{1.0 * i, 0, 0}}, {{i + 1.0, 0, 0}}, {0.01, 0.01}));
  for (int i = 0; i < 300; ++i) {
    at({.x = 0.1 * i, .y = 0.0099}, static_cast<std::uint64_t>(i / 10 + 1));
    ASSERT_EQ(faults.size(), 0U) << i;
  }
  at({.x = 30.2, .y = 0.0102}, 31);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].fault, Fault::limit_path);
  EXPECT_EQ(faults[0].tag.line, 131);
  EXPECT_NEAR(faults[0].value, 0.0102, 1e-9);
  EXPECT_EQ(faults[0].limit, 0.01);
  at({.x = 30.3, .y = 5}, 31);
  EXPECT_EQ(faults.size(), 0U) << "latched";
  oracle.reset();
  at({.x = 30.3, .y = 5}, 31);
  EXPECT_EQ(faults.size(), 1U);
}

TEST_F(Watched, WhatIsNotKnownIsNotJudged) {
  at({.x = 5}, 1);
  EXPECT_EQ(faults.size(), 0U) << "nothing was noted";
  seq = 10;
  add(line({}, {{1, 0, 0}}, {0.01, 0.01}));
  at({.x = 5}, 3);
  EXPECT_EQ(faults.size(), 0U) << "a move from before";
}

TEST_F(Watched, TheLastMovesAreKeptForAnyLengthOfProgram) {
  const int many = 3 * static_cast<int>(ProgrammedMoves::kSlots);
  for (int i = 0; i < many; ++i) {
    add(line({{0.1 * i, 0, 0}}, {{0.1 * (i + 1), 0, 0}}, {0.01, 0.01}));
    if (i < 1000) continue;
    const int here = i - 1000;  // that far behind the planner
    at({.x = 0.1 * here + 0.05, .y = 0.005}, static_cast<std::uint64_t>(here + 1));
    ASSERT_EQ(faults.size(), 0U) << i;
  }
  at({.x = 0.1 * (many - 1000) + 0.05, .y = 0.02}, static_cast<std::uint64_t>(many - 999));
  EXPECT_EQ(faults.size(), 1U);
}

/// What an abort dropped is between where the machine stood and what it drives next.
TEST_F(Watched, MovesThatNobodyDroveArePassedAtOnce) {
  for (int i = 0; i < 1500; ++i) add(line({{1.0 * i, 0, 0}}, {{i + 1.0, 0, 0}}, {0.01, 0.01}));
  at({.x = 3.2}, 4);
  EXPECT_EQ(faults.size(), 0U);
  seq = 2000;
  for (int i = 0; i < 400; ++i) add(line({{3.2, 1.0 * i, 0}}, {{3.2, i + 1.0, 0}}, {0.01, 0.01}));
  at({.x = 3.2, .y = 0.5}, 2001);
  EXPECT_EQ(faults.size(), 0U);
  at({.x = 3.2, .y = 1.5}, 2002);
  EXPECT_EQ(faults.size(), 0U);
  at({.x = 3.3, .y = 1.5}, 2002);
  EXPECT_EQ(faults.size(), 1U);
}

TEST(PathCheck, ARotaryAxisBeyondItsToleranceIsToldInDegrees) {
  auto moves = std::make_unique<ProgrammedMoves>();
  moves->add(line({}, {{10, 0, 0}}, {0.1, 0.05}), 1);
  PathOracle oracle;
  FaultList faults;
  oracle.check(*moves, {.x = 3, .a = 0.06}, 1, SourceTag{}, faults);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].index, 3);
  EXPECT_NEAR(faults[0].value, 0.06, 1e-9);
  EXPECT_EQ(faults[0].limit, 0.05);
}

}  // namespace
}  // namespace kerf::motion
