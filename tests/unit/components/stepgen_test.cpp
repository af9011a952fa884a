#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

constexpr std::int64_t kBaseNs = 50'000;
constexpr int kBasePerServo = 20;

struct Timing {
  std::int64_t length, space, setup, hold;
};

/// Watches step and dir call by call.
class PulseWatch {
 public:
  explicit PulseWatch(Timing t) : t_(t) {}
  void look(bool step, bool dir) {
    now_ns_ += kBaseNs;
    if (dir != dir_) {
      EXPECT_GE(now_ns_ - fell_ns_, t_.hold);
      EXPECT_FALSE(step_ || step) << "dir changes during a pulse";
      dir_ns_ = now_ns_;
    }
    if (step && !step_) {
      EXPECT_GE(now_ns_ - fell_ns_, t_.space);
      EXPECT_GE(now_ns_ - dir_ns_, t_.setup);
      rose_ns_ = now_ns_;
      count_ += dir ? -1 : 1;
    }
    if (!step && step_) {
      EXPECT_GE(now_ns_ - rose_ns_, t_.length);
      fell_ns_ = now_ns_;
    }
    step_ = step;
    dir_ = dir;
  }
  [[nodiscard]] std::int64_t count() const { return count_; }

 private:
  Timing t_;
  std::int64_t now_ns_{0}, rose_ns_{-1'000'000'000}, fell_ns_{-1'000'000'000},
      dir_ns_{-1'000'000'000};
  std::int64_t count_{0};
  bool step_{false}, dir_{false};
};

class StepMachine {
 public:
  explicit StepMachine(const Timing& t) : watch_(t) {
    hal_.set_arg("step_type", "0");
    EXPECT_TRUE(hal_.create(module("stepgen"), "stepgen")) << hal_.error();
    hal_.set("stepgen.0.steplen", t.length);
    hal_.set("stepgen.0.stepspace", t.space);
    hal_.set("stepgen.0.dirsetup", t.setup);
    hal_.set("stepgen.0.dirhold", t.hold);
    hal_.set("stepgen.0.enable", true);
  }
  hal::TestBuilder& hal() { return hal_; }
  PulseWatch& watch() { return watch_; }
  /// One servo period with this command.
  void servo(double command) {
    hal_.set("stepgen.0.position-cmd", command);
    hal_.run("stepgen.capture-position", kBaseNs * kBasePerServo);
    hal_.run("stepgen.update-freq", kBaseNs * kBasePerServo);
    for (int i = 0; i < kBasePerServo; ++i) {
      hal_.run("stepgen.make-pulses", kBaseNs);
      watch_.look(hal_.get<bool>("stepgen.0.step"), hal_.get<bool>("stepgen.0.dir"));
    }
  }

 private:
  hal::TestBuilder hal_;
  PulseWatch watch_;
};

TEST(Stepgen, FollowsAMovingCommandWithinAStepAndKeepsItsTimes) {
  const Timing t{60'000, 50'000, 200'000, 100'000};
  StepMachine m(t);
  auto& hal = m.hal();
  hal.set("stepgen.0.position-scale", 100.0);
  hal.set("stepgen.0.maxaccel", 2000.0);
  // Fifty thousand servo periods are a million base periods.
  double worst = 0.0;
  double command = 0.0;
  for (int i = 0; i < 50'000; ++i) {
    const double s = i * 1e-3;
    const double before = command;
    command = 5.0 * std::sin(2.0 * s) + 2.0 * std::sin(0.37 * s);
    m.servo(command);
    ASSERT_FALSE(testing::Test::HasFailure()) << "servo period " << i;
    // After the period the motor is where the command was at its start and its speed has brought it.
    const double expected = (2.0 * command - before) * 100.0;
    if (i > 50)
      worst = std::max(worst, std::fabs(static_cast<double>(m.watch().count()) - expected));
    ASSERT_EQ(hal.get<std::int32_t>("stepgen.0.rawcounts"), m.watch().count());
  }
  EXPECT_LE(worst, 1.2) << "half a step of rounding, and what the times of a turn hold back";
}

TEST(Stepgen, ComesToRestOnTheCommandWithinItsLimits) {
  StepMachine m({1, 1, 1, 1});
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
  StepMachine m({100'000, 100'000, 1, 1});
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
  StepMachine m({1, 1, 1, 1});
  m.hal().set("stepgen.0.enable", false);
  for (int i = 0; i < 100; ++i) m.servo(100.0);
  EXPECT_EQ(m.watch().count(), 0);
}

TEST(Stepgen, ShowsThePatternsOfTheManual) {
  struct Type {
    int number;
    std::vector<std::string> states;  // phases A to E
  };
  const Type kTypes[] = {
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
  for (const Type& type : kTypes) {
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
