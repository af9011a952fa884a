// plasmac: what must hold whatever comes in. What LinuxCNC does cycle by cycle is in tests/hal/components/plasmac*.rows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>

#include "hal/core/test_builder.hpp"
#include "unit/components/modules.hpp"

namespace kerf::components {
namespace {

/// A table with material at z 20 under plasmac; z follows its offset at once.
struct Table {
  Table() {
    EXPECT_TRUE(hal.create(module("plasmac"), "plasmac"));
    for (const auto& [pin, value] : {std::pair{"units-per-mm", 1.0}, {"axis-z-max-limit", 95.0},
                                     {"axis-x-max-limit", 1000.0},   {"axis-y-max-limit", 1000.0},
                                     {"arc-voltage-scale", 1.0},     {"arc-ok-high", 250.0},
                                     {"arc-ok-low", 60.0},           {"arc-fail-delay", 0.1005},
                                     {"restart-delay", 0.0505},      {"cut-height", 1.5},
                                     {"pierce-height", 4.0},         {"pierce-delay", 0.0205},
                                     {"cut-volts", 100.0},           {"cut-feed-rate", 3000.0},
                                     {"setup-feed-rate", 12000.0},   {"probe-feed-rate", 6000.0},
                                     {"probe-start-height", 23.0},   {"float-switch-travel", 0.5},
                                     {"safe-height", 3.0},           {"thc-feed-rate", 6000.0},
                                     {"thc-threshold", 0.5},         {"pid-p-gain", 10.0},
                                     {"feed-override", 1.0}})
      set(pin, value);
    set("arc-max-starts", 3);
    set("probe-final-speed", 10);
    for (const char* pin : {"machine-is-on", "homed", "torch-enable", "thc-enable"}) set(pin, 1);
    set("program-is-running", 1);
  }
  template <class T>
  void set(const std::string& pin, T value) {
    hal.set("plasmac." + pin, value);
  }
  [[nodiscard]] bool bit(const std::string& pin) const { return hal.get<bool>("plasmac." + pin); }
  [[nodiscard]] std::int32_t s32(const std::string& pin) const {
    return hal.get<std::int32_t>("plasmac." + pin);
  }
  [[nodiscard]] double real(const std::string& pin) const {
    return hal.get<double>("plasmac." + pin);
  }
  void cycle() {
    hal.run("plasmac");
    const double offset = s32("z-offset-counts") * real("offset-scale");
    z = 30.0 + offset;
    set("z-offset-current", offset);
    set("axis-z-position", z);
    if (follows_switch) set("float-switch", z < 20.0 ? 1 : 0);
    if (has_arc) set("arc-voltage-in", bit("torch-on") ? 100.0 + 10.0 * (z - 22.0) : 0.0);
  }
  /// Cycles until state-out is `state`, at most 5 s.
  bool reach(std::int32_t state) {
    for (int i = 0; i < 5000 && s32("state-out") != state; ++i) cycle();
    return s32("state-out") == state;
  }

  hal::TestBuilder hal;
  double z{30.0};
  bool follows_switch{true}, has_arc{true};
};

TEST(PlasmacTest, TheVoltageKeepsTheHeight) {
  Table table;
  table.set("cutting-start", 1);
  ASSERT_TRUE(table.reach(11));
  EXPECT_NEAR(table.real("z-height"), 1.5, 0.02);
  table.set("current-velocity", 50.0);
  table.set("cut-volts", 115.0);
  for (int i = 0; i < 3000; ++i) table.cycle();
  EXPECT_TRUE(table.bit("thc-active"));
  EXPECT_NEAR(table.z, 23.5, 0.06) << "115 V are at z 23.5";
  table.set("cutting-start", 0);
  table.cycle();
  EXPECT_FALSE(table.bit("torch-on"));
  ASSERT_TRUE(table.reach(0));
  EXPECT_NEAR(table.z, 20.5 + 3.0, 0.02);
}

TEST(PlasmacTest, NoArcPausesAndStaysOff) {
  Table table;
  table.has_arc = false;
  table.set("cutting-start", 1);
  ASSERT_TRUE(table.reach(7));
  for (int i = 0; i < 2000; ++i) table.cycle();
  EXPECT_EQ(table.s32("pierce-count"), 3);
  EXPECT_TRUE(table.bit("program-pause"));
  EXPECT_FALSE(table.bit("torch-on"));
}

TEST(PlasmacTest, NoMaterialStopsAboveTheLimit) {
  Table table;
  table.follows_switch = false;
  table.set("cutting-start", 1);
  double lowest = table.z;
  for (int i = 0; i < 3000; ++i) {
    table.cycle();
    lowest = std::min(lowest, table.z);
  }
  EXPECT_GE(lowest, 0.0);
  EXPECT_EQ(table.s32("pierce-count"), 0);
  EXPECT_TRUE(table.bit("program-pause"));
}

TEST(PlasmacTest, APausedProgramDoesNotRelightTheTorch) {
  Table table;
  table.set("cutting-start", 1);
  ASSERT_TRUE(table.reach(11));
  table.set("program-is-running", 0);
  table.set("program-is-paused", 1);
  table.cycle();
  EXPECT_FALSE(table.bit("torch-on"));
  for (int i = 0; i < 2000; ++i) {
    table.cycle();
    ASSERT_FALSE(table.bit("torch-on"));
  }
  EXPECT_NEAR(table.z, 30.0, 1e-9) << "all the way up";
}

TEST(PlasmacTest, ARecoveryTakenBackLightsNoTorchBeforeThePierce) {
  Table table;
  table.set("cutting-start", 1);
  ASSERT_TRUE(table.reach(11));
  table.set("program-is-running", 0);
  table.set("program-is-paused", 1);
  ASSERT_TRUE(table.reach(0));
  table.set("x-offset", 1000);
  table.set("cut-recovery", 1);
  ASSERT_TRUE(table.reach(25));
  table.set("program-is-paused", 0);
  table.set("program-is-running", 1);
  ASSERT_TRUE(table.reach(8));
  ASSERT_TRUE(table.bit("torch-on"));
  table.set("cut-recovery", 0);
  ASSERT_TRUE(table.reach(0)) << "a new cut, as LinuxCNC";
  for (int i = 0; i < 5000 && table.s32("state-out") < 7; ++i) {
    ASSERT_FALSE(table.bit("torch-on")) << "in state " << table.s32("state-out");
    table.cycle();
  }
  EXPECT_TRUE(table.reach(11));
}

TEST(PlasmacTest, TheVoltageOfACutThatWasSwitchedOffIsForgotten) {
  Table table;
  table.set("cutting-start", 1);
  ASSERT_TRUE(table.reach(11));
  table.set("current-velocity", 50.0);
  for (int i = 0; i < 100; ++i) table.cycle();
  ASSERT_NE(table.real("target-volts"), 0.0);
  table.set("machine-is-on", 0);
  table.cycle();
  EXPECT_FALSE(table.bit("torch-on"));
  table.set("machine-is-on", 1);
  table.set("current-velocity", 0.0);
  ASSERT_TRUE(table.reach(11));
  EXPECT_EQ(table.real("target-volts"), 0.0);
}

TEST(PlasmacTest, ThePulseDoesNotRepeatWhileItIsAskedFor) {
  Table table;
  table.set("program-is-running", 0);
  table.set("program-is-idle", 1);
  table.set("torch-pulse-time", 0.0505);
  table.set("torch-pulse-start", 1);
  int on = 0;
  for (int i = 0; i < 1000; ++i) {
    table.cycle();
    on += table.bit("torch-on") ? 1 : 0;
  }
  EXPECT_NEAR(on, 52, 2);
}

TEST(PlasmacTest, WhateverComesInTheTorchObeys) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Table table;
    std::mt19937 random(seed);
    const auto often = [&](unsigned n) { return random() % n == 0; };
    table.set("cutting-start", 1);
    for (int i = 0; i < 3000; ++i) {
      for (const char* pin :
           {"machine-is-on", "torch-off", "breakaway", "program-is-paused", "program-is-idle",
            "cutting-start", "spotting-start", "cut-recovery", "consumable-change", "mesh-enable",
            "ignore-arc-ok-0", "torch-pulse-start", "probe-test", "ohmic-probe-enable",
            "ohmic-probe", "scribe-start", "thc-disable"}) {
        if (often(400)) table.set(pin, 1 - (table.bit(pin) ? 1 : 0));
      }
      if (often(200)) table.set("paused-motion-speed", often(2) ? 0.5 : 0.0);
      if (often(200)) table.set("current-velocity", often(2) ? 50.0 : 0.0);
      if (often(300)) table.set("height-override", static_cast<double>(random() % 5) - 2.0);
      const bool was_paused = table.bit("program-is-paused");
      table.cycle();
      const std::int32_t state = table.s32("state-out");
      const bool on = table.bit("torch-on");
      ASSERT_GE(state, 0);
      ASSERT_LE(state, 26);
      if (!table.bit("machine-is-on") || table.bit("torch-off")) {
        ASSERT_FALSE(on) << "seed " << seed << " cycle " << i << " state " << state;
      }
      if (state <= 5 || (state >= 14 && state <= 17) || (state >= 19 && state <= 25)) {
        ASSERT_FALSE(on) << "seed " << seed << " cycle " << i << " state " << state;
      }
      if (was_paused && state != 19) {
        const bool recovers = table.bit("cut-recovering");
        ASSERT_TRUE(!on || recovers || state == 18)
            << "seed " << seed << " cycle " << i << " state " << state;
      }
      ASSERT_LE(std::fabs(table.real("adaptive-feed")), 1.0);
      ASSERT_TRUE(std::isfinite(table.real("z-height")));
    }
  }
}

}  // namespace
}  // namespace kerf::components
