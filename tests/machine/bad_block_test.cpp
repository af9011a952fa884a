// Hundreds of blocks that are wrong, each in the middle of a program whose spindle turns and whose coolant flows: nothing of the
// block happens, its place is told, and what turns and flows stops as behind an abort.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "harness/machine.hpp"

namespace kerf::harness {
namespace {

// clang-format off
std::vector<std::string> bad_blocks() {
  std::vector<std::string> out;
  const auto add = [&out](std::string a, std::string_view b, std::string_view c = {}) {
    a.append(b).append(c);
    out.push_back(std::move(a));
  };
  // Words that are no numbers, or numbers that cannot be computed.
  for (const char* letter : {
       "X", "Y", "Z", "I", "J", "K", "F", "S", "P", "Q", "R", "D", "H", "L"})
    for (const char* value : {
       "", "[1", "[1/0]", "[SQRT[-1]]", "[ACOS[2]]", "1.2.3", "#[1/0]", "[1 FOO 2]", "#<_nowhere>",
       "1 X2 X3"})
      add(std::string("G1 X5 Y5 ") + letter, value);
  // Two codes of a group, with a move that must not happen.
  for (const char* codes :
       {
       "G0 G1", "G1 G2", "G2 G3", "G17 G18", "G18 G19", "G20 G21", "G54 G55", "G59 G59.3",
       "G61 G64", "G90 G91", "G90.1 G91.1", "G93 G94", "G94 G95", "G98 G99", "G96 G97", "G40 G41",
       "G43 G49", "G7 G8", "G80 G81", "G28 G30", "M0 M1", "M0 M2", "M3 M4", "M3 M5", "M4 M5",
       "M48 M49", "M7 M9", "M6 M61", "M62 M63", "M64 M65", "M66 M67", "M50 M50"})
    add("X5 Y5 F500 ", codes);
  // Cycles without what they need, or with what cannot be.
  for (const char* code : {"G73", "G81", "G82", "G83", "G84", "G85", "G86", "G88", "G89"})
    for (const char* words :
         {
       " Z-2 R-1", " X5 R-1", " X5 Z-2", " X5 Z-1 R-2", " X5 Z-2 R-1 L-1", " X5 Z-2 R-1 L1.5",
       " X5 Z-2 R-1 P-1 Q-1", " X5 Z-2 R-1 Q0 P-1", " X5 Z-2 R-1 U1 I1"})
      add(code, words);
  // Arcs, dwells, offsets, tools and codes that are not.
  for (const char* line : {
       "G2 X5 Y5", "G3 X5 Y5", "G2 X5 Y5 R1", "G2 X5 Y5 I50 J50", "G2 X5 R0", "G2 X0 Y0 R5",
       "G18 G2 X5 Y5 J1", "G19 G3 X5 Z5 I1", "G2 X5 Y5 I1 J1 P0", "G2 X5 Y5 I1 J1 P1.5", "G5 X5",
       "G5.1 X5", "G5.2 X5", "G4", "G4 X2", "G4 P-1", "G10", "G10 L2", "G10 L2 P99 X5",
       "G10 L1 P-1", "G10 L99 P1", "G10 L20 P1.5 X1", "G10 L1", "G41 D-1", "G41 D1.5", "G41 D999",
       "G42 D999", "G41.1 X5", "G43 H-1", "G43 H1.5", "G43 H999", "G43.2 H999", "G53 G2 X5 I2",
       "G53 G81 X5", "G92", "G33 X5", "G33 X5 K0", "G33.1 Z-1", "G38.2 X5", "G38.2 F100",
       "G38.6 X5 F100", "G76 X5", "G76 P1 Z-5", "G61.2", "G93 G1 X5", "G95 G1 X5 F0",
       "G96 S100 D-1", "G6", "G6.3 X5", "G11", "G12", "G13", "G22", "G44", "G65", "G100", "G999",
       "G1.5 X5", "G-1 X5", "M10", "M11", "M33", "M77", "M99.5", "M150", "M199", "M200", "M1000",
       "M-1", "T99 M6", "T-1", "T1.5", "M61", "M61 Q-1", "M61 Q99", "M62", "M62 P99", "M63 P-1",
       "M64 P1.5", "M65", "M66", "M66 P0 E0", "M66 P99 L0", "M66 P0 L9", "M66 P0 L3 Q-1", "M67",
       "M67 E99 Q1", "M67 E-1 Q1", "M68 E1", "M68 Q1", "S-1", "F-1", "$9 M3", "M19 R999 Q-1",
       "M98 P77", "M99 P1", "M70 M72", "M72", "O999 call", "o1 if [1", "o1 endif", "o2 endwhile",
       "o3 endsub", "o4 call [", "o5 repeat", "o6 else", "#1=", "#1=[1/0]", "#0=1", "#-1=1",
       "#5400=1", "#6000=1", "#<a=1", "X5 #1=[", "X5 ]", "X5 (", "X5 (no end", "X[LN[-1]]",
       "X[ATAN[1]]", "X[1]2", "X5 N1.5", "N1 X", "Q5", "A5", "B5", "C5", "U5", "V5", "W5", "E5 X5",
       "X5 @", "X5 !", "X5 ?", "X5 &", "G", "M", "%X5", "X1 Y1 Z1 X1", "G1 G1 X5", "X999",
       "Y-999 X5", "Z999 X5", "G0 X5 Z-999"})
    add(line, "");
  return out;
}

// clang-format on

/// "test.ngc:3:7: " behind the folder's name: line and column, 0 where there is none.
struct Place {
  int line{0}, column{0};
};
Place place_of(const std::string& text) {
  Place at;
  const auto from = text.rfind("test.ngc:");
  if (from != std::string::npos)
    (void)std::sscanf(text.c_str() + from, "test.ngc:%d:%d", &at.line, &at.column);
  return at;
}

TEST(BadBlocks, DoNothingAndSayWhere) {
  auto m = Machine::start();
  ASSERT_TRUE(m->ready()) << m->errors();
  ASSERT_TRUE(m->power_on_and_home()) << m->errors();
  ASSERT_TRUE(m->mdi("G0 X5 Y5 Z-5")) << m->errors();
  const auto blocks = bad_blocks();
  EXPECT_GE(blocks.size(), 300U);
  std::size_t columns = 0, wrong = 0, flowing = 0;
  for (const std::string& block : blocks) {
    const auto before = m->motion();
    bool moved = false, output = false, turned = false, flowed = false;
    m->on_cycle([&](const motion::MotionStatus& s) {
      for (std::size_t j = 0; j < 3; ++j)
        moved = moved || s.joint[j].pos_cmd != before.joint[j].pos_cmd;
      output = output || s.digital_out != before.digital_out;
      turned = turned || s.spindle[0].on;
      flowed = flowed || m->task().flood;
    });
    const auto reply = m->run_text("S500 M3\nM8\nG4 P0.01\n" + block + "\nG0 X20\nM2\n", 20);
    const bool refused = reply.state == task::CommandState::error;
    const bool idle = m->run_until([&] { return m->task().idle; }, 1);
    m->run_for(0.02);
    m->on_cycle(nullptr);
    // What motion refuses has its place in the operator's message.
    const bool placed = reply.text.find("test.ngc:") != std::string::npos;
    const Place at = place_of(placed ? reply.text : m->errors());
    columns += at.column > 0 ? 1 : 0;
    const bool safe = !m->bit("spindle.0.on") && !m->bit("iocontrol.0.coolant-flood") &&
                      !m->bit("iocontrol.0.tool-prepare") && !m->bit("iocontrol.0.tool-change");
    const bool well = refused && idle && safe && !moved && !output && turned &&
                      (at.line == 4 || at.line == 5 || at.line == 6) &&
                      m->task().task_state == task::TaskState::on;
    EXPECT_TRUE(well) << "\"" << block << "\" refused " << refused << " idle " << idle << " safe "
                      << safe << " moved " << moved << " output " << output << " turned " << turned
                      << " from X" << before.joint[0].pos_cmd << " to X" << m->joint(0) << " line "
                      << at.line << ": " << reply.text;
    wrong += well ? 0 : 1;
    flowing += flowed ? 1 : 0;
  }
  EXPECT_TRUE(m->mdi("G0 X6")) << m->errors();
  // But where motion refuses what is read ahead, before the coolant is due.
  EXPECT_GE(flowing + 10, blocks.size());
  std::printf(
      "[ figures ] bad blocks: %zu, %zu did something or were not told; %zu with a column\n",
      blocks.size(), wrong, columns);
}

}  // namespace
}  // namespace kerf::harness
