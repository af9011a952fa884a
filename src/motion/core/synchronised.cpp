#include "motion/core/synchronised.hpp"

#include <algorithm>
#include <cmath>

#include "motion/core/false_position.hpp"

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
/// Share of acceleration and jerk for coming into step; the rest is for the spindle's own. A spindle that changes its speed leaves at least so much.
constexpr double kShare = 0.8, kLeastShare = 0.2;
/// A jerk is sought this finely, as a share of its limit.
constexpr double kSameJerk = 1e-6;
constexpr int kJerkSteps = 30;
/// What takes less of the limits than that is done in proportion.
constexpr double kNearShare = 0.1;
/// Cycles in which acceleration is brought up at least, and half of a run-up.
constexpr double kAccCycles = 4, kRunUpCycles = 5;
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
/// For so long a spindle that is said to be at its speed may be seen faster before a thread is refused (s).
constexpr double kSettles = 0.5;
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
  if (const double forgets = dt / memory; forgets != forgets_) {
    forgets_ = forgets;
    fading_ = std::exp(-forgets);
  }
  const double t = fading_, k = 1 - t;
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

double joining_distance(double ref_speed, double acc, double jerk, double dt) noexcept {
  // While it speeds up evenly it goes half as far as the reference.
  if (jerk > 0) return level_distance(0, std::abs(ref_speed), {acc, jerk});
  const double gain = std::min(kGain, kGainPerCycle / dt), knee = acc / (gain * gain);
  const double v = std::abs(ref_speed);
  return v <= gain * knee ? v / gain : v * v / (2 * acc) + 0.5 * knee;
}

namespace {

FollowLimits limits_of(const TapSpan& tap) noexcept {
  return {tap.acc, tap.jerk, -tap.speed, tap.speed};
}

/// The acceleration after `dt` from which letting go of it ends at `room` above the present speed.
double acc_that_leaves(double room, double acc, double jerk, double dt) noexcept {
  const double square = 0.25 * dt * dt + 2 * (room - 0.5 * acc * dt) / jerk;
  const double then = square > 0 ? jerk * (std::sqrt(square) - 0.5 * dt) : -jerk * dt;
  if (then >= 0 || acc <= 0) return then;
  // It goes through 0 within `dt`, and the highest speed is there.
  return room > 0 ? std::min(then, acc - acc * acc * dt / (2 * room)) : acc - jerk * dt;
}

}  // namespace

double joining_jerk(double jerk, double acc, double speed, double dt) noexcept {
  return std::min(
      {jerk, acc / (kAccCycles * dt), std::abs(speed) / (kRunUpCycles * kRunUpCycles * dt * dt)});
}

double following_jerk(const Reference& ref, RampState state, const FollowLimits& limits,
                      double dt) noexcept {
  const RampLimits own{std::max(kShare * limits.acc - std::abs(ref.acc), kLeastShare * limits.acc),
                       kShare * limits.jerk};
  // In the frame of the reference.
  const double e = ref.ahead, w = state.speed - ref.speed, b = state.acc - ref.acc;
  const double g = std::min(kGain, kGainPerCycle / dt);
  double j = 0;
  const double by_gain = g * (g * (g * std::abs(e) + 3 * std::abs(w)) + 3 * std::abs(b));
  // What a cycle of jerk does is too coarse for what it leads to: it would go to and fro.
  const double step = own.jerk * dt;
  const bool coarse =
      std::abs(b) <= step && std::abs(w) <= step * dt && std::abs(e) <= step * dt * dt;
  if (coarse || by_gain <= kNearShare * std::min(own.jerk, g * own.acc)) {
    j = -g * (g * (g * e + 3 * w) + 3 * b);
  } else {
    // More than the ramp behind it, so that what the division into cycles spoils is made good.
    const double most = own.jerk / kShare;
    const auto end = [&](double jerk) {
      RampState then{w, b};
      const double way = advance(then, jerk, dt);
      return e + way + ramp_distance(then, 0, own);
    };
    j = largest_within(-most, most, 0, end, {kSameJerk, 1e-13, kJerkSteps});
    j = std::clamp(j, std::min(0.0, (-own.acc - b) / dt), std::max(0.0, (own.acc - b) / dt));
  }
  const double a = state.acc;
  j = std::clamp(j, (-limits.acc - a) / dt, (limits.acc - a) / dt);
  const double most = acc_that_leaves(limits.fastest - state.speed, a, limits.jerk, dt);
  const double least = -acc_that_leaves(state.speed - limits.slowest, -a, limits.jerk, dt);
  j = std::min(std::max(j, (least - a) / dt), (most - a) / dt);
  return std::clamp(j, -limits.jerk, limits.jerk);
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
void SyncTracker::choose_turn(double& ahead, double ref_speed, double acc, double jerk,
                              double dt) noexcept {
  const double joins = joining_distance(ref_speed, kShare * acc, kShare * jerk, dt);
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
    choose_turn(ahead, ref_speed, acc, 0, dt);
  }
  const double v = following_speed(ahead, ref_speed, kShare * acc, dt);
  if (!moving_ && !(v > 0)) return lag_ = 0;
  note(spindle, s, ahead, ref_speed);
  return v;
}

double SyncTracker::jerk(const SpindleObserver& spindle, double s, RampState state,
                         const FollowLimits& limits, double into, double dt) noexcept {
  const double k = per_rev_ * turning_;
  Reference ref;
  ref.acc = k * spindle.acc();
  ref.speed = k * spindle.rps_after(into);
  ref.ahead =
      s - k * (spindle.angle() - zero_ + into * (spindle.rps() + 0.5 * spindle.acc() * into));
  age_s_ += dt;
  if (!moving_) {
    lag_ = 0;
    if (!(ref.speed > 0)) return 0;
    begins_with_ = ref.speed;
  }
  FollowLimits used = limits;
  used.jerk = joining_jerk(limits.jerk, limits.acc, begins_with_, dt);
  if (!moving_) choose_turn(ref.ahead, ref.speed, limits.acc, used.jerk, dt);
  const double j = following_jerk(ref, state, used, dt);
  if (!moving_ && !(j > 0)) return 0;
  note(spindle, s, ref.ahead, ref.speed);
  return j;
}

void SyncTracker::note(const SpindleObserver& spindle, double s, double ahead,
                       double ref_speed) noexcept {
  moving_ = true;
  lag_ = -ahead;
  if (joined_ ||
      std::abs(ahead) > kInStep * std::abs(ref_speed) + per_rev_ * spindle.noise() + kNear)
    return;
  joined_ = true;
  run_in_ = s;
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

Synchroniser::Need Synchroniser::need_of(const Wish& wish, double rps) const noexcept {
  const double v = wish.per_rev * rps;
  const bool jerks = wish.jerk > 0;
  const double jerk = joining_jerk(wish.jerk, wish.acc, v, dt_);
  const double joins = jerks ? joining_distance(v, kShare * wish.acc, kShare * jerk, dt_)
                             : v * v / (2 * kShare * wish.acc);
  const double in = joins + std::max(kTail, kTailCycles * dt_) * v;
  const double out = jerks ? stopping_distance(v, {wish.acc, wish.jerk}) : v * v / (2 * wish.acc);
  return {v * wish.factor, wish.ends ? in + out : in};
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
  const double told = std::abs(spindles_.outputs(static_cast<std::size_t>(n)).speed_rpm) / 60;
  const Need need = need_of(wish, std::max(std::abs(observer_[n].rps()), told));
  if (!need.met(wish)) {
    // It may have been faster a moment ago and not be seen at its speed yet.
    if (settling_s_ < kSettles && need_of(wish, told).met(wish)) {
      settling_s_ += dt_;
      why = PathWait::spindle_at_speed;
      return Ready::waits;
    }
    if (need.speed > wish.speed)
      raise(faults, Fault::sync_too_fast, n, need.speed * wish.mm, wish.speed * wish.mm, tag);
    else
      raise(faults, Fault::sync_too_short, n, need.way * wish.mm, wish.to_end * wish.mm, tag);
    settling_s_ = 0;
    return Ready::refused;
  }
  settling_s_ = 0;
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
  watch_thread(sync, done, v * v / (2 * sync.acc), tag, faults);
  return std::max(v, 0.0);
}

double Synchroniser::thread_jerk(const SyncBounds& sync, double done, RampState state,
                                 const FollowLimits& limits, double into, double dt,
                                 const SourceTag& tag, FaultList& faults) noexcept {
  mm_ = sync.mm;
  const double j = tracker_.jerk(observer_[spindle_], passed_ + done, state, limits, into, dt);
  // It goes on being the run-out when hardly any speed is left.
  const double speed = std::max(state.speed, std::abs(observer_[spindle_].rps()) * sync.per_rev);
  watch_thread(sync, done, stopping_distance(speed, {limits.acc, limits.jerk}), tag, faults);
  return j;
}

/// Behind the run-out nobody is in step.
void Synchroniser::watch_thread(const SyncBounds& sync, double done, double braking,
                                const SourceTag& tag, FaultList& faults) noexcept {
  if (sync.to_end - done > 1.5 * braking + sync.mm * 1e-3)
    watch_lag(std::max(kLagShare * sync.per_rev * mm_, kLeastLag), tag, faults);
}

void Synchroniser::begin_tap() noexcept {
  phase_ = TapPhase::in;
  place_ = speed_ = acc_ = stopping_s_ = 0;
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

/// With jerk limits: the wish where a stop behind it stays within the range; else to rest.
void Synchroniser::ramp_tap(const TapSpan& tap, double jerk, double dt) noexcept {
  const RampLimits limits{tap.acc, tap.jerk};
  RampState then{speed_, acc_};
  const double place = place_ + advance(then, jerk, dt);
  const double rest = place + ramp_distance(then, 0, limits);
  if (std::min(place, rest) >= tap.low && std::max(place, rest) <= tap.high) {
    place_ = place;
    speed_ = then.speed;
    acc_ = then.acc;
  } else {
    brake_tap(tap, dt);
  }
}

void Synchroniser::brake_tap(const TapSpan& tap, double dt) noexcept {
  RampState s{speed_, acc_};
  const Ramp ramp = ramp_to(s, 0, {tap.acc, tap.jerk});
  place_ += ramp.advance(s, dt);
  if (ramp.duration() <= dt) s = {};
  speed_ = s.speed;
  acc_ = s.acc;
}

void Synchroniser::follow_spindle(const TapSpan& tap, double dt) noexcept {
  const SpindleObserver& o = observer_[spindle_];
  if (tap.jerk > 0) {
    const double j = tracker_.jerk(o, place_, {speed_, acc_}, limits_of(tap), 0, dt);
    if (tracker_.moving()) ramp_tap(tap, j, dt);
    return;
  }
  const double wanted = tracker_.speed(o, place_, tap.acc, dt);
  move_tap(tap, tracker_.moving() ? wanted : 0.0, dt);
}

/// True: it is there.
bool Synchroniser::comes_home(const TapSpan& tap, double dt) noexcept {
  const double step = (tap.jerk > 0 ? tap.jerk * dt : tap.acc) * dt, still = kLanding * step;
  const double before = speed_, acc_before = acc_;
  if (tap.jerk > 0)
    ramp_tap(tap, following_jerk({place_, 0, 0}, {speed_, acc_}, limits_of(tap), dt), dt);
  else
    move_tap(tap, following_speed(place_, 0, kShare * tap.acc, dt), dt);
  return std::max(std::abs(before), std::abs(speed_)) <= still && std::abs(place_) <= still * dt &&
         std::max(std::abs(acc_before), std::abs(acc_)) <= still / dt;
}

Synchroniser::Tap Synchroniser::stop_tap(const TapSpan& tap, double dt) noexcept {
  const SpindleObserver& o = observer_[spindle_];
  if (stopping_s_ == 0) stop_rps_ = std::abs(o.rps());
  stopping_s_ += dt;
  const double most = stop_rps_ * (1 - (stopping_s_ - kGrace) / kLongestStop);
  const bool slows = std::abs(o.rps()) <= most + kStands;
  if (following_ && phase_ != TapPhase::home && slows && tracker_.moving() &&
      std::abs(o.rps()) >= kStands) {
    follow_spindle(tap, dt);
    return Tap::goes_on;
  }
  if (tap.jerk > 0)
    brake_tap(tap, dt);
  else
    move_tap(tap, 0, dt);
  return speed_ != 0 || acc_ != 0 ? Tap::goes_on : Tap::stopped;
}

Synchroniser::Tap Synchroniser::tap(const TapSpan& tap, bool stop, double dt, const SourceTag& tag,
                                    FaultList& faults) noexcept {
  if (stop) return stop_tap(tap, dt);
  const SpindleObserver& o = observer_[spindle_];
  if (phase_ == TapPhase::home) {
    if (!comes_home(tap, dt)) return Tap::goes_on;
    place_ = speed_ = acc_ = 0;
    return Tap::done;
  }
  follow_spindle(tap, dt);
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
