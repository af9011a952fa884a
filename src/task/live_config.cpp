#include "task/live_config.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ini/reader.hpp"

namespace kerf::task {
namespace {

using motion::AxisConfig;
using motion::JointConfig;
using motion::MachineConfig;

std::string show(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.7g", v);
  return text;
}

/// "Not limited" has no unit.
double to_units(double value, double unit) {
  return std::fabs(value) >= 1e98 ? value : value / unit;
}
double from_units(double value, double unit) {
  return std::fabs(value) >= 1e98 ? value : value * unit;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

/// The pins of each joint and axis by name, and what they stand for.
struct LiveConfig::Table {
  struct JointRow {
    const char* name;
    double JointConfig::*value;
    Rule rule;
  };
  struct AxisRow {
    const char* name;
    double AxisConfig::*value;
    Rule rule;
  };
  static constexpr JointRow kJoint[] = {
      {"backlash", &JointConfig::backlash, Rule::not_negative},
      {"ferror", &JointConfig::ferror, Rule::positive},
      {"min_ferror", &JointConfig::min_ferror, Rule::positive},
      {"home", &JointConfig::home, Rule::any},
      {"home_offset", &JointConfig::home_offset, Rule::any},
      {"max_acceleration", &JointConfig::max_acc, Rule::positive},
      {"max_jerk", &JointConfig::max_jerk, Rule::not_negative},
      {"max_limit", &JointConfig::max_limit, Rule::any},
      {"max_velocity", &JointConfig::max_vel, Rule::positive},
      {"min_limit", &JointConfig::min_limit, Rule::any},
  };
  static constexpr AxisRow kAxis[] = {
      {"max_acceleration", &AxisConfig::max_acc, Rule::positive},
      {"max_jerk", &AxisConfig::max_jerk, Rule::not_negative},
      {"max_limit", &AxisConfig::max_limit, Rule::any},
      {"max_velocity", &AxisConfig::max_vel, Rule::positive},
      {"min_limit", &AxisConfig::min_limit, Rule::any},
  };
  /// Of settings that nothing here depends on: the pin shows what the INI file says.
  struct IdleRow {
    const char* name;
    const char* key;  ///< of [TRAJ]
    IniPin::Type type;
    double fallback;
  };
  static constexpr IdleRow kIdle[] = {
      {"traj_arc_blend_enable", "ARC_BLEND_ENABLE", IniPin::Type::flag, 1},
      {"traj_arc_blend_fallback_enable", "ARC_BLEND_FALLBACK_ENABLE", IniPin::Type::flag, 0},
      {"traj_arc_blend_gap_cycles", "ARC_BLEND_GAP_CYCLES", IniPin::Type::real, 4},
      {"traj_arc_blend_optimization_depth", "ARC_BLEND_OPTIMIZATION_DEPTH", IniPin::Type::integer,
       50},
      {"traj_arc_blend_ramp_freq", "ARC_BLEND_RAMP_FREQ", IniPin::Type::real, 100},
      {"traj_arc_blend_tangent_kink_ratio", "ARC_BLEND_KINK_RATIO", IniPin::Type::real, 0.1},
      {"traj_default_acceleration", "DEFAULT_LINEAR_ACCELERATION", IniPin::Type::real, 1e99},
      {"traj_default_velocity", "DEFAULT_LINEAR_VELOCITY", IniPin::Type::real, 1},
      {"traj_scurve_peak_scale", "SCURVE_PEAK_SCALE", IniPin::Type::real, 1},
  };
};

LiveConfig::LiveConfig(const MachineSetup& setup, const ini::IniFile& ini)
    : linear_unit_mm_(setup.linear_unit_mm), angular_unit_deg_(setup.angular_unit_deg) {
  // The pins show jerk limits also where PLANNER_TYPE switches them off.
  MachineSetup shown = setup;
  shown.motion.traj_max_jerk_mm_s3 = setup.jerks.traj_mm_s3;
  for (std::size_t j = 0; j < setup.jerks.joint.size(); ++j)
    shown.motion.joint[j].max_jerk = setup.jerks.joint[j];
  for (std::size_t a = 0; a < setup.jerks.axis.size(); ++a)
    shown.motion.axis[a].max_jerk = setup.jerks.axis[a];
  add_joints(shown);
  add_axes(shown);
  add_traj(shown, ini);
  for (const IniPin& pin : pins_) seen_.push_back(pin.initial);
  good_ = seen_;
  touched_.assign(pins_.size(), false);
}

void LiveConfig::add(std::string name, IniPin::Type type, double initial, Place place) {
  pins_.push_back({std::move(name), type, initial});
  places_.push_back(place);
}

void LiveConfig::add_joints(const MachineSetup& setup) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(setup.motion.joints); ++j) {
    const std::string prefix = "ini." + std::to_string(j) + ".";
    const JointConfig& joint = setup.motion.joint[j];
    Place place;
    place.kind = Kind::joint;
    place.index = j;
    place.unit = joint.rotary ? angular_unit_deg_ : linear_unit_mm_;
    for (const auto& row : Table::kJoint) {
      place.joint = row.value;
      place.rule = row.rule;
      add(prefix + row.name, IniPin::Type::real, to_units(joint.*row.value, place.unit), place);
    }
    place.kind = Kind::sequence;
    add(prefix + "home_sequence", IniPin::Type::integer, joint.home_sequence, place);
  }
}

void LiveConfig::add_axes(const MachineSetup& setup) {
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    const bool used = (setup.motion.axis_mask >> a & 1U) != 0;
    const char letter = static_cast<char>(rtapi::kAxisLetters[a] + ('a' - 'A'));
    const std::string prefix = std::string("ini.") + letter + ".";
    Place place;
    place.kind = used ? Kind::axis : Kind::none;
    place.index = a;
    place.unit = rtapi::is_rotary(a) ? angular_unit_deg_ : linear_unit_mm_;
    for (const auto& row : Table::kAxis) {
      place.axis = row.value;
      place.rule = used ? row.rule : Rule::any;
      add(prefix + row.name, IniPin::Type::real,
          used ? to_units(setup.motion.axis[a].*row.value, place.unit) : 0.0, place);
    }
  }
}

void LiveConfig::add_traj(const MachineSetup& setup, const ini::IniFile& ini) {
  ini::Reader reader(ini);  // its complaints are those that the setup made already
  for (const auto& row : Table::kIdle) {
    double value = row.fallback;
    if (row.type == IniPin::Type::flag)
      value = reader.boolean("TRAJ", row.key, row.fallback != 0) ? 1 : 0;
    else
      value = reader.real("TRAJ", row.key, row.fallback);
    add(std::string("ini.") + row.name, row.type, value, {});
  }
  Place place;
  place.kind = Kind::traj;
  place.rule = Rule::positive;
  place.unit = setup.linear_unit_mm;
  place.traj = &MachineConfig::traj_max_vel_mm_s;
  add("ini.traj_max_velocity", IniPin::Type::real,
      to_units(setup.motion.traj_max_vel_mm_s, place.unit), place);
  planner_type_ = pins_.size();
  Place type;
  type.kind = Kind::planner_type;
  const double limits_jerk = reader.real("TRAJ", "PLANNER_TYPE", 1);
  add("ini.traj_planner_type", IniPin::Type::integer, limits_jerk, type);
  place.rule = Rule::not_negative;
  place.traj = &MachineConfig::traj_max_jerk_mm_s3;
  add("ini.traj_max_jerk", IniPin::Type::real,
      to_units(setup.motion.traj_max_jerk_mm_s3, place.unit), place);
  place.rule = Rule::positive;
  place.traj = &MachineConfig::traj_max_acc_mm_s2;
  add("ini.traj_max_acceleration", IniPin::Type::real,
      to_units(setup.motion.traj_max_acc_mm_s2, place.unit), place);
}

const char* LiveConfig::wrong(const Place& place, double value) noexcept {
  if (place.kind == Kind::none) return "";
  if (std::isnan(value)) return "expected a number";
  if (place.kind == Kind::planner_type && value != 0 && value != 1) return "expected 0 or 1";
  if (place.kind == Kind::sequence && std::fabs(value) > motion::kNoHomeSequence)
    return "expected -100 to 100";
  if (place.rule == Rule::positive && !(value > 0)) return "expected a number above 0";
  if (place.rule == Rule::not_negative && value < 0) return "expected 0 or more";
  return "";
}

void LiveConfig::apply(const Place& place, double value, MachineConfig& machine) {
  switch (place.kind) {
    case Kind::none: return;
    case Kind::joint:
      machine.joint[place.index].*place.joint = from_units(value, place.unit);
      return;
    case Kind::axis: machine.axis[place.index].*place.axis = from_units(value, place.unit); return;
    case Kind::sequence:
      machine.joint[place.index].home_sequence = static_cast<std::int32_t>(value);
      return;
    case Kind::traj: machine.*place.traj = from_units(value, place.unit); return;
    case Kind::planner_type: return;  // apply_planner_type()
  }
}

void LiveConfig::apply_planner_type(MachineConfig& machine) const {
  const bool off = good_[planner_type_] == 0;
  if (!off && !touched_[planner_type_]) return;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place& p = places_[i];
    const bool jerk = (p.kind == Kind::joint && p.joint == &JointConfig::max_jerk) ||
                      (p.kind == Kind::axis && p.axis == &AxisConfig::max_jerk) ||
                      (p.kind == Kind::traj && p.traj == &MachineConfig::traj_max_jerk_mm_s3);
    if (jerk) apply(p, off ? 0.0 : good_[i], machine);
  }
}

void LiveConfig::check_pairs(const MachineConfig& old, MachineConfig& next,
                             std::vector<std::string>& complaints) const {
  const auto limits = [&](auto& now, const auto& before, const std::string& prefix, double unit) {
    if (now.min_limit < now.max_limit) return;
    complaints.push_back(
        prefix + "min_limit = " + show(to_units(now.min_limit, unit)) + " is not below " + prefix +
        "max_limit = " + show(to_units(now.max_limit, unit)) + ": the limits stay " +
        show(to_units(before.min_limit, unit)) + " and " + show(to_units(before.max_limit, unit)));
    now.min_limit = before.min_limit;
    now.max_limit = before.max_limit;
  };
  for (std::size_t j = 0; j < static_cast<std::size_t>(next.joints); ++j) {
    JointConfig& joint = next.joint[j];
    limits(joint, old.joint[j], "ini." + std::to_string(j) + ".",
           joint.rotary ? angular_unit_deg_ : linear_unit_mm_);
    joint.min_ferror = std::min(joint.min_ferror, joint.ferror);
  }
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    if ((next.axis_mask >> a & 1U) == 0) continue;
    const char letter = static_cast<char>(rtapi::kAxisLetters[a] + ('a' - 'A'));
    limits(next.axis[a], old.axis[a], std::string("ini.") + letter + ".",
           rtapi::is_rotary(a) ? angular_unit_deg_ : linear_unit_mm_);
  }
}

bool LiveConfig::same_object(const Place& a, const Place& b) noexcept {
  const auto kind = [](Kind k) { return k == Kind::sequence ? Kind::joint : k; };
  return kind(a.kind) == kind(b.kind) && a.index == b.index;
}

bool LiveConfig::take(std::span<const double> values, MachineConfig& machine,
                      std::vector<std::string>& complaints) {
  std::vector<std::size_t> news;
  for (std::size_t i = 0; i < pins_.size() && i < values.size(); ++i) {
    if (same(values[i], seen_[i])) continue;
    seen_[i] = values[i];
    const char* why = wrong(places_[i], values[i]);
    if (*why != '\0') {
      complaints.push_back(pins_[i].name + " = " + show(values[i]) + ": " + why + "; " +
                           show(good_[i]) + " stays in force");
      continue;
    }
    good_[i] = values[i];
    touched_[i] = true;  // the others keep what the INI file said, to the last bit
    if (places_[i].kind != Kind::none) news.push_back(i);
  }
  if (news.empty()) return false;
  MachineConfig next = machine;
  // With all that was ever said of this joint or axis: a limit that could not be alone may be right with its partner now.
  for (std::size_t i = 0; i < pins_.size(); ++i)
    if (touched_[i] && std::any_of(news.begin(), news.end(), [&](std::size_t n) {
          return same_object(places_[n], places_[i]);
        }))
      apply(places_[i], good_[i], next);
  apply_planner_type(next);
  std::vector<std::string> pairs;
  check_pairs(machine, next, pairs);
  for (const std::string& text : pairs)
    if (std::find(pair_complaints_.begin(), pair_complaints_.end(), text) == pair_complaints_.end())
      complaints.push_back(text);
  pair_complaints_ = std::move(pairs);
  machine = next;
  return true;
}

std::vector<std::string> beyond_new_limits(const MachineConfig& before, const MachineConfig& after,
                                           std::span<const double> joint_position,
                                           std::span<const bool> homed, const MachineSetup& setup) {
  std::vector<std::string> out;
  for (std::size_t j = 0; j < joint_position.size() && j < homed.size(); ++j) {
    const JointConfig &old = before.joint[j], &now = after.joint[j];
    if (!homed[j] || (old.min_limit == now.min_limit && old.max_limit == now.max_limit)) continue;
    const double at = joint_position[j];
    if (at >= now.min_limit - 1e-6 && at <= now.max_limit + 1e-6) continue;
    const double unit = now.rotary ? setup.angular_unit_deg : setup.linear_unit_mm;
    const bool low = at < now.min_limit;
    out.push_back("joint " + std::to_string(j) + " stands at " + show(at / unit) + ", beyond ini." +
                  std::to_string(j) + (low ? ".min_limit = " : ".max_limit = ") +
                  show(to_units(low ? now.min_limit : now.max_limit, unit)) +
                  ": only moves back inside are possible");
  }
  return out;
}

}  // namespace kerf::task
