// Pins of plasmac.
#pragma once

#include <cstdint>

#include "hal/component.hpp"

namespace kerf::components {

class Plasmac;

/// What plasmac hears and says; the arithmetic is in plasmac.cpp and plasma_arc.hpp.
class PlasmacPins : public hal::Component<Plasmac> {
 public:
  using Component::Component;

 protected:
  hal::In<double> arc_fail_delay_{
      pin<hal::In<double>>("arc-fail-delay", "Time that the arc has to start in [s]")};
  hal::In<double> arc_lost_delay_{
      pin<hal::In<double>>("arc-lost-delay", "Time that a lost arc may stay away in a cut [s]")};
  hal::In<std::int32_t> arc_max_starts_{
      pin<hal::In<std::int32_t>>("arc-max-starts", "Starts of the arc that are tried")};
  hal::In<double> arc_ok_high_{
      pin<hal::In<double>>("arc-ok-high", "Mode 0: highest voltage of a good arc [V]")};
  hal::In<double> arc_ok_low_{
      pin<hal::In<double>>("arc-ok-low", "Mode 0: lowest voltage of a good arc [V]")};
  hal::In<bool> arc_ok_in_{
      pin<hal::In<bool>>("arc-ok-in", "Modes 1 and 2: the power source reports the arc")};
  hal::In<double> arc_voltage_in_{
      pin<hal::In<double>>("arc-voltage-in", "Modes 0 and 1: arc voltage before scale and offset")};
  hal::In<double> arc_voltage_offset_{
      pin<hal::In<double>>("arc-voltage-offset", "arc-voltage-in at zero volts")};
  hal::In<double> arc_voltage_scale_{
      pin<hal::In<double>>("arc-voltage-scale", "Volts for one unit of arc-voltage-in")};
  hal::In<bool> thc_auto_{pin<hal::In<bool>>("thc-auto",
                                             "True, with use-auto-volts: height control begins "
                                             "when the voltage is steady, not after thc-delay")};
  hal::In<double> axis_x_max_limit_{
      pin<hal::In<double>>("axis-x-max-limit", "From ini.x.max_limit")};
  hal::In<double> axis_x_min_limit_{
      pin<hal::In<double>>("axis-x-min-limit", "From ini.x.min_limit")};
  hal::In<double> axis_x_position_{pin<hal::In<double>>("axis-x-position", "From axis.x.pos-cmd")};
  hal::In<double> axis_y_max_limit_{
      pin<hal::In<double>>("axis-y-max-limit", "From ini.y.max_limit")};
  hal::In<double> axis_y_min_limit_{
      pin<hal::In<double>>("axis-y-min-limit", "From ini.y.min_limit")};
  hal::In<double> axis_y_position_{pin<hal::In<double>>("axis-y-position", "From axis.y.pos-cmd")};
  hal::In<double> axis_z_max_limit_{
      pin<hal::In<double>>("axis-z-max-limit", "From ini.z.max_limit")};
  hal::In<double> axis_z_min_limit_{
      pin<hal::In<double>>("axis-z-min-limit", "From ini.z.min_limit")};
  hal::In<double> axis_z_position_{
      pin<hal::In<double>>("axis-z-position", "From joint.N.pos-fb of the joint that moves z")};
  hal::In<bool> breakaway_{
      pin<hal::In<bool>>("breakaway", "Switch of a torch that is broken away")};
  hal::In<bool> consumable_change_{pin<hal::In<bool>>(
      "consumable-change",
      "True: to the place where consumables are changed, while the program is paused")};
  hal::In<bool> cornerlock_enable_{pin<hal::In<bool>>(
      "cornerlock-enable", "True: no height control below cornerlock-threshold")};
  hal::In<double> cornerlock_threshold_{pin<hal::In<double>>(
      "cornerlock-threshold",
      "Speed below which the height is kept [percent of requested-feed-rate]")};
  hal::In<double> current_velocity_{
      pin<hal::In<double>>("current-velocity", "From motion.current-vel")};
  hal::In<double> cut_feed_rate_{pin<hal::In<double>>(
      "cut-feed-rate", "Feed rate of the material [units per minute]; 0: feed-upm")};
  hal::In<double> cut_height_{
      pin<hal::In<double>>("cut-height", "Height of the torch over the material in the cut")};
  hal::In<bool> cut_recovery_{pin<hal::In<bool>>(
      "cut-recovery", "True: to the place where a cut that went wrong begins again")};
  hal::In<double> cut_volts_{pin<hal::In<double>>("cut-volts", "Voltage of the material [V]")};
  hal::In<bool> cutting_start_{
      pin<hal::In<bool>>("cutting-start", "Starts a cut while true, from spindle.0.on")};
  hal::In<bool> debug_print_{
      pin<hal::In<bool>>("debug-print", "True: each change of state is printed")};
  hal::In<bool> external_estop_{
      pin<hal::In<bool>>("external-estop", "Accepted for the files that connect it")};
  hal::In<double> feed_override_{
      pin<hal::In<double>>("feed-override", "From halui.feed-override.value")};
  hal::In<double> feed_reduction_{pin<hal::In<double>>(
      "feed-reduction",
      "Feed rate in percent, 10 to 100; 0: all of it, from motion.analog-out-03")};
  hal::In<bool> float_switch_{
      pin<hal::In<bool>>("float-switch", "Switch that the floating torch closes at the material")};
  hal::In<double> float_switch_travel_{pin<hal::In<double>>(
      "float-switch-travel", "Way of the torch from the material to where the switch opens")};
  hal::In<double> gcode_scale_{pin<hal::In<double>>("gcode-scale", "Scale of the program", 1.0)};
  hal::In<double> height_override_{
      pin<hal::In<double>>("height-override", "Voltage added to the target [V]")};
  hal::In<double> height_per_volt_{
      pin<hal::In<double>>("height-per-volt", "Height for one volt of height-override")};
  hal::In<bool> homed_{pin<hal::In<bool>>("homed", "True when the machine is homed")};
  hal::In<bool> ignore_arc_ok_0_{
      pin<hal::In<bool>>("ignore-arc-ok-0", "True: no arc needed to start or to go on")};
  hal::In<bool> ignore_arc_ok_1_{
      pin<hal::In<bool>>("ignore-arc-ok-1", "True: no arc needed to start or to go on")};
  hal::In<double> kerf_width_{pin<hal::In<double>>(
      "kerf-width", "For programs that read it, G41.1 D#<_hal[plasmac.kerf-width]>")};
  hal::In<bool> override_jog_{pin<hal::In<bool>>("override-jog", "True: jogging is not inhibited")};
  hal::In<bool> offset_set_probe_{
      pin<hal::In<bool>>("offset-set-probe", "True: the probe comes out to measure its offset")};
  hal::In<bool> offset_set_scribe_{
      pin<hal::In<bool>>("offset-set-scribe", "True: the scribe comes out to measure its offset")};
  hal::In<std::int32_t> laser_recovery_start_{pin<hal::In<std::int32_t>>(
      "laser-recovery-start", "Not 0: puts the laser over the torch's place in cut recovery")};
  hal::In<std::int32_t> laser_x_offset_{
      pin<hal::In<std::int32_t>>("laser-x-offset", "Way from torch to laser in x [counts]")};
  hal::In<std::int32_t> laser_y_offset_{
      pin<hal::In<std::int32_t>>("laser-y-offset", "Way from torch to laser in y [counts]")};
  hal::In<double> lowpass_frequency_{pin<hal::In<double>>(
      "lowpass-frequency", "Corner of the filter of arc-voltage-out [Hz]; 0: none")};
  hal::In<bool> machine_is_on_{pin<hal::In<bool>>("machine-is-on", "From halui.machine.is-on")};
  hal::In<std::int32_t> max_offset_{pin<hal::In<std::int32_t>>(
      "max-offset", "Distance to the limit of z that offsets keep [mm]", 5)};
  hal::In<bool> mesh_arc_ok_{pin<hal::In<bool>>("mesh-arc-ok", "True: no arc needed in mesh mode")};
  hal::In<bool> mesh_enable_{pin<hal::In<bool>>(
      "mesh-enable", "True: cuts mesh: no height control, a lost arc does not stop")};
  hal::In<std::int32_t> mode_{pin<hal::In<std::int32_t>>(
      "mode",
      "0: arc from the voltage; 1: arc from arc-ok-in; 2: as 1, height by move-up and move-down")};
  hal::In<std::int32_t> motion_type_{
      pin<hal::In<std::int32_t>>("motion-type", "From motion.motion-type")};
  hal::In<bool> move_down_{pin<hal::In<bool>>("move-down", "Mode 2: the torch shall go down")};
  hal::In<bool> move_up_{pin<hal::In<bool>>("move-up", "Mode 2: the torch shall go up")};
  hal::In<bool> multi_tool_{
      pin<hal::In<bool>>("multi-tool", "Accepted for the files that set it", true)};
  hal::In<double> offset_probe_delay_{pin<hal::In<double>>(
      "offset-probe-delay", "Time that the offset probe takes to come out [s]")};
  hal::In<double> offset_probe_x_{
      pin<hal::In<double>>("offset-probe-x", "Way from torch to offset probe in x")};
  hal::In<double> offset_probe_y_{
      pin<hal::In<double>>("offset-probe-y", "Way from torch to offset probe in y")};
  hal::In<bool> offsets_active_{pin<hal::In<bool>>("offsets-active", "From motion.eoffset-active")};
  hal::In<std::int32_t> ohmic_sense_on_delay_{
      pin<hal::In<std::int32_t>>("ohmic-sense-on-delay", "Cycles until ohmic-sense-in counts", 3)};
  hal::In<std::int32_t> ohmic_sense_off_delay_{pin<hal::In<std::int32_t>>(
      "ohmic-sense-off-delay", "Cycles until the end of ohmic-sense-in counts", 3)};
  hal::In<bool> ohmic_sense_in_{pin<hal::In<bool>>("ohmic-sense-in", "Relay of the ohmic sensor")};
  hal::In<std::int32_t> ohmic_max_attempts_{pin<hal::In<std::int32_t>>(
      "ohmic-max-attempts", "Ohmic probes that are tried before the float switch is used")};
  hal::In<bool> ohmic_probe_{
      pin<hal::In<bool>>("ohmic-probe", "Ohmic contact, from ohmic-sense-out or a pin")};
  hal::In<bool> ohmic_probe_enable_{
      pin<hal::In<bool>>("ohmic-probe-enable", "True: probes by ohmic contact")};
  hal::In<double> ohmic_probe_offset_{pin<hal::In<double>>(
      "ohmic-probe-offset", "Height over the point of ohmic contact that is the material")};
  hal::In<bool> ohmic_test_{
      pin<hal::In<bool>>("ohmic-test", "True: the ohmic sensor is on, to find a shorted torch")};
  hal::In<std::int32_t> ok_sample_counts_{pin<hal::In<std::int32_t>>(
      "ok-sample-counts", "Mode 0: readings in a row for a good arc", 10)};
  hal::In<double> ok_sample_threshold_{pin<hal::In<double>>(
      "ok-sample-threshold", "Mode 0: greatest change between them [V]", 10.0)};
  hal::In<double> pause_at_end_{pin<hal::In<double>>(
      "pause-at-end", "Time that motion stands with the arc on at the end of a cut [s]")};
  hal::In<double> paused_motion_speed_{
      pin<hal::In<double>>("paused-motion-speed", "Speed along the path while paused, -1 to 1")};
  hal::In<double> pid_d_gain_{pin<hal::In<double>>("pid-d-gain", "Derivative gain of the height")};
  hal::In<double> pid_i_gain_{pin<hal::In<double>>("pid-i-gain", "Integral gain of the height")};
  hal::In<double> pid_p_gain_{pin<hal::In<double>>(
      "pid-p-gain",
      "Proportional gain of the height; in mode 2 the speed, in percent of thc-feed-rate")};
  hal::In<double> pierce_delay_{pin<hal::In<double>>("pierce-delay", "Time to pierce [s]")};
  hal::In<double> probe_feed_rate_{
      pin<hal::In<double>>("probe-feed-rate", "Speed of probing down [units per minute]")};
  hal::In<std::int32_t> probe_final_speed_{pin<hal::In<std::int32_t>>(
      "probe-final-speed", "Steps of a cycle while probing up, of 0.001 mm", 1)};
  hal::In<double> pierce_height_{
      pin<hal::In<double>>("pierce-height", "Height over the material to pierce")};
  hal::In<double> probe_start_height_{pin<hal::In<double>>(
      "probe-start-height", "Height over the lower limit of z from which on is probed")};
  hal::In<bool> probe_test_{
      pin<hal::In<bool>>("probe-test", "True: probes and stays at pierce-height")};
  hal::In<bool> program_is_idle_{
      pin<hal::In<bool>>("program-is-idle", "From halui.program.is-idle")};
  hal::In<bool> program_is_paused_{
      pin<hal::In<bool>>("program-is-paused", "From halui.program.is-paused")};
  hal::In<bool> program_is_running_{
      pin<hal::In<bool>>("program-is-running", "From halui.program.is-running")};
  hal::In<double> puddle_jump_delay_{
      pin<hal::In<double>>("puddle-jump-delay", "Time at puddle-jump-height [s]; 0: none")};
  hal::In<double> puddle_jump_height_{pin<hal::In<double>>(
      "puddle-jump-height", "Height behind the pierce [percent of pierce-height]; 0: none")};
  hal::In<double> requested_velocity_{
      pin<hal::In<double>>("requested-velocity", "Accepted for the files that connect it")};
  hal::In<double> feed_upm_{
      pin<hal::In<double>>("feed-upm", "Feed rate of the program, from motion.feed-upm")};
  hal::In<std::int32_t> resolution_{pin<hal::In<std::int32_t>>(
      "resolution", "Counts of an offset of 0.001 mm, with a period of 1 ms", 100)};
  hal::In<double> restart_delay_{
      pin<hal::In<double>>("restart-delay", "Time between starts of the arc [s]")};
  hal::In<double> safe_height_{pin<hal::In<double>>(
      "safe-height", "Height over the material between cuts; 0: as high as z may go")};
  hal::In<double> scribe_arm_delay_{
      pin<hal::In<double>>("scribe-arm-delay", "Time the scribe takes to come down [s]")};
  hal::In<double> scribe_on_delay_{
      pin<hal::In<double>>("scribe-on-delay", "Time from scribe-on to motion [s]")};
  hal::In<bool> scribe_start_{
      pin<hal::In<bool>>("scribe-start", "Starts the scribe while true, from spindle.1.on")};
  hal::In<double> setup_feed_rate_{pin<hal::In<double>>(
      "setup-feed-rate", "Speed of z to start, pierce, cut and safe height [units per minute]")};
  hal::In<double> skip_ihs_distance_{
      pin<hal::In<double>>("skip-ihs-distance", "No probing this near to the last one; 0: always")};
  hal::In<bool> spotting_start_{
      pin<hal::In<bool>>("spotting-start", "Starts a spot while true, from spindle.2.on")};
  hal::In<double> spotting_threshold_{
      pin<hal::In<double>>("spotting-threshold", "Voltage from which on spotting-time counts [V]")};
  hal::In<double> spotting_time_{
      pin<hal::In<double>>("spotting-time", "Time that the torch burns to make a spot [ms]")};
  hal::In<double> thc_delay_{
      pin<hal::In<double>>("thc-delay", "Time at cut feed rate before height control begins [s]")};
  hal::In<bool> thc_disable_{
      pin<hal::In<bool>>("thc-disable", "True: no height control, from motion.digital-out-02")};
  hal::In<bool> thc_enable_{pin<hal::In<bool>>("thc-enable", "True: height control is wanted")};
  hal::In<double> thc_feed_rate_{
      pin<hal::In<double>>("thc-feed-rate", "Highest speed of height control [units per minute]")};
  hal::In<std::int32_t> thc_sample_counts_{pin<hal::In<std::int32_t>>(
      "thc-sample-counts", "thc-auto: readings in a row for a steady voltage", 50)};
  hal::In<double> thc_sample_threshold_{pin<hal::In<double>>(
      "thc-sample-threshold", "thc-auto: greatest change between them [V]", 1.0)};
  hal::In<double> thc_threshold_{
      pin<hal::In<double>>("thc-threshold", "Difference of the voltage that is left alone [V]")};
  hal::In<bool> torch_enable_{pin<hal::In<bool>>("torch-enable", "True: the torch may burn")};
  hal::In<bool> torch_off_{pin<hal::In<bool>>("torch-off", "True: the torch goes off")};
  hal::In<bool> torch_pulse_start_{pin<hal::In<bool>>(
      "torch-pulse-start", "A rising edge lets the torch burn for torch-pulse-time")};
  hal::In<double> torch_pulse_time_{
      pin<hal::In<double>>("torch-pulse-time", "Time of a pulse [s]")};
  hal::In<double> units_per_mm_{
      pin<hal::In<double>>("units-per-mm", "From halui.machine.units-per-mm")};
  hal::In<bool> use_auto_volts_{pin<hal::In<bool>>(
      "use-auto-volts", "True: the voltage at cut height is the target, not cut-volts")};
  hal::In<bool> voidlock_enable_{
      pin<hal::In<bool>>("voidlock-enable", "True: no height control over a void")};
  hal::In<std::int32_t> voidlock_on_cycles_{pin<hal::In<std::int32_t>>(
      "voidlock-on-cycles", "Steep readings in a row that tell of a void", 2)};
  hal::In<std::int32_t> voidlock_off_cycles_{
      pin<hal::In<std::int32_t>>("voidlock-off-cycles", "Readings without that end it", 10)};
  hal::In<std::int32_t> voidlock_slope_{pin<hal::In<std::int32_t>>(
      "voidlock-slope", "Change of the voltage that is steep [V/s]", 500)};
  hal::In<std::int32_t> x_offset_{
      pin<hal::In<std::int32_t>>("x-offset", "Offset of x for consumables and recovery [counts]")};
  hal::In<double> x_offset_current_{
      pin<hal::In<double>>("x-offset-current", "From axis.x.eoffset")};
  hal::In<double> xy_feed_rate_{pin<hal::In<double>>(
      "xy-feed-rate", "Speed to the place where consumables are changed [units per minute]")};
  hal::In<std::int32_t> y_offset_{
      pin<hal::In<std::int32_t>>("y-offset", "Offset of y for consumables and recovery [counts]")};
  hal::In<double> y_offset_current_{
      pin<hal::In<double>>("y-offset-current", "From axis.y.eoffset")};
  hal::In<double> z_offset_current_{
      pin<hal::In<double>>("z-offset-current", "From axis.z.eoffset")};
  hal::In<double> zero_window_{
      pin<hal::In<double>>("zero-window", "Voltage that shows as zero [V]", 0.1)};
  hal::In<std::int32_t> low_cut_volts_{pin<hal::In<std::int32_t>>(
      "low-cut-volts", "Voltage that is too low for height control [V]; 0: none")};
  hal::In<std::int32_t> target_samples_{
      pin<hal::In<std::int32_t>>("target-samples", "Readings that use-auto-volts averages", 6)};
  hal::Out<double> adaptive_feed_{
      pin<hal::Out<double>>("adaptive-feed", "To motion.adaptive-feed")};
  hal::Out<bool> arc_ok_out_{pin<hal::Out<bool>>("arc-ok-out", "True while there is a good arc")};
  hal::Out<double> arc_voltage_out_{pin<hal::Out<double>>("arc-voltage-out", "Arc voltage [V]")};
  hal::Out<bool> consumable_changing_{
      pin<hal::Out<bool>>("consumable-changing", "True while consumables are changed")};
  hal::Out<bool> cornerlock_is_locked_{pin<hal::Out<bool>>(
      "cornerlock-is-locked", "True while the height is kept because of the speed")};
  hal::Out<double> cut_length_{
      pin<hal::Out<double>>("cut-length", "Length of the cuts of the job")};
  hal::Out<bool> cut_recovering_{pin<hal::Out<bool>>("cut-recovering", "True in cut recovery")};
  hal::Out<double> cut_time_{pin<hal::Out<double>>("cut-time", "Time of the cuts of the job [s]")};
  hal::Out<bool> cutting_stop_{pin<hal::Out<bool>>(
      "cutting-stop", "Ends a cut that was started by hand, to halui.spindle.0.stop")};
  hal::Out<bool> feed_hold_{pin<hal::Out<bool>>("feed-hold", "To motion.feed-hold")};
  hal::Out<bool> jog_inhibit_{pin<hal::Out<bool>>("jog-inhibit", "To motion.jog-inhibit")};
  hal::Out<std::int32_t> laser_recovery_state_{pin<hal::Out<std::int32_t>>(
      "laser-recovery-state",
      "Laser in cut recovery: 0 not used or out of reach, 1 begins, 2 moves, 3 is over the place")};
  hal::Out<bool> led_down_{pin<hal::Out<bool>>("led-down", "Height control moves down")};
  hal::Out<bool> led_up_{pin<hal::Out<bool>>("led-up", "Height control moves up")};
  hal::Out<double> offset_scale_{
      pin<hal::Out<double>>("offset-scale", "To axis.x.eoffset-scale, axis.y and axis.z")};
  hal::Out<bool> ohmic_enable_{
      pin<hal::Out<bool>>("ohmic-enable", "True while the ohmic sensor is in use")};
  hal::Out<bool> ohmic_sense_out_{
      pin<hal::Out<bool>>("ohmic-sense-out", "ohmic-sense-in without bounces")};
  hal::Out<bool> paused_motion_{
      pin<hal::Out<bool>>("paused-motion", "True while the torch moves along the path in a pause")};
  hal::Out<double> paused_time_{
      pin<hal::Out<double>>("paused-time", "Time that the job was paused [s]")};
  hal::Out<std::int32_t> pierce_count_{
      pin<hal::Out<std::int32_t>>("pierce-count", "Starts of the arc")};
  hal::Out<bool> probe_test_error_{
      pin<hal::Out<bool>>("probe-test-error", "A probe test came to the lower limit of z")};
  hal::Out<double> probe_time_{
      pin<hal::Out<double>>("probe-time", "Time of probing in the job [s]")};
  hal::Out<bool> program_pause_{pin<hal::Out<bool>>("program-pause", "To halui.program.pause")};
  hal::Out<bool> program_resume_{pin<hal::Out<bool>>("program-resume", "To halui.program.resume")};
  hal::Out<bool> program_run_{pin<hal::Out<bool>>("program-run", "To halui.program.run")};
  hal::Out<bool> program_stop_{pin<hal::Out<bool>>("program-stop", "To halui.program.stop")};
  hal::Out<double> rapid_time_{
      pin<hal::Out<double>>("rapid-time", "Time of rapid motion in the job [s]")};
  hal::Out<double> run_time_{pin<hal::Out<double>>("run-time", "Time of the job [s]")};
  hal::Out<bool> safe_height_is_limited_{pin<hal::Out<bool>>(
      "safe-height-is-limited", "True when z cannot go as high as safe-height")};
  hal::Out<bool> sensor_active_{
      pin<hal::Out<bool>>("sensor-active", "float switch, ohmic contact or breakaway")};
  hal::Out<bool> scribe_arm_{pin<hal::Out<bool>>("scribe-arm", "Lowers the scribe")};
  hal::Out<bool> scribe_on_{pin<hal::Out<bool>>("scribe-on", "Starts the scribe")};
  hal::Out<std::int32_t> state_out_{
      pin<hal::Out<std::int32_t>>("state-out", "State, see the notes")};
  hal::Out<std::int32_t> stop_type_out_{pin<hal::Out<std::int32_t>>(
      "stop-type-out", "Why a cut ended: 0 none, 1 abort, 2 its end, 3 pause")};
  hal::Out<bool> thc_active_{
      pin<hal::Out<bool>>("thc-active", "True while the voltage moves the torch")};
  hal::Out<bool> thc_enabled_{
      pin<hal::Out<bool>>("thc-enabled", "True while height control is allowed")};
  hal::Out<bool> torch_on_{pin<hal::Out<bool>>("torch-on", "Switches the torch")};
  hal::Out<double> torch_time_{
      pin<hal::Out<double>>("torch-time", "Time that the torch burnt in the job [s]")};
  hal::Out<bool> voidlock_is_locked_{
      pin<hal::Out<bool>>("voidlock-is-locked", "True while the height is kept because of a void")};
  hal::Out<std::int32_t> x_offset_counts_{
      pin<hal::Out<std::int32_t>>("x-offset-counts", "To axis.x.eoffset-counts")};
  hal::Out<bool> xy_offset_enable_{
      pin<hal::Out<bool>>("xy-offset-enable", "To axis.x.eoffset-enable and axis.y")};
  hal::Out<std::int32_t> y_offset_counts_{
      pin<hal::Out<std::int32_t>>("y-offset-counts", "To axis.y.eoffset-counts")};
  hal::Out<double> z_height_{pin<hal::Out<double>>("z-height", "Height over the material")};
  hal::Out<std::int32_t> z_offset_counts_{
      pin<hal::Out<std::int32_t>>("z-offset-counts", "To axis.z.eoffset-counts")};
  hal::Out<bool> z_offset_enable_{
      pin<hal::Out<bool>>("z-offset-enable", "To axis.z.eoffset-enable")};
  hal::Out<double> z_relative_{
      pin<hal::Out<double>>("z-relative", "Height over the point of the last probe")};
  hal::Out<double> current_feed_rate_{
      pin<hal::Out<double>>("current-feed-rate", "Speed along the path [units per minute]")};
  hal::Out<double> requested_feed_rate_{
      pin<hal::Out<double>>("requested-feed-rate", "Feed rate of the cut [units per minute]")};
  hal::Out<double> target_volts_{
      pin<hal::Out<double>>("target-volts", "Voltage that height control keeps [V]")};
};

}  // namespace kerf::components
