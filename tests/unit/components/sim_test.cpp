#include <gtest/gtest.h>

#include <cmath>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

constexpr std::int64_t kMs = 1'000'000;

class HomeSwitchTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(hal.create(module("sim_home_switch"), "sw")); }
  bool at(double position) {
    hal.set("sw.cur-pos", position);
    hal.run("sw");
    return hal.get<bool>("sw.home-sw");
  }
  hal::TestBuilder hal;
};

TEST_F(HomeSwitchTest, ClosesAtHomeAndOpensAfterTheHysteresis) {
  EXPECT_FALSE(at(0.0));
  EXPECT_FALSE(at(0.999));
  EXPECT_TRUE(at(1.0));
  EXPECT_TRUE(at(1.3));
  EXPECT_TRUE(at(0.95));
  EXPECT_TRUE(at(0.905));
  EXPECT_FALSE(at(0.895));
  EXPECT_FALSE(at(0.95));
}

TEST_F(HomeSwitchTest, IsMirroredForANegativeHome) {
  hal.set("sw.home-pos", -2.0);
  hal.set("sw.hysteresis", 0.5);
  EXPECT_FALSE(at(0.0));
  EXPECT_FALSE(at(3.0));
  EXPECT_TRUE(at(-2.0));
  EXPECT_TRUE(at(-1.6));
  EXPECT_FALSE(at(-1.4));
  EXPECT_FALSE(at(-1.9));
}

TEST_F(HomeSwitchTest, ClearsIndexEnableAfterTheDelay) {
  hal.set("sw.index-enable", true);
  hal.run("sw", kMs, 10);
  EXPECT_TRUE(hal.get<bool>("sw.index-enable"));
  hal.run("sw");
  EXPECT_FALSE(hal.get<bool>("sw.index-enable"));
  hal.run("sw");  // it has to be seen false before it is waited for again
  hal.set("sw.index-delay-ms", 2.5);
  hal.set("sw.index-enable", true);
  hal.run("sw", kMs, 3);
  EXPECT_TRUE(hal.get<bool>("sw.index-enable"));
  hal.run("sw");
  EXPECT_FALSE(hal.get<bool>("sw.index-enable"));
}

class SpindleTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(hal.create(module("sim_spindle"), "sp")); }
  double position() { return hal.get<double>("sp.position-fb"); }
  hal::TestBuilder hal;
};

TEST_F(SpindleTest, CountsRevolutionsAtTheScaledSpeed) {
  hal.set("sp.velocity-cmd", 600.0);
  hal.set("sp.scale", 1.0 / 60.0);
  hal.run("sp", kMs, 250);
  EXPECT_NEAR(position(), 2.5, 1e-9);
  EXPECT_TRUE(hal.get<bool>("sp.at-speed"));
  EXPECT_NEAR(hal.get<double>("sp.velocity-fb"), 10.0, 1e-9);
  hal.set("sp.velocity-cmd", -600.0);
  hal.run("sp", kMs, 500);
  EXPECT_NEAR(position(), -2.5, 1e-9);
}

TEST_F(SpindleTest, ZeroesAtTheNextIndexAndKeepsTheRest) {
  hal.set("sp.velocity-cmd", 33.3);
  hal.run("sp", kMs, 103);
  EXPECT_NEAR(position(), 3.4299, 1e-9);
  hal.set("sp.index-enable", true);
  hal.run("sp", kMs, 17);
  EXPECT_TRUE(hal.get<bool>("sp.index-enable"));
  EXPECT_NEAR(position(), 3.996, 1e-9);
  hal.run("sp");
  EXPECT_FALSE(hal.get<bool>("sp.index-enable"));
  EXPECT_NEAR(position(), 0.0293, 1e-9);
  // The next index is one revolution on, and backwards it is the same place.
  hal.run("sp", kMs, 40);
  hal.set("sp.velocity-cmd", -33.3);
  hal.set("sp.index-enable", true);
  const double before = position();
  int cycles = 0;
  while (hal.get<bool>("sp.index-enable") && cycles < 100) {
    hal.run("sp");
    ++cycles;
  }
  EXPECT_NEAR(position(), std::fmod(before, 1.0) - 0.0333 * cycles, 1e-9);
  EXPECT_LE(position(), 0.0);
  EXPECT_GT(position(), -0.0334);
}

TEST_F(SpindleTest, RampsAndSaysWhenItIsAtSpeed) {
  hal.set("sp.acceleration", 100.0);
  hal.set("sp.velocity-cmd", 10.0);
  double before = 0.0;
  int cycles = 0;
  do {
    hal.run("sp");
    ++cycles;
    const double now = hal.get<double>("sp.velocity-fb");
    ASSERT_LE(now - before, 0.1 + 1e-9);
    before = now;
  } while (!hal.get<bool>("sp.at-speed") && cycles < 1000);
  EXPECT_NEAR(cycles, 98, 1);  // 2 percent of tolerance
  hal.run("sp", kMs, 10);
  EXPECT_NEAR(hal.get<double>("sp.velocity-fb"), 10.0, 1e-9);
  hal.set("sp.velocity-cmd", 0.0);
  hal.run("sp", kMs, 50);
  EXPECT_FALSE(hal.get<bool>("sp.at-speed"));
  hal.run("sp", kMs, 60);
  EXPECT_TRUE(hal.get<bool>("sp.at-speed"));
  EXPECT_EQ(hal.get<double>("sp.velocity-fb"), 0.0);
}

TEST_F(SpindleTest, OrientsTheShortWayAfterItStopped) {
  hal.set("sp.acceleration", 50.0);
  hal.set("sp.velocity-cmd", 3.3);
  hal.run("sp", kMs, 300);
  hal.set("sp.velocity-cmd", 0.0);
  hal.set("sp.orient", true);
  hal.set("sp.orient-angle", 90.0);
  hal.run("sp");
  EXPECT_FALSE(hal.get<bool>("sp.is-oriented"));
  hal.run("sp", kMs, 66);  // the ramp down
  EXPECT_FALSE(hal.get<bool>("sp.is-oriented"));
  const double stopped_at = position();
  int cycles = 0;
  while (!hal.get<bool>("sp.is-oriented") && cycles < 2000) {
    hal.run("sp");
    ++cycles;
  }
  EXPECT_TRUE(hal.get<bool>("sp.is-oriented"));
  EXPECT_NEAR(cycles, 1000.0 * std::fabs(position() - stopped_at), 2.0);  // one rev/s
  EXPECT_LE(std::fabs(position() - stopped_at), 0.5);
  EXPECT_NEAR(std::remainder(position() - 0.25, 1.0), 0.0, 1e-9);
  hal.run("sp", kMs, 100);
  EXPECT_NEAR(std::remainder(position() - 0.25, 1.0), 0.0, 1e-9);
  hal.set("sp.orient", false);
  hal.run("sp");
  EXPECT_FALSE(hal.get<bool>("sp.is-oriented"));
}

class AxisTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(hal.create(module("sim-axis"), "ax")); }
  void go(double position) {
    hal.set("ax.pos-cmd", position);
    hal.run("ax");
  }
  double feedback() { return hal.get<double>("ax.pos-fb"); }
  bool bit(const char* name) { return hal.get<bool>(name); }
  hal::TestBuilder hal;
};

TEST_F(AxisTest, FollowsExactlyByDefaultAndTripsNothing) {
  for (const double x : {0.1, 0.3, -17.7, 1e6}) {
    go(x);
    EXPECT_EQ(feedback(), x);
    EXPECT_FALSE(bit("ax.home-sw"));
    EXPECT_FALSE(bit("ax.neg-lim-sw"));
    EXPECT_FALSE(bit("ax.pos-lim-sw"));
  }
}

TEST_F(AxisTest, LagsByVelocityTimesTheTimeConstant) {
  constexpr double kLag = 0.02, kVelocity = 50.0, kDt = 1e-3;
  hal.set("ax.lag", kLag);
  double x = 0.0;
  for (int i = 0; i < 1000; ++i) go(x += kVelocity * kDt);
  const double decay = std::exp(-kDt / kLag);
  EXPECT_NEAR(x - feedback(), kVelocity * kDt * decay / (1 - decay), 1e-9);
  EXPECT_NEAR(x - feedback(), kVelocity * kLag, kVelocity * kDt);
  EXPECT_NEAR(hal.get<double>("ax.vel-fb"), kVelocity, 1e-6);
  for (int i = 0; i < 1000; ++i) go(x);
  EXPECT_NEAR(feedback(), x, 1e-9);
}

TEST_F(AxisTest, IsBoundByItsVelocityAndStandsWhenStuckOrDisabled) {
  hal.set("ax.max-velocity", 10.0);
  go(1.0);
  EXPECT_NEAR(feedback(), 0.01, 1e-12);
  hal.set("ax.stuck", true);
  go(2.0);
  EXPECT_NEAR(feedback(), 0.01, 1e-12);
  EXPECT_EQ(hal.get<double>("ax.vel-fb"), 0.0);
  hal.set("ax.stuck", false);
  hal.set("ax.enable", false);
  go(2.0);
  EXPECT_NEAR(feedback(), 0.01, 1e-12);
  hal.set("ax.enable", true);
  go(-2.0);
  EXPECT_NEAR(feedback(), 0.0, 1e-12);
}

TEST_F(AxisTest, ACommandThatIsNoNumberMovesNothing) {
  go(2.5);
  for (const double lag : {0.0, 0.02}) {
    hal.set("ax.lag", lag);
    go(std::nan(""));
    EXPECT_EQ(feedback(), 2.5);
    go(INFINITY);
    EXPECT_EQ(feedback(), 2.5);
  }
}

TEST_F(AxisTest, HomeSwitchIsASideOrACam) {
  struct Case {
    double width;
    bool positive;
    double position;
    bool tripped;
  };
  constexpr Case kCases[] = {
      {0, false, 5.0, true},   {0, false, 5.001, false}, {0, false, -100, true},
      {0, true, 5.0, true},    {0, true, 4.999, false},  {0, true, 100, true},
      {2, false, 4.0, true},   {2, false, 3.99, false},  {2, false, 6.0, true},
      {2, false, 6.01, false}, {2, true, 5.0, true},
  };
  for (const Case& c : kCases) {
    hal::TestBuilder b;
    ASSERT_TRUE(b.create(module("sim-axis"), "ax"));
    b.set("ax.home-switch-pos", 5.0);
    b.set("ax.home-switch-width", c.width);
    b.set("ax.home-switch-positive", c.positive);
    b.set("ax.pos-cmd", c.position);
    b.run("ax");
    EXPECT_EQ(b.get<bool>("ax.home-sw"), c.tripped)
        << "width " << c.width << " positive " << c.positive << " at " << c.position;
  }
}

TEST_F(AxisTest, SwitchesHaveHysteresisAndLimitsTrip) {
  hal.set("ax.home-switch-pos", 0.0);
  hal.set("ax.home-switch-hysteresis", 0.2);
  hal.set("ax.neg-limit-pos", -10.0);
  hal.set("ax.pos-limit-pos", 10.0);
  go(0.1);
  EXPECT_FALSE(bit("ax.home-sw"));
  go(0.0);
  EXPECT_TRUE(bit("ax.home-sw"));
  go(0.15);
  EXPECT_TRUE(bit("ax.home-sw"));
  go(0.21);
  EXPECT_FALSE(bit("ax.home-sw"));
  go(10.0);
  EXPECT_TRUE(bit("ax.pos-lim-sw"));
  EXPECT_FALSE(bit("ax.neg-lim-sw"));
  go(-10.5);
  EXPECT_FALSE(bit("ax.pos-lim-sw"));
  EXPECT_TRUE(bit("ax.neg-lim-sw"));
}

TEST_F(AxisTest, CountsFromTheIndexOnRequest) {
  hal.set("ax.index-pitch", 4.0);
  go(3.0);
  go(5.0);
  EXPECT_EQ(feedback(), 5.0);  // nobody asked
  hal.set("ax.index-enable", true);
  go(7.5);
  EXPECT_TRUE(bit("ax.index-enable"));
  go(8.25);
  EXPECT_FALSE(bit("ax.index-enable"));
  EXPECT_NEAR(feedback(), 0.25, 1e-12);
  EXPECT_NEAR(hal.get<double>("ax.true-pos"), 8.25, 1e-12);
  go(0.25);  // the controller goes on in the new count
  EXPECT_NEAR(feedback(), 0.25, 1e-12);
  EXPECT_NEAR(hal.get<double>("ax.true-pos"), 8.25, 1e-12);
  hal.set("ax.index-enable", true);
  go(-0.5);
  EXPECT_FALSE(bit("ax.index-enable"));
  EXPECT_NEAR(feedback(), -0.5, 1e-12);
}

}  // namespace
}  // namespace kerf::components

namespace kerf::components {
namespace {

class MassTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(hal.create(module("sim-axis"), "m"));
    hal.set("m.inertia", 20.0);
    hal.set("m.bandwidth", 100.0);
  }
  double at() { return hal.get<double>("m.pos-fb"); }
  /// Commands a steady velocity for a while; gives the following error at its end.
  double follow(double vel, int cycles) {
    for (int i = 0; i < cycles; ++i) {
      command_ += vel * 1e-3;
      hal.set("m.pos-cmd", command_);
      hal.run("m");
    }
    return command_ - at();
  }
  double command_{0.0};
  hal::TestBuilder hal;
};

TEST_F(MassTest, FollowsWithTheErrorThatFrictionAndDampingMake) {
  EXPECT_NEAR(follow(50.0, 1000), 0.0, 1e-6);
  hal.set("m.friction", 300.0);
  hal.set("m.damping", 8.0);
  EXPECT_NEAR(follow(50.0, 1000), (300.0 + 8.0 * 50.0) / (20.0 * 100.0 * 100.0), 1e-6);
  EXPECT_NEAR(follow(-50.0, 1000), -(300.0 + 8.0 * 50.0) / (20.0 * 100.0 * 100.0), 1e-6);
  EXPECT_NEAR(hal.get<double>("m.force"), -(300.0 + 8.0 * 50.0), 0.1);
  // At rest friction holds it beside its place, and not farther off than it can.
  follow(0.0, 2000);
  EXPECT_LE(std::fabs(command_ - at()), 300.0 / (20.0 * 100.0 * 100.0) + 1e-6);
  EXPECT_EQ(hal.get<double>("m.vel-fb"), 0.0);
}

TEST_F(MassTest, FallsBehindWhenTheForceDoesNotDo) {
  hal.set("m.max-force", 1000.0);  // 50 units per second^2
  double before = 0.0;
  for (int i = 0; i < 500; ++i) {
    command_ += 100.0 * 1e-3;
    hal.set("m.pos-cmd", command_);
    hal.run("m");
    const double vel = hal.get<double>("m.vel-fb");
    ASSERT_LE(std::fabs(vel - before), 50.0 * 1e-3 * 1.001) << i;
    before = vel;
  }
  EXPECT_GT(command_ - at(), 20.0);
}

TEST_F(MassTest, RunsOutWithoutPowerAndStandsWhenStuck) {
  hal.set("m.friction", 200.0);  // 10 units per second^2
  follow(40.0, 1000);
  hal.set("m.enable", false);
  const double from = at();
  hal.run("m", 1'000'000, 5000);
  EXPECT_NEAR(at() - from, 40.0 * 40.0 / (2 * 10.0), 0.5);
  EXPECT_EQ(hal.get<double>("m.vel-fb"), 0.0);
  // Back on: no jump, within what the drive can do.
  hal.set("m.max-force", 2000.0);
  hal.set("m.enable", true);
  hal.run("m");
  EXPECT_LE(std::fabs(hal.get<double>("m.vel-fb")), 0.11);
  hal.set("m.stuck", true);
  hal.run("m", 1'000'000, 10);
  EXPECT_EQ(hal.get<double>("m.vel-fb"), 0.0);
}

TEST(SwitchBounce, IsUnsteadyForItsTimeAndAlwaysTheSame) {
  std::string first;
  for (int turn = 0; turn < 2; ++turn) {
    hal::TestBuilder hal;
    ASSERT_TRUE(hal.create(module("sim-axis"), "m"));
    hal.set("m.home-switch-pos", -5.0);
    hal.set("m.neg-limit-pos", -6.0);
    hal.set("m.switch-bounce", 0.012);
    hal.set("m.pos-cmd", -5.5);
    std::string seen;
    for (int i = 0; i < 40; ++i) {
      hal.run("m");
      seen += hal.get<bool>("m.home-sw") ? '1' : '0';
      EXPECT_FALSE(hal.get<bool>("m.neg-lim-sw"));
    }
    EXPECT_EQ(seen[0], '1');
    EXPECT_NE(seen.substr(0, 13).find("01"), std::string::npos) << seen;
    EXPECT_NE(seen.substr(0, 13).find("10"), std::string::npos) << seen;
    EXPECT_EQ(seen.substr(13), std::string(27, '1'));
    if (turn == 1) {
      EXPECT_EQ(seen, first);
    }
    first = seen;
  }
}

TEST(SpindleEncoder, CountsInSteps) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("sim_spindle"), "sp"));
  hal.set("sp.velocity-cmd", 1.0);
  hal.set("sp.encoder-counts", 400.0);
  for (int i = 1; i <= 2000; ++i) {
    hal.run("sp");
    const double counts = hal.get<double>("sp.position-fb") * 400.0;
    ASSERT_NEAR(counts, std::round(counts), 1e-9);
    ASSERT_LE(std::fabs(counts / 400.0 - 0.001 * i), 1.0 / 400.0 + 1e-9);
  }
}

class ProbeTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(hal.create(module("sim_probe"), "p"));
    hal.set("p.max-x", 10.0);
    hal.set("p.max-y", 10.0);
    hal.set("p.max-z", 10.0);
    hal.set("p.radius", 1.0);
    hal.set("p.z", 20.0);
  }
  bool at(double x, double y, double z) {
    hal.set("p.x", x);
    hal.set("p.y", y);
    hal.set("p.z", z);
    hal.run("p");
    return hal.get<bool>("p.tripped");
  }
  hal::TestBuilder hal;
};

TEST_F(ProbeTest, TouchesWithTheRadiusOfItsTip) {
  EXPECT_FALSE(at(5, 5, 11.001));
  EXPECT_TRUE(at(5, 5, 10.999));
  EXPECT_TRUE(at(-0.7, 5, 10.7));
  EXPECT_FALSE(at(-0.72, 5, 10.72)) << "around the edge";
  EXPECT_EQ(hal.get<std::uint32_t>("p.contacts"), 1U);
  hal.set("p.connected", false);
  EXPECT_FALSE(at(5, 5, 5));
  EXPECT_TRUE(hal.get<bool>("p.contact"));
  hal.set("p.stuck", true);
  EXPECT_TRUE(at(5, 5, 50));
}

TEST_F(ProbeTest, AnswersLateAndBounces) {
  hal.set("p.delay", 0.003);
  hal.set("p.bounce", 0.008);
  int cycles = 0;
  while (!at(5, 5, 10.5) && cycles < 20) ++cycles;
  EXPECT_EQ(cycles, 3);
  std::string seen;
  for (int i = 0; i < 20; ++i) seen += at(5, 5, 10.5) ? '1' : '0';
  EXPECT_NE(seen.substr(0, 8).find('0'), std::string::npos) << seen;
  EXPECT_EQ(seen.substr(8), std::string(12, '1'));
}

}  // namespace
}  // namespace kerf::components
