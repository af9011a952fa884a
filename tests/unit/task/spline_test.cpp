// Splines as arcs: near the curve, touching each other, the same in every work offset.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "task/interpreter/canon_to_path.hpp"
#include "task/interpreter/spline_path.hpp"

namespace kerf::task {
namespace {

using interp::NurbsCurve;
using interp::SplinePoint;

struct Vec {
  double x{0}, y{0};
};
double length(Vec v) { return std::hypot(v.x, v.y); }

/// Unit tangents of a piece at its two ends.
std::pair<Vec, Vec> tangents(Vec from, const SplinePiece& p) {
  if (p.turn == 0) {
    const Vec d{p.x - from.x, p.y - from.y};
    const Vec t{d.x / length(d), d.y / length(d)};
    return {t, t};
  }
  const auto at = [&](Vec v) {
    const Vec r{v.x - p.cx, v.y - p.cy};
    return Vec{-p.turn * r.y / length(r), p.turn * r.x / length(r)};
  };
  return {at(from), at({p.x, p.y})};
}

double distance(Vec from, const SplinePiece& p, Vec at) {
  const Vec chord{p.x - from.x, p.y - from.y}, d{at.x - from.x, at.y - from.y};
  const double along = (d.x * chord.x + d.y * chord.y) / (length(chord) * length(chord));
  if (along < 0) return length(d);
  if (along > 1) return length({at.x - p.x, at.y - p.y});
  if (p.turn == 0) return std::fabs(chord.x * d.y - chord.y * d.x) / length(chord);
  return std::fabs(length({at.x - p.cx, at.y - p.cy}) - length({p.x - p.cx, p.y - p.cy}));
}

/// Largest distance of points of the curve from the pieces.
double largest_distance(const NurbsCurve& curve, const std::vector<SplinePiece>& pieces) {
  constexpr int kPoints = 1500;
  double worst = 0;
  for (int i = 0; i <= kPoints; ++i) {
    const auto c = curve.at(1.0 * curve.spans() * i / kPoints);
    double best = 1e9;
    Vec from{curve.at(0).x, curve.at(0).y};
    for (const SplinePiece& p : pieces) {
      best = std::min(best, distance(from, p, {c.x, c.y}));
      from = {p.x, p.y};
    }
    worst = std::max(worst, best);
  }
  return worst;
}

TEST(Spline, cubic_and_quadratic_are_bezier_curves) {
  const SplinePoint cubic[] = {{0, 0}, {0, 3}, {1, -2}, {1, 1}};
  for (const double u : {0.0, 0.25, 0.5, 1.0}) {
    const auto p = NurbsCurve(cubic, 4).at(u);
    const double v = 1 - u;
    EXPECT_NEAR(p.x, 3 * v * u * u * 1 + u * u * u, 1e-12);
    EXPECT_NEAR(p.y, 9 * v * v * u - 6 * v * u * u + u * u * u, 1e-12);
  }
  // The manual's parabola through the origin: y = x^2.
  const SplinePoint parabola[] = {{-2, 4}, {0, -4}, {2, 4}};
  const NurbsCurve curve(parabola, 3);
  for (int i = 0; i <= 10; ++i) {
    const auto p = curve.at(i / 10.0);
    EXPECT_NEAR(p.y, p.x * p.x, 1e-12);
  }
  // Its length is known: 2 sqrt(17) + asinh(4) / 2.
  EXPECT_NEAR(curve.length(), 2 * std::sqrt(17) + std::asinh(4) / 2, 1e-6);
}

TEST(Spline, weights_make_exact_circles) {
  const SplinePoint quarter[] = {{1, 0}, {1, 1, std::sqrt(0.5)}, {0, 1}};
  const NurbsCurve curve(quarter, 3);
  for (int i = 0; i <= 10; ++i) {
    const auto p = curve.at(i / 10.0);
    EXPECT_NEAR(std::hypot(p.x, p.y), 1, 1e-12);
  }
  EXPECT_NEAR(curve.length(), M_PI / 2, 1e-9);
  const auto pieces = spline_pieces(curve);
  ASSERT_EQ(pieces.size(), 2u) << "one pair of arcs";
  for (const auto& p : pieces) {
    EXPECT_EQ(p.turn, 1);
    EXPECT_NEAR(std::hypot(p.cx, p.cy), 0, 1e-9);
  }
}

TEST(Spline, knots_are_uniform_and_clamped) {
  // Measured with LinuxCNC: the manual's G5.2 example passes (1, 1.5) after its first span.
  const SplinePoint points[] = {{0, 0}, {0, 1}, {2, 2}, {2, 0}, {0, 0, 2}};
  const NurbsCurve curve(points, 3);
  ASSERT_EQ(curve.spans(), 3);
  EXPECT_NEAR(curve.at(1).x, 1, 1e-12);
  EXPECT_NEAR(curve.at(1).y, 1.5, 1e-12);
  EXPECT_NEAR(curve.at(3).x, 0, 1e-12);
  for (const double u : {0.3, 1.0, 1.7, 2.4}) {
    constexpr double h = 1e-6;
    EXPECT_NEAR(curve.at(u).dx, (curve.at(u + h).x - curve.at(u - h).x) / (2 * h), 1e-4) << u;
    EXPECT_NEAR(curve.at(u).dy, (curve.at(u + h).y - curve.at(u - h).y) / (2 * h), 1e-4) << u;
  }
}

TEST(Spline, arcs_stay_within_tolerance_and_touch) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-50, 50), weight(0.3, 3);
  for (int round = 0; round < 200; ++round) {
    const int order = 3 + round % 3;
    std::vector<SplinePoint> points(static_cast<std::size_t>(order + round % 5));
    for (SplinePoint& p : points) p = {place(random), place(random), weight(random)};
    const NurbsCurve curve(points, order);
    const auto pieces = spline_pieces(curve);
    ASSERT_FALSE(pieces.empty());
    EXPECT_LT(pieces.size(), 4000u) << round;
    EXPECT_NEAR(pieces.back().x, points.back().x, 1e-9);
    EXPECT_NEAR(pieces.back().y, points.back().y, 1e-9);
    EXPECT_LE(largest_distance(curve, pieces), kSplineTolerance_mm * 1.2) << round;
    Vec from{points[0].x, points[0].y};
    Vec before{};
    int corners = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const auto [begin, end] = tangents(from, pieces[i]);
      from = {pieces[i].x, pieces[i].y};
      if (i > 0 && begin.x * before.x + begin.y * before.y < 1 - 1e-6) ++corners;
      before = end;
    }
    EXPECT_EQ(corners, 0) << "round " << round << ": " << pieces.size() << " pieces";
  }
}

TEST(Spline, odd_control_points_end_too) {
  const std::vector<std::vector<SplinePoint>> odd = {
      {{0, 0}, {0, 0}, {0, 0}, {0, 0}},      // nothing
      {{0, 0}, {0, 0}, {10, 0}, {10, 0}},    // a line with no derivative at its ends
      {{0, 0}, {10, 10}, {0, 10}, {10, 0}},  // a cusp
      {{0, 0}, {20, 0}, {-10, 0}, {10, 0}},  // there and back on a line
      {{0, 0}, {1e5, 0, 1e-6}, {0, 1e5, 1e6}, {1, 1}},
      {{0, 0}, {1e-7, 0}, {0, 1e-7}, {1e-7, 1e-7}},
  };
  for (const auto& points : odd) {
    const NurbsCurve curve(points, 4);
    const auto pieces = spline_pieces(curve);
    EXPECT_LT(pieces.size(), 5000u);
    if (!pieces.empty()) {
      EXPECT_LE(largest_distance(curve, pieces), kSplineTolerance_mm * 1.5);
    }
  }
  EXPECT_TRUE(spline_pieces(NurbsCurve(odd[0], 4)).empty());
  EXPECT_EQ(spline_pieces(NurbsCurve(odd[1], 4)).back().turn, 0);
}

TEST(Spline, becomes_moves_in_machine_coordinates_with_the_feed) {
  std::deque<TaskItem> list;
  ToolConfig tools;
  CanonToPath canon{list, tools};
  canon.set_g5x_offset(1, {.x = 100, .y = 50, .z = -20});
  canon.set_xy_rotation(90);
  canon.straight_traverse({.x = 1, .z = 3, .a = 7});
  canon.set_feed_rate(600, 1200);
  list.clear();
  const SplinePoint quarter[] = {{1, 0}, {1, 1, std::sqrt(0.5)}, {0, 1}};
  canon.nurbs_feed(quarter, 3);
  ASSERT_EQ(list.size(), 2u);
  for (const TaskItem& item : list) {
    const auto& arc = std::get<motion::ArcMove>(std::get<PathBody>(item.body));
    EXPECT_NEAR(arc.centre[0], 100, 1e-9);
    EXPECT_NEAR(arc.centre[1], 50, 1e-9);
    EXPECT_EQ(arc.normal[2], 1);
    EXPECT_DOUBLE_EQ(arc.vel_mm_s, 10);
    EXPECT_DOUBLE_EQ(arc.end.z, -17);
    EXPECT_DOUBLE_EQ(arc.end.a, 7);
  }
  EXPECT_NEAR(canon.state().position.x, 99, 1e-9);
  EXPECT_NEAR(canon.state().position.y, 50, 1e-9);
  canon.set_planner_mode(1, 0.5);
  EXPECT_TRUE(std::holds_alternative<ShowMessage>(list.back().body));
}

}  // namespace
}  // namespace kerf::task
