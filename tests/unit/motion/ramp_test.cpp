#include "motion/core/ramp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "motion/core/axis_mover.hpp"

namespace kerf::motion {
namespace {

/// Seven phases in closed form: from rest to rest.
double least_time(double length, double speed, double acc, double jerk) {
  const double up =
      speed >= acc * acc / jerk ? speed / acc + acc / jerk : 2 * std::sqrt(speed / jerk);
  if (speed * up <= length) return length / speed + up;
  if (2 * acc * acc * acc / (jerk * jerk) >= length) return std::cbrt(32 * length / jerk);
  const double peak =
      0.5 * (-acc * acc / jerk + std::sqrt(std::pow(acc * acc / jerk, 2) + 4 * acc * length));
  return 2 * (peak / acc + acc / jerk);
}

TEST(Ramp, EndsAtItsTargetWithinTheLimits) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const RampLimits limits{std::pow(10, 2 + u(rng)), std::pow(10, 4 + 2 * u(rng))};
    const RampState from{100 * u(rng), 1.5 * limits.acc * u(rng)};
    const double target = 100 * u(rng);
    const Ramp ramp = ramp_to(from, target, limits);
    RampState at = from;
    const double way = ramp.advance(at, ramp.duration());
    EXPECT_NEAR(at.speed, target, 1e-8) << i;
    EXPECT_NEAR(at.acc, 0, 1e-7) << i;
    EXPECT_NEAR(way, ramp.distance(from), 1e-9) << i;
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(ramp.seconds[k], 0);
      EXPECT_LE(std::abs(ramp.jerk[k]), limits.jerk);
    }
    for (int k = 1; k < 20; ++k) {
      RampState s = from;
      (void)ramp.advance(s, ramp.duration() * k / 20);
      EXPECT_LE(std::abs(s.acc), std::max(std::abs(from.acc), limits.acc) + 1e-9);
    }
  }
}

TEST(Ramp, AMoveFromRestToRestTakesTheLeastTime) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 300; ++i) {
    const double length = std::pow(10, -3 + 6 * u(rng)), speed = std::pow(10, 3 * u(rng)),
                 acc = std::pow(10, 1 + 3 * u(rng)), jerk = std::pow(10, 3 + 3 * u(rng));
    AxisMover m;
    m.place(0);
    m.set_limits(acc, jerk);
    m.go_to(length, speed);
    const double wanted = least_time(length, speed, acc, jerk), dt = std::max(1e-4, wanted / 3000);
    int cycles = 0;
    while (m.active() && cycles < 100000) {
      m.step(dt);
      ++cycles;
    }
    EXPECT_EQ(m.position(), length);
    EXPECT_LE(cycles * dt, wanted + 2 * dt) << length << ' ' << speed << ' ' << acc << ' ' << jerk;
    EXPECT_GE(cycles * dt, wanted - dt);
  }
}

/// Targets, speeds and stops at any moment: differences of the positions never pass a limit, and it arrives.
TEST(Ramp, ChangesAtAnyMomentKeepTheLimits) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int run = 0; run < 200; ++run) {
    const double acc = 100 + 2000 * u(rng), jerk = std::pow(10, 3.5 + 2 * u(rng)), dt = 0.001;
    AxisMover m;
    m.place(0);
    m.set_limits(acc, jerk);
    double p[4]{};
    int seen = 0;
    for (int i = 0; i < 6000; ++i) {
      if (i < 4000 && u(rng) < 0.02) m.go_to(100 * u(rng) - 50, 120 * u(rng) + 0.1);
      if (i < 4000 && u(rng) < 0.003) m.stop();
      if (i == 4000) m.go_to(7, 50);
      m.step(dt);
      for (int k = 3; k > 0; --k) p[k] = p[k - 1];
      p[0] = m.position();
      if (++seen < 4) continue;
      ASSERT_LE(std::abs(p[0] - 2 * p[1] + p[2]) / dt / dt, acc * 1.000001 + 1e-2)
          << run << ' ' << i;
      ASSERT_LE(std::abs(p[0] - 3 * p[1] + 3 * p[2] - p[3]) / dt / dt / dt, jerk * 1.000001 + 5)
          << run << ' ' << i;
      ASSERT_LE(std::abs(p[0] - p[1]) / dt, 130);
    }
    while (m.active() && seen++ < 40000) m.step(dt);
    EXPECT_EQ(m.position(), 7) << run;
  }
}

}  // namespace
}  // namespace kerf::motion
