// plasmac: the cycle of a plasma torch: find the material, pierce, cut at height, get away; and what can go wrong.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "plasmac_height.hpp"

namespace kerf::components {

class Plasmac final : public PlasmacHeight {
 public:
  static constexpr hal::Info kInfo{
      .name = "plasmac",
      .summary = "The cycle of a plasma torch with height control by the arc voltage",
      .notes =
          "For the configurations of QtPlasmaC. A cut (M3 $0) probes for the material, pierces, "
          "cuts while the arc voltage keeps the height, and goes to safe height; a spot (M3 $2) "
          "burns for spotting-time; M3 $1 is a scribe. Z is moved by its external offset. "
          "state-out: 0 idle, 1 to probe height, 2 probe down, 3 probe up, 4 to the zero height, "
          "5 to pierce height, 6 torch on, 7 waits for the arc, 8 pierce delay, 9 puddle jump, 10 "
          "to cut height, 11 cuts in mode 0 or 1, 12 cuts in mode 2, 13 pause at the end, 14 to "
          "safe height, 15 to maximum height, 16 end of the cut, 17 end of the job, 18 torch "
          "pulse, 19 paused motion, 20 ohmic test, 21 probe test, 22 scribe, 23 and 24 to the "
          "consumable change and back, 25 and 26 cut recovery on and off. The voltage of the "
          "height counts once current-velocity is at 99.9 percent of the feed rate and thc-delay "
          "is over. An error pauses the program and says why; software does not replace switches "
          "that cut the power.",
      .singleton = true};

  using PlasmacHeight::PlasmacHeight;

 private:
  void update(const hal::Period& period) noexcept {
    dt_ = period.seconds();
    scale_ = units_per_mm_ * dt_ / std::max<std::int32_t>(resolution_, 1);
    offset_scale_ = scale_;
    read_sensors();
    read_voltage();
    z_height_ = axis_z_position_ - zero_height_;
    measure_feed();
    allow_height_control();
    if (!cuts() && state_ != S::paused_motion) adaptive_feed_ = 1.0;
    watch_program();
    if (!machine_is_on_ && program_is_idle_) torch_off_now();
    if (torch_) torch_time_ = torch_time_.last() + dt_;
    watch_arc();
    if (machine_is_on_)
      step();
    else
      switch_off();
    if (torch_off_ || !machine_is_on_) torch_off_now();
    jog_inhibit_ = (state_ == S::idle || state_ == S::ohmic_test) && program_is_idle_ &&
                   sensor_active_.last() && !override_jog_;
    feed_hold_ = hold_;
    torch_on_ = torch_;
    ohmic_enable_ = ohmic_on_;
    scribe_arm_ = arm_;
    scribe_on_ = scribe_;
    z_offset_counts_ = z_;
    x_offset_counts_ = static_cast<std::int32_t>(x_);
    y_offset_counts_ = static_cast<std::int32_t>(y_);
    state_out_ = static_cast<std::int32_t>(state_);
    stop_type_out_ = static_cast<std::int32_t>(stop_);
    pierce_count_ = pierces_;
    was_idle_ = program_is_idle_;
    was_cutting_ = cutting_start_;
    if (debug_print_ && state_ != printed_) say(kPlasmaStates[static_cast<std::size_t>(state_)]);
    printed_ = state_;
  }

  // What ends a cut from outside.

  void leave_for_the_top(Stop why) noexcept {
    torch_off_now();
    go_to_the_top(why);
  }
  void go_to_the_top(Stop why) noexcept {
    stop_ = why;
    hold_ = true;
    skip_probe_ = false;
    corner_lock_ = void_lock_ = false;
    cornerlock_is_locked_ = false;
    voidlock_is_locked_ = false;
    state_ = S::max_height;
  }
  /// Pauses the program, or ends a cut made by hand, and says why.
  void fail(std::string_view why) noexcept {
    say(why);
    leave_for_the_top(Stop::pause);
    ask_pause();
  }
  void ask_pause() noexcept {
    if (program_is_idle_)
      cutting_stop_ = true;
    else if (!program_is_paused_)
      program_pause_ = true;
  }
  void watch_program() noexcept {
    if (program_is_paused_ && state_ != S::paused_motion) program_pause_ = false;
    if (!cutting_start_) cutting_stop_ = false;
    if (torch_off_) torch_off_now();
    const bool wanted = spotting_ ? spotting_start_ : cutting_start_;
    const bool testing = testing_ || state_ == S::torch_pulse;
    if (!program_is_idle_) aborted_when_off_ = false;
    if (!machine_is_on_) {
      // What was aborted with the machine off ends the first cycle of a cut by hand.
      if (program_is_idle_ && !was_idle_) aborted_when_off_ = true;
    } else if (state_ == S::safe_height && program_is_idle_ && was_cutting_ && !cutting_start_) {
      leave_for_the_top(Stop::abort);
    } else if (program_is_idle_ && !was_idle_) {
      if (!in_cycle() && state_ != S::pause_at_end && state_ != S::safe_height) {
        abort_idle();
      } else {
        // With a pause at the end the arc is read once more; the way up takes the torch off in this very cycle.
        if (pause_at_end_ <= 0.0) torch_off_now();
        go_to_the_top(Stop::abort);
      }
    } else if (in_cycle() && aborted_) {
      begin_abort();
    } else if (in_cycle() && !testing) {
      if (program_is_paused_ && !recovering_) {
        leave_for_the_top(Stop::pause);
      } else if (!wanted) {
        if (program_is_idle_) {
          leave_for_the_top(Stop::abort);
        } else {
          stop_ = Stop::end;
          state_ = S::pause_at_end;
          timer_.set(pause_at_end_);
          if (pause_at_end_ <= 0.0) torch_off_now();
        }
      } else if (state_ >= S::pierce_height && sensor_active_.last()) {
        fail(breakaway_      ? "breakaway switch activated, program is paused"
             : float_switch_ ? "float switch activated, program is paused"
                             : "ohmic probe activated, program is paused");
      } else if (state_ >= S::pierce_delay && torch_enable_ && !torch_off_ && !arc_good_ &&
                 !ignores_arc() && !mesh_enable_ && !recovering_) {
        fail("valid arc lost, program is paused");
      } else if (thc_active_.last() && mode_ != 2 && low_cut_volts_ > 0 &&
                 volts_ < low_cut_volts_) {
        fail("arc voltage below low-cut-volts, program is paused");
      }
    }
  }
  void switch_off() noexcept {
    torch_ = arm_ = scribe_ = testing_ = recovering_ = ohmic_on_ = false;
    consumables_ = aborted_ = false;
    consumable_changing_ = false;
    cut_recovering_ = false;
    laser_stage_ = 0;
    laser_recovery_state_ = 0;
    paused_motion_ = false;
    program_resume_ = false;
    stop_ = Stop::none;
    z_ = 0;
    x_ = y_ = 0.0;
    state_ = S::idle;
  }
  /// The program ended while nothing was cut: what is left of the offsets goes.
  void abort_idle() noexcept {
    if (state_ == S::paused_motion) end_paused_motion();
    if (state_ == S::consumable_change_on) {
      stop_ = Stop::abort;
      state_ = S::consumable_change_off;
    } else if (state_ == S::cut_recovery_on || state_ == S::cut_recovery_off) {
      // The way back comes first.
      aborted_ = true;
      state_ = S::cut_recovery_off;
    } else if (state_ == S::idle || state_ == S::paused_motion) {
      aborted_ = true;
      state_ = S::idle;
    } else if (state_ == S::max_height && pause_at_end_ > 0.0) {
      begin_abort();
    } else if (state_ == S::max_height || state_ == S::end_cut) {
      stop_ = Stop::abort;
    }
    program_pause_ = false;
    program_resume_ = false;
  }
  // The states.

  void step() noexcept {
    switch (state_) {
      case S::idle: return idle();
      case S::probe_height: return probe_height();
      case S::probe_down: return probe_down();
      case S::probe_up: return probe_up();
      case S::zero_height:
        if (z_to(zero_, setup_feed_rate_) && z_follows(1.5 * scale_)) {
          deploy_.set(x_ != 0.0 || y_ != 0.0 ? offset_probe_delay_ : 0.0);
          state_ = S::pierce_height;
        }
        return;
      case S::pierce_height: return pierce_height();
      case S::torch_on: return torch_start();
      case S::arc_ok: return wait_for_arc();
      case S::pierce_delay: return pierce();
      case S::puddle_jump:
        hold_ = false;
        if ((puddle_jump_height_ <= 0.0 ||
             z_to(zero_ + counts(pierce_height_ * puddle_jump_height_ * 0.01), setup_feed_rate_)) &&
            timer_.over(dt_))
          state_ = S::cut_height;
        return;
      case S::cut_height: return cut_height();
      case S::cut_mode_01: return cut(cut_01());
      case S::cut_mode_2: return cut(cut_2());
      case S::pause_at_end:
        hold_ = true;
        if (!timer_.ends(dt_)) return;
        if (stop_ == Stop::abort)
          state_ = S::max_height;
        else
          end_of_cut();
        return;
      case S::safe_height:
        cornerlock_is_locked_ = corner_lock_ = false;
        if (z_settled(safe_target())) {
          hold_ = false;
          state_ = S::end_cut;
        }
        return;
      case S::max_height:
        torch_off_now();
        hold_ = true;
        if (z_settled(0.0))
          state_ =
              consumable_change_ && stop_ == Stop::pause ? S::consumable_change_on : S::end_cut;
        return;
      case S::end_cut: return end_cut();
      case S::end_job:
        if (!z_settled(0.0)) return;
        probed_ = false;
        stop_ = Stop::none;
        state_ = S::idle;
        return;
      case S::torch_pulse: return torch_pulse();
      case S::paused_motion: return paused_motion();
      case S::ohmic_test:
        if (!ohmic_test_) {
          ohmic_on_ = false;
          state_ = S::idle;
        }
        return;
      case S::probe_test:
        z_offset_enable_ = true;
        if (!probe_test_) end_probe_test();
        return;
      case S::scribing: return scribing();
      case S::consumable_change_on: return consumables_on();
      case S::consumable_change_off: return consumables_off();
      case S::cut_recovery_on: return recovery_on();
      case S::cut_recovery_off: return recovery_off();
    }
  }

  /// Of a program that ended while no torch burned.
  void begin_abort() noexcept {
    torch_off_now();
    aborted_ = false;
    hold_ = true;
    stop_ = Stop::abort;
    timer_.set(pause_at_end_);
    state_ = pause_at_end_ > 0.0 ? S::pause_at_end : S::max_height;
  }

  void idle() noexcept {
    if (aborted_) {
      begin_abort();
      if (state_ == S::pause_at_end || z_ == 0) step();
      return;
    }
    const bool was_asked = pulse_asked_;
    pulse_asked_ = torch_pulse_start_;
    ohmic_on_ = offset_set_probe_;
    arm_ = offset_set_scribe_;
    if (!program_is_idle_ && !was_idle_ && sensor_active_.last()) {
      if (stop_ == Stop::none) {
        say(breakaway_      ? "breakaway switch detected before probing, program is paused"
            : float_switch_ ? "float switch detected before probing, program is paused"
                            : "ohmic probe detected before probing, program is paused");
        ask_pause();
      }
      stop_ = Stop::pause;
      hold_ = true;
      z_offset_enable_ = true;
      state_ = S::end_cut;
      return;
    }
    if (program_is_paused_) return idle_paused();
    if (consumables_) {
      stop_ = Stop::none;
      state_ = S::consumable_change_off;
      return;
    }
    if (override_seen_ != 0.0) {
      override_seen_ = 0.0;
      return;
    }
    if (stop_ == Stop::pause) {
      stop_ = Stop::none;
      hold_ = cutting_start_ || spotting_start_;
      return;
    }
    if (program_pause_.last() || cutting_stop_.last()) return;
    if (!homed_) {
      hold_ = false;
      if (torch_pulse_start_ && !was_asked && program_is_idle_) begin_pulse();
      return;
    }
    if (cutting_start_ || spotting_start_) {
      spotting_ = !cutting_start_;
      begin_cut();
    } else if (scribe_start_) {
      hold_step_ = 0;
      state_ = S::scribing;
    } else if (program_is_idle_ && torch_pulse_start_ && !was_asked) {
      begin_pulse();
    } else if (program_is_idle_ && ohmic_test_ && ohmic_probe_enable_) {
      hold_ = true;
      ohmic_on_ = true;
      state_ = S::ohmic_test;
    } else if (program_is_idle_ && probe_test_) {
      begin_probe_test();
    } else {
      hold_ = false;
    }
  }
  void idle_paused() noexcept {
    if (stop_ != Stop::pause) return;
    if (consumable_change_ && !consumables_) {
      state_ = S::max_height;
    } else if (consumables_) {
      if (!consumable_change_) state_ = S::consumable_change_off;
    } else if (cut_recovery_) {
      state_ = S::cut_recovery_on;
    } else if (paused_motion_speed_ != 0.0) {
      hold_step_ = 0;
      state_ = S::paused_motion;
    }
  }
  void begin_pulse() noexcept {
    hold_ = true;
    hold_step_ = 0;
    state_ = S::torch_pulse;
  }
  void begin_cut() noexcept {
    stop_ = Stop::none;
    hold_ = true;
    starts_ = 0;
    arc_.reset();
    steady_.reset();
    arc_.off();
    ohmic_tries_ = 0;
    // Left over where the machine went off in a cut: not this cut's voltage.
    target_volts_ = 0.0;
    begun_ = corner_lock_ = void_lock_ = false;
    const double way = std::hypot(axis_x_position_ - last_x_, axis_y_position_ - last_y_);
    const bool near = skip_probe_ && skip_ihs_distance_ > 0.0 && way < skip_ihs_distance_;
    if (near && found_) zero_ = static_cast<std::int32_t>(std::clamp(found_zero_, -2e9, 2e9));
    found_ = false;
    first_ = true;
    if (near) {
      deploy_.set(0.0);
      state_ = S::pierce_height;
    } else if (const std::string_view no = beside_limits(); !no.empty()) {
      say(no);
      stop_ = Stop::pause;
      ask_pause();
    } else {
      state_ = S::probe_height;
    }
  }
  /// What says no to the probe's place beside the torch.
  [[nodiscard]] std::string_view beside_limits() const noexcept {
    if (!probes_beside()) return {};
    const double x = axis_x_position_ + offset_probe_x_, y = axis_y_position_ + offset_probe_y_;
    if (x <= axis_x_min_limit_) return "probe offset would violate axis X minimum limit";
    if (x >= axis_x_max_limit_) return "probe offset would violate axis X maximum limit";
    if (y <= axis_y_min_limit_) return "probe offset would violate axis Y minimum limit";
    if (y >= axis_y_max_limit_) return "probe offset would violate axis Y maximum limit";
    return {};
  }
  void begin_probe_test() noexcept {
    hold_ = true;
    testing_ = true;
    spotting_ = false;
    ohmic_tries_ = 0;
    const std::string_view no = sensor_active_.last()
                                    ? "a sensor is active before probing, probe test aborted"
                                    : beside_limits();
    if (no.empty()) {
      first_ = true;
      state_ = S::probe_height;
    } else {
      // Said once, and nothing moves when the reason goes while the test is still asked for.
      say(no);
      probe_test_error_ = true;
      state_ = S::probe_test;
    }
  }
  /// Back up, and back from beside the torch. The probe stays until then.
  void end_probe_test() noexcept {
    xy_straight_to(0.0, 0.0, step_counts(setup_feed_rate_));
    z_to(0.0, setup_feed_rate_);
    const bool is_back = z_ == 0 && x_ == 0.0 && y_ == 0.0;
    state_ = is_back ? S::end_cut : S::probe_test;
  }

  bool left_probe_test() noexcept {
    if (!testing_ || probe_test_) return false;
    state_ = S::probe_test;
    return true;
  }
  void probe_height() noexcept {
    if (aborted_when_off_) {
      aborted_when_off_ = false;
      stop_ = Stop::abort;
      state_ = z_ == 0 ? S::end_cut : S::max_height;
      return;
    }
    if (left_probe_test()) return;
    if (first_) {
      first_ = bottom_ = false;
      z_offset_enable_ = true;
      start_ =
          std::round(z_ - counts(axis_z_position_ - (axis_z_min_limit_ + probe_start_height_)));
      if (probes_by_contact()) {
        ohmic_on_ = true;
        if (ohmic_tries_ == 0) deploy_.set(probes_beside() ? offset_probe_delay_ : 0.0);
      }
      if (probes_beside()) xy_offset_enable_ = true;
    }
    probe_time_ = probe_time_.last() + dt_;
    bool there = z_to(start_, setup_feed_rate_);
    if (probes_beside()) {
      const double x = counts(offset_probe_x_), y = counts(offset_probe_y_);
      xy_straight_to(x, y, step_counts(setup_feed_rate_));
      there = there && x_ == std::trunc(x) && y_ == std::trunc(y);
      deploy_.over(dt_);
    }
    if (there) state_ = S::probe_down;
  }
  void probe_down() noexcept {
    if (left_probe_test() || (ohmic_on_ && !deploy_.over(dt_))) return;
    if (float_switch_ || breakaway_ || ohmic_contact_) {
      if (breakaway_ && !float_switch_)
        return fail("breakaway switch detected while probing, program is paused");
      if (!ohmic_contact_ && probes_by_contact()) {
        // The torch touched, and there was no contact: once more.
        ++ohmic_tries_;
        first_ = true;
        if (!probes_by_contact()) ohmic_on_ = false;
        state_ = S::probe_height;
        return;
      }
      touched_by_contact_ = ohmic_contact_;
      // Of a cut a millimetre stays free above.
      if (axis_z_position_ + pierce_height_ >
          (testing_ ? axis_z_max_limit_.get() : highest() - units_per_mm_))
        return too_high();
      state_ = S::probe_up;
    } else if (!bottom_ && axis_z_position_ - axis_z_min_limit_ <= 0.5 * units_per_mm_) {
      bottom_ = true;
    } else if (bottom_) {
      ohmic_on_ = false;
      if (testing_) {
        say("bottom limit reached while probe testing");
        probe_test_error_ = true;
        state_ = S::probe_test;
      } else {
        fail("bottom limit reached while probing down, program is paused");
      }
    } else {
      move_z(-step_counts(std::min(probe_feed_rate_.get(), setup_feed_rate_.get())));
    }
    probe_time_ = probe_time_.last() + dt_;
  }
  void too_high() noexcept {
    const std::string_view why = touched_by_contact_
                                     ? "pierce height would exceed Z axis maximum limit, found "
                                       "while ohmic probing"
                                     : "pierce height would exceed Z axis maximum limit, found "
                                       "while float switch probing";
    if (!testing_) return fail(why);
    say(why);
    state_ = S::probe_test;
  }
  void probe_up() noexcept {
    if (left_probe_test()) return;
    probe_time_ = probe_time_.last() + dt_;
    if (touched_by_contact_ ? ohmic_contact_ : float_switch_.get()) {
      if (axis_z_position_ >= highest()) return too_high();
      move_z(std::clamp<std::int32_t>(probe_final_speed_, 1, 10) *
             static_cast<double>(std::max<std::int32_t>(resolution_, 1)));
      return;
    }
    ohmic_on_ = false;
    zero_ = z_ + static_cast<std::int32_t>(
                     counts(touched_by_contact_ ? ohmic_probe_offset_ : float_switch_travel_));
    zero_height_ = base_z() + zero_ * scale_;
    last_x_ = axis_x_position_;
    last_y_ = axis_y_position_;
    skip_probe_ = probed_ = true;
    state_ = S::zero_height;
    // Above the pierce two millimetres stay free.
    if (!testing_ && zero_height_ + pierce_height_ + 2.0 * units_per_mm_ > highest())
      fail("material is too high for safe traverse, program is paused");
  }
  void pierce_height() noexcept {
    if (left_probe_test()) return;
    if (pierce_height_ <= 0.0 || cut_height_ <= 0.0 || (mode_ != 2 && cut_volts_ <= 0.0)) {
      if (!testing_) fail("invalid pierce height, cut height or cut volts, program is paused");
      return;
    }
    // The probe goes away first; the torch may go up while it still comes back over the place.
    const bool probe_is_in = deploy_.ends(dt_);
    if (!recovering_) xy_straight_to(0.0, 0.0, step_counts(setup_feed_rate_));
    const bool is_back = recovering_ || (x_ == 0.0 && y_ == 0.0);
    if (!probe_is_in || !z_settled(zero_ + counts(pierce_height_)) || !is_back) return;
    if (testing_) {
      state_ = S::probe_test;
    } else {
      timer_.set(0.0);
      state_ = torch_enable_ ? S::torch_on : S::pierce_delay;
      first_ = true;
    }
  }
  void torch_start() noexcept {
    if (starts_ >= arc_max_starts_) {
      if (!program_pause_.last() && !cutting_stop_.last()) {
        say(program_is_idle_ ? "no arc detected after all start attempts, manual cut is stopped"
                             : "no arc detected after all start attempts, program is paused");
        ask_pause();
      }
      return;
    }
    if (starts_ > 0 && !timer_.ends(dt_)) return;
    ++starts_;
    ++pierces_;
    torch_ = true;
    first_ = true;
    timer_.set(arc_fail_delay_);
    state_ = S::arc_ok;
  }
  void wait_for_arc() noexcept {
    if (spotting_) return spot();
    if (arc_good_ || ignores_arc() || (mesh_enable_ && mesh_arc_ok_)) {
      first_ = true;
      state_ = S::pierce_delay;
    } else if (timer_.ends(dt_)) {
      torch_off_now();
      timer_.set(restart_delay_);
      state_ = S::torch_on;
    }
  }
  void spot() noexcept {
    if (first_) {
      if (volts_ >= spotting_threshold_ || mode_ == 2) {
        first_ = false;
        timer_.set(spotting_time_ * 0.001);
      } else if (timer_.over(dt_)) {
        torch_off_now();
        timer_.set(restart_delay_);
        state_ = S::torch_on;
      }
    } else if (timer_.ends(dt_)) {
      stop_ = Stop::end;
      end_of_cut();
    }
  }
  void pierce() noexcept {
    if (first_) {
      first_ = false;
      timer_.set(pierce_delay_);
    }
    if (timer_.over(dt_)) {
      const bool jumps = (puddle_jump_delay_ > 0.0 || puddle_jump_height_ > 0.0) && !recovering_;
      timer_.set(jumps ? puddle_jump_delay_ : 0.0);
      state_ = jumps ? S::puddle_jump : S::cut_height;
    }
  }
  void cut_height() noexcept {
    if (!z_settled(zero_ + counts(cut_height_))) return;
    begun_ = corner_lock_ = void_lock_ = waits_ = false;
    void_.reset();
    samples_ = 0;
    sum_volts_ = 0.0;
    override_seen_ = 0.0;
    override_waits_ = false;
    if (recovering_) {
      state_ = S::cut_recovery_off;
    } else {
      hold_ = false;
      state_ = mode_ == 2 ? S::cut_mode_2 : S::cut_mode_01;
    }
  }

  /// After a cycle of a cut, with what height control says against going on.
  void cut(std::string_view trouble) noexcept {
    if (trouble.empty()) return;
    fail(trouble);
    // The pause comes first, the hold with the way up.
    hold_ = false;
  }
  void end_of_cut() noexcept {
    torch_off_now();
    // The next cut may begin from the height that the voltage found.
    found_ = begun_ && thc_allowed_ && stop_ == Stop::end;
    if (found_) {
      found_zero_ = z_ - counts(cut_height_);
      last_x_ = axis_x_position_;
      last_y_ = axis_y_position_;
    }
    state_ = S::safe_height;
  }
  double safe_target() noexcept {
    const double top = z_ + counts(highest() - axis_z_position_);
    // Where the material is was not found: back to where z came from.
    if (!probed_) return 0.0;
    double target = safe_height_ > 0.0 ? zero_ + counts(safe_height_) : top;
    const bool limited = target > top;
    if (limited && !safe_height_is_limited_.last()) say("safe traverse height has been reduced");
    safe_height_is_limited_ = limited && safe_height_ > 0.0;
    return std::min(target, std::max(top, static_cast<double>(z_)));
  }
  void end_cut() noexcept {
    torch_off_now();
    ohmic_on_ = false;
    led_up_ = false;
    led_down_ = false;
    target_volts_ = 0.0;
    begun_ = corner_lock_ = void_lock_ = false;
    cornerlock_is_locked_ = false;
    voidlock_is_locked_ = false;
    if (stop_ == Stop::abort || testing_ || (spotting_ && program_is_idle_)) {
      testing_ = false;
      probe_test_error_ = false;
      state_ = S::end_job;
    } else {
      state_ = S::idle;
    }
  }

  void torch_pulse() noexcept {
    if (hold_step_ == 0) {
      torch_ = torch_enable_;
      hold_step_ = 1;
    } else if (hold_step_ == 1 && torch_pulse_time_ > 0.0) {
      timer_.set(torch_pulse_time_);
      hold_step_ = 2;
    } else if (timer_.ends(dt_) || torch_off_) {
      torch_off_now();
      state_ = S::idle;
    }
  }
  void paused_motion() noexcept {
    const double speed = paused_motion_speed_;
    if (hold_step_ == 0) {
      if (speed != 0.0) {
        paused_motion_ = true;
        hold_ = false;
        program_resume_ = true;
        adaptive_feed_ = std::clamp(speed, -1.0, 1.0);
      } else if (!program_is_paused_) {
        adaptive_feed_ = 1.0;
        hold_ = true;
        program_resume_ = false;
        program_pause_ = true;
        hold_step_ = 1;
      }
    } else if (program_is_paused_) {
      end_paused_motion();
      state_ = S::cut_recovery_on;
    }
  }
  void end_paused_motion() noexcept {
    adaptive_feed_ = 1.0;
    paused_motion_ = false;
    program_pause_ = false;
    program_resume_ = false;
    hold_ = true;
  }
  void scribing() noexcept {
    if (!scribe_start_) {
      arm_ = scribe_ = false;
      state_ = S::idle;
    } else if (program_is_paused_) {
      arm_ = scribe_ = false;
      hold_step_ = 0;
    } else if (hold_step_ == 0) {
      hold_ = true;
      arm_ = true;
      timer_.set(scribe_arm_delay_);
      timer_.over(dt_);
      hold_step_ = 1;
    } else if (hold_step_ == 1) {
      if (timer_.over(dt_)) {
        scribe_ = true;
        timer_.set(scribe_on_delay_);
        hold_step_ = 2;
      }
    } else if (timer_.over(dt_)) {
      hold_ = false;
    }
  }
  void consumables_on() noexcept {
    if (!consumables_) {
      xy_offset_enable_ = true;
      consumables_ = true;
      consumable_changing_ = true;
      return;
    }
    if (!consumable_change_ || !program_is_paused_) {
      state_ = program_is_paused_ ? S::idle : S::consumable_change_off;
      return;
    }
    if (sensor_active_.last()) {
      if (!sensor_told_)
        say("a sensor was activated during the consumable change, motion is paused and goes on "
            "when it is gone");
      sensor_told_ = true;
      return;
    }
    sensor_told_ = false;
    if (xy_straight_to(x_offset_, y_offset_, step_of(xy_feed_rate_)) && xy_follows())
      state_ = S::idle;
  }
  void consumables_off() noexcept {
    if (!xy_straight_to(0.0, 0.0, step_of(xy_feed_rate_))) return;
    if (!xy_follows()) return;
    consumables_ = false;
    consumable_changing_ = false;
    hold_ = false;
    state_ = stop_ == Stop::abort ? S::end_cut : S::idle;
  }
  void recovery_on() noexcept {
    recovering_ = true;
    cut_recovering_ = true;
    xy_offset_enable_ = true;
    if (!cut_recovery_) {
      state_ = S::cut_recovery_off;
    } else if (!program_is_paused_) {
      state_ = S::idle;
    } else {
      place_recovery();
    }
  }
  /// The offset of the torch's new place, and of the laser over it.
  void place_recovery() noexcept {
    const double step = recovery_step();
    if (laser_stage_ == 0 && laser_recovery_start_ != 0) {
      const double at_x = axis_x_position_ + laser_x_offset_ * scale_,
                   at_y = axis_y_position_ + laser_y_offset_ * scale_;
      if (at_x >= axis_x_min_limit_ && at_x <= axis_x_max_limit_ && at_y >= axis_y_min_limit_ &&
          at_y <= axis_y_max_limit_)
        laser_stage_ = 1;
    } else if (laser_stage_ == 1) {
      laser_from_x_ = x_;
      laser_from_y_ = y_;
      laser_stage_ = 2;
    } else if (laser_stage_ == 2) {
      if (xy_straight_to(laser_from_x_ + laser_x_offset_, laser_from_y_ + laser_y_offset_,
                         step_of(cut_feed())))
        laser_stage_ = 3;
    } else if (laser_stage_ == 3) {
      xy_apart_to(x_offset_ + laser_x_offset_, y_offset_ + laser_y_offset_, step);
    } else {
      xy_apart_to(x_offset_, y_offset_, step);
    }
    laser_recovery_state_ = laser_stage_;
  }
  void recovery_off() noexcept {
    if (!xy_to(0.0, 0.0, torch_ ? step_counts(cut_feed()) : recovery_step())) return;
    if (!xy_follows()) return;
    recovering_ = false;
    cut_recovering_ = false;
    laser_stage_ = 0;
    laser_recovery_state_ = 0;
    if (cut_recovery_ && (torch_ || !program_is_paused_)) {
      hold_ = false;
      state_ = mode_ == 2 ? S::cut_mode_2 : S::cut_mode_01;
    } else {
      // Taken back while the torch was on its way: a new cut begins here, and no torch burns until it pierces.
      torch_off_now();
      state_ = stop_ == Stop::abort ? S::end_cut : S::idle;
    }
  }

  hal::Function update_{function<&Plasmac::update>("", "One cycle of the torch")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Plasmac)
