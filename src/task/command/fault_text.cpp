#include "task/command/fault_text.hpp"

#include <cstdio>

namespace kerf::task {

using motion::Fault;
using motion::FaultRecord;

namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

std::string joint_name(const FaultRecord& f) { return "joint " + std::to_string(f.index); }

std::string axis_name(const FaultRecord& f) {
  if (f.index < 0 || f.index >= static_cast<std::int32_t>(rtapi::kAxes))
    return "axis " + std::to_string(f.index);
  return std::string("axis ") + rtapi::kAxisLetters[static_cast<std::size_t>(f.index)];
}

/// mm or degrees of a joint's or axis's value in machine units.
double joint_unit(const FaultRecord& f, const MachineSetup& setup) {
  const bool rotary = f.index >= 0 && f.index < static_cast<std::int32_t>(motion::kMaxJoints) &&
                      setup.motion.joint[f.index].rotary;
  return rotary ? setup.angular_unit_deg : setup.linear_unit_mm;
}
double axis_unit(const FaultRecord& f, const MachineSetup& setup) {
  return f.index >= 0 && rtapi::is_rotary(static_cast<std::size_t>(f.index))
             ? setup.angular_unit_deg
             : setup.linear_unit_mm;
}

std::string at_limit(const std::string& what, const char* end, const FaultRecord& f, double unit) {
  return what + " would be at " + number(f.value / unit) + ", beyond its " + end + " soft limit " +
         number(f.limit / unit);
}

std::string body(const FaultRecord& f, const MachineSetup& setup) {
  const double ju = joint_unit(f, setup), au = axis_unit(f, setup);
  switch (f.fault) {
    case Fault::none: return "no fault";
    case Fault::internal: return "internal fault of motion; machine off";
    case Fault::joint_soft_limit_min: return at_limit(joint_name(f), "lower", f, ju);
    case Fault::joint_soft_limit_max: return at_limit(joint_name(f), "upper", f, ju);
    case Fault::axis_soft_limit_min: return at_limit(axis_name(f), "lower", f, au);
    case Fault::axis_soft_limit_max: return at_limit(axis_name(f), "upper", f, au);
    case Fault::joint_hard_limit_min:
      return joint_name(f) + " is on its lower limit switch (joint." + std::to_string(f.index) +
             ".neg-lim-sw-in)";
    case Fault::joint_hard_limit_max:
      return joint_name(f) + " is on its upper limit switch (joint." + std::to_string(f.index) +
             ".pos-lim-sw-in)";
    case Fault::following_error:
      return joint_name(f) + " following error " + number(f.value / ju) + ", limit " +
             number(f.limit / ju);
    case Fault::amp_fault:
      return joint_name(f) + " amplifier fault (joint." + std::to_string(f.index) +
             ".amp-fault-in)";
    case Fault::enable_lost: return "motion.enable went FALSE; machine off";
    case Fault::heartbeat_lost:
      return "motion heard nothing of task for " + number(f.value) + " s; machine off";
    case Fault::not_homed:
      return f.index >= 0 ? joint_name(f) + " is not homed"
                          : std::string("not all joints are homed");
    case Fault::home_failed: return joint_name(f) + " homing failed in state " + number(f.value);
    case Fault::home_no_switch:
      return joint_name(f) + " homing: no switch found within " + number(f.limit / ju);
    case Fault::home_busy: return "homing: another homing or motion is in progress";
    case Fault::jog_while_not_ready:
      return "jog refused: the machine is not on, or in another mode";
    case Fault::jog_beyond_limit:
      return joint_name(f) + " jog: already at its limit " + number(f.limit / ju);
    case Fault::no_inverse: return "kinematics: this position cannot be reached by the joints";
    case Fault::bad_item:
      return "a move that cannot be (no number, radius 0, or an index out of range)";
    case Fault::limit_velocity:
      return joint_name(f) + " commanded velocity " + number(f.value / ju) +
             " is above its limit " + number(f.limit / ju);
    case Fault::limit_acceleration:
      return joint_name(f) + " commanded acceleration " + number(f.value / ju) +
             " is above its limit " + number(f.limit / ju);
    case Fault::limit_jerk:
      return joint_name(f) + " commanded jerk " + number(f.value / ju) + " is above its limit " +
             number(f.limit / ju);
    case Fault::limit_continuity:
      return joint_name(f) + " commanded position jumped by " + number(f.value / ju);
    case Fault::probe_no_contact: return "G38: probe move ended without contact";
    case Fault::probe_already_tripped: return "G38: the probe was tripped before the move began";
    case Fault::probe_unexpected: return "the probe tripped during a move that is no probe move";
    case Fault::orient_fault:
      return "spindle " + std::to_string(f.index) + " orient fault " + number(f.value);
    case Fault::spindle_fault: return "spindle " + std::to_string(f.index) + " amplifier fault";
    case Fault::path_starved_internal: return "internal fault of motion: the path ran out of plan";
  }
  return "fault " + std::to_string(static_cast<int>(f.fault));
}

}  // namespace

std::string fault_text(const FaultRecord& fault, const MachineSetup& setup) {
  return body(fault, setup);
}

bool ends_program(Fault fault) noexcept {
  switch (fault) {
    case Fault::home_failed:
    case Fault::home_no_switch:
    case Fault::home_busy:
    case Fault::jog_while_not_ready:
    case Fault::jog_beyond_limit:
    case Fault::limit_velocity:
    case Fault::limit_acceleration:
    case Fault::limit_jerk: return false;
    default: return true;
  }
}

}  // namespace kerf::task
