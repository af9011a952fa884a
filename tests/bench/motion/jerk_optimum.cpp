#include "bench/motion/jerk_optimum.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::bench {
namespace {

constexpr int kMostIterations = 2000;
/// Relative to the time.
constexpr double kGap = 1e-4;
/// Share of the way to the nearest bound that a step may go.
constexpr double kToBound = 0.95;

/// sum a[k] x[first + k] <= right side; the jerk rows' right side is x^-1/2 of the node in the middle.
struct Row {
  std::array<double, 3> a{};
  double right{0};       ///< constant part
  std::size_t first{0};  ///< of three nodes
  bool jerk{false};      ///< the right side is x^-1/2 at `first` + 1
  double s{0}, z{0};     ///< slack and its multiplier
};

class Solver {
 public:
  Solver(const std::vector<CurveNode>& nodes, const JointLimits& limits)
      : nodes_(nodes), limits_(limits), last_(nodes.size() - 1), x_(nodes.size(), 0.0) {}

  JerkOptimum solve() {
    make_rows();
    first_guess();
    JerkOptimum out;
    double sum = update_slacks();
    double mu = 1e-2 * seconds() / static_cast<double>(rows_.size());
    for (Row& r : rows_) r.z = mu / r.s;
    for (; out.iterations < kMostIterations; ++out.iterations) {
      if (!newton(mu)) break;
      const auto [primal, dual] = step_lengths();
      for (std::size_t i = 1; i < last_; ++i) x_[i] += primal * dx_[i];
      for (std::size_t k = 0; k < rows_.size(); ++k)
        rows_[k].z = std::max(rows_[k].z + dual * dz_[k], 1e-30);
      sum = update_slacks();
      const double step = std::min(primal, dual);
      const double shrink = step > 0.9 ? 0.15 : step > 0.5 ? 0.4 : step > 0.2 ? 0.8 : 1.0;
      mu = shrink * sum / static_cast<double>(rows_.size());
      const double now = seconds();
      const bool settled = std::abs(now - before_) < kGap * now;
      before_ = now;
      if (sum < kGap * now && settled && step > 0.5) break;
    }
    out.seconds = seconds();
    out.gap_s = sum;
    out.x = x_;
    return out;
  }

 private:
  [[nodiscard]] bool is_inner(std::size_t i) const { return i > 0 && i < last_; }

  void add(Row row) {
    // Nodes at rest are no unknowns.
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_inner(row.first + k)) row.a[k] = 0;
      most = std::max(most, std::abs(row.a[k]));
    }
    if (most > 0) rows_.push_back(row);
  }

  void add_both(Row row) {
    add(row);
    for (double& a : row.a) a = -a;
    add(row);
  }

  void make_rows() {
    for (std::size_t i = 1; i < last_; ++i) {
      add({{0, 1 / nodes_[i].cap, 0}, 1, i - 1});
      jerk_rows(i);
    }
    for (std::size_t i = 1; i + 1 < last_; ++i) {
      const double d = nodes_[i].way;
      for (std::size_t j = 0; j < kOptimumJoints; ++j) {
        const double u = nodes_[i].p_mid[j] / (2 * d * limits_.acc[j]),
                     e = nodes_[i].e_mid[j] / (2 * limits_.acc[j]);
        if (u != 0 || e != 0) add_both({{e - u, e + u, 0}, 1, i});
      }
    }
    stop_rows(1, 0);
    stop_rows(last_ - 1, last_ - 1);
  }

  void jerk_rows(std::size_t i) {
    // u on both sides of the node as weights of the three x, and how far apart the places are where they count. Next to a stop
    // u is known at the node itself.
    std::array<double, 3> before{}, after{};
    double between = 0;
    const double d0 = nodes_[i - 1].way, d1 = nodes_[i].way;
    if (i == 1) {
      before = {0, 2 / (3 * d0), 0};
    } else {
      before = {-1 / (2 * d0), 1 / (2 * d0), 0};
      between += d0 / 2;
    }
    if (i + 1 == last_) {
      after = {0, -2 / (3 * d1), 0};
    } else {
      after = {0, -1 / (2 * d1), 1 / (2 * d1)};
      between += d1 / 2;
    }
    if (between <= 0) return;
    for (std::size_t j = 0; j < kOptimumJoints; ++j) {
      const double p = nodes_[i].p[j], e = nodes_[i].e[j], c = nodes_[i].c[j],
                   most = limits_.jerk[j];
      if (p == 0 && e == 0 && c == 0) continue;
      // u as it is on either side: a mean of the two would let it jump from node to node where q' vanishes.
      for (const std::array<double, 3>& u : {before, after}) {
        Row row;
        row.first = i - 1;
        row.jerk = true;
        for (std::size_t k = 0; k < 3; ++k)
          row.a[k] = (p * (after[k] - before[k]) / between + 3 * e * u[k]) / most;
        row.a[1] += c / most;
        add_both(row);
        if (e == 0) break;
      }
    }
  }

  /// Constant jerk from rest to node i over the way of `way_of`: v^3 times a sum for each joint.
  void stop_rows(std::size_t i, std::size_t way_of) {
    const double d = nodes_[way_of].way;
    double most = 0, acc = 0;
    const double sign = way_of < i ? 1 : -1;
    for (std::size_t j = 0; j < kOptimumJoints; ++j) {
      const double p = nodes_[i].p[j], e = nodes_[i].e[j], c = nodes_[i].c[j];
      most = std::max(most, std::abs(p * 2 / (9 * d * d) + sign * 2 * e / d + c) / limits_.jerk[j]);
      acc = std::max(acc, std::abs(sign * p * 2 / (3 * d) + e) / limits_.acc[j]);
    }
    if (most > 0) add({{0, std::cbrt(most * most), 0}, 1, i - 1});
    if (acc > 0) add({{0, acc, 0}, 1, i - 1});
  }

  /// Far below the limits, then shrunk where a row does not hold.
  void first_guess() {
    // The largest x that even speed bears, and growth as on a straight from rest.
    for (std::size_t i = 1; i < last_; ++i) {
      double x = 0.7 * nodes_[i].cap;
      for (std::size_t j = 0; j < kOptimumJoints; ++j) {
        const double e = std::abs(nodes_[i].e[j]), c = std::abs(nodes_[i].c[j]);
        if (e > 0) x = std::min(x, 0.5 * limits_.acc[j] / e);
        if (c > 0) x = std::min(x, std::pow(0.4 * limits_.jerk[j] / c, 2.0 / 3.0));
      }
      x_[i] = x;
    }
    // A dip is left like a stop is: x grows by a power 4/3 of the way, and by 2 A D at most.
    const auto grow = [&](std::size_t from, std::size_t to, std::size_t way_of) {
      double acc = 1e99, jerk = 1e99;
      for (std::size_t j = 0; j < kOptimumJoints; ++j) {
        const double p = std::abs(nodes_[to].p[j]);
        if (p > 0)
          acc = std::min(acc, limits_.acc[j] / p), jerk = std::min(jerk, limits_.jerk[j] / p);
      }
      if (acc > 1e98) return;
      const double d = nodes_[way_of].way;
      // The way that lies behind x in such a start: x = (9 J s^2 / 2)^(2/3) at a part of J.
      const double j = 0.15 * jerk;
      const double s = std::sqrt(2 * std::pow(x_[from], 1.5) / (9 * j));
      const double by_jerk = std::pow(4.5 * j * (s + d) * (s + d), 2.0 / 3.0);
      x_[to] = std::min({x_[to], by_jerk, x_[from] + 0.8 * acc * d});
    };
    for (std::size_t i = 1; i < last_; ++i) grow(i - 1, i, i - 1);
    for (std::size_t i = last_ - 1; i > 0; --i) grow(i + 1, i, i);
    for (int round = 0; round < 400; ++round) {
      std::vector<double> factor(x_.size(), 1.0);
      bool any = false;
      for (const Row& r : rows_) {
        const double left = left_of(r), right = right_of(r);
        if (left <= 0.9 * right) continue;
        any = true;
        constexpr std::size_t kReach = 3;
        const std::size_t low = r.first > kReach ? r.first - kReach : 0;
        for (std::size_t k = low; k <= std::min(last_, r.first + 2 + kReach); ++k)
          factor[k] = std::min(factor[k], 0.85);
      }
      if (!any) return;
      for (std::size_t i = 0; i < x_.size(); ++i) x_[i] *= factor[i];
    }
    // Driven slowly enough all rows hold.
    double worst = 0;
    for (const Row& r : rows_) {
      const double share = left_of(r) / right_of(r);
      worst = std::max(worst, r.jerk ? std::pow(std::max(share, 0.0), 2.0 / 3.0) : share);
    }
    if (worst > 0.9)
      for (double& x : x_) x *= 0.9 / worst;
  }

  [[nodiscard]] double left_of(const Row& r) const {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (r.a[k] != 0) sum += r.a[k] * x_[r.first + k];
    return sum;
  }
  [[nodiscard]] double right_of(const Row& r) const {
    return r.jerk ? 1 / std::sqrt(x_[r.first + 1]) : r.right;
  }
  double update_slacks() {
    double sum = 0;
    for (Row& r : rows_) {
      r.s = right_of(r) - left_of(r);
      sum += r.s * r.z;
    }
    return sum;
  }

  [[nodiscard]] double seconds() const {
    double t = 0;
    for (std::size_t i = 0; i < last_; ++i) {
      const double sum = std::sqrt(x_[i]) + std::sqrt(x_[i + 1]);
      const bool rests = i == 0 || i + 1 == last_;
      t += (rests ? 3.0 : 2.0) * nodes_[i].way / sum;
    }
    return t;
  }

  /// Fills dx_ and dz_. The time's Hessian is that of 1 / (sqrt a + sqrt b), which is convex.
  bool newton(double mu) {
    const std::size_t n = x_.size();
    d0_.assign(n, 0), d1_.assign(n, 0), d2_.assign(n, 0), dx_.assign(n, 0);
    for (std::size_t i = 0; i < last_; ++i) {
      const bool inner0 = is_inner(i), inner1 = is_inner(i + 1);
      const double w = (inner0 && inner1 ? 2.0 : 3.0) * nodes_[i].way;
      const double a = std::sqrt(x_[i]), b = std::sqrt(x_[i + 1]), f = a + b;
      if (inner0) {
        dx_[i] += w / (2 * a * f * f);  // against the gradient
        d0_[i] += w * (1 / (4 * a * a * a * f * f) + 1 / (2 * a * a * f * f * f));
      }
      if (inner1) {
        dx_[i + 1] += w / (2 * b * f * f);
        d0_[i + 1] += w * (1 / (4 * b * b * b * f * f) + 1 / (2 * b * b * f * f * f));
      }
      if (inner0 && inner1) d1_[i] += w / (2 * a * b * f * f * f);
    }
    for (const Row& r : rows_) {
      const std::array<double, 3> g = gradient(r);
      const double weight = r.z / r.s, pull = mu / r.s;
      for (std::size_t k = 0; k < 3; ++k) {
        if (g[k] == 0) continue;
        const std::size_t i = r.first + k;
        dx_[i] -= g[k] * pull;
        d0_[i] += weight * g[k] * g[k];
        if (k < 2 && g[k + 1] != 0) d1_[i] += weight * g[k] * g[k + 1];
        if (k == 0 && g[2] != 0) d2_[i] += weight * g[0] * g[2];
      }
    }
    if (!factor_and_solve()) return false;
    dz_.resize(rows_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Row& r = rows_[k];
      dz_[k] = mu / r.s - r.z + r.z / r.s * along(r);
    }
    return true;
  }

  /// Of left - right.
  [[nodiscard]] std::array<double, 3> gradient(const Row& r) const {
    std::array<double, 3> g = r.a;
    if (r.jerk) {
      const double x = x_[r.first + 1];
      g[1] += 0.5 / (x * std::sqrt(x));
    }
    return g;
  }
  [[nodiscard]] double along(const Row& r) const {
    const std::array<double, 3> g = gradient(r);
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (g[k] != 0) sum += g[k] * dx_[r.first + k];
    return sum;
  }

  [[nodiscard]] std::array<double, 2> step_lengths() const {
    double primal = 1, dual = 1;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Row& r = rows_[k];
      const double ds = -along(r);
      if (ds < 0) primal = std::min(primal, -kToBound * r.s / ds);
      if (dz_[k] < 0) dual = std::min(dual, -kToBound * r.z / dz_[k]);
    }
    for (std::size_t i = 1; i < last_; ++i)
      if (dx_[i] < 0) primal = std::min(primal, -0.6 * x_[i] / dx_[i]);
    return {primal, dual};
  }

  /// L D L^T of five diagonals; dx_ holds the right side, then the step.
  bool factor_and_solve() {
    const std::size_t n = last_;
    for (std::size_t i = 1; i < n; ++i) {
      double d = d0_[i], l1 = d1_[i];
      if (i >= 2) {
        d -= d1_[i - 1] * d1_[i - 1] * d0_[i - 1];
        l1 -= d1_[i - 1] * d0_[i - 1] * d2_[i - 1];
      }
      if (i >= 3) d -= d2_[i - 2] * d2_[i - 2] * d0_[i - 2];
      if (!(d > 0)) return false;
      d0_[i] = d;
      d1_[i] = l1 / d;
      d2_[i] /= d;
      double y = dx_[i];
      if (i >= 2) y -= d1_[i - 1] * dx_[i - 1];
      if (i >= 3) y -= d2_[i - 2] * dx_[i - 2];
      dx_[i] = y;
    }
    for (std::size_t i = n; i-- > 1;) {
      double y = dx_[i] / d0_[i];
      if (i + 1 < n) y -= d1_[i] * dx_[i + 1];
      if (i + 2 < n) y -= d2_[i] * dx_[i + 2];
      dx_[i] = y;
    }
    return true;
  }

  const std::vector<CurveNode>& nodes_;
  const JointLimits& limits_;
  std::size_t last_;
  std::vector<double> x_;
  std::vector<Row> rows_;
  std::vector<double> d0_, d1_, d2_, dx_, dz_;
  double before_{0};
};

}  // namespace

JerkOptimum jerk_optimum(const std::vector<CurveNode>& nodes, const JointLimits& limits) {
  return Solver(nodes, limits).solve();
}

}  // namespace kerf::bench
