// The states of plasmac, and its timer.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace kerf::components {

/// Numbers of state-out.
enum class PlasmaState : std::uint8_t {
  idle,
  probe_height,
  probe_down,
  probe_up,
  zero_height,
  pierce_height,
  torch_on,
  arc_ok,
  pierce_delay,
  puddle_jump,
  cut_height,
  cut_mode_01,
  cut_mode_2,
  pause_at_end,
  safe_height,
  max_height,
  end_cut,
  end_job,
  torch_pulse,
  paused_motion,
  ohmic_test,
  probe_test,
  scribing,
  consumable_change_on,
  consumable_change_off,
  cut_recovery_on,
  cut_recovery_off,
};
inline constexpr std::array<std::string_view, 27> kPlasmaStates{
    "plasmac: IDLE",
    "plasmac: PROBE_HEIGHT",
    "plasmac: PROBE_DOWN",
    "plasmac: PROBE_UP",
    "plasmac: ZERO_HEIGHT",
    "plasmac: PIERCE_HEIGHT",
    "plasmac: TORCH_ON",
    "plasmac: ARC_OK",
    "plasmac: PIERCE_DELAY",
    "plasmac: PUDDLE_JUMP",
    "plasmac: CUT_HEIGHT",
    "plasmac: CUT_MODE_01",
    "plasmac: CUT_MODE_2",
    "plasmac: PAUSE_AT_END",
    "plasmac: SAFE_HEIGHT",
    "plasmac: MAX_HEIGHT",
    "plasmac: END_CUT",
    "plasmac: END_JOB",
    "plasmac: TORCHPULSE",
    "plasmac: PAUSED_MOTION",
    "plasmac: OHMIC_TEST",
    "plasmac: PROBE_TEST",
    "plasmac: SCRIBING",
    "plasmac: CONSUMABLE_CHANGE_ON",
    "plasmac: CONSUMABLE_CHANGE_OFF",
    "plasmac: CUT_RECOVERY_ON",
    "plasmac: CUT_RECOVERY_OFF",
};

/// So many seconds, in cycles; in single precision, which decides about the last cycle. @rt.
class PlasmaTimer {
 public:
  void set(double seconds) noexcept { left_s_ = static_cast<float>(seconds); }
  /// One cycle goes by. True when the time is over.
  bool over(double dt) noexcept {
    if (left_s_ <= 0.0F) return true;
    count(dt);
    return false;
  }
  /// The same where the cycle that ends the time counts.
  bool ends(double dt) noexcept {
    count(dt);
    return left_s_ <= 0.0F;
  }

 private:
  void count(double dt) noexcept {
    left_s_ = static_cast<float>(static_cast<double>(left_s_) - dt);
  }

  float left_s_{0.0F};
};

}  // namespace kerf::components
