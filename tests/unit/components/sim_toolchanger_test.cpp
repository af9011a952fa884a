#include <gtest/gtest.h>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

constexpr std::int64_t kMs = 1'000'000;

class ToolchangerTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(hal.create(module("sim_toolchanger"), "tc")); }
  bool bit(const char* name) { return hal.get<bool>(std::string("tc.") + name); }
  std::int32_t number(const char* name) { return hal.get<std::int32_t>(std::string("tc.") + name); }
  void set(const char* name, bool value) { hal.set(std::string("tc.") + name, value); }
  /// Milliseconds until `name` is `value`.
  int wait(const char* name, bool value = true, int most = 20000) {
    int cycles = 0;
    while (bit(name) != value && cycles < most) {
      hal.run("tc", kMs);
      ++cycles;
    }
    return cycles;
  }
  void prepare(std::int32_t pocket) {
    hal.set("tc.prep-pocket", pocket);
    set("prepare", true);
    wait("prepared");
  }
  hal::TestBuilder hal;
};

TEST_F(ToolchangerTest, TurnsTheShortWayAndSwaps) {
  hal.set("tc.prep-pocket", 4);
  set("prepare", true);
  hal.run("tc", kMs, 5);
  EXPECT_TRUE(bit("motor-fwd"));
  EXPECT_EQ(number("pocket"), 0);
  EXPECT_NEAR(wait("prepared"), 3 * 250, 8);
  EXPECT_EQ(number("pocket"), 4);
  EXPECT_FALSE(bit("motor-fwd"));
  set("prepare", false);
  set("change", true);
  hal.run("tc", kMs);
  EXPECT_TRUE(bit("busy"));
  hal.run("tc", kMs, 500);
  EXPECT_FALSE(bit("arm-home"));
  EXPECT_FALSE(bit("clamped"));
  EXPECT_TRUE(bit("arm-out"));
  EXPECT_NEAR(wait("changed"), 400 + 200 + 500 + 200 + 400 - 500, 8);
  EXPECT_TRUE(bit("arm-home"));
  EXPECT_TRUE(bit("clamped"));
  EXPECT_EQ(number("spindle-pocket"), 4);
  set("change", false);
  EXPECT_EQ(wait("changed", false), 1);
  // 15 of 16 pockets is five back.
  hal.set("tc.prep-pocket", 15);
  set("prepare", true);
  hal.run("tc", kMs, 5);
  EXPECT_TRUE(bit("motor-rev"));
  EXPECT_NEAR(wait("prepared"), 5 * 250, 8);
}

TEST_F(ToolchangerTest, FailsAtEachStepAndIsResetToIdle) {
  hal.set("tc.fault-timeout", 1.0);
  for (const std::int32_t step : {1, 2, 3, 4, 5, 6, 7, 8}) {
    hal.set("tc.fault-step", step);
    const std::int32_t tool = number("spindle-pocket");
    hal.set("tc.prep-pocket", number("pocket") + 2);
    set("prepare", true);
    for (int i = 0; i < 10000 && !bit("fault"); ++i) {
      if (bit("prepared")) set("change", true);
      ASSERT_FALSE(bit("changed")) << step;
      hal.run("tc", kMs);
    }
    ASSERT_TRUE(bit("fault")) << step;
    EXPECT_EQ(number("reason"), step);
    EXPECT_EQ(number("state"), 9);
    EXPECT_FALSE(bit("prepared"));
    // A tool that was swapped before the fault is in the spindle.
    EXPECT_EQ(number("spindle-pocket") != tool, step > 5) << step;
    set("prepare", false);
    set("change", false);
    hal.set("tc.fault-step", 0);
    hal.run("tc", kMs, 5000);
    EXPECT_TRUE(bit("fault")) << "it takes a reset";
    set("reset", true);
    hal.run("tc", kMs);
    set("reset", false);
    EXPECT_LT(wait("busy", false), 1000) << step;
    EXPECT_EQ(number("state"), 0) << step;
    EXPECT_TRUE(bit("arm-home")) << step;
    EXPECT_TRUE(bit("clamped")) << step;
    EXPECT_FALSE(bit("fault")) << step;
  }
}

TEST_F(ToolchangerTest, WithoutReportsItJustNeverAnswers) {
  hal.set("tc.fault-step", 5);
  set("report-faults", false);
  prepare(2);
  set("change", true);
  EXPECT_EQ(wait("changed", true, 60000), 60000);
  EXPECT_FALSE(bit("fault"));
  EXPECT_EQ(number("state"), 5);
  hal.set("tc.fault-step", 0);
  EXPECT_LT(wait("changed"), 1000);
}

TEST_F(ToolchangerTest, AChangeCalledOffIsBroughtToItsEndWithoutAnAnswer) {
  prepare(3);
  set("prepare", false);
  set("change", true);
  hal.run("tc", kMs, 700);
  set("change", false);
  for (int i = 0; i < 5000 && bit("busy"); ++i) {
    hal.run("tc", kMs);
    ASSERT_FALSE(bit("changed"));
  }
  EXPECT_EQ(number("state"), 0);
  EXPECT_TRUE(bit("arm-home"));
  EXPECT_EQ(number("spindle-pocket"), 3);
}

TEST_F(ToolchangerTest, StandsWithoutPowerOrPermission) {
  prepare(3);
  set("permit", false);
  set("change", true);
  hal.run("tc", kMs, 3000);
  EXPECT_TRUE(bit("arm-home"));
  EXPECT_EQ(number("state"), 3);
  set("permit", true);
  hal.run("tc", kMs, 100);
  EXPECT_FALSE(bit("arm-home"));
  // Once on its way the arm does not stop for it.
  set("permit", false);
  set("enable", false);
  hal.run("tc", kMs, 3000);
  EXPECT_EQ(number("state"), 3);
  set("enable", true);
  EXPECT_LT(wait("changed"), 1700);
}

TEST_F(ToolchangerTest, AnotherOrderWhileItTurnsCounts) {
  hal.set("tc.prep-pocket", 5);
  set("prepare", true);
  hal.run("tc", kMs, 300);
  set("prepare", false);
  hal.run("tc", kMs, 10);
  hal.set("tc.prep-pocket", 2);
  set("prepare", true);
  wait("prepared");
  EXPECT_EQ(number("pocket"), 2);
  hal.set("tc.prep-pocket", 3);
  hal.run("tc", kMs);
  EXPECT_FALSE(bit("prepared")) << "not of this pocket";
  wait("prepared");
  EXPECT_EQ(number("pocket"), 3);
}

}  // namespace
}  // namespace kerf::components
