// Blends by themselves: how far they are from what is programmed, to which side, and how hard they bend.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "motion/core/path/junction.hpp"
#include "motion/core/path/smoothing.hpp"
#include "unit/motion/rig.hpp"
#include "unit/motion/vecs.hpp"

namespace kerf::motion::path {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kP = 0.05;

struct Smoothed {
  double bend{0};      ///< largest |q''| of an axis in the middle of the chain
  double off{0};       ///< largest distance from the chain at the same sigma
  double outside{0};   ///< largest x - y beyond the chain
  double high{-1e99};  ///< largest x
};

/// Steps of `leg` along x and y in turns.
Smoothed staircase(double leg, double high, bool peaked = false) {
  test::HeapMemory memory;
  constexpr std::size_t kLines = 20;
  Chain chain;
  Smoother smoother;
  Buffer<Piece> out;
  EXPECT_TRUE(chain.create(memory, kLines) && smoother.create(memory, kLines) &&
              out.create(memory, 40 * kLines));
  Vec at;
  for (std::size_t i = 0; i <= kLines; ++i) {
    chain.at.push_back(at);
    chain.sigma.push_back(leg * static_cast<double>(i));
    if (i < kLines) chain.feed.push_back(Feed{});
    at[i % 2] += leg;
  }
  SmoothingSettings settings;
  settings.tolerance = {kP, kP};
  settings.peaked = peaked;
  settings.low = everywhere(-1e9);
  settings.high = everywhere(high);
  EXPECT_LE(smoother.smooth(chain, settings, out), 1.0);
  Smoothed found;
  double sigma = 0;
  for (const Piece& p : out) {
    constexpr int kSteps = 50;
    for (int k = 0; k <= kSteps; ++k) {
      const double s = p.length * k / kSteps;
      const auto line = std::min(static_cast<std::size_t>((sigma + s) / leg), kLines - 1);
      const Vec programmed =
          chain.at[line] + chain.direction(line) * (sigma + s - chain.sigma[line]);
      const Vec q = p.point(s);
      // The ends have to keep their directions.
      if (sigma + s > 5 * leg && sigma + s < 15 * leg)
        found.bend = std::max(found.bend, max_abs(p.second(s)));
      found.off = std::max(found.off, norm3(q - programmed, 0));
      // The chain lies between x = y and x = y + leg.
      found.outside = std::max({found.outside, q[0] - q[1] - leg, q[1] - q[0]});
      found.high = std::max(found.high, q[0]);
    }
    sigma += p.length;
  }
  EXPECT_NEAR(sigma, leg * kLines, 1e-9);
  EXPECT_LE(max_abs(out.back().point(out.back().length) - chain.at.back()), 1e-9);
  return found;
}

TEST(Blends, ShortLegsUseBothSidesOfTheTolerance) {
  for (const bool peaked : {false, true}) {
    const double far = 1e9, end = 5;  // of the staircase in x
    const Smoothed both = staircase(0.5, far, peaked), inside = staircase(0.5, end, peaked);
    EXPECT_LE(both.off, kP + 1e-9);
    EXPECT_LE(inside.off, kP + 1e-9);
    EXPECT_LE(inside.high, end + 1e-9) << "left the box";
    EXPECT_LE(both.bend, 0.9 * inside.bend) << (peaked ? "triangles" : "trapezoids");
  }
}

TEST(Blends, LongLegsStayWhereTheyAreProgrammed) {
  const Smoothed found = staircase(20, 1e9);
  EXPECT_LE(found.off, kP + 1e-9);
  EXPECT_GT(found.off, 0.9 * kP);
  EXPECT_LE(found.outside, 1e-9);
}

Piece circle(double x, double y, double radius, double from, double sweep) {
  Piece p;
  p.shape = Piece::Shape::arc;
  p.a = xyz(x, y);
  p.c = xyz(1, 0);
  p.d = xyz(0, 1);
  p.phi0 = from;
  p.radius = radius;
  p.length = std::abs(sweep) * radius;
  p.rate = sweep / p.length;
  p.feed.speed = 80;
  return p;
}

struct Met {
  double bend{0}, jerk{0}, off{0}, reach{0}, gap{0};
};

/// Two arcs of radius 4 that meet at the origin with a kink; `turns`: the second one turns to the other side.
Met meeting(double kink, bool jerks, double tolerance, bool turns) {
  const Piece a = circle(0, -4, 4, kPi / 2 + 1, -1);
  Piece b = turns ? circle(0, 0, 4, kink - kPi / 2, 1) : circle(0, 0, 4, kPi / 2 + kink, -1);
  JunctionSettings settings;
  settings.tolerance = {tolerance, tolerance};
  settings.reach_a = settings.reach_b = 2;
  settings.low = everywhere(-1e9);
  settings.high = everywhere(1e9);
  settings.limits.vel = everywhere(200);
  settings.limits.acc = everywhere(1750);
  settings.limits.jerk = everywhere(jerks ? 50000 : kNoLimit);
  settings.limits.jerks = jerks;
  b.a += a.point(a.length) - b.point(0);
  test::HeapMemory memory;
  Buffer<Piece> out;
  EXPECT_TRUE(out.create(memory, 8));
  Met met;
  met.reach = blend_junction(a, b, settings, out);
  double u = -met.reach;
  Vec end = a.point(a.length - met.reach), slope = a.first(a.length - met.reach);
  for (const Piece& p : out) {
    met.gap = std::max({met.gap, max_abs(p.point(0) - end), max_abs(p.first(0) - slope)});
    for (int k = 0; k <= 100; ++k) {
      const double s = p.length * k / 100;
      const Vec programmed = u + s < 0 ? a.point(a.length + u + s) : b.point(u + s);
      met.off = std::max(met.off, norm3(p.point(s) - programmed, 0));
      met.bend = std::max(met.bend, max_abs(p.second(s)));
      met.jerk = std::max(met.jerk, max_abs(p.third(s)));
    }
    u += p.length;
    end = p.point(p.length);
    slope = p.first(p.length);
  }
  met.gap =
      std::max({met.gap, max_abs(b.point(met.reach) - end), max_abs(b.first(met.reach) - slope)});
  return met;
}

TEST(Blends, ArcsThatMeetAreWithinToleranceAndWithoutAGap) {
  for (const bool jerks : {false, true})
    for (const bool turns : {false, true})
      for (const double kink :
           {-2.8, -1.6, -0.8, -0.3, -0.05, -0.003, 0.001, 0.01, 0.1, 0.4, 1.2, 2.2, 3.0})
        for (const double tolerance : {0.003, kP}) {
          SCOPED_TRACE("kink " + std::to_string(kink) + " P " + std::to_string(tolerance));
          const Met met = meeting(kink, jerks, tolerance, turns);
          EXPECT_GT(met.reach, 0);
          EXPECT_LE(met.off, tolerance + 1e-9);
          EXPECT_LE(met.gap, 1e-9);
        }
}

TEST(Blends, ASharpKinkBetweenArcsIsTurnedOutsideOfThemToo) {
  // Cut on its inside alone, the best it can have is 1/8 of kink^2 over tolerance.
  for (const bool turns : {false, true})
    for (const double kink : {1.2, 1.6, 2.2}) {
      const double turn = 2 * std::sin(kink / 2);
      const Met met = meeting(kink, false, kP, turns);
      EXPECT_LT(met.bend, 0.08 * turn * turn / kP) << kink << turns;
      EXPECT_LE(met.off, kP) << kink << turns;
    }
}

TEST(Blends, AShallowKinkBetweenArcsSwingsOutToBendLess) {
  const double kink = 0.3, p = 0.005;
  const Met bent = meeting(kink, false, p, false), eased = meeting(kink, true, p, false);
  // Parabola and triangle of q'' on the inside: half-widths 4 P and 6 P over the kink.
  EXPECT_LE(bent.bend, 0.9 * kink * kink / (8 * p));
  EXPECT_GE(bent.reach, 2 * 4 * p / kink);
  EXPECT_LE(eased.jerk, 0.5 * kink * kink * kink / (36 * p * p));
  EXPECT_GE(eased.reach, 2 * 6 * p / kink);
}

}  // namespace
}  // namespace kerf::motion::path
