// Curves that are moved within their tolerance: they stay in it, go on as they did at both ends, and ask for less jerk. KERF_COUNT chains at random (200), from KERF_SEED on (1).
#include "motion/core/path/relax.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "unit/motion/rig.hpp"
#include "unit/motion/vecs.hpp"

namespace kerf::motion::path {
namespace {

constexpr double kFar = 1e9;

std::uint64_t number(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

/// A chain, its smooth curve, and that curve relaxed.
class RelaxedChain : public testing::Test {
 protected:
  static constexpr std::size_t kLines = 120;

  void SetUp() override {
    ASSERT_TRUE(chain_.create(memory_, kLines) && smoother_.create(memory_, kLines) &&
                relaxer_.create(memory_, kLines) && smooth_.create(memory_, 40 * kLines));
    settings_.tolerance = {0.05, 0.05};
    settings_.peaked = true;
    settings_.low = everywhere(-kFar);
    settings_.high = everywhere(kFar);
    limits_.vel = everywhere(200);
    limits_.acc = everywhere(1750);
    limits_.jerk = everywhere(50000);
    limits_.jerks = true;
    begin({});
  }
  void begin(const Vec& at) {
    chain_.clear();
    chain_.at.push_back(at);
    chain_.sigma.push_back(0);
  }
  void line(const Vec& way, double keeps = 1, double feed = 100) {
    chain_.at.push_back(chain_.at.back() + way);
    chain_.sigma.push_back(chain_.sigma.back() + norm3(way, 0));
    Feed f;
    f.speed = feed;
    chain_.feed.push_back(f);
    chain_.within.push_back(keeps);
  }
  /// Legs along x and y that turn to the left and to the right in pairs: what fills a plane.
  void meander(double leg, int turns) {
    const Vec ways[] = {xyz(leg, 0), xyz(0, leg), xyz(leg, 0), xyz(0, -leg)};
    for (int i = 0; i < turns; ++i) line(ways[i % 4]);
  }
  bool relax() {
    smooth_.clear();
    EXPECT_LE(smoother_.smooth(chain_, settings_, smooth_), 1.0);
    return relaxer_.relax(chain_, settings_, limits_, smooth_, 0);
  }
  /// What is made least, at an even speed.
  static double jerk(const Buffer<Piece>& pieces) {
    double sum = 0;
    for (const Piece& p : pieces)
      for (std::size_t i = 0; i < 3; ++i) sum += p.d[i] * p.d[i] * p.length;
    return sum;
  }
  /// Looks at places of its own, not at coefficients.
  void expect_sound() {
    const Buffer<Piece>& made = relaxer_.relaxed();
    double sigma = 0, sharpest = 1;
    for (const Piece& p : smooth_) sharpest = std::max(sharpest, max_abs(p.c));
    std::size_t line = 0, was = 0;
    double was_sigma = 0;
    for (std::size_t p = 0; p < made.size(); ++p) {
      const Piece& piece = made[p];
      if (p > 0) {
        const Piece& before = made[p - 1];
        EXPECT_LE(max_abs(before.point(before.length) - piece.point(0)), 1e-9) << p;
        EXPECT_LE(max_abs(before.first(before.length) - piece.first(0)), 1e-8) << p;
        EXPECT_LE(max_abs(before.second(before.length) - piece.second(0)), 1e-8 * sharpest) << p;
      }
      constexpr int kLooks = 16;
      for (int k = 0; k <= kLooks; ++k) {
        const double at = std::min(sigma + piece.length * k / kLooks, chain_.sigma.back());
        while (line + 1 < chain_.lines() && chain_.sigma[line + 1] < at) ++line;
        while (line > 0 && chain_.sigma[line] > at) --line;
        const Vec off = piece.point(at - sigma) - chain_.at[line] -
                        chain_.direction(line) * (at - chain_.sigma[line]);
        EXPECT_LE(settings_.tolerance.share(off), chain_.keeps(line) + 1e-9) << "at " << at;
      }
      while (was + 1 < smooth_.size() && was_sigma + smooth_[was].length < sigma + 1e-9)
        was_sigma += smooth_[was++].length;
      EXPECT_EQ(piece.feed, smooth_[was].feed) << p;
      sigma += piece.length;
    }
    EXPECT_NEAR(sigma, chain_.sigma.back(), 1e-9);
    expect_same(made.front(), smooth_.front(), 0, 0);
    expect_same(made.back(), smooth_.back(), made.back().length, smooth_.back().length);
  }
  static void expect_same(const Piece& a, const Piece& b, double s, double t) {
    EXPECT_LE(max_abs(a.point(s) - b.point(t)), 1e-10);
    EXPECT_LE(max_abs(a.first(s) - b.first(t)), 1e-9);
    EXPECT_LE(max_abs(a.second(s) - b.second(t)), 1e-7);
  }

  test::HeapMemory memory_;
  Chain chain_;
  Smoother smoother_;
  Relaxer relaxer_;
  Buffer<Piece> smooth_;
  SmoothingSettings settings_;
  AxisLimits limits_;
};

TEST_F(RelaxedChain, SwingsOutBetweenCorners) {
  meander(0.5, 40);
  ASSERT_TRUE(relax());
  expect_sound();
  EXPECT_LT(jerk(relaxer_.relaxed()), 0.55 * jerk(smooth_));
  double most = 0;
  for (const Piece& p : relaxer_.relaxed()) most = std::max(most, p.point(p.length / 2)[1]);
  // Between two turns to the same side it is beyond the leg by nearly the tolerance.
  EXPECT_GT(most, 0.5 + 0.8 * settings_.tolerance.mm);
}

TEST_F(RelaxedChain, EachLineKeepsItsTolerance) {
  const Vec ways[] = {xyz(0.5, 0), xyz(0, 0.5), xyz(0.5, 0), xyz(0, -0.5)};
  for (int i = 0; i < 40; ++i) line(ways[i % 4], i > 15 && i < 25 ? 0.2 : 1.0);
  ASSERT_TRUE(relax());
  expect_sound();
}

TEST_F(RelaxedChain, LongStraightsStayProgrammed) {
  meander(0.5, 12);
  line(xyz(8, 0));
  line(xyz(0, 0.5));
  meander(0.5, 12);
  ASSERT_TRUE(relax());
  expect_sound();
  const Vec middle = (chain_.at[12] + chain_.at[13]) * 0.5;
  bool found = false;
  for (const Piece& p : relaxer_.relaxed()) {
    const double s = middle[0] - p.a[0];
    if (p.length < 1.5 || s < 0 || s > p.length) continue;
    found = true;
    EXPECT_TRUE(p.straight());
    EXPECT_LE(max_abs(p.point(s) - middle), 1e-12);
  }
  EXPECT_TRUE(found);
}

TEST_F(RelaxedChain, StaysAsItIsBesideSoftLimitsInThreadsAndWithoutTolerance) {
  meander(0.5, 40);
  settings_.high[1] = 0.5 + 0.9 * settings_.tolerance.mm;
  EXPECT_FALSE(relax());
  settings_.high[1] = 0.5 + 1.1 * settings_.tolerance.mm;
  EXPECT_TRUE(relax());
  // An axis that does not bend may be at its limit, and stays there.
  settings_.high[2] = 0;
  EXPECT_TRUE(relax());
  for (const Piece& p : relaxer_.relaxed()) EXPECT_EQ(p.point(p.length / 2)[2], 0);
  settings_.high[2] = kFar;
  chain_.feed[7].sync = true;
  EXPECT_FALSE(relax());
  chain_.feed[7].sync = false;
  limits_.jerk[0] = 0;
  EXPECT_FALSE(relax());
}

TEST_F(RelaxedChain, TheWeakestAxisCountsMost) {
  meander(0.5, 40);
  const auto share = [&](std::size_t axis) {
    double sum = 0;
    for (const Piece& p : relaxer_.relaxed()) sum += p.d[axis] * p.d[axis] * p.length;
    return sum;
  };
  ASSERT_TRUE(relax());
  const double x = share(0);
  limits_.jerk[0] /= 4;
  ASSERT_TRUE(relax());
  expect_sound();
  EXPECT_LT(share(0), 0.97 * x);
}

TEST_F(RelaxedChain, AtRandom) {
  const std::uint64_t first = number("KERF_SEED", 1), count = number("KERF_COUNT", 200);
  std::uint64_t moved = 0;
  for (std::uint64_t seed = first; seed < first + count && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto between = [&](double lo, double hi) {
      return std::uniform_real_distribution<double>(lo, hi)(random);
    };
    settings_.tolerance.mm = std::pow(10, between(-3, -0.5));
    for (std::size_t i = 0; i < 3; ++i) {
      limits_.jerk[i] = std::pow(10, between(3.5, 5.5));
      limits_.acc[i] = std::pow(10, between(2.5, 3.8));
    }
    begin(xyz(between(-500, 500), between(-500, 500), between(-50, 50)));
    const double usual = settings_.tolerance.mm * std::pow(10, between(0, 1.6)),
                 bend = between(0.01, 2.5), tilt = between(0, 1), uneven = between(0, 1);
    const bool keeps = seed % 3 == 0, feeds = seed % 4 == 0;
    double heading = 0, feed = 100;
    const int lines = static_cast<int>(between(4, kLines));
    for (int i = 0; i < lines; ++i) {
      heading += between(-bend, bend);
      const double rise = between(-tilt, tilt), length = usual * std::pow(10, between(-uneven, 0));
      if (feeds && i % 7 == 0) feed = between(10, 200);
      line(xyz(std::cos(heading) * std::cos(rise), std::sin(heading) * std::cos(rise),
               std::sin(rise)) *
               length,
           keeps && i % 5 == 0 ? between(0.05, 1) : 1.0, feed);
    }
    if (!relax()) continue;
    ++moved;
    expect_sound();
  }
  EXPECT_GT(moved, count * 3 / 4);
}

}  // namespace
}  // namespace kerf::motion::path
