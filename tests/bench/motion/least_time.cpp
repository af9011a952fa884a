// The curve of a program as a fine grid for jerk_optimum, and a look at the motion that comes of it by differences of sampled positions.
#include <algorithm>
#include <cmath>

#include "bench/motion/jerk_optimum.hpp"
#include "bench/motion/machinery.hpp"
#include "bench/motion/runs.hpp"

namespace kerf::bench {
namespace {

namespace path = motion::path;

/// Steps of the grid on a straight, and how fast they may grow from one to the next.
constexpr int kStraightSteps = 40;
constexpr double kGrowth = 0.25;
/// Next to a stop (sigma).
constexpr double kAtStop = 0.004;
constexpr double kSamplePeriod = 2e-3;
/// A step that takes longer is halved; next to a stop it may.
constexpr double kLongestStep = 1.5e-3;
constexpr int kRefinements = 3;
/// Where a motion takes the least time, some limit is used up everywhere; differences over three periods blur the changes from one to another.
constexpr double kSaturated = 0.9;

/// Where a node stands.
struct Place {
  std::size_t span{0};
  double s{0};  ///< on its piece
};

struct Grid {
  std::vector<CurveNode> nodes;
  std::vector<Place> places;
};

/// `way` behind a place.
Place ahead(const std::vector<motion::PathSpan>& curve, Place at, double way) {
  for (at.s += way; at.span + 1 < curve.size(); ++at.span) {
    const motion::PathSpan& span = curve[at.span];
    const double over = at.s - (span.from + span.length);
    if (over <= 0) break;
    at.s = curve[at.span + 1].from + over;
  }
  return at;
}

/// What the curve is at the places.
void fill_nodes(const std::vector<motion::PathSpan>& curve, const Machinery& machine, Grid& grid) {
  grid.nodes.clear();
  for (std::size_t i = 0; i < grid.places.size(); ++i) {
    const Place& place = grid.places[i];
    const path::Piece& piece = curve[place.span].piece;
    CurveNode node;
    Values p, e, c;
    machine.derive(piece, place.s, p, e, c);
    std::copy(p.begin(), p.end(), node.p);
    std::copy(e.begin(), e.end(), node.e);
    std::copy(c.begin(), c.end(), node.c);
    node.cap = machine.cap(piece, place.s);
    if (i + 1 < grid.places.size()) {
      const Place& next = grid.places[i + 1];
      node.way = next.s - place.s;
      for (std::size_t k = place.span; k < next.span; ++k)
        node.way += curve[k].from + curve[k].length - curve[k + 1].from;
      const Place middle = ahead(curve, place, node.way / 2);
      machine.derive(curve[middle.span].piece, middle.s, p, e, c);
      std::copy(p.begin(), p.end(), node.p_mid);
      std::copy(e.begin(), e.end(), node.e_mid);
    }
    grid.nodes.push_back(node);
  }
}

/// Of stretches [begin, end), from stop to stop.
Grid grid_of(const std::vector<motion::PathSpan>& curve, std::size_t begin, std::size_t end,
             const Machinery& machine, int curve_steps) {
  // Steps at the joints of stretches: as fine as the finer side, growing evenly.
  const std::size_t n = end - begin;
  std::vector<double> own(n), joint(n + 1);
  double total = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const motion::PathSpan& span = curve[begin + k];
    own[k] = span.length / (span.piece.straight() ? kStraightSteps : curve_steps);
    total += span.length;
  }
  joint[0] = joint[n] = std::min(kAtStop, total / 100);
  for (std::size_t k = 1; k < n; ++k) joint[k] = std::min(own[k - 1], own[k]);
  for (std::size_t k = 0; k < n; ++k)
    joint[k + 1] = std::min(joint[k + 1], joint[k] + kGrowth * curve[begin + k].length);
  for (std::size_t k = n; k-- > 0;)
    joint[k] = std::min(joint[k], joint[k + 1] + kGrowth * curve[begin + k].length);
  Grid out;
  for (std::size_t k = 0; k < n; ++k) {
    const motion::PathSpan& span = curve[begin + k];
    std::vector<double> at{0};
    const auto step = [&](double s) {
      return std::min({own[k], joint[k] + kGrowth * s, joint[k + 1] + kGrowth * (span.length - s)});
    };
    while (at.back() < span.length) {
      const double h = step(at.back());
      at.push_back(at.back() + std::min(h, std::max(step(at.back() + h), h / 2)));
    }
    const double scale = span.length / at.back();
    // q''' jumps at joints, and what jerk allows holds on both sides: nodes stand beside joints, never on one. On a node with the mean of both sides the
    // middle of a triangle of q'' would be passed at any speed.
    if (k == 0) out.places.push_back({begin, span.from});
    for (std::size_t i = 0; i + 1 < at.size(); ++i)
      out.places.push_back({begin + k, span.from + (at[i] + at[i + 1]) / 2 * scale});
  }
  out.places.push_back({end - 1, curve[end - 1].from + curve[end - 1].length});
  fill_nodes(curve, machine, out);
  return out;
}

/// Halves the steps that took too long. False: none did.
bool refine(const std::vector<motion::PathSpan>& curve, const Machinery& machine,
            const std::vector<double>& x, Grid& grid) {
  std::vector<Place> places;
  const std::size_t last = grid.nodes.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    places.push_back(grid.places[i]);
    if (i == 0 || i + 1 == last) continue;
    const double way = grid.nodes[i].way;
    if (2 * way / (std::sqrt(x[i]) + std::sqrt(x[i + 1])) <= kLongestStep) continue;
    if (grid.places[i].span == grid.places[i + 1].span) {
      places.push_back(ahead(curve, grid.places[i], way / 2));
    } else {
      for (const double share : {0.25, 0.75})
        places.push_back(ahead(curve, grid.places[i], share * way));
    }
  }
  places.push_back(grid.places[last]);
  if (places.size() == grid.places.size()) return false;
  grid.places = std::move(places);
  fill_nodes(curve, machine, grid);
  return true;
}

/// Samples the motion: places, speeds and accelerations of the nodes, next to the stops an even jerk.
class Sampler {
 public:
  Sampler(const std::vector<motion::PathSpan>& curve, const Grid& grid, const JerkOptimum& found,
          const Machinery& machine, LeastTime& out)
      : curve_(curve), grid_(grid), x_(found.x), machine_(machine), out_(out) {}

  void run() {
    const std::size_t last = grid_.nodes.size() - 1;
    double at = 0;  // time of the next sample within the interval
    for (std::size_t i = 0; i < last; ++i) {
      const double d = grid_.nodes[i].way, v0 = std::sqrt(x_[i]), v1 = std::sqrt(x_[i + 1]);
      const bool starts = i == 0, ends = i + 1 == last;
      const double t = (starts || ends ? 3 : 2) * d / (v0 + v1);
      for (; at < t; at += kSamplePeriod) {
        const double r = at / t;
        double s = 0;
        if (starts)
          s = d * r * r * r;
        else if (ends)
          s = d * (1 - (1 - r) * (1 - r) * (1 - r));
        else
          s = between(d, v0 * t, v1 * t, acc_at(i) * t * t, acc_at(i + 1) * t * t, r);
        look(i, s);
      }
      at -= t;
    }
  }

 private:
  /// dv/dt at a node.
  [[nodiscard]] double acc_at(std::size_t i) const {
    const std::size_t last = grid_.nodes.size() - 1;
    const double d0 = grid_.nodes[i - 1].way, d1 = grid_.nodes[i].way;
    if (i == 1) return 2 * x_[i] / (3 * d0);
    if (i + 1 == last) return -2 * x_[i] / (3 * d1);
    const double u0 = (x_[i] - x_[i - 1]) / (2 * d0), u1 = (x_[i + 1] - x_[i]) / (2 * d1);
    return (d1 * u0 + d0 * u1) / (d0 + d1);
  }
  /// The polynomial of fifth degree over r in [0, 1] from 0 to d with first and second derivatives at both ends.
  [[nodiscard]] static double between(double d, double v0, double v1, double a0, double a1,
                                      double r) {
    const double k3 = 10 * d - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1;
    const double k4 = -15 * d + 8 * v0 + 7 * v1 + 1.5 * a0 - a1;
    const double k5 = 6 * d - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1;
    return r * (v0 + r * (0.5 * a0 + r * (k3 + r * (k4 + r * k5))));
  }

  void look(std::size_t i, double s) {
    const Place place = ahead(curve_, grid_.places[i], s);
    const path::Piece& piece = curve_[place.span].piece;
    const Values q = machine_.of(piece.point(place.s), &piece, place.s);
    const JointLimits& limits = machine_.limits;
    if (count_ >= 3) {
      // The middle of the four samples lies a step and a half back; speed hardly changes in that time.
      double used = std::min(x_[i], x_[i + 1]) / grid_.nodes[i].cap;
      const double t = kSamplePeriod;
      for (std::size_t j = 0; j < kOptimumJoints; ++j) {
        const double second = std::abs(q[j] - 2 * q_[0][j] + q_[1][j]) / (t * t);
        const double third = std::abs(q[j] - 3 * q_[0][j] + 3 * q_[1][j] - q_[2][j]) / (t * t * t);
        out_.acc = std::max(out_.acc, second / limits.acc[j]);
        out_.jerk = std::max(out_.jerk, third / limits.jerk[j]);
        used = std::max({used, second / limits.acc[j], third / limits.jerk[j]});
      }
      ++out_.samples;
      if (used >= kSaturated) ++out_.saturated;
    }
    q_[2] = q_[1], q_[1] = q_[0], q_[0] = q;
    ++count_;
  }

  const std::vector<motion::PathSpan>& curve_;
  const Grid& grid_;
  const std::vector<double>& x_;
  const Machinery& machine_;
  LeastTime& out_;
  Values q_[3]{};
  std::size_t count_{0};
};

}  // namespace

LeastTime least_time(const Program& program, double jerk, int curve_steps) {
  path::AxisLimits limits;
  const std::vector<motion::PathSpan> curve = curve_of(program, jerk, limits);
  const Machinery machine = machinery_of(program, limits, jerk);
  LeastTime out;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    if (!curve[k].stop_at_end && k + 1 < curve.size()) continue;
    Grid grid = grid_of(curve, begin, k + 1, machine, curve_steps);
    JerkOptimum found = jerk_optimum(grid.nodes, machine.limits);
    for (int round = 0; round < kRefinements && refine(curve, machine, found.x, grid); ++round)
      found = jerk_optimum(grid.nodes, machine.limits);
    out.seconds += found.seconds;
    out.gap_s += found.gap_s;
    out.iterations = std::max(out.iterations, found.iterations);
    Sampler(curve, grid, found, machine, out).run();
    begin = k + 1;
  }
  return out;
}

}  // namespace kerf::bench
