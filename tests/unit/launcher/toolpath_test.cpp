#include "launcher/toolpath.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "samples.hpp"

namespace kerf::launcher {
namespace {

using test::sample;

double distance_to_line(const Point3& p, const std::vector<Point3>& line) {
  double best = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Point3& a = line[i];
    const Point3& b = line[i + 1];
    double length2 = 0, along = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      length2 += (b[k] - a[k]) * (b[k] - a[k]);
      along += (p[k] - a[k]) * (b[k] - a[k]);
    }
    const double t = length2 > 0 ? std::min(1.0, std::max(0.0, along / length2)) : 0;
    double d2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = p[k] - a[k] - t * (b[k] - a[k]);
      d2 += d * d;
    }
    best = std::min(best, std::sqrt(d2));
  }
  return best;
}

TEST(Simplify, AStraightLineKeepsItsEnds) {
  std::vector<Point3> line;
  for (int i = 0; i <= 100; ++i) line.push_back({i * 0.1, i * 0.2, 0});
  EXPECT_EQ(simplify(line, 0.001).size(), 2U);
}

TEST(Simplify, AClosedCircleIsNotLost) {
  std::vector<Point3> circle;
  for (int i = 0; i <= 1000; ++i)
    circle.push_back({10 * std::cos(i * M_PI / 500), 10 * std::sin(i * M_PI / 500), 0});
  const auto thin = simplify(circle, 0.01);
  EXPECT_GT(thin.size(), 20U);
  EXPECT_LT(thin.size(), 200U);
}

TEST(Simplify, EveryPointStaysWithinTheTolerance) {
  std::mt19937 random(42);
  std::uniform_real_distribution<double> step(-1, 1);
  for (int round = 0; round < 50; ++round) {
    std::vector<Point3> walk{{0, 0, 0}};
    for (int i = 0; i < 200; ++i) {
      Point3 p = walk.back();
      for (double& c : p) c += step(random);
      walk.push_back(p);
    }
    const double tolerance = 0.1 + std::fabs(step(random));
    const auto thin = simplify(walk, tolerance);
    ASSERT_EQ(thin.front(), walk.front());
    ASSERT_EQ(thin.back(), walk.back());
    for (const Point3& p : walk) ASSERT_LE(distance_to_line(p, thin), tolerance + 1e-12) << round;
  }
}

TEST(ToolpathRecorder, SplitsByKindAndFeedAndJoinsPieces) {
  ToolpathRecorder recorder;
  std::uint64_t cycle = 0;
  const auto add = [&](double x, double y, motion::MotionKind kind, double vel) {
    auto s = sample(cycle++, x, y);
    s.kind = kind;
    s.requested_vel_mm_s = vel;
    recorder.add(s);
  };
  using motion::MotionKind;
  add(0, 0, MotionKind::none, 0);
  for (int i = 1; i <= 10; ++i) add(i, 0, MotionKind::traverse, 100);
  add(10, 0, MotionKind::feed, 10);  // rest
  for (int i = 1; i <= 10; ++i) add(10, i, MotionKind::feed, 10);
  for (int i = 1; i <= 10; ++i) add(10, 10 + i, MotionKind::arc, 20);
  recorder.finish();
  const auto& pieces = recorder.pieces();
  ASSERT_EQ(pieces.size(), 3U);
  EXPECT_TRUE(pieces[0].rapid);
  EXPECT_EQ(pieces[0].points.size(), 2U);
  EXPECT_DOUBLE_EQ(pieces[1].feed_mm_min, 600);
  EXPECT_DOUBLE_EQ(pieces[2].feed_mm_min, 1200);
  EXPECT_EQ(pieces[0].points.back(), pieces[1].points.front());
  EXPECT_EQ(pieces[1].points.back(), pieces[2].points.front());
}

TEST(ToolpathRecorder, MemoryStaysSmallOnLongPaths) {
  ToolpathRecorder recorder;
  const std::uint64_t n = 200'000;
  for (std::uint64_t i = 0; i < n; ++i) {
    const double angle = static_cast<double>(i) * 1e-3;
    recorder.add(sample(i, 50 * std::cos(angle), 50 * std::sin(angle)));
  }
  recorder.finish();
  ASSERT_EQ(recorder.pieces().size(), 1U);
  EXPECT_LT(recorder.pieces()[0].points.size(), n / 8);
  EXPECT_NEAR(recorder.pieces()[0].points.back()[0],
              50 * std::cos(static_cast<double>(n - 1) * 1e-3), 1e-9);
}

}  // namespace
}  // namespace kerf::launcher
