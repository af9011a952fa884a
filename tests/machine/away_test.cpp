// Pause, jog away, return, resume: the rest of the path is what it would have been.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

constexpr double kCentreX = 40, kCentreY = 20, kRadius = 15;

class Away : public testing::Test {
 protected:
  void SetUp() override {
    m = Machine::start();
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    path = m->write_program(
        "G61 S900 M3\nG0 X25 Y20 Z-5\nG1 Z-20 F900\nG2 X55 Y20 I15 J0\nG1 X70\nM5\nM2\n");
    run = m->start_program(path);
    ASSERT_TRUE(m->run_until([&] { return m->task().current_line == 4; }));
    m->run_for(1);
  }
  /// Half a circle, then a line.
  static double beside_the_path(const rtapi::Pose& p) {
    const double across = p.x <= kCentreX + kRadius && p.y >= kCentreY
                              ? std::hypot(p.x - kCentreX, p.y - kCentreY) - kRadius
                              : p.y - kCentreY;
    return std::max(std::fabs(across), std::fabs(p.z + 20));
  }
  bool paused_and_away() { return m->does({"away"}) && m->motion().away && m->task().paused; }
  /// The spindle was stopped, and nothing goes on, nor does it turn the other way.
  void refused_without_spindle() {
    for (const char* word : {"resume", "step"}) {
      const auto reply = m->command({word});
      EXPECT_EQ(reply.state, task::CommandState::error);
      EXPECT_NE(reply.text.find("spindle 0 turned forward"), std::string::npos) << reply.text;
    }
    EXPECT_EQ(m->command({"spindle", "reverse"}).state, task::CommandState::error);
    EXPECT_FALSE(m->bit("spindle.0.on"));
  }
  /// It turns again, and once it is at its speed the program goes on to its end.
  void goes_on_with_spindle() {
    ASSERT_TRUE(m->does({"spindle", "forward"})) << m->errors();
    EXPECT_EQ(m->command({"resume"}).state, task::CommandState::error) << "not at speed yet";
    m->run_for(12);
    EXPECT_NEAR(m->motion().spindle[0].speed_rpm, 900, 1e-6);
    EXPECT_TRUE(m->does({"resume"})) << m->errors();
    ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 60));
    EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  }
  std::unique_ptr<Machine> m;
  std::string path;
  std::uint64_t run{0};
};

TEST_F(Away, JogsReturnsAndTheRestOfThePathIsTheSame) {
  ASSERT_TRUE(paused_and_away()) << m->errors();
  const auto left = m->motion().pos_cmd;
  EXPECT_LT(beside_the_path(left), 1e-6);
  ASSERT_TRUE(m->does({"jog", "z", "20", "15"})) << m->errors();
  m->run_for(2);
  ASSERT_TRUE(m->does({"jog", "x", "30", "60"})) << m->errors();
  ASSERT_TRUE(m->does({"jog", "y", "-20", "12"})) << m->errors();
  m->run_for(4);
  EXPECT_NEAR(m->motion().pos_cmd.x, left.x + 60, 1e-6);
  EXPECT_NEAR(m->motion().pos_cmd.z, left.z + 15, 1e-6);
  EXPECT_NEAR(m->motion().place.x, left.x, 1e-9);
  // Not from here.
  for (const char* word : {"resume", "step"}) {
    const auto reply = m->command({word});
    EXPECT_EQ(reply.state, task::CommandState::error);
    EXPECT_NE(reply.text.find("return"), std::string::npos) << reply.text;
  }
  m->run_for(0.5);
  EXPECT_NEAR(m->motion().pos_cmd.x, left.x + 60, 1e-6) << "nothing moved";
  // Back: across first, then down.
  double lowest_away = 0;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (std::hypot(s.pos_cmd.x - left.x, s.pos_cmd.y - left.y) > 1e-6)
      lowest_away = std::min(lowest_away, s.pos_cmd.z);
  });
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_NEAR(lowest_away, left.z + 15, 1e-6);
  EXPECT_FALSE(m->motion().away);
  double worst = 0;
  m->on_cycle(
      [&](const motion::MotionStatus& s) { worst = std::max(worst, beside_the_path(s.pos_cmd)); });
  ASSERT_TRUE(m->does({"resume"})) << m->errors();
  ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 60));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_LT(worst, 1e-6);
  EXPECT_NEAR(m->joint(0), 70, 1e-9);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST_F(Away, BelowThePlaceItComesUpFirst) {
  ASSERT_TRUE(paused_and_away()) << m->errors();
  const auto left = m->motion().pos_cmd;
  ASSERT_TRUE(m->does({"jog", "x", "30", "20"}));
  m->run_for(2);
  ASSERT_TRUE(m->does({"jog", "z", "-20", "8"}));
  m->run_for(2);
  bool crossed_low = false;
  double x = m->motion().pos_cmd.x;
  m->on_cycle([&](const motion::MotionStatus& s) {
    crossed_low = crossed_low || (s.pos_cmd.x != x && s.pos_cmd.z < left.z - 1e-6);
    x = s.pos_cmd.x;
  });
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_FALSE(crossed_low);
}

TEST_F(Away, ASpindleThatWasStoppedMustTurnAgainBeforeResume) {
  ASSERT_TRUE(paused_and_away()) << m->errors();
  ASSERT_TRUE(m->does({"spindle", "off"})) << m->errors();
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  refused_without_spindle();
  goes_on_with_spindle();
}

/// A feed goes on into the work only with the spindle that it had: also where nobody left the path.
TEST_F(Away, ASpindleThatWasStoppedInAPauseMustTurnAgainBeforeResume) {
  ASSERT_TRUE(m->does({"pause"})) << m->errors();
  m->run_for(1);
  ASSERT_TRUE(m->does({"spindle", "off"})) << m->errors();
  m->run_for(0.5);
  const auto stands = m->motion().pos_cmd;
  refused_without_spindle();
  EXPECT_EQ(m->motion().pos_cmd, stands);
  EXPECT_EQ(m->branch([&] {
    // Who wants to go on otherwise aborts; nothing of it is left for the next program.
    EXPECT_EQ(m->abort().state, task::CommandState::done);
    m->run_for(0.5);
    const auto next = m->start_program(m->write_program("G1 Z-5 F900\nG1 Z0\nM2\n"));
    m->run_for(0.5);
    EXPECT_TRUE(m->does({"pause"})) << m->errors();
    m->run_for(0.2);
    EXPECT_TRUE(m->does({"resume"})) << m->errors();
    EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(next).state); }, 60));
    EXPECT_EQ(m->outcome(next).state, task::CommandState::done) << m->errors();
  }),
            0);
  goes_on_with_spindle();
}

TEST_F(Away, ASpindleThatWasStoppedAtM0MustTurnAgainBeforeResume) {
  ASSERT_TRUE(m->does({"abort"}));
  m->run_for(0.5);
  run = m->start_program(m->write_program("S900 M3\nG0 X20 Y20 Z-5\nM0\nG1 X30 F600\nM2\n"));
  ASSERT_TRUE(m->run_until([&] { return m->task().paused; }, 60)) << m->errors();
  m->run_for(0.2);
  ASSERT_TRUE(m->does({"spindle", "off"})) << m->errors();
  m->run_for(0.5);
  refused_without_spindle();
  goes_on_with_spindle();
  EXPECT_NEAR(m->joint(0), 30, 1e-9);
}

TEST_F(Away, AbortAtAnyTimeForgetsThePath) {
  ASSERT_TRUE(paused_and_away()) << m->errors();
  ASSERT_TRUE(m->does({"jog", "z", "20", "15"}));
  m->run_for(1.5);
  const auto back = m->send({"return"});
  for (int n = 0; n < 1500; ++n) {
    if (n % 75 == 3) {
      EXPECT_EQ(m->branch([&] {
        EXPECT_EQ(m->abort().state, task::CommandState::done);
        const double z = m->joint(2);
        m->run_for(0.5);
        EXPECT_EQ(m->joint(2), z);
        EXPECT_FALSE(m->motion().away);
        EXPECT_TRUE(m->task().idle);
        EXPECT_TRUE(m->mdi("G91 G0 X0.5")) << m->errors();
        EXPECT_NEAR(m->joint(2), z, 1e-9);
        EXPECT_EQ(m->motion().faults, 0U) << m->errors();
      }),
                0)
          << "cycle " << n;
    }
    m->cycle();
  }
  EXPECT_EQ(m->outcome(back).state, task::CommandState::done);
}

TEST_F(Away, AStoppedWayBackStaysAway) {
  ASSERT_TRUE(paused_and_away()) << m->errors();
  ASSERT_TRUE(m->does({"jog", "x", "30", "40"}));
  m->run_for(2);
  const auto back = m->send({"return"});
  m->run_for(0.4);
  ASSERT_TRUE(m->does({"jog-stop"}));
  m->run_for(0.5);
  EXPECT_EQ(m->outcome(back).state, task::CommandState::error) << m->outcome(back).text;
  EXPECT_TRUE(m->motion().away);
  EXPECT_EQ(m->command({"resume"}).state, task::CommandState::error);
  EXPECT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_TRUE(m->does({"resume"})) << m->errors();
}

TEST_F(Away, AtAStopOfTheProgramToo) {
  ASSERT_TRUE(m->does({"abort"}));
  run = m->start_program(m->write_program("G0 X20 Y20 Z-5\nM0\nG0 X30\nM2\n"));
  m->run_for(3);
  ASSERT_TRUE(paused_and_away()) << m->errors();
  ASSERT_TRUE(m->does({"jog", "x", "30", "40"}));
  m->run_for(2);
  EXPECT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_NEAR(m->joint(0), 20, 1e-9);
  EXPECT_TRUE(m->does({"resume"})) << m->errors();
  ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 60));
  EXPECT_NEAR(m->joint(0), 30, 1e-9);
}

}  // namespace
}  // namespace kerf::harness
