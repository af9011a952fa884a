#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "hal/core/test_builder.hpp"
#include "harness/step_machine.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

TEST(Stepgen, FollowsAMovingCommandWithinAStepAndKeepsItsTimes) {
  struct Case {
    Timing times;
    double size, scale, accel;
  };
  // Slow drives and fast ones, coarse scales and fine ones: a million base periods together.
  for (const Case& c : {Case{{60'000, 50'000, 200'000, 100'000}, 5.0, 100.0, 2000.0},
                        Case{{1, 1, 1, 1}, 20.0, 200.0, 2000.0},
                        Case{{5'000, 5'000, 1'000'000, 1'000'000}, 1.0, 400.0, 500.0},
                        Case{{100'000, 100'000, 50'000, 300'000}, 0.02, 5000.0, 50.0}}) {
    StepMachine m(module("stepgen"), c.times);
    ASSERT_TRUE(m.made());
    m.hal().set("stepgen.0.position-scale", c.scale);
    m.hal().set("stepgen.0.maxaccel", c.accel);
    double phase_s = 0.0;
    const double worst = m.follow_sines(c.size, c.scale, 12'500, phase_s);
    EXPECT_EQ(m.watch().wrong(), "");
    EXPECT_LT(worst, 1.0) << "scale " << c.scale;
    EXPECT_EQ(m.hal().get<std::int32_t>("stepgen.0.rawcounts"), m.watch().count());
  }
}

// Late by the same time at any speed and scale: axes that move together stay on their path, and FERROR sees half a period of the speed.
TEST(Stepgen, IsLateByTheSameTimeAtAnySpeedAndScale) {
  for (const double scale : {100.0, 400.0})
    for (const double vel_mm_s : {-1.0, 7.0, 20.0}) {
      StepMachine m(module("stepgen"), {1, 1, 1, 1});
      m.hal().set("stepgen.0.position-scale", scale);
      double command = 0.0;
      for (int i = 0; i < 2000; ++i) {
        const double before = command;
        m.servo(command += vel_mm_s * 1e-3);
        if (i < 1000) continue;
        EXPECT_LT(std::fabs(static_cast<double>(m.watch().count()) -
                            (command - 0.5e-3 * vel_mm_s) * scale),
                  1.0);
        EXPECT_NEAR(m.hal().get<double>("stepgen.0.position-fb"), before - 0.5e-3 * vel_mm_s,
                    1.0 / scale);
      }
    }
}

TEST(Stepgen, KeepsItsTimesWhenTheCommandJumps) {
  const Timing times{60'000, 50'000, 200'000, 100'000};
  StepMachine m(module("stepgen"), times);
  m.hal().set("stepgen.0.position-scale", 100.0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  for (int i = 0; i < 5000; ++i) m.servo(place(random));
  EXPECT_EQ(m.watch().wrong(), "");
  EXPECT_EQ(m.hal().get<std::int32_t>("stepgen.0.rawcounts"), m.watch().count());
}

TEST(Stepgen, ComesToRestOnTheCommandWithinItsLimits) {
  StepMachine m(module("stepgen"), {1, 1, 1, 1});
  auto& hal = m.hal();
  hal.set("stepgen.0.position-scale", 200.0);
  hal.set("stepgen.0.maxaccel", 500.0);
  hal.set("stepgen.0.maxvel", 20.0);
  double before_speed = 0.0;
  for (const double target : {3.0, -1.5, -1.49, 0.0}) {
    for (int i = 0; i < 1000; ++i) {
      m.servo(target);
      const double speed = hal.get<double>("stepgen.0.frequency") / 200.0;
      EXPECT_LE(std::fabs(speed), 20.0 + 1e-9);
      EXPECT_LE(std::fabs(speed - before_speed), 0.5 + 1e-9);
      before_speed = speed;
    }
    EXPECT_NEAR(hal.get<double>("stepgen.0.position-fb"), target, 1e-6);
    EXPECT_EQ(m.watch().count(), std::lround(target * 200.0));
  }
}

TEST(Stepgen, BoundsMaxvelByTheTimes) {
  StepMachine m(module("stepgen"), {100'000, 100'000, 1, 1});
  auto& hal = m.hal();
  hal.set("stepgen.0.maxvel", 1e6);
  m.servo(0.0);
  m.servo(0.0);
  EXPECT_DOUBLE_EQ(hal.get<double>("stepgen.0.maxvel"), 5000.0);
  hal.set("stepgen.0.maxvel", 0.0);
  m.servo(1e6);
  EXPECT_LE(hal.get<double>("stepgen.0.frequency"), 5000.0);
}

TEST(Stepgen, MakesNoStepsWhileDisabled) {
  StepMachine m(module("stepgen"), {1, 1, 1, 1});
  m.hal().set("stepgen.0.enable", false);
  for (int i = 0; i < 100; ++i) m.servo(100.0);
  EXPECT_EQ(m.watch().count(), 0);
}

TEST(Stepgen, ShowsItsTimesInWholeBasePeriodsAndItsLimitsAsTheyAre) {
  StepMachine m(module("stepgen"), {60'000, 0, 0, 0});
  auto& hal = m.hal();
  hal.set("stepgen.0.maxvel", -5.0);
  hal.set("stepgen.0.maxaccel", 1e12);
  m.servo(0.0);
  EXPECT_EQ(hal.get<std::uint32_t>("stepgen.0.steplen"), 100'000U);
  EXPECT_EQ(hal.get<std::uint32_t>("stepgen.0.stepspace"), 0U);
  EXPECT_EQ(hal.get<std::uint32_t>("stepgen.0.dirsetup"), 0U);
  EXPECT_EQ(hal.get<std::uint32_t>("stepgen.0.dirhold"), 50'000U);
  EXPECT_EQ(hal.get<double>("stepgen.0.maxvel"), 0.0);
  EXPECT_DOUBLE_EQ(hal.get<double>("stepgen.0.maxaccel"), 1e4 / 1e-3);
}

// Long after the last pulse nothing holds the place, but dir is as early as ever.
TEST(Stepgen, TurnsFromRestWithDirSetUpBeforeThePulse) {
  const Timing times{50'000, 50'000, 300'000, 50'000};
  StepMachine m(module("stepgen"), times);
  auto& hal = m.hal();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-6.0, 6.0);
  for (int i = 0; i < 300; ++i) {
    const double target = place(random);
    for (int k = 0; k < 30; ++k) m.servo(target);
    ASSERT_EQ(m.watch().wrong(), "") << target;
    ASSERT_EQ(m.watch().count(), std::lround(hal.get<double>("stepgen.0.position-fb"))) << target;
  }
}

TEST(Stepgen, DropsStepsThatAreLateWhenItIsDisabled) {
  StepMachine m(module("stepgen"), {1, 1, 2'000'000, 1});
  auto& hal = m.hal();
  hal.set("stepgen.0.maxaccel", 1e9);
  for (int i = 0; i < 20; ++i) m.servo(0.6);
  ASSERT_EQ(m.watch().count(), 1);
  // It goes back by two steps at once, for which dir is not yet set up.
  m.servo(-2.0);
  ASSERT_EQ(m.watch().count(), 1);
  hal.set("stepgen.0.enable", false);
  for (int i = 0; i < 20; ++i) m.servo(-2.0);
  EXPECT_EQ(m.watch().count(), 1);
  EXPECT_NEAR(hal.get<double>("stepgen.0.position-fb"), 0.5, 1e-6);
  EXPECT_EQ(m.watch().wrong(), "");
}

TEST(Stepgen, StandsStillOnACommandThatIsNoNumber) {
  StepMachine m(module("stepgen"), {1, 1, 1, 1});
  for (const double command : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (int i = 0; i < 10; ++i) m.servo(command);
    EXPECT_EQ(m.watch().count(), 0) << command;
  }
  for (int i = 0; i < 100; ++i) m.servo(3.0);
  EXPECT_EQ(m.watch().count(), 3);
}

TEST(Stepgen, ShowsThePatternsOfTheManual) {
  struct Type {
    int number;
    std::vector<std::string> states;  // phases A to E
  };
  const Type types[] = {
      {2, {"10", "11", "01", "00"}},
      {3, {"100", "010", "001"}},
      {4, {"100", "110", "010", "011", "001", "101"}},
      {5, {"1000", "0100", "0010", "0001"}},
      {6, {"1100", "0110", "0011", "1001"}},
      {7, {"1000", "1110", "0111", "0001"}},
      {8, {"1010", "0110", "0101", "1001"}},
      {9, {"1000", "1100", "0100", "0110", "0010", "0011", "0001", "1001"}},
      {10, {"1000", "1010", "1110", "0110", "0111", "0101", "0001", "1001"}},
      {11, {"10000", "01000", "00100", "00010", "00001"}},
      {12, {"11000", "01100", "00110", "00011", "10001"}},
      {13,
       {"10000", "11000", "01000", "01100", "00100", "00110", "00010", "00011", "00001", "10001"}},
      {14,
       {"11000", "11100", "01100", "01110", "00110", "00111", "00011", "10011", "10001", "11001"}},
      {15, {"10", "01", "11"}},
  };
  for (const Type& type : types) {
    SCOPED_TRACE(type.number);
    hal::TestBuilder hal;
    hal.set_arg("step_type", std::to_string(type.number));
    hal.set_arg("ctrl_type", "v");
    hal.set_arg("user_step_type", "0x1,0x2,0x3");
    ASSERT_TRUE(hal.create(module("stepgen"), "stepgen")) << hal.error();
    hal.set("stepgen.0.enable", true);
    const auto phases = [&] {
      std::string text;
      for (char c = 'A'; c <= 'E'; ++c) {
        const std::string pin = std::string("stepgen.0.phase-") + c;
        if (hal.has(pin)) text += hal.get<bool>(pin) ? '1' : '0';
      }
      return text;
    };
    for (const double speed : {200.0, -200.0}) {
      hal.set("stepgen.0.velocity-cmd", speed);
      for (int i = 0; i < 200; ++i) {
        const auto before = hal.get<std::int32_t>("stepgen.0.rawcounts");
        hal.run("stepgen.update-freq");
        hal.run("stepgen.make-pulses");
        const auto now = hal.get<std::int32_t>("stepgen.0.rawcounts");
        if (now == before) continue;
        ASSERT_EQ(now - before, speed > 0.0 ? 1 : -1);
        const auto length = static_cast<std::int32_t>(type.states.size());
        const std::int32_t place = (now % length + length) % length;
        ASSERT_EQ(phases(), type.states[static_cast<std::size_t>(place)]) << now;
      }
      EXPECT_GT(std::abs(hal.get<std::int32_t>("stepgen.0.rawcounts")), speed > 0.0 ? 35 : -1);
    }
  }
}

TEST(Stepgen, RefusesWhatItCannotDo) {
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"step_type", ""},
                                                        {"step_type", "16"},
                                                        {"step_type", "x"},
                                                        {"ctrl_type", "q"},
                                                        {"step_type", "15"}}) {
    hal::TestBuilder hal;
    hal.set_arg("step_type", "0");
    hal.set_arg(key, value);
    EXPECT_FALSE(hal.create(module("stepgen"), "stepgen")) << key << "=" << value;
  }
}

}  // namespace
}  // namespace kerf::components
