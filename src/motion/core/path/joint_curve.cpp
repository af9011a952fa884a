#include "motion/core/path/joint_curve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf::motion::path {
namespace {

constexpr std::size_t kCount = 6;
/// Of f''' of a function: the largest distance of the quadratic through both ends and the middle of a part of length 1.
constexpr double kQuadraticOff = 0.00802;

/// The polynomial in r = 0 ... 1 on the part from t0 to t0 + dt.
void shift(const double (&k)[kCount], double t0, double dt, double (&a)[kCount]) noexcept {
  std::copy(std::begin(k), std::end(k), std::begin(a));
  for (std::size_t i = 0; i + 1 < kCount; ++i)
    for (std::size_t j = kCount - 1; j-- > i;) a[j] += a[j + 1] * t0;
  double scale = 1;
  for (double& c : a) c *= scale, scale *= dt;
}

/// The largest Bernstein coefficient of a polynomial of degree n - 1 on 0 ... 1.
template <std::size_t n>
double hull(const double (&a)[n]) noexcept {
  double b[n];
  std::copy(std::begin(a), std::end(a), std::begin(b));
  // b_i = sum over j <= i of C(i, j) / C(n-1, j) a_j
  double over = 1;
  for (std::size_t j = 1; j < n; ++j) {
    over *= static_cast<double>(j) / static_cast<double>(n - j);
    b[j] *= over;
  }
  for (std::size_t level = 1; level < n; ++level)
    for (std::size_t i = n - 1; i >= level; --i) b[i] += b[i - 1];
  double most = 0;
  for (const double c : b) most = std::max(most, std::abs(c));
  return most;
}

/// No less than the polynomial and its hull on 0 ... 1.
double sum_of(const double (&a)[kCount]) noexcept {
  double sum = 0;
  for (const double c : a) sum += std::abs(c);
  return sum;
}

double third_bound(const double (&a)[kCount]) noexcept {
  return 6 * std::abs(a[3]) + 24 * std::abs(a[4]) + 60 * std::abs(a[5]);
}

double part_at(const JointCurve& curve, double s) noexcept {
  return curve.length > 0 ? (s - curve.from) / curve.length : 0.0;
}

}  // namespace

JointPlace place_on(const JointCurve& curve, std::size_t row, double s) noexcept {
  const double* k = curve.row[row].k;
  const double t = part_at(curve, s), d = curve.length;
  JointPlace out;
  out.rate = k[0] + t * (k[1] + t * (k[2] + t * (k[3] + t * (k[4] + t * k[5]))));
  out.curl = (k[1] + t * (2 * k[2] + t * (3 * k[3] + t * (4 * k[4] + t * 5 * k[5])))) / d;
  out.twist = (2 * k[2] + t * (6 * k[3] + t * (12 * k[4] + t * 20 * k[5]))) / (d * d);
  return out;
}

JointPart part_of(const JointCurve& curve, std::size_t row, double s0, double s1) noexcept {
  double a[kCount];
  const double t0 = part_at(curve, s0);
  shift(curve.row[row].k, t0, part_at(curve, s1) - t0, a);
  const double h = s1 - s0, over = 1 / h, over2 = over * over;
  JointPart out;
  out.p0 = a[0];
  out.p2 = a[0] + a[1] + a[2] + a[3] + a[4] + a[5];
  const double middle = a[0] + (a[1] + (a[2] + (a[3] + (a[4] + a[5] / 2) / 2) / 2) / 2) / 2;
  out.p1 = 2 * middle - (out.p0 + out.p2) / 2;
  out.e0 = a[1] * over;
  out.e1 = (a[1] + 2 * a[2] + 3 * a[3] + 4 * a[4] + 5 * a[5]) * over;
  out.c0 = 2 * a[2] * over2;
  out.c2 = (2 * a[2] + 6 * a[3] + 12 * a[4] + 20 * a[5]) * over2;
  const double bend = (2 * a[2] + 3 * a[3] + 3 * a[4] + 2.5 * a[5]) * over2;
  out.c1 = 2 * bend - (out.c0 + out.c2) / 2;
  const double third = third_bound(a);
  out.p_off = kQuadraticOff * third;
  out.e_off = third / 8 * over;
  out.c_off = kQuadraticOff * 120 * std::abs(a[5]) * over2;
  return out;
}

JointBends bends_of(const JointCurve& curve, double s0, double s1) noexcept {
  JointBends out;
  out.count = curve.count;
  const double t0 = part_at(curve, s0), dt = part_at(curve, s1) - t0, over = 1 / (s1 - s0);
  for (std::size_t i = 0; i < curve.count; ++i) {
    double a[kCount];
    shift(curve.row[i].k, t0, dt, a);
    const double first[] = {a[1], 2 * a[2], 3 * a[3], 4 * a[4], 5 * a[5]};
    const double second[] = {2 * a[2], 6 * a[3], 12 * a[4], 20 * a[5]};
    out.row[i] = {hull(a), hull(first) * over, hull(second) * over * over, curve.row[i].acc,
                  curve.row[i].jerk};
  }
  return out;
}

double velocity_cap(const JointCurve& curve, double s0, double s1, double cap) noexcept {
  const double t0 = part_at(curve, s0), dt = part_at(curve, s1) - t0;
  for (std::size_t i = 0; i < curve.count; ++i) {
    // Most joints are far from their limits: a sum that is no less than the hull says so, of the whole curve or of the part.
    const JointCurve::Row& row = curve.row[i];
    const double enough = row.vel * row.vel;
    const auto within = [&](double rate) { return rate * rate * cap <= enough; };
    if (within(sum_of(row.k))) continue;
    double a[kCount];
    shift(row.k, t0, dt, a);
    if (within(sum_of(a))) continue;
    const double v = row.vel / hull(a);
    cap = std::min(cap, v * v);
  }
  return cap;
}

double even_x(const JointCurve& curve, double cap) noexcept {
  double x = cap;
  for (std::size_t i = 0; i < curve.count; ++i)
    for (const double at : {0.0, 0.5, 1.0}) {
      const double curl = std::abs(place_on(curve, i, curve.from + at * curve.length).curl);
      if (curl > 0) x = std::min(x, curve.row[i].acc / curl);
    }
  return x;
}

void joint_rows(const JointCurve& curve, double s0, double s1, bool turned, double share,
                Rows& out) noexcept {
  const double sign = turned ? -1.0 : 1.0, half = sign / (2.0 * (s1 - s0)), over = 1 / curve.length;
  if (turned) std::swap(s0, s1);
  const double t0 = part_at(curve, s0), t1 = part_at(curve, s1), tm = (t0 + t1) / 2;
  for (std::size_t i = 0; i < curve.count; ++i) {
    const double* k = curve.row[i].k;
    const auto rate = [k](double t) {
      return k[0] + t * (k[1] + t * (k[2] + t * (k[3] + t * (k[4] + t * k[5]))));
    };
    const auto curl = [k](double t) {
      return k[1] + t * (2 * k[2] + t * (3 * k[3] + t * (4 * k[4] + t * 5 * k[5])));
    };
    const double limit = 1.0 / (share * curve.row[i].acc);
    const double p0 = rate(t0) * half * limit, p2 = rate(t1) * half * limit,
                 p1 = 2 * rate(tm) * half * limit - (p0 + p2) / 2;
    const double e0 = curl(t0) * over * limit, e1 = curl(t1) * over * limit;
    // As of a cubic in limits.cpp.
    out.at[out.count++] = {e0 - p0, p0};
    out.at[out.count++] = {e1 / 2 - p1, p1 + e0 / 2};
    out.at[out.count++] = {-p2, p2 + e1};
  }
}

double even_step(const JointCurve& curve, double x) noexcept {
  double step = kNoLimit;
  const double d3 = curve.length * curve.length * curve.length;
  for (std::size_t i = 0; i < curve.count; ++i) {
    const double third = third_bound(curve.row[i].k) / d3;
    if (third * x > 0)
      step = std::min(step, std::sqrt(8 * kJointBend * curve.row[i].acc / (third * x)));
  }
  return step;
}

}  // namespace kerf::motion::path
