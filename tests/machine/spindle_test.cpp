// Spindles of a running machine: one state each, true at all times (WANTS 21 and 51): modes, limits, stop and start by hand, waits.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

std::string pin(int n, const std::string& name) {
  return "spindle." + std::to_string(n) + "." + name;
}

std::unique_ptr<Machine> homed(const MachineOptions& options = {}) {
  auto m = Machine::start(options);
  if (!m->ready() || !m->power_on_and_home()) {
    ADD_FAILURE() << m->errors();
    return nullptr;
  }
  return m;
}

std::unique_ptr<Machine> lathe() {
  MachineOptions options;
  options.ini = KERF_SOURCE_DIR "/configs/sim/lathe/lathe.ini";
  return homed(options);
}

/// rpm for a surface speed in m/min at a radius.
double rpm_for(double m_min, double radius_mm) {
  return m_min * 1000 / (2 * std::numbers::pi * radius_mm);
}

TEST(Spindles, EightWithPinsAndLimitsOfTheirOwn) {
  MachineOptions options;
  options.replace = {{"SPINDLES = 1", "SPINDLES = 8"}};
  for (int n = 1; n < 8; ++n)
    options.append +=
        "\n[SPINDLE_" + std::to_string(n) +
        "]\nMAX_FORWARD_VELOCITY = " + std::to_string(1000 * n) +
        "\nMIN_FORWARD_VELOCITY = 200\nMAX_REVERSE_VELOCITY = " + std::to_string(100 * n) +
        "\nMIN_REVERSE_VELOCITY = 50\n";
  auto m = homed(options);
  ASSERT_NE(m, nullptr);
  for (int n = 0; n < 8; ++n) {
    for (const char* name : {"on", "forward", "reverse", "brake", "orient", "locked"})
      EXPECT_EQ(m->pin_kind(pin(n, name)), "bit OUT") << n << name;
    for (const char* name : {"at-speed", "inhibit", "is-oriented", "amp-fault-in"})
      EXPECT_EQ(m->pin_kind(pin(n, name)), "bit IN") << n << name;
    EXPECT_EQ(m->pin_kind(pin(n, "index-enable")), "bit I/O");
  }
  EXPECT_EQ(m->pin_kind("spindle.8.on"), "");
  for (int n = 1; n < 8; ++n) {
    const std::string words = " $" + std::to_string(n);
    ASSERT_TRUE(m->mdi("S99999 M3" + words));
    m->run_for(0.05);
    EXPECT_EQ(m->get(pin(n, "speed-out")), 1000 * n);
    ASSERT_TRUE(m->mdi("S1 M3" + words));
    m->run_for(0.05);
    EXPECT_EQ(m->get(pin(n, "speed-out")), 200);
    ASSERT_TRUE(m->mdi("S99999 M4" + words));
    m->run_for(0.05);
    EXPECT_EQ(m->get(pin(n, "speed-out")), -100 * n);
    EXPECT_EQ(m->get(pin(n, "speed-out-abs")), 100 * n);
    EXPECT_NEAR(m->get(pin(n, "speed-out-rps")), -100.0 * n / 60, 1e-9);
    EXPECT_TRUE(m->bit(pin(n, "reverse")) && m->bit(pin(n, "on")));
    EXPECT_FALSE(m->bit(pin(n, "forward")) || m->bit(pin(n, "brake")));
  }
  ASSERT_TRUE(m->mdi("M5 $3"));
  m->run_for(0.05);
  EXPECT_FALSE(m->bit("spindle.3.on"));
  EXPECT_TRUE(m->bit("spindle.3.brake"));
  EXPECT_TRUE(m->bit("spindle.4.on"));
}

TEST(Spindles, SpeedAloneStartsNothing) {
  auto m = homed();
  ASSERT_NE(m, nullptr);
  ASSERT_TRUE(m->mdi("S4000"));
  m->run_for(0.1);
  EXPECT_FALSE(m->bit("spindle.0.on"));
  EXPECT_EQ(m->get("spindle.0.speed-out"), 0);
  EXPECT_FALSE(m->motion().spindle[0].on);
  // Not by a feed move, nor by a second S.
  ASSERT_TRUE(m->mdi("S5000"));
  ASSERT_TRUE(m->mdi("G1 X1 F1000"));
  EXPECT_FALSE(m->bit("spindle.0.on"));
}

TEST(Spindles, AtSpeedZeroNoDriveIsToldToTurn) {
  auto m = homed();
  ASSERT_NE(m, nullptr);
  const auto drive = [&] {
    return m->bit("spindle.0.on") || m->bit("spindle.0.forward") || m->bit("spindle.0.reverse");
  };
  ASSERT_TRUE(m->mdi("S0 M3"));
  m->run_for(0.01);
  EXPECT_FALSE(drive());
  EXPECT_FALSE(m->motion().spindle[0].on);
  EXPECT_FALSE(m->bit("spindle.0.brake"));
  // M3 stands: the speed is all that was missing.
  ASSERT_TRUE(m->mdi("S1000"));
  m->run_for(0.01);
  EXPECT_TRUE(m->bit("spindle.0.on") && m->bit("spindle.0.forward"));
}

TEST(Spindles, InhibitKeepsTheDriveStill) {
  auto m = homed();
  ASSERT_NE(m, nullptr);
  ASSERT_TRUE(m->mdi("S1000 M3"));
  m->run_for(0.1);
  ASSERT_TRUE(m->hal("setp spindle.0.inhibit 1"));
  m->run_for(0.01);
  EXPECT_EQ(m->get("spindle.0.speed-out"), 0);
  EXPECT_FALSE(m->bit("spindle.0.on") || m->bit("spindle.0.forward"));
  EXPECT_FALSE(m->bit("spindle.0.brake"));
  ASSERT_TRUE(m->hal("setp spindle.0.inhibit 0"));
  m->run_for(0.01);
  EXPECT_TRUE(m->bit("spindle.0.on") && m->bit("spindle.0.forward"));
  EXPECT_EQ(m->get("spindle.0.speed-out"), 1000);
}

TEST(Spindles, StopAndStartByHandKeepTheModeAndTheSpeed) {
  auto m = lathe();
  ASSERT_NE(m, nullptr);
  ASSERT_TRUE(m->mdi("G7 G0 X60"));
  ASSERT_TRUE(m->mdi("G96 D2500 S170 M3"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), rpm_for(170, 30), 0.01);
  ASSERT_TRUE(m->does({"spindle", "off"}));
  m->run_for(0.1);
  EXPECT_FALSE(m->bit("spindle.0.on"));
  ASSERT_TRUE(m->does({"spindle", "forward"}));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), rpm_for(170, 30), 0.01) << "not 170 rpm";
  // Rpm by hand are rpm.
  ASSERT_TRUE(m->does({"spindle", "reverse", "400"}));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), -400, 1e-6);
  ASSERT_TRUE(m->mdi("G0 X40"));
  EXPECT_NEAR(m->get("spindle.0.speed-out"), -400, 1e-6);
}

TEST(Spindles, AProgramInG96LeavesNothingBehindForTheNext) {
  auto m = lathe();
  ASSERT_NE(m, nullptr);
  const std::string program = "G21 G7 G90 G0 X50\nG96 D2000 S120 M3\nG1 X40 F200\nM2\n";
  for (int turn = 0; turn < 2; ++turn) {
    const auto reply = m->run_text(program);
    EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
    m->run_for(0.1);
    EXPECT_FALSE(m->bit("spindle.0.on"));
  }
  const auto reply = m->run_text("G97 S300 M3\nG4 P0.1\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text;
  ASSERT_TRUE(m->mdi("M3"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 300, 1e-6);
}

TEST(Spindles, ConstantSurfaceSpeedCountsFromTheAxisOfTheWork) {
  // X of G96 is the place of the tool's tip over the work's axis: G54 and the tool's offset are in it, and D bounds it.
  auto m = lathe();
  ASSERT_NE(m, nullptr);
  ASSERT_TRUE(m->mdi("G8 G10 L2 P1 X12"));
  ASSERT_TRUE(m->mdi("G54 G0 X20"));
  ASSERT_TRUE(m->mdi("G96 D1500 S100 M3"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), rpm_for(100, 20), 0.01);
  ASSERT_TRUE(m->mdi("G0 X5"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 1500, 1e-6);
}

TEST(Spindles, TheWaitForTheSpeedSaysSoAtOnceAndEndsWithThePin) {
  MachineOptions options;
  options.hal = {"unlinkp spindle.0.at-speed", "setp spindle.0.at-speed 0"};
  auto m = homed(options);
  ASSERT_NE(m, nullptr);
  const auto id = m->start_program(m->write_program("S1000 M3\nG0 X5\nG1 X10 F1000\nM2\n"));
  ASSERT_NE(id, 0U);
  m->run_for(3.0);
  EXPECT_EQ(m->task().waiting_for.pin.view(), "spindle.0.at-speed");
  EXPECT_EQ(m->task().waiting_for.object.view(), "the spindle to be at speed");
  EXPECT_GT(m->task().waiting_for.since_ns, 0);
  EXPECT_NEAR(m->joint(0), 5, 1e-9) << "the traverse does not wait";
  ASSERT_TRUE(m->hal("setp spindle.0.at-speed 1"));
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(id).state); }, 30));
  EXPECT_EQ(m->outcome(id).state, task::CommandState::done);
  EXPECT_EQ(m->task().waiting_for.pin.view(), "");
  // With the spindle off nothing waits.
  ASSERT_TRUE(m->hal("setp spindle.0.at-speed 0"));
  EXPECT_TRUE(m->mdi("G1 X12 F1000", 5));
  EXPECT_TRUE(m->mdi("S0 M3", 5));
  EXPECT_TRUE(m->mdi("G1 X14 F1000", 5)) << "at S0 there is no speed to wait for";
}

}  // namespace
}  // namespace kerf::harness
