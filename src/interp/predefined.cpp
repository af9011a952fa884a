#include "interp/predefined.hpp"

#include "interp/core.hpp"

namespace kerf::interp {

namespace {

using Getter = Predefined::Getter;

double one_if(bool b) { return b ? 1.0 : 0.0; }

template <std::size_t Axis>
double relative(const Core& c) {
  return c.parameter(kPosition + static_cast<int>(Axis));
}
template <std::size_t Axis>
double absolute(const Core& c) {
  const double v = c.state.frame.to_machine(c.shown_position())[Axis];
  return rtapi::is_rotary(Axis) ? v : in_units(v, c.state.unit_mm());
}

constexpr int kSystemCode[10] = {0, 540, 550, 560, 570, 580, 590, 591, 592, 593};

struct Row {
  std::string_view name;
  Getter get;
};

// _vmajor and _vminor say which LinuxCNC a program may expect: 2.10.
constexpr Row kRows[] = {
    {"_vmajor", [](const Core&) { return 2.10; }},
    {"_vminor", [](const Core&) { return 0.0; }},
    {"_line", [](const Core& c) { return static_cast<double>(c.state.line); }},
    {"_motion_mode", [](const Core& c) { return static_cast<double>(c.state.motion); }},
    {"_plane", [](const Core& c) { return static_cast<double>(c.state.plane_code); }},
    {"_ccomp", [](const Core& c) { return static_cast<double>(c.state.cutter_comp); }},
    {"_metric", [](const Core& c) { return one_if(c.state.units == Units::mm); }},
    {"_imperial", [](const Core& c) { return one_if(c.state.units == Units::inch); }},
    {"_absolute", [](const Core& c) { return one_if(c.state.distance == DistanceMode::absolute); }},
    {"_incremental",
     [](const Core& c) { return one_if(c.state.distance == DistanceMode::incremental); }},
    {"_inverse_time",
     [](const Core& c) { return one_if(c.state.feed_mode == ProgramFeedMode::inverse_time); }},
    {"_units_per_minute",
     [](const Core& c) { return one_if(c.state.feed_mode == ProgramFeedMode::per_minute); }},
    {"_units_per_rev",
     [](const Core& c) { return one_if(c.state.feed_mode == ProgramFeedMode::per_revolution); }},
    {"_coord_system",
     [](const Core& c) { return static_cast<double>(kSystemCode[c.state.coord_system]); }},
    {"_tool_offset", [](const Core& c) { return one_if(c.state.tool_offset_code != 490); }},
    {"_retract_r_plane",
     [](const Core& c) { return one_if(c.state.retract == RetractMode::r_plane); }},
    {"_retract_old_z", [](const Core& c) { return one_if(c.state.retract == RetractMode::old_z); }},
    {"_spindle_rpm_mode", [](const Core& c) { return one_if(!c.state.css[0]); }},
    {"_spindle_css_mode", [](const Core& c) { return one_if(c.state.css[0]); }},
    {"_ijk_absolute_mode",
     [](const Core& c) { return one_if(c.state.arc_distance == DistanceMode::absolute); }},
    {"_lathe_diameter_mode", [](const Core& c) { return one_if(c.state.lathe_diameter); }},
    {"_lathe_radius_mode", [](const Core& c) { return one_if(!c.state.lathe_diameter); }},
    {"_spindle_on",
     [](const Core& c) { return one_if(c.state.direction[0] != SpindleDirection::stopped); }},
    {"_spindle_cw",
     [](const Core& c) { return one_if(c.state.direction[0] == SpindleDirection::clockwise); }},
    {"_mist", [](const Core& c) { return one_if(c.state.mist); }},
    {"_flood", [](const Core& c) { return one_if(c.state.flood); }},
    {"_speed_override", [](const Core& c) { return one_if(c.state.speed_override[0]); }},
    {"_feed_override", [](const Core& c) { return one_if(c.state.feed_override); }},
    {"_adaptive_feed", [](const Core& c) { return one_if(c.state.adaptive_feed); }},
    {"_feed_hold", [](const Core& c) { return one_if(c.state.feed_hold); }},
    {"_feed", [](const Core& c) { return c.state.feed_word; }},
    {"_rpm", [](const Core& c) { return c.state.speed_rpm[0]; }},
    {"_x", relative<0>},
    {"_y", relative<1>},
    {"_z", relative<2>},
    {"_a", relative<3>},
    {"_b", relative<4>},
    {"_c", relative<5>},
    {"_u", relative<6>},
    {"_v", relative<7>},
    {"_w", relative<8>},
    {"_abs_x", absolute<0>},
    {"_abs_y", absolute<1>},
    {"_abs_z", absolute<2>},
    {"_abs_a", absolute<3>},
    {"_abs_b", absolute<4>},
    {"_abs_c", absolute<5>},
    {"_abs_u", absolute<6>},
    {"_abs_v", absolute<7>},
    {"_abs_w", absolute<8>},
    {"_current_tool", [](const Core& c) { return c.parameter(kToolNumber); }},
    {"_current_pocket", [](const Core& c) { return static_cast<double>(c.spindle_tool.pocket); }},
    {"_selected_tool", [](const Core& c) { return static_cast<double>(c.state.selected_tool); }},
    {"_selected_pocket",
     [](const Core& c) { return static_cast<double>(c.state.selected_pocket); }},
    {"_value", [](const Core& c) { return c.sub_value; }},
    {"_value_returned", [](const Core& c) { return one_if(c.sub_value_returned); }},
    {"_task", [](const Core& c) { return one_if(c.settings.is_task); }},
    {"_call_level",
     [](const Core& c) {
       return c.flows.frames.empty() ? 0.0 : static_cast<double>(c.flows.frames.size() - 1);
     }},
    {"_remap_level", [](const Core& c) { return static_cast<double>(c.remap_level()); }},
};

}  // namespace

Getter Predefined::find(std::string_view name) {
  for (const Row& r : kRows) {
    if (r.name == name) return r.get;
  }
  return nullptr;
}

void Predefined::add_names(std::vector<std::string_view>& names) {
  for (const Row& r : kRows) names.push_back(r.name);
}

Getter Predefined::by_id(std::uint32_t id, std::string_view name) {
  if (id >= known_.size()) known_.resize(id + 1);
  if (!known_[id]) known_[id] = find(name);
  return *known_[id];
}

}  // namespace kerf::interp
