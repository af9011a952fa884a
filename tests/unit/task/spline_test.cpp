// Splines as cubics and as arcs: near the curve, touching each other, the same in every work offset.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "task/interpreter/canon_to_path.hpp"
#include "task/interpreter/spline_cubics.hpp"
#include "task/interpreter/spline_path.hpp"

namespace kerf::task {
namespace {

using interp::NurbsCurve;
using interp::SplinePoint;

struct Vec {
  double x{0}, y{0};
};
double length(Vec v) { return std::hypot(v.x, v.y); }
double length_of(Vec v) { return length(v); }

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
  const auto pieces = spline_pieces(curve, 0, curve.spans());
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
    constexpr double kH = 1e-6;
    EXPECT_NEAR(curve.at(u).dx, (curve.at(u + kH).x - curve.at(u - kH).x) / (2 * kH), 1e-4) << u;
    EXPECT_NEAR(curve.at(u).dy, (curve.at(u + kH).y - curve.at(u - kH).y) / (2 * kH), 1e-4) << u;
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
    const auto pieces = spline_pieces(curve, 0, curve.spans());
    ASSERT_FALSE(pieces.empty());
    EXPECT_LT(pieces.size(), 4000u) << round;
    EXPECT_NEAR(pieces.back().x, points.back().x, 1e-9);
    EXPECT_NEAR(pieces.back().y, points.back().y, 1e-9);
    EXPECT_LE(largest_distance(curve, pieces), kSplineTolerance * 1.2) << round;
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
    const auto pieces = spline_pieces(curve, 0, curve.spans());
    EXPECT_LT(pieces.size(), 5000u);
    if (!pieces.empty()) {
      EXPECT_LE(largest_distance(curve, pieces), kSplineTolerance * 1.5);
    }
  }
  EXPECT_TRUE(spline_pieces(NurbsCurve(odd[0], 4), 0, 1).empty());
  EXPECT_EQ(spline_pieces(NurbsCurve(odd[1], 4), 0, 1).back().turn, 0);
}

/// Point of a piece, and its first and second derivative.
std::array<Vec, 3> on(Vec from, const CubicPiece& p, double s) {
  const double l = p.length;
  const auto of = [&](double q0, double q1, double d, double dd) {
    const double ddd = 6 / (l * l * l) * (q1 - q0 - d * l - dd * l * l / 2);
    return std::array{q0 + d * s + dd * s * s / 2 + ddd * s * s * s / 6,
                      d + dd * s + ddd * s * s / 2, dd + ddd * s};
  };
  const auto x = of(from.x, p.x, p.dx, p.ddx), y = of(from.y, p.y, p.dy, p.ddy);
  return {Vec{x[0], y[0]}, Vec{x[1], y[1]}, Vec{x[2], y[2]}};
}

/// Of a curve that is nothing but cubics; else none.
std::vector<CubicPiece> all_cubics(const NurbsCurve& curve) {
  std::vector<CubicPiece> out;
  for (const SplinePart& part : spline_parts(curve)) {
    if (!part.arcs.empty()) return {};
    out.insert(out.end(), part.cubics.begin(), part.cubics.end());
  }
  return out;
}

TEST(Spline, cubics_follow_it_by_its_length_and_with_its_curvature) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> size(-20, 20), weight(0.5, 2);
  int had = 0;
  for (int program = 0; program < 60; ++program) {
    std::vector<SplinePoint> points;
    const int order = 3 + program % 3;
    points.reserve(static_cast<std::size_t>(order) + 3);
    for (int i = 0; i < order + program % 4; ++i)
      points.push_back({15.0 * i + size(rng) / 2, size(rng), program % 2 == 0 ? 1.0 : weight(rng)});
    const NurbsCurve curve(points, order);
    const auto pieces = all_cubics(curve);
    if (pieces.empty()) continue;
    ++had;
    Vec from{curve.at(0).x, curve.at(0).y};
    double length = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const auto end = on(from, pieces[i], pieces[i].length);
      EXPECT_NEAR(end[0].x, pieces[i].x, 1e-9);
      EXPECT_NEAR(length_of(on(from, pieces[i], pieces[i].length / 2)[1]), 1, 2e-3);
      length += pieces[i].length;
      from = {pieces[i].x, pieces[i].y};
      if (i + 1 == pieces.size()) continue;
      const auto next = on(from, pieces[i + 1], 0);
      EXPECT_NEAR(end[1].x, next[1].x, 1e-9) << "direction";
      EXPECT_NEAR(end[1].y, next[1].y, 1e-9) << "direction";
      if (order < 4) continue;
      EXPECT_NEAR(end[2].x, next[2].x, 1e-9) << "curvature";
      EXPECT_NEAR(end[2].y, next[2].y, 1e-9) << "curvature";
    }
    EXPECT_NEAR(from.x, points.back().x, 1e-9);
    EXPECT_NEAR(from.y, points.back().y, 1e-9);
    EXPECT_NEAR(length, curve.length(), 1e-5 * length);
    // Each point of the curve has one of the pieces beside it.
    double worst = 0;
    for (int i = 0; i <= 300; ++i) {
      const auto at = curve.at(1.0 * curve.spans() * i / 300);
      double best = 1e9;
      Vec start{curve.at(0).x, curve.at(0).y};
      for (const CubicPiece& p : pieces) {
        for (int k = 0; k <= 200; ++k) {
          const auto q = on(start, p, p.length * k / 200);
          // Off the tangent: samples along it are wider apart than the tolerance.
          const Vec d{at.x - q[0].x, at.y - q[0].y};
          if (length_of(d) > p.length / 100) continue;
          best = std::min(best, std::fabs(d.x * q[1].y - d.y * q[1].x));
        }
        start = {p.x, p.y};
      }
      worst = std::max(worst, best);
    }
    EXPECT_LE(worst, 2 * kCubicTolerance) << "program " << program;
  }
  EXPECT_GT(had, 50);
}

TEST(Spline, has_arcs_only_where_it_has_no_direction) {
  // A cusp and a point.
  const SplinePoint cusp[] = {{0, 0}, {10, 10}, {0, 10}, {10, 0}},
                    point[] = {{1, 1}, {1, 1}, {1, 1}};
  const auto of_cusp = spline_parts(NurbsCurve(cusp, 4));
  ASSERT_EQ(of_cusp.size(), 1U);
  EXPECT_FALSE(of_cusp[0].arcs.empty());
  EXPECT_TRUE(spline_parts(NurbsCurve(point, 3)).empty());
  // At its ends, where control points coincide, it only begins slowly by its parameter.
  const SplinePoint doubled[] = {{0, 0}, {0, 0}, {10, 5}, {20, -5}, {30, 0}, {30, 0}};
  EXPECT_FALSE(all_cubics(NurbsCurve(doubled, 4)).empty());
  // Three points that coincide: the curve stands at a knot, with one direction before it and another one behind.
  const SplinePoint corner[] = {{0, 0},   {10, 8},  {20, 3},  {30, 10}, {30, 10},
                                {30, 10}, {40, -5}, {50, -8}, {60, 0}};
  const NurbsCurve curve(corner, 4);
  const auto parts = spline_parts(curve);
  ASSERT_EQ(parts.size(), 2U);
  for (const SplinePart& part : parts) EXPECT_TRUE(part.arcs.empty());
  EXPECT_NEAR(parts[0].cubics.back().x, 30, 1e-9);
  EXPECT_NEAR(parts[1].cubics.back().x, 60, 1e-9);
  // A cusp within one span of many: the others are cubics all the same.
  const SplinePoint within[] = {{0, 0},   {10, 3}, {20, -2}, {30, 0},  {40, 10},
                                {30, 10}, {40, 0}, {50, 3},  {60, -3}, {70, 0}};
  const NurbsCurve with_cusp(within, 4);
  double arcs = 0, cubics = 0;
  Vec from{};
  for (const SplinePart& part : spline_parts(with_cusp)) {
    for (const SplinePiece& p : part.arcs) {
      arcs += std::hypot(p.x - from.x, p.y - from.y);
      from = {p.x, p.y};
    }
    for (const CubicPiece& p : part.cubics) {
      cubics += p.length;
      from = {p.x, p.y};
    }
  }
  EXPECT_NEAR(arcs + cubics, with_cusp.length(), 1e-3 * with_cusp.length());
  EXPECT_GT(cubics, 0.8 * with_cusp.length());
  EXPECT_NEAR(from.x, 70, 1e-9);
}

TEST(Spline, of_thousands_of_points_is_cubics) {
  std::vector<SplinePoint> points;
  points.reserve(6000);
  for (int i = 0; i < 6000; ++i) points.push_back({0.05 * i, 0.02 * std::sin(0.3 * i)});
  EXPECT_GT(all_cubics(NurbsCurve(points, 4)).size(), 2000U);
}

/// Elsewhere pieces stay long: the servo cycle has to pass them all.
TEST(Spline, a_tight_bend_makes_short_cubics_only_where_it_is) {
  const double x = -33.7116, y = 25.2517, to_x = -34.3913, to_y = 26.1173;
  const SplinePoint points[] = {
      {x, y}, {x + 1.8311, y - 1.6101}, {to_x + 0.9688, to_y - 1.7569}, {to_x, to_y}};
  const auto pieces = all_cubics(NurbsCurve(points, 4));
  ASSERT_FALSE(pieces.empty());
  double shortest = 1e9, longest = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    shortest = std::min(shortest, pieces[i].length);
    longest = std::max(longest, pieces[i].length);
    if (i > 0) {
      EXPECT_LT(pieces[i].length, 2.1 * pieces[i - 1].length);
      EXPECT_LT(pieces[i - 1].length, 2.1 * pieces[i].length);
    }
  }
  EXPECT_LT(pieces.size(), 120U);
  EXPECT_LT(shortest, 0.2 * longest);
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
  ASSERT_GT(list.size(), 2u);
  double length = 0;
  for (const TaskItem& item : list) {
    const auto& piece = std::get<motion::CubicMove>(std::get<PathBody>(item.body));
    EXPECT_NEAR(std::hypot(piece.end.x - 100, piece.end.y - 50), 1, 1e-12);
    // A clamped cubic spline has q'' - h^2/12 q at its knots, up to terms in h^4; q = -q'' on the unit circle. The terms in h^4
    // are 0.008 h^4 at most with four pieces (by solving for the spline of a quarter circle).
    const double h = piece.length;
    EXPECT_NEAR(std::hypot(piece.second.x, piece.second.y) - 1, h * h / 12, h * h * h * h / 100)
        << "curvature";
    EXPECT_DOUBLE_EQ(piece.vel_mm_s, 10);
    EXPECT_DOUBLE_EQ(piece.end.z, -17);
    EXPECT_DOUBLE_EQ(piece.end.a, 7);
    length += piece.length;
  }
  EXPECT_NEAR(length, std::acos(0), 1e-6);
  EXPECT_NEAR(canon.state().position.x, 99, 1e-9);
  EXPECT_NEAR(canon.state().position.y, 50, 1e-9);
  canon.set_planner_mode(1, 0.5);
  EXPECT_TRUE(std::holds_alternative<ShowMessage>(list.back().body));
}

}  // namespace
}  // namespace kerf::task
