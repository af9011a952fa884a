#include "interp/script_self.hpp"

#include <cmath>

#include "interp/codes/families.hpp"
#include "interp/remap_glue.hpp"

namespace kerf::interp {

namespace {

using Kind = ScriptNumber::Kind;

struct Row {
  std::string_view name;
  Kind kind;
  double (*get)(const Core& c, std::size_t index);
  void (*set)(Core& c, std::size_t index, double value);  ///< null: read only
};

double length(const Core& c, const Pose& p, std::size_t axis) {
  return rtapi::is_rotary(axis) ? p[axis] : p[axis] / c.state.unit_mm();
}
template <std::size_t Axis>
double position(const Core& c, std::size_t) {
  return length(c, c.state.position, Axis);
}
template <std::size_t Axis>
double work_offset(const Core& c, std::size_t) {
  return length(c, c.state.frame.g5x(), Axis);
}
template <std::size_t Axis>
double g92_offset(const Core& c, std::size_t) {
  return length(c, c.state.frame.g92(), Axis);
}
template <std::size_t Axis>
void set_position(Core& c, std::size_t, double v) {
  c.state.position[Axis] = rtapi::is_rotary(Axis) ? v : v * c.state.unit_mm();
}
double tool_offset(const Core& c, std::size_t axis) {
  return axis < rtapi::kAxes ? length(c, c.state.frame.tool(), axis) : 0;
}
std::size_t spindle(std::size_t index) { return index < kMaxSpindles ? index : 0; }
int whole(double v) { return static_cast<int>(std::nearbyint(v)); }
double one_if(bool b) { return b ? 1.0 : 0.0; }

constexpr Kind kReal = Kind::real, kInt = Kind::integer, kBool = Kind::boolean;

// The names of the peer's `self` (manual: "Extending the interpreter with Python").
constexpr Row kRows[] = {
    {"current_x", kReal, position<0>, set_position<0>},
    {"current_y", kReal, position<1>, set_position<1>},
    {"current_z", kReal, position<2>, set_position<2>},
    {"AA_current", kReal, position<3>, set_position<3>},
    {"BB_current", kReal, position<4>, set_position<4>},
    {"CC_current", kReal, position<5>, set_position<5>},
    {"u_current", kReal, position<6>, set_position<6>},
    {"v_current", kReal, position<7>, set_position<7>},
    {"w_current", kReal, position<8>, set_position<8>},
    {"program_x", kReal, position<0>, nullptr},
    {"program_y", kReal, position<1>, nullptr},
    {"program_z", kReal, position<2>, nullptr},
    {"origin_offset_x", kReal, work_offset<0>, nullptr},
    {"origin_offset_y", kReal, work_offset<1>, nullptr},
    {"origin_offset_z", kReal, work_offset<2>, nullptr},
    {"AA_origin_offset", kReal, work_offset<3>, nullptr},
    {"BB_origin_offset", kReal, work_offset<4>, nullptr},
    {"CC_origin_offset", kReal, work_offset<5>, nullptr},
    {"u_origin_offset", kReal, work_offset<6>, nullptr},
    {"v_origin_offset", kReal, work_offset<7>, nullptr},
    {"w_origin_offset", kReal, work_offset<8>, nullptr},
    {"axis_offset_x", kReal, g92_offset<0>, nullptr},
    {"axis_offset_y", kReal, g92_offset<1>, nullptr},
    {"axis_offset_z", kReal, g92_offset<2>, nullptr},
    {"AA_axis_offset", kReal, g92_offset<3>, nullptr},
    {"BB_axis_offset", kReal, g92_offset<4>, nullptr},
    {"CC_axis_offset", kReal, g92_offset<5>, nullptr},
    {"u_axis_offset", kReal, g92_offset<6>, nullptr},
    {"v_axis_offset", kReal, g92_offset<7>, nullptr},
    {"w_axis_offset", kReal, g92_offset<8>, nullptr},
    {"tool_offset", kReal, tool_offset, nullptr},
    {"rotation_xy", kReal, [](const Core& c, std::size_t) { return c.state.frame.rotation_deg(); },
     nullptr},
    {"call_level", kInt,
     [](const Core& c, std::size_t) {
       return c.flows.frames.empty() ? 0.0 : static_cast<double>(c.flows.frames.size() - 1);
     },
     nullptr},
    {"remap_level", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.remap_level()); }, nullptr},
    {"stack_index", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.flows.frames.size()); },
     nullptr},
    {"current_tool", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.spindle_tool.number); },
     [](Core& c, std::size_t, double v) { c.spindle_tool.number = whole(v); }},
    {"current_pocket", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.spindle_tool.pocket); },
     [](Core& c, std::size_t, double v) { c.spindle_tool.pocket = whole(v); }},
    {"selected_tool", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.state.selected_tool); },
     [](Core& c, std::size_t, double v) { c.state.selected_tool = whole(v); }},
    {"selected_pocket", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.state.selected_pocket); },
     [](Core& c, std::size_t, double v) { c.state.selected_pocket = whole(v); }},
    {"toolchange_flag", kBool,
     [](const Core& c, std::size_t) { return one_if(c.sync == SyncReason::tool_change); },
     [](Core& c, std::size_t, double v) {
       if (v != 0) c.ask_sync(SyncReason::tool_change);
     }},
    {"tool_change_flag", kBool,
     [](const Core& c, std::size_t) { return one_if(c.sync == SyncReason::tool_change); },
     [](Core& c, std::size_t, double v) {
       if (v != 0) c.ask_sync(SyncReason::tool_change);
     }},
    {"probe_flag", kBool,
     [](const Core& c, std::size_t) { return one_if(c.sync == SyncReason::probe); },
     [](Core& c, std::size_t, double v) {
       if (v != 0) c.ask_sync(SyncReason::probe);
     }},
    {"input_flag", kBool,
     [](const Core& c, std::size_t) { return one_if(c.sync == SyncReason::wait_input); },
     [](Core& c, std::size_t, double v) {
       if (v != 0) c.ask_sync(SyncReason::wait_input);
     }},
    {"speed", kReal,
     [](const Core& c, std::size_t i) { return c.state.speed_rpm[spindle(i)]; },
     [](Core& c, std::size_t i, double v) { c.state.speed_rpm[spindle(i)] = v; }},
    {"spindle_turning", kInt,
     [](const Core& c, std::size_t i) {
       const auto d = c.state.direction[spindle(i)];
       return d == SpindleDirection::stopped ? 1.0 : d == SpindleDirection::clockwise ? 2.0 : 3.0;
     },
     nullptr},
    {"spindle_mode", kInt,
     [](const Core& c, std::size_t i) { return one_if(c.state.css[spindle(i)]); }, nullptr},
    {"speed_override", kBool,
     [](const Core& c, std::size_t i) { return one_if(c.state.speed_override[spindle(i)]); },
     nullptr},
    {"active_spindle", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.state.speed_spindle); },
     [](Core& c, std::size_t, double v) { c.state.speed_spindle = whole(v); }},
    {"num_spindles", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.settings.spindles); }, nullptr},
    {"feed_rate", kReal, [](const Core& c, std::size_t) { return c.state.feed_word; },
     [](Core& c, std::size_t, double v) {
       c.state.feed_word = v;
       c.state.feed = c.state.feed_mode == ProgramFeedMode::inverse_time ? v : c.mm(v);
     }},
    {"feed_mode", kInt,
     [](const Core& c, std::size_t) {
       return c.state.feed_mode == ProgramFeedMode::per_minute     ? 0.0
              : c.state.feed_mode == ProgramFeedMode::inverse_time ? 1.0
                                                                   : 2.0;
     },
     nullptr},
    {"feed_override", kBool,
     [](const Core& c, std::size_t) { return one_if(c.state.feed_override); }, nullptr},
    {"traverse_rate", kReal, [](const Core&, std::size_t) { return 0.0; }, nullptr},
    {"motion_mode", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.state.motion); },
     [](Core& c, std::size_t, double v) { c.state.motion = whole(v); }},
    {"distance_mode", kInt,
     [](const Core& c, std::size_t) {
       return one_if(c.state.distance == DistanceMode::incremental);
     },
     nullptr},
    {"ijk_distance_mode", kInt,
     [](const Core& c, std::size_t) {
       return one_if(c.state.arc_distance == DistanceMode::incremental);
     },
     nullptr},
    {"length_units", kInt,
     [](const Core& c, std::size_t) { return c.state.units == Units::inch ? 1.0 : 2.0; }, nullptr},
    {"plane", kInt,
     [](const Core& c, std::size_t) {
       const Plane p = c.state.plane();
       return p == Plane::xy ? 1.0 : p == Plane::yz ? 2.0 : 3.0;
     },
     nullptr},
    {"retract_mode", kInt,
     [](const Core& c, std::size_t) { return one_if(c.state.retract == RetractMode::old_z); },
     nullptr},
    {"origin_index", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.state.coord_system); }, nullptr},
    {"cutter_comp_side", kInt,
     [](const Core& c, std::size_t) {
       return c.state.cutter_comp == 400 ? 0.0 : c.state.cutter_comp < 420 ? 2.0 : 1.0;
     },
     nullptr},
    {"cycle_r", kReal,
     [](const Core& c, std::size_t) { return c.state.cycle.r / c.state.unit_mm(); }, nullptr},
    {"cycle_cc", kReal,
     [](const Core& c, std::size_t) { return c.state.cycle.bottom / c.state.unit_mm(); }, nullptr},
    {"cutter_comp_radius", kReal,
     [](const Core& c, std::size_t) { return c.compensation.radius_mm() / c.state.unit_mm(); },
     nullptr},
    {"speed_feed_mode", kInt, [](const Core&, std::size_t) { return 2.0; }, nullptr},
    {"mdi_interrupt", kBool, [](const Core&, std::size_t) { return 0.0; }, nullptr},
    {"arc_not_allowed", kBool,
     [](const Core& c, std::size_t) { return one_if(c.compensation.leaving()); }, nullptr},
    {"cycle_p", kReal, [](const Core& c, std::size_t) { return c.state.cycle.p; }, nullptr},
    {"cycle_q", kReal,
     [](const Core& c, std::size_t) { return c.state.cycle.q / c.state.unit_mm(); }, nullptr},
    {"cycle_i", kReal,
     [](const Core& c, std::size_t) { return c.state.cycle.i / c.state.unit_mm(); }, nullptr},
    {"cycle_j", kReal,
     [](const Core& c, std::size_t) { return c.state.cycle.j / c.state.unit_mm(); }, nullptr},
    {"cycle_k", kReal,
     [](const Core& c, std::size_t) { return c.state.cycle.k / c.state.unit_mm(); }, nullptr},
    {"mist", kBool, [](const Core& c, std::size_t) { return one_if(c.state.mist); }, nullptr},
    {"flood", kBool, [](const Core& c, std::size_t) { return one_if(c.state.flood); }, nullptr},
    {"percent_flag", kBool,
     [](const Core& c, std::size_t) { return one_if(c.state.percent_file); }, nullptr},
    {"return_value", kReal, [](const Core& c, std::size_t) { return c.sub_value; },
     [](Core& c, std::size_t, double v) { c.sub_value = v; }},
    {"value_returned", kInt,
     [](const Core& c, std::size_t) { return one_if(c.sub_value_returned); },
     [](Core& c, std::size_t, double v) { c.sub_value_returned = v != 0; }},
    {"sequence_number", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.state.line); }, nullptr},
    {"task", kInt, [](const Core& c, std::size_t) { return one_if(c.settings.is_task); }, nullptr},
    {"random_toolchanger", kInt,
     [](const Core& c, std::size_t) { return one_if(c.settings.random_toolchanger); }, nullptr},
    {"debugmask", kInt, [](const Core& c, std::size_t) { return static_cast<double>(c.settings.debug_mask); }, nullptr},
    {"loggingLevel", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.settings.log_level); }, nullptr},
    {"loglevel", kInt,
     [](const Core& c, std::size_t) { return static_cast<double>(c.settings.log_level); }, nullptr},
    {"active_g_codes", kInt,
     [](const Core& c, std::size_t i) {
       const auto g = c.state.active_g_codes();
       return i < g.size() ? static_cast<double>(g[i]) : -1.0;
     },
     nullptr},
    {"active_m_codes", kInt,
     [](const Core& c, std::size_t i) {
       const auto m = c.state.active_m_codes();
       return i < m.size() ? static_cast<double>(m[i]) : -1.0;
     },
     nullptr},
    {"active_settings", kReal,
     [](const Core& c, std::size_t i) {
       const auto s = c.state.settings();
       return i < s.size() ? s[i] : 0.0;
     },
     nullptr},
};

const Row* find_row(std::string_view name) {
  for (const Row& r : kRows) {
    if (r.name == name) return &r;
  }
  return nullptr;
}

std::string lower_name(std::string_view name) {
  std::string out;
  for (const char ch : name) {
    if (ch != ' ' && ch != '\t') out += ch >= 'A' && ch <= 'Z' ? static_cast<char>(ch + 32) : ch;
  }
  return out;
}

}  // namespace

std::optional<ScriptNumber> CoreSelf::number(std::string_view name, int index) {
  const Row* r = find_row(name);
  if (r == nullptr || index < 0) return std::nullopt;
  return ScriptNumber{r->kind, r->get(c_, static_cast<std::size_t>(index))};
}

bool CoreSelf::set_number(std::string_view name, int index, double value) {
  const Row* r = find_row(name);
  if (r == nullptr || r->set == nullptr || index < 0) return false;
  r->set(c_, static_cast<std::size_t>(index), value);
  return true;
}

std::optional<std::string> CoreSelf::text(std::string_view name) {
  if (name == "filename") return std::string(c_.current_file());
  if (name == "linetext") {
    const RemapCall* call = block_of(0);
    return std::string(call != nullptr         ? call->parsed.text
                       : c_.current != nullptr ? c_.current->text
                                               : std::string_view());
  }
  return std::nullopt;
}

std::vector<std::string_view> CoreSelf::names() {
  std::vector<std::string_view> out;
  for (const Row& r : kRows) out.push_back(r.name);
  return out;
}

std::optional<double> CoreSelf::parameter(int index) {
  if (index < 1 || index >= kParameterCount) return std::nullopt;
  return c_.parameter(index);
}

bool CoreSelf::set_parameter(int index, double value) {
  if (index < 1 || index >= kParameterCount || ParameterTable::read_only(index)) return false;
  c_.params.set(index, value);
  return true;
}

std::optional<double> CoreSelf::parameter(std::string_view name) {
  Value v;
  bool exists = false;
  if (!c_.read_named(c_.params.intern(lower_name(name)), v, exists)) return std::nullopt;
  return v.number;
}

bool CoreSelf::set_parameter(std::string_view name, double value) {
  const std::string lower = lower_name(name);
  if (Predefined::find(lower) != nullptr) return false;
  return c_.set_local(lower, value);
}

std::vector<std::string> CoreSelf::parameter_names() {
  std::vector<std::string_view> names = c_.params.visible_names();
  Predefined::add_names(names);
  return {names.begin(), names.end()};
}

const RemapCall* CoreSelf::block_of(int level) const {
  const auto& frames = c_.flows.frames;
  if (level == 0) {  // the call in progress
    for (std::size_t i = frames.size(); i-- > 0;)
      if (frames[i].remap != nullptr) return frames[i].remap.get();
    return nullptr;
  }
  for (const Frame& f : frames) {
    if (f.remap != nullptr && f.remap->remap != nullptr && --level == 0) return f.remap.get();
  }
  return nullptr;
}

std::optional<double> CoreSelf::word(int level, char letter) {
  const RemapCall* call = block_of(level);
  if (call == nullptr || letter_index(letter) < 0 || !call->block.has(letter)) return std::nullopt;
  return call->block[letter];
}

std::string CoreSelf::block_text(int level, std::string_view what) {
  const RemapCall* call = block_of(level);
  if (call == nullptr) return {};
  if (what == "comment")
    return call->parsed.comment != CommentKind::none ? std::string(call->parsed.comment_text)
                                                     : std::string();
  if (what == "text") return std::string(call->parsed.text);
  const std::string& label = c_.flows.labels.text(call->parsed.label);
  return label.size() > 2 && label[0] == '<' ? label.substr(1, label.size() - 2) : label;
}

std::optional<ScriptNumber> CoreSelf::block_number(int level, std::string_view what, int index) {
  const RemapCall* call = block_of(level);
  if (call == nullptr) return std::nullopt;
  if (what == "line_number" || what == "saved_line_number")
    return ScriptNumber{kInt, static_cast<double>(call->parsed.place.line + 1)};
  if (what == "n_number") return ScriptNumber{kInt, static_cast<double>(call->parsed.sequence)};
  if (what == "motion_to_be")
    return ScriptNumber{kInt, static_cast<double>(call->block.motion_code)};
  if (what == "builtin_used") return ScriptNumber{kBool, one_if(call->builtin_used)};
  if (what == "g_modes")
    return ScriptNumber{kInt, static_cast<double>(call->block.code_of('g', index))};
  if (what == "m_modes")
    return ScriptNumber{kInt, static_cast<double>(call->block.code_of('m', index))};
  return std::nullopt;
}

std::optional<std::string> CoreSelf::call_text(int level, std::string_view what) {
  const auto& frames = c_.flows.frames;
  if (level < 0 || static_cast<std::size_t>(level) >= frames.size()) return std::nullopt;
  const Frame& f = frames[static_cast<std::size_t>(level)];
  if (what == "subname") {
    const std::string& label = c_.flows.labels.text(f.sub);
    return label.size() > 2 && label[0] == '<' ? label.substr(1, label.size() - 2) : label;
  }
  return c_.flows.programs[f.program].path;
}

ScriptTool CoreSelf::script_tool(const Tool& tool) const {
  ScriptTool out;
  out.number = tool.number;
  out.pocket = tool.pocket;
  const double unit = c_.settings.machine_unit_mm;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    out.offset[i] = rtapi::is_rotary(i) ? tool.offset[i] : tool.offset[i] / unit;
  out.diameter = tool.diameter_mm / unit;
  out.front_angle = tool.front_angle_deg;
  out.back_angle = tool.back_angle_deg;
  out.orientation = tool.orientation;
  return out;
}

std::optional<ScriptTool> CoreSelf::tool(int number) {
  const auto found = c_.env.find_tool(number);
  if (!found) return std::nullopt;
  return script_tool(*found);
}

ScriptTool CoreSelf::tool_in_spindle() { return script_tool(c_.spindle_tool); }

std::string CoreSelf::glue(std::string_view function) {
  const NativeGlue run = find_native_glue(function);
  RemapCall* call = nullptr;
  for (std::size_t i = c_.flows.frames.size(); i-- > 0 && call == nullptr;)
    call = c_.flows.frames[i].remap.get();
  if (run == nullptr || call == nullptr || call->remap == nullptr)
    return std::string(function) + " works inside remapped codes only";
  return run(c_, *call) ? std::string() : c_.error.text;
}

}  // namespace kerf::interp
