// Random machines and programs, and what must hold for each of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "unit/motion/rig.hpp"

namespace kerf::motion::test {

/// Under the address sanitizer, which looks at memory and not at figures, a quarter of them: each takes several times as long there.
inline int property_count(int normal) {
  const char* text = std::getenv("KERF_COUNT");
  if (text != nullptr && std::atoi(text) > 0) return std::atoi(text);
#ifdef __SANITIZE_ADDRESS__
  return (normal + 3) / 4;
#else
  return normal;
#endif
}

class Random {
 public:
  explicit Random(unsigned start) : rng_(start) {}
  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>()(rng_);
  }
  double log(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng_); }
  bool chance(double p) { return uniform(0, 1) < p; }

 private:
  std::mt19937_64 rng_;
};

/// A machine of 1 to 9 axes with its own limits for each.
inline std::vector<int> random_axes(Random& r) {
  std::vector<int> axes{0, 1, 2};
  for (int a = 3; a < 9; ++a) {
    if (r.chance(0.35)) axes.push_back(a);
  }
  return axes;
}

/// `jerks`: with jerk limits that are reached within some cycles to half a second.
inline void random_limits(Rig& rig, Random& r, bool jerks = false) {
  const double acc = r.log(100, 5000), vel = r.log(10, 300);
  const double jerk = jerks ? acc / r.log(0.004, 0.5) : 0.0;
  for (std::size_t j = 0; j < rig.controller->joints(); ++j) {
    JointConfig& c = rig.config.joint[j];
    c.max_vel = vel * r.log(0.5, 2);
    c.max_acc = acc * r.log(0.5, 2);
    if (jerks) c.max_jerk = jerk * r.log(0.5, 2);
    c.min_limit = -1e5;
    c.max_limit = 1e5;
    c.ferror = c.min_ferror = 1e9;
  }
  for (AxisConfig& a : rig.config.axis) {
    a.min_limit = -1e5;
    a.max_limit = 1e5;
    a.max_vel = a.max_acc = 1e9;
  }
  rig.config.max_feed_override = r.chance(0.5) ? 1.0 : 2.0;
  rig.apply_config();
}

/// Straight, arc, helix or spiral from `from`, with whatever other axes the machine has.
inline PathItems::Variant random_move(const Rig& rig, const Pose& from, Random& r, Pose& end) {
  const std::uint32_t mask = rig.kinematics.axis_mask();
  const double speed = r.log(5, 400);
  end = from;
  for (std::size_t i = 3; i < rtapi::kAxes; ++i) {
    if ((mask >> i & 1U) != 0 && r.chance(0.5)) end[i] += r.uniform(-1, 1) * r.log(0.01, 30);
  }
  if (r.chance(0.5)) {
    const double size = r.log(0.001, 40);
    for (std::size_t i = 0; i < 3; ++i) {
      if (r.chance(0.7)) end[i] += r.uniform(-size, size);
    }
    LinearMove m;
    m.end = end;
    m.kind = r.chance(0.3) ? MotionKind::traverse : MotionKind::feed;
    m.vel_mm_s = m.kind == MotionKind::traverse ? 0 : speed;
    return m;
  }
  // A frame in any direction, a centre, and the end by its angle.
  double n[3], u[3], w[3];
  const auto unit = [](double* v) {
    const double k = 1 / std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; ++i) v[i] *= k;
  };
  if (r.chance(0.6)) {
    const int axis = r.integer(0, 2);
    for (int i = 0; i < 3; ++i) n[i] = i == axis ? (r.chance(0.5) ? 1.0 : -1.0) : 0.0;
  } else {
    for (double& x : n) x = r.uniform(-1, 1);
    unit(n);
  }
  double any[3] = {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)};
  const double along = any[0] * n[0] + any[1] * n[1] + any[2] * n[2];
  for (int i = 0; i < 3; ++i) u[i] = any[i] - along * n[i];
  unit(u);
  w[0] = n[1] * u[2] - n[2] * u[1];
  w[1] = n[2] * u[0] - n[0] * u[2];
  w[2] = n[0] * u[1] - n[1] * u[0];
  ArcMove m;
  const double radius = r.log(0.05, 12),
               angle = r.chance(0.2) ? 6.283185307179586 : r.log(0.02, 6.2);
  const double end_radius = r.chance(0.7) ? radius : radius * r.log(0.3, 3),
               rise = r.chance(0.5) ? 0.0 : r.uniform(-10, 10);
  m.turns = r.chance(0.2) ? r.integer(2, 4) : 1;
  for (std::size_t i = 0; i < 3; ++i) {
    m.centre[i] = from[i] - radius * u[i];
    m.normal[i] = n[i];
    end[i] =
        m.centre[i] + end_radius * (u[i] * std::cos(angle) + w[i] * std::sin(angle)) + rise * n[i];
  }
  m.end = end;
  m.vel_mm_s = speed;
  return m;
}

/// How far `p` is from the geometry of `move`, found without the code under test.
inline double deviation(const PathItems::Variant& move, const Pose& start, const Pose& p) {
  if (const auto* line = std::get_if<LinearMove>(&move)) {
    const Pose d = line->end - start, q = p - start;
    double dd = 0, dq = 0;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) dd += d[i] * d[i], dq += d[i] * q[i];
    const double t = dd > 0 ? std::clamp(dq / dd, 0.0, 1.0) : 0.0;
    double worst = 0;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      worst = std::max(worst, std::abs(q[i] - t * d[i]));
    return worst;
  }
  const auto& arc = *std::get_if<ArcMove>(&move);
  const auto planar = [&](const Pose& at, double* v) {
    double h = 0;
    for (std::size_t i = 0; i < 3; ++i) h += (at[i] - arc.centre[i]) * arc.normal[i];
    for (std::size_t i = 0; i < 3; ++i) v[i] = at[i] - arc.centre[i] - h * arc.normal[i];
    return h;
  };
  double a[3], b[3], c[3];
  const double ha = planar(start, a), hb = planar(arc.end, b), hc = planar(p, c);
  const auto dot = [](const double* l, const double* r) {
    return l[0] * r[0] + l[1] * r[1] + l[2] * r[2];
  };
  const double ra = std::sqrt(dot(a, a)), rb = std::sqrt(dot(b, b)), rc = std::sqrt(dot(c, c));
  const double side[3] = {arc.normal[1] * a[2] - arc.normal[2] * a[1],
                          arc.normal[2] * a[0] - arc.normal[0] * a[2],
                          arc.normal[0] * a[1] - arc.normal[1] * a[0]};
  constexpr double kTurn = 6.283185307179586;
  const auto angle_of = [&](const double* v) {
    const double phi = std::atan2(dot(v, side), dot(v, a));
    return phi < 0 ? phi + kTurn : phi;
  };
  double whole = angle_of(b);
  if (whole < 1e-6 / ra) whole = kTurn;
  whole += kTurn * (arc.turns - 1);
  double best = 1e9;
  for (int turn = -1; turn <= arc.turns; ++turn) {
    const double phi = angle_of(c) + kTurn * turn, share = phi / whole;
    if (share < -1e-6 || share > 1 + 1e-6) continue;
    double worst =
        std::max(std::abs(rc - (ra + (rb - ra) * share)), std::abs(hc - (ha + (hb - ha) * share)));
    for (std::size_t i = 3; i < rtapi::kAxes; ++i)
      worst = std::max(worst, std::abs(p[i] - start[i] - (arc.end[i] - start[i]) * share));
    best = std::min(best, worst);
  }
  return best;
}

/// Point of an arc at a share of its angle.
inline Pose arc_point_at(const ArcMove& arc, const Pose& start, double share) {
  double a[3], b[3], ha = 0, hb = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    ha += (start[i] - arc.centre[i]) * arc.normal[i];
    hb += (arc.end[i] - arc.centre[i]) * arc.normal[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    a[i] = start[i] - arc.centre[i] - ha * arc.normal[i];
    b[i] = arc.end[i] - arc.centre[i] - hb * arc.normal[i];
  }
  const auto dot = [](const double* l, const double* r) {
    return l[0] * r[0] + l[1] * r[1] + l[2] * r[2];
  };
  const double side[3] = {arc.normal[1] * a[2] - arc.normal[2] * a[1],
                          arc.normal[2] * a[0] - arc.normal[0] * a[2],
                          arc.normal[0] * a[1] - arc.normal[1] * a[0]};
  constexpr double kTurn = 6.283185307179586;
  const double ra = std::sqrt(dot(a, a)), rb = std::sqrt(dot(b, b));
  double whole = std::atan2(dot(b, side), dot(b, a));
  if (whole < 1e-6 / ra) whole += kTurn;
  whole += kTurn * (arc.turns - 1);
  const double phi = whole * share, r = ra + (rb - ra) * share;
  Pose out = start + (arc.end - start) * share;
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = arc.centre[i] + (ha + (hb - ha) * share) * arc.normal[i] +
             r * (a[i] * std::cos(phi) + side[i] * std::sin(phi)) / ra;
  return out;
}

/// Distance of `p` from a move, by the larger of XYZ, UVW and each rotary axis.
inline double distance(const PathItems::Variant& move, const Pose& start, const Pose& p) {
  const auto far = [&](const Pose& at) {
    const Pose d = p - at;
    return std::max({std::hypot(d.x, d.y, d.z), std::hypot(d.u, d.v, d.w), std::abs(d.a),
                     std::abs(d.b), std::abs(d.c)});
  };
  const auto at = [&](double share) {
    if (const auto* line = std::get_if<LinearMove>(&move))
      return start + (line->end - start) * share;
    return arc_point_at(*std::get_if<ArcMove>(&move), start, share);
  };
  constexpr int kSteps = 300;
  int best = 0;
  for (int i = 0; i <= kSteps; ++i)
    if (far(at(1.0 * i / kSteps)) < far(at(1.0 * best / kSteps))) best = i;
  double low = std::max(0.0, (best - 1.0) / kSteps), high = std::min(1.0, (best + 1.0) / kSteps);
  for (int i = 0; i < 60; ++i) {
    const double l = low + (high - low) / 3, h = high - (high - low) / 3;
    (far(at(l)) < far(at(h)) ? high : low) = far(at(l)) < far(at(h)) ? h : l;
  }
  return far(at(low));
}

/// Differences of every joint, cycle by cycle, against its limits.
class Oracle {
 public:
  void watch(const Rig& rig) {
    const MotionStatus& s = rig.status();
    for (std::size_t j = 0; j < rig.controller->joints(); ++j) {
      const double p = s.joint[j].pos_cmd, v = (p - p1_[j]) / Rig::kPeriod,
                   a = (p - 2 * p1_[j] + p2_[j]) / (Rig::kPeriod * Rig::kPeriod);
      if (seen_ >= 1) vel = std::max(vel, (std::abs(v) - 1e-8) / rig.config.joint[j].max_vel);
      const double third = (p - 3 * p1_[j] + 3 * p2_[j] - p3_[j]) /
                           (Rig::kPeriod * Rig::kPeriod * Rig::kPeriod),
                   most = rig.config.joint[j].max_jerk;
      if (seen_ >= 3 && most > 0) jerk = std::max(jerk, (std::abs(third) - 10) / most);
      if (seen_ >= 2) acc = std::max(acc, (std::abs(a) - 1e-2) / rig.config.joint[j].max_acc);
      p3_[j] = p2_[j];
      p2_[j] = p1_[j];
      p1_[j] = p;
    }
    ++seen_;
  }
  double vel{0}, acc{0}, jerk{0};  ///< largest share of a limit

 private:
  double p1_[kMaxJoints]{}, p2_[kMaxJoints]{}, p3_[kMaxJoints]{};
  int seen_{0};
};

}  // namespace kerf::motion::test
