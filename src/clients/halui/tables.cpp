// The pins of halui by name: what each button does, what each state shows.
#include <algorithm>
#include <cmath>

#include "clients/halui/halui.hpp"
#include "clients/halui/modes.hpp"

namespace kerf::clients::halui {
namespace {

/// Commanded position in the coordinates of the program.
double relative(const Stat& s, std::size_t axis) {
  rtapi::Pose p;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    p[i] = s.position[i] - s.g5x_offset[i] - s.tool_offset[i];
  const double angle = -s.rotation_xy * M_PI / 180;
  const double x = p.x * std::cos(angle) - p.y * std::sin(angle);
  p.y = p.x * std::sin(angle) + p.y * std::cos(angle);
  p.x = x;
  return p[axis] - s.g92_offset[axis];
}

double spindle_override(const Stat& s, int n) {
  return s.spindle[static_cast<std::size_t>(n)].override_;
}

/// command, scale at first, reset pin, value
constexpr KnobRow kFeed{"feed-override", 0.1, true, [](const Stat& s, int) { return s.feedrate; }};
constexpr KnobRow kRapid{"rapid-override", 0.1, true,
                         [](const Stat& s, int) { return s.rapidrate; }};
constexpr KnobRow kSpeed{"spindle-override", 0.1, true, spindle_override};
constexpr KnobRow kVelocity{"max-velocity", 0, false,
                            [](const Stat& s, int) { return s.max_velocity; }};

}  // namespace

struct Tables {
  using Scene = Halui::Scene;
  using H = Halui;
  struct ButtonRow {
    const char* name;
    Halui::Press press;
  };
  struct StateRow {
    const char* name;
    PinType type;
    double (*value)(const Scene&, int index);
  };

  static constexpr ButtonRow kButtons[] = {
      {"abort", &H::abort},
      {"estop.activate", &H::estop_activate},
      {"estop.reset", &H::estop_reset},
      {"machine.on", &H::machine_on},
      {"machine.off", &H::machine_off},
      {"flood.on", &H::flood_on},
      {"flood.off", &H::flood_off},
      {"mist.on", &H::mist_on},
      {"mist.off", &H::mist_off},
      {"mode.manual", &H::mode_manual},
      {"mode.auto", &H::mode_auto},
      {"mode.mdi", &H::mode_mdi},
      {"mode.joint", &H::mode_joint},
      {"mode.teleop", &H::mode_teleop},
      {"program.run", &H::program_run},
      {"program.pause", &H::program_pause},
      {"program.resume", &H::program_resume},
      {"program.step", &H::program_step},
      {"program.stop", &H::abort},
      {"program.block-delete.on", &H::block_delete_on},
      {"program.block-delete.off", &H::block_delete_off},
      {"program.optional-stop.on", &H::optional_stop_on},
      {"program.optional-stop.off", &H::optional_stop_off},
      {"prompt.ok", &H::prompt_ok},
  };
  static constexpr ButtonRow kHomeAll = {"home-all", &H::home_all};
  static constexpr ButtonRow kJointButtons[] = {{"home", &H::joint_home},
                                                {"unhome", &H::joint_unhome}};
  static constexpr ButtonRow kJointSelect = {"select", &H::joint_select};
  static constexpr ButtonRow kAxisSelect = {"select", &H::axis_select};
  static constexpr ButtonRow kSpindleButtons[] = {
      {"start", &H::spindle_start},       {"stop", &H::spindle_stop},
      {"forward", &H::spindle_forward},   {"reverse", &H::spindle_reverse},
      {"increase", &H::spindle_increase}, {"decrease", &H::spindle_decrease},
      {"brake-on", &H::brake_on},         {"brake-off", &H::brake_off},
  };

  static constexpr StateRow kStates[] = {
      {"estop.is-activated", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.task_state == kStateEstop; }},
      {"machine.is-on", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.task_state == kStateOn; }},
      {"machine.units-per-mm", PinType::real,
       [](const Scene& s, int) { return s.stat.linear_units; }},
      {"flood.is-on", PinType::bit, [](const Scene& s, int) -> double { return s.stat.flood; }},
      {"mist.is-on", PinType::bit, [](const Scene& s, int) -> double { return s.stat.mist; }},
      {"mode.is-manual", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.task_mode == kModeManual; }},
      {"mode.is-auto", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.task_mode == kModeAuto; }},
      {"mode.is-mdi", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.task_mode == kModeMdi; }},
      {"mode.is-joint", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.motion_mode == kMotionFree; }},
      {"mode.is-teleop", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.motion_mode == kMotionTeleop; }},
      {"program.is-idle", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.interp_state == kInterpIdle; }},
      {"program.is-running", PinType::bit,
       [](const Scene& s, int) -> double {
         return s.stat.interp_state != kInterpIdle && !s.stat.task_paused;
       }},
      {"program.is-paused", PinType::bit,
       [](const Scene& s, int) -> double {
         return s.stat.interp_state != kInterpIdle && s.stat.task_paused;
       }},
      {"program.is-waiting", PinType::bit,
       [](const Scene& s, int) -> double {
         return s.stat.interp_state != kInterpIdle && !s.stat.waiting_for.object.empty();
       }},
      {"program.block-delete.is-on", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.block_delete; }},
      {"program.optional-stop.is-on", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.optional_stop; }},
      {"prompt.is-waiting", PinType::bit,
       [](const Scene& s, int) -> double { return s.stat.prompt.kind != task::PromptKind::none; }},
      {"prompt.is-tool-change", PinType::bit,
       [](const Scene& s, int) -> double {
         return s.stat.prompt.kind == task::PromptKind::tool_change;
       }},
      {"prompt.tool", PinType::u32,
       [](const Scene& s, int) -> double { return std::max(s.stat.prompt.tool, 0); }},
      {"joint.selected", PinType::u32,
       [](const Scene& s, int) -> double { return s.halui.selected_joint_; }},
      {"axis.selected", PinType::u32,
       [](const Scene& s, int) -> double { return s.halui.selected_axis_; }},
      {"tool.number", PinType::u32,
       [](const Scene& s, int) -> double { return std::max(s.stat.tool_in_spindle, 0); }},
      {"tool.diameter", PinType::real,
       [](const Scene& s, int) {
         const auto& tools = s.stat.tool_table;
         return tools.empty() || tools[0].id <= 0 ? 0.0 : tools[0].diameter;
       }},
  };
  template <auto kMember>
  static double of_joint(const Scene& s, int index) {
    const int joint = s.halui.joint(index);
    return s.stat.joint[static_cast<std::size_t>(joint)].*kMember ? 1 : 0;
  }
  static constexpr StateRow kJointStates[] = {
      {"has-fault", PinType::bit, of_joint<&JointStat::fault>},
      {"is-homed", PinType::bit, of_joint<&JointStat::homed>},
      {"on-hard-max-limit", PinType::bit, of_joint<&JointStat::max_hard_limit>},
      {"on-hard-min-limit", PinType::bit, of_joint<&JointStat::min_hard_limit>},
      {"on-soft-max-limit", PinType::bit, of_joint<&JointStat::max_soft_limit>},
      {"on-soft-min-limit", PinType::bit, of_joint<&JointStat::min_soft_limit>},
      {"override-limits", PinType::bit, of_joint<&JointStat::override_limits>},
  };
  static constexpr StateRow kJointSelected = {
      "is-selected", PinType::bit,
      [](const Scene& s, int joint) -> double { return s.halui.selected_joint_ == joint; }};
  static constexpr StateRow kAxisStates[] = {
      {"is-selected", PinType::bit,
       [](const Scene& s, int axis) -> double { return s.halui.selected_axis_ == axis; }},
      {"pos-commanded", PinType::real,
       [](const Scene& s, int axis) { return s.stat.position[static_cast<std::size_t>(axis)]; }},
      {"pos-feedback", PinType::real,
       [](const Scene& s, int axis) {
         return s.stat.actual_position[static_cast<std::size_t>(axis)];
       }},
      {"pos-relative", PinType::real,
       [](const Scene& s, int axis) { return relative(s.stat, static_cast<std::size_t>(axis)); }},
  };
  static const SpindleStat& spindle(const Scene& s, int n) {
    return s.stat.spindle[static_cast<std::size_t>(n)];
  }
  static constexpr StateRow kSpindleStates[] = {
      {"is-on", PinType::bit,
       [](const Scene& s, int n) -> double { return spindle(s, n).enabled != 0; }},
      {"runs-forward", PinType::bit,
       [](const Scene& s, int n) -> double { return spindle(s, n).direction > 0; }},
      {"runs-backward", PinType::bit,
       [](const Scene& s, int n) -> double { return spindle(s, n).direction < 0; }},
      {"brake-is-on", PinType::bit,
       [](const Scene& s, int n) -> double { return spindle(s, n).brake != 0; }},
  };
  static constexpr StateRow kToolOffset = {
      "tool.length_offset.", PinType::real,
      [](const Scene& s, int axis) { return s.stat.tool_offset[static_cast<std::size_t>(axis)]; }};

  static void add(Halui& h, const std::string& prefix, const ButtonRow& row, int index = 0) {
    h.buttons_.push_back({h.board_.input(prefix + row.name, PinType::bit), row.press, index});
  }
  static void add(Halui& h, const std::string& prefix, const StateRow& row, int index = 0) {
    h.states_.push_back({h.board_.output(prefix + row.name, row.type), row.value, index});
  }
};

void Halui::add_joint_pins(const std::string& prefix, int index) {
  for (const auto& row : Tables::kJointButtons) Tables::add(*this, prefix, row, index);
  for (const auto& row : Tables::kJointStates) Tables::add(*this, prefix, row, index);
}

void Halui::make_pins() {
  for (const auto& row : Tables::kButtons) Tables::add(*this, "", row);
  if (layout_.home_all) Tables::add(*this, "", Tables::kHomeAll);
  for (const auto& row : Tables::kStates) Tables::add(*this, "", row);
  for (int j = 0; j < layout_.joints; ++j) {
    const std::string prefix = "joint." + std::to_string(j) + ".";
    add_joint_pins(prefix, j);
    Tables::add(*this, prefix, Tables::kJointSelect, j);
    Tables::add(*this, prefix, Tables::kJointSelected, j);
  }
  add_joint_pins("joint.selected.", kSelected);
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    const char letter = static_cast<char>(rtapi::kAxisLetters[a] + ('a' - 'A'));
    const int index = static_cast<int>(a);
    Tables::StateRow offset = Tables::kToolOffset;
    Tables::add(*this, std::string(offset.name) + letter, {"", offset.type, offset.value}, index);
    if ((layout_.axis_mask >> a & 1U) == 0) continue;
    const std::string prefix = std::string("axis.") + letter + ".";
    Tables::add(*this, prefix, Tables::kAxisSelect, index);
    for (const auto& row : Tables::kAxisStates) Tables::add(*this, prefix, row, index);
  }
  knobs_.emplace_back(board_, kFeed, "feed-override.", -1);
  knobs_.emplace_back(board_, kRapid, "rapid-override.", -1);
  knobs_.emplace_back(board_, kVelocity, "max-velocity.", -1);
  for (int n = 0; n < layout_.spindles; ++n) {
    const std::string prefix = "spindle." + std::to_string(n) + ".";
    for (const auto& row : Tables::kSpindleButtons) Tables::add(*this, prefix, row, n);
    for (const auto& row : Tables::kSpindleStates) Tables::add(*this, prefix, row, n);
    knobs_.emplace_back(board_, kSpeed, prefix + "override.", n);
  }
}

}  // namespace kerf::clients::halui
