#include "motion/core/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "motion/core/axis_mover.hpp"

namespace kerf::motion {
namespace {

double time_to_end(double length, double speed, double acc, double period) {
  ProfileState s{length, 0};
  double t = 0;
  for (int i = 0; i < 10'000'000; ++i) {
    const double used = advance(s, {speed, acc, 0}, period);
    t += used;
    if (s.left == 0) return t;
  }
  return -1;
}

/// Trapezoid or triangle in closed form.
double least_time(double length, double speed, double acc) {
  if (speed * speed / acc >= length) return 2 * std::sqrt(length / acc);
  return length / speed + speed / acc;
}

TEST(Profile, TakesTheLeastTimeWhateverThePeriod) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> log_length(-6, 3), log_speed(-1, 3), log_acc(0, 4),
      period(1e-5, 1e-2);
  for (int i = 0; i < 300; ++i) {
    const double length = std::pow(10, log_length(rng)), speed = std::pow(10, log_speed(rng)),
                 acc = std::pow(10, log_acc(rng));
    const double wanted = least_time(length, speed, acc);
    const double t = time_to_end(length, speed, acc, std::max(period(rng), wanted / 1e5));
    EXPECT_NEAR(t, wanted, 1e-6 * wanted + 1e-9) << length << ' ' << speed << ' ' << acc;
  }
}

TEST(Profile, SpeedChangesKeepTheAccelerationAndTheEnd) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(0, 1);
  for (int run = 0; run < 200; ++run) {
    const double acc = 100 + 1000 * u(rng), length = 0.1 + 50 * u(rng), dt = 0.001;
    ProfileState s{length, 0};
    double speed = 100 * u(rng);
    for (int i = 0; i < 200000 && s.left > 0; ++i) {
      if (u(rng) < 0.02) speed = u(rng) < 0.2 ? 0.0 : 100 * u(rng);
      if (i > 3000) speed = 50;
      const ProfileState before = s;
      const double used = advance(s, {speed, acc, 0}, dt);
      EXPECT_LE(s.left, before.left);
      EXPECT_LE(std::abs(s.speed - before.speed), acc * used * (1 + 1e-9) + 1e-9);
      // Never faster than what the rest allows.
      EXPECT_LE(s.speed * s.speed, 2 * acc * s.left * (1 + 1e-6) + 1e-12);
    }
    EXPECT_EQ(s.left, 0);
    EXPECT_EQ(s.speed, 0);
  }
}

TEST(Profile, StandsWhenNothingIsWanted) {
  ProfileState s{10, 0};
  EXPECT_EQ(advance(s, {0, 100, 0}, 0.001), 0.001);
  EXPECT_EQ(s.left, 10);
}

TEST(AxisMover, ReachesTheTargetExactlyAndTurnsRound) {
  AxisMover m;
  m.set_limits(1000, 0);
  m.place(5);
  m.go_to(105, 50);
  double last = 5, last_v = 0;
  for (int i = 0; i < 10000 && m.active(); ++i) {
    if (i == 500) m.go_to(-20.25, 80);                 // while it runs the other way
    if (i == 700) m.go_to(m.position() - 0.0001, 80);  // too near to stop at: over and back
    m.step(0.001);
    const double v = (m.position() - last) / 0.001;
    EXPECT_LE(std::abs(v), 80.0001);
    EXPECT_LE(std::abs(v - last_v) / 0.001, 1000.1) << i;
    last = m.position();
    last_v = v;
  }
  EXPECT_FALSE(m.active());
  EXPECT_EQ(m.speed(), 0);
  EXPECT_EQ(m.position(), m.target());
}

TEST(AxisMover, StopTakesTheBrakingDistance) {
  AxisMover m;
  m.set_limits(1000, 0);
  m.go_to(1e6, 100);
  for (int i = 0; i < 500; ++i) m.step(0.001);
  const double from = m.position();
  m.stop();
  for (int i = 0; i < 101; ++i) m.step(0.001);
  EXPECT_FALSE(m.active());
  EXPECT_NEAR(m.position() - from, 5.0, 1e-9);
}

}  // namespace
}  // namespace kerf::motion
