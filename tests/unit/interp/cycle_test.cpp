// What canned cycles and splines leave behind, and how they go on block by block; their calls are golden programs.
#include <gtest/gtest.h>

#include "rig.hpp"

namespace kerf::interp {
namespace {

TEST(Cycle, each_repeat_is_a_step_of_its_own_and_the_stop_comes_last) {
  Rig rig;
  ASSERT_TRUE(rig.interp.open_text("t.ngc", "F100 G91 G81 X1 Z-1 R1 L3 M2\nG0 X99\n").ok());
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.calls().find("PROGRAM_END"), std::string::npos);
  EXPECT_EQ(rig.interp.modal().position.x, 1);
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  EXPECT_EQ(rig.interp.modal().position.x, 2);
  EXPECT_EQ(rig.interp.execute_next(), Outcome::program_end);
  EXPECT_EQ(rig.interp.modal().position.x, 3);
  EXPECT_NE(rig.calls().find("PROGRAM_END"), std::string::npos);
}

TEST(Cycle, g88_asks_where_the_operator_left_the_tool) {
  Rig rig;
  ASSERT_TRUE(
      rig.interp.open_text("t.ngc", "F100 M3 S9 G0 Z5\nG88 X1 Z-1 R1 P0 L2\nX5\nM2\n").ok());
  EXPECT_EQ(rig.interp.execute_next(), Outcome::ok);
  for (int hole = 0; hole < 2; ++hole) {
    ASSERT_EQ(rig.interp.execute_next(), Outcome::needs_sync) << hole;
    EXPECT_EQ(rig.interp.sync_reason(), SyncReason::program_stop);
    rig.interp.synchronize({.machine_position = Pose{.x = 1, .z = 20}});
    EXPECT_EQ(rig.interp.modal().position.z, 20);
  }
  (void)rig.calls();
  ASSERT_EQ(rig.interp.execute_next(), Outcome::needs_sync);
  EXPECT_NE(rig.calls().find("STRAIGHT_TRAVERSE(5.0000, 0.0000, 20.0000"), std::string::npos);
}

TEST(Cycle, a_repeat_in_error_ends_the_block) {
  Rig rig;
  rig.mdi("G0 X2");
  const std::string got = rig.mdi("F100 G91 G81 @-1 Z-1 R1 L5");
  EXPECT_NE(got.find("indeterminate when at the origin"), std::string::npos) << got;
  EXPECT_EQ(rig.mdi("G90 G0 X9").find("error"), std::string::npos);
}

TEST(Cycle, the_d_word_is_the_clearance_of_pecks) {
  Rig rig;
  const std::string got = rig.mdi("F100 G83 X1 Z-2 R0 Q1 D.25");
  EXPECT_NE(got.find("STRAIGHT_TRAVERSE(1.0000, 0.0000, -0.7500"), std::string::npos) << got;
  EXPECT_NE(rig.mdi("G73 X1 Z-2 R0 Q1 D-1").find("error: Negative d word used"), std::string::npos);
}

TEST(Cycle, a_hole_of_too_many_pecks_is_refused) {
  Rig rig;
  EXPECT_NE(rig.mdi("F100 G83 X1 Z-5 R0 Q.000001").find("error: Too many pecks"),
            std::string::npos);
}

TEST(Nurbs, a_point_in_error_is_no_point) {
  Rig rig;
  rig.mdi("F100 G5.2 X1 Y1");
  EXPECT_NE(rig.mdi("X2 Y2 P-1").find("error"), std::string::npos);
  rig.mdi("X2 Y2 P2");
  EXPECT_EQ(rig.mdi("G5.3"), "NURBS_G5_FEED(3, ...)\n");
  EXPECT_EQ(rig.interp.modal().position.y, 2);
  EXPECT_EQ(rig.interp.modal().motion, -1);
}

TEST(Nurbs, an_abort_ends_the_block_of_points) {
  Rig rig;
  rig.mdi("F100 G5.2 X1 Y1");
  const ModalState before = rig.interp.modal();
  rig.interp.abort();
  EXPECT_NE(rig.mdi("G5.3").find("error: Cannot use G5.3 without G5.2 first"), std::string::npos);
  rig.interp.restore(before);
  EXPECT_NE(rig.mdi("X1 Y1").find("error"), std::string::npos);
}

TEST(Nurbs, g93_gives_the_time_of_the_whole_curve) {
  Rig rig;
  rig.mdi("G93");
  // A straight one of 10 mm in half a minute.
  EXPECT_EQ(rig.mdi("G5.1 X10 I5 F2"), "SET_FEED_RATE(20.0000)\nNURBS_G5_FEED(3, ...)\n");
}

TEST(Nurbs, orders_and_points_have_limits) {
  Rig rig;
  rig.mdi("F100");
  EXPECT_NE(rig.mdi("G5.2 L17").find("error: L word greater than 16"), std::string::npos);
  EXPECT_NE(rig.mdi("G5.2 X1 Y1 Z1").find("error: Splines may not"), std::string::npos);
}

}  // namespace
}  // namespace kerf::interp
