// The direction of a held program (linuxcnc.AUTO_REVERSE, AUTO_FORWARD): resume runs the path back over what motion remembers, and
// forwards again.
#include <gtest/gtest.h>

#include <cmath>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

class Direction : public testing::Test {
 protected:
  void SetUp() override {
    m = Machine::start();
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  }
  void run_to(double x) {
    id = m->start_program(m->write_program(
        "G21 G90 G61\nG1 X10 F3000\nG1 X20\nG2 X40 I10 J0\nG1 X60\nM62 P0\nG1 X80\nM2\n"));
    ASSERT_TRUE(m->run_until([&] { return m->joint(0) > x; }, 30)) << m->errors();
  }
  bool refuses(const char* way, const char* why) {
    const auto reply = m->command({"direction", way});
    return reply.state == task::CommandState::error && reply.text.find(why) != std::string::npos;
  }
  bool hold() {
    return m->does({"pause"}) && m->run_until([&] { return m->motion().held; }, 1);
  }
  std::unique_ptr<Machine> m;
  std::uint64_t id{0};
};

TEST_F(Direction, BackToTheBeginningAndForwardsToTheEnd) {
  EXPECT_TRUE(refuses("reverse", "no program runs"));
  run_to(50);
  EXPECT_TRUE(refuses("reverse", "pause the program first"));
  ASSERT_TRUE(hold());
  const double held = m->joint(0);
  EXPECT_TRUE(m->does({"direction", "reverse"}));
  m->run_for(0.5);
  EXPECT_EQ(m->joint(0), held) << "only resume moves";
  EXPECT_EQ(m->command({"step"}).state, task::CommandState::error);
  bool on_arc = false;
  m->on_cycle([&](const motion::MotionStatus& s) {
    on_arc = on_arc || (s.joint[0].pos_cmd > 25 && s.joint[0].pos_cmd < 35 &&
                        std::abs(s.joint[1].pos_cmd) > 5);
  });
  EXPECT_TRUE(m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) < 1e-9; }, 30)) << m->joint(0);
  EXPECT_TRUE(on_arc) << "back the way it came";
  m->run_for(1);
  EXPECT_NEAR(m->joint(0), 0, 1e-9) << "it stands where its memory begins";
  EXPECT_FALSE(m->task().idle);
  EXPECT_NE(m->task().waiting_for.object.view().find("forwards"), std::string::npos)
      << m->task().waiting_for.object.view();
  EXPECT_FALSE(m->bit("motion.digital-out-00"));
  // Half way forwards, a little back, and on.
  ASSERT_TRUE(hold());
  EXPECT_TRUE(m->does({"direction", "forward"}) && m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) > 55; }, 30));
  ASSERT_TRUE(hold());
  EXPECT_TRUE(m->does({"direction", "reverse"}) && m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) < 45; }, 30));
  ASSERT_TRUE(hold());
  EXPECT_TRUE(m->does({"direction", "forward"}) && m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(id).state); }, 30));
  EXPECT_EQ(m->outcome(id).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 80, 1e-9);
  EXPECT_TRUE(m->bit("motion.digital-out-00"));
  EXPECT_EQ(m->errors().find("limit"), std::string::npos) << m->errors();
}

TEST_F(Direction, AnAbortForgetsIt) {
  run_to(50);
  ASSERT_TRUE(hold());
  EXPECT_TRUE(m->does({"direction", "reverse"}) && m->does({"resume"}));
  m->run_for(0.2);
  EXPECT_TRUE(m->abort().state == task::CommandState::done);
  EXPECT_TRUE(m->mdi("G0 X0 Y0"));
  run_to(50);
  EXPECT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(id).state); }, 30));
  EXPECT_NEAR(m->joint(0), 80, 1e-9);
}

/// A negative adaptive feed of a path that runs backwards drives it forwards: both together are one turn too many.
TEST_F(Direction, AdaptiveFeedCountsInTheDirectionThatIsSet) {
  ASSERT_TRUE(m->mdi("M52 P1"));
  run_to(50);
  ASSERT_TRUE(hold());
  EXPECT_TRUE(m->hal("setp motion.adaptive-feed 0.5") && m->does({"direction", "reverse"}) &&
              m->does({"resume"}));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) < 48; }, 5));
  EXPECT_TRUE(m->hal("setp motion.adaptive-feed -0.5"));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) > 52; }, 5)) << m->joint(0);
  EXPECT_TRUE(m->hal("setp motion.adaptive-feed 0"));
  m->run_for(0.5);
  const double x = m->joint(0);
  m->run_for(0.5);
  EXPECT_EQ(m->joint(0), x);
}

}  // namespace
}  // namespace kerf::harness
