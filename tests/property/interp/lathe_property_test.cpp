// Lathe cycles on random parts: programs with G70, G71 and G72 run through the interpreter, and a model of the stock says
// whether a move cuts the part, runs through stock in rapid, or takes a layer that is too high.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "interp/interpreter.hpp"
#include "interp/lathe/profile.hpp"
#include "interp/null_canon.hpp"

namespace kerf::interp {
namespace {

using lathe::Move;
using lathe::Path;
using lathe::Point;

unsigned parts = 300;
unsigned only_seed = 0;

constexpr double kPi = 3.14159265358979323846;
constexpr double kSame = 2e-5;  ///< programs have six decimals, and steep walls make more of it

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double real(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(engine_);
  }
  int integer(int from, int to) { return std::uniform_int_distribution<int>(from, to)(engine_); }
  bool chance(double p) { return real(0, 1) < p; }

 private:
  std::mt19937 engine_;
};

double rounded(double v) { return std::nearbyint(v * 1e6) / 1e6; }
std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6f", v);
  return text;
}

/// A random part in coordinates (s, h), and how it lies in Z and X.
struct Part {
  Path moves;  ///< as written, with corners
  Point start;
  double cut, retract, finish;
  bool facing, flip_s, flip_h;
  int code;

  [[nodiscard]] double z(Point p) const {
    return facing ? (flip_h ? -p.h : p.h) : (flip_s ? -p.s : p.s);
  }
  [[nodiscard]] double x(Point p) const {
    return facing ? (flip_s ? -p.s : p.s) : (flip_h ? -p.h : p.h);
  }
  [[nodiscard]] Point back(double zz, double xx) const {
    const double s = facing ? xx : zz, h = facing ? zz : xx;
    return {flip_s ? -s : s, flip_h ? -h : h};
  }
  [[nodiscard]] bool mirrored() const { return facing != (flip_s != flip_h); }
  [[nodiscard]] std::string words(Point p) const {
    return "X" + number(x(p)) + " Z" + number(z(p));
  }
};

void add_line(Path& path, Point to) {
  const Point from = path.empty() ? to : path.back().to;
  to = {rounded(to.s), rounded(to.h)};
  if (std::hypot(to.s - from.s, to.h - from.h) > 1e-3) path.push_back({from, to});
}

void add_arc(Path& path, Random& r) {
  const Point from = path.back().to;
  const bool upper = r.chance(0.5);
  const double a = r.real(0, kPi), b = r.real(0, kPi);
  const double first = std::max(a, b), last = std::min(a, b), radius = r.real(0.5, 12);
  if (first - last < 0.05) return;
  const double side = upper ? 1 : -1;
  Move m;
  m.arc = true;
  m.ccw = !upper;
  m.from = from;
  m.center = {rounded(from.s - radius * std::cos(first)),
              rounded(from.h - side * radius * std::sin(first))};
  m.to = {rounded(m.center.s + radius * std::cos(last)),
          rounded(m.center.h + side * radius * std::sin(last))};
  if (std::hypot(m.to.s - from.s, m.to.h - from.h) > 1e-2 && m.to.s > from.s) path.push_back(m);
}

Part random_part(Random& r) {
  Part p;
  const Point first{rounded(r.real(-5, 5)), rounded(r.real(0, 20))};
  Path path;
  path.push_back({first, first});
  const int count = r.integer(1, 12);
  while (static_cast<int>(path.size()) <= count) {
    const Point at = path.back().to;
    const double kind = r.real(0, 1);
    if (kind < 0.35) {
      add_line(path, {at.s + r.real(0.05, 10), at.h + r.real(-10, 10)});
    } else if (kind < 0.5) {
      add_line(path, {at.s + r.real(0.05, 10), at.h});
    } else if (kind < 0.65 && path.back().from.s < at.s) {
      add_line(path, {at.s, at.h + r.real(-10, 10)});
    } else {
      add_arc(path, r);
    }
  }
  path.erase(path.begin());
  if (path.back().to.s - path.front().from.s < 0.1)
    add_line(path, {path.back().to.s + 3, path.back().to.h + 1});
  double highest = first.h;
  for (const Move& m : path) highest = std::max({highest, m.from.h, m.to.h});
  for (Move& m : path) {
    if (!r.chance(0.15)) continue;
    m.corner = rounded(r.real(0.01, 0.4));
    m.chamfer = r.chance(0.5);
  }
  p.moves = path;
  const double above = r.chance(0.85) ? highest + r.real(0, 6) : first.h + r.real(0.5, 6);
  p.start = {rounded(first.s + (r.chance(0.85) ? -r.real(0, 5) : r.real(0, 8))), rounded(above)};
  p.cut = rounded(r.real(0.3, 6));
  p.retract = r.chance(0.2) ? 0 : rounded(r.real(0, 2));
  p.finish = r.chance(0.3) ? 0 : rounded(r.real(0.01, 3));
  p.facing = r.chance(0.4);
  p.flip_s = r.chance(0.5);
  p.flip_h = r.chance(0.5);
  p.code = r.integer(0, 2);
  return p;
}

std::string sub_of(const Part& p) {
  std::string text = "O100 SUB\nG0 " + p.words(p.moves.front().from) + "\n";
  for (const Move& m : p.moves) {
    text += !m.arc ? "G1 " : m.ccw != p.mirrored() ? "G3 " : "G2 ";
    text += p.words(m.to);
    if (m.arc) {
      text +=
          " I" + number(p.x(m.center) - p.x(m.from)) + " K" + number(p.z(m.center) - p.z(m.from));
    }
    if (m.corner > 0) text += (m.chamfer ? " C" : " A") + number(m.corner);
    text += "\n";
  }
  return text + "O100 ENDSUB\n";
}

/// The moves of a program, as short straight pieces in (s, h).
class Recorder final : public NullCanon {
 public:
  struct Piece {
    Point from, to;
    bool rapid;
    bool cycle;  ///< not a G0 of the program
  };
  explicit Recorder(const Part& p) : part_(p) {}
  void next_block(const SourceLine& source) override { cycle_ = !source.text.starts_with("G0"); }
  void straight_traverse(const Pose& end) override { line(part_.back(end.z, end.x), true); }
  void straight_feed(const Pose& end) override { line(part_.back(end.z, end.x), false); }
  void arc_feed(const Arc& a) override {
    const Point c = part_.back(a.center[2], a.center[0]), from = at_;
    const Point to = part_.back(a.end.z, a.end.x);
    const bool ccw = (a.turns > 0) != part_.mirrored();
    const double r1 = std::hypot(from.s - c.s, from.h - c.h);
    const double r2 = std::hypot(to.s - c.s, to.h - c.h);
    EXPECT_NEAR(r1, r2, 1e-4);
    const double a1 = std::atan2(from.h - c.h, from.s - c.s);
    double sweep = std::atan2(to.h - c.h, to.s - c.s) - a1;
    if (ccw && sweep < -1e-6) sweep += 2 * kPi;
    if (!ccw && sweep > 1e-6) sweep -= 2 * kPi;
    EXPECT_LE(std::fabs(sweep), kPi + 1e-3) << "an arc turns back";
    constexpr int kPieces = 200;
    for (int i = 1; i < kPieces; ++i) {
      const double angle = a1 + sweep * i / kPieces;
      const double r = r1 + (r2 - r1) * i / kPieces;
      line({c.s + r * std::cos(angle), c.h + r * std::sin(angle)}, false);
    }
    line(to, false);
  }
  std::vector<Piece> pieces;

 private:
  void line(Point to, bool rapid) {
    pieces.push_back({at_, to, rapid, cycle_});
    at_ = to;
  }
  const Part& part_;
  Point at_{};
  bool cycle_{false};
};

/// Height of what is left of the stock, over samples of s. A sample lies inside its cell, never on a wall of the path.
class Stock {
 public:
  Stock(const Path& part, const Path& path, Point start) : part_(part), path_(path) {
    const Point begin = path.front().from;
    from_ = std::min(begin.s, start.s);
    const double to = path.back().to.s;
    cell_ = (to - from_) / kCells;
    for (int i = 0; i < kCells; ++i) {
      const double s = at(i);
      double h = start.h;
      // In front of the profile stock may reach to the line on which the tool enters.
      if (s < begin.s) h = start.h + (begin.h - start.h) * (s - from_) / (begin.s - from_);
      height_.push_back(h);
      floor_.push_back(s < begin.s
                           ? -1e9
                           : std::min({lathe::height_at(part, s), lathe::height_at(part, s - 1e-6),
                                       lathe::height_at(part, s + 1e-6)}));
    }
  }

  /// "" or what is wrong. `layer`: the highest cut.
  std::string move(const Recorder::Piece& m, double layer) {
    const Point a = m.from.s <= m.to.s ? m.from : m.to, b = m.from.s <= m.to.s ? m.to : m.from;
    const int first = std::max(0, static_cast<int>(std::ceil((a.s - from_) / cell_ - kInside)));
    const int last =
        std::min(kCells - 1, static_cast<int>(std::floor((b.s - from_) / cell_ - kInside)));
    for (int i = first; i <= last; ++i) {
      const double s = at(i);
      const double h =
          b.s - a.s < 1e-12 ? std::min(a.h, b.h) : a.h + (b.h - a.h) * (s - a.s) / (b.s - a.s);
      // Arcs come as chords, and steep walls make much of small errors in s.
      const double slack = kSame + slope(i) * 1e-3 + chord_;
      auto& height = height_[static_cast<std::size_t>(i)];
      const double floor = floor_[static_cast<std::size_t>(i)];
      if (h < floor - slack) return say("cuts the part", s, h, floor);
      if (m.rapid && h < height - slack) return say("runs through stock", s, h, height);
      if (!m.rapid && height - h > layer + slack) return say("takes too much", s, h, height);
      height = std::min(height, h);
    }
    return "";
  }
  void set_chord(double error) { chord_ = error; }
  /// "" or where the rest is not what it should be.
  std::string rest(double surface) {
    for (int i = 0; i < kCells; ++i) {
      const double want = std::min(surface, lathe::height_at(path_, at(i)));
      if (at(i) < path_.front().from.s) continue;
      const double slack = kSame + slope(i) * 1e-3 + chord_;
      if (std::fabs(height_[static_cast<std::size_t>(i)] - want) > slack)
        return say("is left", at(i), height_[static_cast<std::size_t>(i)], want);
    }
    return "";
  }

 private:
  static constexpr int kCells = 1500;
  static constexpr double kInside = 0.3819;
  [[nodiscard]] double at(int i) const { return from_ + (i + kInside) * cell_; }
  [[nodiscard]] double slope(int i) const {
    const double e = 1e-4;
    return (std::fabs(lathe::height_at(part_, at(i) + e) - lathe::height_at(part_, at(i))) +
            std::fabs(lathe::height_at(part_, at(i)) - lathe::height_at(part_, at(i) - e))) /
           e;
  }
  static std::string say(const char* what, double s, double h, double against) {
    return std::string(what) + " at s " + number(s) + ", h " + number(h) + " against " +
           number(against);
  }
  const Path& part_;
  const Path& path_;
  double from_, cell_, chord_{0.001};
  std::vector<double> height_, floor_;
};

std::string run(const std::string& program, Recorder& recorder, int& steps) {
  Environment nothing;
  Interpreter interp(nothing, recorder, Settings{});
  interp.init();
  EXPECT_TRUE(interp.open_text("part.ngc", program).ok());
  for (steps = 0; steps < 1000; ++steps) {
    const Outcome o = interp.execute_next();
    if (o == Outcome::error) return interp.error().text;
    if (o == Outcome::program_end) return "";
  }
  return "does not end";
}

std::string head(const Part& p) {
  return sub_of(p) + "G18 G21 G90 F100\nG0 " + p.words(p.start) + "\n";
}

bool same_corners(const Part& p, Path& profile) {
  Path with_way = p.moves;
  with_way.insert(with_way.begin(), Move{p.start, p.moves.front().from});
  const auto round = lathe::round_corners(with_way);
  if (!round) return false;
  profile.assign(round->begin() + 1, round->end());
  return lathe::runs_forward(profile);
}

std::string why_refused(const Path& way, Point start) {
  if (way.empty()) return "G7X error: The profile is too narrow for D";
  const double begin = way.front().from.s;
  if (start.s > begin) {
    for (int i = 0; i <= 1000; ++i) {
      if (lathe::height_at(way, begin + (start.s - begin) * i / 1000) > start.h + 1e-6)
        return "G7X error: The cycle begins inside the part";
    }
  }
  return "";
}

void rough_part(unsigned seed) {
  Random r(seed);
  const Part p = random_part(r);
  Path profile;
  const bool good = same_corners(p, profile);
  const std::string words =
      " D" + number(p.finish) + " I" + number(p.cut) + " R" + number(p.retract);
  const std::string g = p.facing ? "G72" : "G71";
  std::string program = head(p);
  if (p.code == 0) {
    program += g + " Q100" + words + "\n";
  } else {
    program +=
        g + ".1 Q100" + words + "\nG0 " + p.words(p.start) + "\n" + g + ".2 Q100" + words + "\n";
  }
  SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + program);
  Recorder recorder(p);
  int steps = 0;
  const std::string error = run(program + "M2\n", recorder, steps);
  if (!good) {
    EXPECT_EQ(error, "G7X error: Not monotonic");
    EXPECT_LE(recorder.pieces.size(), 1U) << "a profile in error moves the tool";
    return;
  }
  const Path path = lathe::allowance(profile, p.finish);
  const std::string refused = why_refused(path, p.start);
  ASSERT_EQ(error, refused);
  if (!refused.empty()) return;
  Stock stock(path, path, p.start);
  int moves = 0;
  for (const auto& m : recorder.pieces) {
    ++moves;
    if (!m.cycle) continue;
    const std::string wrong = stock.move(m, p.code == 0 ? p.cut : 1e9);
    ASSERT_EQ(wrong, "") << "move " << moves << " from s " << m.from.s << " h " << m.from.h
                         << " to s " << m.to.s << " h " << m.to.h << (m.rapid ? " rapid" : " feed");
  }
  EXPECT_EQ(stock.rest(p.start.h), "");
}

TEST(LatheProperty, RoughingCutsAllButTheAllowanceAndNothingElse) {
  if (only_seed != 0) return rough_part(only_seed);
  for (unsigned seed = 1; seed <= parts && !HasFailure(); ++seed) rough_part(seed);
}

void finish_part(unsigned seed) {
  Random r(seed + 1000000);
  Part p = random_part(r);
  p.facing = false;  // G70 tries Z first
  Path profile;
  if (!same_corners(p, profile)) return;
  const double last = r.chance(0.5) ? 0 : rounded(r.real(0, p.finish));
  const int passes = r.integer(1, 4);
  const std::string program = head(p) + "G70 Q100 D" + number(p.finish) + " E" + number(last) +
                              " P" + std::to_string(passes) + "\nM2\n";
  SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + program);
  Recorder recorder(p);
  int steps = 0;
  const std::string error = run(program, recorder, steps);
  const Path path = lathe::allowance(profile, last);
  if (error != "") {
    const double first = (passes - 1) * (p.finish - last) / passes + last;
    EXPECT_EQ(error, why_refused(lathe::allowance(profile, first), p.start));
    return;
  }
  Stock stock(path, path, p.start);
  for (std::size_t i = 0; i < recorder.pieces.size(); ++i) {
    const auto& m = recorder.pieces[i];
    if (!m.cycle) continue;
    // What roughing has left is not in the model: rapids must keep off the part only.
    const std::string wrong = stock.move({m.from, m.to, false, true}, 1e9);
    ASSERT_EQ(wrong, "") << "move " << i << (m.rapid ? " rapid" : " feed");
  }
  EXPECT_EQ(stock.rest(p.start.h), "");
}

TEST(LatheProperty, FinishingFollowsTheProfileAndKeepsOffThePart) {
  if (only_seed != 0) return finish_part(only_seed);
  for (unsigned seed = 1; seed <= parts && !HasFailure(); ++seed) finish_part(seed);
}

/// Height that a tool of radius d must keep over s, found by trying many points of the profile.
double brute_allowance(const Path& profile, double s, double d) {
  double highest = -1e9;
  const double from = std::max(profile.front().from.s, s - d),
               to = std::min(profile.back().to.s, s + d);
  constexpr int kTries = 2000;
  for (int i = 0; i <= kTries && from <= to; ++i) {
    const double t = from + (to - from) * i / kTries;
    highest = std::max(highest, lathe::height_at(profile, t) +
                                    std::sqrt(std::max(0.0, d * d - (s - t) * (s - t))));
  }
  for (const Move& m : profile) {
    for (const Point q : {m.from, m.to}) {
      if (std::fabs(q.s - s) < d)
        highest = std::max(highest, q.h + std::sqrt(d * d - (s - q.s) * (s - q.s)));
    }
  }
  return highest;
}

TEST(LatheProperty, TheAllowanceIsTheEnvelopeOfATurningDisc) {
  const unsigned count = std::max(1U, parts / 10);
  for (unsigned seed = 1; seed <= count && !HasFailure(); ++seed) {
    Random r(seed + 2000000);
    const Part p = random_part(r);
    Path profile;
    if (!same_corners(p, profile)) continue;
    const double d = r.real(0.05, 3);
    const Path path = lathe::allowance(profile, d);
    if (path.empty()) continue;
    SCOPED_TRACE("seed " + std::to_string(seed) + ", distance " + number(d) + "\n" + sub_of(p));
    for (std::size_t i = 1; i < path.size(); ++i) {
      ASSERT_NEAR(path[i].from.s, path[i - 1].to.s, 1e-9);
      ASSERT_NEAR(path[i].from.h, path[i - 1].to.h, 1e-6);
    }
    const double from = path.front().from.s, to = path.back().to.s;
    for (int i = 0; i < 60; ++i) {
      const double s = from + (to - from) * (i + 0.37) / 60;
      const double want = brute_allowance(profile, s, d), got = lathe::height_at(path, s);
      const double slope =
          std::fabs(lathe::height_at(path, s + 1e-4) - lathe::height_at(path, s - 1e-4)) / 2e-4;
      EXPECT_NEAR(got, want, 0.02 + slope * 0.01) << "at s " << s;
      EXPECT_GE(got, want - 1e-5 * (1 + slope)) << "at s " << s;
    }
  }
}

}  // namespace
}  // namespace kerf::interp

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i + 1 < argc; i += 2) {
    const auto number = static_cast<unsigned>(std::strtoul(argv[i + 1], nullptr, 10));
    if (std::string(argv[i]) == "--count") kerf::interp::parts = number;
    if (std::string(argv[i]) == "--seed") kerf::interp::only_seed = number;
  }
  return RUN_ALL_TESTS();
}
