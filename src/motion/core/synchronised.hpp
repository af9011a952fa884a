// Synchronised: what follows the turns of a spindle (G33, G76, G33.1, G95). Pure arithmetic, @rt.
//
// The place on the path is pitch times the spindle's angle since its index, at any speed: the thread is where it would be if the axis had
// started at full speed in the very moment of the index. The axis stands until the reference comes so near that it joins it just as it
// has speeded up (SyncTracker::speed): no catching up, and the run-in is v^2/2a. Angle and speed come from an observer, not from
// differences of counts. Reference and limits are separate: the tracker only wishes a speed, the executor keeps the limits.
// With jerk limits the tracker wishes a jerk: what a triple integrator needs to come to rest on its reference in the least time.
// Sources: fading-memory (g-h-k) filter: Morrison, Introduction to Sequential Smoothing and Prediction; switching curve of the double
// integrator and switching surface of the triple one, with a linear part at their end (Pao and Franklin, Proximate time-optimal control of
// third-order servomechanisms, 1993).
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>

#include "motion/core/io.hpp"
#include "motion/core/ramp.hpp"
#include "motion/core/span.hpp"
#include "motion/core/spindles.hpp"

namespace kerf::motion {

/// Angle, speed and acceleration of a spindle behind the counts of its encoder. Exact for constant acceleration.
class SpindleObserver {
 public:
  /// The counter shows `revs` now whatever it showed before (its zero has moved); the speed stays.
  void anchor(double revs) noexcept { angle_ = revs; }
  /// `revs`: the counter in this cycle, `dt` seconds after the last one.
  void step(double revs, double dt) noexcept;

  [[nodiscard]] double angle() const noexcept { return angle_; }  ///< revolutions
  [[nodiscard]] double rps() const noexcept { return rps_; }
  /// Mean distance of the counter from the angle: a quarter of a count where it counts.
  [[nodiscard]] double noise() const noexcept { return noise_; }
  [[nodiscard]] double rps_after(double t) const noexcept { return rps_ + acc_ * t; }
  /// In the last step the counter was not where a spindle can have brought it.
  [[nodiscard]] bool jumped() const noexcept { return jumped_; }
  [[nodiscard]] double acc() const noexcept { return acc_; }  ///< revolutions/s2

 private:
  double angle_{0}, rps_{0}, acc_{0}, noise_{0};
  double counted_{0}, since_change_s_{0}, since_jump_s_{0},
      between_s_{0};               ///< how seldom the counter changes
  double forgets_{0}, fading_{1};  ///< exp(-forgets_) of the last step, mostly that of this one
  bool known_{false}, jumped_{false};
};

/// The speed that brings a place onto its reference: `ahead` of it now, which moves on with `ref_speed`. On a switching curve for `acc`, so
/// that the two meet with equal speeds; near 0 in proportion.
[[nodiscard]] double following_speed(double ahead, double ref_speed, double acc,
                                     double dt) noexcept;
/// What stands joins a reference that moves with `ref_speed` when it is this far behind. `jerk` 0: not limited.
[[nodiscard]] double joining_distance(double ref_speed, double acc, double jerk,
                                      double dt) noexcept;

/// What of a jerk limit is used to come to `speed`: acceleration builds up over some cycles at least, and so does the speed.
[[nodiscard]] double joining_jerk(double jerk, double acc, double speed, double dt) noexcept;

/// A reference at this moment, as seen from a place on its line.
struct Reference {
  double ahead{0};  ///< of it, the place is; negative: behind
  double speed{0}, acc{0};
};
/// What a place may do.
struct FollowLimits {
  double acc{1}, jerk{1};         ///< both above 0
  double slowest{0}, fastest{0};  ///< speeds, never passed
};
/// The jerk for the next `dt` seconds, within the limits, that brings a place at `state` onto its reference in the least time: such that
/// bringing the difference of speeds to 0 from there on as fast as possible ends on the reference; near to it in proportion.
[[nodiscard]] double following_jerk(const Reference& ref, RampState state,
                                    const FollowLimits& limits, double dt) noexcept;

/// The reference of one thread: per_rev * (turns since the index), and how it is come into step with.
class SyncTracker {
 public:
  /// From the index at `zero_revs` on, `turning` (1 or -1) is forwards.
  /// The index was `age_s` ago.
  void begin(double per_rev, double zero_revs, std::int32_t turning, double age_s = 0) noexcept;
  /// The speed to have `dt` from now at place `s` (from where the thread begins), before limits; negative backwards. Until the first
  /// motion the reference is put back by whole turns as long as it is too near to be joined.
  [[nodiscard]] double speed(const SpindleObserver& spindle, double s, double acc,
                             double dt) noexcept;
  /// The same with a jerk limit: the jerk for `dt` seconds from `into` seconds after the observer's moment on, at place `s` then.
  [[nodiscard]] double jerk(const SpindleObserver& spindle, double s, RampState state,
                            const FollowLimits& limits, double into, double dt) noexcept;
  [[nodiscard]] double lag() const noexcept { return lag_; }  ///< behind the reference
  [[nodiscard]] bool moving() const noexcept { return moving_; }
  /// In step since it came into it; false while catching up or not yet begun.
  [[nodiscard]] bool joined() const noexcept { return joined_; }
  [[nodiscard]] double run_in() const noexcept { return run_in_; }
  /// Not before so long after the index: the observer has to settle.
  static constexpr double kSettle = 0.06;  // s

 private:
  void choose_turn(double& ahead, double ref_speed, double acc, double jerk, double dt) noexcept;
  void note(const SpindleObserver& spindle, double s, double ahead, double ref_speed) noexcept;

  double per_rev_{0}, zero_{0}, lag_{0}, run_in_{0}, age_s_{0};
  std::int32_t turning_{1};
  double begins_with_{0};  ///< speed of the reference when it was chosen
  bool chosen_{false}, moving_{false}, joined_{false};
};

/// Everything about spindles that the path follows: one observer each, and the thread or tap in execution.
class Synchroniser {
 public:
  explicit Synchroniser(Spindles& spindles) noexcept : spindles_(spindles) {}

  /// Once a cycle, before the path.
  void observe(const SpindleInputs* in, double dt) noexcept;
  [[nodiscard]] const SpindleObserver& observer(std::int32_t n) const noexcept {
    return observer_[n];
  }
  void take_over(std::int32_t n, const SpindleObserver& observer) noexcept {
    observer_[n] = observer;
  }
  /// What feed_speeds() goes by, kMaxSpindles each; for the flight record.
  void save_speeds(double* slow_rps, double* feed_rps) const noexcept {
    std::copy(std::begin(slow_rps_), std::end(slow_rps_), slow_rps);
    std::copy(std::begin(feed_rps_), std::end(feed_rps_), feed_rps);
  }
  void restore_speeds(const double* slow_rps, const double* feed_rps) noexcept {
    std::copy_n(slow_rps, kMaxSpindles, slow_rps_);
    std::copy_n(feed_rps, kMaxSpindles, feed_rps_);
  }
  /// Measured speeds for G95, smoothed, in steps of a hundredth.
  void feed_speeds(double* rps) const noexcept;

  // --- the start of a thread or tap ---
  enum class Ready { yes, waits, refused };
  /// At rest before it: waits for the spindle to turn, to be at speed and to pass its index. `why` while it waits; a fault when it
  /// cannot be.
  struct Wish {
    double per_rev{0}, acc{0}, jerk{0}, speed{0}, to_end{0}, mm{1}, factor{1};
    std::int32_t spindle{0};
    bool ends{true};  ///< it has to stop at `to_end`
  };
  [[nodiscard]] Ready prepare(const Wish& wish, PathWait& why, const SourceTag& tag,
                              FaultList& faults) noexcept;
  /// A thread is being followed: what comes next keeps step with it.
  [[nodiscard]] bool following(std::int32_t spindle) const noexcept {
    return following_ && spindle_ == spindle;
  }
  /// A thread or tap of this spindle comes behind what is driven now: its index is asked for already. Whole turns behind it are as good,
  /// so nothing is waited for but the next of them.
  void foresee(std::int32_t spindle) noexcept;
  /// Whatever it was has ended; the index is armed anew for the next.
  void end() noexcept;
  /// The same, but what was foreseen goes on.
  void end_thread() noexcept {
    if (!foreseen_) end();
  }

  // --- threads ---
  /// The thread is given up: nothing is said any more of falling behind.
  void lag_is_wanted() noexcept { told_ = true; }
  /// The speed in sigma/s that is wanted at the end of this cycle, `done` of the present stretch being driven. Says so, once, when the
  /// path falls behind.
  [[nodiscard]] double thread_speed(const SyncBounds& sync, double done, const SourceTag& tag,
                                    FaultList& faults) noexcept;
  /// With jerk limits: the jerk that is wanted for `dt` seconds from `into` seconds of this cycle on.
  [[nodiscard]] double thread_jerk(const SyncBounds& sync, double done, RampState state,
                                   const FollowLimits& limits, double into, double dt,
                                   const SourceTag& tag, FaultList& faults) noexcept;
  /// A stretch of `length` sigma was driven to its end.
  void passed(double length) noexcept { passed_ += following_ ? length : 0.0; }

  // --- taps ---
  enum class Tap { goes_on, done, stopped };
  void begin_tap() noexcept;
  /// One cycle. `stop`: the spindle has been told to stop; follow it to its standstill.
  [[nodiscard]] Tap tap(const TapSpan& tap, bool stop, double dt, const SourceTag& tag,
                        FaultList& faults) noexcept;
  [[nodiscard]] double tap_place() const noexcept { return place_; }
  [[nodiscard]] double tap_speed() const noexcept { return speed_; }

  [[nodiscard]] bool moving() const noexcept { return tracker_.moving(); }
  [[nodiscard]] double lag_mm() const noexcept { return following_ ? tracker_.lag() * mm_ : 0.0; }
  [[nodiscard]] bool in_step() const noexcept { return following_ && tracker_.joined(); }
  [[nodiscard]] double run_in_mm() const noexcept { return run_in_mm_; }

 private:
  enum class TapPhase { in, out, turn, home };
  /// What a thread or tap asks for at a speed of its spindle: of its axes, and way (sigma).
  struct Need {
    double speed{0}, way{0};
    [[nodiscard]] bool met(const Wish& wish) const noexcept {
      return speed <= wish.speed && way <= wish.to_end;
    }
  };
  [[nodiscard]] Need need_of(const Wish& wish, double rps) const noexcept;
  void arm(std::int32_t spindle) noexcept;
  void follow() noexcept;
  void watch_lag(double bound, const SourceTag& tag, FaultList& faults) noexcept;
  void watch_thread(const SyncBounds& sync, double done, double braking, const SourceTag& tag,
                    FaultList& faults) noexcept;
  void move_tap(const TapSpan& tap, double wanted, double dt) noexcept;
  void ramp_tap(const TapSpan& tap, double jerk, double dt) noexcept;
  void brake_tap(const TapSpan& tap, double dt) noexcept;
  void follow_spindle(const TapSpan& tap, double dt) noexcept;
  [[nodiscard]] bool comes_home(const TapSpan& tap, double dt) noexcept;
  [[nodiscard]] Tap stop_tap(const TapSpan& tap, double dt) noexcept;

  Spindles& spindles_;
  SpindleObserver observer_[kMaxSpindles];
  double slow_rps_[kMaxSpindles]{}, feed_rps_[kMaxSpindles]{};
  const SpindleInputs* in_{nullptr};
  double dt_{1e-3};

  SyncTracker tracker_;
  double per_rev_{0};
  std::int32_t spindle_{-1};
  bool armed_{false}, following_{false}, told_{false};
  double armed_at_{0};
  double settling_s_{0};  ///< for so long a thread has waited to see its spindle slow down
  bool foreseen_{false};  ///< the index was asked for ahead of its thread, which has not asked yet
  bool indexed_{false};   ///< and has come: at `zero_`, `indexed_s_` ago
  double zero_{0}, indexed_s_{0};
  double passed_{0};  ///< sigma of this thread in the stretches before the present one
  double mm_{1}, run_in_mm_{0};

  TapPhase phase_{TapPhase::in};
  double place_{0}, speed_{0}, acc_{0}, stopping_s_{0}, stop_rps_{0};
  std::int32_t turning_{1};
};

}  // namespace kerf::motion
