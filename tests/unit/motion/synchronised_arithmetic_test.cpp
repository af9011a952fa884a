// What moves that follow a spindle reckon with: the observer of its angle and the tracker that comes into step.
#include "motion/core/synchronised.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "property/motion/random_program.hpp"

namespace kerf::motion {
namespace {

TEST(SpindleObserver, IsExactAtConstantAccelerationAndQuietBehindCoarseCounts) {
  constexpr double kDt = 0.001;
  SpindleObserver smooth;
  double angle = 0.2, rps = -3;
  for (int i = 0; i < 1000; ++i) {
    angle += kDt * (rps + 0.5 * 40 * kDt);
    rps += 40 * kDt;
    smooth.step(angle, kDt);
  }
  EXPECT_NEAR(smooth.angle(), angle, 1e-6);
  EXPECT_NEAR(smooth.rps(), rps, 1e-4);

  SpindleObserver coarse;
  double worst = 0, worst_rps = 0;
  for (int i = 0; i < 3000; ++i) {
    angle = 10.0 * kDt * i;
    coarse.step(std::floor(angle * 256) / 256, kDt);
    if (i < 500) continue;
    worst = std::max(worst, std::abs(coarse.angle() + 0.5 / 256 - angle));
    worst_rps = std::max(worst_rps, std::abs(coarse.rps() - 10));
  }
  EXPECT_LT(worst, 0.5 / 256);
  EXPECT_LT(worst_rps, 0.1);
  coarse.anchor(0);
  EXPECT_EQ(coarse.angle(), 0);
  EXPECT_NEAR(coarse.rps(), 10, 0.1);
}

TEST(SpindleObserver, SeesAtOnceThatASpindleStands) {
  constexpr double kDt = 0.001;
  for (const double counts : {100.0, 1024.0, 1e6}) {
    SpindleObserver o;
    double angle = 0, rps = 5, worst = 0;
    for (int i = 0; i < 1500; ++i) {
      if (i > 500) rps = std::max(0.0, rps - 50 * kDt);
      angle += rps * kDt;
      o.step(std::floor(angle * counts) / counts, kDt);
      if (i > 600) worst = std::max(worst, std::abs(o.angle() - angle));
      if (i > 700) {
        EXPECT_NEAR(o.rps(), 0, 0.05) << counts << " cycle " << i;
      }
    }
    EXPECT_LT(worst, 0.005 + 1.5 / counts) << counts;
  }
}

TEST(SpindleObserver, RecoversFromACounterThatIsSet) {
  constexpr double kDt = 0.001;
  for (const double jump : {0.3, 0.49, 0.7, 100.0, -3.3}) {
    SpindleObserver o;
    for (int i = 0; i < 300; ++i) o.step(0, kDt);
    for (int i = 0; i < 3000; ++i) o.step(jump, kDt);
    EXPECT_NEAR(o.angle(), jump, 1e-3) << jump;
    EXPECT_NEAR(o.rps(), 0, 0.02) << jump;
    double angle = jump;
    for (int i = 0; i < 1000; ++i) o.step(angle += 20 * kDt, kDt);
    for (int i = 0; i < 500; ++i) {
      if (i == 100) angle -= std::floor(angle);
      o.step(angle += 20 * kDt, kDt);
      EXPECT_NEAR(o.angle(), angle, 1e-3) << jump;
      EXPECT_NEAR(o.rps(), 20, 0.1) << jump;
    }
  }
}

TEST(SyncTracker, JoinsWithoutOvershootWithinItsShareOfTheAcceleration) {
  const double periods[] = {0.00025, 0.001, 0.002, 0.004};
  for (int n = 0; n < 16; ++n) {
    const double rps = std::array{0.5, 3.0, 10.0, 33.0}[static_cast<std::size_t>(n % 4)];
    const double dt = periods[n / 4];
    constexpr double kAcc = 600, kPitch = 1.5;
    SpindleObserver o;
    SyncTracker t;
    double angle = 0, s = 0, v = 0, worst_acc = 0, fastest = 0;
    bool begun = false;
    for (int i = 0; i * dt < 6; ++i) {
      angle += rps * dt;
      o.step(angle, dt);
      if (i * dt < 0.2) continue;
      if (!begun) t.begin(kPitch, angle, 1);
      begun = true;
      const double next = std::max(t.speed(o, s, kAcc, dt), 0.0);
      worst_acc = std::max(worst_acc, std::abs(next - v) / dt);
      s += 0.5 * (v + next) * dt;
      v = next;
      fastest = std::max(fastest, v);
    }
    EXPECT_TRUE(t.joined()) << rps;
    EXPECT_NEAR(t.lag(), 0, 1e-4) << rps;
    EXPECT_LE(worst_acc, kAcc * (1 + 15 * dt)) << rps;
    EXPECT_LE(fastest, 1.02 * kPitch * rps + 0.05) << "nothing is caught up, at " << rps;
    const double least = kPitch * rps * kPitch * rps / (2 * 0.8 * kAcc);
    EXPECT_LE(t.run_in(), least + (0.02 + 10 * dt) * kPitch * rps + 0.02) << rps;
  }
}

/// Random references with noise, random limits: within them in every cycle, and on the reference in the time that limits allow.
TEST(SyncTracker, KeepsItsJerkAndJoinsInTheLeastTime) {
  double slowest = 0, farthest = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    test::Random r(seed);
    const double dt = std::array{0.00025, 0.001, 0.002, 0.004}[seed % 4];
    FollowLimits limits{r.log(100, 5000), 0, 0, r.log(20, 300)};
    limits.jerk = limits.acc / r.log(0.004, 0.5);
    const double speed = limits.fastest * r.uniform(0.02, 0.8);
    limits.jerk = joining_jerk(limits.jerk, limits.acc, speed, dt);
    const RampLimits own{0.8 * limits.acc, 0.8 * limits.jerk};
    const double joins = joining_distance(speed, own.acc, own.jerk, dt);
    RampState s;
    Reference ref{joins + r.uniform(1, 20) * speed * dt, speed, 0};
    double place = 0, at = -ref.ahead, begun = -1, in_step = -1, overshoot = 0, off = 0,
           jerk_before = 0;
    for (int i = 0; i * dt < 60 && (in_step < 0 || i * dt < begun + in_step + 0.2); ++i) {
      ref.ahead = place - at;
      const double j = following_jerk(ref, s, limits, dt);
      ASSERT_LE(std::abs(j), limits.jerk * (1 + 1e-9));
      if (begun < 0 && j > 0) begun = i * dt;
      if (begun < 0) {
        ASSERT_EQ(j, 0);
      }
      place += dt * (s.speed + dt * (0.5 * s.acc + dt * j / 6));
      s.speed += dt * (s.acc + 0.5 * dt * j);
      s.acc += dt * j;
      ASSERT_LE(std::abs(s.acc), limits.acc * (1 + 1e-9));
      ASSERT_LE(s.speed, limits.fastest * (1 + 1e-9));
      ASSERT_GE(s.speed, -1e-9);
      at += speed * dt;
      overshoot = std::max(overshoot, s.speed - speed);
      if (begun >= 0 && i * dt > begun + ramp_to({}, speed, own).duration() + 2 * dt)
        off = std::max(off, std::abs(place - at));
      if (in_step < 0 && begun >= 0 && std::abs(place - at) < 2e-5 * speed + 1e-6)
        in_step = i * dt - begun;
      jerk_before = j;
    }
    ASSERT_GE(in_step, 0) << "ahead " << place - at << " speed " << s.speed << " of " << speed
                          << " jerk " << jerk_before;
    const double least = ramp_to({}, speed, own).duration();
    const double tail = std::max(0.1, 50 * dt);
    slowest = std::max(slowest, (in_step - least) / tail);
    EXPECT_LE(in_step, least + tail) << least;
    farthest = std::max(farthest, off / (speed * dt));
    EXPECT_LE(off, std::max(0.25 * speed * dt, 0.001));
    EXPECT_LE(overshoot, 0.02 * speed + 0.01 * own.jerk * dt);
  }
  std::printf(
      "result: 2 cycles after the least time at most %.2f of a cycle's way off, in step %.2f tails "
      "after it\n",
      farthest, slowest);
}

}  // namespace
}  // namespace kerf::motion
