// JointCurve: bounds of joints along a stretch are bounds; and what JointBounds tells of a tilting table is what its joints do.
#include "motion/core/path/joint_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bench/motion/machines.hpp"
#include "motion/core/planner/ceilings.hpp"
#include "motion/core/planner/joint_bounds.hpp"
#include "motion/core/planner/turn.hpp"

namespace kerf::motion {
namespace {

using path::JointCurve;

struct Random {
  std::mt19937_64 rng{7};
  double operator()(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>()(rng);
  }
};

JointCurve random_curve(Random& r) {
  JointCurve out;
  out.from = r(0, 5);
  out.length = std::exp(r(-4, 2));
  out.count = 1;
  for (double& k : out.row[0].k) k = r(-1, 1);
  out.row[0].vel = out.row[0].acc = out.row[0].jerk = 1;
  return out;
}

TEST(JointCurve, BoundsHoldOnEachPartAndAreNotFarOff) {
  Random r;
  double least = 1;
  for (int n = 0; n < 300; ++n) {
    const JointCurve curve = random_curve(r);
    const double a = curve.from + curve.length * r(0, 0.5), b = a + curve.length * r(0.01, 0.5);
    const path::JointBends bends = path::bends_of(curve, a, b);
    path::JointPlace most;
    for (int i = 0; i <= 100; ++i) {
      const path::JointPlace at = path::place_on(curve, 0, a + (b - a) * i / 100);
      most.rate = std::max(most.rate, std::abs(at.rate));
      most.curl = std::max(most.curl, std::abs(at.curl));
      most.twist = std::max(most.twist, std::abs(at.twist));
    }
    EXPECT_GE(bends.row[0].p, most.rate * (1 - 1e-12));
    EXPECT_GE(bends.row[0].e, most.curl * (1 - 1e-12));
    EXPECT_GE(bends.row[0].c, most.twist * (1 - 1e-12));
    const double cap = path::velocity_cap(curve, a, b, path::kNoLimit);
    EXPECT_LE(cap, std::pow(1 / most.rate, 2) * (1 + 1e-9));
    // Whichever is the least; what is far from both is not looked at closely.
    for (const double other : {0.5 * cap, 0.99 * cap, 1.01 * cap, 2 * cap})
      EXPECT_DOUBLE_EQ(path::velocity_cap(curve, a, b, other), std::min(cap, other));
    least = std::min(least, most.rate / bends.row[0].p);
  }
  EXPECT_GT(least, 0.4);
}

TEST(JointCurve, PlacesAreDerivativesOfOneAnother) {
  Random r;
  for (int n = 0; n < 100; ++n) {
    const JointCurve curve = random_curve(r);
    const double h = 1e-4 * curve.length, s = curve.from + curve.length * r(0.01, 0.99);
    const path::JointPlace before = path::place_on(curve, 0, s - h),
                           at = path::place_on(curve, 0, s),
                           after = path::place_on(curve, 0, s + h);
    EXPECT_NEAR((after.rate - before.rate) / (2 * h), at.curl, 1e-6 / curve.length);
    EXPECT_NEAR((after.curl - before.curl) / (2 * h), at.twist,
                1e-5 / (curve.length * curve.length));
  }
}

TEST(JointCurve, WhatAPartLeavesOutIsAtMostWhatItSays) {
  Random r;
  for (int n = 0; n < 300; ++n) {
    const JointCurve curve = random_curve(r);
    const double a = curve.from + curve.length * r(0, 0.7), b = a + curve.length * r(0.01, 0.3);
    const path::JointPart part = path::part_of(curve, 0, a, b);
    const auto quadratic = [](double b0, double b1, double b2, double t) {
      return b0 * (1 - t) * (1 - t) + 2 * b1 * t * (1 - t) + b2 * t * t;
    };
    for (int i = 0; i <= 50; ++i) {
      const double t = i / 50.0;
      const path::JointPlace at = path::place_on(curve, 0, a + (b - a) * t);
      const double tiny = 1e-9 / std::pow(b - a, 2) + 1e-9;
      EXPECT_LE(std::abs(quadratic(part.p0, part.p1, part.p2, t) - at.rate), part.p_off + tiny);
      EXPECT_LE(std::abs(part.e0 + (part.e1 - part.e0) * t - at.curl), part.e_off + tiny);
      EXPECT_LE(std::abs(quadratic(part.c0, part.c1, part.c2, t) - at.twist), part.c_off + tiny);
    }
  }
}

/// A cubic in all axes of the table.
path::Piece random_piece(Random& r) {
  path::Piece p;
  p.length = std::exp(r(-4, 3));
  const double bends = r(0, 1) / p.length;
  for (const std::size_t i : {0U, 1U, 2U, 3U, 5U}) {
    p.a[i] = r(-40, 40);
    p.b[i] = r(-1, 1) * (i > 2 ? 8 : 1);
    p.c[i] = bends * r(-1, 1);
    p.d[i] = bends / p.length * r(-1, 1);
  }
  return p;
}

TEST(JointCurve, TellsWhatTheJointsOfATiltingTableDo) {
  const test::RigKinematics kinematics = bench::moved_by(bench::Machine::table);
  MachineConfig config;
  bench::set_limits(config, bench::Machine::table, 50000);
  config.joints = kinematics.joints();
  config.axis_mask = kinematics.axis_mask();
  config.traj_max_vel_mm_s = config.traj_max_ang_vel_deg_s = 1e6;
  JointBounds bounds(kinematics);
  const path::AxisLimits axes = path_limits_of(kinematics, config).axes;
  bounds.configure(config, axes);
  Random r;
  double stretches = 0;
  constexpr int kPieces = 200;
  for (int n = 0; n < kPieces; ++n) {
    const path::Piece piece = random_piece(r);
    bounds.begin({});
    const auto joint = [&](std::size_t j, double s) {
      JointVector q{};
      Pose pose;
      const path::Vec at = piece.point(s);
      for (std::size_t i = 0; i < path::kAxes; ++i) pose[i] = at[i];
      EXPECT_TRUE(kinematics.inverse(pose, q));
      return q[j];
    };
    double to = 0;
    for (double from = 0; from < piece.length; from = to) {
      to = piece.length;
      JointCurve curve;
      ASSERT_TRUE(bounds.curve_of(piece, from, to, curve));
      ASSERT_EQ(curve.count, 3U) << "A and C are axes";
      ++stretches;
      // As fast as velocities and curls allow.
      const path::JointBends bends = path::bends_of(curve, from, to);
      double x = path::velocity_cap(curve, from, to, path::axis_cap(piece, from, to, axes));
      for (std::size_t j = 0; j < 3; ++j) x = std::min(x, bends.row[j].acc / bends.row[j].e);
      constexpr double kH = 0.02;
      for (int i = 0; i <= 10; ++i) {
        const double s = from + (to - from) * i / 10;
        for (std::size_t j = 0; j < 3; ++j) {
          const path::JointPlace told = path::place_on(curve, j, s);
          const auto q = [&](double k) { return joint(j, s + k * kH); };
          const double rate = (8 * (q(1) - q(-1)) - (q(2) - q(-2))) / (12 * kH);
          const double curl = (16 * (q(1) + q(-1)) - (q(2) + q(-2)) - 30 * q(0)) / (12 * kH * kH);
          EXPECT_NEAR(told.rate * std::sqrt(x), rate * std::sqrt(x),
                      5e-4 * config.joint[j].max_vel);
          EXPECT_NEAR(told.curl * x, curl * x, 1.5e-3 * config.joint[j].max_acc);
        }
      }
    }
  }
  EXPECT_LT(stretches / kPieces, 8) << "few of them do";
}

/// Lines that turn the tilting table, by several turns some, and helices on it: a joint's soft limit a hair beyond its farthest place lets
/// the move pass, and one a hair before that refuses it.
TEST(SoftLimits, SeeWhereAJointTurnsBackBetweenTheEndsOfAMove) {
  constexpr int kDense = 20'000;
  constexpr double kHair = 3e-6;
  Random r;
  const test::RigKinematics kinematics(bench::kTable);
  int turned = 0;
  for (int n = 0; n < 400; ++n) {
    MachineConfig config;
    bench::set_limits(config, bench::Machine::table, 0);
    for (auto& a : config.axis) a.min_limit = -1e6, a.max_limit = 1e6;
    for (auto& j : config.joint) j.min_limit = -1e6, j.max_limit = 1e6;
    const auto place = [&](double turns) {
      Pose p;
      for (std::size_t i : {0U, 1U, 2U}) p[i] = r(-150, 150);
      p[3] = r(-90, 90);
      p[5] = r(-360, 360) * turns;
      return p;
    };
    Curve curve;
    const Pose start = place(1), end = place(n % 4 == 0 ? 6 : 1);
    if (n % 3 == 0) {
      ArcMove arc;
      arc.end = end;
      arc.normal[2] = 1;
      arc.centre[0] = r(-100, 100);
      arc.centre[1] = r(-100, 100);
      arc.turns = 1 + static_cast<std::int32_t>(r(0, 5));
      ASSERT_TRUE(make_arc(start, arc, curve));
    } else {
      ASSERT_TRUE(make_line(start, end, 0x1FF, curve));
    }
    JointVector first{};
    ASSERT_TRUE(kinematics.inverse(start, first));
    JointVector before = first, here = first, at = first, most = first;
    bool between[kMaxJoints]{};
    for (int k = 1; k <= kDense; ++k) {
      before = here;
      here = at;
      ASSERT_TRUE(kinematics.inverse(point_at(curve, curve.length * k / kDense), at));
      for (std::size_t j = 0; j < 5; ++j) {
        const Turn turn = k > 1 ? turn_of(before[j], here[j], at[j]) : Turn{};
        const double value = std::max(at[j], turn.within ? turn.value : at[j]);
        if (value > most[j]) most[j] = value, between[j] = turn.within;
      }
    }
    const double none[kMaxJoints]{};
    for (std::size_t j = 0; j < 3; ++j) {
      turned += between[j] ? 1 : 0;
      for (const bool passes : {true, false}) {
        // Where it only leads inside, it may begin outside.
        if (!passes && most[j] - first[j] < 2 * kHair) continue;
        config.joint[j].max_limit = most[j] + (passes ? kHair : -kHair);
        JointVector joint = first;
        FaultRecord fault;
        EXPECT_EQ(within_soft_limits(curve, kinematics, config, none, {}, joint, fault), passes)
            << n << " joint " << j << " of most " << most[j];
        if (!passes) {
          EXPECT_EQ(fault.fault, Fault::joint_soft_limit_max);
          EXPECT_EQ(fault.index, static_cast<std::int32_t>(j));
        }
      }
      config.joint[j].max_limit = 1e6;
    }
  }
  EXPECT_GT(turned, 400) << "most of them between the ends";
}

/// Two solutions everywhere: the joint turns with X, or stands nearly still. They are nearest to each other at X0.
class TwoSolutions final : public Kinematics {
 public:
  [[nodiscard]] KinematicsType type() const noexcept override { return KinematicsType::both; }
  [[nodiscard]] std::int32_t joints() const noexcept override { return 1; }
  [[nodiscard]] bool forward(const JointVector&, Pose&) const noexcept override { return false; }
  [[nodiscard]] bool inverse(const Pose& p, JointVector& q) const noexcept override {
    const double turns = 4 * p.x, stands = -2.5 - 0.1 * p.x;
    q[0] = std::abs(turns - q[0]) < std::abs(stands - q[0]) ? turns : stands;
    return true;
  }
  [[nodiscard]] std::int32_t axis_of_joint(std::int32_t) const noexcept override { return -1; }
  [[nodiscard]] std::uint32_t axis_mask() const noexcept override { return 0b1; }
};

/// Next to a pole the solution nearest to the joints a look before was taken for the one that the motion comes to: the limit was found when it was passed.
TEST(SoftLimits, AreThoseOfTheSolutionThatTheMotionComesTo) {
  const TwoSolutions kinematics;
  MachineConfig config;
  for (auto& a : config.axis) a.min_limit = -1e6, a.max_limit = 1e6;
  config.joint[0].min_limit = -1e6;
  Curve curve;
  ASSERT_TRUE(make_line({}, {.x = 64}, 0b1, curve));
  const double none[kMaxJoints]{};
  for (const bool passes : {true, false}) {
    config.joint[0].max_limit = passes ? 257 : 255;
    JointVector joint{};
    FaultRecord fault;
    EXPECT_EQ(within_soft_limits(curve, kinematics, config, none, {}, joint, fault), passes);
    EXPECT_NEAR(joint[0], passes ? 256 : 0, 1e-9);
    EXPECT_EQ(fault.fault, passes ? Fault::none : Fault::joint_soft_limit_max);
  }
}

}  // namespace
}  // namespace kerf::motion
