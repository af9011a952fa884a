// The pins of motmod by their documented names (manual: motion(9)). Groups of them are made once for each joint, axis,
// spindle and input or output.
#pragma once

#include <string_view>

#include "hal/component.hpp"
#include "rtapi/base/pose.hpp"

namespace kerf::motion {

using Bit = bool;
template <class T>
using In = hal::In<T>;
template <class T>
using Out = hal::Out<T>;

namespace detail {
/// "joint.3." + "pos-cmd"
inline hal::Name pin_name(std::string_view group, std::size_t index,
                          std::string_view suffix) noexcept {
  hal::Name name = hal::numbered(group, index);
  name.append(suffix);
  return name;
}
inline hal::Name axis_pin_name(std::size_t index, std::string_view suffix) noexcept {
  hal::Name name("axis.");
  const char letter = static_cast<char>(rtapi::kAxisLetters[index] + ('a' - 'A'));
  name.append(std::string_view(&letter, 1));
  name.append(".");
  name.append(suffix);
  return name;
}
}  // namespace detail

struct JointPins {
  JointPins(hal::Builder& builder, std::size_t index) noexcept : b(builder), n(index) {}
  template <class P>
  P pin(std::string_view suffix, std::string_view doc, typename P::Item initial = {}) noexcept {
    return hal::make_pin<P>(b, detail::pin_name("joint.#.", n, suffix), doc, initial);
  }
  hal::Builder& b;
  std::size_t n;

  In<Bit> amp_fault_in{pin<In<Bit>>("amp-fault-in", "The joint's amplifier reports a fault")};
  In<Bit> home_sw_in{pin<In<Bit>>("home-sw-in", "Home switch is closed")};
  In<Bit> neg_lim_sw_in{pin<In<Bit>>("neg-lim-sw-in", "Negative limit switch is tripped")};
  In<Bit> pos_lim_sw_in{pin<In<Bit>>("pos-lim-sw-in", "Positive limit switch is tripped")};
  In<double> motor_pos_fb{pin<In<double>>("motor-pos-fb", "Actual motor position [machine units]")};
  In<Bit> fb_stale{
      pin<In<Bit>>("fb-stale", "The driver could not read motor-pos-fb in this cycle")};
  Out<Bit> fb_extrapolated{pin<Out<Bit>>(
      "fb-extrapolated", "pos-fb is where the joint should be by now; it was not read")};
  Out<std::uint32_t> fb_lost{
      pin<Out<std::uint32_t>>("fb-lost", "Cycles in which fb-stale was true")};
  In<Bit> jog_enable{pin<In<Bit>>("jog-enable", "Wheel jogging enabled")};
  In<Bit> jog_vel_mode{pin<In<Bit>>("jog-vel-mode", "Wheel jogging stops with the wheel")};
  In<std::int32_t> jog_counts{pin<In<std::int32_t>>("jog-counts", "Counts of the jog wheel")};
  In<double> jog_scale{pin<In<double>>("jog-scale", "Distance a count of the jog wheel")};
  In<double> jog_accel_fraction{pin<In<double>>(
      "jog-accel-fraction", "Share of the acceleration limit for wheel jogging", 1.0)};
  hal::Io<Bit> index_enable{
      pin<hal::Io<Bit>>("index-enable", "Encoder's index handshake for homing")};
  Out<Bit> active{pin<Out<Bit>>("active", "The joint is in use")};
  Out<Bit> amp_enable_out{pin<Out<Bit>>("amp-enable-out", "Enables the joint's amplifier")};
  Out<Bit> error{pin<Out<Bit>>("error", "The joint stopped the machine")};
  Out<Bit> f_errored{pin<Out<Bit>>("f-errored", "Following error beyond its limit")};
  Out<Bit> faulted{pin<Out<Bit>>("faulted", "Amplifier fault seen")};
  Out<Bit> free_tp_enable{
      pin<Out<Bit>>("free-tp-enable", "The joint moves by itself (jog, homing)")};
  Out<Bit> homed{pin<Out<Bit>>("homed", "The joint is homed")};
  Out<Bit> homing{pin<Out<Bit>>("homing", "The joint is being homed")};
  Out<Bit> in_position{pin<Out<Bit>>("in-position", "The joint stands")};
  Out<Bit> kb_jog_active{pin<Out<Bit>>("kb-jog-active", "The joint is being jogged")};
  Out<Bit> wheel_jog_active{
      pin<Out<Bit>>("wheel-jog-active", "The joint is being jogged by wheel")};
  Out<Bit> neg_hard_limit{pin<Out<Bit>>("neg-hard-limit", "On the negative limit switch")};
  Out<Bit> pos_hard_limit{pin<Out<Bit>>("pos-hard-limit", "On the positive limit switch")};
  Out<std::int32_t> home_state{pin<Out<std::int32_t>>("home-state", "Step of homing, 0: none")};
  Out<double> acc_cmd{pin<Out<double>>("acc-cmd", "Commanded acceleration")};
  Out<double> jerk_cmd{pin<Out<double>>("jerk-cmd", "Commanded jerk")};
  Out<double> vel_cmd{pin<Out<double>>("vel-cmd", "Commanded velocity")};
  Out<double> pos_cmd{pin<Out<double>>("pos-cmd", "Commanded joint position")};
  Out<double> pos_fb{pin<Out<double>>("pos-fb", "Actual joint position")};
  Out<double> coarse_pos_cmd{pin<Out<double>>(
      "coarse-pos-cmd", "Commanded position before interpolation; here the same as pos-cmd")};
  Out<double> backlash_corr{pin<Out<double>>("backlash-corr", "Backlash compensation wanted")};
  Out<double> backlash_filt{pin<Out<double>>("backlash-filt", "Backlash compensation in force")};
  Out<double> backlash_vel{pin<Out<double>>("backlash-vel", "Speed of the compensation")};
  Out<double> f_error{pin<Out<double>>("f-error", "Following error")};
  Out<double> f_error_lim{pin<Out<double>>("f-error-lim", "Its present limit")};
  Out<double> free_pos_cmd{pin<Out<double>>("free-pos-cmd", "Target of a jog or homing move")};
  Out<double> free_vel_lim{pin<Out<double>>("free-vel-lim", "Its speed limit")};
  Out<double> motor_offset{
      pin<Out<double>>("motor-offset", "Motor position at joint position 0, set by homing")};
  Out<double> motor_pos_cmd{pin<Out<double>>("motor-pos-cmd", "Commanded motor position")};
};

struct AxisPins {
  AxisPins(hal::Builder& builder, std::size_t index) noexcept : b(builder), n(index) {}
  template <class P>
  P pin(std::string_view suffix, std::string_view doc, typename P::Item initial = {}) noexcept {
    return hal::make_pin<P>(b, detail::axis_pin_name(n, suffix), doc, initial);
  }
  hal::Builder& b;
  std::size_t n;

  In<Bit> eoffset_clear{pin<In<Bit>>("eoffset-clear", "Clears the external offset")};
  In<Bit> eoffset_enable{pin<In<Bit>>("eoffset-enable", "External offset enabled")};
  In<std::int32_t> eoffset_counts{
      pin<In<std::int32_t>>("eoffset-counts", "Counts of the external offset")};
  In<double> eoffset_scale{
      pin<In<double>>("eoffset-scale", "Distance a count of the external offset")};
  In<Bit> jog_enable{pin<In<Bit>>("jog-enable", "Wheel jogging enabled")};
  In<Bit> jog_vel_mode{pin<In<Bit>>("jog-vel-mode", "Wheel jogging stops with the wheel")};
  In<std::int32_t> jog_counts{pin<In<std::int32_t>>("jog-counts", "Counts of the jog wheel")};
  In<double> jog_scale{pin<In<double>>("jog-scale", "Distance a count of the jog wheel")};
  In<double> jog_accel_fraction{pin<In<double>>(
      "jog-accel-fraction", "Share of the acceleration limit for wheel jogging", 1.0)};
  Out<Bit> kb_jog_active{pin<Out<Bit>>("kb-jog-active", "The axis is being jogged")};
  Out<Bit> wheel_jog_active{pin<Out<Bit>>("wheel-jog-active", "The axis is being jogged by wheel")};
  Out<Bit> teleop_tp_enable{pin<Out<Bit>>("teleop-tp-enable", "The axis moves by itself")};
  Out<double> eoffset{pin<Out<double>>("eoffset", "External offset in force")};
  Out<double> eoffset_request{pin<Out<double>>("eoffset-request", "External offset wanted")};
  Out<double> pos_cmd{pin<Out<double>>("pos-cmd", "Commanded axis position")};
  Out<double> teleop_pos_cmd{pin<Out<double>>("teleop-pos-cmd", "Target of a jog")};
  Out<double> teleop_vel_cmd{pin<Out<double>>("teleop-vel-cmd", "Speed of a jog")};
  Out<double> teleop_vel_lim{pin<Out<double>>("teleop-vel-lim", "Speed limit of a jog")};
};

struct SpindlePins {
  SpindlePins(hal::Builder& builder, std::size_t index) noexcept : b(builder), n(index) {}
  template <class P>
  P pin(std::string_view suffix, std::string_view doc, typename P::Item initial = {}) noexcept {
    return hal::make_pin<P>(b, detail::pin_name("spindle.#.", n, suffix), doc, initial);
  }
  hal::Builder& b;
  std::size_t n;

  In<Bit> amp_fault_in{pin<In<Bit>>("amp-fault-in", "The spindle's drive reports a fault")};
  In<Bit> at_speed{pin<In<Bit>>("at-speed", "Feed moves after a spindle change wait for it", true)};
  In<Bit> inhibit{pin<In<Bit>>("inhibit", "Holds the speed at 0")};
  In<Bit> is_oriented{pin<In<Bit>>("is-oriented", "Orientation is done")};
  In<std::int32_t> orient_fault{pin<In<std::int32_t>>("orient-fault", "Not 0: orientation failed")};
  In<double> revs{pin<In<double>>("revs", "Revolutions, from the encoder")};
  In<double> speed_in{pin<In<double>>("speed-in", "Actual speed [rev/s]")};
  hal::Io<Bit> index_enable{pin<hal::Io<Bit>>("index-enable", "Encoder's index handshake")};
  Out<Bit> on{pin<Out<Bit>>("on", "The spindle shall turn")};
  Out<Bit> forward{pin<Out<Bit>>("forward", "Clockwise")};
  Out<Bit> reverse{pin<Out<Bit>>("reverse", "Counterclockwise")};
  Out<Bit> brake{pin<Out<Bit>>("brake", "Brake on")};
  Out<Bit> orient{pin<Out<Bit>>("orient", "Begin to orient (M19)")};
  Out<Bit> locked{pin<Out<Bit>>("locked", "Orientation complete")};
  Out<double> orient_angle{pin<Out<double>>("orient-angle", "Angle to orient to [deg]")};
  Out<std::int32_t> orient_mode{pin<Out<std::int32_t>>("orient-mode", "P word of M19")};
  Out<double> speed_out{pin<Out<double>>("speed-out", "Wanted speed, signed [rpm]")};
  Out<double> speed_out_abs{pin<Out<double>>("speed-out-abs", "Wanted speed [rpm]")};
  Out<double> speed_out_rps{pin<Out<double>>("speed-out-rps", "Wanted speed, signed [rev/s]")};
  Out<double> speed_out_rps_abs{pin<Out<double>>("speed-out-rps-abs", "Wanted speed [rev/s]")};
  Out<double> speed_cmd_rps{pin<Out<double>>(
      "speed-cmd-rps", "Programmed speed, signed, before override and limits [rev/s]")};
};

/// Pins that stand once, and the parameters that exist for tools that look for them.
struct MotionPins {
  explicit MotionPins(hal::Builder& builder) noexcept : b(builder) {}
  template <class P>
  P pin(std::string_view suffix, std::string_view doc, typename P::Item initial = {}) noexcept {
    hal::Name name("motion.");
    name.append(suffix);
    return hal::make_pin<P>(b, name, doc, initial);
  }
  hal::Builder& b;

  In<Bit> enable{pin<In<Bit>>("enable", "False: machine off at once", true)};
  In<Bit> feed_hold{pin<In<Bit>>("feed-hold", "Feed 0, where M53 P1 allows it")};
  In<Bit> feed_inhibit{pin<In<Bit>>("feed-inhibit", "The path stands")};
  In<Bit> homing_inhibit{pin<In<Bit>>("homing-inhibit", "No homing is begun")};
  In<Bit> jog_inhibit{pin<In<Bit>>("jog-inhibit", "No jog is begun")};
  In<Bit> jog_stop{pin<In<Bit>>("jog-stop", "Rising: jogs stop within their acceleration")};
  In<Bit> jog_stop_immediate{pin<In<Bit>>("jog-stop-immediate", "Rising: jogs stop dead")};
  In<Bit> probe_input{pin<In<Bit>>("probe-input", "Probe contact closed")};
  In<double> adaptive_feed{
      pin<In<double>>("adaptive-feed", "Factor on the feed, where M52 P1 allows it", 1.0)};
  Out<Bit> coord_error{
      pin<Out<Bit>>("coord-error", "A path was refused or broken off; until the next abort")};
  Out<Bit> coord_mode{pin<Out<Bit>>("coord-mode", "Coordinated mode")};
  Out<Bit> teleop_mode{pin<Out<Bit>>("teleop-mode", "Teleop mode")};
  Out<Bit> eoffset_active{pin<Out<Bit>>("eoffset-active", "External offsets are not 0")};
  Out<Bit> eoffset_limited{pin<Out<Bit>>("eoffset-limited", "External offsets met a soft limit")};
  Out<Bit> in_position{pin<Out<Bit>>("in-position", "The machine stands")};
  Out<Bit> is_all_homed{pin<Out<Bit>>("is-all-homed", "All joints are homed")};
  Out<Bit> jog_is_active{pin<Out<Bit>>("jog-is-active", "Something is being jogged")};
  Out<Bit> motion_enabled{pin<Out<Bit>>("motion-enabled", "Machine on")};
  Out<Bit> on_soft_limit{pin<Out<Bit>>("on-soft-limit", "A joint stands on a soft limit")};
  Out<Bit> tp_reverse{pin<Out<Bit>>("tp-reverse", "The path runs backwards")};
  Out<double> current_vel{
      pin<Out<double>>("current-vel", "Speed along the path [machine units/s]")};
  Out<Bit> sync_in_step{
      pin<Out<Bit>>("sync-in-step", "G33, G33.1, G76: the path is where the spindle wants it")};
  Out<double> sync_lag{
      pin<Out<double>>("sync-lag", "G33, G33.1, G76: the path behind its spindle [machine units]")};
  Out<double> sync_run_in{pin<Out<double>>(
      "sync-run-in", "What the last of them needed to come into step [machine units]")};
  Out<double> distance_to_go{
      pin<Out<double>>("distance-to-go", "Rest of the move [machine units]")};
  Out<double> requested_vel{
      pin<Out<double>>("requested-vel", "Programmed speed within limits [machine units/s]")};
  Out<double> feed_upm{pin<Out<double>>("feed-upm", "Feed in force [machine units/min]")};
  Out<double> feed_inches_per_minute{pin<Out<double>>("feed-inches-per-minute", "Feed in force")};
  Out<double> feed_inches_per_second{pin<Out<double>>("feed-inches-per-second", "Feed in force")};
  Out<double> feed_mm_per_minute{pin<Out<double>>("feed-mm-per-minute", "Feed in force")};
  Out<double> feed_mm_per_second{pin<Out<double>>("feed-mm-per-second", "Feed in force")};
  Out<Bit> interp_iscircle{pin<Out<Bit>>("interp.iscircle", "The move is an arc")};
  Out<double> interp_arc_center[3] = {
      pin<Out<double>>("interp.arc-center-x", "Centre of the arc [machine units]"),
      pin<Out<double>>("interp.arc-center-y", "Centre of the arc [machine units]"),
      pin<Out<double>>("interp.arc-center-z", "Centre of the arc [machine units]")};
  Out<double> interp_arc_radius{
      pin<Out<double>>("interp.arc-radius", "Radius of the arc [machine units]")};
  Out<double> interp_feedrate{
      pin<Out<double>>("interp.feedrate", "Programmed feed [machine units/min]")};
  Out<double> interp_heading{
      pin<Out<double>>("interp.heading", "Direction of the path in XY [deg]")};
  Out<double> interp_normal_heading{
      pin<Out<double>>("interp.normal-heading", "Direction across the path in XY [deg]")};
  Out<std::int32_t> interp_line_number{
      pin<Out<std::int32_t>>("interp.line-number", "Line of the move")};
  Out<std::int32_t> interp_motion_type{
      pin<Out<std::int32_t>>("interp.motion-type", "Kind of the move")};
  Out<std::int32_t> motion_type{pin<Out<std::int32_t>>(
      "motion-type",
      "0 none, 1 traverse, 2 feed, 3 arc, 4 tool change, 5 probing, 6 rotary unlock")};
  Out<std::int32_t> program_line{pin<Out<std::int32_t>>("program-line", "Line in execution")};
  Out<std::uint32_t> servo_last_period{
      pin<Out<std::uint32_t>>("servo.last-period", "Time between the last two cycles [ns]")};
  Out<double> tooloffset[rtapi::kAxes] = {tool('x'), tool('y'), tool('z'), tool('a'), tool('b'),
                                          tool('c'), tool('u'), tool('v'), tool('w')};
  void add_debug_params() noexcept;

 private:
  Out<double> tool(char letter) noexcept {
    hal::Name name("motion.tooloffset.");
    name.append(std::string_view(&letter, 1));
    return hal::make_pin<Out<double>>(b, name, "Tool offset in force [machine units]");
  }
};

}  // namespace kerf::motion
