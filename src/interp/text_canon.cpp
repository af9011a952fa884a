#include "interp/text_canon.hpp"

#include <cstdarg>
#include <cstdlib>
#include <iterator>

namespace kerf::interp {

namespace {
const char* on_off(bool on, const char* yes, const char* no) { return on ? yes : no; }
}  // namespace

// The line goes to the stream in one piece. Nobody else writes to it from another thread, so it needs no lock.
void TextCanon::end(const char* to) {
  ::fwrite_unlocked(line_, 1, static_cast<std::size_t>(to - line_), out_);
}

void TextCanon::no_label() {
  constexpr std::string_view kNone = " N..... ";
  label_size_ = static_cast<std::size_t>(put(label_, kNone) - label_);
}

void TextCanon::next_block(const SourceLine& source) {
  if (!source.label) return no_label();
  constexpr std::size_t kColumns = 8;
  char* to = put(label_, " N");
  to = put(to, source.label->substr(0, sizeof label_ - 2));
  while (to < label_ + kColumns) *to++ = ' ';
  label_size_ = static_cast<std::size_t>(to - label_);
}

char* TextCanon::begin(std::string_view name) {
  char* to = line_;
  ++counter_;
  for (std::uint32_t least = 10000; least > counter_; least /= 10) *to++ = ' ';
  to = write_digits(to, counter_);
  to = put(to, {label_, label_size_});
  return put(to, name);
}

void TextCanon::line(const char* format, ...) {
  end(begin(""));
  std::va_list args;
  va_start(args, format);
  std::vfprintf(out_, format, args);
  va_end(args);
  std::fputc('\n', out_);
}

void TextCanon::pose(std::string_view name, const Pose& p, std::string_view before) {
  char* to = put(put(begin(name), "("), before);
  const double values[] = {length(p.x), length(p.y), length(p.z), p.a, p.b, p.c};
  for (std::size_t i = 0; i < std::size(values); ++i) {
    if (i > 0) to = put(to, ", ");
    to = put(to, pose_words_[i], values[i]);
  }
  end(put(to, ")\n"));
}

void TextCanon::text(std::string_view name, std::string_view s) {
  end(put(begin(name), "(\""));
  ::fwrite_unlocked(s.data(), 1, s.size(), out_);
  ::fwrite_unlocked("\")\n", 1, 3, out_);
}

void TextCanon::use_length_units(Units units) {
  unit_mm_ = units == Units::inch ? 25.4 : 1.0;
  line("USE_LENGTH_UNITS(%s)", units == Units::inch ? "CANON_UNITS_INCHES" : "CANON_UNITS_MM");
}
void TextCanon::select_plane(Plane plane) {
  line("SELECT_PLANE(CANON_PLANE_%s)", plane == Plane::xy   ? "XY"
                                       : plane == Plane::xz ? "XZ"
                                       : plane == Plane::yz ? "YZ"
                                                            : "UNKNOWN");
}
void TextCanon::set_g5x_offset(int system, const Pose& offset) {
  char before[16];
  std::snprintf(before, sizeof before, "%d, ", system);
  pose("SET_G5X_OFFSET", offset, before);
}
void TextCanon::set_g92_offset(const Pose& offset) { pose("SET_G92_OFFSET", offset); }
void TextCanon::set_xy_rotation(double degrees) { line("SET_XY_ROTATION(%.4f)", degrees); }
void TextCanon::use_tool_length_offset(const Pose& o) {
  if (!offset_changed_) offset_of_last_motion_ = tool_offset_;
  offset_changed_ = true;
  tool_offset_ = o;
  line("USE_TOOL_LENGTH_OFFSET(%.4f %.4f %.4f, %.4f %.4f %.4f, %.4f %.4f %.4f)", length(o.x),
       length(o.y), length(o.z), o.a, o.b, o.c, length(o.u), length(o.v), length(o.w));
}

void TextCanon::set_feed_rate(double linear_mm_min, double) {
  line("SET_FEED_RATE(%.4f)", length(linear_mm_min));
}
void TextCanon::set_feed_mode(int spindle, FeedMode mode) {
  line("SET_FEED_MODE(%d, %d)", spindle, mode == FeedMode::per_revolution ? 1 : 0);
}
void TextCanon::set_feed_reference() { line("SET_FEED_REFERENCE(CANON_XYZ)"); }
void TextCanon::set_motion_control_mode(PathMode mode, double tolerance_mm) {
  if (mode == PathMode::continuous)
    line("SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, %f)", length(tolerance_mm));
  else
    line("SET_MOTION_CONTROL_MODE(%s)",
         mode == PathMode::exact_path ? "CANON_EXACT_PATH" : "CANON_EXACT_STOP");
}
void TextCanon::set_naivecam_tolerance(double tolerance_mm) {
  line("SET_NAIVECAM_TOLERANCE(%.4f)", length(tolerance_mm));
}
void TextCanon::set_planner_mode(int type, double corner_factor) {
  line("SET_PLANNER_MODE(type=%d, peak_scale=%f)", type, corner_factor);
}
void TextCanon::start_speed_feed_sync(int, double mm_per_revolution, bool velocity_mode) {
  line("START_SPEED_FEED_SYNC(%f,%d)", length(mm_per_revolution), velocity_mode ? 1 : 0);
}
void TextCanon::stop_speed_feed_sync() { line("STOP_SPEED_FEED_SYNCH()"); }

void TextCanon::straight_traverse(const Pose& end) {
  offset_changed_ = false;
  pose("STRAIGHT_TRAVERSE", end);
}
void TextCanon::straight_feed(const Pose& end) {
  offset_changed_ = false;
  pose("STRAIGHT_FEED", end);
}
void TextCanon::arc_feed(const Arc& arc) {
  offset_changed_ = false;
  const std::size_t first = arc.plane == Plane::xy ? 0 : arc.plane == Plane::xz ? 2 : 1;
  const std::size_t second = (first + 1) % 3, normal = (first + 2) % 3;
  char* to = begin("ARC_FEED(");
  const double values[] = {length(arc.end[first]),
                           length(arc.end[second]),
                           length(arc.center[first]),
                           length(arc.center[second]),
                           length(arc.end[normal]),
                           arc.end.a,
                           arc.end.b,
                           arc.end.c};
  for (std::size_t i = 0; i < std::size(values); ++i) {
    if (i > 0) to = put(to, ", ");
    if (i == 4) {
      if (arc.turns < 0) *to++ = '-';
      to = put(write_digits(to, static_cast<std::uint64_t>(std::abs(std::int64_t{arc.turns}))),
               ", ");
    }
    to = put(to, arc_words_[i], values[i]);
  }
  end(put(to, ")\n"));
}
void TextCanon::nurbs_feed(std::span<const SplinePoint> points, int) {
  offset_changed_ = false;
  line("NURBS_G5_FEED(%zu, ...)", points.size());
}
void TextCanon::straight_probe(const Pose& end, ProbeKind) {
  offset_changed_ = false;
  pose("STRAIGHT_PROBE", end);
}
void TextCanon::turn_probe_on() { line("TURN_PROBE_ON()"); }
void TextCanon::turn_probe_off() { line("TURN_PROBE_OFF()"); }
void TextCanon::rigid_tap(const Pose& end, double) {
  line("RIGID_TAP(%.4f, %.4f, %.4f)", length(end.x), length(end.y), length(end.z));
}
void TextCanon::dwell(double seconds) { line("DWELL(%.4f)", seconds); }

void TextCanon::set_spindle_speed(int spindle, double speed) {
  const bool css = css_[static_cast<std::size_t>(spindle)];
  line("SET_SPINDLE_SPEED(%d, %.4f)", spindle,
       !css ? speed : speed / (unit_mm_ > 1 ? 304.8 : 1000.0));
}
void TextCanon::set_spindle_mode(int spindle, double css_max_rpm) {
  css_[static_cast<std::size_t>(spindle)] = css_max_rpm > 0;
  line("SET_SPINDLE_MODE(%d %.4f)", spindle, css_max_rpm);
}
void TextCanon::start_spindle(int spindle, SpindleDirection direction) {
  line("START_SPINDLE_%s(%d)",
       direction == SpindleDirection::counterclockwise ? "COUNTERCLOCKWISE" : "CLOCKWISE", spindle);
}
void TextCanon::stop_spindle(int spindle) { line("STOP_SPINDLE_TURNING(%d)", spindle); }
void TextCanon::orient_spindle(int spindle, double angle_deg, int mode) {
  line("ORIENT_SPINDLE(%d, %.4f, %d)", spindle, angle_deg, mode);
}
void TextCanon::wait_orient_complete(int spindle, double timeout_s) {
  line("SPINDLE.%d.WAIT_ORIENT_COMPLETE(%.4f)", spindle, timeout_s);
}

void TextCanon::select_tool(int number) {
  selected_tool_ = number;
  line("SELECT_TOOL(%d)", number);
}
void TextCanon::change_tool() {
  spindle_tool_ = selected_tool_;
  line("CHANGE_TOOL()");
}
void TextCanon::change_tool_number(int number) { line("CHANGE_TOOL_NUMBER(%d)", number); }
// The row of the tool in the spindle is printed again as that of pocket 0; before the first change that is pocket 1.
void TextCanon::set_tool_table_entry(const Tool& t) {
  const Pose& o = t.offset;
  const double unit = machine_unit_mm_;
  const bool in_spindle = spindle_tool_ < 0 ? t.pocket == 1 : t.number == spindle_tool_;
  for (int row = 0; row < (in_spindle ? 2 : 1); ++row) {
    line(
        "SET_TOOL_TABLE_ENTRY(%d, %d, %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f, %.4f, %.4f, "
        "%d)",
        row == 0 ? t.pocket : 0, t.number, o.x / unit, o.y / unit, o.z / unit, o.a, o.b, o.c,
        o.u / unit, o.v / unit, o.w / unit, t.front_angle_deg, t.back_angle_deg, t.orientation);
  }
}
void TextCanon::reload_tooldata() { line("RELOAD_TOOLDATA()"); }

void TextCanon::set_mist(bool on) { line("%s", on_off(on, "MIST_ON()", "MIST_OFF()")); }
void TextCanon::set_flood(bool on) { line("%s", on_off(on, "FLOOD_ON()", "FLOOD_OFF()")); }
void TextCanon::set_motion_output_bit(int index, bool on) {
  line("%s_MOTION_OUTPUT_BIT(%d)", on_off(on, "SET", "CLEAR"), index);
}
void TextCanon::set_motion_output_value(int index, double value) {
  line("SET_MOTION_OUTPUT_VALUE(%d,%f)", index, value);
}
void TextCanon::set_aux_output_bit(int index, bool on) {
  line("%s_AUX_OUTPUT_BIT(%d)", on_off(on, "SET", "CLEAR"), index);
}
void TextCanon::set_aux_output_value(int index, double value) {
  line("SET_AUX_OUTPUT_VALUE(%d,%f)", index, value);
}

void TextCanon::enable_feed_override(bool on) {
  line("%s_FEED_OVERRIDE()", on_off(on, "ENABLE", "DISABLE"));
}
void TextCanon::enable_speed_override(int spindle, bool on) {
  line("%s_SPEED_OVERRIDE(%d)", on_off(on, "ENABLE", "DISABLE"), spindle);
}
void TextCanon::enable_adaptive_feed(bool on) {
  line("%s_ADAPTIVE_FEED()", on_off(on, "ENABLE", "DISABLE"));
}
void TextCanon::enable_feed_hold(bool on) {
  line("%s_FEED_HOLD()", on_off(on, "ENABLE", "DISABLE"));
}

void TextCanon::program_stop() { line("PROGRAM_STOP()"); }
void TextCanon::optional_program_stop() { line("OPTIONAL_PROGRAM_STOP()"); }
void TextCanon::pallet_shuttle() { line("PALLET_SHUTTLE()"); }
void TextCanon::program_end() { line("PROGRAM_END()"); }
void TextCanon::finish() { line("FINISH()"); }
void TextCanon::on_reset() {
  no_label();
  line("ON_RESET()");
}
void TextCanon::user_mcode(int number, std::string_view, double p, double q) {
  line("USER_DEFINED_FUNCTION(%d, %f, %f)", number, p, q);
}

void TextCanon::comment(std::string_view s) { text("COMMENT", s); }
void TextCanon::message(std::string_view s) { text("MESSAGE", s); }
void TextCanon::print(std::string_view s) {
  ::fwrite_unlocked(s.data(), 1, s.size(), out_);
  ::fwrite_unlocked("\n", 1, 1, out_);
}
void TextCanon::log_open(std::string_view path, bool append) {
  text(append ? "LOGAPPEND" : "LOGOPEN", path);
}
void TextCanon::log(std::string_view s) { text("LOG", s); }
void TextCanon::log_close() { line("LOGCLOSE()"); }

}  // namespace kerf::interp
