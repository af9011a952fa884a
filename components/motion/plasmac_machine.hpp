// What plasmac hears, and how it moves: sensors, voltage, feed, offsets. The states are in plasmac.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "hal/operator_line.hpp"
#include "plasma_arc.hpp"
#include "plasmac_pins.hpp"
#include "plasmac_states.hpp"

namespace kerf::components {

class PlasmacMachine : public PlasmacPins {
 public:
  explicit PlasmacMachine(hal::Builder& b) noexcept
      : PlasmacPins(b),
        line_(static_cast<const hal::OperatorLine*>(b.find_service(hal::kOperatorLine))) {}

 protected:
  using S = PlasmaState;
  enum class Stop : std::uint8_t { none, abort, end, pause };
  static constexpr double kAtSpeed = 0.999, kArrived = 0.01;
  /// A rate that comes to whole counts is taken as below them: no faster than asked. Cut recovery takes half of one, and as the
  /// whole counts that it is.
  static constexpr double kALittleLess = 1.0 - 1e-12, kALittleMore = 1.0 + 1e-12;

  void read_sensors() noexcept {
    const bool relay = ohmic_sense_in_;
    if (relay == sense_) {
      sense_cycles_ = 0;
    } else if (++sense_cycles_ >= (relay ? ohmic_sense_on_delay_ : ohmic_sense_off_delay_)) {
      sense_ = relay;
      sense_cycles_ = 0;
    }
    if (!ohmic_on_) sense_ = false;
    ohmic_sense_out_ = sense_;
    sensor_active_ = float_switch_ || breakaway_ || ohmic_contact_;
    ohmic_contact_ = ohmic_on_ && ohmic_probe_;
  }
  void read_voltage() noexcept {
    const double in = (arc_voltage_in_ - arc_voltage_offset_) * arc_voltage_scale_;
    volts_ = voltage_.follow(std::isfinite(in) ? in : 0.0, lowpass_frequency_, dt_);
    if (std::fabs(volts_) < zero_window_) volts_ = 0.0;
    arc_voltage_out_ = volts_;
  }
  void measure_feed() noexcept {
    feed_now_ = current_velocity_ * 60.0;
    current_feed_rate_ = feed_now_;
    // A job begins in the cycle in which the program runs, and lasts through its pauses.
    const bool goes_on = job_ && !program_is_idle_;
    const bool runs = goes_on || (program_is_paused_ && !program_is_idle_);
    if (!goes_on) job_ = program_is_running_ && !program_is_idle_;
    if (job_ && !goes_on) clear_times();
    if (runs) run_time_ = run_time_.last() + dt_;
    if (program_is_paused_ && !program_is_idle_) paused_time_ = paused_time_.last() + dt_;
    if (runs && motion_type_ == 1) rapid_time_ = rapid_time_.last() + dt_;
  }
  void clear_times() noexcept {
    run_time_ = 0.0;
    paused_time_ = 0.0;
    rapid_time_ = 0.0;
    torch_time_ = 0.0;
    probe_time_ = 0.0;
    cut_time_ = 0.0;
    cut_length_ = 0.0;
    pierces_ = 0;
  }
  [[nodiscard]] bool ignores_arc() const noexcept { return ignore_arc_ok_0_ || ignore_arc_ok_1_; }
  [[nodiscard]] bool in_cycle() const noexcept {
    return state_ >= S::probe_height && state_ <= S::cut_mode_2;
  }
  [[nodiscard]] bool cuts() const noexcept {
    return state_ == S::cut_mode_01 || state_ == S::cut_mode_2;
  }
  void torch_off_now() noexcept {
    torch_ = false;
    arc_.off();
  }
  void say(std::string_view text) const noexcept {
    if (line_ != nullptr) line_->error(text);
  }

  void watch_arc() noexcept {
    bool ok = false;
    if (mode_ == 0) {
      if (torch_)
        ok = arc_.follow(volts_, arc_ok_low_, arc_ok_high_, ok_sample_threshold_, ok_sample_counts_,
                         thc_active_.last());
      else
        arc_.off();
    } else {
      ok = arc_ok_in_;
    }
    is_steady_ = torch_ && steady_.follow(volts_, thc_sample_threshold_, thc_sample_counts_);
    // A lost arc may come back.
    const bool was_missing = arc_missing_;
    arc_missing_ = torch_ && !ok && arc_lost_delay_ > 0.0 && (mode_ != 0 || arc_was_good_);
    if (arc_missing_ && !was_missing) lost_.set(arc_lost_delay_);
    arc_good_ = torch_ && (ok || (arc_missing_ && arc_was_good_ && !lost_.over(dt_)));
    arc_was_good_ = arc_good_;
    arc_ok_out_ = arc_good_;
  }

  [[nodiscard]] double cut_feed() const noexcept {
    return cut_feed_rate_ > 0.0 ? cut_feed_rate_.get()
                                : feed_upm_ / std::max(gcode_scale_.get(), 1e-9);
  }
  void count_cut() noexcept {
    cut_time_ = cut_time_.last() + dt_;
    cut_length_ = cut_length_.last() + current_velocity_ * dt_;
    requested_ = cut_feed();
    requested_feed_rate_ = requested_;
    adaptive_feed_ = feed_reduction_ > 0.0 ? std::clamp(feed_reduction_ * 0.01, 0.1, 1.0) : 1.0;
  }
  [[nodiscard]] bool at_speed() const noexcept { return feed_now_ > requested_ * kAtSpeed; }

  // Moves.

  [[nodiscard]] std::int32_t step_counts(double units_per_minute) const noexcept {
    if (scale_ <= 0.0) return 0;
    return static_cast<std::int32_t>(
        std::clamp(units_per_minute / 60.0 * dt_ / scale_ * kALittleLess, 0.0, 1e9));
  }
  [[nodiscard]] double step_of(double units_per_minute) const noexcept {
    return std::max(counts(units_per_minute / 60.0 * dt_) * kALittleLess, 0.0);
  }
  [[nodiscard]] double recovery_step() const noexcept {
    return std::trunc(std::max(counts(cut_feed() * 0.5 / 60.0 * dt_ * kALittleMore), 0.0));
  }
  [[nodiscard]] double counts(double units) const noexcept {
    return scale_ > 0.0 ? std::clamp(units / scale_, -2e9, 2e9) : 0.0;
  }
  void move_z(double change) noexcept {
    z_ = static_cast<std::int32_t>(std::clamp(z_ + change, -2e9, 2e9));
  }
  [[nodiscard]] bool probes_by_contact() const noexcept {
    return ohmic_probe_enable_ && ohmic_tries_ < std::max<std::int32_t>(ohmic_max_attempts_, 1);
  }
  [[nodiscard]] bool probes_beside() const noexcept {
    return probes_by_contact() && (offset_probe_x_ != 0.0 || offset_probe_y_ != 0.0);
  }
  /// True when z has been there since the last cycle.
  bool z_to(double target, double units_per_minute) noexcept {
    const std::int64_t goal = static_cast<std::int32_t>(std::clamp(target, -2e9, 2e9)), now = z_;
    if (now == goal) return true;
    const std::int64_t step = step_counts(units_per_minute);
    z_ = static_cast<std::int32_t>(std::clamp(goal, now - step, now + step));
    return false;
  }
  [[nodiscard]] bool z_follows(double within) const noexcept {
    return std::fabs(z_offset_current_ - z_ * scale_) < within;
  }
  bool z_settled(double target) noexcept {
    return z_to(target, setup_feed_rate_) && z_follows(kArrived * units_per_mm_);
  }
  [[nodiscard]] bool xy_follows() const noexcept {
    return std::fabs(x_offset_current_ - x_ * scale_) +
               std::fabs(y_offset_current_ - y_ * scale_) <=
           kArrived * units_per_mm_;
  }
  /// Straight to a place, with a new look at it each cycle.
  bool xy_to(double x, double y, double step) noexcept {
    const double dx = x - x_, dy = y - y_, way = std::hypot(dx, dy);
    if (way == 0.0) return true;
    if (way <= step) {
      x_ = x;
      y_ = y;
    } else {
      x_ += std::trunc(step * dx / way);
      y_ += std::trunc(step * dy / way);
    }
    return false;
  }
  /// The same in equal steps all the way, those of its start, to the whole counts of the place. Another place or rate has its own
  /// start; the way back is that of the way there.
  bool xy_straight_to(double x, double y, double step) noexcept {
    const double at_x = std::trunc(x), at_y = std::trunc(y);
    if (x_ == at_x && y_ == at_y) return true;
    const bool went = x_ == way_.at_x && y_ == way_.at_y;
    if (x != way_.x || y != way_.y || step != way_.step || !went) {
      const bool was_there = went && x_ == std::trunc(way_.x) && y_ == std::trunc(way_.y);
      const double dx = x - (was_there ? way_.x : x_), dy = y - (was_there ? way_.y : y_),
                   way = std::hypot(dx, dy);
      way_ = {x, y, step, x_, y_, std::trunc(step * dx / way), std::trunc(step * dy / way)};
    }
    const bool arrives = std::hypot(x - x_, y - y_) <= step;
    x_ = way_.at_x = arrives ? at_x : x_ + way_.step_x;
    y_ = way_.at_y = arrives ? at_y : y_ + way_.step_y;
    return false;
  }
  /// Each axis on its own.
  void xy_apart_to(double x, double y, double step) noexcept {
    x_ = std::clamp(x, x_ - step, x_ + step);
    y_ = std::clamp(y, y_ - step, y_ + step);
  }
  [[nodiscard]] double highest() const noexcept {
    return axis_z_max_limit_ - max_offset_ * units_per_mm_;
  }
  [[nodiscard]] double base_z() const noexcept { return axis_z_position_ - z_offset_current_; }

  /// Where xy_straight_to goes, in which steps, and where it left off.
  struct Way {
    double x, y, step, at_x, at_y, step_x, step_y;
  };

  const hal::OperatorLine* line_;
  ArcVoltage voltage_;
  ArcDetector arc_;
  SteadyVoltage steady_;
  VoidDetector void_;
  HeightPid pid_;
  PlasmaTimer timer_, deploy_, lost_;
  Way way_{};
  S state_{S::idle}, printed_{S::idle};
  Stop stop_{Stop::none};
  double dt_{0.001}, scale_{1e-5};
  double volts_{0.0}, feed_now_{0.0}, requested_{0.0};
  double zero_height_{0.0}, start_{0.0}, last_x_{0.0}, last_y_{0.0}, x_{0.0}, y_{0.0};
  double sum_volts_{0.0}, override_seen_{0.0}, found_zero_{0.0};
  std::int32_t z_{0}, zero_{0}, starts_{0}, pierces_{0}, samples_{0};
  std::int32_t sense_cycles_{0}, ohmic_tries_{0}, hold_step_{0}, laser_stage_{0};
  double laser_from_x_{0.0}, laser_from_y_{0.0};
  bool sense_{false}, ohmic_on_{false}, ohmic_contact_{false}, touched_by_contact_{false};
  bool torch_{false}, hold_{false}, arc_good_{false}, arc_was_good_{false}, arc_missing_{false};
  bool was_idle_{true}, is_steady_{false}, job_{false}, first_{false}, spotting_{false},
      testing_{false};
  bool thc_allowed_{false}, begun_{false}, corner_lock_{false}, void_lock_{false}, waits_{false};
  bool override_waits_{false}, skip_probe_{false}, probed_{false}, consumables_{false},
      recovering_{false};
  bool bottom_{false}, aborted_{false}, aborted_when_off_{false}, was_cutting_{false},
      found_{false}, sensor_told_{false}, arm_{false}, scribe_{false}, pulse_asked_{false};
};

}  // namespace kerf::components
