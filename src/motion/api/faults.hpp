// Names and texts of faults, for readers: realtime code keeps numbers only. @nonrt
#pragma once

#include <cstdio>
#include <span>
#include <string>
#include <string_view>

#include "motion/api/config.hpp"
#include "motion/api/status.hpp"

namespace kerf::motion {

/// All faults that exist, in the order of their numbers.
inline constexpr Fault kFaults[] = {Fault::internal,
                                    Fault::joint_soft_limit_min,
                                    Fault::joint_soft_limit_max,
                                    Fault::axis_soft_limit_min,
                                    Fault::axis_soft_limit_max,
                                    Fault::joint_hard_limit_min,
                                    Fault::joint_hard_limit_max,
                                    Fault::following_error,
                                    Fault::amp_fault,
                                    Fault::enable_lost,
                                    Fault::heartbeat_lost,
                                    Fault::not_homed,
                                    Fault::home_failed,
                                    Fault::home_no_switch,
                                    Fault::home_busy,
                                    Fault::jog_while_not_ready,
                                    Fault::jog_beyond_limit,
                                    Fault::no_inverse,
                                    Fault::bad_item,
                                    Fault::kinematics_refused,
                                    Fault::indexer_refused,
                                    Fault::stale_feedback,
                                    Fault::limit_velocity,
                                    Fault::limit_acceleration,
                                    Fault::limit_jerk,
                                    Fault::limit_continuity,
                                    Fault::indexer_locked,
                                    Fault::limit_path,
                                    Fault::probe_no_contact,
                                    Fault::probe_already_tripped,
                                    Fault::probe_unexpected,
                                    Fault::orient_fault,
                                    Fault::spindle_fault,
                                    Fault::sync_too_fast,
                                    Fault::sync_too_short,
                                    Fault::sync_no_index,
                                    Fault::sync_behind,
                                    Fault::path_starved_internal,
                                    Fault::overrun};

/// The name of the fault's page, docs/troubleshooting/NAME.md; a fault missing here does not compile.
inline const char* fault_name(Fault fault) {
  switch (fault) {
    case Fault::none: return "none";
    case Fault::internal: return "internal";
    case Fault::joint_soft_limit_min: return "joint-soft-limit-min";
    case Fault::joint_soft_limit_max: return "joint-soft-limit-max";
    case Fault::axis_soft_limit_min: return "axis-soft-limit-min";
    case Fault::axis_soft_limit_max: return "axis-soft-limit-max";
    case Fault::joint_hard_limit_min: return "joint-hard-limit-min";
    case Fault::joint_hard_limit_max: return "joint-hard-limit-max";
    case Fault::following_error: return "following-error";
    case Fault::amp_fault: return "amp-fault";
    case Fault::enable_lost: return "enable-lost";
    case Fault::heartbeat_lost: return "heartbeat-lost";
    case Fault::not_homed: return "not-homed";
    case Fault::home_failed: return "home-failed";
    case Fault::home_no_switch: return "home-no-switch";
    case Fault::home_busy: return "home-busy";
    case Fault::jog_while_not_ready: return "jog-while-not-ready";
    case Fault::jog_beyond_limit: return "jog-beyond-limit";
    case Fault::no_inverse: return "no-inverse";
    case Fault::bad_item: return "bad-item";
    case Fault::kinematics_refused: return "kinematics-refused";
    case Fault::indexer_refused: return "indexer-refused";
    case Fault::stale_feedback: return "stale-feedback";
    case Fault::limit_velocity: return "limit-velocity";
    case Fault::limit_acceleration: return "limit-acceleration";
    case Fault::limit_jerk: return "limit-jerk";
    case Fault::limit_continuity: return "limit-continuity";
    case Fault::indexer_locked: return "indexer-locked";
    case Fault::limit_path: return "limit-path";
    case Fault::probe_no_contact: return "probe-no-contact";
    case Fault::probe_already_tripped: return "probe-already-tripped";
    case Fault::probe_unexpected: return "probe-unexpected";
    case Fault::orient_fault: return "orient-fault";
    case Fault::spindle_fault: return "spindle-fault";
    case Fault::sync_too_fast: return "sync-too-fast";
    case Fault::sync_too_short: return "sync-too-short";
    case Fault::sync_no_index: return "sync-no-index";
    case Fault::sync_behind: return "sync-behind";
    case Fault::path_starved_internal: return "path-starved-internal";
    case Fault::overrun: return "overrun";
  }
  return "unknown";
}

/// Why homing failed: FaultRecord::value of Fault::home_failed. `HOMING_STATE` numbers are of joint.N.home-state.
inline const char* home_failure_text(double value) {
  switch (static_cast<int>(value)) {
    case 1: return "the machine is off; switch it on first";
    case 2: return "homing needs joint mode; leave teleop and coordinated mode first";
    case 3: return "the pin motion.homing-inhibit forbids it";
    case 4:
      return "HOME_SEARCH_VEL is set but HOME_LATCH_VEL is 0; set both, or neither for homing in "
             "place";
    case 5:
      return "HOME_LATCH_VEL is set, but there is neither a switch (HOME_SEARCH_VEL) nor an index "
             "(HOME_USE_INDEX = YES) to find with it";
    case 6:
      return "HOME_IS_SHARED is set and the switch is closed already; move the joints off their "
             "switches first";
    case 7:
      return "the home switch did not open while the joint backed off; check the switch and its "
             "wiring";
    case 8: return "there is no such joint";
    case 9: return "it was stopped";
    case 10:
      return "no joint has a HOME_SEQUENCE, so home all has nothing to do; home joint by joint or "
             "set HOME_SEQUENCE";
    case 11:
      return "the home switch closed in the search and was not found again on the way back; check "
             "it and its wiring for loose contacts";
    case 12:
      return "the encoder's index did not come; connect joint.N.index-enable to the encoder and "
             "check its index";
    case 13:
      return "HOME_USE_INDEX is set but HOME_LATCH_VEL is 0; set it to the speed towards the index";
    case 15:
      return "its HOME_SEQUENCE numbers do not begin at 0 or 1 and follow one another, and home "
             "all "
             "ends before the gap; correct them";
    case 16:
      return "its feedback was lost in the cycle in which its switch or index came, so nobody "
             "knows "
             "where that is; home again";
    case 14: return "it is an extra joint, which is unhomed only while the machine is off";
    default: return "unknown reason";
  }
}

namespace detail {

inline std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4f", value);
  return text;
}
inline std::string line_of(const SourceTag& tag) {
  return tag.line > 0 ? " on line " + std::to_string(tag.line) : std::string();
}
inline std::string joint_of(std::int32_t index) {
  return index >= 0 ? "joint " + std::to_string(index) : std::string("the machine");
}
inline std::string axis_of(std::int32_t index) {
  if (index < 0 || static_cast<std::size_t>(index) >= rtapi::kAxes) return "an axis";
  return std::string("axis ") + rtapi::kAxisLetters[static_cast<std::size_t>(index)];
}
inline std::string misc_error_pin(int number) {
  char text[60];
  std::snprintf(text, sizeof text, "motion.misc-error-%02d, or by its name motion.err-NAME",
                number);
  return text;
}
/// Of jogs, whose index is a joint or kAxisJog + an axis.
inline std::string jogged_of(std::int32_t index) {
  return index >= kAxisJog ? axis_of(index - kAxisJog) : joint_of(index);
}
/// A length for people: in machine units, as the INI has it; degrees as they are.
inline std::string shown(double value, bool rotary, const MachineConfig& config) {
  const double k = rotary || config.linear_units_per_mm <= 0 ? 1.0 : config.linear_units_per_mm;
  return number(value * k);
}

inline std::string soft_limit_text(const FaultRecord& r, const MachineConfig& config) {
  const bool joint =
      r.fault == Fault::joint_soft_limit_min || r.fault == Fault::joint_soft_limit_max;
  const bool high = r.fault == Fault::joint_soft_limit_max || r.fault == Fault::axis_soft_limit_max;
  const bool rotary = joint ? r.index >= 0 && static_cast<std::size_t>(r.index) < kMaxJoints &&
                                  config.joint[r.index].rotary
                            : r.index >= 0 && rtapi::is_rotary(static_cast<std::size_t>(r.index));
  return "Move" + line_of(r.tag) + " would take " + (joint ? joint_of(r.index) : axis_of(r.index)) +
         " to " + shown(r.value, rotary, config) + ", " +
         (high ? "above its MAX_LIMIT of " : "below its MIN_LIMIT of ") +
         shown(r.limit, rotary, config) +
         "; nothing was moved. Change the program or the work offset";
}

inline std::string joint_value(const FaultRecord& r, double value, const MachineConfig& config) {
  const bool rotary = r.index >= 0 && static_cast<std::size_t>(r.index) < kMaxJoints &&
                      config.joint[r.index].rotary;
  return shown(value, rotary, config);
}

inline std::string jog_value(const FaultRecord& r, double value, const MachineConfig& config) {
  if (r.index < kAxisJog) return joint_value(r, value, config);
  return shown(value, rtapi::is_rotary(static_cast<std::size_t>(r.index - kAxisJog)), config);
}

inline std::string oracle_text(const FaultRecord& r, const MachineConfig& config,
                               const char* what) {
  return "Internal fault: commanded " + std::string(what) + " of " + joint_of(r.index) +
         line_of(r.tag) + " was " + joint_value(r, r.value, config) + ", its limit is " +
         joint_value(r, r.limit, config) + ". Please report it with the program";
}

inline std::string indexer_text(const FaultRecord& r) {
  const std::string joint = std::to_string(static_cast<int>(r.limit));
  switch (static_cast<IndexerRefusal>(static_cast<int>(r.value))) {
    case IndexerRefusal::locked:
      return "Cannot jog " + jogged_of(r.index) + ": it is a locking indexer, and joint." + joint +
             ".is-unlocked is false. Turn it with G0, in MDI or a program";
    case IndexerRefusal::no_pins:
      return "Move" + line_of(r.tag) + " of " + axis_of(r.index) + " needs the pins joint." +
             joint + ".unlock and joint." + joint +
             ".is-unlocked: load motmod with this joint's bit in unlock_joints_mask";
    case IndexerRefusal::not_alone: break;
  }
  return "Move" + line_of(r.tag) + " would turn " + axis_of(r.index) +
         ", which is a locking indexer: it turns only in G0, alone; nothing was moved. Change the "
         "program";
}

}  // namespace detail

/// One message for a person: what happened, where, and what to do. Positions in machine units.
inline std::string fault_text(const FaultRecord& r, const MachineConfig& config) {
  using namespace detail;
  const auto v = [&](double value) { return joint_value(r, value, config); };
  switch (r.fault) {
    case Fault::none: return "no fault";
    case Fault::internal:
      return "Internal fault of the motion controller, the machine is off. Please report it";
    case Fault::joint_soft_limit_min:
    case Fault::joint_soft_limit_max:
    case Fault::axis_soft_limit_min:
    case Fault::axis_soft_limit_max: return soft_limit_text(r, config);
    case Fault::joint_hard_limit_min:
      return joint_of(r.index) + " is on its negative limit switch at " + v(r.value) +
             ". Override limits, switch on and jog it off";
    case Fault::joint_hard_limit_max:
      return joint_of(r.index) + " is on its positive limit switch at " + v(r.value) +
             ". Override limits, switch on and jog it off";
    case Fault::following_error:
      return joint_of(r.index) + " following error: it is " + v(r.value) +
             " away from where it should be" + line_of(r.tag) + ", allowed are " + v(r.limit) +
             ". Check the drive, the load, FERROR and MIN_FERROR";
    case Fault::amp_fault:
      if (r.index < 0)
        return "Error input " + std::to_string(static_cast<int>(r.value)) + " (" +
               misc_error_pin(static_cast<int>(r.value)) +
               ") is true, so the machine is off; clear it at its source";
      return joint_of(r.index) + " amplifier fault (joint." + std::to_string(r.index) +
             ".amp-fault-in). Clear it at the drive";
    case Fault::enable_lost:
      return "The pin motion.enable is false, so the machine is off. Make it true, then switch on "
             "again";
    case Fault::heartbeat_lost:
      return "Task has not answered for " + number(r.value) + " s (limit " + number(r.limit) +
             " s), so the machine stopped and is off. Check the load of the computer";
    case Fault::not_homed:
      return "Not all joints are homed, which this mode needs. Home the machine, or set "
             "[TRAJ]NO_FORCE_HOMING = 1";
    case Fault::home_failed:
      return "Homing of " + joint_of(r.index) + " failed: " + home_failure_text(r.value);
    case Fault::home_no_switch:
      return joint_of(r.index) + " moved " + v(r.value) +
             " without finding its home switch. Check the switch, HOME_SEARCH_VEL's sign and "
             "HOME_SEARCH_DIST";
    case Fault::home_busy:
      return "Homing request for " + joint_of(r.index) +
             " refused: the machine moves or is being homed. Wait, then ask again";
    case Fault::jog_while_not_ready:
      return "Cannot jog " + jogged_of(r.index) +
             ": machine off, wrong mode, homing, or the pin motion.jog-inhibit is true";
    case Fault::jog_beyond_limit:
      return "Cannot jog " + jogged_of(r.index) + " further: it is at " +
             jog_value(r, r.value, config) + ", the limit is " + jog_value(r, r.limit, config) +
             ". Jog the other way";
    case Fault::no_inverse:
      return "Move" + line_of(r.tag) +
             " leads where the kinematics have no joint positions. Change the program";
    case Fault::bad_item:
      return "Move or command" + line_of(r.tag) + " cannot be carried out (value " +
             number(r.value) +
             "): a number that is none, an arc without radius, no feed, or an output or spindle "
             "that does not exist";
    case Fault::kinematics_refused:
      if (r.limit == 3)
        return "The kinematics have no position for where the joints stand, so the machine stays "
               "in "
               "joint mode. Jog the joints into the working space";
      return "Kinematics not switched to kind " + std::to_string(static_cast<int>(r.value)) +
             (r.limit == 1 ? ": there is no such kind. Set motion.switchkins-type to one that is"
                           : ": it has no position for where the joints stand. Move into its "
                             "working space, then set motion.switchkins-type again");
    case Fault::indexer_refused: return indexer_text(r);
    case Fault::indexer_locked:
      return "Indexer joint " + std::to_string(r.index) + " turned" + line_of(r.tag) +
             " and joint." + std::to_string(r.index) +
             ".is-unlocked went false, so the path was stopped. Check the lock and its sensor";
    case Fault::stale_feedback:
      if (r.limit < 0)
        return "Probe contact" + line_of(r.tag) + " in a cycle without feedback of " +
               joint_of(r.index) +
               ", so nobody knows where it was; the path was stopped. Probe again";
      return joint_of(r.index) + " had no feedback in " +
             std::to_string(static_cast<int>(r.value)) + " cycles" + line_of(r.tag) + " (joint." +
             std::to_string(r.index) + ".fb-stale), allowed are " +
             std::to_string(static_cast<int>(r.limit)) + " of " +
             std::to_string(config.stale_window) +
             " ([KERF]STALE_FEEDBACK_CYCLES, STALE_FEEDBACK_WINDOW); the machine stopped and is "
             "off. Check the link to the drives, then switch on again";
    case Fault::limit_velocity: return oracle_text(r, config, "velocity");
    case Fault::limit_acceleration: return oracle_text(r, config, "acceleration");
    case Fault::limit_jerk: return oracle_text(r, config, "jerk");
    case Fault::limit_continuity: return oracle_text(r, config, "step (as velocity)");
    case Fault::limit_path: {
      const bool rotary = r.index >= 3;
      return "Internal fault: the path" + line_of(r.tag) + " was " +
             shown(r.value, rotary, config) + " from what is programmed, allowed are " +
             shown(r.limit, rotary, config) + ". Please report it with the program";
    }
    case Fault::probe_no_contact:
      return "Probe move" + line_of(r.tag) +
             " ended without contact. Check the probe and the start height";
    case Fault::probe_already_tripped:
      return std::string("Probe is already ") +
             (r.value != 0 ? "tripped when starting G38.2 or G38.3 move"
                           : "clear when starting G38.4 or G38.5 move") +
             line_of(r.tag) + ". It was not begun; " +
             (r.value != 0 ? "move the probe clear first" : "begin where the probe touches");
    case Fault::probe_unexpected:
      return "Probe tripped" + line_of(r.tag) +
             " during a move that does not probe; the path was stopped";
    case Fault::orient_fault:
      if (r.value == -1)
        return "Spindle " + std::to_string(r.index) +
               " timed out: it was not oriented within the " + number(r.limit) + " s of M19 Q" +
               line_of(r.tag) + ". Check the drive and spindle." + std::to_string(r.index) +
               ".is-oriented";
      if (r.value == 0)
        return "Spindle " + std::to_string(r.index) +
               " was stopped while it was being oriented, so the program cannot go on. Run it "
               "again";
      return "Spindle " + std::to_string(r.index) + " could not orient: spindle." +
             std::to_string(r.index) + ".orient-fault is " +
             std::to_string(static_cast<int>(r.value)) + ". See the drive's list of faults";
    case Fault::spindle_fault:
      return "Spindle " + std::to_string(r.index) + " drive fault (spindle." +
             std::to_string(r.index) + ".amp-fault-in). Clear it at the drive";
    case Fault::sync_too_fast:
      return "Thread or tap" + line_of(r.tag) + " not begun: at this speed of spindle " +
             std::to_string(r.index) + " its pitch needs " + shown(r.value, false, config) +
             " per second, the axes can do " + shown(r.limit, false, config) +
             ". Lower the spindle speed";
    case Fault::sync_too_short:
      return "Thread or tap" + line_of(r.tag) + " not begun: it is " +
             shown(r.limit, false, config) + " long, but coming into step with spindle " +
             std::to_string(r.index) + " and stopping need " + shown(r.value, false, config) +
             ". Lower the spindle speed or begin further away";
    case Fault::sync_no_index:
      return "Spindle " + std::to_string(r.index) + " turned " + number(r.value) +
             " revolutions without an index pulse, so the thread" + line_of(r.tag) +
             " was not begun. Connect spindle." + std::to_string(r.index) +
             ".index-enable to the encoder and check its index";
    case Fault::sync_behind:
      return "The axes fell " + shown(r.value, false, config) + " behind spindle " +
             std::to_string(r.index) + line_of(r.tag) + " (allowed are " +
             shown(r.limit, false, config) +
             "); the thread is not true there. Lower the spindle speed or let it change speed "
             "more slowly";
    case Fault::path_starved_internal:
      return "Internal fault: a move" + line_of(r.tag) +
             " does not begin where the machine stands; the path was dropped. Please report it";
    case Fault::overrun:
      return "A servo cycle came " + number(r.value) + " ms after the one before" + line_of(r.tag) +
             " (limit " + number(r.limit) +
             " ms, [KERF]OVERRUN). `halcmd timing` shows what was late; see docs/timing.md";
  }
  return "unknown fault";
}

}  // namespace kerf::motion
