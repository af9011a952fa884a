// The smooth path on a whole machine: corners that are rounded, steps that end where blocks end, outputs in their places.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "harness/joint_watch.hpp"
#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

std::unique_ptr<Machine> homed_machine() {
  auto m = Machine::start();
  EXPECT_TRUE(m->ready()) << m->errors();
  EXPECT_TRUE(m->power_on_and_home()) << m->errors();
  return m;
}

std::string zigzag(const std::string& mode) {
  std::string text = "G21 G90 " + mode + "\nG0 X0 Y0\nF1200\n";
  for (int i = 1; i <= 10; ++i)
    text += "G1 X" + std::to_string(4 * i) + " Y" + (i % 2 != 0 ? "3" : "0") + "\n";
  return text + "M2\n";
}

TEST(SmoothPath, CornersArePassedAtSpeedWithinTheTolerance) {
  double seconds[2]{}, slowest[2]{1e9, 1e9}, nearest[2]{1e9, 1e9};
  for (int k = 0; k < 2; ++k) {
    auto m = homed_machine();
    const auto path = m->write_program(zigzag(k == 0 ? "G64 P0.05" : "G61.1"));
    const auto run = m->start_program(path);
    const auto begin = m->now();
    m->on_cycle([&](const motion::MotionStatus& s) {
      // Between the first corner and the last one.
      if (s.pos_cmd.x > 3 && s.pos_cmd.x < 37) slowest[k] = std::min(slowest[k], s.vel_mm_s);
      nearest[k] = std::min(nearest[k], std::hypot(s.pos_cmd.x - 20, s.pos_cmd.y - 3));
    });
    EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
    m->on_cycle({});
    EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->outcome(run).text;
    seconds[k] = static_cast<double>(m->now() - begin) * 1e-9;
    EXPECT_NEAR(m->joint(0), 40, 1e-9);
  }
  EXPECT_GT(slowest[0], 2.0) << "no stop at a corner";
  EXPECT_LT(slowest[1], 1.0) << "G61.1 stops at each";
  EXPECT_LE(nearest[0], 0.05 + 1e-6) << "from the programmed corner";
  EXPECT_LT(nearest[1], 1e-9);
  EXPECT_LT(seconds[0], seconds[1]);
}

// What a new feed means for a way of seconds is planned a moment after the first metres of it, with nothing else to wake the planner.
TEST(SmoothPath, AFeedThatChangesOnceIsKeptToTheEndOfWhatWasPlanned) {
  for (const bool jerk : {false, true}) {
    MachineOptions options;
    if (jerk) (void)limit_jerk(options, 3, 0.02);
    auto m = Machine::start(options);
    ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
    std::string text = "G21 G90 G64 P0.01 Q0\nG0 X0 Y0\nF3000\n";
    for (int i = 1; i <= 600; ++i)
      text += "G1 X" + std::to_string(0.4 * i) + " Y" + std::to_string(0.0004 * i * i) + "\n";
    const auto run = m->start_program(m->write_program(text + "M2\n"));
    ASSERT_TRUE(m->run_until([&] { return m->motion().pos_cmd.x > 20; }));
    ASSERT_TRUE(m->does({"feed-override", "0.5"}));
    m->run_for(0.2);
    double slowest = 1e9, fastest = 0;
    m->on_cycle([&](const motion::MotionStatus& s) {
      if (s.pos_cmd.x > 238) return;
      slowest = std::min(slowest, s.vel_mm_s);
      fastest = std::max(fastest, s.vel_mm_s);
    });
    EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
    EXPECT_NEAR(slowest, 25, 0.5) << jerk;
    EXPECT_NEAR(fastest, 25, 0.5) << jerk;
    m->on_cycle({});
  }
}

// Task is not woken for each of thousands of short lines a second; what it shows is 10 ms old at most, and exact at the end.
TEST(SmoothPath, TheLineShownIsAtMostTenMillisecondsOldWhileMuchIsQueued) {
  auto m = homed_machine();
  std::string text = "G21 G90 G64 P0.01 Q0\nF3000\n";
  constexpr int kLines = 12000;
  for (int i = 1; i <= kLines; ++i) {
    char line[40];
    std::snprintf(line, sizeof line, "G1 X%.3f Y%.4f\n", 0.02 * i, 10 + 5 * std::sin(0.002 * i));
    text += line;
  }
  const auto run = m->start_program(m->write_program(text + "M2\n"));
  std::vector<int> executed;  // of the last cycles
  int oldest_cycles = 0;
  bool ended = false;
  m->on_cycle([&](const motion::MotionStatus& s) {
    executed.push_back(s.current.line);
    const int shown = m->task().current_line;
    if (ended || shown == 0 || s.current.line == 0) return;
    int age = 0;
    while (age + 1 < static_cast<int>(executed.size()) &&
           executed[executed.size() - 1 - static_cast<std::size_t>(age)] > shown)
      ++age;
    oldest_cycles = std::max(oldest_cycles, age);
    ended = s.current.line >= kLines;
  });
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
  m->on_cycle({});
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->outcome(run).text;
  EXPECT_GT(executed.size(), 1000U);
  std::printf("result: the line shown is at most %d cycles old\n", oldest_cycles);
  EXPECT_LE(oldest_cycles, 12);
}

TEST(Probe, WhatIsSoAlreadyIsAnErrorOrAResultWithoutAMove) {
  auto m = homed_machine();
  const auto result = [&](const std::string& probe, double x, double success) {
    ASSERT_TRUE(m->mdi("G90 G94 G0 X5 Y0"));
    ASSERT_TRUE(m->mdi(probe)) << probe << m->errors();
    EXPECT_NEAR(m->joint(0), x, 1e-9) << probe;
    ASSERT_TRUE(m->mdi("G94 G0 Y[10 + #5070] X#5061"));
    EXPECT_NEAR(m->joint(1), 10 + success, 1e-9) << probe;
    EXPECT_NEAR(m->joint(0), x, 1e-9) << "the place of the probe is the programmed or met one";
  };
  for (const char* feed : {"G94 F100 ", "G93 F100 "}) {
    // To where it stands.
    result(std::string(feed) + "G38.3 X5", 5, 0);
    result(std::string(feed) + "G38.5 X5", 5, 0);
    // Nothing met on the way.
    result(std::string(feed) + "G38.3 X7", 7, 0);
    // Open already, which is what G38.5 goes for.
    result(std::string(feed) + "G38.5 X7", 5, 1);
  }
  EXPECT_FALSE(m->mdi("G94 F100 G38.4 X7"));
  EXPECT_NE(m->errors().find("Probe is already clear when starting G38.4 or G38.5 move"),
            std::string::npos)
      << m->errors();
  EXPECT_FALSE(m->mdi("F100 G38.2 X5"));
  // The program goes on from where it stands, not from where the probe would have ended.
  const auto program = "G90 G0 X5 Y0\nF600 G38.5 X9\nG91 G1 X1\nG90 G38.5 Y9\nG1 Y2\nM2\n";
  EXPECT_EQ(m->run_text(program).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 6, 1e-9);
  EXPECT_NEAR(m->joint(1), 2, 1e-9);
}

/// Where joints bend along it a probe move is driven in several stretches. It is one move all the same: what it goes for is asked for at its start, an
/// error of its end comes at its end, and behind the contact nothing of it is left.
TEST(Probe, AMoveInSeveralStretchesIsOne) {
  for (const char* jerk : {"", "MAX_LINEAR_JERK = 20000\n"}) {
    MachineOptions o;
    o.ini = std::string(KERF_SOURCE_DIR) + "/configs/sim/xyzac-trt/xyzac-trt.ini";
    o.replace = {{"[TRAJ]\n", std::string("[TRAJ]\n") + jerk}};
    o.hal = {"loadrt comp names=touch",
             "addf touch servo-thread",
             "setp touch.in0 1000",
             "setp touch.hyst 0.0001",
             "net turned joint.4.pos-cmd touch.in1",
             "net touched touch.out motion.probe-input"};
    auto m = Machine::start(o);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    const auto start = [&](double contact) {
      ASSERT_TRUE(m->hal("setp touch.in0 1000"));
      ASSERT_TRUE(m->mdi("G21 G90 G94 G64 P0.05 G0 X30 Y5 Z-40 A-20 C0")) << m->errors();
      ASSERT_TRUE(m->hal("setp touch.in0 " + std::to_string(contact)));
      for (int i = 0; i < 3; ++i) m->cycle();
    };
    const auto ends_at = [&](double c, double success) {
      EXPECT_NEAR(m->motion().pos_cmd.c, c, 1e-9);
      // The parameters, by where they send the machine.
      ASSERT_TRUE(m->mdi("G0 X[10 + #5070]")) << m->errors();
      EXPECT_NEAR(m->motion().pos_cmd.x, 10 + success, 1e-9);
    };
    // Nothing is met: with G38.3 a result, with G38.2 an error, both at the end.
    start(1000);
    ASSERT_TRUE(m->mdi("F1200 G38.3 C40")) << m->errors();
    ends_at(40, 0);
    start(1000);
    EXPECT_FALSE(m->mdi("F1200 G38.2 C40"));
    EXPECT_NEAR(m->motion().pos_cmd.c, 40, 1e-9);
    EXPECT_NE(m->errors().find("ended without contact"), std::string::npos) << m->errors();
    // Met anywhere, at the ends of stretches (of a degree, or so) too. Programs go on from there.
    for (const double contact : {0.3, 3.0, 4.9, 5.0, 5.01, 11.0, 19.99, 25.0, 34.0, 39.0, 39.7}) {
      start(contact);
      const auto reply = m->run_text("F1200\nG1 X31 C0\nG38.3 C40\n#1=#5066\nG1 C[#1]\nM2\n");
      ASSERT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors() << contact;
      EXPECT_NEAR(m->motion().pos_cmd.c, contact, 0.05) << contact;
      ends_at(m->motion().pos_cmd.c, 1);
    }
    // In single steps, and held while it brakes.
    start(20);
    ASSERT_TRUE(m->does({"mode", "auto"}));
    ASSERT_TRUE(m->does({"open", m->write_program("F600\nG38.3 C40\nG1 C10\nM2\n")}));
    const auto is_at = [&](double c) {
      for (int i = 0; i < 4000; ++i) m->cycle();
      EXPECT_NEAR(m->motion().pos_cmd.c, c, 0.3);
      EXPECT_EQ(m->motion().vel_mm_s, 0);
    };
    ASSERT_TRUE(m->does({"step"}));
    ASSERT_TRUE(m->run_until([&] { return m->motion().pos_cmd.c > 20; }));
    ASSERT_TRUE(m->does({"pause"}));
    is_at(20);
    ASSERT_TRUE(m->does({"step"}));
    is_at(10);
    ASSERT_TRUE(m->does({"step"}));
    is_at(10);
    ASSERT_TRUE(m->does({"mode", "mdi"}));
    // There already.
    start(-1);
    ASSERT_TRUE(m->mdi("F1200 G38.3 C40")) << m->errors();
    ends_at(0, 1);
    // Stopped on the way, and begun again.
    start(20);
    const auto run = m->start_program(m->write_program("F600\nG38.2 C40\nM2\n"));
    ASSERT_TRUE(m->run_until([&] { return m->motion().pos_cmd.c > 8; }));
    ASSERT_TRUE(m->does({"abort"}));
    EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
    ASSERT_TRUE(m->does({"mode", "mdi"}));
    ASSERT_TRUE(m->mdi("F600 G38.2 C40")) << m->errors();
    EXPECT_GT(m->motion().pos_cmd.c, 20);
    EXPECT_LT(m->motion().pos_cmd.c, 25);
    EXPECT_EQ(m->motion().faults, 1U) << m->errors();  // that which met nothing
  }
}

TEST(SmoothPath, CoolantBetweenLinesThatQJoinsKeepsItsPlace) {
  auto m = homed_machine();
  double flood_at = -1, off_at = -1;
  bool before = false;
  m->on_cycle([&](const motion::MotionStatus& s) {
    const bool flood = m->bit("iocontrol.0.coolant-flood");
    if (flood != before) (flood ? flood_at : off_at) = s.pos_cmd.x;
    before = flood;
  });
  const auto text = "G21 G90 F600 G64 P.1 Q.1\nG1 X5\nM8\nG1 X10\nM9\nG1 X15\nM2\n";
  EXPECT_EQ(m->run_text(text).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(flood_at, 5, 0.2);
  EXPECT_NEAR(off_at, 10, 0.2);
}

TEST(SmoothPath, AStepAfterAPauseEndsAtTheEndOfItsBlock) {
  auto m = homed_machine();
  const auto path = m->write_program(zigzag("G64 P0.05"));
  const auto run = m->start_program(path);
  ASSERT_TRUE(m->run_until([&] { return m->motion().pos_cmd.x > 5; }));
  EXPECT_TRUE(m->does({"pause"}));
  m->run_for(0.5);
  const double held = m->joint(0);
  for (double end : {8.0, 12.0, 16.0}) {
    if (end < held) continue;
    EXPECT_TRUE(m->does({"step"}));
    m->run_for(2);
    // In a blend the path is kept, so the end of a block is the middle of its corner.
    EXPECT_NEAR(m->joint(0), end, 0.05);
    EXPECT_EQ(m->motion().vel_mm_s, 0);
    EXPECT_EQ(m->task().interp_state, task::InterpState::paused);
  }
  EXPECT_TRUE(m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 40, 1e-9);
}

TEST(SmoothPath, SynchronisedOutputsSwitchAtTheirVertexWithoutAStop) {
  auto m = homed_machine();
  std::string text = "G21 G90 G64 P0.01\nG0 X0 Y0\nF1800\n";
  for (int i = 1; i <= 200; ++i) {
    text += i % 2 != 0 ? "M62 P0\n" : "M63 P0\n";
    text += "G1 X" + std::to_string(0.2 * i) + "\n";
  }
  const auto path = m->write_program(text + "M63 P0\nG1 X41\nM2\n");
  const auto run = m->start_program(path);
  bool before = false;
  int edges = 0;
  double worst = 0, slowest = 1e9;
  m->on_cycle([&](const motion::MotionStatus& s) {
    const bool on = (s.digital_out & 1U) != 0;
    if (on != before) {
      // Edge n stands at X 0.2 n; the cycle in which it is seen is the first behind it.
      const double over = s.pos_cmd.x - 0.2 * edges;
      worst = std::max({worst, over / std::max(s.vel_mm_s * 0.001, 1e-3), -over / 1e-6});
      ++edges;
    }
    before = on;
    if (s.pos_cmd.x > 2 && s.pos_cmd.x < 38) slowest = std::min(slowest, s.vel_mm_s);
  });
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
  m->on_cycle({});
  EXPECT_EQ(edges, 200);
  EXPECT_LE(worst, 1.001) << "in servo cycles of travel";
  EXPECT_GT(slowest, 29.9) << "full feed throughout";
}

TEST(SmoothPath, AnUnchangedSpeedWordStopsNothing) {
  auto m = homed_machine();
  std::string text = "G21 G90 G64 P0.01\nG0 X0 Y0\nF1800 S1000 M3\nG1 X0.5\n";
  for (int i = 1; i <= 50; ++i) text += "G1 S1000 F1800 X" + std::to_string(0.5 + 0.5 * i) + "\n";
  const auto path = m->write_program(text + "M2\n");
  const auto run = m->start_program(path);
  double slowest = 1e9;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.pos_cmd.x > 2 && s.pos_cmd.x < 24) slowest = std::min(slowest, s.vel_mm_s);
  });
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
  m->on_cycle({});
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_GT(slowest, 29.9);
}

}  // namespace
}  // namespace kerf::harness
