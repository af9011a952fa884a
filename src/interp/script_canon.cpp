// Canonical functions that a script may call by name (the module emccanon). Lengths in program units, as the program has them.
#include <algorithm>
#include <cmath>

#include "interp/codes/families.hpp"
#include "interp/script_self.hpp"

namespace kerf::interp {

namespace {

/// Numbers and texts of one call; what is missing is 0 or "".
class Arguments {
 public:
  Arguments(Core& c, const std::vector<ScriptArgument>& all) : c_(c), all_(all) {}
  [[nodiscard]] double number(std::size_t i) const { return i < all_.size() ? all_[i].number : 0; }
  [[nodiscard]] int whole(std::size_t i) const {
    return static_cast<int>(std::nearbyint(number(i)));
  }
  [[nodiscard]] bool flag(std::size_t i) const { return number(i) != 0; }
  [[nodiscard]] double mm(std::size_t i) const { return c_.mm(number(i)); }
  [[nodiscard]] std::string_view text(std::size_t i) const {
    return c_.out.keep(i < all_.size() ? std::string_view(all_[i].text) : std::string_view());
  }
  [[nodiscard]] Pose pose(std::size_t first) const {
    Pose p;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i)
      p[i] = rtapi::is_rotary(i) ? number(first + i) : mm(first + i);
    return p;
  }

 private:
  Core& c_;
  const std::vector<ScriptArgument>& all_;
};

struct Row {
  std::string_view name;
  std::size_t least;  ///< arguments
  void (*run)(Core& c, const Arguments& a);
};

void start_spindle(Core& c, int spindle, SpindleDirection direction) {
  if (spindle < 0 || spindle >= c.settings.spindles) return;
  c.state.direction[static_cast<std::size_t>(spindle)] = direction;
  if (direction == SpindleDirection::stopped)
    c.out.call<&Canon::stop_spindle>(spindle);
  else
    c.out.call<&Canon::start_spindle>(spindle, direction);
}

void straight(Core& c, const Arguments& a, bool feed) {
  c.state.position = a.pose(1);
  if (feed)
    c.out.call<&Canon::straight_feed>(c.state.position);
  else
    c.out.call<&Canon::straight_traverse>(c.state.position);
}

void wait(Core& c, const Arguments& a) {
  // index, 1 digital or 0 analog, kind of wait, seconds
  const int kind = a.whole(2);
  c.out.call<&Canon::wait_input>(a.whole(0), a.whole(1) == 0,
                                 static_cast<WaitMode>(kind < 0 || kind > 4 ? 0 : kind),
                                 a.number(3));
  c.ask_sync(SyncReason::wait_input);
}

void change_tool(Core& c, const Arguments&) {
  const int number = c.state.selected_tool < 0 ? 0 : c.state.selected_tool;
  c.out.call<&Canon::change_tool>();
  c.spindle_tool = number == 0 && !c.settings.random_toolchanger
                       ? Tool{0, 0, {}, 0, 0, 0, 0}
                       : c.env.find_tool(number).value_or(Tool{number, 0, {}, 0, 0, 0, 0});
  c.state.tool_change = 6;
  c.ask_sync(SyncReason::tool_change);
}

void motion_control(Core& c, const Arguments& a) {
  const int mode = a.whole(0);  // CANON_EXACT_STOP, CANON_EXACT_PATH, CANON_CONTINUOUS
  c.state.path = mode == 1   ? PathMode::exact_stop
                 : mode == 2 ? PathMode::exact_path
                             : PathMode::continuous;
  if (c.state.path == PathMode::continuous) c.state.tolerance_mm = a.mm(1);
  c.out.call<&Canon::set_motion_control_mode>(c.state.path, mode == 3 ? c.state.tolerance_mm : 0.0);
}

/// As if the program had this G-code here.
void g_code(Core& c, int code) {
  const Block none;
  if (const CodeRow* r = c.row('g', code); r != nullptr) (void)r->run(c, none, code);
}

void select_plane(Core& c, const Arguments& a) {
  constexpr int kPlanes[] = {170, 190, 180, 171, 191, 181};  // XY YZ XZ UV VW UW
  if (const int n = a.whole(0); n >= 1 && n <= 6) g_code(c, kPlanes[n - 1]);
}

void speed_override(Core& c, const Arguments& a, bool on) {
  const int n = a.whole(0);
  if (n < 0 || n >= c.settings.spindles) return;
  c.state.speed_override[static_cast<std::size_t>(n)] = on;
  c.out.call<&Canon::enable_speed_override>(n, on);
}

constexpr Row kRows[] = {
    {"SELECT_PLANE", 1, select_plane},
    {"USE_LENGTH_UNITS", 1,
     [](Core& c, const Arguments& a) { g_code(c, a.whole(0) == 1 ? 200 : 210); }},
    {"ENABLE_SPEED_OVERRIDE", 0, [](Core& c, const Arguments& a) { speed_override(c, a, true); }},
    {"DISABLE_SPEED_OVERRIDE", 0, [](Core& c, const Arguments& a) { speed_override(c, a, false); }},
    {"STRAIGHT_TRAVERSE", 4, [](Core& c, const Arguments& a) { straight(c, a, false); }},
    {"STRAIGHT_FEED", 4, [](Core& c, const Arguments& a) { straight(c, a, true); }},
    {"STRAIGHT_PROBE", 4,
     [](Core& c, const Arguments& a) {
       c.state.position = a.pose(1);
       c.out.call<&Canon::straight_probe>(c.state.position, ProbeKind::toward_error);
       c.ask_sync(SyncReason::probe);
     }},
    {"TURN_PROBE_ON", 0, [](Core& c, const Arguments&) { c.out.call<&Canon::turn_probe_on>(); }},
    {"TURN_PROBE_OFF", 0, [](Core& c, const Arguments&) { c.out.call<&Canon::turn_probe_off>(); }},
    {"DWELL", 1, [](Core& c, const Arguments& a) { c.out.call<&Canon::dwell>(a.number(0)); }},
    {"SET_FEED_RATE", 1,
     [](Core& c, const Arguments& a) {
       c.state.feed_word = a.number(0);
       c.state.feed = a.mm(0);
       c.out.call<&Canon::set_feed_rate>(c.state.feed, c.state.feed_word);
     }},
    {"SET_SPINDLE_SPEED", 1,
     [](Core& c, const Arguments& a) {
       // (speed) for spindle 0 or (spindle, speed)
       const bool two = a.number(1) != 0 || a.whole(0) < c.settings.spindles;
       const int n = two ? a.whole(0) : 0;
       if (n < 0 || n >= c.settings.spindles) return;
       c.state.speed_rpm[static_cast<std::size_t>(n)] = a.number(two ? 1 : 0);
       announce_speed(c, n);
     }},
    {"START_SPINDLE_CLOCKWISE", 0,
     [](Core& c, const Arguments& a) {
       start_spindle(c, a.whole(0), SpindleDirection::clockwise);
     }},
    {"START_SPINDLE_COUNTERCLOCKWISE", 0,
     [](Core& c, const Arguments& a) {
       start_spindle(c, a.whole(0), SpindleDirection::counterclockwise);
     }},
    {"STOP_SPINDLE_TURNING", 0,
     [](Core& c, const Arguments& a) { start_spindle(c, a.whole(0), SpindleDirection::stopped); }},
    {"SELECT_TOOL", 1,
     [](Core& c, const Arguments& a) {
       c.state.selected_tool = a.whole(0);
       c.out.call<&Canon::select_tool>(a.whole(0));
     }},
    {"START_CHANGE", 0, [](Core& c, const Arguments&) { c.out.call<&Canon::start_change>(); }},
    {"CHANGE_TOOL", 0, change_tool},
    {"CHANGE_TOOL_NUMBER", 1,
     [](Core& c, const Arguments& a) { c.out.call<&Canon::change_tool_number>(a.whole(0)); }},
    {"RELOAD_TOOLDATA", 0,
     [](Core& c, const Arguments&) { c.out.call<&Canon::reload_tooldata>(); }},
    {"USE_TOOL_LENGTH_OFFSET", 1,
     [](Core& c, const Arguments& a) {
       CanonFrame f = c.state.frame;
       f.use_tool_length_offset(a.pose(0));
       c.set_frame(f);
       c.state.tool_offset_code = f.tool() == Pose{} ? 490 : 430;
       c.out.call<&Canon::use_tool_length_offset>(f.tool());
     }},
    {"MIST_ON", 0,
     [](Core& c, const Arguments&) { c.out.call<&Canon::set_mist>(c.state.mist = true); }},
    {"MIST_OFF", 0,
     [](Core& c, const Arguments&) { c.out.call<&Canon::set_mist>(c.state.mist = false); }},
    {"FLOOD_ON", 0,
     [](Core& c, const Arguments&) { c.out.call<&Canon::set_flood>(c.state.flood = true); }},
    {"FLOOD_OFF", 0,
     [](Core& c, const Arguments&) { c.out.call<&Canon::set_flood>(c.state.flood = false); }},
    {"SET_MOTION_OUTPUT_BIT", 1,
     [](Core& c, const Arguments& a) {
       c.out.call<&Canon::set_motion_output_bit>(a.whole(0), true);
     }},
    {"CLEAR_MOTION_OUTPUT_BIT", 1,
     [](Core& c, const Arguments& a) {
       c.out.call<&Canon::set_motion_output_bit>(a.whole(0), false);
     }},
    {"SET_AUX_OUTPUT_BIT", 1,
     [](Core& c, const Arguments& a) { c.out.call<&Canon::set_aux_output_bit>(a.whole(0), true); }},
    {"CLEAR_AUX_OUTPUT_BIT", 1,
     [](Core& c, const Arguments& a) {
       c.out.call<&Canon::set_aux_output_bit>(a.whole(0), false);
     }},
    {"SET_MOTION_OUTPUT_VALUE", 2,
     [](Core& c, const Arguments& a) {
       c.out.call<&Canon::set_motion_output_value>(a.whole(0), a.number(1));
     }},
    {"SET_AUX_OUTPUT_VALUE", 2,
     [](Core& c, const Arguments& a) {
       c.out.call<&Canon::set_aux_output_value>(a.whole(0), a.number(1));
     }},
    {"WAIT", 4, wait},
    {"SET_MOTION_CONTROL_MODE", 1, motion_control},
    {"SET_NAIVECAM_TOLERANCE", 1,
     [](Core& c, const Arguments& a) {
       c.state.naivecam_tolerance_mm = a.mm(0);
       c.out.call<&Canon::set_naivecam_tolerance>(c.state.naivecam_tolerance_mm);
     }},
    {"ENABLE_FEED_OVERRIDE", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::enable_feed_override>(c.state.feed_override = true);
     }},
    {"DISABLE_FEED_OVERRIDE", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::enable_feed_override>(c.state.feed_override = false);
     }},
    {"ENABLE_FEED_HOLD", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::enable_feed_hold>(c.state.feed_hold = true);
     }},
    {"DISABLE_FEED_HOLD", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::enable_feed_hold>(c.state.feed_hold = false);
     }},
    {"ENABLE_ADAPTIVE_FEED", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::enable_adaptive_feed>(c.state.adaptive_feed = true);
     }},
    {"DISABLE_ADAPTIVE_FEED", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::enable_adaptive_feed>(c.state.adaptive_feed = false);
     }},
    {"PROGRAM_STOP", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::program_stop>();
       c.ask_sync(SyncReason::program_stop);
     }},
    {"OPTIONAL_PROGRAM_STOP", 0,
     [](Core& c, const Arguments&) {
       c.out.call<&Canon::optional_program_stop>();
       c.ask_sync(SyncReason::program_stop);
     }},
    {"PALLET_SHUTTLE", 0, [](Core& c, const Arguments&) { c.out.call<&Canon::pallet_shuttle>(); }},
    {"MESSAGE", 1, [](Core& c, const Arguments& a) { c.out.call<&Canon::message>(a.text(0)); }},
    {"COMMENT", 1, [](Core& c, const Arguments& a) { c.out.call<&Canon::comment>(a.text(0)); }},
    {"LOG", 1, [](Core& c, const Arguments& a) { c.out.call<&Canon::log>(a.text(0)); }},
    {"LOGOPEN", 1,
     [](Core& c, const Arguments& a) { c.out.call<&Canon::log_open>(a.text(0), false); }},
    {"LOGAPPEND", 1,
     [](Core& c, const Arguments& a) { c.out.call<&Canon::log_open>(a.text(0), true); }},
    {"LOGCLOSE", 0, [](Core& c, const Arguments&) { c.out.call<&Canon::log_close>(); }},
};

}  // namespace

std::string CoreSelf::canon(std::string_view name, const std::vector<ScriptArgument>& arguments) {
  if (name.starts_with("enqueue_")) name.remove_prefix(8);
  for (const Row& r : kRows) {
    if (r.name != name) continue;
    if (arguments.size() < r.least)
      return std::string(name) + " takes at least " + std::to_string(r.least) + " arguments";
    r.run(c_, Arguments(c_, arguments));
    return {};
  }
  return std::string(name) + " cannot be called from Python";
}

std::vector<std::string_view> CoreSelf::canon_names() {
  std::vector<std::string_view> out;
  for (const Row& r : kRows) out.push_back(r.name);
  return out;
}

}  // namespace kerf::interp
