// A tool of another length in the middle of a held path: its tip goes on along the path as if nothing had happened.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

using Tip = std::array<double, 3>;

Tip tip_of(const motion::MotionStatus& s) {
  const rtapi::Pose p = s.pos_cmd - s.tool_offset;
  return {p.x, p.y, p.z};
}

double distance_to_segment(const Tip& p, const Tip& a, const Tip& b) {
  double length2 = 0, along = 0, off2 = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
    along += (p[i] - a[i]) * (b[i] - a[i]);
  }
  const double t = length2 > 0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d = p[i] - (a[i] + t * (b[i] - a[i]));
    off2 += d * d;
  }
  return std::sqrt(off2);
}

/// How far the points of a path are from the line through those of another, both in order.
double deviation(const std::vector<Tip>& path, const std::vector<Tip>& reference) {
  double worst = 0;
  std::size_t at = 0;
  for (const Tip& p : path) {
    double best = 1e9;
    std::size_t best_at = at;
    for (std::size_t k = at; k + 1 < reference.size() && (path.data() == &p || k < at + 800); ++k) {
      const double d = distance_to_segment(p, reference[k], reference[k + 1]);
      if (d < best) best = d, best_at = k;
    }
    at = best_at;
    worst = std::max(worst, best);
  }
  return worst;
}

class ToolExchange : public testing::Test {
 protected:
  static constexpr const char* kBegin =
      "G21 G90 G17 G40 G64 P0.05 Q0 S900 M3\nG43 H1\nG0 X25 Y20 Z-70\n";

  void SetUp() override {
    m = Machine::start();
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
    ASSERT_TRUE(m->mdi("G10 L1 P1 Z50 R3")) << m->errors();
    ASSERT_TRUE(m->mdi("G10 L1 P2 Z57.25 R3")) << m->errors();
    ASSERT_TRUE(m->mdi("M61 Q1")) << m->errors();
  }
  void start(const std::string& rest) {
    run = m->start_program(m->write_program(kBegin + rest + "M5\nM2\n"));
  }
  /// The whole program without a pause.
  std::vector<Tip> reference(const std::string& rest) {
    std::vector<Tip> out;
    const std::string file = m->folder() + "/reference.txt";
    EXPECT_EQ(m->branch([&] {
      std::ofstream to(file);
      to.precision(17);
      // So slowly that the chords between its cycles are the path.
      EXPECT_TRUE(m->does({"feed-override", "0.05"}) && m->does({"rapid-override", "0.05"}));
      Tip last{};
      m->on_cycle([&](const motion::MotionStatus& s) {
        const Tip p = tip_of(s);
        if (s.current.line >= 3 && p != std::exchange(last, p))
          to << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
      });
      start(rest);
      EXPECT_TRUE(ends()) << m->errors();
    }),
              0);
    std::ifstream in(file);
    for (Tip p; in >> p[0] >> p[1] >> p[2];) out.push_back(p);
    return out;
  }
  bool ends() {
    return m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 1200) &&
           m->outcome(run).state == task::CommandState::done;
  }
  bool leave_at(const std::function<bool()>& here) {
    return m->run_until(here, 60) && m->does({"away"}) && m->does({"jog", "z", "20", "15"}) &&
           m->run_until([&] { return !m->motion().jogging; }, 10);
  }
  /// Joints keep their limits; the tip is noted.
  std::vector<Tip> go_on() {
    std::vector<Tip> path;
    m->on_cycle([&](const motion::MotionStatus& s) { path.push_back(tip_of(s)); });
    EXPECT_TRUE(m->does({"resume"})) << m->errors();
    EXPECT_TRUE(ends()) << m->outcome(run).text << m->errors();
    EXPECT_EQ(m->motion().faults, 0U) << m->errors();
    return path;
  }
  task::Reply refused(const std::vector<std::string>& words = {"exchange-tool", "2"}) {
    const auto before = m->motion().place;
    auto reply = m->command(words);
    EXPECT_EQ(reply.state, task::CommandState::error);
    EXPECT_EQ(m->motion().path_shift, rtapi::Pose{});
    EXPECT_EQ(m->motion().place, before);
    return reply;
  }
  std::unique_ptr<Machine> m;
  std::uint64_t run{0};
};

constexpr const char* kArcs =
    "G1 Z-75 F900\nG2 X55 Y20 I15 J0\nG1 X70\nG1 Y35\nG3 X60 Y45 I-10 J0\nG1 X40 F1200\n";

TEST_F(ToolExchange, WhatTheOldToolHasCutIsNotDrivenBackOverWithTheNew) {
  // With 7.25 mm more the machine would be 5.25 mm above the limit of Z in line 5.
  start("G1 Z-52 F900\nX60\nZ-70\nY60\nX30\nY30\n");
  ASSERT_TRUE(leave_at([&] { return m->task().current_line == 7 && m->joint(1) > 40; }))
      << m->errors();
  ASSERT_TRUE(m->does({"exchange-tool", "2"}) && m->does({"return"})) << m->errors();
  const auto turn = [&](const char* way) {
    EXPECT_TRUE(m->does({"pause"}) && m->run_until([&] { return m->motion().held; }, 10));
    EXPECT_TRUE(m->does({"direction", way}) && m->does({"resume"})) << m->errors();
  };
  // In the very move: nothing of it was cut with the new tool when it was exchanged.
  const double y = m->joint(1);
  ASSERT_TRUE(m->does({"resume"})) << m->errors();
  m->run_for(0.3);
  turn("reverse");
  m->run_for(3);
  EXPECT_GT(m->joint(1), y);
  turn("forward");
  ASSERT_TRUE(m->run_until([&] { return m->joint(0) < 50; }, 60)) << m->errors();
  turn("reverse");
  m->run_for(10);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  // Back to where the first whole move began, which is in the corner.
  EXPECT_NEAR(m->joint(0), 60, 0.3);
  EXPECT_NEAR(m->joint(1), 60, 0.3);
  turn("forward");
  EXPECT_TRUE(ends()) << m->errors();
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST_F(ToolExchange, OnAWayBackNoToolIsExchanged) {
  start("G1 Z-75 F900\nX60\nY60\nX30\n");
  ASSERT_TRUE(m->run_until([&] { return m->task().current_line == 6 && m->joint(1) > 40; }, 60));
  ASSERT_TRUE(m->does({"pause"}) && m->does({"direction", "reverse"}) && m->does({"resume"}));
  ASSERT_TRUE(leave_at([&] { return m->joint(1) < 30; })) << m->errors();
  EXPECT_NE(refused().text.find("back"), std::string::npos);
  ASSERT_TRUE(m->does({"return"}) && m->does({"direction", "forward"})) << m->errors();
  (void)go_on();
}

TEST_F(ToolExchange, MidArcTheTipGoesOnAlongThePath) {
  const auto whole = reference(kArcs);
  ASSERT_GT(whole.size(), 1000U);
  start(kArcs);
  ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.x > 33 && m->task().current_line == 5; }))
      << m->errors();
  const auto place = m->motion().place;
  ASSERT_TRUE(m->does({"jog", "x", "30", "25"})) << m->errors();
  m->run_for(2);
  ASSERT_TRUE(m->does({"exchange-tool", "2"})) << m->errors();
  EXPECT_NEAR(m->motion().place.z, place.z + 7.25, 1e-9);
  EXPECT_NEAR(m->motion().tool_offset.z, 57.25, 1e-9);
  EXPECT_NEAR(m->task().tool_offset.z, 57.25, 1e-9);
  m->run_for(0.1);
  EXPECT_EQ(m->task().tool_in_spindle, 2);
  EXPECT_EQ(m->command({"resume"}).state, task::CommandState::error) << "return first";
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_NEAR(m->joint(2), place.z + 7.25, 1e-7);
  const auto rest = go_on();
  ASSERT_GT(rest.size(), 500U);
  const double worst = deviation(rest, whole);
  RecordProperty("deviation_mm", std::to_string(worst));
  std::printf(
      "[ figures ] mid arc: the tip is at most %.3g mm beside the uninterrupted path, %zu cycles\n",
      worst, rest.size());
  EXPECT_LT(worst, 1e-6);
  EXPECT_NEAR(m->joint(0), 40, 1e-9);
  EXPECT_NEAR(m->joint(2), -75 + 57.25, 1e-9);
  // What comes later is about the new tool alone.
  EXPECT_EQ(m->motion().path_shift.z, 7.25);
  ASSERT_TRUE(m->mdi(m->line_to_shown_place())) << m->errors();
  EXPECT_EQ(m->motion().path_shift, rtapi::Pose{});
  EXPECT_NEAR(m->joint(2), -75 + 57.25, 1e-9);
  ASSERT_TRUE(m->mdi("G0 Z-70")) << m->errors();
  EXPECT_NEAR(m->joint(2), -70 + 57.25, 1e-9);
  ASSERT_TRUE(m->mdi("G49")) << m->errors();
  ASSERT_TRUE(m->mdi("G0 Z-5")) << m->errors();
  EXPECT_NEAR(m->joint(2), -5, 1e-9);
}

TEST_F(ToolExchange, InABlend) {
  const std::string rest = "G1 Z-75 F900\nG1 X40 Y20\nG1 X40 Y25\nG1 X50 Y25\n";
  const auto whole = reference(rest);
  start(rest);
  // The blend of the corner at X40 Y20 leaves both lines.
  ASSERT_TRUE(leave_at([&] {
    const auto p = m->motion().pos_cmd;
    return p.y > 20.001 && p.x < 39.9999;
  })) << m->errors();
  ASSERT_TRUE(m->does({"exchange-tool", "2"})) << m->errors();
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  const double worst = deviation(go_on(), whole);
  std::printf("[ figures ] in a blend: the tip is at most %.3g mm beside the uninterrupted path\n",
              worst);
  EXPECT_LT(worst, 1e-6);
}

/// What is read only later goes the same way, and what it says of offsets and of the machine's places is about the new tool.
TEST_F(ToolExchange, WithMostOfTheProgramStillUnread) {
  std::string rest = "G1 Z-75 F900\nG1 X40 Y20\nG1 X40 Y40\n";
  for (int n = 0; n < 8000; ++n)
    rest += "G1 X" + std::to_string(40 + 5 * std::sin(n * 0.02)) + " Y" +
            std::to_string(40 - n * 0.004) + " F6000\n";
  rest += "G43 H2\nG1 Z-74\nG1 X20\nG49\nG53 G0 Z0\nG43 H2\nG1 Z-70\n";
  ASSERT_TRUE(m->mdi("G10 L1 P2 Z44.5 R3"));
  const auto tips = [&](bool exchange) {
    const std::string file = m->folder() + "/tips.txt";
    EXPECT_EQ(m->branch([&] {
      start(rest);
      ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.y > 39; })) << m->errors();
      if (exchange) {
        ASSERT_TRUE(m->does({"exchange-tool", "2"})) << m->errors();
      }
      ASSERT_TRUE(m->does({"return"})) << m->errors();
      std::ofstream to(file);
      to.precision(17);
      for (const Tip& p : go_on()) to << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
      EXPECT_NEAR(m->joint(2), -70 + 44.5, 1e-9);
    }),
              0);
    std::vector<Tip> out;
    std::ifstream in(file);
    for (Tip p; in >> p[0] >> p[1] >> p[2];) out.push_back(p);
    // G43 H2 changes the tool offset of the old tool, not that of the new one.
    out.erase(std::find_if(out.begin(), out.end(), [](const Tip& p) { return p[2] > -75 + 1e-6; }),
              out.end());
    return out;
  };
  const auto with = tips(true), without = tips(false);
  ASSERT_GT(with.size(), 5000U);
  double worst = 0;
  // The very end is another move: the old tool has 5.5 mm to go for G43 H2.
  for (std::size_t n = 0; n + 200 < std::min(with.size(), without.size()); ++n)
    for (std::size_t i = 0; i < 3; ++i)
      worst = std::max(worst, std::fabs(with[n][i] - without[n][i]));
  std::printf("[ figures ] 8000 lines, cycle by cycle beside the old tool: %.3g mm, %zu cycles\n",
              worst, with.size());
  EXPECT_LT(worst, 1e-6);
}

TEST_F(ToolExchange, TwiceAndBackToTheFirst) {
  const auto whole = reference(kArcs);
  start(kArcs);
  ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.x > 33 && m->task().current_line == 5; }));
  ASSERT_TRUE(m->does({"exchange-tool", "2"})) << m->errors();
  m->run_for(0.1);
  ASSERT_TRUE(m->does({"exchange-tool", "1"})) << m->errors();
  EXPECT_EQ(m->motion().path_shift, rtapi::Pose{});
  m->run_for(0.1);
  ASSERT_TRUE(m->does({"exchange-tool", "2"})) << m->errors();
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_LT(deviation(go_on(), whole), 1e-6);
}

/// The same number with its new length in the file of the table.
TEST_F(ToolExchange, TheTableIsReadAgain) {
  const auto whole = reference(kArcs);
  start(kArcs);
  ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.x > 33 && m->task().current_line == 5; }));
  std::ofstream(m->folder() + "/mill.tbl") << "T1 P1 Z48.125 D6\nT2 P2 Z57.25 D6\n";
  ASSERT_TRUE(m->does({"exchange-tool"})) << m->errors();
  EXPECT_NEAR(m->motion().path_shift.z, -1.875, 1e-9);
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_LT(deviation(go_on(), whole), 1e-6);
  EXPECT_EQ(m->task().tool_in_spindle, 1);
}

TEST_F(ToolExchange, AnAbortAtAnyCycleShowsWhatIsApplied) {
  start(kArcs);
  ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.x > 33 && m->task().current_line == 5; }));
  const auto exchange = m->send({"exchange-tool", "2"});
  const auto check = [&] {
    EXPECT_EQ(m->abort().state, task::CommandState::done);
    const auto at = m->motion().pos_cmd;
    EXPECT_EQ(m->motion().path_shift, rtapi::Pose{});
    EXPECT_EQ(m->motion().tool_offset, m->task().tool_offset);
    EXPECT_TRUE(m->mdi(m->line_to_shown_place())) << m->errors();
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(m->joint(j), at[j], 1e-9) << j;
    EXPECT_FALSE(m->bit("spindle.0.on"));
    EXPECT_EQ(m->motion().faults, 0U) << m->errors();
  };
  for (int n = 0; n < 12; ++n) {
    EXPECT_EQ(m->branch(check), 0) << n;
    m->cycle();
  }
  EXPECT_EQ(m->outcome(exchange).state, task::CommandState::done);
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  ASSERT_TRUE(m->does({"resume"})) << m->errors();
  for (int n = 0; n < 1200; ++n) {
    if (n % 97 == 5) {
      EXPECT_EQ(m->branch(check), 0) << n;
    }
    m->cycle();
  }
}

TEST_F(ToolExchange, RefusedWithTheReason) {
  start(kArcs);
  EXPECT_NE(refused().text.find("away first"), std::string::npos);
  ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.x > 33 && m->task().current_line == 5; }));
  EXPECT_NE(refused({"exchange-tool", "99"}).text.find("tool 99 is not in the tool table"),
            std::string::npos);
  EXPECT_NE(refused({"exchange-tool", "0"}).text.find("number of a tool"), std::string::npos);
  // A limit: place Z -25, with a tool that is 30 mm longer above 0.
  std::ofstream(m->folder() + "/mill.tbl") << "T1 P1 Z50 D6\nT2 P2 Z99 D6\n";
  const auto reply = refused();
  EXPECT_NE(reply.text.find("beyond its limit of"), std::string::npos) << reply.text;
  std::ofstream(m->folder() + "/mill.tbl") << "T1 P1 Z50 D6\nT2 P2 Z57 D6\n";
  EXPECT_TRUE(m->does({"exchange-tool", "2"})) << m->errors();
}

TEST_F(ToolExchange, RefusedByWhatIsReadAlready) {
  struct Row {
    const char* rest;
    const char* why;
  };
  const Row rows[]{
      {"G1 Z-75 F900\nG1 X60\nG53 G0 Z0\n", "line 6 goes to a place in machine coordinates"},
      {"G1 Z-75 F900\nG1 X60\nG28 Z-70\n", "line 6 goes to a place in machine coordinates"},
      {"G1 Z-75 F900\nG1 X60\nG49\n", "line 6 changes the tool or its offset"},
      {"G1 Z-75 F900\nG1 X60\nG43 H2\n", "line 6 changes the tool or its offset"},
      {"G49\nG1 Z-20 F900\nG1 X60\n", "no tool length offset is in force (G49)"},
      {"G43.1 Z50\nG1 Z-75 F900\nG1 X60\n", "sets the tool length offset itself"},
      {"G43 H2\nG1 Z-75 F900\nG1 X60\n", "is not that of tool 1 in the spindle"},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(m->branch([&] {
      start(row.rest);
      ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.x > 40; })) << m->errors();
      const auto reply = refused({"exchange-tool", "2"});
      EXPECT_NE(reply.text.find(row.why), std::string::npos) << reply.text;
      EXPECT_NE(reply.text.find("run LINE"), std::string::npos) << reply.text;
      // Nothing has changed: the path goes on with the old tool.
      EXPECT_TRUE(m->does({"return"}) && m->does({"resume"})) << m->errors();
      EXPECT_TRUE(ends()) << m->errors();
    }),
              0)
        << row.rest;
  }
}

TEST_F(ToolExchange, UnderCompensationOnlyWithTheSameDiameter) {
  const std::string rest =
      "G41\nG1 X25 Y24 F900\nG1 Y40 Z-75\nG1 X60\nG1 Y10\nG1 X30\nG40\nG1 X20 Y5\n";
  ASSERT_TRUE(m->mdi("G10 L1 P3 Z57.25 R2")) << m->errors();
  const auto whole = reference(rest);
  start(rest);
  ASSERT_TRUE(leave_at([&] { return m->motion().pos_cmd.x > 40; })) << m->errors();
  const auto reply = refused({"exchange-tool", "3"});
  EXPECT_NE(reply.text.find("with cutter compensation"), std::string::npos) << reply.text;
  EXPECT_NE(reply.text.find("6 mm"), std::string::npos) << reply.text;
  ASSERT_TRUE(m->does({"exchange-tool", "2"})) << m->errors();
  ASSERT_TRUE(m->does({"return"})) << m->errors();
  EXPECT_LT(deviation(go_on(), whole), 1e-6);
}

}  // namespace
}  // namespace kerf::harness
