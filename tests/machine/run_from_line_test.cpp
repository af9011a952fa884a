// Run from line: right, or refused with a documented reason.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

std::unique_ptr<Machine> homed_machine() {
  auto m = Machine::start();
  EXPECT_TRUE(m->ready()) << m->errors();
  EXPECT_TRUE(m->power_on_and_home()) << m->errors();
  // Programs do not begin at a limit.
  EXPECT_TRUE(m->mdi("G53 G0 X10 Y10 Z-10")) << m->errors();
  return m;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// All that a line of G-code can find, as text: so that a difference reads well.
std::string state_of(const Machine& m) {
  const auto t = m.task();
  const auto s = m.motion();
  std::ostringstream out;
  out.precision(9);
  for (int i = 1; i < 17; ++i) out << "G" << i << "=" << t.g_codes[i] << ' ';
  // What M0 itself leaves is no part of it.
  for (int i = 2; i < 10; ++i)
    if (i != 3) out << "M" << i << "=" << t.m_codes[i] << ' ';
  for (int i = 1; i < 5; ++i) out << "S" << i << "=" << t.settings[i] << ' ';
  const auto pose = [&](const char* name, const rtapi::Pose& p) {
    out << '\n' << name;
    for (std::size_t a = 0; a < 3; ++a) out << ' ' << std::round(p[a] * 1e6) / 1e6 + 0.0;
  };
  pose("g5x", t.g5x_offset);
  pose("g92", t.g92_offset);
  pose("tool offset", t.tool_offset);
  pose("applied tool offset", s.tool_offset);
  pose("position", s.pos_cmd);
  out << "\nrotation " << t.rotation_deg << " tool " << t.tool_in_spindle << " prepared "
      << t.tool_prepped << " flood " << t.flood << " mist " << t.mist << "\nspindle "
      << s.spindle[0].on << ' ' << (s.spindle[0].on ? s.spindle[0].speed_rpm : 0) << " outputs "
      << s.digital_out << ' ' << s.analog_out[0] << ' ' << s.analog_out[1] << "\noverrides "
      << s.enables.feed << s.enables.spindle[0] << s.enables.adaptive << s.enables.feed_hold;
  return out.str();
}

bool runs_to_pause(Machine& m, std::uint64_t id) {
  return m.run_until(
             [&] {
               return task::is_terminal(m.outcome(id).state) ||
                      (m.task().paused && m.task().interp_state == task::InterpState::paused);
             },
             600) &&
         !task::is_terminal(m.outcome(id).state);
}

struct Program {
  const char* name;
  const char* text;
  int refused;  ///< so many of its lines
};

constexpr Program kPrograms[] = {
    {"lines",
     "G21 G90 G94 G17\nF600\nG0 X20 Y20 Z-5\nG1 Z-8\nG1 X30\nG1 Y30\n\n(a remark)\nG0 Z-5\nM2\n",
     0},
    {"spindle_coolant",
     "S800 M3\nM8\nG0 X20 Y20\nG1 Z-12 F400\nS1200\nG1 X25\nM7\nM9\nM4 S500\nG1 X20\nM5\nG0 "
     "Z-5\nM2\n",
     0},
    {"tools",
     "T1 M6\nG43 H1\nG0 X20 Y20 Z-60\nG1 X22 F500\nT2\nG1 X24\nM6\nG43\nG1 X26\nG49\nM61 Q3\nG1 "
     "X28\nT0 M6\nM2\n",
     0},
    {"offsets",
     "G10 L2 P2 X30 Y30 Z-20\nG55\nG0 X0 Y0 Z5\nG92 X10\nG1 X12 F300\nG92.2\nG92.3\nG1 "
     "Y3\nG92.1\nG54\nG10 L2 P1 R30\nG0 X20 Y15\nG10 L2 P1 R0\nM2\n",
     0},
    {"inches",
     "G20\nF20\nG1 X1 Y1 Z-.5\nG91\nG1 X.1\nG90\nG21\nG1 X30\nG20 G61.1\nG1 X1\nG64 P.001 "
     "Q.0005\nG1 Y1.1\nM2\n",
     0},
    {"arcs",
     "G17 F900\nG0 X30 Y30 Z-10\nG2 X40 Y30 I5 J0\nG3 X30 Y30 R5 P2\nG18\nG2 X40 Z-10 I5 "
     "K0\nG19\nG90.1\nG17\nG2 X50 Y30 I45 J30\nG91.1\nG0 X20\nM2\n",
     0},
    {"cycles",
     "G0 X20 Y20 Z-5\nF300\nG98 G81 X20 Y20 Z-12 R-8\nX25\nG99 Y25\nG83 X30 Y30 Z-14 R-9 "
     "Q2\nX32\nG80\nG91 G81 X2 Y1 Z-3 R-1 L3\nG90 G80\nG0 Z-5\nM2\n",
     0},
    {"loops",
     "G0 X20 Y20 Z-5\nF900\n#1=0\no100 while [#1 LT 3]\n  G1 X[20+#1]\n  #1=[#1+1]\no100 "
     "endwhile\nG1 Y[20+#1]\no101 repeat [2]\n  G91 G1 X1\no101 endrepeat\nG90\nG1 Z-6\nM2\n",
     5},
    {"subs",
     "o<cut> sub\n  G1 X[#1] F800\n  #<_deep>=#1\no<cut> endsub\nG0 X20 Y20 Z-5\no<cut> call "
     "[25]\nG1 Y[#<_deep>]\no<cut> call [30]\nG1 Z-6\nM2\n",
     3},
    {"branches",
     "#2=7\no10 if [#2 EQ 7]\n  G0 X20 Y20\n  G1 Z-12 F400\no10 else\n  G0 X30\no10 endif\nG1 "
     "X22\no11 if [#2 EQ 8]\n  G0 X50\no11 elseif [#2 EQ 7]\n  M8\no11 endif\nG1 Y22\nM2\n",
     4},
    {"outputs",
     "M64 P0\nG0 X20\nM62 P1\nM67 E1 Q2.5\nG1 X22 F300\nM63 P1\nG4 P.1\nG1 X24\nM65 P0\nM68 E0 "
     "Q7\nG0 Z-5\nM2\n",
     0},
    {"states", "G20 F10\nM70\nG21 F500\nG1 X30\nM72\nG1 X1\nM73\nG61\nG1 Y1\nM71\nM2\n", 0},
    {"overrides",
     "M49\nF300\nG1 X20\nM48\nG1 X21\nM50 P0\nM52 P0\nM53 P1\nM51 P0\nG1 X22\nM51 P1\nM50 P1\nM2\n",
     0},
    {"compensation",
     "T1 M6\nG0 X20 Y20 Z-5\nF600\nG41 D1\nG1 X30 Y25\nG1 X50\nG1 Y50\nG40\nG1 X60 Y60\nG0 "
     "Z-4\nM2\n",
     5},
    {"probe", "G0 X20 Y20 Z-5\nF300\nG38.3 Z-15\nG10 L20 P1 Z0\nG0 Z5\nM2\n", 3},
    {"input", "G0 X20\nM66 P0 L0\nG1 X25 F300\n#3=#5399\nG1 X[26+#3]\nM2\n", 2},
    {"feed_modes",
     "S600 M3\nG95 F.5\nG0 X20 Y20 Z-5\nG1 X22\nG94 F300\nG1 X24\nG93\nG1 X26 F20\nG94 F200\nG1 "
     "X28\nG96 S30 D900\nG1 X32\nG97 S500\nG1 X34\nM5\nM2\n",
     0},
    {"splines",
     "G0 X20 Y20 Z-5 F500\nG5 I0 J3 P0 Q-3 X21 Y26\nG5 P0 Q-3 X22 Y32\nG5.2 P1 L3\nX24 Y34 P1\nX28 "
     "Y30 P1\nX30 Y36 P1\nG5.3\nG1 X20\nM2\n",
     4},
    {"homes",
     "G28.1\nG0 X40 Y40 Z-15\nG30.1\nG0 X20\nG28 Z-5\nG30\nG53 G0 X15\nG1 X20 F400\nG52 X3\nG1 "
     "X20\nG52 X0\nM2\n",
     0},
    {"stops", "/G0 X20\nG0 X22\nM1\n/G1 X25 F200\nN100 G1 X27 F250\nM0\nG0 X20\nM2\n", 0},
};

class RunFromLine : public testing::TestWithParam<Program> {};

TEST_P(RunFromLine, EachLineFindsTheStateOfAFullRunOrIsRefused) {
  auto m = homed_machine();
  const auto lines = lines_of(GetParam().text);
  const std::string path = m->write_program(GetParam().text);
  int refused = 0;
  std::string refusals;
  for (std::size_t n = 1; n <= lines.size(); ++n) {
    // The reference stops at an M0 in front of the line.
    std::string stopped_text;
    for (std::size_t i = 0; i < lines.size(); ++i)
      stopped_text += (i + 1 == n ? "M0\n" : "") + lines[i] + "\n";
    // A branch cannot give text back: the file in the machine's folder does.
    const std::string stopped = m->write_program(stopped_text, "stopped.ngc");
    const std::string wanted_file = m->folder() + "/wanted.txt";
    const auto put = [](const std::string& file, const std::string& text) {
      std::FILE* f = std::fopen(file.c_str(), "w");
      std::fputs(text.c_str(), f);
      std::fclose(f);
    };
    const auto read = [](const std::string& file) {
      std::string text;
      if (std::FILE* f = std::fopen(file.c_str(), "r"); f != nullptr) {
        char buffer[4096];
        text.assign(buffer, std::fread(buffer, 1, sizeof buffer, f));
        std::fclose(f);
      }
      return text;
    };
    const std::string where =
        std::string(GetParam().name) + " line " + std::to_string(n) + " `" + lines[n - 1] + "`: ";
    put(wanted_file, "");
    ASSERT_EQ(m->branch([&] {
      m->does({"optional-stop", "off"});
      const auto id = m->start_program(stopped);
      // Which M0 it is, the line says.
      while (runs_to_pause(*m, id) && m->task().current_line != static_cast<int>(n))
        m->does({"resume"});
      if (task::is_terminal(m->outcome(id).state)) return;  // it never comes there
      const std::string at = state_of(*m);
      m->does({"abort"});
      put(wanted_file, at);
    }),
              0)
        << where;
    const std::string refusal_file = m->folder() + "/refusal.txt";
    put(refusal_file, "");
    ASSERT_EQ(m->branch([&] {
      m->does({"optional-stop", "off"});
      ASSERT_TRUE(m->does({"open", path}));
      const std::string before = state_of(*m);
      const auto id = m->send({"run", std::to_string(n), "hold"});
      if (runs_to_pause(*m, id)) {
        EXPECT_EQ(state_of(*m), read(wanted_file)) << where << m->errors();
        // Once more, through to the end.
        ASSERT_TRUE(m->does({"resume"}));
        for (int i = 0; i < 3 && runs_to_pause(*m, id); ++i) m->does({"resume"});
        EXPECT_EQ(m->outcome(id).state, task::CommandState::done) << where << m->errors();
      } else {
        const auto reply = m->outcome(id);
        EXPECT_EQ(reply.state, task::CommandState::error) << where;
        EXPECT_NE(reply.text.find("run from line " + std::to_string(n)), std::string::npos)
            << where << reply.text;
        // Nothing happened.
        EXPECT_TRUE(m->task().idle) << where;
        EXPECT_EQ(state_of(*m), before) << where;
        EXPECT_TRUE(m->mdi("G4 P0.01")) << where << m->errors();
        put(refusal_file, reply.text + "\n");
      }
    }),
              0)
        << where;
    const std::string refusal = read(refusal_file);
    if (!refusal.empty()) {
      ++refused;
      refusals += refusal;
    }
  }
  EXPECT_EQ(refused, GetParam().refused) << refusals;
  std::printf("[ figures ] run from line in %s: %zu lines, %d refused\n", GetParam().name,
              lines.size(), refused);
}

INSTANTIATE_TEST_SUITE_P(Programs, RunFromLine, testing::ValuesIn(kPrograms),
                         [](const auto& p) { return std::string(p.param.name); });

TEST(RunFromLineSearch, CanBeAbortedAndAsksNothingOfTheMachine) {
  auto m = homed_machine();
  const std::string before = state_of(*m);
  m->write_program("M64 P0\nS500 M3\no1 while [1 GT 0]\n#1=[#1+1]\no1 endwhile\nG1 X50 F500\nM2\n");
  ASSERT_TRUE(m->does({"open", m->folder() + "/test.ngc"}));
  const auto id = m->send({"run", "6"});
  m->run_for(0.5);
  EXPECT_FALSE(task::is_terminal(m->outcome(id).state)) << m->outcome(id).text;
  EXPECT_NE(std::string(m->task().waiting_for.object.view()).find("line 6"), std::string::npos);
  EXPECT_EQ(m->abort().state, task::CommandState::done);
  EXPECT_EQ(m->outcome(id).state, task::CommandState::aborted);
  EXPECT_EQ(state_of(*m), before);
  EXPECT_TRUE(m->mdi("G0 X11")) << m->errors();
}

TEST(RunFromLineSearch, CheckTellsWhatDiffersAndChangesNothing) {
  auto m = homed_machine();
  const std::string path = m->write_program("G55\nT2 M6\nS500 M3\nM8\nG1 X50 F500\nM2\n");
  ASSERT_TRUE(m->does({"open", path}));
  const std::string before = state_of(*m);
  const auto reply = m->command({"run", "5", "check"});
  EXPECT_EQ(reply.state, task::CommandState::done);
  for (const char* what : {"tool: 0 -> 2", "spindle 0: stopped -> forward 500 rpm",
                           "flood: off -> on", "G54 -> G55", "machine position: "})
    EXPECT_NE(reply.text.find(what), std::string::npos) << what << " not in:\n" << reply.text;
  EXPECT_EQ(state_of(*m), before);
}

TEST(RunFromLineApproach, LeavesTheWorkFirstAndComesDownLast) {
  auto m = homed_machine();
  ASSERT_TRUE(m->mdi("G53 G0 X80 Y70 Z-60"));
  ASSERT_TRUE(
      m->does({"open", m->write_program("G0 X20 Y20 Z-5\nG1 Z-40 F600\nG1 X30\nG1 X40\nM2\n")}));
  double highest = -1e9, highest_xy_move_z = 1e9, fastest_down = 0;
  auto last = m->motion().pos_cmd;
  m->on_cycle([&](const motion::MotionStatus& s) {
    const auto& p = s.pos_cmd;
    if (std::hypot(p.x - last.x, p.y - last.y) > 1e-9 && p.x > 31)
      highest_xy_move_z = std::min(highest_xy_move_z, p.z);
    fastest_down = std::max(fastest_down, (last.z - p.z) / 0.001);
    highest = std::max(highest, p.z);
    last = p;
  });
  const auto id = m->send({"run", "4", "hold"});
  ASSERT_TRUE(runs_to_pause(*m, id)) << m->errors();
  EXPECT_NEAR(highest, 0.01, 1e-6) << "Z goes to its upper limit";
  EXPECT_GT(highest_xy_move_z, 0) << "no move beside Z below that";
  EXPECT_LE(fastest_down, 10.001) << "down at the program's feed";
  EXPECT_NEAR(m->joint(0), 30, 1e-9);
  EXPECT_NEAR(m->joint(2), -40, 1e-9);
}

/// What MDI and earlier programs have put into named parameters is there behind a run from a line, too.
TEST(RunFromLineApproach, KeepsNamedParametersOfBefore) {
  auto m = homed_machine();
  ASSERT_TRUE(m->mdi("#<_of_mdi>=5"));
  const auto path = m->write_program("#<_of_program>=7\nG1 X20 F900\nG1 X[20+#<_of_mdi>]\nM2\n");
  for (int run = 0; run < 2; ++run) {
    ASSERT_TRUE(m->does({"open", path}));
    ASSERT_TRUE(m->does({"run", "2"})) << m->errors();
    EXPECT_NEAR(m->joint(0), 25, 1e-9);
    ASSERT_TRUE(m->mdi("G0 X[#<_of_mdi> + #<_of_program>]")) << m->errors();
    EXPECT_NEAR(m->joint(0), 12, 1e-9);
  }
}

}  // namespace
}  // namespace kerf::harness
