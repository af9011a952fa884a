// Remapped codes with functions in Python on a whole machine. A program of its own: Python stays in the process.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScript = "import remap\n";
constexpr const char* kRemap = R"PY(
from interpreter import *
from stdglue import *
import emccanon

def square(self, **words):
    side = words["p"]
    self.execute("G91")
    for move in ("X%f", "Y%f", "X-%f", "Y-%f"):
        self.execute("G0 " + move % side)
    self.execute("G90")
    self.execute("M66 P0 L0")
    yield INTERP_EXECUTE_FINISH
    self.params["_side"] = side
    emccanon.MESSAGE("input %d" % self.params[5399])
    return

def counted_prolog(self, **words):
    self.params["_changes"] = self.params["_changes"] + 1
    if self.selected_tool == 3:
        return "tool 3 stays in its box"
    return INTERP_OK

def fails(self, **words):
    raise ValueError("boom")
)PY";

class PythonRemap : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "kerf_remap_" + std::to_string(::getpid());
    fs::create_directories(dir_);
    write("toplevel.py", kScript);
    write("remap.py", kRemap);
    write("change.ngc", "o<change> sub\nG53 G0 Z0\nG0 X7\nM6\nG43\no<change> endsub\nM2\n");
    MachineOptions o;
    o.append = "[PYTHON]\nTOPLEVEL = " + dir_ + "/toplevel.py\nPATH_PREPEND = " + dir_ + "\n";
    o.replace = {{"SUBROUTINE_PATH = ",
                  "REMAP = M400 modalgroup=10 argspec=P python=square\n"
                  "REMAP = M401 modalgroup=10 python=fails\n"
                  "REMAP = M6 modalgroup=6 prolog=counted_prolog ngc=change\n"
                  "SUBROUTINE_PATH = " +
                      dir_ + ":"},
                 {"TOOL_CHANGE_POSITION = 0 0 0\n", ""}};
    m_ = Machine::start(o);
    ASSERT_TRUE(m_->ready()) << m_->errors();
    ASSERT_TRUE(m_->power_on_and_home()) << m_->errors();
  }
  void TearDown() override {
    m_.reset();
    fs::remove_all(dir_);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ + "/" + name) << text;
  }
  std::string dir_;
  std::unique_ptr<Machine> m_;
};

TEST_F(PythonRemap, MovesReadsAndChangesToolsOnTheMachine) {
  double furthest_x = 0, furthest_y = 0;
  m_->on_cycle([&](const motion::MotionStatus& s) {
    furthest_x = std::max(furthest_x, s.joint[0].pos_cmd);
    furthest_y = std::max(furthest_y, s.joint[1].pos_cmd);
  });
  EXPECT_EQ(m_->run_text("G0 X0 Y0\nM400 P12 G0 Z-1\n(debug,%d side #<_side>)\nM2\n").state,
            task::CommandState::done)
      << m_->errors();
  EXPECT_NEAR(furthest_x, 12, 1e-6);
  EXPECT_NEAR(furthest_y, 12, 1e-6);
  EXPECT_NEAR(m_->joint(2), -1, 1e-6);
  EXPECT_NE(m_->errors().find("input 0"), std::string::npos) << m_->errors();
  EXPECT_NE(m_->errors().find("side 12"), std::string::npos) << m_->errors();

  // The change goes where the body says, with the built-in M6 inside it, and its offset counts.
  EXPECT_EQ(
      m_->run_text("#<_changes>=0\nT2 M6\nG0 Z-40\n(debug,%d tool #5400 changes #<_changes>)\nM2\n")
          .state,
      task::CommandState::done)
      << m_->errors();
  EXPECT_NE(m_->errors().find("tool 2 changes 1"), std::string::npos) << m_->errors();
  EXPECT_NEAR(m_->joint(0), 7, 1e-6);
  EXPECT_NEAR(m_->joint(2), -10, 1e-6) << "30 mm of the tool and -40 of the program";

  // What functions refuse stops the program where it stands.
  const auto refused = m_->run_text("T3 M6\nG0 X50\nM2\n");
  EXPECT_EQ(refused.state, task::CommandState::error) << refused.text;
  EXPECT_NE(m_->errors().find("tool 3 stays in its box"), std::string::npos) << m_->errors();
  m_->run_for(0.2);  // the stop is over
  const auto raised = m_->run_text("M401\nG0 X50\nM2\n");
  EXPECT_EQ(raised.state, task::CommandState::error);
  EXPECT_NE(m_->errors().find("boom"), std::string::npos) << raised.text << m_->errors();
  EXPECT_NEAR(m_->joint(0), 7, 1e-6);
  m_->run_for(0.2);
  EXPECT_TRUE(m_->mdi("G0 X1"));
  // A limit is an error of the program's line, though the machine still stands at the end of the body.
  EXPECT_EQ(m_->run_text("G0 X0\nT1 M6\nG0 Z5\nM2\n").state, task::CommandState::error);
  EXPECT_NE(m_->errors().find("test.ngc:3: Move would take axis Z"), std::string::npos)
      << m_->errors();
}

TEST_F(PythonRemap, AnAbortAtAnyMomentOfAChangeLeavesNothingOfIt) {
  const std::string program = m_->write_program(
      "#<_changes>=0\nT1 M6\nS600 M3\nT2 M6\nM62 P1\nM400 P2\nG0 X20\nM64 P2\nM2\n");
  int cases = 0;
  bool ended = false;
  // No branches: Python has a thread of its own, which a fork leaves behind.
  for (int n = 0; !ended && !HasFailure(); n += 37, ++cases) {
    const std::string where = "cycle " + std::to_string(n) + ": ";
    ASSERT_TRUE(m_->mdi("#<_changes>=0 M65 P1")) << m_->errors();
    ASSERT_TRUE(m_->mdi("M65 P2")) << m_->errors();
    ASSERT_TRUE(m_->mdi("G53 G0 X0 Y0")) << m_->errors();
    const auto run = m_->start_program(program);
    for (int i = 0; i < n; ++i) m_->cycle();
    ended = task::is_terminal(m_->outcome(run).state);
    EXPECT_EQ(m_->abort().state, task::CommandState::done) << where;
    const auto at = m_->motion();
    m_->run_for(0.5);
    const auto later = m_->motion();
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_EQ(later.joint[j].pos_cmd, at.joint[j].pos_cmd) << where << "it moves on";
    EXPECT_EQ(later.digital_out, at.digital_out) << where;
    EXPECT_FALSE(later.spindle[0].on) << where;
    EXPECT_TRUE(m_->task().idle) << where;
    EXPECT_EQ(m_->task().call_level, 0) << where;
    EXPECT_TRUE(m_->mdi(m_->line_to_shown_place())) << where << m_->errors();
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(m_->joint(j), at.joint[j].pos_cmd, 1e-9) << where;
    // Another tool than the one that may have been on its way, by MDI; then the whole program, from its top.
    EXPECT_TRUE(m_->mdi("T1 M6")) << where << m_->errors();
    EXPECT_EQ(m_->task().tool_in_spindle, 1) << where;
    EXPECT_NEAR(m_->joint(0), 7, 1e-6) << where << "the body of the remapped M6 has run";
    EXPECT_EQ(m_->run_program(program).state, task::CommandState::done) << where << m_->errors();
    EXPECT_EQ(m_->task().tool_in_spindle, 2) << where;
    EXPECT_NEAR(m_->joint(0), 20, 1e-6) << where;
  }
  EXPECT_TRUE(ended || HasFailure());
  EXPECT_GT(cases, 10);
  std::printf("[ figures ] abort in a remapped tool change: %d moments\n", cases);
}

}  // namespace
}  // namespace kerf::harness
