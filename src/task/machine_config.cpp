#include "task/machine_config.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "ini/reader.hpp"
#include "io/tool_table.hpp"

namespace kerf::task {
namespace {

using ini::IntSpec;
using ini::Reader;
using ini::RealSpec;

/// "%g" without surprises.
std::string show(double v) {
  std::ostringstream out;
  out << v;
  return out.str();
}

class SetupReader {
 public:
  explicit SetupReader(const ini::IniFile& file) : r_(file) {}

  SetupResult run() {
    out_.setup.machine_name = r_.string("EMC", "MACHINE", "");
    units();
    traj();
    for (int j = 0; j < out_.setup.motion.joints; ++j) joint(j);
    for (std::size_t a = 0; a < rtapi::kAxes; ++a)
      if ((out_.setup.motion.axis_mask & (1U << a)) != 0) axis(a);
    identity_limits();
    for (int s = 0; s < out_.setup.motion.spindles; ++s) spindle(s);
    display();
    rs274ngc();
    emcio();
    out_.setup.mdi_queue = static_cast<int>(
        r_.integer("TASK", "MDI_QUEUED_COMMANDS", IntSpec{.fallback = 10, .min = 1, .max = 1000}));
    out_.setup.motion.heartbeat_timeout_s =
        r_.real("KERF", "HEARTBEAT_TIMEOUT",
                RealSpec{.fallback = 0.1, .min = 0.01, .max = 10, .unit = "s"});
    out_.diagnostics = r_.complaints();
    unknown_keys();
    out_.ok = std::none_of(out_.diagnostics.begin(), out_.diagnostics.end(),
                           [](const auto& d) { return d.is_error; });
    return std::move(out_);
  }

 private:
  double length(std::string_view section, std::string_view key, double fallback_units,
                bool required = false, double min = -1e99) {
    return r_.real(
        section, key,
        RealSpec{
            .fallback = fallback_units, .min = min, .required = required, .unit = "machine units"});
  }
  double rate(std::string_view section, std::string_view key, double fallback, bool required,
              const char* unit) {
    return r_.real(section, key,
                   RealSpec{.fallback = fallback,
                            .min = 0,
                            .min_excluded = true,
                            .required = required,
                            .unit = unit});
  }
  static double scaled(double value, double unit) {
    return std::fabs(value) >= 1e98 ? value : value * unit;
  }

  void units() {
    auto& s = out_.setup;
    s.linear_unit_mm = r_.linear_unit("TRAJ", "LINEAR_UNITS", 1.0);
    s.angular_unit_deg = r_.angular_unit("TRAJ", "ANGULAR_UNITS", 1.0);
    s.motion.linear_units_per_mm = 1.0 / s.linear_unit_mm;
    s.interp.machine_unit_mm = s.linear_unit_mm;
  }

  void traj() {
    auto& s = out_.setup;
    auto& m = s.motion;
    coordinates();
    m.joints = static_cast<std::int32_t>(
        r_.integer("KINS", "JOINTS",
                   IntSpec{.fallback = 0,
                           .min = 1,
                           .max = static_cast<std::int64_t>(motion::kMaxJoints),
                           .required = true}));
    (void)r_.string("KINS", "KINEMATICS", {.fallback = "trivkins", .required = true});
    m.spindles = static_cast<std::int32_t>(r_.integer(
        "TRAJ", "SPINDLES",
        IntSpec{.fallback = 1, .min = 1, .max = static_cast<std::int64_t>(motion::kMaxSpindles)}));
    s.interp.spindles = m.spindles;
    m.traj_max_vel_mm_s =
        rate("TRAJ", "MAX_LINEAR_VELOCITY", 1e9, false, "machine units/s") * s.linear_unit_mm;
    m.traj_max_acc_mm_s2 =
        rate("TRAJ", "MAX_LINEAR_ACCELERATION", 1e9, false, "machine units/s^2") * s.linear_unit_mm;
    m.traj_max_ang_vel_deg_s =
        rate("TRAJ", "MAX_ANGULAR_VELOCITY", 1e9, false, "machine units/s") * s.angular_unit_deg;
    m.no_force_homing = r_.boolean("TRAJ", "NO_FORCE_HOMING", false);
    m.probe_error_inhibit_jog = r_.boolean("TRAJ", "NO_PROBE_JOG_ERROR", false);
    m.probe_error_inhibit_home = r_.boolean("TRAJ", "NO_PROBE_HOME_ERROR", false);
    for (const char* key :
         {"DEFAULT_LINEAR_VELOCITY", "DEFAULT_LINEAR_ACCELERATION", "DEFAULT_ANGULAR_VELOCITY",
          "DEFAULT_ANGULAR_ACCELERATION", "MAX_ANGULAR_ACCELERATION", "MAX_LINEAR_JERK",
          "POSITION_FILE", "HOME", "TPMOD", "AXES", "ARC_BLEND_ENABLE", "ARC_BLEND_FALLBACK_ENABLE",
          "ARC_BLEND_OPTIMIZATION_DEPTH", "ARC_BLEND_GAP_CYCLES", "ARC_BLEND_RAMP_FREQ",
          "ARC_BLEND_KINK_RATIO", "PLANNER_TYPE", "SCURVE_PEAK_SCALE", "CYCLE_TIME"})
      r_.known_key("TRAJ", key);
  }

  void coordinates() {
    const std::string text =
        r_.string("TRAJ", "COORDINATES", {.fallback = "X Y Z", .required = true});
    std::uint32_t mask = 0;
    for (const char c : text) {
      if (c == ' ' || c == '\t') continue;
      const int axis = rtapi::axis_index(c);
      if (axis < 0) {
        r_.complain("TRAJ", "COORDINATES",
                    std::string("'") + c + "' is no axis: expected letters of XYZABCUVW");
        continue;
      }
      mask |= 1U << static_cast<unsigned>(axis);
    }
    if (mask == 0)
      r_.complain("TRAJ", "COORDINATES",
                  "no axis named: expected letters of XYZABCUVW, such as X Y Z");
    out_.setup.motion.axis_mask = mask;
    out_.setup.interp.axis_mask = mask;
  }

  void joint(int index) {
    const std::string section = "JOINT_" + std::to_string(index);
    auto& j = out_.setup.motion.joint[index];
    const std::size_t type = r_.choice(section, "TYPE", {"LINEAR", "ANGULAR"}, 0);
    j.rotary = type == 1;
    double unit = j.rotary ? out_.setup.angular_unit_deg : out_.setup.linear_unit_mm;
    if (r_.has(section, "UNITS"))
      unit = j.rotary ? r_.angular_unit(section, "UNITS", unit)
                      : r_.linear_unit(section, "UNITS", unit);
    j.min_limit = scaled(length(section, "MIN_LIMIT", -1e99), unit);
    j.max_limit = scaled(length(section, "MAX_LIMIT", 1e99), unit);
    if (!(j.min_limit < j.max_limit))
      r_.complain(section, "MIN_LIMIT",
                  "MIN_LIMIT " + show(j.min_limit / unit) + " is not below MAX_LIMIT " +
                      show(j.max_limit / unit));
    j.max_vel = rate(section, "MAX_VELOCITY", 1, true, "machine units/s") * unit;
    j.max_acc = rate(section, "MAX_ACCELERATION", 1, true, "machine units/s^2") * unit;
    j.max_jerk = length(section, "MAX_JERK", 0, false, 0) * unit;
    const bool has_ferror = r_.has(section, "FERROR");
    j.ferror = scaled(length(section, "FERROR", 1e99, false, 0), unit);
    j.min_ferror = r_.has(section, "MIN_FERROR") ? length(section, "MIN_FERROR", 0, false, 0) * unit
                                                 : j.ferror;
    if (has_ferror && j.min_ferror > j.ferror) j.min_ferror = j.ferror;
    j.backlash = length(section, "BACKLASH", 0, false, 0) * unit;
    homing(section, j, unit);
    for (const char* key : {"COMP_FILE",
                            "COMP_FILE_TYPE",
                            "LOCKING_INDEXER",
                            "POSTHOME_CMD",
                            "STEPGEN_MAXVEL",
                            "STEPGEN_MAXACCEL",
                            "SCALE",
                            "STEP_SCALE",
                            "ENCODER_SCALE",
                            "INPUT_SCALE",
                            "OUTPUT_SCALE",
                            "P",
                            "I",
                            "D",
                            "FF0",
                            "FF1",
                            "FF2",
                            "BIAS",
                            "DEADBAND",
                            "MAX_OUTPUT",
                            "MIN_OUTPUT",
                            "DIRSETUP",
                            "DIRHOLD",
                            "STEPLEN",
                            "STEPSPACE",
                            "OUTPUT_OFFSET",
                            "OUTPUT_MIN_LIMIT",
                            "OUTPUT_MAX_LIMIT"})
      r_.known_key(section, key);
  }

  void homing(const std::string& section, motion::JointConfig& j, double unit) {
    j.home = length(section, "HOME", 0) * unit;
    j.home_offset = length(section, "HOME_OFFSET", 0) * unit;
    j.home_search_vel = length(section, "HOME_SEARCH_VEL", 0) * unit;
    j.home_latch_vel = length(section, "HOME_LATCH_VEL", 0) * unit;
    j.home_final_vel = length(section, "HOME_FINAL_VEL", 0) * unit;
    if (j.home_search_vel != 0 && j.home_latch_vel == 0)
      r_.complain(section, "HOME_LATCH_VEL",
                  "HOME_SEARCH_VEL is set and HOME_LATCH_VEL is 0: expected a velocity towards or "
                  "off the switch, in machine units/s");
    j.home_search_dist = length(section, "HOME_SEARCH_DIST", 0, false, 0) * unit;
    j.home_latch_dist = length(section, "HOME_LATCH_DIST", 0, false, 0) * unit;
    j.home_sequence =
        r_.has(section, "HOME_SEQUENCE")
            ? static_cast<std::int32_t>(
                  r_.integer(section, "HOME_SEQUENCE",
                             IntSpec{.fallback = motion::kNoHomeSequence, .min = -100, .max = 100}))
            : motion::kNoHomeSequence;
    const auto flag = [&](const char* key, std::int32_t bit) {
      if (r_.boolean(section, key, false)) j.home_flags |= bit;
    };
    flag("HOME_IGNORE_LIMITS", motion::home_ignore_limits);
    flag("HOME_USE_INDEX", motion::home_use_index);
    flag("HOME_IS_SHARED", motion::home_is_shared);
    flag("HOME_INDEX_NO_ENCODER_RESET", motion::home_index_no_encoder_reset);
    const auto absolute =
        r_.integer(section, "HOME_ABSOLUTE_ENCODER", IntSpec{.fallback = 0, .min = 0, .max = 2});
    if (absolute > 0) j.home_flags |= motion::home_absolute_encoder;
    if (absolute == 2) j.home_flags |= motion::home_no_final_move;
    j.volatile_home = r_.boolean(section, "VOLATILE_HOME", false);
  }

  void axis(std::size_t index) {
    const std::string section = std::string("AXIS_") + rtapi::kAxisLetters[index];
    auto& a = out_.setup.motion.axis[index];
    const double unit =
        rtapi::is_rotary(index) ? out_.setup.angular_unit_deg : out_.setup.linear_unit_mm;
    a.max_vel = rate(section, "MAX_VELOCITY", 1, true, "machine units/s") * unit;
    out_.setup.interp.axis_max_per_s[index] = a.max_vel;
    a.max_acc = rate(section, "MAX_ACCELERATION", 1, true, "machine units/s^2") * unit;
    a.max_jerk = length(section, "MAX_JERK", 0, false, 0) * unit;
    a.min_limit = scaled(length(section, "MIN_LIMIT", -1e99), unit);
    a.max_limit = scaled(length(section, "MAX_LIMIT", 1e99), unit);
    if (!(a.min_limit < a.max_limit))
      r_.complain(section, "MIN_LIMIT",
                  "MIN_LIMIT " + show(a.min_limit / unit) + " is not below MAX_LIMIT " +
                      show(a.max_limit / unit));
    a.offset_av_ratio =
        r_.real(section, "OFFSET_AV_RATIO", RealSpec{.fallback = 0, .min = 0, .max = 0.9});
    for (const char* key : {"WRAPPED_ROTARY", "LOCKING_INDEXER_JOINT", "HOME"})
      r_.known_key(section, key);
  }

  /// Identity kinematics: a joint must reach all that its axis may.
  void identity_limits() {
    const std::string kinematics =
        out_.setup.motion.joints > 0 ? r_.string("KINS", "KINEMATICS", "trivkins") : std::string();
    if (kinematics.rfind("trivkins", 0) != 0) return;
    std::string order;
    if (const auto at = kinematics.find("coordinates="); at != std::string::npos) {
      for (const char c : kinematics.substr(at + 12)) {
        if (rtapi::axis_index(c) < 0) break;
        order += c;
      }
    }
    if (order.empty()) order = std::string(rtapi::kAxisLetters);
    for (std::size_t j = 0;
         j < static_cast<std::size_t>(out_.setup.motion.joints) && j < order.size(); ++j) {
      const auto axis_at = static_cast<std::size_t>(rtapi::axis_index(order[j]));
      if ((out_.setup.motion.axis_mask & (1U << axis_at)) == 0) continue;
      const auto& joint_config = out_.setup.motion.joint[j];
      const auto& axis_config = out_.setup.motion.axis[axis_at];
      const std::string section = "JOINT_" + std::to_string(j);
      const std::string axis_section = std::string("[AXIS_") + rtapi::kAxisLetters[axis_at] + "]";
      if (joint_config.min_limit > axis_config.min_limit + 1e-9)
        r_.complain(section, "MIN_LIMIT",
                    "the joint's MIN_LIMIT is above " + axis_section +
                        "MIN_LIMIT: with trivkins the joint must reach all that its axis may");
      if (joint_config.max_limit < axis_config.max_limit - 1e-9)
        r_.complain(section, "MAX_LIMIT",
                    "the joint's MAX_LIMIT is below " + axis_section +
                        "MAX_LIMIT: with trivkins the joint must reach all that its axis may");
    }
  }

  void spindle(int index) {
    const std::string section = "SPINDLE_" + std::to_string(index);
    auto& s = out_.setup.motion.spindle[index];
    const auto rpm = [&](const char* key, double fallback) {
      return r_.real(section, key, RealSpec{.fallback = fallback, .min = 0, .unit = "rpm"});
    };
    s.max_forward_rpm = rpm("MAX_FORWARD_VELOCITY", 1e99);
    s.min_forward_rpm = rpm("MIN_FORWARD_VELOCITY", 0);
    s.max_reverse_rpm = rpm("MAX_REVERSE_VELOCITY", s.max_forward_rpm);
    s.min_reverse_rpm = rpm("MIN_REVERSE_VELOCITY", s.min_forward_rpm);
    const double most = std::max(s.max_forward_rpm, s.max_reverse_rpm);
    out_.setup.interp.spindle_max_rpm[static_cast<std::size_t>(index)] = most < 1e99 ? most : 0;
    s.home_search_rpm = r_.real(section, "HOME_SEARCH_VELOCITY", RealSpec{.unit = "rpm"});
    s.increment_rpm = rpm("INCREMENT", 100);
    if (s.min_forward_rpm > s.max_forward_rpm)
      r_.complain(section, "MIN_FORWARD_VELOCITY", "it is above MAX_FORWARD_VELOCITY");
    for (const char* key : {"HOME_SEQUENCE", "P", "I", "D", "FF0", "FF1", "FF2", "BIAS", "DEADBAND",
                            "MAX_OUTPUT", "MAX_VELOCITY", "MIN_VELOCITY"})
      r_.known_key(section, key);
  }

  void display() {
    auto& l = out_.setup.limits;
    l.max_feed_override =
        r_.real("DISPLAY", "MAX_FEED_OVERRIDE",
                RealSpec{.fallback = 1.0, .min = 0, .max = 100, .min_excluded = true});
    out_.setup.motion.max_feed_override = l.max_feed_override;
    l.min_spindle_override =
        r_.real("DISPLAY", "MIN_SPINDLE_OVERRIDE", RealSpec{.fallback = 0.5, .min = 0, .max = 100});
    l.max_spindle_override =
        r_.real("DISPLAY", "MAX_SPINDLE_OVERRIDE", RealSpec{.fallback = 1.0, .min = 0, .max = 100});
  }

  void rs274ngc() {
    auto& s = out_.setup;
    interp::InterpSetup read = interp::read_interp_setup(r_, s.linear_unit_mm);
    // What [TRAJ] and [EMCIO] say is not in these sections.
    read.settings.machine_unit_mm = s.interp.machine_unit_mm;
    read.settings.spindles = s.interp.spindles;
    read.settings.axis_mask = s.interp.axis_mask;
    read.settings.random_toolchanger = s.interp.random_toolchanger;
    read.settings.is_task = true;
    s.interp = std::move(read.settings);
    s.paths = std::move(read.paths);
    s.python = std::move(read.python);
    s.startup_code = std::move(read.startup_code);
    s.on_abort_command = std::move(read.on_abort_command);
  }

  void emcio() {
    constexpr const char* kSection = "EMCIO";
    auto& t = out_.setup.tools;
    const double unit = out_.setup.linear_unit_mm;
    const std::string table = r_.string(kSection, "TOOL_TABLE", "");
    if (!table.empty()) t.table_file = resolve_path(out_.setup.paths.ini_dir, table);
    t.random_changer = r_.boolean(kSection, "RANDOM_TOOLCHANGER", false);
    out_.setup.interp.random_toolchanger = t.random_changer;
    t.cycle_time_s = r_.real(kSection, "CYCLE_TIME", RealSpec{.fallback = 0.1, .unit = "s"});
    t.spindle_on_during_change = r_.boolean(kSection, "TOOL_CHANGE_WITH_SPINDLE_ON", false);
    t.quill_up = r_.boolean(kSection, "TOOL_CHANGE_QUILL_UP", false);
    t.at_g30 = r_.boolean(kSection, "TOOL_CHANGE_AT_G30", false);
    const std::string position = r_.string(kSection, "TOOL_CHANGE_POSITION", "");
    if (!position.empty()) {
      std::istringstream in(position);
      std::vector<double> numbers;
      for (double v = 0; in >> v;) numbers.push_back(v);
      if (!in.eof() || (numbers.size() != 3 && numbers.size() != 6 && numbers.size() != 9)) {
        r_.complain(kSection, "TOOL_CHANGE_POSITION",
                    "'" + position + "': expected 3, 6 or 9 numbers in machine units");
      } else {
        t.has_position = true;
        for (std::size_t a = 0; a < numbers.size(); ++a) {
          t.position[a] = numbers[a] * (rtapi::is_rotary(a) ? out_.setup.angular_unit_deg : unit);
          t.position_mask |= 1U << a;
        }
      }
    }
    for (const char* key : {"EMCIO", "DB_PROGRAM", "TOOL_TABLE_FORMAT", "COMMENT"})
      r_.known_key(kSection, key);
  }

  void unknown_keys() {
    std::vector<std::string> sections{"TRAJ", "KINS", "RS274NGC", "EMCIO", "PYTHON"};
    for (int j = 0; j < out_.setup.motion.joints; ++j)
      sections.push_back("JOINT_" + std::to_string(j));
    for (std::size_t a = 0; a < rtapi::kAxes; ++a)
      if ((out_.setup.motion.axis_mask & (1U << a)) != 0)
        sections.push_back(std::string("AXIS_") + rtapi::kAxisLetters[a]);
    for (int s = 0; s < out_.setup.motion.spindles; ++s)
      sections.push_back("SPINDLE_" + std::to_string(s));
    mark_keys_of_hal_files(sections);
    for (auto& d : r_.unknown_keys(sections)) out_.diagnostics.push_back(std::move(d));
  }

  /// Custom keys ([JOINT_0]SCALE ...) are legal where a HAL file uses them.
  void mark_keys_of_hal_files(const std::vector<std::string>& sections) {
    std::string hal;
    for (const char* key : {"HALFILE", "POSTGUI_HALFILE", "HALCMD", "SHUTDOWN"})
      for (const auto* entry : r_.file().find_all("HAL", key)) {
        hal += entry->value + '\n';
        const std::string name = entry->value.substr(0, entry->value.find(' '));
        if (auto text = io::read_file(resolve_path(out_.setup.paths.ini_dir, name)); text.ok())
          hal += *text + '\n';
      }
    for (const auto& section : sections)
      for (const auto* entry : r_.file().variables(section))
        if (hal.find(entry->key) != std::string::npos) r_.known_key(section, entry->key);
  }

  Reader r_;
  SetupResult out_;
};

}  // namespace

std::string SetupResult::text() const {
  std::string out;
  for (const auto& d : diagnostics) out += d.message() + '\n';
  return out;
}

SetupResult read_machine_setup(const ini::IniFile& file) { return SetupReader(file).run(); }

}  // namespace kerf::task
