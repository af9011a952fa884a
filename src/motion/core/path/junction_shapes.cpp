#include "motion/core/path/junction_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::motion::path {
namespace {

/// E at the first three knots and O at the second and the third; the rest follows.
struct Entry {
  double even[3];
  double odd[2];
};
constexpr Entry kTable[] = {
    {{1.5179, 1.5179, 0.3687}, {0.3519, 0.672}},   {{1.0391, 1.0391, 1.0391}, {0.2205, 0.5512}},
    {{1.5074, 1.4749, 0.4366}, {0.5083, 0.5083}},  {{0.686, 0.686, 0.686}, {0.1917, 0.4792}},
    {{1.1475, 1.1475, 1.0781}, {0.2832, 0.7028}},  {{1.9536, 1.3245, 0.3808}, {3.4857, 0}},
    {{1.4043, 1.4043, 0.5808}, {0.3547, 0.5346}},  {{1.2248, 1.082, 0.4719}, {0.5083, 0.5083}},
    {{1.7124, 1.4004, 0.411}, {0.5083, 0.5083}},   {{1.253, 1.253, 0.8159}, {0.2655, 0.5532}},
    {{0.7048, 0.7048, 0.7048}, {0.1758, 0.4395}},  {{1.0501, 1.0501, 0.5186}, {0.4356, 0.5207}},
    {{0.8483, 0.8483, 0.6579}, {0.2679, 0.5494}},  {{1.2288, 1.2288, 0.895}, {0.2838, 0.6682}},
    {{1.9723, 1.9723, -0.6224}, {0.5064, 0.5724}}, {{1.4346, 1.2765, 0.4457}, {0.5083, 0.5083}},
    {{0.8434, 0.8434, 0.8434}, {0.2172, 0.5431}},  {{1.8555, 1.8555, -0.5642}, {0.3171, 0.721}},
    {{2.9641, 1.765, -1.0483}, {0.5496, 0.5496}},  {{1.5091, 1.08, 0.4364}, {3.4857, 0}},
    {{3.4092, 1.5955, -1.125}, {3.4857, 0}},       {{1.2637, 1.2637, 0.5103}, {0.4239, 0.5227}},
    {{1.7073, 1.5866, 0.1719}, {0.5281, 0.5281}},  {{1.1001, 1.1001, 0.6771}, {0.2897, 0.5457}},
    {{0.9978, 0.9978, 0.9978}, {0.1996, 0.499}},   {{1.2047, 1.2047, 0.741}, {0.2778, 0.5477}},
    {{1.9722, 1.9722, -0.6604}, {0.4149, 0.667}},  {{0.9708, 0.9708, 0.9708}, {0.2211, 0.5529}},
    {{1.7561, 1.2158, 0.4055}, {3.4857, 0}},       {{0.684, 0.684, 0.684}, {0.2014, 0.5036}},
    {{1.3579, 1.3579, 0.5383}, {0.3869, 0.5291}},  {{2.8804, 2.8804, -2.8437}, {0.6346, 0.4556}},
    {{1.9543, 1.4894, 0.1422}, {0.5281, 0.5281}},  {{1.5764, 1.2422, 0.4279}, {0.5083, 0.5083}},
    {{1.6706, 1.6706, -0.0561}, {0.3434, 0.6922}}, {{0.8512, 0.8512, 0.8512}, {0.1946, 0.4866}},
    {{2.2149, 2.2149, -1.1945}, {0.5424, 0.5457}}, {{0.6928, 0.6928, 0.6928}, {0.1807, 0.4517}},
    {{1.3439, 1.0726, 0.457}, {0.5083, 0.5083}},   {{3.0097, 2.0456, -1.5402}, {0.5516, 0.5485}},
};
constexpr std::size_t kShapes = std::size(kTable);
constexpr std::size_t kSpans = kJunctionKnots.size() - 1;
/// Places from the vertex on at which deviations are looked at.
constexpr std::size_t kPlaces = 12;

/// std::abs is not constexpr in C++20.
constexpr double magnitude(double v) { return v < 0 ? -v : v; }

/// What a function that is linear between the knots adds to its integral (order 0) and to its first moment (order 1) by its value at knot k.
constexpr double weight(std::size_t k, int order) {
  double sum = 0;
  for (std::size_t i = 0; i < kSpans; ++i) {
    if (i != k && i + 1 != k) continue;
    const double a = kJunctionKnots[i], b = kJunctionKnots[i + 1], at = k == i ? a : b;
    // Simpson's rule, exact here.
    sum += (b - a) / 6 * (order == 0 ? 3.0 : at + 2 * (a + b) / 2);
  }
  return sum;
}

constexpr JunctionShape shape_of(const Entry& entry) {
  JunctionShape s;
  double area = 0.5, moment = 0.25;
  for (std::size_t k = 0; k < 3; ++k) {
    s.even[k] = entry.even[k];
    area -= s.even[k] * weight(k, 0);
  }
  s.even[3] = area / weight(3, 0);
  s.odd[1] = entry.odd[0];
  s.odd[2] = entry.odd[1];
  s.odd[4] = 0.5;
  for (const std::size_t k : {1UL, 2UL, 4UL}) moment -= s.odd[k] * weight(k, 1);
  s.odd[3] = moment / weight(3, 1);
  return s;
}

/// How far the path is off at x when q'' is off by f behind it: the integral of (t - x) f(t) from x to 1.
constexpr double off_at(const std::array<double, kSpans + 1>& f, double minus, double x) {
  double sum = 0;
  for (std::size_t i = 0; i < kSpans; ++i) {
    const double k0 = kJunctionKnots[i], k1 = kJunctionKnots[i + 1];
    if (k1 <= x) continue;
    const double a = std::max(k0, x), b = k1, m = (a + b) / 2;
    const auto value = [&](double t) {
      return (f[i] + (f[i + 1] - f[i]) * (t - k0) / (k1 - k0) - minus) * (t - x);
    };
    sum += (b - a) / 6 * (value(a) + 4 * value(m) + value(b));
  }
  return magnitude(sum);
}

struct Response {
  JunctionShape shape;
  double even_off[kPlaces]{}, odd_off[kPlaces]{};
  double even_slope[kSpans]{}, odd_slope[kSpans]{};
};

constexpr std::array<Response, kShapes> responses() {
  std::array<Response, kShapes> out{};
  for (std::size_t n = 0; n < kShapes; ++n) {
    Response& r = out[n];
    r.shape = shape_of(kTable[n]);
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const double x = static_cast<double>(k) / kPlaces;
      r.even_off[k] = off_at(r.shape.even, 0, x);
      r.odd_off[k] = off_at(r.shape.odd, 0.5, x);
    }
    for (std::size_t i = 0; i < kSpans; ++i) {
      const double over = 1 / (kJunctionKnots[i + 1] - kJunctionKnots[i]);
      r.even_slope[i] = magnitude(r.shape.even[i + 1] - r.shape.even[i]) * over;
      r.odd_slope[i] = magnitude(r.shape.odd[i + 1] - r.shape.odd[i]) * over;
    }
  }
  return out;
}

constexpr std::array<Response, kShapes> kResponses = responses();

}  // namespace

JunctionChoice choose_junction_shape(const JunctionNeeds& needs) noexcept {
  const Response* best = &kResponses[0];
  double fastest = -1, reach = 0;
  for (const Response& r : kResponses) {
    double l = needs.reach;
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const double c1 = needs.kink_off * r.even_off[k], c2 = needs.jump_off * r.odd_off[k];
      if (l * (c1 + c2 * l) > 1) l = 2 / (c1 + std::sqrt(c1 * c1 + 4 * c2));
    }
    double jerk = 0, acc = 0;
    for (std::size_t i = 0; i < kSpans; ++i) {
      jerk = std::max(
          jerk, needs.kink_jerk * r.even_slope[i] / (l * l) + needs.jump_jerk * r.odd_slope[i] / l);
      acc = std::max(acc, needs.kink_acc * magnitude(r.shape.even[i]) / l +
                              needs.jump_acc * magnitude(r.shape.odd[i]));
    }
    const double speed =
        std::min(1 / std::cbrt(jerk + 1e-30), 1 / std::sqrt(acc + needs.bend_acc + 1e-30));
    if (speed <= fastest) continue;
    fastest = speed;
    best = &r;
    reach = l;
  }
  return {best->shape, reach};
}

}  // namespace kerf::motion::path
