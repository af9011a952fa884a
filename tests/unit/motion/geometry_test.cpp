#include "motion/core/geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::motion {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kAll = 0x1ff;

ArcMove arc(const Pose& end, double cx, double cy, double cz, double nx, double ny, double nz,
            int turns = 1) {
  ArcMove m;
  m.end = end;
  m.centre[0] = cx, m.centre[1] = cy, m.centre[2] = cz;
  m.normal[0] = nx, m.normal[1] = ny, m.normal[2] = nz;
  m.turns = turns;
  return m;
}

double distance(const Pose& a, const Pose& b) {
  double sum = 0;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// Length of the XYZ part by summing chords.
double measured_length(const Curve& c, int n = 20000) {
  double sum = 0;
  Pose before = point_at(c, 0);
  for (int i = 1; i <= n; ++i) {
    const Pose p = point_at(c, c.length * i / n);
    sum += std::hypot(p.x - before.x, p.y - before.y, p.z - before.z);
    before = p;
  }
  return sum;
}

TEST(Geometry, LineMeasuresTheAxesOfTheFeedMetric) {
  Curve c;
  ASSERT_TRUE(make_line({}, {.x = 3, .y = 4, .a = 90}, kAll, c));
  EXPECT_EQ(c.metric, FeedMetric::xyz);
  EXPECT_DOUBLE_EQ(c.length, 5);
  ASSERT_TRUE(make_line({}, {.a = 90, .u = 3, .w = 4}, kAll, c));
  EXPECT_EQ(c.metric, FeedMetric::uvw);
  EXPECT_DOUBLE_EQ(c.length, 5);
  ASSERT_TRUE(make_line({}, {.a = 3, .c = -4}, kAll, c));
  EXPECT_EQ(c.metric, FeedMetric::abc);
  EXPECT_DOUBLE_EQ(c.length, 5);
}

TEST(Geometry, AxesThatTheMachineLacksDoNotCount) {
  Curve c;
  ASSERT_TRUE(make_line({}, {.w = 10}, 0x7, c));
  EXPECT_EQ(c.shape, Curve::Shape::point);
  EXPECT_EQ(c.length, 0);
  ASSERT_TRUE(make_line({}, {.x = 1, .w = 10}, 0x7, c));
  EXPECT_DOUBLE_EQ(c.length, 1);
  EXPECT_DOUBLE_EQ(point_at(c, 0.5).w, 5);
}

TEST(Geometry, RoundingInXyzDoesNotTurnARotaryMoveIntoALinearOne) {
  Curve c;
  ASSERT_TRUE(make_line({.x = 0.1 + 0.2}, {.x = 0.3, .a = 360}, kAll, c));
  EXPECT_EQ(c.metric, FeedMetric::abc);
}

TEST(Geometry, EndsAreExact) {
  Curve c;
  const Pose start{.x = 0.1, .y = 1.0 / 3, .b = 7}, end{.x = 77.7, .y = -1e-3, .b = 1.0 / 7};
  ASSERT_TRUE(make_line(start, end, kAll, c));
  EXPECT_EQ(point_at(c, 0), start);
  EXPECT_EQ(point_at(c, c.length), end);
  ASSERT_TRUE(make_arc({.x = 1}, arc({.x = -1, .z = 5, .c = 9}, 0, 0, 0, 0, 0, 1), c));
  EXPECT_EQ(point_at(c, c.length), (Pose{.x = -1, .z = 5, .c = 9}));
  EXPECT_LT(distance(arc_point(c, c.angle), c.end), 1e-12);
}

TEST(Geometry, EqualEndsAreAFullCircleAndTurnsAddToIt) {
  Curve c;
  ASSERT_TRUE(make_arc({.x = 10}, arc({.x = 10}, 0, 0, 0, 0, 0, 1), c));
  EXPECT_DOUBLE_EQ(c.angle, 2 * kPi);
  EXPECT_NEAR(c.length, 20 * kPi, 1e-12);
  EXPECT_NEAR(point_at(c, c.length / 4).y, 10, 1e-12);
  ASSERT_TRUE(make_arc({.x = 10}, arc({.x = 10}, 0, 0, 0, 0, 0, 1, 3), c));
  EXPECT_DOUBLE_EQ(c.angle, 6 * kPi);
  ASSERT_TRUE(make_arc({.x = 10}, arc({.y = 10}, 0, 0, 0, 0, 0, 1, 2), c));
  EXPECT_NEAR(c.angle, 2.5 * kPi, 1e-14);
}

TEST(Geometry, AnEndOnTheRayOfTheStartIsAFullTurnOfASpiral) {
  Curve c;
  const double k = 1.7 / std::sqrt(2.0);
  for (const double e : {-1e-15, 0.0, 1e-15}) {
    ASSERT_TRUE(make_arc({.x = std::sqrt(0.5), .y = std::sqrt(0.5)},
                         arc({.x = k, .y = k + e}, 0, 0, 0, 0, 0, 1), c));
    EXPECT_NEAR(c.angle, 2 * kPi, 1e-12);
  }
}

TEST(Geometry, ClockwiseIsTheOppositeNormal) {
  Curve c;
  ASSERT_TRUE(make_arc({.x = 10}, arc({.y = -10}, 0, 0, 0, 0, 0, -1), c));
  EXPECT_NEAR(c.angle, kPi / 2, 1e-14);
  ASSERT_TRUE(make_arc({.x = 10}, arc({.y = -10}, 0, 0, 0, 0, 0, 1), c));
  EXPECT_NEAR(c.angle, 1.5 * kPi, 1e-14);
}

TEST(Geometry, HelixRisesAndCarriesOtherAxesWithTheAngle) {
  Curve c;
  ASSERT_TRUE(make_arc({.x = 3}, arc({.x = 3, .z = 8, .a = 720}, 0, 0, 0, 0, 0, 1, 2), c));
  EXPECT_NEAR(c.length, std::hypot(12 * kPi, 8), 1e-12);
  const Pose half = point_at(c, c.length / 2);
  EXPECT_NEAR(half.z, 4, 1e-12);
  EXPECT_NEAR(half.a, 360, 1e-10);
  EXPECT_NEAR(half.x, 3, 1e-12);
}

TEST(Geometry, CentreMayLieAnywhereAlongTheNormal) {
  Curve c;
  ASSERT_TRUE(make_arc({.x = 3, .z = 2}, arc({.x = -3, .z = 2}, 0, 0, 55, 0, 0, 1), c));
  EXPECT_NEAR(point_at(c, c.length / 2).z, 2, 1e-13);
  EXPECT_NEAR(c.radius, 3, 1e-13);
}

TEST(Geometry, SpiralIsReckonedByItsTrueLength) {
  for (const double r1 : {1.0000001, 1.001, 2.0, 10.0, 0.01, 0.5}) {
    for (const double height : {0.0, 3.0}) {
      Curve c;
      ASSERT_TRUE(make_arc({.x = 1}, arc({.x = -r1, .z = height}, 0, 0, 0, 0, 0, 1, 2), c));
      EXPECT_NEAR(c.length, measured_length(c), 1e-6 * c.length) << r1 << ' ' << height;
      // Equal steps of s are equal steps of length.
      const double h = c.length * 1e-4;
      for (double s = h; s < c.length - h; s += c.length / 37) {
        const Pose a = point_at(c, s - h), b = point_at(c, s + h);
        EXPECT_NEAR(std::hypot(b.x - a.x, b.y - a.y, b.z - a.z), 2 * h, 2e-3 * h) << r1 << ' ' << s;
        EXPECT_NEAR(arc_length_to(c, arc_angle_at(c, s)), s, 1e-11 * c.length);
      }
    }
  }
}

TEST(Geometry, DerivativesAgreeWithDifferences) {
  Curve curves[3];
  ASSERT_TRUE(
      make_arc({.x = 4, .a = 1}, arc({.x = -4, .z = 3, .a = 20}, 0, 0, 0, 0, 0, 1), curves[0]));
  ASSERT_TRUE(make_arc({.x = 4}, arc({.x = -9, .z = 3, .u = 2}, 0, 0, 0, 0, 0, 1), curves[1]));
  const double n = 1 / std::sqrt(3.0);
  ASSERT_TRUE(make_arc({.x = 1, .y = -1},
                       arc({.x = 1 + 0.5, .y = -1 + 0.5, .z = 0.5}, 0, 0, 0, n, n, n), curves[2]));
  for (const Curve& c : curves) {
    for (double s = 0.1 * c.length; s < 0.95 * c.length; s += 0.1 * c.length) {
      const double h = 1e-4 * c.length;
      Pose d1, d2;
      derivatives_at(c, s, d1, d2);
      const Pose a = point_at(c, s - h), b = point_at(c, s), e = point_at(c, s + h);
      for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
        EXPECT_NEAR(d1[i], (e[i] - a[i]) / (2 * h), 1e-6) << i;
        EXPECT_NEAR(d2[i], (e[i] - 2 * b[i] + a[i]) / (h * h), 1e-5) << i;
      }
    }
  }
}

TEST(Geometry, ExtentSeesTheBulgeOfAnArc) {
  Curve c;
  Pose low, high;
  ASSERT_TRUE(make_arc({.x = 3, .y = 4}, arc({.x = -3, .y = 4}, 0, 0, 0, 0, 0, 1), c));
  extent_of(c, low, high);
  EXPECT_NEAR(high.y, 5, 1e-9);
  EXPECT_NEAR(low.y, 4, 1e-12);
  EXPECT_NEAR(high.x, 3, 1e-12);
  ASSERT_TRUE(make_arc({.x = 5, .b = 1}, arc({.x = 5, .z = 9, .b = -2}, 0, 0, 0, 0, 0, 1, 4), c));
  extent_of(c, low, high);
  EXPECT_NEAR(low.x, -5, 1e-9);
  EXPECT_NEAR(low.y, -5, 1e-9);
  EXPECT_EQ(high.z, 9);
  EXPECT_EQ(low.b, -2);
}

TEST(Geometry, ExtentOfManyTurnsHoldsEveryTurn) {
  // Counts of turns at which evenly spaced samples would all fall on the same angle.
  for (const int turns : {2, 3, 4, 100, 4097, 4098, 4099, 8196}) {
    Curve c;
    Pose low, high;
    ASSERT_TRUE(make_arc({.x = 5}, arc({.x = 5, .z = 9}, 0, 0, 0, 0, 0, 1, turns), c));
    extent_of(c, low, high);
    EXPECT_NEAR(low.x, -5, 1e-9) << turns;
    EXPECT_NEAR(low.y, -5, 1e-9) << turns;
    EXPECT_NEAR(high.y, 5, 1e-9) << turns;
    EXPECT_NEAR(high.x, 5, 1e-9) << turns;
    EXPECT_NEAR(low.z, 0, 1e-9) << turns;
    EXPECT_NEAR(high.z, 9, 1e-9) << turns;
  }
}

TEST(Geometry, ImpossibleMovesAreRefused) {
  Curve c;
  EXPECT_FALSE(make_line({}, {.x = std::nan("")}, kAll, c));
  EXPECT_FALSE(make_line({}, {.c = INFINITY}, kAll, c));
  EXPECT_FALSE(make_arc({.x = 1}, arc({.x = 2}, 1, 0, 0, 0, 0, 1), c)) << "starts at the centre";
  EXPECT_FALSE(make_arc({.x = 1}, arc({.x = 2}, 2, 0, 0, 0, 0, 1), c)) << "ends at the centre";
  EXPECT_FALSE(make_arc({.x = 1}, arc({.x = 2}, 0, 0, 0, 0, 0, 2), c)) << "no unit vector";
  EXPECT_FALSE(make_arc({.x = 1}, arc({.x = 2}, 0, 0, 0, 0, 0, 1, 0), c)) << "no turns";
  EXPECT_FALSE(make_arc({.x = 1}, arc({.x = 2}, NAN, 0, 0, 0, 0, 1), c));
}

}  // namespace
}  // namespace kerf::motion
