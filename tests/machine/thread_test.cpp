// Threads and taps on whole machines: from the program to the joints, behind a simulated spindle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "harness/joint_watch.hpp"
#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

std::unique_ptr<Machine> homed(const char* ini) {
  MachineOptions o;
  o.ini = std::string(KERF_SOURCE_DIR) + "/configs/sim/" + ini;
  auto m = Machine::start(o);
  EXPECT_TRUE(m->ready()) << m->errors();
  EXPECT_TRUE(m->power_on_and_home()) << m->errors();
  return m;
}
std::unique_ptr<Machine> lathe() { return homed("lathe/lathe.ini"); }
std::unique_ptr<Machine> mill() { return homed("mill/mill.ini"); }

/// What a thread was cut like, from its servo cycles in step.
struct Cut {
  double low{1e9}, high{-1e9};  ///< place of Z where the index was, along the pitch
  int cycles{0};
  double fastest{0}, worst_lag{0};
};

/// Watches Z against spindle.0.revs while in step and above `z_end`.
void watch(Machine& m, double pitch, double z_end, Cut& out) {
  m.on_cycle([&m, &out, pitch, z_end](const motion::MotionStatus& s) {
    out.fastest = std::max(out.fastest, s.vel_mm_s);
    if (!s.sync_in_step || s.pos_cmd.z < z_end) return;
    out.worst_lag = std::max(out.worst_lag, std::abs(s.sync_lag_mm));
    if (s.vel_mm_s <= 0) return;
    const double at = s.pos_cmd.z + m.get("spindle.0.revs") * pitch;
    const double phase = at - std::floor(at / pitch) * pitch;
    out.low = std::min(out.low, phase);
    out.high = std::max(out.high, phase);
    ++out.cycles;
  });
}

TEST(ThreadOnALathe, G33IsTheSameThreadAtEachSpeedAndInEachPass) {
  auto m = lathe();
  double phase = -1;
  for (const int rpm : {200, 400, 800, 1600, 2000}) {
    ASSERT_TRUE(m->mdi("M3 S" + std::to_string(rpm)));
    for (int pass = 0; pass < 2; ++pass) {
      ASSERT_TRUE(m->mdi("G0 X20 Z5.1"));
      Cut cut;
      watch(*m, 1.5, -25, cut);
      ASSERT_TRUE(m->mdi("G33 Z-30 K1.5")) << m->errors();
      m->on_cycle({});
      ASSERT_GT(cut.cycles, 100) << rpm;
      EXPECT_LT(cut.high - cut.low, 0.002) << rpm;
      const double middle = (cut.low + cut.high) / 2;
      if (phase < 0) phase = middle;
      EXPECT_NEAR(middle, phase, 0.001) << rpm;
      EXPECT_LT(cut.fastest, 1.5 * rpm / 60.0 * 1.01 + 61) << rpm;
      EXPECT_NEAR(m->motion().pos_cmd.z, -30, 1e-9);
    }
  }
  // The thread goes through its starting point as if the axis had started at once.
  EXPECT_NEAR(phase, std::fmod(5.1, 1.5), 0.001);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(ThreadOnATable, ItsMovesAreOneThreadWhereKinematicsMixAxesToo) {
  auto m = homed("xyzac-trt/xyzac-trt.ini");
  ASSERT_TRUE(m->mdi("G21 G90 G64 P0.05 S600 M3")) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X20 Y10 Z-60 A10 C20")) << m->errors();
  double slowest = 1e9;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.sync_in_step && s.pos_cmd.z > -99) slowest = std::min(slowest, s.vel_mm_s);
  });
  const auto reply = m->run_text("G33 Z-72.34567 K0.5\nG33 Z-90 K0.5\nG33 Z-100 K0.5\nM2\n");
  m->on_cycle({});
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
  EXPECT_GT(slowest, 4.5);  // 5 mm/s, without a stop between its moves
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(ThreadOnALathe, AThreadThatBeginsInACornerIsBegunWithJerkLimitsToo) {
  MachineOptions o;
  o.ini = std::string(KERF_SOURCE_DIR) + "/configs/sim/lathe/lathe.ini";
  o.replace = {{"[TRAJ]\n", "[TRAJ]\nMAX_LINEAR_JERK = 3000\n"}};
  auto m = Machine::start(o);
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  // The way to the crest and the taper are one blend from the first move on, slower than the thread; it comes into step behind it.
  double worst = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.sync_in_step && s.pos_cmd.z < -10 && s.pos_cmd.z > -38)
      worst = std::max(worst, std::abs(s.sync_lag_mm));
  });
  const auto reply = m->run_text(
      "G8 G18 G21 G90 G97 G64 P0.2 S1000 M3\nG0 X11 Z5\n"
      "G76 P1 Z-40 I-0.5 J0.3 K0.9 R1 Q29.5 H0 E6 L1\nM2\n");
  m->on_cycle({});
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
  EXPECT_LT(worst, 0.01);
}

TEST(ThreadOnALathe, BrakingAtItsEndIsNoFallingBehind) {
  MachineOptions o;
  o.ini = KERF_SOURCE_DIR "/configs/sim/lathe/lathe.ini";
  (void)limit_jerk(o, 2, 0.03);
  auto m = Machine::start(o);
  ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
  for (int n = 4; n < 7; ++n) {
    const double rpm = 500 + 37.3 * n;
    ASSERT_TRUE(m->mdi("M3 S" + std::to_string(rpm)));
    ASSERT_TRUE(m->mdi("G0 X20 Z0"));
    ASSERT_TRUE(
        m->mdi("G76 P1.5 Z-" + std::to_string(10 + 0.037 * n) + " I-1 J0.3 K0.6 R1.5 Q29.5 H1"))
        << m->errors();
    EXPECT_EQ(m->motion().faults, 0U) << rpm << m->errors();
  }
}

TEST(ThreadOnALathe, AnAbortInItIsNoFallingBehindEither) {
  for (const double ramp_s : {0.0, 0.03}) {
    MachineOptions o;
    o.ini = KERF_SOURCE_DIR "/configs/sim/lathe/lathe.ini";
    if (ramp_s > 0) (void)limit_jerk(o, 2, ramp_s);
    auto m = Machine::start(o);
    ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
    ASSERT_TRUE(m->mdi("M3 S1200"));
    ASSERT_TRUE(m->mdi("G0 X20 Z0"));
    (void)m->send({"mdi", "G33 Z-30 K1"});
    ASSERT_TRUE(m->run_until([&] { return m->motion().pos_cmd.z < -10; }, 5)) << m->errors();
    ASSERT_TRUE(m->does({"abort"}));
    m->run_for(1);
    EXPECT_EQ(m->motion().faults, 0U) << m->errors();
    EXPECT_GT(m->motion().pos_cmd.z, -12);
  }
}

TEST(ThreadOnALathe, G76CutsAllItsPassesInOneGroove) {
  auto m = lathe();
  std::vector<double> depths;
  int indexes = 0;
  bool armed = false;
  Cut cut;
  double low_x = 1e9, low_z = 1e9;
  m->on_cycle([&](const motion::MotionStatus& s) {
    const bool now = m->bit("spindle.0.index-enable");
    if (armed && !now) ++indexes;
    armed = now;
    low_z = std::min(low_z, s.pos_cmd.z);
    if (!s.sync_in_step) return;
    // Middle of the thread: away from the tapers.
    if (s.pos_cmd.z < 1 && s.pos_cmd.z > -12) {
      if (depths.empty() || std::abs(depths.back() - s.pos_cmd.x) > 1e-6 || low_x > 1e8)
        depths.push_back(s.pos_cmd.x);
      low_x = s.pos_cmd.x;
      // Q29.5 moves each pass along by its depth; the way to the crest is part of the thread.
      const double shift = (10.5 - s.pos_cmd.x) * std::tan(29.5 * M_PI / 180);
      const double at = s.pos_cmd.z + shift + m->get("spindle.0.revs") * 1.5;
      const double phase = at - std::floor(at / 1.5) * 1.5;
      cut.low = std::min(cut.low, phase);
      cut.high = std::max(cut.high, phase);
      ++cut.cycles;
    } else {
      low_x = 1e9;
    }
  });
  const auto reply = m->run_text(
      "G8 G18 G21 G90 G97 S600 M3\nG0 X11 Z5\n"
      "G76 P1.5 Z-20 I-0.5 J0.25 K0.92 R1.8 Q29.5 H2 E1 L3\nM2\n");
  m->on_cycle({});
  EXPECT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
  EXPECT_NEAR(m->motion().pos_cmd.x, 11, 1e-9) << "the drive line";
  EXPECT_NEAR(m->motion().pos_cmd.z, -20, 1e-9);
  // Depth 0.25 n^(1/1.8) below 0.92: 10 passes, then the last depth with two spring passes.
  EXPECT_GE(indexes, 12);
  ASSERT_GE(depths.size(), 10U);
  EXPECT_NEAR(depths.front(), 10.25, 1e-6);
  EXPECT_NEAR(depths.back(), 9.58, 1e-6);
  EXPECT_GT(cut.cycles, 1000);
  EXPECT_LT(cut.high - cut.low, 0.01) << "all in one groove";
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  EXPECT_TRUE(m->motion().enables.feed);
}

TEST(ThreadOnALathe, ASpeedChangeInTheThreadIsFollowed) {
  auto m = lathe();
  ASSERT_TRUE(m->mdi("M3 S600"));
  ASSERT_TRUE(m->mdi("G0 X20 Z10.6"));
  Cut cut;
  watch(*m, 2, -75, cut);
  const auto run = m->start_program(m->write_program("G33 Z-80 K2\nM2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->motion().sync_in_step; }, 20));
  m->run_for(0.3);
  EXPECT_TRUE(m->does({"spindle-override", "0.5"}) || m->does({"spindle-override", "0", "0.5"}));
  m->run_for(1.0);
  EXPECT_NEAR(m->motion().vel_mm_s, 10, 0.1);
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }));
  m->on_cycle({});
  EXPECT_LT(cut.high - cut.low, 0.02);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(ThreadOnALathe, AbortGivesTheOverridesBackAndThePauseWaitsForTheEnd) {
  auto m = lathe();
  ASSERT_TRUE(m->mdi("M3 S600"));
  ASSERT_TRUE(m->mdi("G0 X11 Z5"));
  auto run = m->start_program(
      m->write_program("G76 P1.5 Z-20 I-0.5 J0.25 K0.92 R1.8 Q29.5 H2 E1 L3\nM2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->motion().sync_in_step; }, 20));
  EXPECT_FALSE(m->motion().enables.feed);
  m->abort();
  m->run_for(0.5);
  EXPECT_FALSE(m->bit("spindle.0.on"));
  EXPECT_FALSE(m->bit("spindle.0.index-enable"));
  EXPECT_EQ(m->motion().vel_mm_s, 0);
  // The next order says again what counts.
  ASSERT_TRUE(m->mdi("G0 X30"));
  EXPECT_TRUE(m->motion().enables.feed) << "an abort leaves no override dead";
  ASSERT_TRUE(m->mdi("M3 S600"));
  ASSERT_TRUE(m->mdi("G0 Z5"));
  run = m->start_program(m->write_program("G33 Z-20 K1.5\nG0 X40\nM2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->motion().sync_in_step; }, 20));
  m->send({"pause"});
  ASSERT_TRUE(m->run_until([&] { return m->motion().pos_cmd.z == -20; }, 20));
  m->run_for(0.5);
  EXPECT_NEAR(m->motion().pos_cmd.x, 30, 1e-9) << "paused at the end of the thread";
  EXPECT_TRUE(m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 60));
  EXPECT_NEAR(m->motion().pos_cmd.x, 40, 1e-9);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(ThreadOnALathe, FeedPerRevolutionFollowsTheMeasuredSpeed) {
  auto m = lathe();
  ASSERT_TRUE(m->mdi("M3 S600"));
  ASSERT_TRUE(m->mdi("G0 X20 Z5"));
  ASSERT_TRUE(m->mdi("G95 F0.2"));
  const auto run = m->start_program(m->write_program("G1 Z-20\nG94 F60 G1 Z-22\nM2\n"));
  m->run_for(2);
  EXPECT_NEAR(m->motion().vel_mm_s, 2, 0.03);
  EXPECT_TRUE(m->hal("setp spindle.0.inhibit 1"));
  m->run_for(2);
  EXPECT_EQ(m->motion().vel_mm_s, 0) << "without revolutions no feed";
  EXPECT_TRUE(m->hal("setp spindle.0.inhibit 0"));
  m->run_for(2);
  EXPECT_NEAR(m->motion().vel_mm_s, 2, 0.03);
  EXPECT_TRUE(m->run_until([&] { return m->motion().pos_cmd.z < -20.5; }, 30));
  m->run_for(0.1);
  EXPECT_NEAR(m->motion().vel_mm_s, 1, 1e-6);
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 60));
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(TapOnAMill, G331GoesBeyondBothEndsWithItsSpindleAndEndsWhereItBegan) {
  auto m = mill();
  ASSERT_TRUE(m->mdi("M3 S600"));
  ASSERT_TRUE(m->mdi("G0 X30 Y30 Z-20"));
  double deepest = 0, highest = -1e9, lag = 0, low = 1e9, high = -1e9;
  bool reversed = false;
  m->on_cycle([&](const motion::MotionStatus& s) {
    deepest = std::min(deepest, s.pos_cmd.z);
    highest = std::max(highest, s.pos_cmd.z);
    reversed = reversed || m->bit("spindle.0.reverse");
    if (!s.sync_in_step) return;
    lag = std::max(lag, std::abs(s.sync_lag_mm));
    const double at = s.pos_cmd.z + m->get("spindle.0.revs") * 1.25;
    low = std::min(low, at);
    high = std::max(high, at);
  });
  ASSERT_TRUE(m->mdi("G33.1 Z-35 K1.25")) << m->errors();
  m->on_cycle({});
  // 10 rev/s on 100 rev/s2 are half a turn.
  EXPECT_NEAR(deepest, -35.625, 0.1);
  EXPECT_GT(highest, -20 + 0.3);
  EXPECT_LT(highest, -20 + 1.0);
  EXPECT_TRUE(reversed);
  EXPECT_LT(lag, 0.05);
  EXPECT_NEAR(m->motion().pos_cmd.z, -20, 1e-9);
  EXPECT_EQ(m->motion().spindle[0].direction, 1);
  EXPECT_TRUE(m->bit("spindle.0.forward"));
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  // The next move knows where it is, and what I does.
  double fastest = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    (void)s;
    fastest = std::max(fastest, m->get("spindle.0.speed-out-abs"));
  });
  ASSERT_TRUE(m->mdi("G33.1 Z-35 K1.25 I2")) << m->errors();
  m->on_cycle({});
  EXPECT_NEAR(fastest, 1200, 1e-6);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 600, 1e-6);
  ASSERT_TRUE(m->mdi("G1 X40 F600"));
  EXPECT_NEAR(m->motion().pos_cmd.x, 40, 1e-9);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(TapOnAMill, AbortAtManyCyclesOfATapNeverTearsItOut) {
  auto m = mill();
  ASSERT_TRUE(m->mdi("M3 S600"));
  ASSERT_TRUE(m->mdi("G0 X30 Y30 Z-20"));
  m->send({"mdi", "G33.1 Z-30 K1.25"});
  int at = 0;
  while (m->run_until([&] { return m->motion().sync_in_step; }, 5) && at < 40) {
    const int failed = m->branch([&] {
      double lag = 0;
      m->on_cycle([&](const motion::MotionStatus& s) {
        if (s.sync_in_step) lag = std::max(lag, std::abs(s.sync_lag_mm));
      });
      m->abort();
      m->run_for(0.6);
      EXPECT_LT(lag, 0.1);
      EXPECT_EQ(m->motion().vel_mm_s, 0);
      EXPECT_EQ(m->motion().faults, 0U) << m->errors();
      EXPECT_EQ(m->motion().spindle[0].direction, 0);
      EXPECT_TRUE(m->mdi("G0 Z-10"));
      EXPECT_FALSE(m->bit("spindle.0.on"));
    });
    EXPECT_EQ(failed, 0) << "cycle group " << at;
    ++at;
    m->run_for(0.083);
  }
  EXPECT_GT(at, 15);
}

}  // namespace
}  // namespace kerf::harness
