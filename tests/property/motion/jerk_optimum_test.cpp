// The offline optimum with jerk limits (bench/motion/jerk_optimum.hpp) against dynamic programming on the same grid.
//
// Both look for the least time under the same rows. The interior-point method finds a local optimum of a problem that is not convex; dynamic programming
// looks at all motions, in cells of speed and acceleration: of those that come to one cell at a node the fastest goes on, with its exact state. So what it
// finds can be driven, and the optimum may not be slower. That the optimum can be driven itself is seen by its rows.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "bench/motion/families.hpp"
#include "bench/motion/jerk_optimum.hpp"
#include "bench/motion/runs.hpp"
#include "property/motion/random_program.hpp"

namespace kerf::bench {
namespace {

constexpr std::size_t kSpeeds = 400, kAccs = 200;
constexpr int kChoices = 30;
constexpr double kNever = std::numeric_limits<double>::infinity();

struct Range {
  double low{-kNever}, high{kNever};
  /// Only what keeps |a + b u| <= most.
  void keep(double a, double b, double most) {
    if (b == 0) {
      if (std::abs(a) > most * (1 + 1e-9)) low = kNever;
      return;
    }
    const double p = (-most - a) / b, q = (most - a) / b;
    low = std::max(low, std::min(p, q));
    high = std::min(high, std::max(p, q));
  }
};

class Search {
 public:
  Search(const std::vector<CurveNode>& nodes, const JointLimits& limits)
      : nodes_(nodes), limits_(limits) {
    for (const CurveNode& n : nodes) top_ = std::max(top_, std::sqrt(n.cap));
    for (std::size_t j = 0; j < kOptimumJoints; ++j) most_acc_ = std::max(most_acc_, limits.acc[j]);
    // What jerk lets come of it on the way to full speed.
    cells_acc_ = std::min(1.5 * most_acc_, 1.2 * std::sqrt(limits.jerk[0] * top_));
  }

  /// Whether a motion with these x at the nodes keeps all limits, but for a share of 1e-6.
  [[nodiscard]] bool drives(const std::vector<double>& x) const {
    const std::size_t last = nodes_.size() - 1;
    constexpr double kRounding = 1e-6;
    if (x[1] > rest_cap(1, 0) * (1 + kRounding) ||
        x[last - 1] > rest_cap(last - 1, last - 1) * (1 + kRounding))
      return false;
    for (std::size_t i = 1; i < last; ++i) {
      State s;
      s.x = x[i];
      s.u = i == 1 ? 2 * x[1] / (3 * nodes_[0].way) : (x[i] - x[i - 1]) / (2 * nodes_[i - 1].way);
      const bool ends = i + 1 == last;
      const double u =
          ends ? -2 * x[i] / (3 * nodes_[i].way) : (x[i + 1] - x[i]) / (2 * nodes_[i].way);
      const double between = (i == 1 ? 0 : nodes_[i - 1].way / 2) + (ends ? 0 : nodes_[i].way / 2);
      Range r = by_jerk(i, s, between);
      if (!ends) by_acc(i, s, r);
      const double rounding = kRounding * most_acc_;
      if (u < r.low - rounding || u > r.high + rounding || x[i] > nodes_[i].cap * (1 + kRounding))
        return false;
    }
    return true;
  }

  /// Seconds from rest to rest.
  double run() {
    const std::size_t last = nodes_.size() - 1;
    std::vector<State> now(kSpeeds * kAccs), next;
    const double most = rest_cap(1, 0);
    for (std::size_t k = 1; k <= kSpeeds; ++k) {
      State s;
      const double v = std::sqrt(most) * static_cast<double>(k) / kSpeeds;
      s.x = v * v * (1 - 1e-12);
      s.u = 2 * s.x / (3 * nodes_[0].way);
      s.seconds = 3 * nodes_[0].way / v;
      put(now, s);
    }
    for (std::size_t i = 1; i + 1 < last; ++i) {
      next.assign(kSpeeds * kAccs, State{});
      for (const State& s : now)
        if (s.seconds < kNever) go_on(i, s, next);
      now.swap(next);
    }
    double best = kNever;
    const double way = nodes_[last - 1].way, cap = rest_cap(last - 1, last - 1);
    for (const State& s : now) {
      if (!(s.seconds < kNever) || s.x > cap) continue;
      const double after = -2 * s.x / (3 * way);
      const Range r = by_jerk(last - 1, s, nodes_[last - 2].way / 2);
      if (after >= r.low && after <= r.high)
        best = std::min(best, s.seconds + 3 * way / std::sqrt(s.x));
    }
    return best;
  }

 private:
  struct State {
    double seconds{kNever}, x{0}, u{0};  ///< u: on the way to the node
  };

  void put(std::vector<State>& cells, const State& s) const {
    const double speed = std::sqrt(s.x) / top_ * kSpeeds, acc = (s.u / cells_acc_ + 1) / 2 * kAccs;
    const auto row = std::min(static_cast<std::size_t>(std::max(speed, 0.0)), kSpeeds - 1);
    const auto column = std::min(static_cast<std::size_t>(std::max(acc, 0.0)), kAccs - 1);
    State& cell = cells[row * kAccs + column];
    if (s.seconds < cell.seconds) cell = s;
  }

  /// u behind the node that the jerk limits allow.
  [[nodiscard]] Range by_jerk(std::size_t i, const State& s, double between) const {
    Range r;
    const CurveNode& n = nodes_[i];
    const double v = std::sqrt(s.x);
    for (std::size_t j = 0; j < kOptimumJoints; ++j) {
      const double most = limits_.jerk[j] / v;
      // With the acceleration on the way there and on the way from there.
      r.keep(-n.p[j] * s.u / between + 3 * n.e[j] * s.u + n.c[j] * s.x, n.p[j] / between, most);
      r.keep(-n.p[j] * s.u / between + n.c[j] * s.x, n.p[j] / between + 3 * n.e[j], most);
    }
    return r;
  }

  void by_acc(std::size_t i, const State& s, Range& r) const {
    const CurveNode& n = nodes_[i];
    for (std::size_t j = 0; j < kOptimumJoints; ++j)
      r.keep(n.e_mid[j] * s.x, n.p_mid[j] + n.e_mid[j] * n.way, limits_.acc[j]);
  }

  void go_on(std::size_t i, const State& s, std::vector<State>& next) const {
    const CurveNode& n = nodes_[i];
    const double d = n.way;
    Range r = by_jerk(i, s, (i == 1 ? 0 : nodes_[i - 1].way / 2) + d / 2);
    by_acc(i, s, r);
    r.low = std::max(r.low, (1e-9 - s.x) / (2 * d));
    r.high = std::min(r.high, (nodes_[i + 1].cap - s.x) / (2 * d));
    if (!(r.low <= r.high)) return;
    for (int k = 0; k <= kChoices + 1; ++k) {
      State to;
      // The last one goes on as it came.
      to.u =
          k > kChoices ? std::clamp(s.u, r.low, r.high) : r.low + (r.high - r.low) * k / kChoices;
      to.x = s.x + 2 * d * to.u;
      if (!(to.x > 0)) continue;
      to.seconds = s.seconds + 2 * d / (std::sqrt(s.x) + std::sqrt(to.x));
      put(next, to);
    }
  }

  /// The largest x at the node next to a stop, which is left or reached with an even jerk.
  [[nodiscard]] double rest_cap(std::size_t i, std::size_t way_of) const {
    const CurveNode& n = nodes_[i];
    const double d = nodes_[way_of].way, sign = way_of < i ? 1 : -1;
    double cap = n.cap;
    for (std::size_t j = 0; j < kOptimumJoints; ++j) {
      // v^3 (p w + 3 e u + c) with u = 2 x / 3 d and w = 2 x / 9 d^2.
      const double jerk = std::abs(n.p[j] * 2 / (9 * d * d) + sign * 2 * n.e[j] / d + n.c[j]);
      const double acc = std::abs(sign * n.p[j] * 2 / (3 * d) + n.e[j]);
      if (jerk > 0) cap = std::min(cap, std::pow(limits_.jerk[j] / jerk, 2.0 / 3.0));
      if (acc > 0) cap = std::min(cap, limits_.acc[j] / acc);
    }
    return cap;
  }

  const std::vector<CurveNode>& nodes_;
  const JointLimits& limits_;
  double top_{0}, most_acc_{0}, cells_acc_{0};
};

/// A plane curve by the angle of its tangent and its first two derivatives.
struct Angle {
  double at{0}, first{0}, second{0};
};

std::vector<CurveNode> curve(double length, std::size_t steps, double feed,
                             const std::function<Angle(double)>& angle) {
  std::vector<CurveNode> nodes(steps + 1);
  const double d = length / static_cast<double>(steps);
  for (std::size_t i = 0; i <= steps; ++i) {
    CurveNode& n = nodes[i];
    const double s = d * static_cast<double>(i);
    const Angle a = angle(s), m = angle(s + d / 2);
    n.p[0] = std::cos(a.at), n.p[1] = std::sin(a.at);
    n.e[0] = -a.first * n.p[1], n.e[1] = a.first * n.p[0];
    n.c[0] = -a.second * n.p[1] - a.first * a.first * n.p[0];
    n.c[1] = a.second * n.p[0] - a.first * a.first * n.p[1];
    n.p_mid[0] = std::cos(m.at), n.p_mid[1] = std::sin(m.at);
    n.e_mid[0] = -m.first * n.p_mid[1], n.e_mid[1] = m.first * n.p_mid[0];
    n.way = i < steps ? d : 0;
    n.cap = feed * feed;
  }
  return nodes;
}

JointLimits limits_of(double acc, double jerk) {
  JointLimits limits;
  for (std::size_t j = 0; j < kOptimumJoints; ++j) limits.acc[j] = acc, limits.jerk[j] = jerk;
  return limits;
}

void compare(const std::vector<CurveNode>& nodes, const JointLimits& limits) {
  const JerkOptimum found = jerk_optimum(nodes, limits);
  Search search(nodes, limits);
  EXPECT_TRUE(search.drives(found.x)) << "the optimum cannot be driven";
  std::vector<double> faster = found.x;
  for (double& x : faster) x *= 1.02;
  EXPECT_FALSE(search.drives(faster)) << "there are no limits";
  const double searched = search.run();
  EXPECT_LE(found.seconds - found.gap_s, searched * 1.0005);
  // The fastest one to a cell need not be the best one in it.
  EXPECT_LE(searched, found.seconds * 1.15) << "the search found next to nothing";
}

TEST(JerkOptimum, IsTheClosedFormOnAStraight) {
  // Far enough for full acceleration and full speed: v/a + a/j and l/v.
  const double l = 12, v = 80, a = 1750, j = 50000;
  const auto nodes = curve(l, 600, v, [](double) { return Angle{}; });
  EXPECT_NEAR(jerk_optimum(nodes, limits_of(a, j)).seconds, l / v + v / a + a / j, 2e-3);
  compare(curve(2, 40, 80, [](double) { return Angle{}; }), limits_of(1750, 50000));
}

TEST(JerkOptimum, IsFoundByDynamicProgrammingToo) {
  const int count = motion::test::property_count(5);
  for (int i = 1; i <= count && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE("seed " + std::to_string(i));
    motion::test::Random r(static_cast<unsigned>(i));
    const double turn = r.uniform(0.3, 1.2), wave = r.uniform(1, 4), phase = r.uniform(0, 6);
    const auto nodes = curve(r.uniform(1, 4), 60, r.uniform(20, 120), [&](double s) {
      const double x = wave * s + phase;
      return Angle{turn * std::sin(x), turn * wave * std::cos(x),
                   -turn * wave * wave * std::sin(x)};
    });
    compare(nodes, limits_of(r.uniform(500, 3000), r.log(5000, 200000)));
  }
}

/// In the middle of such corners the path turns back across one axis, so that the jump of q''' there is all that counts.
TEST(JerkOptimum, IsHardlySlowerOnAFinerGrid) {
  Program program = zigzag(0.05, 100, 6.5);
  program.items.resize(12);
  const double jerk = 50000, coarse = least_time(program, jerk).seconds,
               fine = least_time(program, jerk, 4 * kLeastTimeSteps).seconds;
  EXPECT_NEAR(coarse, fine, 0.008 * fine);
}

}  // namespace
}  // namespace kerf::bench
