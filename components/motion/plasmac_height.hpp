// plasmac's height control: how far the torch moves up or down while it cuts. The states are in plasmac.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "plasmac_machine.hpp"

namespace kerf::components {

class PlasmacHeight : public PlasmacMachine {
 public:
  using PlasmacMachine::PlasmacMachine;

 protected:
  void allow_height_control() noexcept {
    thc_allowed_ = thc_enable_ && !thc_disable_ && !mesh_enable_ && !ignores_arc() && !arc_missing_;
    thc_enabled_ = thc_allowed_;
    thc_active_ =
        thc_allowed_ && ((state_ == S::cut_mode_01 && begun_ && !corner_lock_ && !void_lock_) ||
                         state_ == S::cut_mode_2);
  }

  /// One cycle of a cut in mode 0 or 1. What it returns ends the cut.
  [[nodiscard]] std::string_view cut_01() noexcept {
    count_cut();
    if (!torch_) return {};
    if (target_volts_.last() == 0.0) {
      if (mesh_enable_ || ignores_arc()) return {};
      corner_lock_ = true;
      cornerlock_is_locked_ = true;
      find_target();
      return {};
    }
    if (mesh_enable_ || ignores_arc() || follow_override()) return {};
    if (!thc_allowed_) {
      led_up_ = false;
      led_down_ = false;
      pid_.reset();
      return {};
    }
    if (!begun_) {
      begun_ = true;
      corner_lock_ = false;
    }
    if (cornerlock_enable_) {
      if (feed_now_ < requested_ * cornerlock_threshold_ * 0.01)
        corner_lock_ = true;
      else if (at_speed())
        corner_lock_ = false;
    } else {
      corner_lock_ = false;
    }
    cornerlock_is_locked_ = corner_lock_;
    void_lock_ =
        void_.follow(volts_, dt_, voidlock_slope_, voidlock_on_cycles_, voidlock_off_cycles_) &&
        voidlock_enable_;
    voidlock_is_locked_ = void_lock_;
    if (corner_lock_ || void_lock_) {
      led_up_ = false;
      led_down_ = false;
      pid_.reset();
      return {};
    }
    return move_by_voltage();
  }
  /// The same in mode 2, where the torch's own controller says up and down; pid-p-gain is the share of thc-feed-rate in percent.
  [[nodiscard]] std::string_view cut_2() noexcept {
    count_cut();
    if (!torch_) return {};
    cornerlock_is_locked_ = corner_lock_ =
        cornerlock_enable_ &&
        (corner_lock_ ? !at_speed() : feed_now_ < requested_ * cornerlock_threshold_ * 0.01);
    const bool up = move_up_ && thc_allowed_ && !corner_lock_,
               down = move_down_ && thc_allowed_ && !corner_lock_ && !up;
    led_up_ = up;
    led_down_ = down;
    if (!up && !down) return {};
    const double change =
        step_counts(thc_feed_rate_ * std::clamp(pid_p_gain_ * 0.01, 0.0, 1.0)) * (up ? 1.0 : -1.0);
    return move_within_limits(change, 0.5 * units_per_mm_);
  }

 private:
  /// The voltage to keep, once the torch is at speed and the arc steady.
  void find_target() noexcept {
    if (!waits_) {
      if (!at_speed()) return;
      waits_ = true;
      timer_.set(thc_delay_);
    }
    if (thc_auto_ && use_auto_volts_) {
      if (is_steady_) target_volts_ = volts_;
      return;
    }
    if (!timer_.over(dt_)) return;
    if (!use_auto_volts_) {
      target_volts_ = cut_volts_;
      return;
    }
    sum_volts_ += volts_;
    if (++samples_ >= std::max<std::int32_t>(target_samples_, 1))
      target_volts_ = sum_volts_ / samples_;
  }
  /// A new height-override moves the torch by height-per-volt: up at once, down no faster than setup-feed-rate. True in the cycles
  /// that it takes.
  bool follow_override() noexcept {
    if (!override_waits_) {
      if (height_override_ == override_seen_) return false;
      override_waits_ = true;
      override_next_ = height_override_;
      override_z_ = z_ + std::trunc(counts((override_next_ - override_seen_) * height_per_volt_));
      led_up_ = false;
      led_down_ = false;
      return true;
    }
    if (override_z_ > z_)
      move_z(override_z_ - z_);
    else
      z_to(override_z_, setup_feed_rate_);
    if (z_ == static_cast<std::int32_t>(std::clamp(override_z_, -2e9, 2e9))) {
      override_waits_ = false;
      override_seen_ = override_next_;
    }
    return true;
  }
  [[nodiscard]] std::string_view move_by_voltage() noexcept {
    double error = target_volts_.last() + override_seen_ - volts_;
    if (std::fabs(error) <= thc_threshold_) error = 0.0;
    const double most = step_counts(thc_feed_rate_);
    const double change = std::clamp(
        pid_.follow(error, pid_p_gain_, pid_i_gain_, pid_d_gain_, dt_) * resolution_ * 0.1, -most,
        most);
    if (change > 0.0) {
      led_up_ = true;
    } else if (change < 0.0) {
      led_down_ = true;
    } else {
      led_up_ = false;
      led_down_ = false;
    }
    return move_within_limits(change, 0.0);
  }
  /// Moves the torch, or says why it may not be moved. It stays as much below the top.
  [[nodiscard]] std::string_view move_within_limits(double change, double below_top) noexcept {
    const double z = axis_z_position_ + change * scale_;
    if (change < 0.0 && z < axis_z_min_limit_)
      return "bottom limit reached while THC moving down, program is paused";
    if (change > 0.0 && z > highest() - below_top)
      return "top limit reached while THC moving up, program is paused";
    move_z(change);
    return {};
  }

  double override_next_{0.0}, override_z_{0.0};
};

}  // namespace kerf::components
