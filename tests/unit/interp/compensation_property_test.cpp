// Random closed contours: the compensated path keeps the tool's radius from the contour, everywhere and on the right side.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "interp/null_canon.hpp"
#include "rig.hpp"

namespace kerf::interp {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Point {
  double x{0}, y{0};
};
Point operator-(Point p, Point q) { return {p.x - q.x, p.y - q.y}; }
double length(Point p) { return std::hypot(p.x, p.y); }

/// A line, or an arc about `center` turning by `turn` (1, -1).
struct Piece {
  Point from, to, center;
  int turn{0};

  [[nodiscard]] double sweep() const {
    const double a = std::atan2(from.y - center.y, from.x - center.x);
    const double b = std::atan2(to.y - center.y, to.x - center.x);
    const double s = (b - a) * turn;
    return s > 1e-12 ? s : s + 2 * kPi;
  }
  [[nodiscard]] Point at(double t) const {
    if (turn == 0) return {from.x + (to.x - from.x) * t, from.y + (to.y - from.y) * t};
    const double a = std::atan2(from.y - center.y, from.x - center.x) + turn * sweep() * t;
    const double r = length(from - center);
    return {center.x + r * std::cos(a), center.y + r * std::sin(a)};
  }
  [[nodiscard]] double size() const {
    return turn == 0 ? length(to - from) : sweep() * length(from - center);
  }
  /// Direction at the start (0) or the end (1).
  [[nodiscard]] double heading(int end) const {
    if (turn == 0) return std::atan2(to.y - from.y, to.x - from.x);
    const Point p = (end == 0 ? from : to) - center;
    return std::atan2(p.y, p.x) + turn * kPi / 2;
  }
  [[nodiscard]] double distance(Point p) const {
    const double ends = std::min(length(p - from), length(p - to));
    if (turn == 0) {
      const Point d = to - from, e = p - from;
      const double t = (d.x * e.x + d.y * e.y) / (d.x * d.x + d.y * d.y);
      return t < 0 || t > 1 ? ends : length(p - at(t));
    }
    const double a = std::atan2(from.y - center.y, from.x - center.x);
    double s = (std::atan2(p.y - center.y, p.x - center.x) - a) * turn;
    while (s < 0) s += 2 * kPi;
    return s <= sweep() ? std::fabs(length(p - center) - length(from - center)) : ends;
  }
};

double turn_between(const Piece& p, const Piece& q) {
  return std::remainder(q.heading(0) - p.heading(1), 2 * kPi);
}

/// A star of lines and arcs around the origin; the first piece is a line. `swirl` turns its points like blades, so that walls overhang.
std::vector<Piece> contour(std::mt19937& random, int most_corners = 9, double swirl = 0) {
  const auto in = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const int n = std::uniform_int_distribution<int>(3, most_corners)(random);
  std::vector<Point> corners;
  for (int i = 0; i < n; ++i) {
    double angle = 2 * kPi * (i + in(-0.3, 0.3)) / n;
    const double r = in(10, 30);
    angle += swirl * (r - 20) / 10;
    corners.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  if (in(0, 1) < 0.5) std::reverse(corners.begin(), corners.end());
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Piece p{corners[i], corners[(i + 1) % corners.size()], {}, 0};
    if (i > 0 && in(0, 1) < 0.4) {
      const Point d = p.to - p.from;
      p.turn = in(0, 1) < 0.5 ? 1 : -1;
      const double off = in(0.6, 3) * p.turn;  // chords from the centre
      p.center = {(p.from.x + p.to.x) / 2 - off * d.y, (p.from.y + p.to.y) / 2 + off * d.x};
    }
    pieces.push_back(p);
  }
  return pieces;
}

std::string word(const char* letters, Point p) {
  char text[100];
  std::snprintf(text, sizeof text, " %c%.12f %c%.12f", letters[0], p.x, letters[1], p.y);
  return text;
}

std::string move(const Piece& p) {
  if (p.turn == 0) return "G1" + word("XY", p.to) + "\n";
  return (p.turn > 0 ? "G3" : "G2") + word("XY", p.to) + word("IJ", p.center - p.from) + "\n";
}

/// What the tool does between G41 and G40.
class Path final : public NullCanon {
 public:
  void straight_traverse(const Pose& end) override { add(end, {}, 0); }
  void straight_feed(const Pose& end) override { add(end, {}, 0); }
  void arc_feed(const Arc& arc) override {
    add(arc.end, {arc.center[0], arc.center[1]}, arc.turns > 0 ? 1 : -1);
  }
  std::vector<Piece> pieces;

 private:
  void add(const Pose& end, Point center, int turn) {
    pieces.push_back({at_, {end.x, end.y}, center, turn});
    at_ = {end.x, end.y};
  }
  Point at_;
};

bool inside(const std::vector<Piece>& shape, Point p) {
  bool odd = false;
  for (const Piece& piece : shape) {
    constexpr int kSteps = 60;
    for (int i = 0; i < kSteps; ++i) {
      const Point a = piece.at(double(i) / kSteps), b = piece.at(double(i + 1) / kSteps);
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
        odd = !odd;
    }
  }
  return odd;
}

/// The contour crosses itself (arcs may) or comes nearer to itself than `room`, or a corner is none (the peer's path is inexact
/// there).
bool unsuitable(const std::vector<Piece>& shape, double room = 2.5) {
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const double turn = std::fabs(turn_between(shape[i], shape[(i + 1) % shape.size()]));
    if (turn < 0.06 || turn > kPi - 0.2) return true;
    for (std::size_t k = 0; k < shape.size(); ++k) {
      const bool next = k == i || k == (i + 1) % shape.size() || i == (k + 1) % shape.size();
      for (int s = 1; s < 20 && !next; ++s)
        if (shape[k].distance(shape[i].at(s / 20.0)) < room) return true;
    }
  }
  return false;
}

TEST(CompensationProperty, the_tool_keeps_its_radius_from_random_contours) {
  int kept = 0, refused = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    const std::vector<Piece> shape = contour(random);
    const bool left = random() % 2 == 0;
    const double radius = std::uniform_real_distribution<double>(0.2, 1.0)(random);
    if (unsuitable(shape)) continue;
    // From the middle of the first line around and back to it.
    const Point middle = shape[0].at(0.5);
    std::string program = "G21 F100\nG0" + word("XY", shape[0].at(0.1)) + "\n";
    char on[40];
    std::snprintf(on, sizeof on, "%s D%.12f\n", left ? "G41.1" : "G42.1", 2 * radius);
    program += on + ("G1" + word("XY", middle)) + "\n";
    for (std::size_t i = 0; i < shape.size(); ++i) program += move(shape[i]);
    program += "G1" + word("XY", middle) + "\nG40\nM2\n";
    BenchEnvironment world;
    Path path;
    bool good = false;
    {
      Interpreter interp(world, path);
      interp.init();
      ASSERT_TRUE(interp.open_text("t.ngc", program).ok());
      Outcome o = Outcome::ok;
      while (o == Outcome::ok) o = interp.execute_next();
      good = o == Outcome::program_end;
    }
    if (!good) {
      ++refused;
      continue;
    }
    ++kept;
    double area = 0;
    for (const Piece& p : shape) area += p.from.x * p.to.y - p.to.x * p.from.y;
    const bool within = (area > 0) == left;
    ASSERT_GT(path.pieces.size(), 3u);
    for (std::size_t i = 2; i < path.pieces.size(); ++i) {  // behind the way in
      const Piece& p = path.pieces[i];
      const int steps = std::max(2, static_cast<int>(p.size() / 0.05));
      for (int s = 0; s <= steps; ++s) {
        const Point at = p.at(static_cast<double>(s) / steps);
        double nearest = 1e9;
        for (const Piece& c : shape) nearest = std::min(nearest, c.distance(at));
        ASSERT_NEAR(nearest, radius, 1e-6) << "seed " << seed << "\n" << program;
        if (s == steps / 2) {
          ASSERT_EQ(inside(shape, at), within) << "seed " << seed << "\n" << program;
        }
      }
    }
    const Point last = path.pieces.back().to;
    const double side = left ? 1 : -1, heading = shape[0].heading(0);
    EXPECT_NEAR(last.x, middle.x - side * radius * std::sin(heading), 1e-6) << seed;
    EXPECT_NEAR(last.y, middle.y + side * radius * std::cos(heading), 1e-6) << seed;
  }
  EXPECT_GT(kept, 120);
  EXPECT_LT(refused, kept / 4);
}

/// The tool's path along the program; nullopt: an error, whose text is in `error`.
std::optional<Path> path_of(const std::string& program, int look_ahead, std::string& error) {
  BenchEnvironment world;
  Path path;
  Settings settings;
  settings.compensation_look_ahead = look_ahead;
  Interpreter interp(world, path, settings);
  interp.init();
  EXPECT_TRUE(interp.open_text("t.ngc", program).ok());
  Outcome o = Outcome::ok;
  while (o == Outcome::ok) o = interp.execute_next();
  error = o == Outcome::error ? interp.error().text : "";
  if (o != Outcome::program_end) return std::nullopt;
  return path;
}

TEST(CompensationProperty, look_ahead_refuses_what_gouges_and_nothing_else) {
  int legal = 0, gouges = 0;
  for (unsigned seed = 0; seed < 1500; ++seed) {
    std::mt19937 random(seed);
    const std::vector<Piece> shape = contour(random, 12, seed % 2 == 0 ? 1.5 : -1.5);
    const bool left = random() % 2 == 0;
    const double radius = std::uniform_real_distribution<double>(0.5, 8.0)(random);
    if (unsuitable(shape, 0.3)) continue;
    const Point middle = shape[0].at(0.5);
    std::string program = "G21 F100\nG0" + word("XY", shape[0].at(0.1)) + "\n";
    char on[40];
    std::snprintf(on, sizeof on, "%s D%.12f\n", left ? "G41.1" : "G42.1", 2 * radius);
    program += on + ("G1" + word("XY", middle)) + "\n";
    for (int round = 0; round < 2; ++round)
      for (const Piece& p : shape) program += move(p);
    program += "G1" + word("XY", middle) + "\nG40\nM2\n";
    std::string error;
    const auto plain = path_of(program, 0, error);
    if (!plain) continue;
    double nearest = 1e9;
    for (std::size_t i = 2; i < plain->pieces.size(); ++i) {
      const Piece& p = plain->pieces[i];
      const int steps = std::max(2, static_cast<int>(p.size() / 0.05));
      for (int s = 0; s <= steps; ++s)
        for (const Piece& c : shape)
          nearest = std::min(nearest, c.distance(p.at(static_cast<double>(s) / steps)));
    }
    if (nearest > 0.99 * radius - 0.01 && nearest < 0.9999 * radius) continue;  // either will do
    const int depth = static_cast<int>(shape.size()) + 2;
    const auto guarded = path_of(program, depth, error);
    if (nearest >= 0.9999 * radius) {
      ++legal;
      ASSERT_TRUE(guarded) << "seed " << seed << " " << error << "\n" << program;
      ASSERT_EQ(guarded->pieces.size(), plain->pieces.size()) << seed;
    } else {
      ++gouges;
      ASSERT_FALSE(guarded) << "seed " << seed << ": " << nearest << " of " << radius << "\n"
                            << program;
      ASSERT_EQ(error.substr(0, 16), "The tool gouges ") << seed;
    }
  }
  EXPECT_GT(legal, 100);
  EXPECT_GT(gouges, 20);
}

}  // namespace
}  // namespace kerf::interp
