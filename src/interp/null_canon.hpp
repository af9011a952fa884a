// NullCanon: counts motion calls and drops everything; what hears only some calls derives from it.
#pragma once

#include <cstdint>

#include "interp/canon.hpp"

namespace kerf::interp {

class NullCanon : public Canon {
 public:
  std::uint64_t moves{0};
  void next_block(const SourceLine&) override {}
  void use_length_units(Units) override {}
  void select_plane(Plane) override {}
  void set_g5x_offset(int, const Pose&) override {}
  void set_g92_offset(const Pose&) override {}
  void set_xy_rotation(double) override {}
  void use_tool_length_offset(const Pose&) override {}
  void set_feed_rate(double, double) override {}
  void set_feed_mode(int, FeedMode) override {}
  void set_feed_reference() override {}
  void set_motion_control_mode(PathMode, double) override {}
  void set_naivecam_tolerance(double) override {}
  void set_planner_mode(int, double) override {}
  void start_speed_feed_sync(int, double, bool) override {}
  void stop_speed_feed_sync() override {}
  void straight_traverse(const Pose&) override { ++moves; }
  void straight_feed(const Pose&) override { ++moves; }
  void arc_feed(const Arc&) override { ++moves; }
  void nurbs_feed(std::span<const SplinePoint>, int) override { ++moves; }
  void straight_probe(const Pose&, ProbeKind) override { ++moves; }
  void turn_probe_on() override {}
  void turn_probe_off() override {}
  void rigid_tap(const Pose&, double) override { ++moves; }
  void dwell(double) override {}
  void set_spindle_speed(int, double) override {}
  void set_spindle_mode(int, double) override {}
  void start_spindle(int, SpindleDirection) override {}
  void stop_spindle(int) override {}
  void orient_spindle(int, double, int) override {}
  void wait_orient_complete(int, double) override {}
  void select_tool(int) override {}
  void start_change() override {}
  void change_tool() override {}
  void change_tool_number(int) override {}
  void set_tool_table_entry(const Tool&) override {}
  void reload_tooldata() override {}
  void set_mist(bool) override {}
  void set_flood(bool) override {}
  void set_motion_output_bit(int, bool) override {}
  void set_motion_output_value(int, double) override {}
  void set_aux_output_bit(int, bool) override {}
  void set_aux_output_value(int, double) override {}
  void wait_input(int, bool, WaitMode, double) override {}
  void enable_feed_override(bool) override {}
  void enable_speed_override(int, bool) override {}
  void enable_adaptive_feed(bool) override {}
  void enable_feed_hold(bool) override {}
  void program_stop() override {}
  void optional_program_stop() override {}
  void pallet_shuttle() override {}
  void program_end() override {}
  void user_mcode(int, std::string_view, double, double) override {}
  void comment(std::string_view) override {}
  void message(std::string_view) override {}
  void print(std::string_view) override {}
  void log_open(std::string_view, bool) override {}
  void log(std::string_view) override {}
  void probe_log_open(std::string_view) override {}
  void probe_log_close() override {}
  void log_close() override {}
};

}  // namespace kerf::interp
