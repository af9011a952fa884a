// Two commands in the same moment, each pair in both orders: each has an outcome that is true, and the machine is in order behind them.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

using task::CommandState;
using Words = std::vector<std::string>;

std::string text_of(const Words& words) {
  std::string text;
  for (const std::string& w : words) text += (text.empty() ? "" : " ") + w;
  return text;
}

bool ends_others(const Words& w) {
  return w[0] == "abort" || (w[0] == "state" && (w[1] == "off" || w[1] == "estop"));
}

class Pair {
 public:
  Pair(Machine& m, const Words& first, const Words& second, const std::string& from)
      : m_(m), words_{first, second} {
    where_ = from + ": " + text_of(first) + ", then " + text_of(second) + ": ";
  }
  void check() {
    m_.on_cycle([this](const motion::MotionStatus& s) {
      furthest_ = std::max(furthest_, s.joint[0].pos_cmd);
      both_ = both_ || (s.homing_active && !s.path_empty) || (s.jogging && !s.path_empty);
    });
    const std::uint64_t id[2]{m_.send(words_[0]), m_.send(words_[1])};
    const auto ended = [&] {
      return task::is_terminal(m_.outcome(id[0]).state) &&
             task::is_terminal(m_.outcome(id[1]).state);
    };
    // A program that was paused waits for its operator.
    if (!m_.run_until(ended, 12)) m_.does({"abort"});
    EXPECT_TRUE(m_.run_until(ended, 0.5)) << where_ << "no outcome";
    m_.run_for(0.3);
    if (ends_others(words_[1])) stands();
    for (int i = 0; i < 2; ++i) look(words_[i], m_.outcome(id[i]), words_[1 - i]);
    EXPECT_FALSE(both_) << where_ << "the path ran beside a jog or homing";
    m_.does({"jog-stop"});
    EXPECT_TRUE(m_.does({"abort"})) << where_;
    EXPECT_TRUE(m_.run_until([&] { return m_.task().idle; }, 1)) << where_;
    // What is switched off in the moment in which it was asked to home says so; a mode may need what unhome has just taken.
    if (!ends_others(words_[0]) && !ends_others(words_[1]) && !has("unhome")) {
      EXPECT_EQ(m_.motion().faults, 0U) << where_ << m_.errors();
    }
    in_order();
  }

 private:
  [[nodiscard]] bool has(const char* word) const {
    return words_[0][0] == word || words_[1][0] == word;
  }
  void stands() {
    const motion::MotionStatus s = m_.motion();
    EXPECT_TRUE(s.path_empty && !s.homing_active && !s.jogging) << where_;
    m_.run_for(0.1);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(m_.joint(j), s.joint[j].pos_cmd) << where_;
  }
  void look(const Words& words, const task::Reply& reply, const Words& other) {
    const std::string what = where_ + text_of(words) + " -> " + task::to_string(reply.state) + " ";
    if (!has("unhome")) {
      EXPECT_EQ(reply.text.find("did not"), std::string::npos) << what << reply.text;
    }
    if (reply.state == CommandState::error) {
      EXPECT_NE(reply.text, "") << what;
    }
    if (reply.state == CommandState::aborted) {
      EXPECT_TRUE(ends_others(other) || other[0] == "pause" || other[0] == "step")
          << what << reply.text;
    }
    if (reply.state != CommandState::done || ends_others(other)) return;
    if (words[0] == "mdi") {
      EXPECT_GE(furthest_, 30 - 1e-9) << what;
    }
    if (words[0] == "run" && other[0] != "pause") {
      EXPECT_GE(furthest_, 24.95) << what;
    }
    if (words[0] == "home" && words[1] == "-1" && other[0] != "unhome") {
      EXPECT_TRUE(m_.motion().all_homed) << what;
    }
  }
  void in_order() {
    EXPECT_TRUE(m_.task().task_state != task::TaskState::estop || m_.does({"state", "estop-reset"}))
        << where_;
    EXPECT_TRUE(m_.task().task_state == task::TaskState::on || m_.does({"state", "on"})) << where_;
    EXPECT_TRUE(m_.does({"home", "-1"})) << where_ << m_.errors();
    EXPECT_TRUE(m_.mdi("G53 G0 X12 Y12 Z-10", 20)) << where_ << m_.errors();
    EXPECT_NEAR(m_.joint(0), 12, 1e-9) << where_;
  }
  Machine& m_;
  Words words_[2];
  std::string where_;
  double furthest_{0};
  bool both_{false};
};

TEST(SameMoment, EachPairOfCommandsHasTrueOutcomesAndLeavesTheMachineInOrder) {
  const std::vector<Words> commands{{"mdi", "G53 G0 X30"},
                                    {"run"},
                                    {"step"},
                                    {"home", "-1"},
                                    {"home", "0"},
                                    {"unhome", "0"},
                                    {"jog", "x", "10"},
                                    {"jog", "x", "10", "3"},
                                    {"jog", "0", "10"},
                                    {"teleop", "on"},
                                    {"teleop", "off"},
                                    {"mode", "manual"},
                                    {"mode", "auto"},
                                    {"mode", "mdi"},
                                    {"motion-mode", "free"},
                                    {"motion-mode", "coordinated"},
                                    {"spindle", "forward", "speed=500"},
                                    {"pause"},
                                    {"resume"},
                                    {"abort"},
                                    {"state", "off"},
                                    {"state", "estop"}};
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G53 G0 X10 Y10 Z-10")) << m->errors();
  const std::string program = m->write_program("G21 G90 G54\nG0 X25\nG1 X20 F3000\nM2\n");
  ASSERT_TRUE(m->does({"open", program})) << m->errors();
  int failures = 0, pairs = 0;
  for (const Words& from :
       {Words{"mode", "manual"}, Words{"teleop", "off"}, Words{"mode", "auto"}}) {
    ASSERT_TRUE(m->does(from)) << m->errors();
    m->run_for(0.1);
    for (const Words& first : commands)
      for (const Words& second : commands) {
        ++pairs;
        failures += m->branch([&] { Pair(*m, first, second, text_of(from)).check(); }) != 0 ? 1 : 0;
      }
  }
  EXPECT_EQ(failures, 0) << "of " << pairs << " pairs";
  std::printf("[ figures ] two commands in the same moment: %d pairs\n", pairs);
}

}  // namespace
}  // namespace kerf::harness
