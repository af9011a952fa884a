// Canonical calls to path items, without interpreter or motion.
#include <gtest/gtest.h>

#include <cmath>

#include "task/interpreter/canon_to_path.hpp"

namespace kerf::task {
namespace {

using interp::Pose;

struct Bench {
  template <class T>
  T last() const {
    EXPECT_FALSE(list.empty());
    EXPECT_TRUE(is_path(list.back()));
    const auto& body = std::get<PathBody>(list.back().body);
    EXPECT_TRUE(std::holds_alternative<T>(body));
    return std::get<T>(body);
  }
  std::deque<TaskItem> list;
  ToolConfig tools;
  CanonToPath canon{list, tools};
};

TEST(Canon, feed_follows_the_metric_of_the_move) {
  Bench b;
  b.canon.set_feed_rate(600, 1200);
  b.canon.straight_feed({.x = 1});
  EXPECT_DOUBLE_EQ(b.last<motion::LinearMove>().vel_mm_s, 10);
  b.canon.straight_feed({.x = 1, .a = 90});
  EXPECT_DOUBLE_EQ(b.last<motion::LinearMove>().vel_mm_s, 20)
      << "degrees per second, rotary axes alone";
  b.canon.straight_feed({.x = 1, .a = 180, .u = 5});
  EXPECT_DOUBLE_EQ(b.last<motion::LinearMove>().vel_mm_s, 10) << "UVW count as linear";
  b.canon.set_spindle_speed(0, 100);
  b.canon.set_feed_mode(0, interp::FeedMode::per_revolution);
  b.canon.set_feed_rate(0.3, 0.3);
  b.canon.straight_feed({.x = 2, .a = 180, .u = 5});
  EXPECT_DOUBLE_EQ(b.last<motion::LinearMove>().vel_mm_s, 0.5);
}

TEST(Canon, moves_of_no_length_vanish_but_full_circles_do_not) {
  Bench b;
  b.canon.straight_traverse({});
  b.canon.straight_feed({});
  EXPECT_TRUE(b.list.empty());
  b.canon.set_feed_rate(60, 60);
  b.canon.arc_feed({.end = {}, .center = {5, 0, 0}, .turns = 1});
  EXPECT_EQ(b.list.size(), 1u);
}

TEST(Canon, arcs_turn_right_handed_about_their_normal_in_all_planes) {
  for (const auto plane : {interp::Plane::xy, interp::Plane::xz, interp::Plane::yz}) {
    for (const int turns : {1, -1, 3, -3}) {
      for (const double rotation : {0.0, 30.0}) {
        Bench b;
        b.canon.set_xy_rotation(rotation);
        b.canon.set_g5x_offset(1, {.x = 100, .y = 50, .z = -20});
        b.canon.arc_feed(
            {.end = {.x = 1, .y = 2, .z = 3}, .center = {4, 5, 6}, .plane = plane, .turns = turns});
        const auto arc = b.last<motion::ArcMove>();
        EXPECT_EQ(arc.turns, std::abs(turns));
        const auto normal = b.canon.state().frame.normal(plane);
        double dot = 0, length = 0;
        for (std::size_t i = 0; i < 3; ++i)
          dot += normal[i] * arc.normal[i], length += arc.normal[i] * arc.normal[i];
        EXPECT_NEAR(length, 1, 1e-12);
        EXPECT_NEAR(dot, turns > 0 ? 1 : -1, 1e-12);
        const auto back = b.canon.state().frame.to_program(
            Pose{arc.centre[0], arc.centre[1], arc.centre[2], 0, 0, 0, 0, 0, 0});
        EXPECT_NEAR(back.x, 4, 1e-12);
        EXPECT_NEAR(back.y, 5, 1e-12);
        EXPECT_NEAR(back.z, 6, 1e-12);
      }
    }
  }
}

TEST(Canon, surface_speed_becomes_a_factor) {
  Bench b;
  b.canon.set_spindle_mode(0, 2500);
  b.canon.set_spindle_speed(0, 60000);  // mm/min of surface
  b.canon.start_spindle(0, interp::SpindleDirection::clockwise);
  const auto change = b.last<motion::SpindleChange>();
  EXPECT_NEAR(change.css_factor / 10, 60000 / (2 * M_PI * 10), 1e-9) << "rpm at 10 mm";
  EXPECT_EQ(change.css_max_rpm, 2500);
  b.canon.set_spindle_mode(0, 0);
  b.canon.set_spindle_speed(0, 800);
  EXPECT_EQ(b.last<motion::SpindleChange>().speed_rpm, 800);
  EXPECT_EQ(b.last<motion::SpindleChange>().css_factor, 0);
}

TEST(Canon, a_surface_speed_never_becomes_a_speed_in_mm_per_minute) {
  for (const auto& [units, surface] :
       {std::pair{interp::Units::mm, 100 * 1000.0}, std::pair{interp::Units::inch, 100 * 304.8}}) {
    Bench b;
    b.canon.use_length_units(units);
    b.canon.set_spindle_mode(0, 2500);
    b.canon.set_spindle_speed(0, surface);  // G96 S100
    b.canon.set_spindle_mode(0, 0);         // G97 or M2, without S
    b.canon.start_spindle(0, interp::SpindleDirection::clockwise);
    EXPECT_NEAR(b.last<motion::SpindleChange>().speed_rpm, 100, 1e-9);
    EXPECT_EQ(b.last<motion::SpindleChange>().css_factor, 0);
  }
}

TEST(Canon, surface_speed_is_measured_from_the_workpiece) {
  Bench b;
  b.canon.set_g5x_offset(1, {.x = -100});
  EXPECT_TRUE(b.list.empty());
  b.canon.use_tool_length_offset({.x = 7});
  b.canon.set_spindle_mode(0, 2500);
  b.canon.set_spindle_speed(0, 60000);
  b.canon.start_spindle(0, interp::SpindleDirection::clockwise);
  EXPECT_EQ(b.last<motion::SpindleChange>().css_center_x_mm, -100);
  b.canon.set_g92_offset({.x = 30});
  EXPECT_EQ(b.last<motion::SpindleChange>().css_center_x_mm, -70);
  b.canon.set_g5x_offset(2, {.x = -50});
  EXPECT_EQ(b.last<motion::SpindleChange>().css_center_x_mm, -20);
}

TEST(Canon, the_orientation_itself_knows_its_timeout) {
  Bench b;
  b.canon.orient_spindle(0, 90, 1);
  EXPECT_EQ(b.last<motion::SpindleChange>().orient_timeout_s, 0);
  b.canon.wait_orient_complete(0, 2.5);
  ASSERT_EQ(b.list.size(), 2u);
  const auto& change = std::get<motion::SpindleChange>(std::get<PathBody>(b.list[0].body));
  EXPECT_EQ(change.orient_timeout_s, 2.5);
  EXPECT_TRUE(std::holds_alternative<WaitOrient>(b.list[1].body));
}

TEST(Canon, program_end_forgets_outputs_that_no_move_came_for) {
  Bench b;
  b.canon.set_motion_output_bit(0, true);
  b.canon.program_end();
  ASSERT_GE(b.list.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<ProgramEnd>(b.list.back().body));
  b.list.pop_back();
  EXPECT_TRUE(b.last<motion::Marker>().drop_outputs);
}

TEST(Canon, feed_moves_between_start_and_stop_of_the_spindles_lead_follow_it) {
  Bench b;
  b.canon.set_feed_rate(600, 600);
  b.canon.start_speed_feed_sync(1, -1.5, false);
  b.canon.straight_feed({.z = -10});
  const auto sync = b.last<motion::SyncMove>();
  EXPECT_EQ(sync.end.z, -10);
  EXPECT_EQ(sync.per_rev_mm, 1.5) << "the end says which way";
  EXPECT_EQ(sync.spindle, 1);
  b.canon.rigid_tap({.z = -20}, 2);
  const auto tap = b.last<motion::TapMove>();
  EXPECT_EQ(tap.end.z, -20);
  EXPECT_EQ(tap.per_rev_mm, 1.5);
  EXPECT_EQ(tap.return_factor, 2);
  EXPECT_EQ(b.canon.state().position.z, -10) << "a tap ends where it begins";
  b.canon.stop_speed_feed_sync();
  b.canon.straight_feed({.x = 1, .z = -10});
  EXPECT_EQ(b.last<motion::LinearMove>().vel_mm_s, 10);
}

TEST(Canon, feed_per_revolution_names_the_spindle_and_its_programmed_speed) {
  Bench b;
  b.canon.set_spindle_speed(0, 600);
  b.canon.set_feed_mode(0, interp::FeedMode::per_revolution);
  EXPECT_EQ(b.last<motion::FeedPerRev>().spindle, 0);
  EXPECT_EQ(b.last<motion::FeedPerRev>().rps, 10);
  b.canon.set_feed_rate(0.5, 0.5);
  b.canon.straight_feed({.x = 10});
  EXPECT_EQ(b.last<motion::LinearMove>().vel_mm_s, 5);
  b.canon.set_spindle_speed(0, 1200);
  EXPECT_EQ(b.last<motion::FeedPerRev>().rps, 20);
  b.canon.straight_feed({.x = 20});
  EXPECT_EQ(b.last<motion::LinearMove>().vel_mm_s, 10);
  // Surface speeds are no revolutions: whatever is assumed, feed and speed belong together.
  b.canon.set_spindle_mode(0, 1000);
  const double rps = b.last<motion::FeedPerRev>().rps;
  b.canon.straight_feed({.x = 30});
  EXPECT_DOUBLE_EQ(b.last<motion::LinearMove>().vel_mm_s, 0.5 * rps);
  b.canon.set_feed_mode(0, interp::FeedMode::per_minute);
  EXPECT_EQ(b.last<motion::FeedPerRev>().spindle, -1);
}

TEST(Canon, user_mcode_words_are_text) {
  Bench b;
  b.canon.user_mcode(100, "/x/M100", 123.456, -1);
  const auto& run = std::get<UserMcodeRun>(b.list.back().body);
  EXPECT_EQ(run.p, "123.456000");
  EXPECT_EQ(run.q, "-1.000000");
}

}  // namespace
}  // namespace kerf::task
