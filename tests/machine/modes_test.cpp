// Modes do not race, and what outlives the end of a program is declared item by item: docs/modes.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

using task::CommandState;
using task::TaskMode;

std::unique_ptr<Machine> homed_machine(const MachineOptions& options = {}) {
  auto m = Machine::start(options);
  EXPECT_TRUE(m->ready()) << m->errors();
  EXPECT_TRUE(m->power_on_and_home()) << m->errors();
  EXPECT_TRUE(m->mdi("G53 G0 X10 Y10 Z-10")) << m->errors();
  return m;
}

struct Order {
  std::vector<std::string> words;
  bool refused;
};

/// What anybody may ask for while a program runs, and what comes of it.
const std::vector<Order>& orders_beside_a_program() {
  static const std::vector<Order> all{
      {{"mode", "manual"}, true},
      {{"mode", "mdi"}, true},
      {{"mode", "auto"}, false},
      {{"mdi", "G0 X0"}, true},
      {{"mdi", "G0 X0", "in-mode=on"}, true},
      {{"jog", "x", "10"}, true},
      {{"jog", "0", "10", "5"}, true},
      {{"home"}, true},
      {{"unhome"}, true},
      {{"teleop", "on"}, true},
      {{"teleop", "off"}, true},
      {{"motion-mode", "free"}, true},
      {{"run"}, true},
      {{"tool-table"}, true},
      {{"reset-interpreter"}, true},
      {{"spindle", "forward", "speed=100"}, true},
      {{"synch"}, false},
      {{"feed-override", "1"}, false},
      {{"flood", "off"}, false},
      {{"jog-stop"}, false},
  };
  return all;
}

TEST(Modes, SeveralClientsAtOnceChangeNothingOfARunningProgram) {
  auto m = homed_machine();
  const std::string program = m->write_program(
      "G61 G0 X20 Y20 Z-5\nG1 X60 F3000\nY50\nG4 P0.2\nX20\nG2 X40 Y70 I20 J0\nM2\n");
  double time[2]{};
  for (const bool disturbed : {false, true}) {
    ASSERT_TRUE(m->mdi("G53 G0 X10 Y10 Z-10")) << m->errors();
    const auto begin = m->now();
    const auto run = m->start_program(program);
    ASSERT_TRUE(m->run_until([&] { return m->task().current_line > 0; }, 5));
    std::mt19937 random(9);
    std::map<std::uint64_t, const Order*> asked;
    bool wrong_mode = false;
    m->on_cycle([&](const motion::MotionStatus& s) {
      wrong_mode = wrong_mode || s.mode != motion::MotionMode::coordinated || s.jogging;
    });
    const auto& all = orders_beside_a_program();
    while (!task::is_terminal(m->outcome(run).state)) {
      // Four clients ask in the same moment.
      for (int client = 0; disturbed && client < 4; ++client) {
        const Order& order = all[random() % all.size()];
        asked[m->send(order.words)] = &order;
      }
      for (auto n = random() % 20; n < 20; ++n) m->cycle();
      if (!task::is_terminal(m->outcome(run).state) && m->task().current_line > 0) {
        EXPECT_EQ(m->task().mode, TaskMode::automatic);
      }
    }
    m->on_cycle({});
    EXPECT_EQ(m->outcome(run).state, CommandState::done) << m->errors();
    EXPECT_FALSE(wrong_mode);
    EXPECT_NEAR(m->joint(0), 40, 1e-9);
    EXPECT_NEAR(m->joint(1), 70, 1e-9);
    EXPECT_EQ(m->motion().faults, 0U) << m->errors();
    time[disturbed ? 1 : 0] = static_cast<double>(m->now() - begin) * 1e-9;
    m->run_for(0.1);
    std::map<std::string, int> outcomes;
    int last_ones = 0;
    for (const auto& [id, order] : asked) {
      const auto reply = m->outcome(id);
      ASSERT_TRUE(task::is_terminal(reply.state)) << order->words[0] << " has no outcome";
      const std::string what =
          order->words[0] + " " + (order->words.size() > 1 ? order->words[1] : "");
      ++outcomes[what];
      // Those asked in the moment of the end may find the machine idle.
      if ((reply.state != CommandState::done) != order->refused && ++last_ones > 8)
        ADD_FAILURE() << what << ": " << to_string(reply.state) << " " << reply.text;
      if (order->refused && reply.state == CommandState::error) {
        EXPECT_FALSE(reply.text.empty()) << what;
      }
    }
    if (disturbed) {
      EXPECT_GE(outcomes.size(), 15U) << "each was asked";
    }
  }
  EXPECT_NEAR(time[0], time[1], 0.05) << "and it takes as long";
}

TEST(Modes, AStepBeginsNothingWhileTheMachineJogsOrHomes) {
  auto m = homed_machine();
  ASSERT_TRUE(m->does({"open", m->write_program("G0 X20\nG0 X30\nM2\n")}));
  ASSERT_TRUE(m->does({"mode", "manual"}));
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"jog", "y", "10"}, std::vector<std::string>{"home", "-1"}}) {
    m->send(other);
    m->run_for(0.2);
    for (const char* begin : {"step", "run"}) {
      const auto reply = m->command({begin}, 5);
      EXPECT_EQ(reply.state, CommandState::error) << begin;
      EXPECT_NE(reply.text, "");
    }
    EXPECT_EQ(m->task().mode, TaskMode::manual);
    EXPECT_FALSE(m->task().single_step);
    EXPECT_TRUE(m->motion().jogging || m->motion().homing_active) << "it goes on";
    EXPECT_TRUE(m->does({"jog-stop"}));
    EXPECT_TRUE(m->run_until([&] { return m->task().idle; }, 30));
  }
  EXPECT_TRUE(m->does({"step"})) << m->errors();
}

TEST(Modes, MdiFromIdleComesByPolicyAndGoesBackByNobody) {
  auto m = homed_machine();
  ASSERT_TRUE(m->does({"mode", "manual"}));
  EXPECT_TRUE(m->mdi("G0 X20"));
  EXPECT_EQ(m->task().mode, TaskMode::mdi) << "from manual it goes there";
  ASSERT_TRUE(m->does({"mode", "auto"}));
  EXPECT_TRUE(m->mdi("G0 X21"));
  EXPECT_EQ(m->task().mode, TaskMode::automatic) << "idle auto takes it, and stays";
  EXPECT_EQ(m->command({"mdi", "G0 X22", "in-mode=on"}).state, CommandState::error);
  // No MDI beside a jog, no jog beside MDI.
  ASSERT_TRUE(m->does({"mode", "manual"}));
  ASSERT_TRUE(m->does({"jog", "x", "10", "20"})) << m->errors();
  m->run_for(0.2);
  EXPECT_EQ(m->command({"mdi", "G0 Y0"}).state, CommandState::error);
  EXPECT_EQ(m->command({"mode", "mdi"}).state, CommandState::error);
  EXPECT_EQ(m->command({"home"}).state, CommandState::error);
  m->run_for(3);
  const auto line = m->send({"mdi", "G1 Y30 F600"});
  m->run_for(0.3);
  EXPECT_EQ(m->command({"jog", "x", "10", "5"}).state, CommandState::error);
  EXPECT_EQ(m->command({"mode", "manual"}).state, CommandState::error);
  ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(line).state); }, 20));
  EXPECT_EQ(m->outcome(line).state, CommandState::done);
  EXPECT_NEAR(m->joint(0), 41, 1e-6);
}

TEST(Modes, AJogFromIdleTakesItsModesAlong) {
  auto m = homed_machine();
  EXPECT_EQ(m->task().mode, TaskMode::mdi);
  EXPECT_EQ(m->command({"jog", "x", "10", "5", "in-mode=on"}).state, CommandState::error);
  ASSERT_TRUE(m->does({"jog", "x", "10", "5"})) << m->errors();
  EXPECT_EQ(m->task().mode, TaskMode::manual);
  m->run_for(2);
  EXPECT_EQ(m->motion().mode, motion::MotionMode::teleop);
  EXPECT_NEAR(m->joint(0), 15, 1e-6);
  EXPECT_EQ(m->command({"jog", "0", "10", "5", "in-mode=on"}).state, CommandState::error);
  ASSERT_TRUE(m->does({"jog", "0", "10", "5"})) << m->errors();
  EXPECT_EQ(m->command({"jog", "x", "10", "5"}).state, CommandState::error) << "while it moves";
  m->run_for(2);
  EXPECT_EQ(m->motion().mode, motion::MotionMode::free);
  EXPECT_NEAR(m->joint(0), 20, 1e-6);
  ASSERT_TRUE(m->does({"mode", "auto"}));
  ASSERT_TRUE(m->does({"jog", "y", "10", "5"})) << m->errors();
  m->run_for(2);
  EXPECT_NEAR(m->joint(1), 15, 1e-6);
  EXPECT_EQ(m->motion().faults, 0U) << m->errors();
}

TEST(Modes, ALineThatComesBackLeavesTheModeAsItWas) {
  auto m = homed_machine();
  const auto line = [&](const char* x) {
    return m->send({"mdi", std::string("G1 F6000 X") + x, "and-back=on"});
  };
  for (const char* mode : {"manual", "auto", "mdi"}) {
    ASSERT_TRUE(m->does({"mode", mode}));
    const auto before = m->task().mode;
    const auto motion_before = m->motion().mode;
    const auto first = line("30"), second = line("20");
    m->run_for(0.1);
    EXPECT_EQ(m->task().mode, TaskMode::mdi);
    ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(first).state); }, 10));
    EXPECT_EQ(m->task().mode, TaskMode::mdi) << "another one waits";
    ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(second).state); }, 10));
    m->run_for(0.1);
    EXPECT_EQ(m->task().mode, before) << mode;
    EXPECT_EQ(m->motion().mode, motion_before) << mode;
    EXPECT_NEAR(m->joint(0), 20, 1e-9);
  }
  // Joint mode comes back too; somebody's own line keeps MDI mode.
  ASSERT_TRUE(m->does({"teleop", "off"}));
  EXPECT_EQ(m->command({"mdi", "G999", "and-back=on"}).state, CommandState::error);
  m->run_for(0.5);
  EXPECT_EQ(m->task().mode, TaskMode::manual);
  EXPECT_EQ(m->motion().mode, motion::MotionMode::free);
  line("30");
  m->run_for(0.1);
  EXPECT_TRUE(m->mdi("G0 X20"));
  m->run_for(0.5);
  EXPECT_EQ(m->task().mode, TaskMode::mdi);
}

TEST(Modes, TheMdiQueueKeepsOrderIsBoundedAndEndsWithAnAbort) {
  MachineOptions options;
  options.replace = {{"[TASK]\n", "[TASK]\nMDI_QUEUED_COMMANDS = 3\n"}};
  auto m = homed_machine(options);
  std::vector<std::uint64_t> ids;
  for (int i = 1; i <= 6; ++i)
    ids.push_back(m->send({"mdi", "G1 F600 X" + std::to_string(10 + i)}));
  m->run_for(0.5);
  int full = 0;
  for (const auto id : ids)
    full += m->outcome(id).text.find("MDI_QUEUED_COMMANDS = 3") != std::string::npos ? 1 : 0;
  EXPECT_GE(full, 2);
  EXPECT_LE(full, 3);
  ASSERT_TRUE(m->run_until([&] { return m->task().idle; }, 20));
  EXPECT_NEAR(m->joint(0), 16 - full, 1e-9) << "the accepted ones, in order";
  ids.clear();
  for (int i = 1; i <= 3; ++i)
    ids.push_back(m->send({"mdi", "G1 F600 X" + std::to_string(20 + i)}));
  m->run_for(0.3);
  EXPECT_EQ(m->abort().state, CommandState::done);
  const double x = m->joint(0);
  m->run_for(1);
  EXPECT_EQ(m->joint(0), x);
  for (const auto id : ids) EXPECT_EQ(m->outcome(id).state, CommandState::aborted);
}

/// One item of docs/modes.md: what the program sets, and what it is behind the end and behind an abort.
struct Item {
  const char* name;
  const char* set;
  std::function<double(const Machine&)> value;
  double program_end, abort;
};
std::function<double(const Machine&)> code(std::size_t n) {
  return [n](const Machine& m) { return m.task().g_codes[n]; };
}
const std::vector<Item>& items() {
  static const std::vector<Item> all{
      {"motion mode", "G0 X11", code(1), 10, 0},
      {"plane", "G18", code(3), 170, 180},
      {"units", "G20", code(5), 200, 200},
      {"distances", "G91", code(6), 900, 910},
      {"feed mode", "G95", code(7), 940, 950},
      {"work offset", "G55", code(8), 540, 550},
      {"tool offset", "G43 H1", code(9), 430, 430},
      {"retract", "G98", code(10), 980, 980},
      {"path control", "G61", code(11), 610, 610},
      {"spindle mode", "G96 S20 D500", code(13), 970, 960},
      {"centres of arcs", "G90.1", code(14), 901, 901},
      {"F", "F777", [](const Machine& m) { return m.task().settings[1]; }, 0, 777},
      {"S", "S888", [](const Machine& m) { return m.task().settings[2]; }, 888, 888},
      {"spindle", "S500 M3", [](const Machine& m) { return m.motion().spindle[0].on ? 1.0 : 0.0; },
       0, 0},
      {"flood", "M8", [](const Machine& m) { return m.task().flood ? 1.0 : 0.0; }, 0, 0},
      {"mist", "M7", [](const Machine& m) { return m.task().mist ? 1.0 : 0.0; }, 0, 0},
      {"feed override", "M49", [](const Machine& m) { return m.motion().enables.feed ? 1.0 : 0.0; },
       1, 0},
      {"adaptive feed", "M52",
       [](const Machine& m) { return m.motion().enables.adaptive ? 1.0 : 0.0; }, 1, 1},
      {"outputs", "M64 P1",
       [](const Machine& m) { return static_cast<double>(m.motion().digital_out >> 1 & 1U); }, 1,
       1},
      {"analog outputs", "M68 E1 Q4", [](const Machine& m) { return m.motion().analog_out[1]; }, 4,
       4},
      {"G92", "G92 X5", [](const Machine& m) { return m.task().g92_offset.x; }, 5, 5},
      {"tool", "M61 Q2",
       [](const Machine& m) { return static_cast<double>(m.task().tool_in_spindle); }, 2, 2},
  };
  return all;
}

TEST(Modes, EachItemBehindTheEndOfAProgramAndBehindAnAbortIsAsDeclared) {
  auto m = homed_machine();
  // What G92 finds: the machine at 5.
  ASSERT_TRUE(m->mdi("G0 X10"));
  for (const Item& item : items()) {
    for (const bool ends : {true, false}) {
      EXPECT_EQ(m->branch([&] {
        const auto run = m->start_program(
            m->write_program(std::string(item.set) + "\n" + (ends ? "" : "M0\n") + "M2\n"));
        if (!ends) {
          ASSERT_TRUE(m->run_until([&] { return m->task().paused; }, 20)) << m->errors();
          EXPECT_EQ(m->abort().state, CommandState::done);
        }
        ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(run).state); }, 20));
        m->run_for(0.1);
        EXPECT_NEAR(item.value(*m), ends ? item.program_end : item.abort, 1e-9) << m->errors();
      }),
                0)
          << item.name << (ends ? " behind M2" : " behind an abort");
    }
  }
}

constexpr const char* kStartupCode =
    "RS274NGC_STARTUP_CODE = G17 G21 G40 G49 G64 P0.02 G80 G90 G94";

TEST(Modes, TheStartIsAsDeclaredAndTheStartupCodeRunsOnce) {
  MachineOptions options;
  options.replace = {{kStartupCode, "#"}};
  auto m = Machine::start(options);
  ASSERT_TRUE(m->ready()) << m->errors();
  m->run_for(0.1);
  const auto plain = m->task();
  const std::map<int, int> codes{{1, 800}, {3, 170}, {4, 400},  {5, 210},  {6, 900},  {7, 940},
                                 {8, 540}, {9, 490}, {10, 990}, {11, 640}, {13, 970}, {14, 911}};
  for (const auto& [n, value] : codes) EXPECT_EQ(plain.g_codes[n], value) << "code " << n;
  EXPECT_EQ(plain.settings[1], 0);
  EXPECT_EQ(plain.settings[2], 0);
  EXPECT_TRUE(m->motion().enables.feed && m->motion().enables.feed_hold);
  EXPECT_FALSE(m->motion().enables.adaptive);
  EXPECT_EQ(plain.tool_in_spindle, 0);
  options.replace = {{kStartupCode, "RS274NGC_STARTUP_CODE = G18 G20"}};
  m = Machine::start(options);
  ASSERT_TRUE(m->ready() && m->power_on_and_home()) << m->errors();
  EXPECT_EQ(m->task().g_codes[3], 180);
  EXPECT_EQ(m->task().g_codes[5], 200);
  ASSERT_EQ(m->run_text("G4 P0.01\nM2\n").state, CommandState::done);
  EXPECT_EQ(m->task().g_codes[3], 170) << "not run again";
  EXPECT_EQ(m->task().g_codes[5], 200) << "nor taken back";
}

TEST(Modes, AToolOfAnotherLengthGoesOnFromTheLineAndCutsTheSamePath) {
  auto m = homed_machine();
  ASSERT_TRUE(m->mdi("M61 Q1"));
  const std::string path = m->write_program(
      "G61 G43 H1\nG0 X25 Y20 Z-60\nG1 Z-62 F900\nG2 X55 Y20 I15 J0\nG1 X70\nG49\nM2\n");
  const auto run = m->start_program(path);
  ASSERT_TRUE(m->run_until([&] { return m->task().current_line == 4; }, 60)) << m->errors();
  m->run_for(1);
  ASSERT_TRUE(m->does({"away"})) << m->errors();
  ASSERT_TRUE(m->does({"jog", "z", "20", "15"})) << m->errors();
  m->run_for(2);
  EXPECT_EQ(m->abort().state, CommandState::done);
  EXPECT_EQ(m->outcome(run).state, CommandState::aborted);
  ASSERT_TRUE(m->mdi("G10 L1 P1 Z33.5")) << "the new one is measured: " << m->errors();
  double worst = 0;
  bool cut = false;
  m->on_cycle([&](const motion::MotionStatus& s) {
    if (s.current.line < 4 || s.current.line > 5 || s.kind == motion::MotionKind::traverse) return;
    const auto tip = s.pos_cmd - s.tool_offset;
    if (tip.z > -62 + 1e-6) return;  // on the way down
    cut = true;
    const double across =
        tip.x <= 55 && tip.y >= 20 - 1e-9 ? std::hypot(tip.x - 40, tip.y - 20) - 15 : tip.y - 20;
    worst = std::max(
        {worst, std::fabs(s.current.line == 5 ? tip.y - 20 : across), std::fabs(tip.z + 62)});
  });
  const auto again = m->send({"run", "4"});
  ASSERT_TRUE(m->run_until([&] { return task::is_terminal(m->outcome(again).state); }, 120));
  m->on_cycle({});
  EXPECT_EQ(m->outcome(again).state, CommandState::done) << m->errors();
  EXPECT_TRUE(cut);
  EXPECT_LT(worst, 1e-6);
}

}  // namespace
}  // namespace kerf::harness
