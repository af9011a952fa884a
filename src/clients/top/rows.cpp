#include "clients/top/rows.hpp"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace kerf::clients::top {
namespace {

using Json = nlohmann::json;

Json of(const rtapi::Pose& p) {
  Json out = Json::array();
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) out.push_back(p[i]);
  return out;
}

Json of(const JointStat& j) {
  return {{"backlash", j.backlash},
          {"enabled", j.enabled},
          {"fault", j.fault},
          {"ferror_current", j.ferror_current},
          {"ferror_highmark", j.ferror_highmark},
          {"homed", j.homed},
          {"homing", j.homing},
          {"inpos", j.inpos},
          {"input", j.input},
          {"jointType", j.joint_type},
          {"max_ferror", j.max_ferror},
          {"max_hard_limit", j.max_hard_limit},
          {"max_position_limit", j.max_position_limit},
          {"max_soft_limit", j.max_soft_limit},
          {"min_ferror", j.min_ferror},
          {"min_hard_limit", j.min_hard_limit},
          {"min_position_limit", j.min_position_limit},
          {"min_soft_limit", j.min_soft_limit},
          {"output", j.output},
          {"override_limits", j.override_limits},
          {"units", j.units},
          {"velocity", j.velocity}};
}

Json of(const AxisStat& a) {
  return {{"max_position_limit", a.max_position_limit},
          {"min_position_limit", a.min_position_limit},
          {"velocity", a.velocity}};
}

Json of(const SpindleStat& s) {
  return {{"brake", s.brake},
          {"direction", s.direction},
          {"enabled", s.enabled},
          {"homed", s.homed},
          {"orient_fault", s.orient_fault},
          {"orient_state", s.orient_state},
          {"override", s.override_},
          {"override_enabled", s.override_enabled},
          {"speed", s.speed}};
}

Json of(const ToolStat& t) {
  return {{"id", t.id},
          {"pocket", t.pocket},
          {"offset", of(t.offset)},
          {"diameter", t.diameter},
          {"frontangle", t.frontangle},
          {"backangle", t.backangle},
          {"orientation", t.orientation},
          {"comment", t.comment}};
}

Json of(const task::WaitingFor& w) {
  if (w.object.empty()) return nullptr;
  return {{"text", task::wait_text(w)},
          {"object", w.object.view()},
          {"pin", w.pin.view()},
          {"net", w.net.view()}};
}

template <class List>
Json each(const List& list, std::size_t count) {
  Json out = Json::array();
  for (std::size_t i = 0; i < count && i < list.size(); ++i) out.push_back(of(list[i]));
  return out;
}

struct Row {
  const char* name;
  Json (*value)(const Stat&);
  const char* words{nullptr};  ///< what the numbers from 1 on are called
};

// NOLINTBEGIN(cppcoreguidelines-macro-usage): the name of the member is the name of the row.
#define KERF_ROW(member)                                    \
  {                                                         \
#member, [](const Stat& s) -> Json { return s.member; } \
  }
#define KERF_POSE(member)                                       \
  {                                                             \
#member, [](const Stat& s) -> Json { return of(s.member); } \
  }
#define KERF_STATE(member, words)                                                    \
  {                                                                                  \
#member, [](const Stat& s) -> Json { return static_cast<int>(s.member); }, words \
  }
// NOLINTEND(cppcoreguidelines-macro-usage)

/// Sorted by name.
constexpr Row kRows[] = {
    KERF_ROW(acceleration),
    KERF_ROW(active_queue),
    KERF_POSE(actual_position),
    KERF_ROW(adaptive_feed_enabled),
    KERF_ROW(ain),
    KERF_ROW(angular_units),
    KERF_ROW(aout),
    {"axis", [](const Stat& s) { return each(s.axis, rtapi::kAxes); }},
    KERF_ROW(axis_mask),
    KERF_ROW(block_delete),
    KERF_ROW(call_level),
    KERF_ROW(command),
    KERF_ROW(current_line),
    KERF_ROW(current_vel),
    KERF_ROW(cycle_time),
    KERF_ROW(debug),
    KERF_ROW(delay_left),
    KERF_ROW(din),
    KERF_ROW(distance_to_go),
    KERF_ROW(dout),
    KERF_POSE(dtg),
    KERF_ROW(echo_serial_number),
    KERF_ROW(enabled),
    KERF_ROW(estop),
    KERF_STATE(exec_state,
               "EXEC_ERROR EXEC_DONE EXEC_WAITING_FOR_MOTION EXEC_WAITING_FOR_MOTION_QUEUE "
               "EXEC_WAITING_FOR_IO 6 EXEC_WAITING_FOR_MOTION_AND_IO EXEC_WAITING_FOR_DELAY "
               "EXEC_WAITING_FOR_SYSTEM_CMD EXEC_WAITING_FOR_SPINDLE_ORIENTED"),
    KERF_ROW(feed_hold_enabled),
    KERF_ROW(feed_override_enabled),
    KERF_ROW(feedrate),
    KERF_ROW(file),
    KERF_ROW(flood),
    KERF_ROW(g5x_index),
    KERF_POSE(g5x_offset),
    KERF_POSE(g92_offset),
    KERF_ROW(gcodes),
    KERF_ROW(heartbeat),
    KERF_ROW(homed),
    KERF_ROW(ini_filename),
    KERF_ROW(inpos),
    KERF_ROW(input_timeout),
    KERF_STATE(interp_state, "INTERP_IDLE INTERP_READING INTERP_PAUSED INTERP_WAITING"),
    KERF_ROW(interpreter_errcode),
    {"joint", [](const Stat& s) { return each(s.joint, static_cast<std::size_t>(s.joints)); }},
    KERF_ROW(joint_actual_position),
    KERF_ROW(joint_position),
    KERF_ROW(joints),
    KERF_STATE(
        kinematics_type,
        "KINEMATICS_IDENTITY KINEMATICS_FORWARD_ONLY KINEMATICS_INVERSE_ONLY KINEMATICS_BOTH"),
    KERF_ROW(limit),
    KERF_ROW(linear_units),
    KERF_ROW(max_acceleration),
    KERF_ROW(max_velocity),
    KERF_ROW(mcodes),
    KERF_ROW(misc_error),
    KERF_ROW(mist),
    KERF_ROW(motion_id),
    KERF_ROW(motion_line),
    KERF_STATE(motion_mode, "TRAJ_MODE_FREE TRAJ_MODE_COORD TRAJ_MODE_TELEOP"),
    KERF_STATE(motion_type,
               "MOTION_TYPE_TRAVERSE MOTION_TYPE_FEED MOTION_TYPE_ARC MOTION_TYPE_TOOLCHANGE "
               "MOTION_TYPE_PROBING MOTION_TYPE_INDEXROTARY"),
    KERF_ROW(num_extrajoints),
    KERF_ROW(optional_stop),
    KERF_ROW(paused),
    KERF_ROW(pocket_prepped),
    KERF_POSE(position),
    KERF_ROW(probe_tripped),
    KERF_ROW(probe_val),
    KERF_POSE(probed_position),
    KERF_ROW(probing),
    KERF_STATE(program_units, "CANON_UNITS_INCHES CANON_UNITS_MM"),
    KERF_ROW(queue),
    KERF_ROW(queue_full),
    KERF_ROW(queued_mdi_commands),
    KERF_ROW(rapidrate),
    KERF_ROW(read_line),
    KERF_ROW(rotation_xy),
    KERF_ROW(settings),
    KERF_ROW(single_stepping),
    {"spindle",
     [](const Stat& s) { return each(s.spindle, static_cast<std::size_t>(s.spindles)); }},
    KERF_ROW(spindles),
    KERF_STATE(state, "RCS_DONE RCS_EXEC RCS_ERROR"),
    KERF_STATE(task_mode, "MODE_MANUAL MODE_AUTO MODE_MDI"),
    KERF_ROW(task_paused),
    KERF_STATE(task_state, "STATE_ESTOP STATE_ESTOP_RESET STATE_OFF STATE_ON"),
    KERF_ROW(taskbeat),
    KERF_ROW(tool_from_pocket),
    KERF_ROW(tool_in_spindle),
    KERF_POSE(tool_offset),
    {"tool_table", [](const Stat& s) { return each(s.tool_table, s.tool_table.size()); }},
    KERF_ROW(velocity),
    {"waiting_for", [](const Stat& s) { return of(s.waiting_for); }},
};
#undef KERF_ROW
#undef KERF_POSE
#undef KERF_STATE

const Row* find(std::string_view name) {
  for (const Row& row : kRows)
    if (name == row.name) return &row;
  return nullptr;
}

std::string number(double v) {
  char out[40];
  std::snprintf(out, sizeof out, "%.6g", v == 0 ? 0.0 : v);
  return out;
}

/// The nth of words that stand behind one another, from 1; "" when there are not so many.
std::string nth_word(std::string_view words, int n) {
  for (int i = 1; !words.empty(); ++i) {
    const auto end = std::min(words.find(' '), words.size());
    if (i == n) return std::string(words.substr(0, end));
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return {};
}

std::string plain(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return number(value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object()) {
    std::string out;
    for (const auto& [key, item] : value.items())
      out += (out.empty() ? "" : " ") + key + "=" + plain(item);
    return out;
  }
  if (!value.is_array()) return value.dump();
  std::string out;
  const bool objects = !value.empty() && value[0].is_object();
  for (std::size_t i = 0; i < value.size(); ++i)
    out += objects ? (i > 0 ? "\n" : "") + std::to_string(i) + ": " + plain(value[i])
                   : (i > 0 ? " " : "") + plain(value[i]);
  return out;
}

/// G-codes are tenths, -1: none.
std::string codes(const Json& list, char letter, int divisor) {
  std::string out;
  for (const Json& item : list) {
    const int code = item.get<int>();
    if (code < 0) continue;
    out += (out.empty() ? "" : " ") + std::string(1, letter) + std::to_string(code / divisor);
    if (code % divisor != 0) out += "." + std::to_string(code % divisor);
  }
  return out;
}

}  // namespace

std::vector<std::string_view> names() {
  std::vector<std::string_view> out;
  for (const Row& row : kRows) out.emplace_back(row.name);
  return out;
}

std::string text(const Stat& stat, std::string_view name) {
  const Row* row = find(name);
  if (row == nullptr) return {};
  const Json value = row->value(stat);
  if (name == "gcodes") return codes(value, 'G', 10);
  if (name == "mcodes") return codes(value, 'M', 1);
  if (name == "waiting_for") return value.is_null() ? "-" : value["text"].get<std::string>();
  if (row->words != nullptr)
    if (std::string word = nth_word(row->words, value.get<int>()); !word.empty()) return word;
  const bool pose = value.is_array() && value.size() == rtapi::kAxes && value[0].is_number_float();
  if (!pose) return plain(value);
  std::string out;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if ((stat.axis_mask >> i & 1U) != 0 || value[i].get<double>() != 0)
      out += (out.empty() ? "" : " ") + std::string(1, rtapi::kAxisLetters[i]) +
             number(value[i].get<double>());
  return out;
}

std::string json(const Stat& stat, std::span<const std::string> wanted) {
  Json out = Json::object();
  if (wanted.empty()) {
    for (const Row& row : kRows) out[row.name] = row.value(stat);
  } else {
    for (const std::string& name : wanted)
      if (const Row* row = find(name); row != nullptr) out[name] = row->value(stat);
  }
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kerf::clients::top
