// Blends by themselves: how far they are from what is programmed, to which side, and how hard they bend.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
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

/// Where a curve is, how it goes on and how it bends.
struct State {
  Vec at, first, second;
  [[nodiscard]] double apart(const State& other) const {
    return std::max(
        {max_abs(at - other.at), max_abs(first - other.first), max_abs(second - other.second)});
  }
};
State state_at(const Piece& p, double s) { return {p.point(s), p.first(s), p.second(s)}; }

/// Chains that are smoothed part by part: each part is cut where it bends, and goes on with more lines behind it.
class CutChains {
 public:
  CutChains() {
    EXPECT_TRUE(all_.create(memory_, kLines) && part_.create(memory_, kLines) &&
                smoother_.create(memory_, kLines) && lead_.create(memory_, kLines) &&
                rest_.create(memory_, kLines) && out_.create(memory_, 40 * kLines));
  }
  static constexpr std::size_t kLines = 400;

  /// Lines of any lengths at angles of at most `kink`; `mixed`: some of them keep a tolerance twenty times smaller.
  void draw(std::uint64_t seed, double length, double kink, bool mixed = false) {
    std::mt19937_64 random(seed);
    const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    double heading = 0, sigma = 0;
    Vec at;
    all_.clear();
    for (std::size_t i = 0; i < kLines; ++i) {
      all_.at.push_back(at);
      all_.sigma.push_back(sigma);
      all_.feed.push_back(Feed{.speed = random() % 4 == 0 ? 50.0 : 80.0});
      all_.within.push_back(mixed && i / 50 % 2 != 0 ? 0.05 : 1.0);
      const double step = length * (0.1 + 1.8 * share());
      heading += kink * (std::sin(0.1 * static_cast<double>(i)) + 0.3 * (2 * share() - 1));
      at[0] += step * std::cos(heading);
      at[1] += step * std::sin(heading);
      sigma += step;
    }
    all_.at.push_back(at);
    all_.sigma.push_back(sigma);
  }
  /// `step` lines more each time; `as_it_was`: at each second cut it goes on as the part before would have.
  void drive(std::size_t step, bool as_it_was) {
    out_.clear();
    SmoothingSettings settings;
    settings.peaked = true;
    settings.low = everywhere(-1e9);
    settings.high = everywhere(1e9);
    std::size_t first = 0;  // vertex
    double taken = 0;       // of the line behind it
    for (std::size_t end = 2 * step; first < kLines; end += step) {
      const bool last = end >= kLines;
      end = std::min(end, kLines);
      const double most = take(first, taken, end, last);
      settings.tolerance = {kP * most, kP * most};
      const bool leads = lead_.on;
      const std::size_t before = out_.size();
      const bool as_before = leads && as_it_was && ++turn_ % 2 == 0;
      if (!as_before) {
        const double worst = smoother_.smooth(part_, settings, out_, leads ? &lead_ : nullptr);
        ASSERT_TRUE(leads || worst <= 1.0);
        // What is spread already may ask for what the new lines leave no room for.
        if (worst > 1.0) ++failed_;
        if (worst > 1.0) out_.truncate(before);
      }
      if (out_.size() == before) {
        ++gone_on_;
        smoother_.go_on(part_, lead_, out_);
        watch(before);
        first += lead_.lines() - 1;
        taken = (all_.sigma[first + 1] - all_.sigma[first]) / 2;
        lead_.on = false;
        end -= step;
        continue;
      }
      if (last) {
        watch(before);
        break;
      }
      const std::size_t at = smoother_.cut(part_, part_.lines() / 2, out_, rest_);
      watch(before);
      if (at == 0) {
        // It is driven to the middle of the last line.
        ++halved_;
        first = end - 1;
        taken = (all_.sigma[end] - all_.sigma[first]) / 2;
        lead_.on = false;
        continue;
      }
      ASSERT_GT(rest_.lines(), 1U);
      ++cuts_;
      EXPECT_LE(
          state_at(out_.back(), out_.back().length).apart({rest_.at, rest_.first, rest_.bend[0]}),
          1e-9);
      first += at;
      taken = 0;
      std::swap(lead_, rest_);
    }
    const Piece& end = out_.back();
    EXPECT_LE(max_abs(end.point(end.length) - all_.at.back()), 1e-9);
    EXPECT_LE(max_abs(end.first(end.length) - all_.direction(kLines - 1)), 1e-9);
    lead_.on = false;
  }
  std::size_t cuts_{0}, gone_on_{0}, failed_{0}, halved_{0};

 private:
  /// The chain from there to vertex `end`, of its last line only half if more follow. Gives the largest share of kP that one of its lines keeps.
  double take(std::size_t first, double taken, std::size_t end, bool last) {
    part_.clear();
    const double begin = all_.sigma[first] + taken,
                 most = *std::max_element(all_.within.begin() + first, all_.within.begin() + end);
    for (std::size_t v = first; v < end; ++v) {
      part_.at.push_back(v == first ? all_.at[v] + all_.direction(v) * taken : all_.at[v]);
      part_.sigma.push_back(v == first ? 0.0 : all_.sigma[v] - begin);
      part_.feed.push_back(all_.feed[v]);
      part_.within.push_back(all_.within[v] / most);
    }
    const double half = (all_.sigma[end] - all_.sigma[end - 1]) / 2;
    part_.at.push_back(last ? all_.at[end] : all_.at[end] - all_.direction(end - 1) * half);
    part_.sigma.push_back(all_.sigma[end] - (last ? 0.0 : half) - begin);
    return most;
  }
  /// New pieces from `before` on: no jump where they meet, and none farther from the chain than the tolerance.
  void watch(std::size_t before) {
    double sigma = 0;
    for (std::size_t p = 0; p < before; ++p) sigma += out_[p].length;
    std::size_t line = 0;
    for (std::size_t p = before; p < out_.size(); ++p) {
      const Piece& piece = out_[p];
      if (p > 0) {
        EXPECT_LE(state_at(out_[p - 1], out_[p - 1].length).apart(state_at(piece, 0)), 1e-8)
            << "at " << sigma;
      }
      for (int k = 0; k <= 10; ++k) {
        const double s = sigma + piece.length * k / 10;
        while (line + 1 < kLines && all_.sigma[line + 1] <= s) ++line;
        const Vec on = all_.at[line] + all_.direction(line) * (s - all_.sigma[line]);
        EXPECT_LE(norm3(piece.point(piece.length * k / 10) - on, 0), kP * all_.keeps(line) + 1e-9)
            << "at " << s;
      }
      sigma += piece.length;
    }
  }

  test::HeapMemory memory_;
  Chain all_, part_;
  Smoother smoother_;
  Lead lead_, rest_;
  Buffer<Piece> out_;
  int turn_{0};
};

/// The largest |q''| in the middle of short lines along a circle, each second point of which has no corner, that begin at `x`.
double bend_of_stream(double x) {
  constexpr std::size_t kLines = 400;
  constexpr double kStep = 0.02, kRadius = 12.5;
  test::HeapMemory memory;
  Chain chain;
  Smoother smoother;
  Buffer<Piece> out;
  EXPECT_TRUE(chain.create(memory, kLines) && smoother.create(memory, kLines) &&
              out.create(memory, 6 * kLines));
  const auto corner = [&](std::size_t i) {
    const double angle = 2 * kStep * static_cast<double>(i) / kRadius;
    // Numbers without rounding where they are halved: a middle that is no corner at all.
    const auto even = [](double v) { return std::round(v * 0x1p16) * 0x1p-16; };
    return xyz(x + even(kRadius * std::sin(angle)), even(kRadius * (1 - std::cos(angle))));
  };
  double sigma = 0;
  for (std::size_t i = 0; i <= kLines; ++i) {
    const Vec from = corner(i / 2), to = corner(i / 2 + 1);
    chain.at.push_back(i % 2 == 0 ? from : (from + to) * 0.5);
    if (i > 0) sigma += norm3(chain.at[i] - chain.at[i - 1], 0);
    chain.sigma.push_back(sigma);
    if (i < kLines) chain.feed.push_back(Feed{});
  }
  SmoothingSettings settings;
  settings.tolerance = {0.01, 0.01};
  settings.peaked = true;
  settings.low = everywhere(-1e9);
  settings.high = everywhere(1e9);
  EXPECT_LE(smoother.smooth(chain, settings, out), 1.0);
  double bend = 0, at = 0;
  for (const Piece& p : out) {
    at += p.length;
    if (at > sigma / 3 && at < sigma * 2 / 3) bend = std::max(bend, max_abs(p.second(p.length)));
  }
  return bend;
}

TEST(Blends, RoundingFarFromZeroIsNoCorner) {
  const double near = bend_of_stream(0);
  EXPECT_NEAR(near, 1 / 12.5, 0.01);
  for (const double x : {130.0, 777.0, 5000.0})
    EXPECT_LE(bend_of_stream(x), 1.1 * near) << "at " << x;
}

TEST(Blends, ACurveThatWasCutKeepsTheToleranceOfEachLine) {
  CutChains chains;
  for (std::uint64_t seed = 1; seed <= 40 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    chains.draw(seed, 0.02 * std::pow(2.0, static_cast<double>(seed % 7)),
                0.003 * std::pow(3.0, static_cast<double>(seed % 6)), true);
    chains.drive(seed % 3 == 0 ? 20 : 80, false);
  }
  EXPECT_GT(chains.cuts_, 100U);
}

TEST(Blends, ACurveThatWasCutGoesOnWithoutAJump) {
  CutChains chains;
  for (std::uint64_t seed = 1; seed <= 40 && !testing::Test::HasFailure(); ++seed)
    for (const bool as_it_was : {false, true}) {
      SCOPED_TRACE(seed);
      const double length = 0.02 * std::pow(2.0, static_cast<double>(seed % 7)),
                   kink = 0.003 * std::pow(3.0, static_cast<double>(seed % 6));
      chains.draw(seed, length, kink);
      chains.drive(seed % 3 == 0 ? 20 : 80, as_it_was);
    }
  EXPECT_GT(chains.cuts_, 200U);
  EXPECT_GT(chains.gone_on_, 50U);
  EXPECT_LE(chains.failed_, chains.cuts_ / 20);
  EXPECT_LE(chains.halved_, chains.cuts_ / 20);
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

TEST(Blends, ArcsMeetWithNearlyTheLeastJerkThatThereIs) {
  // The least of any curve within P on 2 mm of both arcs, by a linear program (kink, jump of curvature 0.5/mm or none):
  // tests/bench/motion/junction_shapes.py --least KINK JUMP P 2.
  struct Case {
    double kink, tolerance;
    bool turns;
    double least;
    double most{1.15};
  };
  // A kink is spread in its own direction while the arcs turn away from it, which costs where it is spread wide.
  for (const Case& c : {Case{0.1, 0.01, true, 0.3865},
                        {0, 0.01, true, 0.3246},
                        {0.3, 0.1, true, 0.2453},
                        {0.3, 0.01, false, 1.1109, 1.5},
                        {0.1, 0.1, true, 0.2141},
                        {0.05, 0.03, true, 0.2213}}) {
    SCOPED_TRACE("kink " + std::to_string(c.kink) + " P " + std::to_string(c.tolerance));
    const Met met = meeting(c.kink, true, c.tolerance, c.turns);
    // What the arcs have of themselves, 1/16, may come on top.
    EXPECT_LE(met.jerk, c.most * c.least + 1.0 / 16);
    EXPECT_LE(met.off, c.tolerance);
  }
}

}  // namespace
}  // namespace kerf::motion::path
