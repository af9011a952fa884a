// What recorded runs of LinuxCNC cannot show: time, limits and return ways.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

TEST(Limit3, KeepsAllLimitsAndEndsOnTheInput) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("limit3"), "l"));
  hal.set("l.min", -2.0);
  hal.set("l.max", 2.5);
  hal.set("l.maxv", 10.0);
  hal.set("l.maxa", 200.0);
  double out = 0.0, speed = 0.0;
  for (int move = 0; move < 200; ++move) {
    const double target = place(random);
    hal.set("l.in", target);
    for (int i = 0; i < 1000; ++i) {
      hal.run("l");
      const double now = hal.get<double>("l.out"), speed_now = (now - out) * 1000.0;
      ASSERT_LE(now, 2.5 + 1e-9);
      ASSERT_GE(now, -2.0 - 1e-9);
      ASSERT_LE(std::fabs(speed_now), 10.0 + 1e-6);
      ASSERT_LE(std::fabs(speed_now - speed), 0.2 + 1e-6) << "move " << move << " call " << i;
      out = now;
      speed = speed_now;
    }
    EXPECT_NEAR(out, std::min(2.5, std::max(-2.0, target)), 1e-9);
  }
  hal.set("l.enable", false);
  hal.run("l", hal::TestBuilder::kPeriodNs, 1000);
  EXPECT_NEAR(hal.get<double>("l.out"), 0.0, 1e-9);
  hal.set("l.load", true);
  hal.set("l.in", 1.25);
  hal.run("l");
  EXPECT_EQ(hal.get<double>("l.out"), 0.0) << "without enable it is zero that is loaded";
  hal.set("l.enable", true);
  hal.run("l");
  EXPECT_EQ(hal.get<double>("l.out"), 1.25);
}

TEST(Limit3, FollowsAnInputUnderWayWithoutLag) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("limit3"), "l"));
  hal.set("l.max", 8.0);
  hal.set("l.maxv", 20.0);
  hal.set("l.maxa", 400.0);
  double in = 0.0, out = 0.0, speed = 0.0;
  for (int i = 0; i < 2000; ++i) {
    in += 0.01;
    hal.set("l.in", in);
    hal.run("l");
    const double now = hal.get<double>("l.out");
    ASSERT_LE(now, 8.0 + 1e-9);
    ASSERT_LE(std::fabs((now - out) * 1000.0 - speed), 0.4 + 1e-6) << "call " << i;
    speed = (now - out) * 1000.0;
    out = now;
    if (i > 300 && in < 7.5) {
      ASSERT_NEAR(now, in, 1e-9) << "call " << i;
    }
  }
  EXPECT_NEAR(out, 8.0, 1e-9);
}

TEST(Moveoff, TakesTheOffsetOfTheLastCycleFromTheFeedback) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("moveoff"), "mv", 1));
  for (const char* pin : {"mv.power-on", "mv.move-enable", "mv.apply-offsets"}) hal.set(pin, true);
  hal.set("mv.offset-in-0", 1.0);
  double before = 0.0;
  for (int i = 0; i < 300; ++i) {
    // A motor that is where it was sent in the last cycle.
    hal.set("mv.fb-0", before);
    hal.run("mv.read-inputs");
    hal.run("mv.write-outputs");
    EXPECT_EQ(hal.get<double>("mv.fb-minusoffset-0"), 0.0) << "call " << i;
    before = hal.get<double>("mv.pos-plusoffset-0");
  }
  EXPECT_GT(before, 0.5);
}

TEST(Watchdog, BitesAtAStillInputAndNeedsANewEnable) {
  hal::TestBuilder hal;
  hal.set_arg("num_inputs", "2");
  ASSERT_TRUE(hal.create(module("watchdog"), "watchdog")) << hal.error();
  hal.set("watchdog.timeout-0", 0.005);
  hal.set("watchdog.timeout-1", 0.010);
  bool beat = false;
  const auto run = [&](int cycles, bool first, bool second) {
    for (int i = 0; i < cycles; ++i) {
      beat = !beat;
      if (first) hal.set("watchdog.input-0", beat);
      if (second) hal.set("watchdog.input-1", beat);
      hal.run("watchdog.process");
      hal.run("watchdog.set-timeouts");
    }
    return hal.get<bool>("watchdog.ok-out");
  };
  EXPECT_FALSE(run(3, true, true));
  hal.set("watchdog.enable-in", true);
  EXPECT_TRUE(run(50, true, true));
  EXPECT_TRUE(run(4, false, true));
  EXPECT_FALSE(run(2, false, true));
  EXPECT_FALSE(run(50, true, true)) << "it stays bitten";
  hal.set("watchdog.enable-in", false);
  EXPECT_FALSE(run(1, true, true));
  hal.set("watchdog.enable-in", true);
  EXPECT_TRUE(run(50, true, true));
  hal.set("watchdog.enable-in", false);
  EXPECT_FALSE(run(1, true, true));
}

TEST(SimEncoder, MakesAsManyCountsAsTheSpeedSays) {
  hal::TestBuilder hal;
  ASSERT_TRUE(hal.create(module("sim_encoder"), "sim-encoder")) << hal.error();
  ASSERT_TRUE(hal.create(module("encoder"), "encoder")) << hal.error();
  hal.set("sim-encoder.0.ppr", 25);
  hal.set("encoder.0.position-scale", 100.0);
  int indexes = 0;
  bool z_before = true;
  const auto run = [&](double speed, int cycles) {
    hal.set("sim-encoder.0.speed", speed);
    for (int i = 0; i < cycles; ++i) {
      if (i % 20 == 0) hal.run("sim-encoder.update-speed");
      hal.run("sim-encoder.make-pulses", 50'000);
      for (const char* phase : {"phase-A", "phase-B", "phase-Z"})
        hal.set(std::string("encoder.0.") + phase,
                hal.get<bool>(std::string("sim-encoder.0.") + phase));
      const bool z = hal.get<bool>("sim-encoder.0.phase-Z");
      indexes += z && !z_before ? 1 : 0;
      z_before = z;
      hal.run("encoder.update-counters", 50'000);
      if (i % 20 == 19) hal.run("encoder.capture-position");
    }
    return hal.get<double>("encoder.0.position");
  };
  EXPECT_NEAR(run(7.3, 20'000), 7.3, 0.03);
  EXPECT_NEAR(hal.get<double>("encoder.0.velocity"), 7.3, 0.2);
  EXPECT_EQ(indexes, 7);
  EXPECT_NEAR(run(-7.3, 20'000), 0.0, 0.04);
  EXPECT_NEAR(hal.get<double>("encoder.0.velocity"), -7.3, 0.2);
}

TEST(Moveoff, AppliesOffsetsWithinTheirLimitsAndComesBack) {
  for (const bool backtrack : {false, true}) {
    hal::TestBuilder hal;
    ASSERT_TRUE(hal.create(module("moveoff"), "mv", 2)) << hal.error();
    hal.set("mv.power-on", true);
    hal.set("mv.backtrack-enable", backtrack);
    hal.set("mv.move-enable", true);
    hal.set("mv.apply-offsets", true);
    hal.set("mv.offset-in-0", 0.7);
    hal.set("mv.offset-in-1", -3.0);
    hal.set("mv.offset-min-1", -0.4);
    hal.set("mv.pos-0", 5.0);
    hal.set("mv.fb-1", 2.0);
    double before[2]{};
    const auto run = [&](int cycles) {
      for (int i = 0; i < cycles; ++i) {
        hal.run("mv.read-inputs");
        hal.run("mv.write-outputs");
        for (int j = 0; j < 2; ++j) {
          const double now = hal.get<double>("mv.offset-current-" + std::to_string(j));
          ASSERT_LE(std::fabs(now - before[j]), 0.010 + 1e-9) << "10 units a second";
          before[j] = now;
        }
      }
    };
    run(1000);
    EXPECT_NEAR(before[0], 0.7, 1e-6);
    EXPECT_NEAR(before[1], -0.4, 1e-6);
    EXPECT_NEAR(hal.get<double>("mv.pos-plusoffset-0"), 5.7, 1e-6);
    EXPECT_NEAR(hal.get<double>("mv.fb-minusoffset-1"), 2.4, 1e-6);
    EXPECT_TRUE(hal.get<bool>("mv.offset-applied"));
    hal.set("mv.apply-offsets", false);
    run(1);
    EXPECT_TRUE(hal.get<bool>("mv.warning"));
    run(5000);
    EXPECT_NEAR(before[0], 0.0, 1e-4);
    EXPECT_NEAR(before[1], 0.0, 1e-4);
    EXPECT_FALSE(hal.get<bool>("mv.offset-applied"));
    EXPECT_FALSE(hal.get<bool>("mv.warning"));
    EXPECT_EQ(hal.get<std::int32_t>("mv.dbg-state"), 0);
  }
}

class MatrixKbCodes : public testing::Test {
 protected:
  void SetUp() override {
    hal.set_arg("config", "4x8");
    ASSERT_TRUE(hal.create(module("matrix_kb"), "matrix-kb")) << hal.error();
  }
  void code(std::uint32_t value) {
    hal.set("matrix_kb.0.keycode", value);
    hal.run("matrix_kb.0");
  }
  hal::TestBuilder hal;
};

TEST_F(MatrixKbCodes, ShowsTheKeysOfItsCodesAndNoMoreThanItMay) {
  code(0xC0 + 2 * 8 + 3);
  EXPECT_TRUE(hal.get<bool>("matrix_kb.0.key.r2c3"));
  code(0x40);
  EXPECT_TRUE(hal.get<bool>("matrix_kb.0.key.r2c3"));
  code(0xC0 + 1);
  EXPECT_TRUE(hal.get<bool>("matrix_kb.0.key.r0c1"));
  code(0xC0 + 2);
  EXPECT_FALSE(hal.get<bool>("matrix_kb.0.key.r0c2")) << "two keys are the limit";
  code(0x80 + 1);
  EXPECT_FALSE(hal.get<bool>("matrix_kb.0.key.r0c1"));
  code(0xC0 + 2);
  EXPECT_TRUE(hal.get<bool>("matrix_kb.0.key.r0c2"));
}

TEST_F(MatrixKbCodes, CountsTheKeysThatAreDownWhateverCodesRepeat) {
  for (const std::uint32_t key : {0U, 0U, 1U, 2U}) code(0xC0 + key);
  EXPECT_TRUE(hal.get<bool>("matrix_kb.0.key.r0c1")) << "the first key is down once";
  EXPECT_FALSE(hal.get<bool>("matrix_kb.0.key.r0c2"));
  code(0x80 + 2);
  code(0xC0 + 3);
  EXPECT_FALSE(hal.get<bool>("matrix_kb.0.key.r0c3")) << "a key that was not taken leaves no place";
}

TEST(MatrixKb, ScansEachKeyWhateverTheOthersOfItsRowDo) {
  hal::TestBuilder hal;
  hal.set_arg("config", "1x2s");
  ASSERT_TRUE(hal.create(module("matrix_kb"), "matrix-kb")) << hal.error();
  hal.set("matrix_kb.0.negative-logic", false);
  const auto scan = [&](bool first, bool second) {
    hal.set("matrix_kb.0.col-00-in", first);
    hal.set("matrix_kb.0.col-01-in", second);
    hal.run("matrix_kb.0");
  };
  // The second key changes between the two scans that have to agree for the first one.
  for (const bool down : {true, false}) {
    scan(down, !down);
    scan(down, down);
    EXPECT_EQ(hal.get<bool>("matrix_kb.0.key.r0c0"), down);
    scan(down, down);
    EXPECT_EQ(hal.get<bool>("matrix_kb.0.key.r0c1"), down);
    for (int i = 0; i < 3; ++i) scan(down, down);
  }
}

TEST(Pid, TunesAPlantSoThatItSettles) {
  hal::TestBuilder hal;
  hal.set_arg("num_chan", "1");
  ASSERT_TRUE(hal.create(module("pid"), "pid")) << hal.error();
  hal.set("pid.0.enable", true);
  hal.set("pid.0.tune-mode", true);
  hal.set("pid.0.tune-effort", 1.0);
  hal.set("pid.0.tune-start", true);
  double speed = 0.0, at = 0.01;
  const auto run = [&](int cycles) {
    for (int i = 0; i < cycles; ++i) {
      hal.set("pid.0.feedback", at);
      hal.run("pid.0.do-pid-calcs");
      // A motor whose speed follows the output within 20 ms.
      speed += (hal.get<double>("pid.0.output") - speed) * 0.05;
      at += speed * 1e-3;
    }
  };
  run(60'000);
  EXPECT_FALSE(hal.get<bool>("pid.0.tune-start"));
  EXPECT_GT(hal.get<double>("pid.0.Pgain"), 5.0);
  EXPECT_GT(hal.get<double>("pid.0.Dgain"), 0.0);
  hal.set("pid.0.tune-mode", false);
  hal.set("pid.0.command", 0.5);
  run(20'000);
  EXPECT_NEAR(at, 0.5, 1e-3);
}

TEST(Pid, HoldsTheIntegralWhileTheOutputIsAtItsLimit) {
  hal::TestBuilder hal;
  hal.set_arg("names", "loop");
  hal.set_arg("debug", "1");
  ASSERT_TRUE(hal.create(module("pid"), "pid")) << hal.error();
  hal.set("loop.enable", true);
  hal.set("loop.Igain", 10.0);
  hal.set("loop.maxoutput", 2.0);
  hal.set("loop.command", 10.0);
  hal.run("loop.do-pid-calcs", hal::TestBuilder::kPeriodNs, 1000);
  EXPECT_EQ(hal.get<double>("loop.output"), 2.0);
  EXPECT_TRUE(hal.get<bool>("loop.saturated"));
  EXPECT_GT(hal.get<std::int32_t>("loop.saturated-count"), 990);
  EXPECT_NEAR(hal.get<double>("loop.saturated-s"), 1.0, 0.02);
  EXPECT_LT(hal.get<double>("loop.errorI"), 0.1);
}

}  // namespace
}  // namespace kerf::components
