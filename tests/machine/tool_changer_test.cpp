// M6, T and M61 on a running machine: a carousel changer with faults at each step, random changers, change positions, the database.
#include <gtest/gtest.h>
#include <unistd.h>
#include <algorithm>
#include <fstream>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

const std::vector<std::string> kCarousel = {
    "unlinkp iocontrol.0.tool-prepared",
    "unlinkp iocontrol.0.tool-changed",
    "loadrt sim_toolchanger names=changer",
    "addf changer servo-thread",
    "setp changer.pockets 8",
    "setp changer.fault-timeout 1",
    "net tool-prepare changer.prepare",
    "net tool-pocket iocontrol.0.tool-prep-pocket changer.prep-pocket",
    "net tool-prepared changer.prepared iocontrol.0.tool-prepared",
    "net tool-change changer.change",
    "net tool-changed changer.changed iocontrol.0.tool-changed",
};

class ToolChanger : public testing::Test {
 protected:
  void start(MachineOptions options = {}, bool carousel = true) {
    if (carousel) options.hal.insert(options.hal.begin(), kCarousel.begin(), kCarousel.end());
    m = Machine::start(options);
    ASSERT_TRUE(m->ready()) << m->errors();
    ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  }
  bool ends(std::uint64_t id, double limit_s) {
    return m->run_until([&] { return task::is_terminal(m->outcome(id).state); }, limit_s);
  }
  bool settles() {
    return m->run_until([&] { return m->task().idle; }, 5);
  }
  int tool() const { return m->task().tool_in_spindle; }
  std::string table() const { return text_of(m->folder() + "/mill.tbl"); }
  static std::string text_of(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// The line of a tool in the table's file begins so.
  void expect_row(const std::string& begin) const {
    EXPECT_NE(("\n" + table()).find("\n" + begin), std::string::npos) << begin << "\n" << table();
  }
  void expect_no_handshake() const {
    EXPECT_FALSE(m->bit("iocontrol.0.tool-prepare") || m->bit("iocontrol.0.tool-change"));
  }
  std::unique_ptr<Machine> m;
};

/// A random changer with its own table: T1 in the spindle, T0 is an empty pocket.
MachineOptions random_changer() {
  MachineOptions o;
  o.replace = {{"TOOL_TABLE = mill.tbl", "RANDOM_TOOLCHANGER = 1\nTOOL_TABLE = random.tbl"}};
  return o;
}

TEST_F(ToolChanger, ACarouselBringsEachTool) {
  start();
  const auto run = m->start_program(
      m->write_program("T2 M6\nG43 H2\nT3\nG1 X20 F600\nM6 T1\nM6 T1\nT0 M6\nT3 M6\nM2\n"));
  EXPECT_TRUE(m->run_until([&] { return tool() == 2; }, 20));
  EXPECT_EQ(m->get("changer.spindle-pocket"), 2);
  EXPECT_EQ(m->get("iocontrol.0.tool-from-pocket"), 2);
  EXPECT_TRUE(m->run_until([&] { return m->joint(0) > 10; }, 20));
  EXPECT_EQ(m->get("iocontrol.0.tool-prep-number"), 3) << "prepared while the program cuts";
  EXPECT_TRUE(ends(run, 120));
  EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
  EXPECT_EQ(tool(), 3);
  EXPECT_EQ(m->get("changer.spindle-pocket"), 3);
  expect_no_handshake();
}

TEST_F(ToolChanger, AThousandChangesWithoutAStop) {
  start({}, false);
  const auto reply = m->run_text(
      "o1 repeat [500]\nT1 M6\no2 if [#5400 NE 1]\n(abort,tool #5400)\no2 endif\nG43 H1\n"
      "G91 G1 X0.01 F6000\nT2 M6\nG43\no3 if [#5400 NE 2]\n(abort,tool #5400)\no3 endif\n"
      "o1 endrepeat\nM2\n");
  EXPECT_EQ(reply.state, task::CommandState::done) << m->errors();
  EXPECT_EQ(tool(), 2);
  expect_no_handshake();
}

TEST_F(ToolChanger, AFaultAtAnyStepWaitsForTheOperatorAndLeavesASafeMachine) {
  start();
  EXPECT_TRUE(m->mdi("T1 M6"));
  for (int step = 1; step <= 8; ++step) {
    for (const bool reports : {true, false}) {
      for (const char* how : {"abort", "estop", "off"}) {
        const int failures = m->branch([&] {
          m->hal("setp changer.fault-step " + std::to_string(step));
          m->hal(std::string("setp changer.report-faults ") + (reports ? "1" : "0"));
          const auto run = m->start_program(m->write_program("M8\nS500 M3\nT3 M6\nG0 X50\nM2\n"));
          m->run_for(20);
          EXPECT_FALSE(task::is_terminal(m->outcome(run).state)) << step;
          EXPECT_EQ(m->bit("changer.fault"), reports);
          EXPECT_FALSE(m->bit("spindle.0.on")) << "M6 has stopped it";
          EXPECT_TRUE(m->bit("iocontrol.0.coolant-flood")) << "M6 leaves it";
          EXPECT_EQ(tool(), 1);
          EXPECT_FALSE(m->task().waiting_for.pin.empty()) << "it says what it waits for";
          if (std::string(how) == "abort")
            m->does({"abort"});
          else
            m->does({"state", how});
          EXPECT_TRUE(settles());
          EXPECT_EQ(m->outcome(run).state, task::CommandState::aborted);
          expect_no_handshake();
          EXPECT_FALSE(m->bit("spindle.0.on") || m->bit("iocontrol.0.coolant-flood"));
          m->hal("setp changer.fault-step 0");
          m->hal("setp changer.reset 1");
          m->run_for(3);
          m->hal("setp changer.reset 0");
          EXPECT_NEAR(m->joint(0), 0, 1e-9) << "nothing behind the M6 has run";
          EXPECT_EQ(tool(), 1);
          EXPECT_TRUE(m->power_on()) << m->errors();
          EXPECT_TRUE(m->mdi("T2 M6")) << m->errors();
          EXPECT_EQ(tool(), 2);
        });
        EXPECT_EQ(failures, 0) << "step " << step << ' ' << reports << ' ' << how;
      }
    }
  }
}

TEST_F(ToolChanger, AbortAtAnyMomentOfAChange) {
  start();
  EXPECT_TRUE(m->mdi("T1 M6"));
  const auto run = m->start_program(m->write_program("T3 M6\nG4 P0.1\nM2\n"));
  int moments = 0;
  while (!task::is_terminal(m->outcome(run).state) && moments < 200) {
    ++moments;
    EXPECT_EQ(m->branch([&] {
      const int before = tool();
      m->does({"abort"});
      EXPECT_TRUE(settles());
      expect_no_handshake();
      EXPECT_TRUE(tool() == before || tool() == 3);
      EXPECT_EQ(tool(), static_cast<int>(m->get("iocontrol.0.tool-number")));
      m->run_for(3);
      EXPECT_TRUE(m->mdi("T2 M6")) << m->errors();
      EXPECT_EQ(tool(), 2);
      EXPECT_EQ(m->get("changer.spindle-pocket"), 2);
    }),
              0)
        << moments;
    m->run_for(0.05);
  }
  EXPECT_GT(moments, 30);
}

TEST_F(ToolChanger, Iov2TellsOfAbortsAndTakesFaults) {
  MachineOptions o;
  o.replace = {
      {"TOOL_TABLE = mill.tbl", "EMCIO = iov2 -support-start-change\nTOOL_TABLE = mill.tbl"},
      {"TASK = milltask", "TASK = milltask\nIO_ERROR = carousel says %d"}};
  o.hal = {"net abort iocontrol.0.emc-abort iocontrol.0.emc-abort-ack",
           "net start iocontrol.0.start-change iocontrol.0.start-change-ack",
           "net fault changer.fault iocontrol.0.toolchanger-fault",
           "net reason changer.reason iocontrol.0.toolchanger-reason"};
  start(o);
  EXPECT_TRUE(m->mdi("T1 M6"));
  EXPECT_EQ(tool(), 1);
  // The carousel jams as it swaps. Its reason is above 0: the program goes on and knows.
  m->hal("setp changer.fault-step 5");
  const std::string program =
      "T2 M6\no1 if [#5600 NE 1 OR #5601 NE 5]\n(abort,#5600 is not set)\no1 endif\n"
      "o2 if [#5400 NE 1]\n(abort,tool #5400)\no2 endif\nG0 X7\nM2\n";
  EXPECT_EQ(m->run_text(program).state, task::CommandState::done) << m->errors();
  EXPECT_NEAR(m->joint(0), 7, 1e-9);
  EXPECT_EQ(tool(), 1);
  EXPECT_NE(m->errors().find("the tool was not changed"), std::string::npos) << m->errors();
  EXPECT_TRUE(m->bit("iocontrol.0.toolchanger-faulted"));
  // Until it is cleared each M6 fails at once.
  m->hal("setp changer.fault-step 0");
  m->hal("setp changer.reset 1");
  m->run_for(3);
  EXPECT_FALSE(m->bit("iocontrol.0.toolchanger-fault-ack"));
  EXPECT_TRUE(m->mdi("T2 M6"));
  EXPECT_EQ(tool(), 1);
  m->hal("setp iocontrol.0.toolchanger-clear-fault 1");
  m->run_for(0.1);
  m->hal("setp iocontrol.0.toolchanger-clear-fault 0");
  m->hal("setp changer.reset 0");
  EXPECT_TRUE(m->mdi("T2 M6")) << m->errors();
  EXPECT_EQ(tool(), 2);
  // Reasons of 0 and below end the program.
  m->hal("unlinkp iocontrol.0.toolchanger-fault");
  m->hal("unlinkp iocontrol.0.toolchanger-reason");
  m->hal("setp iocontrol.0.toolchanger-reason -4");
  m->hal("setp iocontrol.0.toolchanger-fault 1");
  EXPECT_EQ(m->run_text("T3 M6\nG0 X60\nM2\n").state, task::CommandState::error);
  EXPECT_NE(m->errors().find("carousel says -4"), std::string::npos) << m->errors();
  EXPECT_NEAR(m->joint(0), 0, 7.1);
  EXPECT_EQ(tool(), 2);
}

TEST_F(ToolChanger, Iov2BlocksUntilTheAbortIsAcknowledged) {
  MachineOptions o;
  o.replace = {{"TOOL_TABLE = mill.tbl", "EMCIO = iov2\nTOOL_TABLE = mill.tbl"}};
  start(o);
  m->hal("setp iocontrol.0.emc-abort-ack 1");
  m->run_for(0.1);
  m->hal("setp iocontrol.0.emc-abort-ack 0");
  m->send({"mdi", "T1 M6"});
  m->run_for(0.1);
  m->does({"abort"});
  m->run_for(0.1);
  EXPECT_TRUE(m->bit("iocontrol.0.emc-abort"));
  EXPECT_EQ(m->get("iocontrol.0.emc-reason"), 8);
  const auto next = m->send({"mdi", "T2 M6"});
  m->run_for(5);
  EXPECT_FALSE(m->bit("iocontrol.0.tool-prepare"));
  EXPECT_FALSE(task::is_terminal(m->outcome(next).state));
  m->hal("setp iocontrol.0.emc-abort-ack 1");
  EXPECT_TRUE(ends(next, 10));
  EXPECT_EQ(tool(), 2);
}

TEST_F(ToolChanger, ARandomChangerSwapsPocketsAndKnowsThemAfterwards) {
  MachineOptions o = random_changer();
  o.files = {{"random.tbl", "T1 P0 D1 ;first\nT2 P2 D2\nT3 P5 D3\nT0 P4 ;empty\n"}};
  start(o);
  EXPECT_EQ(tool(), 1) << "pocket 0 is the spindle";
  EXPECT_EQ(m->get("iocontrol.0.tool-number"), 1);
  m->send({"mdi", "T3"});
  EXPECT_TRUE(m->run_until([&] { return m->bit("iocontrol.0.tool-prepare"); }, 1));
  EXPECT_EQ(m->get("iocontrol.0.tool-prep-index"), 5) << "its pocket on random changers";
  m->run_for(5);
  EXPECT_TRUE(m->mdi("M6")) << m->errors();
  EXPECT_EQ(tool(), 3);
  const auto row = [&](const std::string& begin) {
    const std::string text = "\n" + text_of(m->folder() + "/random.tbl");
    EXPECT_NE(text.find("\n" + begin + " "), std::string::npos) << begin << text;
  };
  row("T3 P0");
  row("T1 P5");
  row("T2 P2");
  EXPECT_TRUE(m->mdi("M61 Q2"));
  row("T2 P0");
  row("T3 P2");
  EXPECT_EQ(m->command({"mdi", "T9"}).state, task::CommandState::error);
  EXPECT_EQ(tool(), 2);
}

TEST_F(ToolChanger, AnEmptyPocketLeavesTheSpindleEmpty) {
  MachineOptions o = random_changer();
  o.files = {{"random.tbl", "T1 P0 D1\nT2 P2 D2 Z5\nT0 P4 ;empty\n"}};
  start(o);
  EXPECT_TRUE(m->mdi("T2 M6 G43"));
  EXPECT_TRUE(m->mdi("T0 M6")) << m->errors();
  EXPECT_EQ(tool(), 0);
  EXPECT_EQ(m->get("changer.spindle-pocket"), 4)
      << "the arm has brought what is in pocket 4: nothing";
  const std::string text = text_of(m->folder() + "/random.tbl");
  EXPECT_NE(text.find("T0 P0"), std::string::npos) << text;
  EXPECT_NE(text.find("T2 P4"), std::string::npos) << text;
  EXPECT_TRUE(m->mdi("G43"));
  EXPECT_EQ(m->task().tool_offset.z, 0);
  EXPECT_TRUE(m->mdi("T2 M6"));
  EXPECT_EQ(tool(), 2);
  // Without random pockets nobody goes to an empty one but by T0.
  start();
  EXPECT_TRUE(m->mdi("T2 M6 G43"));
  EXPECT_TRUE(m->mdi("T0 M6"));
  EXPECT_EQ(tool(), 0);
  EXPECT_EQ(m->get("iocontrol.0.tool-from-pocket"), 0);
}

TEST_F(ToolChanger, M61ChangesTheNumberAndNothingElse) {
  start();
  EXPECT_TRUE(m->mdi("T3 M6 G43"));
  const double z = m->task().tool_offset.z;
  EXPECT_EQ(m->run_text("M61 Q2\nG0 X3\nM2\n").state, task::CommandState::done) << m->errors();
  EXPECT_EQ(tool(), 2);
  EXPECT_EQ(m->get("iocontrol.0.tool-number"), 2);
  EXPECT_EQ(m->get("changer.spindle-pocket"), 3) << "nobody has moved a tool";
  EXPECT_EQ(m->task().tool_offset.z, z) << "G43 applies the new one";
  EXPECT_TRUE(m->mdi("M61 Q0"));
  EXPECT_EQ(tool(), 0);
  for (const char* bad : {"M61", "M61 Q-1", "M61 Q1.5", "M61 Q77", "T77 M6", "T-1", "T1.5"}) {
    EXPECT_EQ(m->command({"mdi", bad}).state, task::CommandState::error) << bad;
    EXPECT_TRUE(settles());
    EXPECT_EQ(tool(), 0) << bad;
    expect_no_handshake();
  }
}

TEST_F(ToolChanger, TheChangePositionIsReachedBeforeTheHandshake) {
  struct Row {
    const char* keys;
    motion::Pose at;
    bool spindle;
  };
  const Row rows[] = {
      {"", {.x = 30, .y = 20, .z = -10}, false},
      {"TOOL_CHANGE_QUILL_UP = 1", {.x = 30, .y = 20, .z = 0}, false},
      {"TOOL_CHANGE_POSITION = 5 6 -7", {.x = 5, .y = 6, .z = -7}, false},
      {"TOOL_CHANGE_POSITION = 5 6 0\nTOOL_CHANGE_QUILL_UP = 1", {.x = 5, .y = 6, .z = 0}, false},
      {"TOOL_CHANGE_AT_G30 = 1", {.x = 40, .y = 50, .z = -20}, false},
      {"TOOL_CHANGE_AT_G30 = 1\nTOOL_CHANGE_QUILL_UP = 1\nTOOL_CHANGE_WITH_SPINDLE_ON = 1",
       {.x = 40, .y = 50, .z = -20},
       true},
  };
  for (const Row& row : rows) {
    MachineOptions o;
    o.replace = {{"TOOL_CHANGE_POSITION = 0 0 0", row.keys}};
    o.hal = {"unlinkp iocontrol.0.tool-changed"};
    start(o, false);
    EXPECT_TRUE(m->mdi("G0 X40 Y50 Z-20") && m->mdi("G30.1") && m->mdi("G0 X30 Y20 Z-10"));
    EXPECT_TRUE(m->mdi("S800 M3"));
    double highest = -100;
    bool asked = false;
    m->on_cycle([&](const motion::MotionStatus& s) {
      if (!asked) highest = std::max(highest, s.joint[2].pos_cmd);
    });
    const auto run = m->start_program(m->write_program("T1 M6\nG0 X31\nM2\n"));
    EXPECT_TRUE(m->run_until([&] { return m->bit("iocontrol.0.tool-change"); }, 30)) << row.keys;
    asked = true;
    const auto s = m->motion();
    EXPECT_NEAR(s.joint[0].pos_cmd, row.at.x, 1e-9) << row.keys;
    EXPECT_NEAR(s.joint[1].pos_cmd, row.at.y, 1e-9) << row.keys;
    EXPECT_NEAR(s.joint[2].pos_cmd, row.at.z, 1e-9) << row.keys;
    // The path to the change position is rounded by G64 P0.02.
    EXPECT_EQ(highest > -0.02,
              std::string(row.keys).find("QUILL") != std::string::npos || row.at.z == 0)
        << row.keys << highest;
    EXPECT_EQ(m->bit("spindle.0.on"), row.spindle) << row.keys;
    EXPECT_EQ(s.vel_mm_s, 0);
    m->hal("setp iocontrol.0.tool-changed 1");
    EXPECT_TRUE(ends(run, 30));
    EXPECT_EQ(m->outcome(run).state, task::CommandState::done) << m->errors();
    EXPECT_NEAR(m->joint(0), 31, 1e-9);
    EXPECT_NEAR(m->joint(1), row.at.y, 1e-9) << "it does not go back by itself";
  }
}

class ToolDatabaseOnMachine : public ToolChanger {
 protected:
  static MachineOptions with(const std::string& script) {
    MachineOptions o;
    o.replace = {{"TOOL_TABLE = mill.tbl", "DB_PROGRAM = ./db one two\nTOOL_TABLE = mill.tbl"}};
    o.files = {{"db", "#!/bin/sh\n" + script}};
    return o;
  }
  /// The program answers in real time.
  void expect_said(const std::string& text) {
    for (int i = 0; i < 200 && m->errors().find(text) == std::string::npos; ++i) {
      ::usleep(10000);
      m->mdi("G4 P0");
    }
    EXPECT_NE(m->errors().find(text), std::string::npos) << m->errors();
  }
  std::string log() const { return text_of(m->folder() + "/log"); }
  static constexpr const char* kGood =
      "echo v2.1\nwhile read -r cmd; do echo \"$cmd\" >>log\ncase $cmd in\n"
      "g) echo \"T5 P3 Z10 D6 ;$1 $2\"; cat more 2>/dev/null; echo FINI;;\n*) echo ok;;\nesac; "
      "done\n";
};

TEST_F(ToolDatabaseOnMachine, TheProgramGivesTheToolsAndHearsOfEachChange) {
  start(with(kGood));
  EXPECT_EQ(m->command({"mdi", "T1 M6"}).state, task::CommandState::error)
      << "TOOL_TABLE is not read";
  EXPECT_TRUE(settles());
  EXPECT_TRUE(m->mdi("T5 M6")) << m->errors();
  EXPECT_EQ(m->get("iocontrol.0.tool-from-pocket"), 3);
  EXPECT_TRUE(m->mdi("G10 L1 P5 Z12.5"));
  EXPECT_TRUE(m->mdi("T0 M6"));
  EXPECT_TRUE(m->mdi("M61 Q5"));
  std::ofstream(m->folder() + "/more") << "T8 P8 D3\n";
  EXPECT_TRUE(m->mdi("G10 L0")) << m->errors();
  EXPECT_EQ(log(), "g\nl T5 P0\np T5 P3 Z12.5 D6 ;one two\nu T0 P0\nl T5 P0\ng\n");
  EXPECT_TRUE(m->mdi("T8 M6")) << m->errors();
  EXPECT_EQ(tool(), 8);
  EXPECT_TRUE(m->does({"tool-table"}));
  EXPECT_EQ(m->errors().find("DB_PROGRAM"), std::string::npos) << m->errors();
}

TEST_F(ToolDatabaseOnMachine, AProgramThatFailsCostsTheToolsAndNothingElse) {
  struct Row {
    const char* script;
    const char* says;
  };
  for (const Row& row : {Row{"exit 7\n", "exit status 7"}, Row{"echo hello\nsleep 9\n", "'hello'"},
                         Row{"echo v2.1\nread x\nexit 3\n", "exit status 3"},
                         Row{"echo v2.1\nread x\necho T1 Px\necho FINI\nsleep 9\n", "Px"}}) {
    start(with(row.script));
    EXPECT_NE(m->errors().find(row.says), std::string::npos) << row.says << m->errors();
    EXPECT_TRUE(m->mdi("G0 X3"));
    EXPECT_EQ(m->command({"mdi", "T5 M6"}).state, task::CommandState::error);
  }
}

TEST_F(ToolDatabaseOnMachine, AProgramThatDiesOrRefusesIsToldToTheOperator) {
  start(with(
      "echo v2.1\nread x\necho T5 P3\necho FINI\nread x\necho NAK not mine\nread x\nexit 2\n"));
  EXPECT_TRUE(m->mdi("T5 M6"));
  expect_said("NAK not mine");
  EXPECT_TRUE(m->mdi("G10 L1 P5 Z2"));
  expect_said("exit status 2");
  EXPECT_TRUE(m->mdi("T0 M6"));
  EXPECT_EQ(tool(), 0);
  EXPECT_TRUE(m->mdi("G10 L0")) << "it starts again: " << m->errors();
  EXPECT_TRUE(m->mdi("T5 M6")) << m->errors();
}

}  // namespace
}  // namespace kerf::harness
