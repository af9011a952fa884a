// Stops, program end and user M-codes: M0 M1 M60, M2 M30, M100-M199. Manual: the sections of these names.
#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

bool stop(Core& c, const Block&, int code) {
  c.state.last_stop = code;
  if (code == 60) c.out.call<&Canon::pallet_shuttle>();
  if (code == 1)
    c.out.call<&Canon::optional_program_stop>();
  else
    c.out.call<&Canon::program_stop>();
  c.ask_sync(SyncReason::program_stop);
  return true;
}

}  // namespace

void reset_g92_at_end(Core& c) {
  if (!c.settings.disable_g92_persistence || !c.state.g92_applied) return;
  CanonFrame f = c.state.frame;
  f.set_g92_offset({});
  c.set_frame(f);
  c.state.g92_applied = false;
  c.params.set(kG92Applied, 0);
  c.params.set_pose(kG92Offset, {}, c.settings.machine_unit_mm);
  c.out.call<&Canon::set_g92_offset>(Pose{});
}

namespace {

/// G54, without touching G92.
void default_work_offset(Core& c) {
  if (!c.settings.disable_auto_g54) {
    CanonFrame f = c.state.frame;
    f.set_g5x_offset(c.params.pose(kG5xOffset, c.settings.machine_unit_mm));
    f.set_xy_rotation(c.params.get(kG5xOffset + 9));
    c.state.coord_system = 1;
    c.params.set(kCoordSystem, 1);
    c.set_frame(f);
  }
  reset_g92_at_end(c);
  c.out.call<&Canon::set_g5x_offset>(c.state.coord_system, c.state.frame.g5x());
  c.out.call<&Canon::set_xy_rotation>(c.state.frame.rotation_deg());
}

}  // namespace

bool end_program(Core& c, int code) {
  ModalState& s = c.state;
  if (!c.compensation.end_program(true)) return false;
  default_work_offset(c);
  if (s.plane_code != 170) {
    s.plane_code = 170;
    c.out.call<&Canon::select_plane>(Plane::xy);
  }
  s.distance = DistanceMode::absolute;
  s.feed_mode = ProgramFeedMode::per_minute;
  s.feed = s.feed_word = 0;
  c.out.call<&Canon::set_feed_mode>(0, FeedMode::per_minute);
  c.out.call<&Canon::set_feed_rate>(0.0, 0.0);
  if (!s.feed_override) c.out.call<&Canon::enable_feed_override>(s.feed_override = true);
  for (int i = 0; i < c.settings.spindles; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if (!s.speed_override[n])
      c.out.call<&Canon::enable_speed_override>(i, s.speed_override[n] = true);
  }
  s.cutter_comp = 400;
  for (int i = 0; i < c.settings.spindles; ++i) {
    const auto n = static_cast<std::size_t>(i);
    s.direction[n] = SpindleDirection::stopped;
    s.css[n] = s.orienting[n] = false;
    s.css_max_rpm[n] = 0;
    c.out.call<&Canon::stop_spindle>(i);
    c.out.call<&Canon::set_spindle_mode>(i, 0.0);
  }
  s.motion = 10;
  if (s.mist) c.out.call<&Canon::set_mist>(s.mist = false);
  if (s.flood) c.out.call<&Canon::set_flood>(s.flood = false);
  if (code == 30) c.out.call<&Canon::pallet_shuttle>();
  c.out.call<&Canon::program_end>();
  s.last_stop = code;
  c.ended = true;
  return true;
}

namespace {

bool end(Core& c, const Block&, int code) { return end_program(c, code); }

/// At the beginning of a line M98 and M99 direct the flow (flow_words.cpp); elsewhere they mean nothing.
bool misplaced(Core& c, const Block&, int code) {
  return c.fail(0, "Write it first, on a line of its own", "Unknown m code used: M%d", code);
}

bool user_code(Core& c, const Block& b, int code) {
  const UserMcode found = c.env.find_user_mcode(code);
  if (found.path.empty()) return c.fail(0, found.cause.c_str(), "Unknown m code used: M%d", code);
  c.out.call<&Canon::user_mcode>(code, c.out.keep(found.path), b.get('p', -1), b.get('q', -1));
  c.ask_sync(SyncReason::user_mcode);
  return true;
}

constexpr CodeRow kRows[] = {
    {'m', 0, 1, 4, kOrderStop, stop, 0, AxisUse::none},
    {'m', 60, 60, 4, kOrderStop, stop, 0, AxisUse::none},
    {'m', 2, 2, 4, kOrderStop, end, 0, AxisUse::none},
    {'m', 30, 30, 4, kOrderStop, end, 0, AxisUse::none},
    {'m', 98, 98, 4, 0, misplaced, letters("pl"), AxisUse::none},
    {'m', 99, 99, 4, 0, misplaced, 0, AxisUse::none},
    {'m', 100, 199, 10, kOrderUser, user_code, letters("pq"), AxisUse::none},
};

}  // namespace

std::span<const CodeRow> program_codes() { return kRows; }

}  // namespace kerf::interp
