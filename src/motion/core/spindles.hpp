// Spindles: M3 M4 M5 S M19 carried out, one state machine a spindle. Pure arithmetic, @rt.
#pragma once

#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/core/io.hpp"

namespace kerf::motion {

/// What the pins of a spindle show.
struct SpindleOutputs {
  double speed_rpm{0};    ///< signed, after override, limits and inhibit
  double command_rps{0};  ///< signed, as programmed
  double orient_angle_deg{0};
  std::int32_t orient_mode{0};
  std::int8_t index_order{0};  ///< in this cycle: 1 makes spindle.N.index-enable true, -1 false
  bool on{false}, forward{false}, reverse{false}, brake{true}, orient{false}, locked{false};
};

class Spindles {
 public:
  void configure(const MachineConfig& config, std::int32_t count) noexcept;
  void apply(const SpindleChange& change) noexcept;
  void stop(std::int32_t n) noexcept;
  void stop_all() noexcept;
  /// At the last speed, in this direction (-1, 1); not while it is being oriented.
  void restart(std::int32_t n, std::int32_t direction) noexcept;
  /// Engaging stops the spindle; released, the brake stays off until the next order.
  void brake(std::int32_t n, bool engage) noexcept;
  /// Ends orientations in progress; a spindle that turns goes on.
  void abort_orient() noexcept;
  /// One cycle. `x_mm`: machine X without tool offset, for constant surface speed. `overrides`: one factor a spindle, already 1 where disabled.
  void step(const SpindleInputs* in, const double* overrides, double x_mm,
            FaultList& faults) noexcept;

  /// The other direction, at `factor` times the programmed speed, until the next order. Nothing happens to one that does not turn.
  void reverse(std::int32_t n, double factor) noexcept;
  /// -1, 0, 1
  [[nodiscard]] std::int32_t direction(std::int32_t n) const noexcept { return at(n).direction; }
  [[nodiscard]] std::int32_t count() const noexcept { return count_; }
  /// Asks the encoder to start from zero at its index. From the next cycle on index-enable is true until it has passed.
  void arm_index(std::int32_t n) noexcept { out_[n].index_order = 1; }
  void disarm_index(std::int32_t n) noexcept { out_[n].index_order = -1; }
  /// Before each cycle.
  void begin_cycle() noexcept {
    for (SpindleOutputs& out : out_) out.index_order = 0;
  }

  /// A traverse has ended: spindles at constant surface speed turn at another speed now, so the next feed move waits.
  void wait_after_traverse() noexcept;
  /// The spindle whose at-speed pin a feed move must wait for, or -1.
  [[nodiscard]] std::int32_t not_at_speed() const noexcept;
  /// The spindle that is being oriented, or -1.
  [[nodiscard]] std::int32_t orienting() const noexcept;
  /// The last orientation came to its end.
  [[nodiscard]] bool oriented(std::int32_t n) const noexcept {
    return at(n).orient_state == kOrientDone;
  }
  /// True once after an orientation failed.
  [[nodiscard]] bool orient_failed(std::int32_t n) const noexcept {
    return at(n).orient_state == kOrientFault;
  }
  [[nodiscard]] const SpindleOutputs& outputs(std::size_t n) const noexcept { return out_[n]; }
  void fill(std::size_t n, const SpindleInputs& in, SpindleStatus& status) const noexcept;

 private:
  static constexpr std::int32_t kOrientNone = 0, kOrientRunning = 1, kOrientDone = 2,
                                kOrientFault = 3;
  /// Cycles after a change before at-speed is believed: the drive has to see the new speed first.
  static constexpr std::int32_t kSettleCycles = 3;

  struct State {
    double speed_rpm{0}, css_factor{0}, css_max_rpm{0}, css_center_x_mm{0};
    double factor{1};  ///< on the way back of a tap
    std::int32_t direction{0}, orient_state{kOrientNone}, orient_fault{0}, age{0};
    bool ack_low{false};   ///< is-oriented was false since the orientation began
    bool wait{false};      ///< the next feed move waits for at-speed
    bool released{false};  ///< the brake, by the operator
  };
  [[nodiscard]] const State& at(std::int32_t n) const noexcept { return state_[n]; }
  [[nodiscard]] double limited(std::size_t n, double rpm) const noexcept;

  State state_[kMaxSpindles];
  SpindleOutputs out_[kMaxSpindles];
  SpindleConfig config_[kMaxSpindles];
  std::int32_t count_{1};
};

}  // namespace kerf::motion
