#include "task/machine_config.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <utility>
#include <vector>

#include "ini/convert.hpp"
#include "ini/reader.hpp"
#include "io/tool_table.hpp"
#include "task/screw_file.hpp"

namespace kerf::task {
namespace {

using ini::Reader;

/// "%g" without surprises.
std::string show(double v) {
  std::ostringstream out;
  out << v;
  return out.str();
}

/// "0x7FFFFFFF", "3"; 0 for anything else: it only sets how much is printed.
constexpr const char* kDigitalOut = "motion.digital-out-";
constexpr const char* kAnalogOut = "motion.analog-out-";

int debug_level(const std::string& text) {
  return static_cast<int>(std::strtoul(text.c_str(), nullptr, 0));
}

class SetupReader {
 public:
  explicit SetupReader(const ini::IniFile& file) : r_(file) { out_.setup.ini_file = file.name(); }

  SetupResult run() {
    out_.setup.machine_name = r_.string("EMC", "MACHINE");
    units();
    traj();
    for (int j = 0; j < out_.setup.motion.joints; ++j) joint(j);
    for (std::size_t a = 0; a < rtapi::kAxes; ++a)
      if ((out_.setup.motion.axis_mask & (1U << a)) != 0) axis(a);
    sequences();
    jerks();
    identity_limits();
    for (int s = 0; s < out_.setup.motion.spindles; ++s) spindle(s);
    display();
    rs274ngc();
    emcio();
    for (int j = 0; j < out_.setup.motion.joints; ++j) screw(j);
    out_.setup.mdi_queue = static_cast<int>(r_.integer("TASK", "MDI_QUEUED_COMMANDS"));
    out_.setup.motion.heartbeat_timeout_s = r_.real("KERF", "HEARTBEAT_TIMEOUT");
    out_.setup.motion.lost_heartbeat_is_off = r_.choice("KERF", "HEARTBEAT_REACTION") == 1;
    out_.setup.step_by_moves = r_.choice("KERF", "SINGLE_STEP") == 1;
    out_.setup.motion.overrun = static_cast<motion::OverrunPolicy>(r_.choice("KERF", "OVERRUN"));
    out_.setup.motion.overrun_periods = r_.real("KERF", "OVERRUN_PERIODS");
    out_.setup.motion.stale_cycles =
        static_cast<std::int32_t>(r_.integer("KERF", "STALE_FEEDBACK_CYCLES"));
    out_.setup.motion.stale_window =
        static_cast<std::int32_t>(r_.integer("KERF", "STALE_FEEDBACK_WINDOW"));
    out_.setup.check_limits = r_.boolean("KERF", "CHECK_LIMITS");
    out_.setup.motion.path_check = r_.boolean("KERF", "PATH_CHECK");
    out_.setup.motion.time_laws = r_.boolean("KERF", "TIME_LAWS");
    out_.setup.journal = r_.string("KERF", "JOURNAL");
    safe_state();
    out_.diagnostics = r_.complaints();
    out_.ok = std::none_of(out_.diagnostics.begin(), out_.diagnostics.end(),
                           [](const auto& d) { return d.is_error; });
    return std::move(out_);
  }

 private:
  /// LinuxCNC goes on with its default, too; at 1 mm/s nobody would know why the machine is slow.
  double rate(const std::string& section, const char* key) {
    const double value = r_.real(section, key);
    if (!r_.has(section, key))
      r_.complain(section, key, "is not given: " + show(value) + " is used", false);
    return value;
  }
  static double scaled(double value, double unit) {
    return std::fabs(value) >= 1e98 ? value : value * unit;
  }

  /// Motion sets its own outputs itself, in the very cycle; all other pins of [SAFE_STATE] are the launcher's.
  void safe_state() {
    motion::SafeOutputs& safe = out_.setup.motion.safe;
    for (const std::string& line : r_.strings("SAFE_STATE", "PIN")) {
      std::istringstream in(line);
      std::string name, text;
      in >> name >> text;
      const bool digital = name.rfind(kDigitalOut, 0) == 0;
      if (!digital && name.rfind(kAnalogOut, 0) != 0) continue;
      const std::string digits = name.substr(std::strlen(digital ? kDigitalOut : kAnalogOut));
      char* end = nullptr;
      const unsigned long index = std::strtoul(digits.c_str(), &end, 10);
      const std::size_t most = digital ? motion::kMaxDigital : motion::kMaxAnalog;
      if (digits.empty() || *end != '\0' || index >= most) {
        r_.complain("SAFE_STATE", "PIN",
                    name + ": expected a number from 00 to " + std::to_string(most - 1) +
                        " (of an output with a name, its place in the list that motmod has)");
        continue;
      }
      const std::uint64_t bit = std::uint64_t{1} << index;
      const double value = std::strtod(text.c_str(), &end);
      if (digital) {
        const bool on = text == "1" || ini::equal_ignoring_case(text, "true");
        if (!on && text != "0" && !ini::equal_ignoring_case(text, "false"))
          r_.complain("SAFE_STATE", "PIN",
                      std::string(name).append(": '").append(text).append("': expected 0 or 1"));
        safe.digital_mask |= bit;
        if (on) safe.digital |= bit;
      } else {
        if (text.empty() || *end != '\0' || !std::isfinite(value))
          r_.complain("SAFE_STATE", "PIN",
                      std::string(name).append(": '").append(text).append("': expected a number"));
        safe.analog_mask |= bit;
        safe.analog[index] = value;
      }
    }
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
    m.joints = static_cast<std::int32_t>(r_.integer("KINS", "JOINTS"));
    (void)r_.string("KINS", "KINEMATICS");
    m.spindles = static_cast<std::int32_t>(r_.integer("TRAJ", "SPINDLES"));
    s.interp.spindles = m.spindles;
    const double linear = s.linear_unit_mm;
    m.traj_max_vel_mm_s = r_.real("TRAJ", "MAX_LINEAR_VELOCITY", 1e9) * linear;
    m.traj_max_acc_mm_s2 = r_.real("TRAJ", "MAX_LINEAR_ACCELERATION", 1e9) * linear;
    m.rotary_tolerance_deg = std::max(0.0, r_.real("TRAJ", "ROTARY_TOLERANCE"));
    m.traj_max_jerk_mm_s3 = std::max(0.0, r_.real("TRAJ", "MAX_LINEAR_JERK")) * linear;
    m.traj_max_ang_vel_deg_s = r_.real("TRAJ", "MAX_ANGULAR_VELOCITY", 1e9) * s.angular_unit_deg;
    s.default_vel_mm_s = r_.real("TRAJ", "DEFAULT_LINEAR_VELOCITY") * linear;
    s.default_acc_mm_s2 = r_.real("TRAJ", "DEFAULT_LINEAR_ACCELERATION") * linear;
    s.task_cycle_s = r_.real("TASK", "CYCLE_TIME");
    s.debug = debug_level(r_.string("EMC", "DEBUG"));
    m.no_force_homing = r_.boolean("TRAJ", "NO_FORCE_HOMING");
    m.probe_error_inhibit_jog = r_.boolean("TRAJ", "NO_PROBE_JOG_ERROR");
    m.probe_error_inhibit_home = r_.boolean("TRAJ", "NO_PROBE_HOME_ERROR");
  }

  void coordinates() {
    const std::string text = r_.string("TRAJ", "COORDINATES");
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
    if (mask == 0 && r_.has("TRAJ", "COORDINATES"))
      r_.complain("TRAJ", "COORDINATES",
                  "no axis named: expected letters of XYZABCUVW, such as X Y Z");
    out_.setup.motion.axis_mask = mask;
    out_.setup.interp.axis_mask = mask;
  }

  void joint(int index) {
    const std::string section = "JOINT_" + std::to_string(index);
    auto& j = out_.setup.motion.joint[index];
    j.rotary = r_.choice(section, "TYPE") == 1;
    double unit = j.rotary ? out_.setup.angular_unit_deg : out_.setup.linear_unit_mm;
    if (r_.has(section, "UNITS"))
      unit = j.rotary ? r_.angular_unit(section, "UNITS", unit)
                      : r_.linear_unit(section, "UNITS", unit);
    out_.setup.joint_unit[static_cast<std::size_t>(index)] = unit;
    limits(section, unit, j);
    j.max_vel = rate(section, "MAX_VELOCITY") * unit;
    j.max_acc = rate(section, "MAX_ACCELERATION") * unit;
    j.max_jerk = r_.real(section, "MAX_JERK") * unit;
    j.ferror = scaled(r_.real(section, "FERROR", 1e99), unit);
    j.min_ferror = r_.has(section, "MIN_FERROR") ? r_.real(section, "MIN_FERROR") * unit : j.ferror;
    if (r_.has(section, "FERROR") && j.min_ferror > j.ferror) j.min_ferror = j.ferror;
    j.backlash = r_.real(section, "BACKLASH") * unit;
    homing(section, j, unit);
  }

  /// MIN_LIMIT and MAX_LIMIT of a joint or an axis.
  template <class Config>
  void limits(const std::string& section, double unit, Config& config) {
    config.min_limit = scaled(r_.real(section, "MIN_LIMIT", -1e99), unit);
    config.max_limit = scaled(r_.real(section, "MAX_LIMIT", 1e99), unit);
    if (!(config.min_limit < config.max_limit))
      r_.complain(section, "MIN_LIMIT",
                  "MIN_LIMIT " + show(config.min_limit / unit) + " is not below MAX_LIMIT " +
                      show(config.max_limit / unit));
  }

  void homing(const std::string& section, motion::JointConfig& j, double unit) {
    j.home = r_.real(section, "HOME") * unit;
    j.home_offset = r_.real(section, "HOME_OFFSET") * unit;
    j.home_search_vel = r_.real(section, "HOME_SEARCH_VEL") * unit;
    j.home_latch_vel = r_.real(section, "HOME_LATCH_VEL") * unit;
    j.home_final_vel = r_.real(section, "HOME_FINAL_VEL") * unit;
    if (j.home_search_vel != 0 && j.home_latch_vel == 0)
      r_.complain(section, "HOME_LATCH_VEL",
                  "HOME_SEARCH_VEL is set and HOME_LATCH_VEL is 0: expected a velocity towards or "
                  "off the switch, in machine units/s");
    j.home_search_dist = r_.real(section, "HOME_SEARCH_DIST") * unit;
    j.home_latch_dist = r_.real(section, "HOME_LATCH_DIST") * unit;
    j.home_sequence =
        static_cast<std::int32_t>(r_.integer(section, "HOME_SEQUENCE", motion::kNoHomeSequence));
    const auto flag = [&](const char* key, std::int32_t bit) {
      if (r_.boolean(section, key)) j.home_flags |= bit;
    };
    flag("HOME_IGNORE_LIMITS", motion::home_ignore_limits);
    flag("HOME_USE_INDEX", motion::home_use_index);
    flag("HOME_IS_SHARED", motion::home_is_shared);
    flag("HOME_INDEX_NO_ENCODER_RESET", motion::home_index_no_encoder_reset);
    flag("LOCKING_INDEXER", motion::home_unlock_first);
    const bool index = (j.home_flags & motion::home_use_index) != 0;
    if (!index && j.home_search_vel == 0 && j.home_latch_vel != 0)
      r_.complain(
          section, "HOME_LATCH_VEL",
          "there is neither a switch (HOME_SEARCH_VEL) nor an index (HOME_USE_INDEX) to find "
          "with it, so the joint cannot be homed",
          false);
    if (index && j.home_latch_vel == 0)
      r_.complain(
          section, "HOME_USE_INDEX",
          "HOME_LATCH_VEL is 0, so the joint cannot be homed: expected the speed towards the "
          "index",
          false);
    const auto absolute = r_.integer(section, "HOME_ABSOLUTE_ENCODER");
    if (absolute > 0) j.home_flags |= motion::home_absolute_encoder | motion::home_no_rehome;
    if (absolute == 2) j.home_flags |= motion::home_no_final_move;
    j.volatile_home = r_.boolean(section, "VOLATILE_HOME");
  }

  void screw(int index) {
    const std::string section = "JOINT_" + std::to_string(index);
    const std::string file = r_.string(section, "COMP_FILE");
    if (file.empty()) return;
    if (!r_.has(section, "COMP_FILE_TYPE"))
      r_.complain(section, "COMP_FILE", "COMP_FILE_TYPE is not given: 0, positions, is used",
                  false);
    auto& s = out_.setup;
    s.screws.resize(motion::kMaxJoints);
    const auto j = static_cast<std::size_t>(index);
    const auto type = static_cast<ScrewFileType>(r_.choice(section, "COMP_FILE_TYPE"));
    const std::string why =
        read_screw_file(resolve_path(s.paths.ini_dir, file), type, s.joint_unit[j], s.screws[j]);
    if (!why.empty()) r_.complain(section, "COMP_FILE", why);
    if (why.empty() && s.motion.joint[j].backlash != 0)
      r_.complain(section, "BACKLASH", "is not used, since there is a COMP_FILE", false);
  }

  /// Home all ends where HOME_SEQUENCE numbers do not follow one another.
  void sequences() {
    std::vector<std::pair<int, int>> order;  // |number|, joint
    for (int j = 0; j < out_.setup.motion.joints; ++j) {
      const int number = out_.setup.motion.joint[j].home_sequence;
      if (number != motion::kNoHomeSequence) order.emplace_back(std::abs(number), j);
    }
    std::sort(order.begin(), order.end());
    int last = 0;
    for (const auto& [number, j] : order) {
      if (number > last + 1)
        r_.complain(
            "JOINT_" + std::to_string(j), "HOME_SEQUENCE",
            "no joint has " + std::to_string(last + 1) +
                ", so home all ends before this one: numbers begin at 0 or 1 and follow one "
                "another",
            false);
      last = number;
    }
  }

  void axis(std::size_t index) {
    const std::string section = std::string("AXIS_") + rtapi::kAxisLetters[index];
    auto& a = out_.setup.motion.axis[index];
    const double unit =
        rtapi::is_rotary(index) ? out_.setup.angular_unit_deg : out_.setup.linear_unit_mm;
    a.max_vel = rate(section, "MAX_VELOCITY") * unit;
    out_.setup.interp.axis_max_per_s[index] = a.max_vel;
    a.max_acc = rate(section, "MAX_ACCELERATION") * unit;
    a.max_jerk = r_.real(section, "MAX_JERK") * unit;
    limits(section, unit, a);
    a.offset_av_ratio = r_.real(section, "OFFSET_AV_RATIO");
    indexer(section, index, a);
  }

  void indexer(const std::string& section, std::size_t index, motion::AxisConfig& a) {
    constexpr const char* kKey = "LOCKING_INDEXER_JOINT";
    if (!r_.has(section, kKey)) return;
    if (!rtapi::is_rotary(index)) {
      r_.complain(section, kKey, "is for the rotary axes A, B and C");
      return;
    }
    const auto joint = static_cast<int>(r_.integer(section, kKey));
    if (joint >= out_.setup.motion.joints) {
      r_.complain(section, kKey,
                  "there is no joint " + std::to_string(joint) + ": [KINS]JOINTS is " +
                      std::to_string(out_.setup.motion.joints));
      return;
    }
    a.locking_joint = joint;
    const std::string of_joint = "JOINT_" + std::to_string(joint);
    if ((out_.setup.motion.joint[joint].home_flags & motion::home_unlock_first) == 0)
      r_.complain(section, kKey,
                  "[" + of_joint + "]LOCKING_INDEXER = 1 is missing, so the joint homes locked",
                  false);
    if (a.offset_av_ratio > 0)
      r_.complain(section, "OFFSET_AV_RATIO",
                  "external offsets cannot turn a locking indexer: delete it");
  }

  /// [TRAJ]PLANNER_TYPE 0 switches all jerk limits off; without it they count where they are given. MAX_LINEAR_JERK counts for linear joints and
  /// axes that have none of their own.
  void jerks() {
    auto& m = out_.setup.motion;
    const bool asked = r_.has("TRAJ", "PLANNER_TYPE");
    const bool off = asked && r_.choice("TRAJ", "PLANNER_TYPE") == 0;
    JerkLimits& limits = out_.setup.jerks;
    limits.traj_mm_s3 = m.traj_max_jerk_mm_s3;
    bool any = limits.traj_mm_s3 > 0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(std::max(m.joints, 0)); ++j) {
      double& jerk = m.joint[j].max_jerk;
      if (!(jerk > 0) && !m.joint[j].rotary) jerk = limits.traj_mm_s3;
      any = any || jerk > 0;
      limits.joint[j] = jerk;
      if (off) jerk = 0;
    }
    for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
      double& jerk = m.axis[a].max_jerk;
      const bool exists = (m.axis_mask & (1U << a)) != 0;
      if (!exists) jerk = 0;
      if (exists && !(jerk > 0) && !rtapi::is_rotary(a)) jerk = limits.traj_mm_s3;
      any = any || jerk > 0;
      limits.axis[a] = jerk;
      if (off) jerk = 0;
    }
    if (off) m.traj_max_jerk_mm_s3 = 0;
    if (asked && !off && !any)
      r_.complain("TRAJ", "PLANNER_TYPE",
                  "is 1, but there is no [JOINT_n]MAX_JERK, [AXIS_L]MAX_JERK or "
                  "[TRAJ]MAX_LINEAR_JERK: only acceleration is limited",
                  false);
  }

  /// Identity kinematics: a joint must reach all that its axis may.
  void identity_limits() {
    const ini::Entry* entry = r_.file().find("KINS", "KINEMATICS");
    const std::string kinematics = entry != nullptr ? entry->value : "trivkins";
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
      out_.setup.joint_axis[j] = static_cast<int>(axis_at);
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
    s.max_forward_rpm = r_.real(section, "MAX_FORWARD_VELOCITY", 1e99);
    s.min_forward_rpm = r_.real(section, "MIN_FORWARD_VELOCITY");
    s.max_reverse_rpm = r_.real(section, "MAX_REVERSE_VELOCITY", s.max_forward_rpm);
    s.min_reverse_rpm = r_.real(section, "MIN_REVERSE_VELOCITY", s.min_forward_rpm);
    const double most = std::max(s.max_forward_rpm, s.max_reverse_rpm);
    out_.setup.interp.spindle_max_rpm[static_cast<std::size_t>(index)] = most < 1e99 ? most : 0;
    s.home_search_rpm = r_.real(section, "HOME_SEARCH_VELOCITY");
    s.increment_rpm = r_.real(section, "INCREMENT");
    if (s.min_forward_rpm > s.max_forward_rpm)
      r_.complain(section, "MIN_FORWARD_VELOCITY", "it is above MAX_FORWARD_VELOCITY");
  }

  void display() {
    auto& l = out_.setup.limits;
    l.max_feed_override = r_.real("DISPLAY", "MAX_FEED_OVERRIDE");
    out_.setup.motion.max_feed_override = l.max_feed_override;
    l.min_spindle_override = r_.real("DISPLAY", "MIN_SPINDLE_OVERRIDE");
    l.max_spindle_override = r_.real("DISPLAY", "MAX_SPINDLE_OVERRIDE");
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
    s.motion.adaptive_only_slows = s.interp.compat != interp::Compat::newest;
    s.motion.adaptive_reverses = s.interp.compat != interp::Compat::v2_7;
    s.paths = std::move(read.paths);
    s.python = std::move(read.python);
    const std::string positions = r_.string("TRAJ", "POSITION_FILE");
    if (!positions.empty()) s.position_file = resolve_path(s.paths.ini_dir, positions);
    s.startup_code = std::move(read.startup_code);
    s.on_abort_command = std::move(read.on_abort_command);
  }

  void emcio() {
    constexpr const char* kSection = "EMCIO";
    auto& t = out_.setup.tools;
    const double unit = out_.setup.linear_unit_mm;
    t.database = r_.string(kSection, "DB_PROGRAM");
    const std::string table = r_.string(kSection, "TOOL_TABLE");
    if (!table.empty() && t.database.empty())
      t.table_file = resolve_path(out_.setup.paths.ini_dir, table);
    t.random_changer = r_.boolean(kSection, "RANDOM_TOOLCHANGER");
    const std::string program = r_.string(kSection, "EMCIO");
    t.v2_pins = program == "iov2" || program.rfind("iov2 ", 0) == 0;
    t.v2 = t.v2_pins && r_.integer(kSection, "PROTOCOL_VERSION", 2) != 1;
    t.start_change = program.find("-support-start-change") != std::string::npos;
    const std::string fault = r_.string("TASK", "IO_ERROR");
    if (!fault.empty()) t.fault_text = fault;
    if (const auto period = r_.integer("EMCMOT", "SERVO_PERIOD", 0); period > 0)
      t.servo_period_ns = period;
    out_.setup.interp.random_toolchanger = t.random_changer;
    out_.setup.interp.spindle_on_during_change =
        r_.boolean(kSection, "TOOL_CHANGE_WITH_SPINDLE_ON");
    t.quill_up = r_.boolean(kSection, "TOOL_CHANGE_QUILL_UP");
    t.at_g30 = r_.boolean(kSection, "TOOL_CHANGE_AT_G30");
    const std::vector<double> position = r_.reals(kSection, "TOOL_CHANGE_POSITION");
    t.has_position = !position.empty();
    for (std::size_t a = 0; a < position.size(); ++a) {
      t.position[a] = position[a] * (rtapi::is_rotary(a) ? out_.setup.angular_unit_deg : unit);
      t.position_mask |= 1U << a;
    }
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
