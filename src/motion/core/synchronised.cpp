#include "motion/core/synchronised.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::motion {
namespace {

/// Memory of the observer: long against the time between two counts, and at least what smooths the steps of coarse encoders.
constexpr double kLeastMemory = 0.015;  // s
constexpr double kMostMemory = 0.2;
constexpr double kCountsRemembered = 6;
constexpr double kLate = 3;  ///< times the usual time between counts
/// A counter that is this far (revolutions) from where it should be has been set to another value.
constexpr double kCounterJump = 0.5;
/// Residuals decay with this rate where they are small.
constexpr double kGain = 150;  // 1/s
constexpr double kGainPerCycle = 0.25;
/// Share of the acceleration for coming into step; the rest is for the spindle's own.
constexpr double kShare = 0.8;
/// In step, for the first time: this near to the reference, in seconds of its motion, or as near as a quarter of a count.
constexpr double kInStep = 2e-5;
constexpr double kNear = 1e-6;  // mm
/// From the switching curve into step.
constexpr double kTail = 0.02;  // s
constexpr double kTailCycles = 8;
/// Lag that is told, as a part of the pitch, and at least [mm].
constexpr double kLagShare = 0.25;
constexpr double kLeastLag = 0.1;
/// Turns after which an index pulse must have come.
constexpr double kNoIndexAfter = 5;
/// Below this a spindle stands (revolutions per second).
constexpr double kStands = 0.02;
/// A tap that is stopped follows its spindle while that slows down at least so fast; after `kGrace` it has to have begun.
constexpr double kGrace = 0.3, kLongestStop = 6;  // s
/// The way back to the start of a tap has ended where the rest is this part of what a cycle can change.
constexpr double kLanding = 0.05;
constexpr double kFeedFilter = 0.02;  // s
constexpr double kFeedStep = 0.01;

}  // namespace

void SpindleObserver::step(double revs, double dt) noexcept {
  if (!std::isfinite(revs)) return;
  since_change_s_ = std::min(since_change_s_ + dt, kMostMemory);
  if (revs != counted_) {
    between_s_ += 0.2 * (since_change_s_ - between_s_);
    since_change_s_ = 0;
    counted_ = revs;
  }
  // Counts that do not come any more are a spindle that stands, and that has to be seen at once.
  const bool late = since_change_s_ > kLate * between_s_ + 2 * dt;
  const double memory =
      late ? kLeastMemory : std::clamp(kCountsRemembered * between_s_, kLeastMemory, kMostMemory);
  const double t = std::exp(-dt / memory), k = 1 - t;
  angle_ += dt * (rps_ + 0.5 * acc_ * dt);
  rps_ += acc_ * dt;
  const double residual = revs - angle_;
  since_jump_s_ = std::min(since_jump_s_ + dt, kMostMemory);
  jumped_ = std::abs(residual) > kCounterJump;
  if (!known_ || jumped_) {
    // Once is a counter that was set; again is a speed that is none.
    if (since_jump_s_ < kMostMemory) rps_ = 0;
    acc_ = since_jump_s_ = 0;
    known_ = true;
    angle_ = revs;
    return;
  }
  noise_ += (std::abs(residual) - noise_) * std::min(1.0, dt / kLeastMemory);
  angle_ += (1 - t * t * t) * residual;
  rps_ += 1.5 * k * k * (1 + t) * residual / dt;
  acc_ += k * k * k * residual / (dt * dt);
}

double following_speed(double ahead, double ref_speed, double acc, double dt) noexcept {
  const double gain = std::min(kGain, kGainPerCycle / dt), knee = acc / (gain * gain);
  const double distance = std::abs(ahead);
  const double towards =
      distance <= knee ? gain * distance : std::sqrt(2 * acc * (distance - 0.5 * knee));
  return ref_speed - std::copysign(towards, ahead);
}

double joining_distance(double ref_speed, double acc, double dt) noexcept {
  const double gain = std::min(kGain, kGainPerCycle / dt), knee = acc / (gain * gain);
  const double v = std::abs(ref_speed);
  return v <= gain * knee ? v / gain : v * v / (2 * acc) + 0.5 * knee;
}

void SyncTracker::begin(double per_rev, double zero_revs, std::int32_t turning,
                        double age_s) noexcept {
  *this = SyncTracker{};
  age_s_ = age_s;
  per_rev_ = per_rev;
  zero_ = zero_revs;
  turning_ = turning;
}

/// What stands can only be joined by a reference that is still behind it.
void SyncTracker::choose_turn(double& ahead, double ref_speed, double acc, double dt) noexcept {
  const double joins = joining_distance(ref_speed, kShare * acc, dt);
  // Once chosen, only a spindle that has become faster makes it too late.
  const double least =
      chosen_ ? 0.7 * joins : joins + ref_speed * (2 * dt + std::max(kSettle - age_s_, 0.0));
  if (!(ahead < least) || !(per_rev_ > 0)) {
    chosen_ = true;
    return;
  }
  const double turns = std::ceil((joins + 2 * dt * ref_speed - ahead) / per_rev_);
  const double more = std::max(std::ceil((least - ahead) / per_rev_), turns);
  chosen_ = true;
  zero_ += turning_ * more;
  ahead += per_rev_ * more;
}

double SyncTracker::speed(const SpindleObserver& spindle, double s, double acc,
                          double dt) noexcept {
  const double k = per_rev_ * turning_;
  const double ref_speed = k * spindle.rps_after(dt);
  double ahead = s - k * (spindle.angle() - zero_);
  age_s_ += dt;
  if (!moving_) {
    if (!(ref_speed > 0)) return lag_ = 0;
    choose_turn(ahead, ref_speed, acc, dt);
  }
  const double v = following_speed(ahead, ref_speed, kShare * acc, dt);
  if (!moving_ && !(v > 0)) return lag_ = 0;
  moving_ = true;
  lag_ = -ahead;
  if (!joined_ &&
      std::abs(ahead) <= kInStep * std::abs(ref_speed) + per_rev_ * spindle.noise() + kNear) {
    joined_ = true;
    run_in_ = s;
  }
  return v;
}

void Synchroniser::observe(const SpindleInputs* in, double dt) noexcept {
  in_ = in;
  dt_ = dt;
  indexed_s_ += dt;
  for (std::int32_t n = 0; n < spindles_.count(); ++n) {
    SpindleObserver& o = observer_[n];
    // The encoder has taken index-enable back: its counter starts at the index.
    const bool index = armed_ && n == spindle_ && !in[n].index_enable;
    if (index) {
      const double before = o.angle();
      o.step(before + o.rps() * dt, dt);
      o.anchor(in[n].revs);
      armed_ = false;
      // A counter that goes on counting has its index at a whole revolution.
      const double turned = std::abs(o.rps()) * dt + 0.5;
      zero_ = std::abs(in[n].revs) <= turned ? 0.0
              : turning_ > 0                 ? std::floor(in[n].revs)
                                             : std::ceil(in[n].revs);
      indexed_s_ = 0;
      indexed_ = foreseen_;
      if (!foreseen_) follow();
    } else {
      o.step(in[n].revs, dt);
      // A counter that is set by anyone else has no index any more.
      if (indexed_ && n == spindle_ && o.jumped()) end();
    }
    const double now = std::isfinite(in[n].speed_in_rps) ? std::abs(in[n].speed_in_rps) : 0.0;
    slow_rps_[n] += (now - slow_rps_[n]) * std::min(1.0, dt / kFeedFilter);
    const double change = std::abs(slow_rps_[n] - feed_rps_[n]);
    if (change > kFeedStep * feed_rps_[n]) feed_rps_[n] = slow_rps_[n] < 1e-3 ? 0 : slow_rps_[n];
  }
}

void Synchroniser::feed_speeds(double* rps) const noexcept {
  for (std::size_t n = 0; n < kMaxSpindles; ++n) rps[n] = feed_rps_[n];
}

Synchroniser::Ready Synchroniser::prepare(const Wish& wish, PathWait& why, const SourceTag& tag,
                                          FaultList& faults) noexcept {
  const std::int32_t n = wish.spindle;
  if (following(n)) return Ready::yes;
  if (foreseen_ && (n != spindle_ || spindles_.direction(n) != turning_)) end();
  if (armed_ && !foreseen_) {
    why = PathWait::spindle_index;
    const double turned = std::abs(observer_[n].angle() - armed_at_);
    if (turned < kNoIndexAfter) return Ready::waits;
    raise(faults, Fault::sync_no_index, n, turned, 0, tag);
    end();
    return Ready::refused;
  }
  if (spindles_.direction(n) == 0) {
    why = PathWait::spindle_turning;
    return Ready::waits;
  }
  if (spindles_.not_at_speed() >= 0 || in_ == nullptr || !in_[n].at_speed) {
    why = PathWait::spindle_at_speed;
    return Ready::waits;
  }
  const double rps =
      std::max(std::abs(observer_[n].rps()),
               std::abs(spindles_.outputs(static_cast<std::size_t>(n)).speed_rpm) / 60);
  const double v = wish.per_rev * rps;
  if (v * wish.factor > wish.speed) {
    raise(faults, Fault::sync_too_fast, n, v * wish.factor * wish.mm, wish.speed * wish.mm, tag);
    return Ready::refused;
  }
  const double in = v * v / (2 * kShare * wish.acc) + std::max(kTail, kTailCycles * dt_) * v;
  const double need = wish.ends ? in + v * v / (2 * wish.acc) : in;
  if (need > wish.to_end) {
    raise(faults, Fault::sync_too_short, n, need * wish.mm, wish.to_end * wish.mm, tag);
    return Ready::refused;
  }
  per_rev_ = wish.per_rev;
  mm_ = wish.mm;
  passed_ = 0;
  told_ = false;
  if (!foreseen_) arm(n);
  foreseen_ = false;
  if (indexed_) {
    follow();
    return Ready::yes;
  }
  why = PathWait::spindle_index;
  return Ready::waits;
}

void Synchroniser::foresee(std::int32_t spindle) noexcept {
  if (armed_ || following_ || indexed_ || spindles_.direction(spindle) == 0) return;
  arm(spindle);
  foreseen_ = true;
}

void Synchroniser::arm(std::int32_t spindle) noexcept {
  spindle_ = spindle;
  turning_ = spindles_.direction(spindle);
  armed_ = true;
  armed_at_ = observer_[spindle].angle();
  spindles_.arm_index(spindle);
}

void Synchroniser::follow() noexcept {
  indexed_ = false;
  following_ = true;
  tracker_.begin(per_rev_, zero_, turning_, indexed_s_);
}

void Synchroniser::end() noexcept {
  if (armed_) spindles_.disarm_index(spindle_);
  armed_ = following_ = foreseen_ = indexed_ = false;
  passed_ = 0;
  spindle_ = -1;
}

void Synchroniser::watch_lag(double bound, const SourceTag& tag, FaultList& faults) noexcept {
  if (!tracker_.joined()) return;
  run_in_mm_ = tracker_.run_in() * mm_;
  const double lag = std::abs(tracker_.lag()) * mm_;
  if (told_ || lag <= bound) return;
  told_ = true;
  raise(faults, Fault::sync_behind, spindle_, lag, bound, tag);
}

double Synchroniser::thread_speed(const SyncBounds& sync, double done, const SourceTag& tag,
                                  FaultList& faults) noexcept {
  mm_ = sync.mm;
  const double v = tracker_.speed(observer_[spindle_], passed_ + done, sync.acc, dt_);
  // Behind the run-out nobody is in step.
  const double braking = v * v / (2 * sync.acc);
  if (sync.to_end - done > 1.5 * braking + sync.mm * 1e-3)
    watch_lag(std::max(kLagShare * sync.per_rev * mm_, kLeastLag), tag, faults);
  return std::max(v, 0.0);
}

void Synchroniser::begin_tap() noexcept {
  phase_ = TapPhase::in;
  place_ = speed_ = stopping_s_ = 0;
}

/// Towards `wanted` as fast as the limits allow, and never nearer to an end of the range than it can stop.
void Synchroniser::move_tap(const TapSpan& tap, double wanted, double dt) noexcept {
  const double before = speed_, step = tap.acc * dt;
  double v = std::clamp(wanted, -tap.speed, tap.speed);
  const double ahead = tap.high - place_ - std::max(before, 0.0) * dt;
  const double back = place_ - tap.low - std::max(-before, 0.0) * dt;
  v = std::min(v, std::sqrt(2 * tap.acc * std::max(ahead, 0.0)));
  v = std::max(v, -std::sqrt(2 * tap.acc * std::max(back, 0.0)));
  speed_ = std::clamp(v, before - step, before + step);
  place_ += 0.5 * (before + speed_) * dt;
}

Synchroniser::Tap Synchroniser::stop_tap(const TapSpan& tap, double dt) noexcept {
  const SpindleObserver& o = observer_[spindle_];
  if (stopping_s_ == 0) stop_rps_ = std::abs(o.rps());
  stopping_s_ += dt;
  const double most = stop_rps_ * (1 - (stopping_s_ - kGrace) / kLongestStop);
  const bool slows = std::abs(o.rps()) <= most + kStands;
  double wanted = 0;
  if (following_ && phase_ != TapPhase::home && slows && tracker_.moving())
    wanted = tracker_.speed(o, place_, tap.acc, dt);
  if (std::abs(o.rps()) < kStands) wanted = 0;
  move_tap(tap, wanted, dt);
  if (wanted != 0 || speed_ != 0) return Tap::goes_on;
  return Tap::stopped;
}

Synchroniser::Tap Synchroniser::tap(const TapSpan& tap, bool stop, double dt, const SourceTag& tag,
                                    FaultList& faults) noexcept {
  if (stop) return stop_tap(tap, dt);
  const SpindleObserver& o = observer_[spindle_];
  if (phase_ == TapPhase::home) {
    const double before = speed_, still = kLanding * tap.acc * dt;
    move_tap(tap, following_speed(place_, 0, kShare * tap.acc, dt), dt);
    if (std::max(std::abs(before), std::abs(speed_)) > still || std::abs(place_) > still * dt)
      return Tap::goes_on;
    place_ = speed_ = 0;
    return Tap::done;
  }
  double wanted = tracker_.speed(o, place_, tap.acc, dt);
  if (!tracker_.moving()) wanted = 0;
  move_tap(tap, wanted, dt);
  watch_lag(std::max(kLagShare * tap.per_rev, kLeastLag), tag, faults);
  const double turning = o.rps() * turning_;
  switch (phase_) {
    case TapPhase::in:
      if (place_ < tap.depth) break;
      spindles_.reverse(spindle_, tap.return_factor);
      phase_ = TapPhase::out;
      break;
    case TapPhase::out:
      if (place_ > 0 || turning > 0) break;
      spindles_.reverse(spindle_, 1);
      phase_ = TapPhase::turn;
      break;
    case TapPhase::turn:
      if (turning > kStands) phase_ = TapPhase::home;
      break;
    case TapPhase::home: break;
  }
  return Tap::goes_on;
}

}  // namespace kerf::motion
