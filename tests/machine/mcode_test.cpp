// M codes on a running machine, at the pins.
#include <gtest/gtest.h>

#include <string>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

class MCode : public testing::Test {
 protected:
  void start(const MachineOptions& options = {}) {
    m = Machine::start(options);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  }
  bool ends(std::uint64_t id, double limit_s) {
    return m->run_until([&] { return task::is_terminal(m->outcome(id).state); }, limit_s);
  }
  std::unique_ptr<Machine> m;
};

TEST_F(MCode, CoolantPinsFollowM7M8M9) {
  start();
  EXPECT_TRUE(m->mdi("M7"));
  EXPECT_TRUE(m->bit("iocontrol.0.coolant-mist"));
  EXPECT_FALSE(m->bit("iocontrol.0.coolant-flood"));
  EXPECT_TRUE(m->mdi("M7"));
  EXPECT_TRUE(m->mdi("M8"));
  EXPECT_TRUE(m->bit("iocontrol.0.coolant-mist") && m->bit("iocontrol.0.coolant-flood"));
  EXPECT_TRUE(m->mdi("M9"));
  EXPECT_TRUE(m->mdi("M9"));
  EXPECT_FALSE(m->bit("iocontrol.0.coolant-mist") || m->bit("iocontrol.0.coolant-flood"));
}

TEST_F(MCode, ImmediateOutputsAtOnceSynchronisedOnesWithTheNextMove) {
  start();
  EXPECT_TRUE(m->mdi("M64 P1"));
  EXPECT_TRUE(m->bit("motion.digital-out-01"));
  EXPECT_TRUE(m->mdi("M65 P1"));
  EXPECT_FALSE(m->bit("motion.digital-out-01"));
  m->start_program(m->write_program("M64 P0\nM63 P0\nG4 P1\nG1 X20 F600\nM2\n"));
  m->run_for(0.5);
  EXPECT_TRUE(m->bit("motion.digital-out-00")) << "it waits for the move";
  m->run_for(1.5);
  EXPECT_FALSE(m->bit("motion.digital-out-00"));
}

TEST_F(MCode, LaterOutputsReplaceQueuedOnesAndAnalogPinsHoldTheirValues) {
  start();
  EXPECT_EQ(m->run_text("M62 P2\nM63 P2\nM67 E1 Q1\nM67 E1 Q3.5\nG0 X5\nM68 E0 Q-2\nM2\n").state,
            task::CommandState::done);
  EXPECT_FALSE(m->bit("motion.digital-out-02"));
  EXPECT_EQ(m->get("motion.analog-out-01"), 3.5);
  EXPECT_EQ(m->get("motion.analog-out-00"), -2);
}

TEST_F(MCode, M66ReadsAtOnceAndWaitsForEdgesAndLevels) {
  start();
  m->hal("setp motion.analog-in-02 7.5");
  EXPECT_TRUE(m->mdi("M66 E2 L0 Q9"));
  EXPECT_TRUE(m->mdi("G0 X#5399"));
  EXPECT_NEAR(m->joint(0), 7.5, 1e-9);
  for (const char* line : {"M66 P1 L2 Q5", "M66 P1 L4 Q5"}) {
    m->hal("setp motion.digital-in-01 1");
    const auto id = m->send({"mdi", line});
    m->run_for(1);
    EXPECT_FALSE(task::is_terminal(m->outcome(id).state)) << line;
    m->hal("setp motion.digital-in-01 0");
    EXPECT_TRUE(ends(id, 0.2)) << line;
  }
  const auto late = m->send({"mdi", "M66 P1 L3 Q2"});
  EXPECT_TRUE(ends(late, 2.5));
  EXPECT_TRUE(m->mdi("G0 X[#5399+10]"));
  EXPECT_NEAR(m->joint(0), 9, 1e-9) << "#5399 is -1 after the time-out";
}

TEST_F(MCode, PausesRefuseMdiAndResumeAtTheNextLine) {
  for (const char* code : {"M0", "M1", "M60"}) {
    start();
    m->does({"optional-stop", "on"});
    const auto run =
        m->start_program(m->write_program(std::string("G0 X1\n") + code + "\nG0 X7\nM2\n"));
    m->run_for(1);
    EXPECT_NEAR(m->joint(0), 1, 1e-9) << code;
    EXPECT_EQ(m->command({"mdi", "G0 Y9"}).state, task::CommandState::error) << code;
    EXPECT_TRUE(m->does({"resume"})) << code;
    EXPECT_TRUE(ends(run, 10));
    EXPECT_NEAR(m->joint(0), 7, 1e-9) << code;
    EXPECT_NEAR(m->joint(1), 0, 1e-9) << code;
  }
}

TEST_F(MCode, AnyClientMayAnswerWhatTheProgramAsks) {
  start();
  m->hal("unlinkp iocontrol.0.tool-changed");
  EXPECT_EQ(m->command({"answer"}).state, task::CommandState::error) << "nothing is asked";
  const auto run = m->start_program(m->write_program("M0\nM1\nM60\nT3 M6\nT0 M6\nG0 X7\nM2\n"));
  struct Row {
    task::PromptKind kind;
    const char* text;
    int tool;
  };
  using task::PromptKind;
  std::uint64_t last = 0;
  for (const Row& row :
       {Row{PromptKind::stop, "M0", -1}, Row{PromptKind::optional_stop, "M1", -1},
        Row{PromptKind::pallet, "pallet", -1}, Row{PromptKind::tool_change, "tool 3 (drill)", 3},
        Row{PromptKind::tool_change, "no tool", 0}}) {
    EXPECT_TRUE(m->run_until([&] { return m->task().prompt.number > last; }, 10)) << row.text;
    const task::Prompt prompt = m->task().prompt;
    EXPECT_EQ(prompt.kind, row.kind);
    EXPECT_EQ(prompt.tool, row.tool);
    EXPECT_NE(prompt.text.view().find(row.text), std::string_view::npos) << prompt.text.c_str();
    m->run_for(1);
    EXPECT_EQ(m->task().prompt.number, prompt.number) << "the same question";
    if (last != 0) {
      const auto late = m->command({"answer", std::to_string(last)});
      EXPECT_EQ(late.state, task::CommandState::error) << "to the question before";
    }
    last = prompt.number;
    EXPECT_TRUE(m->does({"answer", std::to_string(last)}));
  }
  EXPECT_TRUE(ends(run, 10));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 7, 1e-9);
  EXPECT_EQ(m->task().prompt.kind, PromptKind::none);
  // An abort ends the question; the operator's own pause is not answered.
  m->start_program(m->write_program("M0\nG0 X30\nM2\n"));
  m->run_for(0.5);
  EXPECT_TRUE(m->does({"pause"}));
  EXPECT_TRUE(m->does({"answer"}));
  m->run_for(1);
  EXPECT_NEAR(m->joint(0), 7, 1e-9);
  EXPECT_TRUE(m->does({"abort"}));
  m->run_for(0.1);
  EXPECT_EQ(m->task().prompt.kind, PromptKind::none);
  EXPECT_EQ(m->command({"answer"}).state, task::CommandState::error);
}

TEST_F(MCode, M1GoesOnWithTheSwitchOff) {
  start();
  m->does({"optional-stop", "off"});
  EXPECT_EQ(m->run_text("G0 X1\nM1\nG0 X7\nM2\n").state, task::CommandState::done);
  EXPECT_NEAR(m->joint(0), 7, 1e-9);
}

TEST_F(MCode, M3WithS0TurnsWhenTheSpeedComes) {
  start();
  EXPECT_TRUE(m->mdi("M3 S0"));
  m->run_for(0.1);
  EXPECT_EQ(m->get("spindle.0.speed-out"), 0);
  EXPECT_TRUE(m->mdi("S800"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), 800, 1e-6);
  EXPECT_TRUE(m->bit("spindle.0.forward") && m->bit("spindle.0.on"));
  EXPECT_TRUE(m->mdi("M4"));
  m->run_for(0.1);
  EXPECT_NEAR(m->get("spindle.0.speed-out"), -800, 1e-6);
  EXPECT_TRUE(m->bit("spindle.0.reverse"));
  EXPECT_TRUE(m->mdi("M5"));
  m->run_for(0.1);
  EXPECT_FALSE(m->bit("spindle.0.on"));
}

TEST_F(MCode, AdaptiveFeedOverrideAndFeedHoldPinsScaleAndStopTheFeed) {
  start();
  m->hal("setp motion.adaptive-feed 0.5");
  EXPECT_TRUE(m->does({"feed-override", "0.2"}));
  m->start_program(m->write_program("M52\nM50 P0\nM53\nG1 X250 F1200\nM2\n"));
  m->run_for(1);
  EXPECT_NEAR(m->motion().vel_mm_s, 10, 1e-6) << "half of F1200; the operator's override is off";
  m->hal("setp motion.adaptive-feed 9");
  m->run_for(0.3);
  EXPECT_NEAR(m->motion().vel_mm_s, 30, 1e-6) << "MAX_FEED_OVERRIDE 1.5 bounds it";
  m->hal("setp motion.adaptive-feed 0");
  m->run_for(0.3);
  EXPECT_EQ(m->motion().vel_mm_s, 0);
  m->hal("setp motion.adaptive-feed 1");
  m->run_for(0.3);
  EXPECT_NEAR(m->motion().vel_mm_s, 20, 1e-6);
  m->hal("setp motion.feed-hold 1");
  m->run_for(0.3);
  EXPECT_EQ(m->motion().vel_mm_s, 0);
  m->hal("setp motion.feed-hold 0");
  m->run_for(0.3);
  EXPECT_NEAR(m->motion().vel_mm_s, 20, 1e-6);
}

TEST_F(MCode, NegativeAdaptiveFeedRunsThePathBackwards) {
  start();
  m->hal("setp motion.adaptive-feed 1");
  const auto run = m->start_program(m->write_program(
      "M52 P1\nG64 P0.1\nF1200\nG1 X20\nY10\nG2 X30 Y20 I10\nG1 X60\nM62 P0\nX100\nM2\n"));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) > 70; }, 20));
  EXPECT_EQ(m->task().current_line, 9);
  EXPECT_TRUE(m->bit("motion.digital-out-00"));
  m->hal("setp motion.adaptive-feed -9");
  m->run_for(0.3);
  EXPECT_NEAR(m->motion().vel_mm_s, 30, 1e-6) << "MAX_FEED_OVERRIDE 1.5 bounds it";
  EXPECT_TRUE(m->bit("motion.tp-reverse"));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) < 15; }, 20));
  EXPECT_NEAR(m->joint(1), 0, 1e-9);
  EXPECT_EQ(m->task().current_line, 4) << "the line that is driven is shown";
  EXPECT_TRUE(m->bit("motion.digital-out-00")) << "outputs stay as they are";
  m->run_for(5);
  EXPECT_NEAR(m->joint(0), 0, 1e-9);
  EXPECT_EQ(m->motion().vel_mm_s, 0);
  EXPECT_FALSE(task::is_terminal(m->outcome(run).state));
  // M52 P0: an adaptive feed that is off is 1.
  EXPECT_TRUE(m->does({"adaptive-feed", "off"}));
  EXPECT_TRUE(ends(run, 30));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 100, 1e-9);
  EXPECT_FALSE(m->bit("motion.tp-reverse"));
  // The program has ended: there is nothing to go back to.
  EXPECT_TRUE(m->does({"adaptive-feed", "on"}));
  m->run_for(1);
  EXPECT_NEAR(m->joint(0), 100, 1e-9);
}

TEST_F(MCode, EstopAndAbortEndAReverseRun) {
  start();
  m->start_program(m->write_program("M52\nF1200\nG1 X20\nG1 X60 Y20\nX200\nM2\n"));
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) > 70; }, 20));
  m->hal("setp motion.adaptive-feed -1");
  m->run_for(1.7);
  for (const char* stop : {"abort", "state estop"}) {
    EXPECT_EQ(m->branch([&] {
      EXPECT_GT(m->motion().vel_mm_s, 15);
      const double x = m->joint(0);
      m->does(stop == std::string("abort") ? std::vector<std::string>{"abort"}
                                           : std::vector<std::string>{"state", "estop"});
      m->run_for(1);
      EXPECT_NEAR(m->joint(0), x, 1) << stop;
      const double stands = m->joint(0);
      m->hal("setp motion.adaptive-feed 1");
      m->run_for(1);
      EXPECT_EQ(m->joint(0), stands) << stop;
    }),
              0);
  }
}

TEST_F(MCode, SavedStateComesBackAndTheProgramStartsAgainFromItsFirstLine) {
  start();
  const std::string program =
      "o<s> sub\nM70\nG20 G91 F5 S300\no<s> endsub\nG21 G90 F200 S2500\nM70\no<s> call\nM72\n"
      "o1 if [#<_metric> NE 1 OR #<_absolute> NE 1 OR #<_feed> NE 200 OR #<_rpm> NE "
      "2500]\n(abort,not restored)\n"
      "o1 endif\nG0 X3\nM30\nG0 X50\n";
  EXPECT_EQ(m->run_text(program).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 3, 1e-9);
  EXPECT_TRUE(m->mdi("G0 X9"));
  EXPECT_TRUE(m->does({"mode", "auto"}));
  EXPECT_TRUE(m->does({"run"}));
  EXPECT_NEAR(m->joint(0), 3, 1e-9);
}

TEST_F(MCode, ProgramEndStopsSpindleAndCoolantAndResetsModes) {
  start();
  EXPECT_EQ(m->run_text("G21 G91 G55 G18 G93\nM3 S500\nM8\nG94 G1 X2 F600\nM2\n").state,
            task::CommandState::done)
      << m->errors();
  EXPECT_FALSE(m->bit("spindle.0.on"));
  EXPECT_FALSE(m->bit("iocontrol.0.coolant-flood"));
  const auto t = m->task();
  EXPECT_EQ(t.g5x_index, 1);
  bool absolute = false;
  bool xy = false;
  for (const int code : t.g_codes) {
    absolute = absolute || code == 900;
    xy = xy || code == 170;
  }
  EXPECT_TRUE(absolute && xy);
}

}  // namespace
}  // namespace kerf::harness
