#include "task/interpreter/canon_to_path.hpp"

#include <cmath>
#include <cstdio>
#include <vector>

#include "task/interpreter/spline_cubics.hpp"

namespace kerf::task {

using motion::MotionKind;
using motion::Pose;
using motion::SpindleChange;

namespace {
constexpr double kTwoPi = 6.283185307179586;
constexpr double kNoRadius = 1e-6;  ///< mm
constexpr double kSomeRpm = 1000;   ///< G95 counts from here where S says nothing
}  // namespace

void CanonToPath::forget_outputs() {
  state_.direction.fill(0);
  state_.pending_outputs = 0;
}

void CanonToPath::announce(std::uint64_t tag_id) {
  tag_ = motion::SourceTag{};
  tag_.id = tag_id;
  add_path(state_.path);
  add_path(state_.overrides);
  add_path(motion::ToolOffset{state_.frame.tool()});
  // Motion forgets it with an abort.
  if (state_.feed_mode == interp::FeedMode::per_revolution) add_path(feed_per_rev());
}

const std::vector<DeliveredBlock>& CanonToPath::end_delivery() {
  if (!delivered_.empty()) delivered_.back().canon = state_;
  interpreter_ = nullptr;
  return delivered_;
}

void CanonToPath::next_block(const interp::SourceLine& source) {
  if (interpreter_ != nullptr && !delivered_.empty()) {
    delivered_.back().canon = state_;
    new_tag();
  }
  tag_.line = source.line;
  tag_.file = static_cast<std::int32_t>(source.file_id);
  tag_.call_level = source.call_level;
  tag_.main_line = source.main_line;
  file_ = source.file;
  if (interpreter_ != nullptr)
    delivered_.push_back({tag_, list_.size(), interpreter_->modal(), state_});
}

void CanonToPath::set_g5x_offset(int system, const interp::Pose& offset) {
  state_.g5x_index = system;
  state_.frame.set_g5x_offset(offset);
  frame_changed();
}

void CanonToPath::set_g92_offset(const interp::Pose& offset) {
  state_.frame.set_g92_offset(offset);
  frame_changed();
}

void CanonToPath::set_xy_rotation(double degrees) {
  state_.frame.set_xy_rotation(degrees);
  frame_changed();
}

/// Spindles at constant surface speed learn where X0 is now.
void CanonToPath::frame_changed() {
  for (std::size_t n = 0; n < motion::kMaxSpindles; ++n) {
    if (state_.css_max_rpm[n] > 0 && state_.direction[n] != 0)
      add_path(spindle_change(static_cast<int>(n), SpindleChange::Action::set_speed));
  }
}

void CanonToPath::use_tool_length_offset(const interp::Pose& offset) {
  state_.frame.use_tool_length_offset(offset);
  add_path(motion::ToolOffset{offset});
}

void CanonToPath::replace_tool_offset(const motion::Pose& offset) {
  state_.position = state_.position + (offset - state_.frame.tool());
  state_.frame.use_tool_length_offset(offset);
}

void CanonToPath::set_feed_rate(double linear_mm_min, double angular_deg_min) {
  state_.linear_mm_min = linear_mm_min;
  state_.angular_deg_min = angular_deg_min;
}

void CanonToPath::set_feed_mode(int spindle, interp::FeedMode mode) {
  const bool changes = mode != state_.feed_mode ||
                       (mode == interp::FeedMode::per_revolution && spindle != state_.feed_spindle);
  state_.feed_spindle = spindle;
  state_.feed_mode = mode;
  if (changes) add_path(feed_per_rev());
}

void CanonToPath::set_motion_control_mode(interp::PathMode mode, double tolerance_mm) {
  using Mode = motion::PathControl::Mode;
  state_.path.mode = mode == interp::PathMode::exact_path   ? Mode::exact_path
                     : mode == interp::PathMode::exact_stop ? Mode::exact_stop
                                                            : Mode::continuous;
  state_.path.tolerance_mm = tolerance_mm;
  add_path(state_.path);
}

void CanonToPath::set_naivecam_tolerance(double tolerance_mm) {
  state_.path.naive_cam_tolerance_mm = tolerance_mm;
  add_path(state_.path);
}

/// Feed along the metric of the move: XYZ, else UVW, else ABC.
double CanonToPath::feed_mm_s(const Pose& end) const {
  const Pose d = end - state_.position;
  const bool linear = d.x != 0 || d.y != 0 || d.z != 0 || d.u != 0 || d.v != 0 || d.w != 0;
  double per_minute = linear ? state_.linear_mm_min : state_.angular_deg_min;
  if (state_.feed_mode == interp::FeedMode::per_revolution) per_minute *= nominal_rpm();
  return per_minute / 60.0;
}

double CanonToPath::linear_mm_s() const {
  double per_minute = state_.linear_mm_min;
  if (state_.feed_mode == interp::FeedMode::per_revolution) per_minute *= nominal_rpm();
  return per_minute / 60.0;
}

void CanonToPath::add_rapid(const Pose& from, const Pose& end, MotionKind kind) {
  Pose at = from;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    if ((indexers_ >> a & 1U) == 0 || std::fabs(end[a] - at[a]) <= motion::kLockedSlack) continue;
    at[a] = end[a];
    add_path(motion::LinearMove{at, 0, MotionKind::index_rotary});
  }
  if (!(end == at)) add_path(motion::LinearMove{end, 0, kind});
}

void CanonToPath::traverse_machine(const Pose& end, MotionKind kind) {
  // A move of no length has no direction, hence no place on a path.
  if (end == state_.position) return;
  add_rapid(state_.position, end, kind);
  state_.position = end;
  state_.pending_outputs = 0;
}

void CanonToPath::straight_traverse(const interp::Pose& end) {
  traverse_machine(state_.frame.to_machine(end), MotionKind::traverse);
}

void CanonToPath::straight_feed(const interp::Pose& end) {
  const Pose to = state_.frame.to_machine(end);
  if (to == state_.position) return;
  if (state_.sync_spindle >= 0)
    add_path(motion::SyncMove{to, state_.sync_per_rev_mm, state_.sync_spindle});
  else
    add_path(motion::LinearMove{to, feed_mm_s(to), MotionKind::feed});
  state_.position = to;
  state_.pending_outputs = 0;
}

void CanonToPath::arc_feed(const interp::Arc& arc) {
  // A tool as large as the inside of an arc stands still.
  double gap[3] = {arc.end.x - arc.center[0], arc.end.y - arc.center[1], arc.end.z - arc.center[2]};
  gap[arc.plane == interp::Plane::xy ? 2 : arc.plane == interp::Plane::xz ? 1 : 0] = 0;
  if (std::hypot(gap[0], gap[1], gap[2]) < kNoRadius) {
    straight_feed(arc.end);
    return;
  }
  motion::ArcMove move;
  move.end = state_.frame.to_machine(arc.end);
  const auto centre = state_.frame.to_machine(arc.center);
  auto normal = state_.frame.normal(arc.plane);
  // The move turns right-handed about its normal; a clockwise arc is one about the opposite normal.
  const double sign = arc.turns < 0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    move.centre[i] = centre[i];
    move.normal[i] = sign * normal[i];
  }
  move.turns = std::abs(arc.turns);
  // The feed of an arc is that of XYZ, also of a full circle, whose ends are the same.
  move.vel_mm_s = linear_mm_s();
  add_path(move);
  state_.position = move.end;
  state_.pending_outputs = 0;
}

void CanonToPath::nurbs_feed(std::span<const interp::SplinePoint> points, int order) {
  // Offsets and rotation take lines to lines, so the curve of the moved control points is the moved curve.
  std::vector<interp::SplinePoint> machine(points.begin(), points.end());
  for (interp::SplinePoint& p : machine) {
    const auto at = state_.frame.to_machine(interp::Vector3{p.x, p.y, 0});
    p.x = at[0];
    p.y = at[1];
  }
  const double velocity_mm_s = linear_mm_s();
  const interp::NurbsCurve curve(machine, order);
  const auto drive = [&](const auto& move) {
    add_path(move);
    state_.position = move.end;
    state_.pending_outputs = 0;
  };
  for (const SplinePart& part : spline_parts(curve)) {
    for (const CubicPiece& piece : part.cubics) {
      motion::CubicMove move;
      move.end = state_.position;
      move.end.x = piece.x;
      move.end.y = piece.y;
      move.first = {.x = piece.dx, .y = piece.dy};
      move.second = {.x = piece.ddx, .y = piece.ddy};
      move.length = piece.length;
      move.vel_mm_s = velocity_mm_s;
      drive(move);
    }
    for (const SplinePiece& piece : part.arcs) {
      Pose end = state_.position;
      end.x = piece.x;
      end.y = piece.y;
      if (piece.turn == 0) {
        drive(motion::LinearMove{end, velocity_mm_s, MotionKind::feed});
        continue;
      }
      motion::ArcMove arc;
      arc.end = end;
      arc.centre[0] = piece.cx;
      arc.centre[1] = piece.cy;
      arc.centre[2] = end.z;
      arc.normal[2] = piece.turn;
      arc.vel_mm_s = velocity_mm_s;
      drive(arc);
    }
  }
}

void CanonToPath::set_planner_mode(int, double corner_factor) {
  // There is one planner and it is the smooth one; only a wider corner would be something new.
  if (corner_factor > 0)
    add(ShowMessage{"G64 R has no effect: corners are always rounded within P", MessageKind::text});
}

void CanonToPath::straight_probe(const interp::Pose& end, interp::ProbeKind kind) {
  const Pose to = state_.frame.to_machine(end);
  motion::ProbeMove move{to, feed_mm_s(to)};
  move.until_open = kind == interp::ProbeKind::away || kind == interp::ProbeKind::away_error;
  move.fail_is_error =
      kind == interp::ProbeKind::toward_error || kind == interp::ProbeKind::away_error;
  add_path(move);
  state_.position = to;
  state_.pending_outputs = 0;
}

void CanonToPath::start_speed_feed_sync(int spindle, double mm_per_revolution, bool velocity_mode) {
  // G95 announces itself so too; set_feed_mode has said it.
  if (velocity_mode) return;
  state_.sync_spindle = spindle;
  state_.sync_per_rev_mm = std::fabs(mm_per_revolution);
}

void CanonToPath::stop_speed_feed_sync() { state_.sync_spindle = -1; }

void CanonToPath::rigid_tap(const interp::Pose& end, double return_scale) {
  motion::TapMove tap;
  tap.end = state_.frame.to_machine(end);
  tap.per_rev_mm = state_.sync_per_rev_mm;
  tap.return_factor = return_scale;
  tap.spindle = state_.sync_spindle;
  // It ends where it begins.
  if (tap.end == state_.position) return;
  add_path(tap);
  state_.pending_outputs = 0;
}

/// In G95 the speeds of moves count at the programmed speed of the spindle.
motion::FeedPerRev CanonToPath::feed_per_rev() const {
  motion::FeedPerRev mode;
  if (state_.feed_mode != interp::FeedMode::per_revolution) return mode;
  mode.spindle = state_.feed_spindle;
  mode.rps = nominal_rpm() / 60.0;
  return mode;
}

double CanonToPath::nominal_rpm() const {
  const auto n = static_cast<std::size_t>(state_.feed_spindle);
  // At constant surface speed S is no number of revolutions.
  const double rpm = state_.css_max_rpm[n] > 0 ? 0.0 : state_.speed[n];
  return rpm > 0 ? rpm : kSomeRpm;
}

void CanonToPath::dwell(double seconds) { add_path(motion::Dwell{seconds}); }

SpindleChange CanonToPath::spindle_change(int spindle, SpindleChange::Action action) const {
  const auto n = static_cast<std::size_t>(spindle);
  SpindleChange change;
  change.spindle = spindle;
  change.action = action;
  if (state_.css_max_rpm[n] > 0) {
    change.css_factor = state_.speed[n] / kTwoPi;
    change.css_max_rpm = state_.css_max_rpm[n];
    change.css_center_x_mm = state_.frame.to_machine(Pose{}).x - state_.frame.tool().x;
  } else {
    change.speed_rpm = state_.speed[n];
  }
  return change;
}

void CanonToPath::use_length_units(interp::Units units) {
  state_.surface_mm = units == interp::Units::inch ? 304.8 : 1000.0;
}

void CanonToPath::set_spindle_speed(int spindle, double rpm) {
  const auto n = static_cast<std::size_t>(spindle);
  state_.speed[n] = rpm;
  state_.surface_unit[n] = state_.css_max_rpm[n] > 0 ? state_.surface_mm : 0;
  add_path(spindle_change(spindle, SpindleChange::Action::set_speed));
  if (state_.feed_mode == interp::FeedMode::per_revolution && spindle == state_.feed_spindle)
    add_path(feed_per_rev());
}

void CanonToPath::set_spindle_mode(int spindle, double css_max_rpm) {
  const auto n = static_cast<std::size_t>(spindle);
  state_.css_max_rpm[n] = css_max_rpm;
  // A surface speed in mm/min would be a deadly rpm: without a new S the number that was written counts.
  if (css_max_rpm <= 0 && state_.surface_unit[n] > 0) {
    state_.speed[n] /= state_.surface_unit[n];
    state_.surface_unit[n] = 0;
  }
  if (state_.feed_mode == interp::FeedMode::per_revolution && spindle == state_.feed_spindle)
    add_path(feed_per_rev());
}

void CanonToPath::start_spindle(int spindle, interp::SpindleDirection direction) {
  const bool forward = direction == interp::SpindleDirection::clockwise;
  state_.direction[static_cast<std::size_t>(spindle)] = forward ? std::int8_t{1} : std::int8_t{-1};
  add_path(spindle_change(
      spindle, forward ? SpindleChange::Action::forward : SpindleChange::Action::reverse));
}

void CanonToPath::stop_spindle(int spindle) {
  state_.direction[static_cast<std::size_t>(spindle)] = 0;
  add_path(spindle_change(spindle, SpindleChange::Action::stop));
}

void CanonToPath::orient_spindle(int spindle, double angle_deg, int mode) {
  state_.direction[static_cast<std::size_t>(spindle)] = 0;
  SpindleChange change = spindle_change(spindle, SpindleChange::Action::orient);
  change.orient_angle_deg = angle_deg;
  change.orient_mode = mode;
  add_path(change);
}

void CanonToPath::wait_orient_complete(int spindle, double timeout_s) {
  // The path stands at the orientation, so the path has to count its time.
  if (!list_.empty()) {
    auto* path = std::get_if<PathBody>(&list_.back().body);
    auto* change = path == nullptr ? nullptr : std::get_if<SpindleChange>(path);
    if (change != nullptr && change->action == SpindleChange::Action::orient &&
        change->spindle == spindle)
      change->orient_timeout_s = timeout_s;
  }
  add(WaitOrient{spindle, timeout_s});
}

void CanonToPath::select_tool(int number) {
  state_.selected_tool = number;
  state_.tool_awaits_change = true;
  add(PrepareTool{number});
}

void CanonToPath::change_tool_number(int number) {
  // M6 behind M61 must not fetch the tool of an M6 before it.
  if (!state_.tool_awaits_change) state_.selected_tool = number;
  add(SetToolNumber{number});
}

void CanonToPath::start_change() {
  if (tools_.v2 && tools_.start_change) add(StartChange{});
}

void CanonToPath::change_tool() {
  if (tools_.quill_up) {
    Pose up = state_.position;
    up.z = 0;
    traverse_machine(up, MotionKind::tool_change);
  }
  if (tools_.at_g30) {
    traverse_machine(g30_, MotionKind::tool_change);
  } else if (tools_.has_position) {
    Pose to = state_.position;
    for (std::size_t a = 0; a < rtapi::kAxes; ++a)
      if ((tools_.position_mask & (1U << a)) != 0) to[a] = tools_.position[a];
    traverse_machine(to, MotionKind::tool_change);
  }
  state_.tool_awaits_change = false;
  add(ChangeTool{state_.selected_tool});
}

void CanonToPath::output(int index, bool analog, bool synchronised, double value) {
  const int count = analog ? analog_count_ : digital_count_;
  if (index < 0 || index >= count) {
    char name[40];
    std::snprintf(name, sizeof name, "motion.%s-out-%02d", analog ? "analog" : "digital", index);
    add(ProgramError{std::string(name) + " does not exist: motmod has " + std::to_string(count) +
                         (analog ? " analog outputs (num_aio)" : " digital outputs (num_dio)"),
                     {},
                     0});
    return;
  }
  add_path(motion::OutputChange{index, analog, synchronised, 0, value});
  if (synchronised) ++state_.pending_outputs;
}

void CanonToPath::wait_input(int index, bool analog, interp::WaitMode mode, double timeout_s) {
  add(WaitInput{index, analog, mode, timeout_s});
}

void CanonToPath::enable_feed_override(bool on) {
  state_.overrides.feed = on;
  add_path(state_.overrides);
}
void CanonToPath::enable_speed_override(int spindle, bool on) {
  state_.overrides.spindle[spindle] = on;
  add_path(state_.overrides);
}
void CanonToPath::enable_adaptive_feed(bool on) {
  state_.overrides.adaptive = on;
  add_path(state_.overrides);
}
void CanonToPath::enable_feed_hold(bool on) {
  state_.overrides.feed_hold = on;
  add_path(state_.overrides);
}

void CanonToPath::program_end() {
  pallet_ = false;
  if (state_.pending_outputs > 0) {
    add(ShowMessage{
        "the program ends with M62, M63 or M67 and no move behind it: these outputs do not change",
        MessageKind::text});
    state_.pending_outputs = 0;
  }
  motion::Marker end;
  end.drop_outputs = true;
  add_path(end);
  add(ProgramEnd{});
}

void CanonToPath::user_mcode(int number, std::string_view path, double p, double q) {
  char p_text[64], q_text[64];
  std::snprintf(p_text, sizeof p_text, "%f", p);
  std::snprintf(q_text, sizeof q_text, "%f", q);
  add(UserMcodeRun{number, std::string(path), p_text, q_text});
}

void CanonToPath::log_open(std::string_view path, bool append) {
  add(LogText{append ? LogText::Kind::append : LogText::Kind::open, std::string(path)});
}

}  // namespace kerf::task
