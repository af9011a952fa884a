// Moves that wait for the end of a compensated path: their tags, and where an abort leaves the interpreter.
#include <gtest/gtest.h>

#include "rig.hpp"

namespace kerf::task::testing {
namespace {

constexpr const char* kSquare =
    "G21 G0 X-10 F600\nG41.1 D2\nG1 X0\nX10\nM8\nG91\nY-10\nG90\nX0\nG40\nG0 X-20\nM2\n";

TEST(Compensation, items_carry_the_line_of_their_own_block) {
  Rig rig;
  rig.ready();
  EXPECT_EQ(rig.run_text(kSquare).state, CommandState::done) << rig.messages();
  std::vector<int> lines;
  std::vector<std::uint64_t> ids;
  for (const auto& item : rig.fake->done) {
    if (std::holds_alternative<motion::LinearMove>(item.body) ||
        std::holds_alternative<motion::ArcMove>(item.body)) {
      lines.push_back(item.tag.line);
      ids.push_back(item.tag.id);
    }
  }
  // Each corner belongs to the move behind it.
  EXPECT_EQ(lines, (std::vector<int>{1, 3, 4, 7, 7, 9, 9, 11}));
  EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
}

TEST(Compensation, abort_returns_to_the_block_that_moves) {
  Rig rig;
  rig.ready();
  rig.fake->move_time = rtapi::kSecond;
  rig.start_text(kSquare);
  rig.run_for(2.5);  // within line 4
  EXPECT_EQ(rig.status().current_line, 4);
  rig.does({"abort"});
  rig.run_for(0.1);
  const TaskStatus s = rig.status();
  EXPECT_EQ(s.g_codes[6], 900) << "G91 was read, not reached";
  EXPECT_EQ(s.g_codes[4], 400) << "the tool no longer follows a path";
  rig.fake->move_time = kMillisecond;
  rig.does({"mdi", "G0 Y7"});
  EXPECT_EQ(rig.fake->status.pos_cmd.y, 7);
}

TEST(Compensation, a_pause_comes_at_its_place) {
  Rig rig;
  rig.ready();
  const auto run =
      rig.start_text("G21 G0 X-10 F600\nG41.1 D2\nG1 X0\nX10\nM0\nY10\nG40\nG0 X0\nM2\n");
  rig.run_for(1);
  EXPECT_FALSE(rig.finished(run));
  EXPECT_DOUBLE_EQ(rig.fake->status.pos_cmd.x, 9) << "the inside corner is known already";
  rig.does({"resume"});
  EXPECT_EQ(rig.wait(run).state, CommandState::done);
}

TEST(Compensation, mdi_lines_go_on_with_the_path) {
  Rig rig;
  rig.ready();
  for (const char* line : {"G21 G0 X-10 F600", "G41.1 D2", "G1 X0", "X10"}) rig.does({"mdi", line});
  EXPECT_DOUBLE_EQ(rig.fake->status.pos_cmd.x, 0);
  EXPECT_DOUBLE_EQ(rig.fake->status.pos_cmd.y, 1);
  rig.does({"mdi", "Y10"});
  EXPECT_DOUBLE_EQ(rig.fake->status.pos_cmd.x, 9);
  rig.does({"mdi", "G40"});
  EXPECT_DOUBLE_EQ(rig.fake->status.pos_cmd.y, 10);
}

}  // namespace
}  // namespace kerf::task::testing
