// A machine with jerk limits, driven as operators do: overrides, pauses and aborts while its path follows time laws.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

constexpr double kJerk = 20000;  // mm/s3
constexpr double kPeriod = 0.001;

/// Once round a flower, in short lines, and back over arcs.
std::string program() {
  std::string out = "G21 G90 G54 G64 P0.01 F6000\nG0 X60 Y60 Z-10\n";
  char text[80];
  for (int i = 0; i <= 300; ++i) {
    const double t = i * 0.02, r = 40 * (1 + 0.1 * std::sin(5 * t));
    std::snprintf(text, sizeof text, "G1 X%.3f Y%.3f\n", 60 + r * std::cos(t),
                  60 + r * std::sin(t));
    out += text;
  }
  return out + "G2 X60 Y20 R40\nG3 X40 Y20 R12\nG1 X20 Y10\nM2\n";
}

class TimeLawsMachine : public testing::Test {
 protected:
  void start(bool laws = true) {
    MachineOptions options;
    options.replace = {
        {"MAX_LINEAR_VELOCITY = 120", "MAX_LINEAR_VELOCITY = 120\nMAX_LINEAR_JERK = 20000"},
        {"[KERF]\n",
         std::string("[KERF]\nPATH_CHECK = yes\nTIME_LAWS = ") + (laws ? "1\n" : "0\n")}};
    m = Machine::start(options);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    m->on_cycle([this](const motion::MotionStatus& s) {
      for (int j = 0; j < 3; ++j) {
        double* p = before[j];
        const double third = s.joint[j].pos_cmd - 3 * p[0] + 3 * p[1] - p[2];
        if (++seen > 9) jerk = std::max(jerk, std::abs(third) / (kPeriod * kPeriod * kPeriod));
        p[2] = p[1], p[1] = p[0], p[0] = s.joint[j].pos_cmd;
      }
    });
  }
  [[nodiscard]] bool stands() const { return m->motion().vel_mm_s == 0; }

  std::unique_ptr<Machine> m;
  double before[3][3]{};
  int seen{0};
  double jerk{0};
};

TEST_F(TimeLawsMachine, TakeLessTimeThanLookingAheadInTheServo) {
  double seconds[2];
  for (const bool laws : {false, true}) {
    start(laws);
    const auto begun = m->now();
    const auto reply = m->run_text(program());
    ASSERT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
    seconds[laws ? 1 : 0] = static_cast<double>(m->now() - begun) * 1e-9;
    EXPECT_EQ(m->errors(), "");
    EXPECT_NEAR(m->joint(0), 20, 1e-9);
    EXPECT_NEAR(m->joint(1), 10, 1e-9);
    EXPECT_LE(jerk, kJerk * 1.01);
    jerk = 0, seen = 0;
    m.reset();
  }
  EXPECT_LT(seconds[1], 0.95 * seconds[0]);
  std::printf("with laws %.3f s, without %.3f s\n", seconds[1], seconds[0]);
}

TEST_F(TimeLawsMachine, KeepLimitsAndPathUnderAnOperatorsHands) {
  start();
  std::mt19937_64 random(5);
  for (int run = 0; run < 3; ++run) {
    const auto id = m->start_program(m->write_program(program()));
    bool paused = false;
    for (int i = 0; i < 400 && m->outcome(id).state != task::CommandState::done; ++i) {
      m->run_for(0.02 + 0.001 * static_cast<double>(random() % 60));
      if (m->outcome(id).state == task::CommandState::done) break;
      switch (random() % 4) {
        case 0:
          m->send(
              {"feed-override", std::to_string(0.02 + 0.01 * static_cast<double>(random() % 118))});
          break;
        case 1:
          m->send({paused ? "resume" : "pause"});
          paused = !paused;
          break;
        default: break;
      }
    }
    if (paused) m->send({"resume"});
    m->send({"feed-override", "1"});
    EXPECT_TRUE(
        m->run_until([&] { return m->outcome(id).state == task::CommandState::done; }, 600));
    EXPECT_NEAR(m->joint(0), 20, 1e-9);
  }
  EXPECT_EQ(m->errors(), "");
  EXPECT_LE(jerk, kJerk * 1.01);
}

TEST_F(TimeLawsMachine, KeepTheProgrammedFeedHoweverSlowItIs) {
  start();
  for (const double feed : {1.0, 5.0, 30.0, 200.0, 1000.0}) {
    ASSERT_TRUE(m->mdi("G0 X10 Y10")) << m->errors();
    double fastest = 0;
    m->on_cycle([&](const motion::MotionStatus& s) { fastest = std::max(fastest, s.vel_mm_s); });
    // As far as the corners are concerned: P0.01 rounds off 0.02 mm of the way at most.
    const double size = feed < 10 ? 0.2 : 5, way = (5.831 + 7.810 + 7.071) / 5 * size;
    char text[200];
    std::snprintf(text, sizeof text,
                  "G21 G90 G54 G64 P0.01\nF%g\nG91\nG1 X%g Y%g\nG1 X%g Y%g\nG1 X%g Y%g\nM2\n", feed,
                  size, 0.6 * size, size, 1.2 * size, -1.4 * size, 0.2 * size);
    const auto begun = m->now();
    const auto reply = m->run_text(text);
    m->on_cycle({});
    ASSERT_EQ(reply.state, task::CommandState::done) << reply.text << m->errors();
    const double seconds = static_cast<double>(m->now() - begun) * 1e-9;
    EXPECT_LE(fastest, feed / 60 * 1.001) << "F" << feed;
    EXPECT_LE(seconds, way / feed * 60 * 1.005 + 0.3) << "F" << feed;
    EXPECT_GE(seconds, (way - 0.06) / feed * 60) << "F" << feed;
  }
  EXPECT_EQ(m->errors(), "");
}

TEST_F(TimeLawsMachine, AnOverrideThatSwingsDownToNothingDoesNotHoldItBack) {
  start();
  // Two long lines with a corner between them, slow for what the machine can do: 0.6 mm/s.
  const auto id = m->start_program(m->write_program(
      "G21 G90 G54 G64 P0.01\nG0 X10 Y10\nG1 X11.2 Y10.9 F36\nG1 X10.3 Y12.3\nM2\n"));
  const auto begun = m->now();
  // From 0 to 2 and back in 0.8 s, as a knob does it: a step each 10 ms.
  for (int i = 0; i < 3000 && m->outcome(id).state != task::CommandState::done; ++i) {
    m->send({"feed-override", std::to_string(0.01 * std::round(60 * (1 - std::cos(i * 0.0785))))});
    m->run_for(0.01);
  }
  ASSERT_EQ(m->outcome(id).state, task::CommandState::done) << m->errors();
  const double seconds = static_cast<double>(m->now() - begun) * 1e-9;
  // 3.17 mm at 0.36 mm/s in the mean, and the rapid.
  EXPECT_LT(seconds, 12);
  EXPECT_EQ(m->errors(), "");
  EXPECT_LE(jerk, kJerk * 1.01);
}

TEST_F(TimeLawsMachine, AnAbortAtAnyMomentStandsSoonAndNothingIsLeft) {
  start();
  std::mt19937_64 random(6);
  for (int run = 0; run < 10; ++run) {
    (void)m->start_program(m->write_program(program()));
    m->run_for(0.3 + 0.001 * static_cast<double>(random() % 6000));
    (void)m->abort();
    EXPECT_TRUE(m->run_until([&] { return stands(); }, 0.5)) << "run " << run;
    const double x = m->joint(0), y = m->joint(1);
    EXPECT_TRUE(m->mdi(m->line_to_shown_place())) << m->errors();
    EXPECT_NEAR(m->joint(0), x, 1e-9);
    EXPECT_NEAR(m->joint(1), y, 1e-9);
  }
  EXPECT_EQ(m->errors(), "");
  EXPECT_LE(jerk, kJerk * 1.01);
}

}  // namespace
}  // namespace kerf::harness
