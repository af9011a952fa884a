// M70-M73: save and restore of the modal state. Manual: the sections of these names.
#include "interp/codes/families.hpp"

namespace kerf::interp {

namespace {

void restore_feed_and_speed(Core& c, const ModalState& was) {
  ModalState& s = c.state;
  const bool mode_changed = s.feed_mode != was.feed_mode;
  if (mode_changed) {
    s.feed_mode = was.feed_mode;
    s.feed_spindle = was.feed_spindle;
    const bool per_rev = s.feed_mode == ProgramFeedMode::per_revolution;
    c.comment(s.feed_mode == ProgramFeedMode::inverse_time
                  ? "interpreter: feed mode set to inverse time"
              : per_rev ? "interpreter: feed mode set to units per revolution"
                        : "interpreter: feed mode set to units per minute");
    c.out.call<&Canon::set_feed_mode>(s.feed_spindle,
                                      per_rev ? FeedMode::per_revolution : FeedMode::per_minute);
  }
  if (mode_changed || s.feed != was.feed || s.feed_word != was.feed_word) {
    s.feed = was.feed;
    s.feed_word = was.feed_word;
    if (s.feed_mode != ProgramFeedMode::inverse_time)
      c.out.call<&Canon::set_feed_rate>(s.feed, s.feed_word);
  }
}

void restore_spindles(Core& c, const ModalState& was) {
  ModalState& s = c.state;
  for (int i = 0; i < c.settings.spindles; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if (s.speed_rpm[n] != was.speed_rpm[n] || s.css[n] != was.css[n]) {
      s.speed_rpm[n] = was.speed_rpm[n];
      s.css[n] = was.css[n];
      announce_speed(c, i);
    }
    if (s.direction[n] == was.direction[n]) continue;
    s.direction[n] = was.direction[n];
    s.orienting[n] = false;
    if (s.direction[n] == SpindleDirection::stopped)
      c.out.call<&Canon::stop_spindle>(i);
    else
      c.out.call<&Canon::start_spindle>(i, s.direction[n]);
  }
}

void restore_spindle_modes(Core& c, const ModalState& was) {
  for (int i = 0; i < c.settings.spindles; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if (c.state.css_max_rpm[n] == was.css_max_rpm[n]) continue;
    c.state.css_max_rpm[n] = was.css_max_rpm[n];
    c.out.call<&Canon::set_spindle_mode>(i, was.css_max_rpm[n]);
  }
}

/// Runs the handler of a code, as if the program had it here.
bool run(Core& c, int g_code) {
  Block b;
  const CodeRow* r = c.row('g', g_code);
  return r != nullptr && r->run(c, b, g_code);
}

bool same_compensation(const ModalState& a, const ModalState& b) {
  if (a.cutter_comp != b.cutter_comp || a.cutter_comp == 400) return a.cutter_comp == b.cutter_comp;
  if (a.comp_own_tool != b.comp_own_tool) return false;
  return !a.comp_own_tool ||
         (a.comp_diameter_mm == b.comp_diameter_mm && a.comp_orientation == b.comp_orientation);
}

bool restore_geometry(Core& c, const ModalState& was, int tool_then) {
  ModalState& s = c.state;
  const bool comp_changes = !same_compensation(s, was);
  if (comp_changes && s.cutter_comp != 400 && !stop_compensation(c)) return false;
  if (s.plane_code != was.plane_code && !run(c, was.plane_code)) return false;
  if (s.lathe_diameter != was.lathe_diameter && !run(c, was.lathe_diameter ? 70 : 80)) return false;
  // G43 without H is the length of the tool in the spindle, which may be another one now.
  const bool other_tool = was.tool_offset_code == 430 && c.spindle_tool.number != tool_then;
  const Pose offset = other_tool ? c.spindle_tool.offset : was.frame.tool();
  if (s.frame.tool() != offset || s.tool_offset_code != was.tool_offset_code) {
    CanonFrame f = s.frame;
    f.use_tool_length_offset(offset);
    c.set_frame(f);
    s.tool_offset_code = was.tool_offset_code;
    c.out.call<&Canon::use_tool_length_offset>(f.tool());
  }
  constexpr int kSystemCodes[10] = {540, 540, 550, 560, 570, 580, 590, 591, 592, 593};
  if (s.coord_system != was.coord_system && !run(c, kSystemCodes[was.coord_system])) return false;
  // Last: while it is on the others must not change.
  return !comp_changes || was.cutter_comp == 400 || restore_compensation(c, was);
}

void restore_path(Core& c, const ModalState& was) {
  ModalState& s = c.state;
  if (s.path == was.path && s.tolerance_mm == was.tolerance_mm &&
      s.naivecam_tolerance_mm == was.naivecam_tolerance_mm)
    return;
  s.path = was.path;
  s.tolerance_mm = was.tolerance_mm;
  s.naivecam_tolerance_mm = was.naivecam_tolerance_mm;
  announce_path_mode(c);
}

void restore_switches(Core& c, const ModalState& was) {
  ModalState& s = c.state;
  if (!was.mist && !was.flood && (s.mist || s.flood)) s.mist = s.flood = true;  // as M9
  if (s.mist != was.mist) c.out.call<&Canon::set_mist>(s.mist = was.mist);
  if (s.flood != was.flood) c.out.call<&Canon::set_flood>(s.flood = was.flood);
  if (s.feed_override != was.feed_override)
    c.out.call<&Canon::enable_feed_override>(s.feed_override = was.feed_override);
  for (int i = 0; i < c.settings.spindles; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if (s.speed_override[n] != was.speed_override[n])
      c.out.call<&Canon::enable_speed_override>(i, s.speed_override[n] = was.speed_override[n]);
  }
  if (s.adaptive_feed != was.adaptive_feed)
    c.out.call<&Canon::enable_adaptive_feed>(s.adaptive_feed = was.adaptive_feed);
  if (s.feed_hold != was.feed_hold)
    c.out.call<&Canon::enable_feed_hold>(s.feed_hold = was.feed_hold);
}

}  // namespace

bool restore_modes(Core& c, const ModalState& was, int tool_then) {
  // Units first: feeds and lengths are announced in them.
  if (c.state.units != was.units) {
    c.state.units = was.units;
    c.out.call<&Canon::use_length_units>(was.units);
  }
  restore_spindle_modes(c, was);
  restore_feed_and_speed(c, was);
  restore_spindles(c, was);
  if (!restore_geometry(c, was, tool_then)) return false;
  restore_path(c, was);
  if (!run(c, was.distance == DistanceMode::absolute ? 900 : 910) ||
      !run(c, was.arc_distance == DistanceMode::absolute ? 901 : 911))
    return false;
  if (c.state.retract != was.retract && !run(c, was.retract == RetractMode::old_z ? 980 : 990))
    return false;
  restore_switches(c, was);
  return true;
}

namespace {

bool state_code(Core& c, const Block&, int code) {
  Frame& f = c.flows.frames.back();
  if (code == 72) {
    if (!f.saved_state)
      return c.fail(0, "Write M70 before, at the same level",
                    "Cannot restore context from invalid stack frame - missing M70/M73?");
    return restore_modes(c, ModalState(*f.saved_state), f.saved_tool);
  }
  if (code != 70) f.restore_on_return = code == 73;
  f.saved_state.reset();
  if (code == 71) return true;
  f.saved_state = std::make_unique<ModalState>(c.state);
  f.saved_tool = c.spindle_tool.number;
  return true;
}

constexpr CodeRow kRows[] = {
    {'m', 70, 73, 7, kOrderSaveState, state_code, 0, AxisUse::none},
};

}  // namespace

std::span<const CodeRow> state_codes() { return kRows; }

}  // namespace kerf::interp
