// Modes: G7 G8, G17-G19.1, G20 G21, G61 G61.1 G64, G90 G91, G90.1 G91.1, G93-G95, G98 G99.
// Manual: the sections of these names.
#include "interp/codes/families.hpp"

namespace kerf::interp {

void announce_path_mode(Core& c) {
  c.out.call<&Canon::set_motion_control_mode>(
      c.state.path, c.state.path == PathMode::continuous ? c.state.tolerance_mm : 0.0);
  if (c.state.path == PathMode::continuous)
    c.out.call<&Canon::set_naivecam_tolerance>(c.state.naivecam_tolerance_mm);
}

namespace {

bool plane(Core& c, const Block&, int code) {
  if (c.state.cutter_comp != 400 && code != c.state.plane_code)
    return c.fail(0, "Write G40 before", "Cannot change planes with cutter radius compensation on");
  c.state.plane_code = code;
  c.out.call<&Canon::select_plane>(c.state.plane());
  return true;
}

bool units(Core& c, const Block&, int code) {
  c.state.units = code == 200 ? Units::inch : Units::mm;
  c.out.call<&Canon::use_length_units>(c.state.units);
  return true;
}

bool distance(Core& c, const Block&, int code) {
  const auto wanted = code == 900 ? DistanceMode::absolute : DistanceMode::incremental;
  if (c.state.distance == wanted) return true;
  c.state.distance = wanted;
  c.comment(code == 900 ? "interpreter: distance mode changed to absolute"
                        : "interpreter: distance mode changed to incremental");
  return true;
}

bool arc_distance(Core& c, const Block&, int code) {
  const auto wanted = code == 901 ? DistanceMode::absolute : DistanceMode::incremental;
  if (c.state.arc_distance == wanted) return true;
  c.state.arc_distance = wanted;
  c.comment(code == 901 ? "interpreter: IJK distance mode changed to absolute"
                        : "interpreter: IJK distance mode changed to incremental");
  return true;
}

bool lathe(Core& c, const Block&, int code) {
  if (c.state.lathe_diameter == (code == 70)) return true;
  c.state.lathe_diameter = code == 70;
  c.out.call_at_once<&Canon::comment>(
      c.out.keep(code == 70 ? "interpreter: Lathe diameter mode changed to diameter"
                            : "interpreter: Lathe diameter mode changed to radius"));
  return true;
}

bool feed_mode(Core& c, const Block& b, int code) {
  if (code == 930) {
    c.comment("interpreter: feed mode set to inverse time");
    c.out.call<&Canon::set_feed_mode>(0, FeedMode::per_minute);
    c.state.feed_mode = ProgramFeedMode::inverse_time;
    return true;
  }
  const bool per_rev = code == 950;
  int spindle = 0;
  if (per_rev && !one_spindle(c, b, "Invalid spindle ($) number in feed mode command", spindle))
    return false;
  c.comment(per_rev ? "interpreter: feed mode set to units per revolution"
                    : "interpreter: feed mode set to units per minute");
  c.state.feed_mode = per_rev ? ProgramFeedMode::per_revolution : ProgramFeedMode::per_minute;
  c.state.feed_spindle = spindle;
  c.state.feed = c.state.feed_word = 0;  // a number of the old mode would mean something else now
  c.out.call<&Canon::set_feed_mode>(spindle,
                                    per_rev ? FeedMode::per_revolution : FeedMode::per_minute);
  c.out.call<&Canon::set_feed_rate>(0.0, 0.0);
  return true;
}

/// G64 R.
bool planner(Core& c, const Block& b) {
  const double r = b['r'];
  if (r < 0) return c.fail('r', "R is 0 or more", "Negative R word used with G64");
  if (r > 0 && c.settings.smooth_planner == 0)
    return c.fail('r', "Set [TRAJ]SMOOTH_PLANNER to 1, or leave R out",
                  "R word used with G64, but [TRAJ]SMOOTH_PLANNER is 0");
  c.out.call<&Canon::set_planner_mode>(r > 0 ? c.settings.smooth_planner : 0, r);
  return true;
}

bool path(Core& c, const Block& b, int code) {
  if (code != 640) {
    c.state.path = code == 610 ? PathMode::exact_path : PathMode::exact_stop;
    announce_path_mode(c);
    return true;
  }
  const double p = b.has('p') ? c.mm(b['p']) : c.settings.g64_default_tolerance_mm;
  double q = b.has('p') ? p : c.settings.g64_default_naivecam_mm;
  if (b.has('q')) q = c.mm(b['q']);
  c.state.path = PathMode::continuous;
  c.state.tolerance_mm = p > 0 ? p : 0;
  c.state.naivecam_tolerance_mm = q > 0 ? q : 0;
  announce_path_mode(c);
  const bool for_motion = b.motion != nullptr && (b.motion->words & letters("r")) != 0;
  return !b.has('r') || for_motion || planner(c, b);
}

bool retract(Core& c, const Block&, int code) {
  c.state.retract = code == 980 ? RetractMode::old_z : RetractMode::r_plane;
  c.comment(code == 980 ? "interpreter: retract mode set to old_z"
                        : "interpreter: retract mode set to r_plane");
  return true;
}

constexpr CodeRow row(std::int16_t code, std::int8_t group, std::int16_t order, CodeHandler run,
                      LetterMask words = 0) {
  return {'g', code, code, group, order, run, words, AxisUse::none};
}
constexpr CodeRow kRows[] = {
    row(70, 15, kOrderLathe, lathe),
    row(80, 15, kOrderLathe, lathe),
    row(170, 2, kOrderPlane, plane),
    row(171, 2, kOrderPlane, plane),
    row(180, 2, kOrderPlane, plane),
    row(181, 2, kOrderPlane, plane),
    row(190, 2, kOrderPlane, plane),
    row(191, 2, kOrderPlane, plane),
    row(200, 6, kOrderUnits, units),
    row(210, 6, kOrderUnits, units),
    row(610, 13, kOrderPath, path),
    row(611, 13, kOrderPath, path),
    row(640, 13, kOrderPath, path, letters("pqr")),
    row(900, 3, kOrderDistance, distance),
    row(910, 3, kOrderDistance, distance),
    row(901, 4, kOrderArcDistance, arc_distance),
    row(911, 4, kOrderArcDistance, arc_distance),
    row(930, 5, kOrderFeedMode, feed_mode),
    row(940, 5, kOrderFeedMode, feed_mode),
    row(950, 5, kOrderFeedMode, feed_mode, letters("$")),
    row(980, 10, kOrderRetract, retract),
    row(990, 10, kOrderRetract, retract),
};

}  // namespace

std::span<const CodeRow> mode_codes() { return kRows; }

}  // namespace kerf::interp
