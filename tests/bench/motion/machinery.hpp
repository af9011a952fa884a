// What axes and joints do along the curve of a program, for its optima: derivatives by differences of kinematics, of orders that the planner does not use.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "bench/motion/families.hpp"
#include "bench/motion/jerk_optimum.hpp"
#include "bench/motion/runs.hpp"
#include "bench/motion/table_kinematics.hpp"

namespace kerf::bench {

/// The axes of both machines, and the joints of the table that mix them.
inline constexpr std::size_t kAxisAt[] = {0, 1, 2, 3, 5};
inline constexpr std::size_t kAxesAt = std::size(kAxisAt), kMixed = kOptimumJoints - kAxesAt;
/// Joints are differentiated over so much of the path (sigma).
inline constexpr double kJointStep = 0.02;

using Values = std::array<double, kOptimumJoints>;

/// A machine: what its axes and joints do along a piece, and their limits.
struct Machinery {
  bool table{false};
  motion::path::AxisLimits axes;
  double vel[kMixed]{};
  JointLimits limits;

  [[nodiscard]] Values of(const motion::path::Vec& q, const motion::path::Piece* at,
                          double s) const {
    Values out{};
    for (std::size_t i = 0; i < kAxesAt; ++i) out[i] = q[kAxisAt[i]];
    if (!table || at == nullptr) return out;
    const Values there = joints(*at, s);
    std::copy(there.begin(), there.begin() + kMixed, out.begin() + kAxesAt);
    return out;
  }
  [[nodiscard]] static Values joints(const motion::path::Piece& piece, double s) {
    motion::JointVector q{};
    const motion::path::Vec at = piece.point(s);
    motion::Pose pose;
    for (std::size_t i = 0; i < motion::path::kAxes; ++i) pose[i] = at[i];
    (void)TableKinematics{}.inverse(pose, q);
    Values out{};
    for (std::size_t j = 0; j < kMixed; ++j) out[j] = q[j];
    return out;
  }
  /// Derivatives of axes and joints; those of joints by differences of fourth order and higher.
  void derive(const motion::path::Piece& piece, double s, Values& p, Values& e, Values& c) const {
    p = of(piece.first(s), nullptr, s);
    e = of(piece.second(s), nullptr, s);
    c = of(piece.third(s), nullptr, s);
    if (!table) return;
    Values f[7];
    for (int k = -3; k <= 3; ++k) f[k + 3] = joints(piece, s + k * kJointStep);
    for (std::size_t j = 0; j < kMixed; ++j) {
      const auto odd = [&](int k) { return f[3 + k][j] - f[3 - k][j]; };
      const auto even = [&](int k) { return f[3 + k][j] + f[3 - k][j]; };
      p[kAxesAt + j] = (45 * odd(1) - 9 * odd(2) + odd(3)) / (60 * kJointStep);
      e[kAxesAt + j] = (270 * even(1) - 27 * even(2) + 2 * even(3) - 490 * f[3][j]) /
                       (180 * kJointStep * kJointStep);
      c[kAxesAt + j] =
          (-13 * odd(1) + 8 * odd(2) - odd(3)) / (8 * kJointStep * kJointStep * kJointStep);
    }
  }
  [[nodiscard]] double cap(const motion::path::Piece& piece, double s) const {
    double out = speed_cap(piece, piece.first(s), axes);
    Values p, e, c;
    derive(piece, s, p, e, c);
    for (std::size_t j = 0; table && j < kMixed; ++j)
      if (p[kAxesAt + j] != 0) out = std::min(out, std::pow(vel[j] / p[kAxesAt + j], 2));
    return out;
  }
};

inline Machinery machinery_of(const Program& program, const motion::path::AxisLimits& axes,
                              double jerk) {
  Machinery out;
  out.table = program.machine == Machine::table;
  out.axes = axes;
  motion::MachineConfig config;
  reference_machine(config);
  for (std::size_t i = 0; i < kAxesAt; ++i)
    out.limits.acc[i] = axes.acc[kAxisAt[i]], out.limits.jerk[i] = axes.jerk[kAxisAt[i]];
  for (std::size_t j = 0; j < kMixed; ++j) {
    out.vel[j] = config.joint[j].max_vel;
    out.limits.acc[kAxesAt + j] = config.joint[j].max_acc;
    out.limits.jerk[kAxesAt + j] = jerk;
  }
  return out;
}

}  // namespace kerf::bench
