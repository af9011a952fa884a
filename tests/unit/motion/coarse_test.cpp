// Moves that are small against the tolerance: as lines, and as parts of a path.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "motion/core/path/coarse.hpp"
#include "motion/core/path/program_path.hpp"
#include "motion/core/path/smoothing.hpp"
#include "unit/motion/rig.hpp"
#include "unit/motion/vecs.hpp"

namespace kerf::motion::path {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFar = 1e9, kFeed = 150;
constexpr int kSteps = 24;        ///< in which curves are looked at
constexpr double kChords = 1e-3;  ///< of the tolerance: what chords of these are off

AxisLimits mill() {
  AxisLimits limits;
  limits.vel = everywhere(200);
  limits.acc = everywhere(1750);
  limits.jerk = everywhere(kNoLimit);
  return limits;
}

/// Writes lines and arcs in XY one after another.
struct Track {
  Vec at;
  double heading{0};
  PathMode mode;
  std::vector<Move> moves;

  explicit Track(double p_mm, PathMode::Corners corners = PathMode::Corners::blend) {
    mode.corners = corners;
    mode.tolerance = {p_mm, p_mm};
  }
  void line(double length) {
    const Vec to = at + xyz(std::cos(heading), std::sin(heading)) * length;
    Move move;
    move.piece = line_move(at, to, kFeed, false, mill().vel);
    move.mode = mode;
    moves.push_back(move);
    at = to;
  }
  void arc(double radius, double sweep, double rise = 0) {
    const double left = std::copysign(1.0, sweep);
    Piece p;
    p.shape = Piece::Shape::arc;
    p.a = at + xyz(-std::sin(heading), std::cos(heading)) * (left * radius);
    p.c = (at - p.a) * (1 / radius);
    p.d = xyz(std::cos(heading), std::sin(heading));
    p.b[2] = rise / std::abs(sweep);
    p.radius = radius;
    scale_arc(p, std::abs(sweep), std::hypot(radius * sweep, rise), kFeed, false, mill().vel);
    Move move;
    move.piece = p;
    move.mode = mode;
    moves.push_back(move);
    at = p.point(p.length);
    heading += sweep;
  }
};

struct Driven {
  double seconds{0}, sigma{0};
  double off{0};  ///< of the path from the programmed one, and of programmed ends from the path
  double high{-1e99};
  int stops{0};
  double shortest_arc{1e99};
};

double product(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// From the polyline.
double distance(const Vec& q, const std::vector<Vec>& points) {
  double least = 1e99;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec way = points[i + 1] - points[i], here = q - points[i];
    const double square = product(way, way);
    const double along = square > 0 ? std::clamp(product(here, way) / square, 0.0, 1.0) : 0.0;
    least = std::min(least, norm3(here - way * along, 0));
  }
  return least;
}

AxisLimits with_jerk() {
  AxisLimits limits = mill();
  limits.jerk = everywhere(50'000);
  limits.jerks = true;
  return limits;
}

Driven drive(const Track& track, double high = kFar, const AxisLimits& limits = mill()) {
  test::HeapMemory memory;
  constexpr std::size_t kMoves = 300;
  ProgramPath path;
  Buffer<Piece> out;
  Buffer<double> x;
  EXPECT_TRUE(path.create(memory, kMoves) && out.create(memory, 14 * kMoves) &&
              x.create(memory, 100 * kMoves));
  PathSettings settings;
  settings.low = everywhere(-kFar);
  settings.high = everywhere(high);
  settings.limits = limits;
  path.configure(settings);
  path.make(track.moves.data(), track.moves.size(), out);
  Driven found;
  std::vector<Vec> programmed, driven;
  for (const Move& m : track.moves) {
    const int steps = m.piece.straight() ? 1 : kSteps;
    for (int k = 0; k <= steps; ++k)
      programmed.push_back(m.piece.point(m.piece.length * k / steps));
  }
  for (const Piece& p : out) {
    found.sigma += p.length;
    found.stops += p.stop_at_end ? 1 : 0;
    if (p.shape == Piece::Shape::arc) found.shortest_arc = std::min(found.shortest_arc, p.length);
    const int steps = p.straight() ? 1 : kSteps;
    for (int k = 0; k <= steps; ++k) driven.push_back(p.point(p.length * k / steps));
  }
  for (const Vec& q : driven) {
    found.off = std::max(found.off, distance(q, programmed));
    found.high = std::max(found.high, max_abs(q));
  }
  for (const Move& m : track.moves)
    found.off = std::max(found.off, distance(m.piece.point(m.piece.length), driven));
  for (std::size_t i = 0; i + 1 < out.size(); ++i) {
    EXPECT_LE(max_abs(out[i].point(out[i].length) - out[i + 1].point(0)), 1e-9);
    if (out[i].stop_at_end) continue;
    EXPECT_LE(max_abs(out[i].first(out[i].length) - out[i + 1].first(0)), 1e-9);
    if (!limits.jerks) continue;
    EXPECT_LE(max_abs(out[i].second(out[i].length) - out[i + 1].second(0)), 1e-6);
  }
  found.seconds = least_seconds(out.begin(), out.size(), settings.limits, x);
  return found;
}

double sigma_of(const Track& track) {
  double sum = 0;
  for (const Move& m : track.moves) sum += m.piece.length;
  return sum;
}

Track with_fillets(double p_mm, double radius) {
  Track t(p_mm);
  t.line(12);
  for (int i = 0; i < 8; ++i) {
    if (radius > 0)
      t.arc(radius, i % 2 != 0 ? kPi / 2 : -kPi / 2);
    else
      t.heading += i % 2 != 0 ? kPi / 2 : -kPi / 2;
    t.line(12 - 2 * radius);
  }
  return t;
}

Track with_chamfers(double p_mm, double size) {
  Track t(p_mm);
  t.line(12);
  for (int i = 0; i < 8; ++i) {
    const double turn = i % 2 != 0 ? kPi / 2 : -kPi / 2;
    t.heading += turn / 2;
    t.line(size);
    t.heading += turn / 2;
    t.line(12);
  }
  return t;
}

TEST(Coarse, TangentsTakeTheSigmaOfTheirArcAndStayNearIt) {
  test::HeapMemory memory;
  Buffer<CoarseLine> lines;
  ASSERT_TRUE(lines.create(memory, 20));
  const Tolerance tolerance{0.2, 0.2};
  for (const double sweep : {0.3, -1.2, 2.0, -3.0}) {
    Track t(0.2);
    t.arc(0.6, sweep, 0.3);
    const Piece& arc = t.moves[0].piece;
    lines.clear();
    const double share = tangents_of(arc, tolerance, 0.3, lines);
    ASSERT_GT(share, 0) << sweep;
    EXPECT_LE(share, 0.3);
    double sigma = 0;
    Vec at = arc.point(0);
    for (const CoarseLine& line : lines) {
      EXPECT_LE(max_abs(line.from - at), 1e-12);
      at += line.way;
      sigma += line.sigma;
    }
    EXPECT_NEAR(sigma, arc.length, 1e-12);
    EXPECT_LE(max_abs(at - arc.point(arc.length)), 1e-12);
    EXPECT_LE(max_abs(lines[0].from - arc.point(0)), 1e-12);
  }
}

TEST(Coarse, LargeArcsStayArcs) {
  test::HeapMemory memory;
  Buffer<CoarseLine> lines;
  ASSERT_TRUE(lines.create(memory, 20));
  Track t(0.01);
  t.arc(20, 2);
  EXPECT_LT(tangents_of(t.moves[0].piece, t.mode.tolerance, 0.3, lines), 0);
  EXPECT_TRUE(lines.empty());
}

TEST(Coarse, ChordsTakeTheSigmaOfTheirArcAndLeadToItsEnd) {
  test::HeapMemory memory;
  Buffer<CoarseLine> lines;
  ASSERT_TRUE(lines.create(memory, 20));
  Track t(0.2);
  t.arc(0.6, 1.0, 0.3);
  const Piece& arc = t.moves[0].piece;
  const double share = chords_of(arc, t.mode.tolerance, 0.6, 1, lines);
  ASSERT_EQ(lines.size(), 1U);
  // The sagitta.
  EXPECT_NEAR(share, 0.6 * (1 - std::cos(0.5)) / 0.2, 0.1 * share);
  EXPECT_EQ(lines[0].sigma, arc.length);
  EXPECT_LE(max_abs(lines[0].from + lines[0].way - arc.point(arc.length)), 1e-12);
  EXPECT_LT(chords_of(arc, t.mode.tolerance, 0.9 * share, 1, lines), 0);
  EXPECT_EQ(lines.size(), 1U);
}

TEST(Coarse, StraightenedLinesBendLessAndStayNearWhatTheyWereAtTheSameSigma) {
  test::HeapMemory memory;
  Buffer<CoarseLine> lines;
  Buffer<Vec> work;
  ASSERT_TRUE(lines.create(memory, 20) && work.create(memory, 21));
  const Tolerance tolerance{0.5, 2};
  std::vector<CoarseLine> were;
  Vec at;
  for (int k = 0; k < 12; ++k) {
    Vec way = xyz(0.3, k % 3 == 0 ? 0.2 : -0.3, 0.1 * (k % 2));
    way[3] = k % 4 == 0 ? 3 : -1;
    were.push_back({at, way, 0.3 + 0.02 * k, {}});
    lines.push_back(were.back());
    at += way;
  }
  const auto bends = [](const auto& all) {
    double sum = 0;
    for (std::size_t k = 1; k < all.size(); ++k) {
      const Vec kink = all[k].way * (1 / all[k].sigma) - all[k - 1].way * (1 / all[k - 1].sigma);
      sum += dot(kink, kink) / (all[k].sigma + all[k - 1].sigma);
    }
    return sum;
  };
  const double before = bends(were), share = straighten_lines(tolerance, 0.6, false, lines, work);
  EXPECT_GT(share, 0.1);
  EXPECT_LE(share, 0.6);
  ASSERT_EQ(lines.size(), were.size());
  EXPECT_LT(bends(lines), 0.5 * before);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    EXPECT_EQ(lines[k].sigma, were[k].sigma);
    EXPECT_LE(tolerance.share(lines[k].from - were[k].from), share * (1 + 1e-9)) << k;
    const Vec end = k + 1 < lines.size() ? lines[k + 1].from : at;
    EXPECT_LE(max_abs(lines[k].from + lines[k].way - end), 1e-12) << k;
  }
  // What is beside them may depend on where they lead from and to.
  for (const std::size_t k : {std::size_t{0}, lines.size() - 1})
    EXPECT_LE(max_abs(lines[k].way - were[k].way), 1e-12) << k;
}

TEST(Coarse, PulledTautLinesAreShortWithinTheTolerance) {
  test::HeapMemory memory;
  Buffer<CoarseLine> lines;
  Buffer<Vec> work;
  ASSERT_TRUE(lines.create(memory, 60) && work.create(memory, 61));
  // Half a circle of R5 in chords: on its inside, half a millimetre nearer to its centre.
  constexpr int kCount = 50;
  const auto on = [](int k) {
    const double turn = kPi * k / kCount;
    return xyz(5 * std::cos(turn), 5 * std::sin(turn));
  };
  for (int k = 0; k < kCount; ++k)
    lines.push_back({on(k), on(k + 1) - on(k), 5 * kPi / kCount, {}});
  EXPECT_NEAR(straighten_lines({1, 1}, 0.5, true, lines, work), 0.5, 1e-9);
  for (int k = kCount / 4; k < 3 * kCount / 4; ++k)
    EXPECT_NEAR(norm3(lines[static_cast<std::size_t>(k)].from, 0), 4.5, 0.02) << k;
}

/// Hilbert curve of 255 lines.
Track winding(double p_mm, double leg) {
  Track t(p_mm);
  const std::function<void(int, int)> draw = [&](int level, int turn) {
    if (level == 0) return;
    t.heading += turn * kPi / 2;
    draw(level - 1, -turn);
    t.line(leg);
    t.heading -= turn * kPi / 2;
    draw(level - 1, turn);
    t.line(leg);
    draw(level - 1, turn);
    t.heading -= turn * kPi / 2;
    t.line(leg);
    draw(level - 1, -turn);
    t.heading += turn * kPi / 2;
  };
  draw(4, 1);
  return t;
}

TEST(Coarse, WhatWindsWithinTheToleranceIsDrivenStraighter) {
  // Only smoothed, in parts of 200 lines, 1.81 and 2.58 s; in parts of 48 2.2 and 3.7.
  for (const AxisLimits& limits : {mill(), with_jerk()}) {
    const Track t = winding(0.5, 0.5);
    const Driven found = drive(t, kFar, limits);
    EXPECT_LE(found.seconds, limits.jerks ? 2.45 : 1.75);
    EXPECT_LE(found.off, 0.5 * (1 + kChords));
    EXPECT_NEAR(found.sigma, sigma_of(t), 1e-9);
    EXPECT_EQ(found.stops, 0);
    // Soft limits at the path's own edge.
    double high = -1e99;
    for (const Move& m : t.moves) high = std::max(high, max_abs(m.piece.point(0)));
    EXPECT_LE(drive(t, high + 1e-9, limits).high, high + 2e-9);
  }
}

TEST(Coarse, PairsOfLinesBecomeOneWhereTheirEndIsOffByLittle) {
  Buffer<CoarseLine> lines;
  test::HeapMemory memory;
  ASSERT_TRUE(lines.create(memory, 6));
  // The fourth could join the second and third as well: no line stands for more than two. The first and the last one are not to be joined.
  lines.push_back({xyz(-1, -0.01), xyz(1, 0.01), 1, {}});
  lines.push_back({xyz(0, 0), xyz(1, 0.01), 1, {}});
  lines.push_back({xyz(1, 0.01), xyz(0.1, 0), 0.1, {}});
  lines.push_back({xyz(1.1, 0.01), xyz(0.1, 0), 0.1, {}});
  lines.push_back({xyz(1.2, 0.01), xyz(0, 3), 3, {}});
  lines.push_back({xyz(1.2, 3.01), xyz(0, 1), 1, {}});
  const double off = join_pairs({1, 1}, 1, 5, lines);
  EXPECT_GT(off, 0);
  EXPECT_LE(off, 0.05);
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_LE(max_abs(lines[0].way - xyz(1, 0.01)), 1e-12);
  EXPECT_NEAR(lines[1].sigma, 1.1, 1e-12);
  EXPECT_LE(max_abs(lines[1].way - xyz(1.1, 0.01)), 1e-12);
  EXPECT_LE(max_abs(lines[3].from - xyz(1.2, 0.01)), 1e-12);
  EXPECT_LE(max_abs(lines[4].from - xyz(1.2, 3.01)), 1e-12);
}

TEST(Coarse, ArcsThatWindWithTinyLinesBetweenThemAreDrivenStraighter) {
  // In parts of 48, each line by itself, 1.43 and 1.73 s.
  for (const AxisLimits& limits : {mill(), with_jerk()}) {
    Track t(1);
    for (int i = 0; i < 80; ++i) {
      t.arc(2 + 7 * i % 11, (i * 5 % 7 < 4 ? 1 : -1) * (0.05 + 0.05 * (i * 3 % 11)));
      t.line(0.005 * (1 + i * i % 40));
      t.heading += 0.005 * (i % 5 - 2);
    }
    const Driven found = drive(t, kFar, limits);
    EXPECT_LE(found.seconds, limits.jerks ? 1.36 : 1.29);
    EXPECT_LE(found.off, 1 + kChords);
    EXPECT_EQ(found.stops, 0);
  }
}

/// Arcs to both sides that bend a little where they meet; with lines of `between` there.
Track fitted_arcs(double p_mm, double between) {
  Track t(p_mm);
  for (int i = 0; i < 12; ++i) {
    t.arc(3, i % 2 != 0 ? 0.7 : -0.7);
    t.heading += i % 3 != 0 ? 0.03 : -0.045;
    if (between > 0 && i < 11) t.line(between);
  }
  return t;
}

TEST(Blends, GoOverMovesThatWouldKeepThemNarrow) {
  for (const AxisLimits& limits : {mill(), with_jerk()})
    for (const double between : {0.005, 0.05}) {
      const Driven none = drive(fitted_arcs(0.01, 0), kFar, limits),
                   some = drive(fitted_arcs(0.01, between), kFar, limits);
      EXPECT_LE(some.seconds, 1.06 * none.seconds) << between << " mm, jerk " << limits.jerks;
      EXPECT_LE(some.off, 0.01 * (1 + kChords)) << between << " mm, jerk " << limits.jerks;
      EXPECT_NEAR(some.sigma, sigma_of(fitted_arcs(0.01, between)), 1e-9);
      EXPECT_EQ(some.stops, 0);
    }
}

TEST(Blends, LeaveNoSliverOfAnArc) {
  // Both neighbours let the blends take nearly half of it.
  for (const double more : {0.0, 1e-4, 1e-3, 4e-3, 0.02}) {
    Track t(0.05);
    for (const double length : {2.0, 2 + more, 2.0}) {
      t.arc(9, length / 9);
      t.heading += 0.02;
    }
    const Driven found = drive(t, kFar, with_jerk());
    EXPECT_EQ(found.stops, 0);
    EXPECT_GE(found.shortest_arc, 0.0049) << more;
    EXPECT_NEAR(found.sigma, 6 + more, 1e-9);
  }
}

TEST(Coarse, FilletsWithinTheToleranceCostNoTimeWithJerkLimits) {
  const Driven sharp = drive(with_fillets(0.2, 0), kFar, with_jerk()),
               round = drive(with_fillets(0.2, 0.1), kFar, with_jerk());
  EXPECT_LE(round.seconds, 1.1 * sharp.seconds);
  EXPECT_LE(round.off, 0.2 * (1 + kChords));
}

TEST(Coarse, FilletsWithinTheToleranceCostNoTime) {
  const Driven sharp = drive(with_fillets(0.2, 0)), round = drive(with_fillets(0.2, 0.1));
  EXPECT_LE(round.seconds, 1.02 * sharp.seconds);
  EXPECT_LE(round.off, 0.2 * (1 + kChords));
  EXPECT_NEAR(round.sigma, sigma_of(with_fillets(0.2, 0.1)), 1e-9);
}

TEST(Coarse, ChamfersWithinTheToleranceCostNoTime) {
  const Driven sharp = drive(with_chamfers(0.2, 1e-6)), chamfered = drive(with_chamfers(0.2, 0.1));
  EXPECT_LE(chamfered.seconds, 1.02 * sharp.seconds);
  EXPECT_LE(chamfered.off, 0.2 * (1 + kChords));
  EXPECT_NEAR(chamfered.sigma, sigma_of(with_chamfers(0.2, 0.1)), 1e-9);
}

/// Lines of about `leg` that turn to the left and to the right by `degrees`, in no order.
Track polyline(double p_mm, double leg, double degrees) {
  Track t(p_mm);
  const int side[] = {1, 1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, 1};
  const double share[] = {0.9, 1.2, 0.8, 1.1, 1, 0.85, 1.15};
  t.heading = 0.4;
  for (int i = 0; i < 14; ++i) {
    t.line(leg * share[i % 7]);
    t.heading += side[i] * degrees * kPi / 180;
  }
  return t;
}

TEST(Corners, MoreToleranceIsNeverSlower) {
  for (const double leg : {1.0, 3.0, 8.0, 20.0})
    for (const double degrees : {10.0, 20.0, 45.0, 90.0, 135.0, 165.0}) {
      double before = 1e99;
      for (const double p : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5}) {
        const Driven found = drive(polyline(p, leg, degrees));
        EXPECT_LE(found.seconds, 1.01 * before) << leg << " mm, " << degrees << " degrees, P" << p;
        EXPECT_LE(found.off, p * (1 + kChords)) << leg << " mm, " << degrees << " degrees, P" << p;
        before = found.seconds;
      }
    }
}

TEST(Corners, KeepTheirOwnToleranceBesideOthers) {
  constexpr double kSmall = 0.02, kLarge = 0.5;
  const auto polylines = [](double first, double second) {
    Track t = polyline(first, 3, 90);
    t.mode.tolerance = {second, second};
    for (int i = 0; i < 14; ++i) {
      t.line(3);
      t.heading += (i % 4 < 2 ? 1 : -1) * kPi / 2;
    }
    return t;
  };
  const double small = drive(polylines(kSmall, kSmall)).seconds,
               large = drive(polylines(kLarge, kLarge)).seconds;
  const Track mixed = polylines(kSmall, kLarge);
  EXPECT_LT(drive(mixed).seconds, small - 0.4 * (small - large));
  EXPECT_LT(drive(polylines(kLarge, kSmall)).seconds, small - 0.4 * (small - large));
  // Alone and beside the others.
  test::HeapMemory memory;
  ProgramPath path;
  Buffer<Piece> out;
  ASSERT_TRUE(path.create(memory, 100) && out.create(memory, 1400));
  PathSettings settings;
  settings.low = everywhere(-kFar);
  settings.high = everywhere(kFar);
  settings.limits = mill();
  path.configure(settings);
  path.make(mixed.moves.data(), mixed.moves.size(), out);
  std::vector<Vec> programmed;
  for (const Move& m : mixed.moves) programmed.push_back(m.piece.point(0));
  programmed.push_back(mixed.at);
  double narrow = 0;  // of the moves with little
  for (const Move& m : mixed.moves)
    if (m.mode.tolerance.mm == kSmall) narrow += m.piece.length;
  double sigma = 0, off = 0;
  for (const Piece& p : out)
    for (int k = 0; k < kSteps; ++k, sigma += p.length / kSteps)
      if (sigma < narrow) off = std::max(off, distance(p.point(p.length * k / kSteps), programmed));
  EXPECT_LE(off, kSmall * (1 + 1e-9));
  EXPECT_GT(off, 0.5 * kSmall);
}

/// The polyline's curve by the smoother alone.
double smoothed(const Track& t, bool inside, const AxisLimits& limits) {
  test::HeapMemory memory;
  Smoother smoother;
  Chain chain;
  Buffer<Piece> out;
  Buffer<double> x;
  EXPECT_TRUE(smoother.create(memory, 50) && chain.create(memory, 50) && out.create(memory, 900) &&
              x.create(memory, 9000));
  SmoothingSettings settings;
  settings.tolerance = t.mode.tolerance;
  settings.peaked = limits.jerks;
  settings.inside = inside;
  settings.low = everywhere(-kFar);
  settings.high = everywhere(kFar);
  double sigma = 0;
  for (const Move& m : t.moves) {
    chain.at.push_back(m.piece.point(0));
    chain.sigma.push_back(sigma);
    chain.feed.push_back(m.piece.feed);
    sigma += m.piece.length;
  }
  chain.at.push_back(t.at);
  chain.sigma.push_back(sigma);
  EXPECT_LE(smoother.smooth(chain, settings, out), 1.0);
  return least_seconds(out.begin(), out.size(), limits, x);
}

TEST(Corners, TheFasterOfBothCurvesIsDriven) {
  // About the chain, or inside of it: each is the faster one somewhere.
  int inside_wins = 0, about_wins = 0;
  for (const AxisLimits& limits : {mill(), with_jerk()})
    for (const double leg : {0.2, 0.5, 1.0, 3.0})
      for (const double degrees : {10.0, 45.0, 90.0, 135.0}) {
        const Track t = polyline(0.1, leg, degrees);
        const double about = smoothed(t, false, limits), inside = smoothed(t, true, limits);
        inside_wins += inside < 0.98 * about ? 1 : 0;
        about_wins += about < 0.98 * inside ? 1 : 0;
        EXPECT_LE(drive(t, kFar, limits).seconds, 1.0001 * std::min(about, inside))
            << leg << " mm, " << degrees << " degrees, jerk " << limits.jerks;
      }
  EXPECT_GE(inside_wins, 3);
  EXPECT_GE(about_wins, 3);
}

TEST(Corners, ThoseThatAreWideEnoughForTheFeedAreDrivenAtIt) {
  const Track t = polyline(0.5, 20, 20);
  EXPECT_LE(drive(t).seconds, 1.01 * sigma_of(t) / kFeed);
}

TEST(Coarse, WhatHasNoRoomToTheSoftLimitStaysAsProgrammed) {
  Track t(0.2);
  t.line(3);
  t.arc(0.3, 2 * kPi / 3);  // too large for its chord
  t.line(3);
  const double high = 3.3;  // of the arc
  EXPECT_LE(drive(t, high).high, high + 1e-9);
  EXPECT_LT(drive(t).seconds, 0.98 * drive(t, high).seconds);
}

Track lines_and_arcs(double kink) {
  Track t(kExact, PathMode::Corners::exact_path);
  for (int i = 0; i < 10; ++i) {
    t.line(5);
    t.heading += i % 2 != 0 ? kink : -kink;
    t.arc(4, 1);
    t.heading += kink;
  }
  return t;
}

TEST(ExactPath, KinksFromRoundedPointsAreNoCorners) {
  const Driven rounded = drive(lines_and_arcs(0.0007)), smooth = drive(lines_and_arcs(0));
  EXPECT_EQ(rounded.stops, 0);
  EXPECT_LE(rounded.seconds, 1.05 * smooth.seconds);
}

TEST(ExactPath, CornersAreStops) {
  Track t(kExact, PathMode::Corners::exact_path);
  for (int i = 0; i < 4; ++i) {
    t.line(5);
    t.heading += 0.05;
  }
  EXPECT_EQ(drive(t).stops, 3);
}

}  // namespace
}  // namespace kerf::motion::path
