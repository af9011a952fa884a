// Modes, and what moves in each of them.
#include <algorithm>
#include <array>
#include <cmath>

#include "motion/core/controller.hpp"

namespace kerf::motion {
namespace {
/// A continuous jog without limits goes this far at most (mm, degrees).
constexpr double kEndlessJog = 1e6;
constexpr double kAtLimit = 1e-9;
constexpr double kOtherPlace =
    1e-6;  ///< mm, degrees; rounding, and searches of kinematics, are below
constexpr double kLeastAcc = 1e-6;  ///< movers divide by it
/// The way on which jogs would stop is looked at in so many places.
constexpr std::size_t kPartsOfStop = 8;
/// So much farther than even acceleration says a joint may go where it turns between two of them: axes come to rest there.
constexpr double kBetween = 4;
}  // namespace

bool Controller::all_homed() const noexcept {
  for (std::size_t j = 0; j < joints_; ++j) {
    if (!joint_[j].homed) return false;
  }
  return true;
}

bool Controller::may_leave_free() const noexcept {
  return all_homed() || (config_.no_force_homing && kinematics_.type() == KinematicsType::identity);
}

std::uint32_t Controller::jogging_axes() const noexcept {
  const std::uint32_t axes = kinematics_.axis_mask();
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if ((axes >> i & 1U) != 0 && axis_[i].active()) out |= 1U << i;
  return out;
}

bool Controller::jogging() const noexcept {
  if (mode_ == MotionMode::free && !homing_.active()) {
    for (std::size_t j = 0; j < joints_; ++j) {
      if (joint_[j].mover.active()) return true;
    }
  }
  return jogging_axes() != 0;
}

/// Jogs away from a held path and back. The path waits until the machine stands where it was left.
void Controller::watch_away(const Orders& orders) noexcept {
  constexpr double kThere = 1e-7;  ///< mm, degrees
  if (!away_) {
    away_ = orders.values->away && orders.hold && enabled_ && !closing_down_ &&
            orders.abort_epoch == acked_epoch_ && mode_ == MotionMode::coordinated && at_rest();
    for (std::size_t i = 0; away_ && i < rtapi::kAxes; ++i) axis_[i].place(pose_[i]);
    return;
  }
  if (orders.values->away || !at_rest()) return;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (std::abs(pose_[i] - path_pose()[i]) > kThere) return;
  away_ = false;
}

/// Nothing moves for it: beside the path only its place changes, and without a path there is none.
void Controller::take_shift(const Orders& orders) noexcept {
  const Pose& want = orders.values->path_shift;
  if (want == shift_ || orders.abort_epoch != acked_epoch_ || !at_rest()) return;
  if (!away_) {
    if (want == Pose{} && executor_.idle() && orders.path_ring_empty) fold_shift();
    return;
  }
  bool finite = true;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) finite = finite && std::isfinite(want[i]);
  if (!finite || !plain_kinematics_ || executor_.retraces()) return;
  shift_ = want;
  executor_.forget_way_back();
}

void Controller::fold_shift() noexcept {
  if (shift_ == Pose{}) return;
  executor_.fold(shift_);
  shift_ = {};
}

/// Task and planner have looked at limits with the shift; what they overlooked ends here.
bool Controller::shift_leads_out() noexcept {
  constexpr double kRounding = 1e-6;  ///< mm, degrees
  if (shift_ == Pose{}) return false;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    const AxisConfig& a = axis_limit_[i];
    const bool over = pose_[i] > a.max_limit + kRounding && pose_[i] > pose_before_[i];
    const bool under = pose_[i] < a.min_limit - kRounding && pose_[i] < pose_before_[i];
    if (!over && !under) continue;
    raise(faults_, over ? Fault::axis_soft_limit_max : Fault::axis_soft_limit_min,
          static_cast<std::int32_t>(i), pose_[i], over ? a.max_limit : a.min_limit,
          status_.current);
    return true;
  }
  return false;
}

void Controller::switch_mode(const Orders& orders) noexcept {
  MotionMode want = orders.values->mode;
  if (mode_ != MotionMode::free && !may_leave_free()) want = MotionMode::free;
  if (away_) want = mode_;
  if (want == mode_) {
    refused_mode_ = MotionMode::free;
    return;
  }
  if (!at_rest() || homing_.active() || executor_.moving_item()) return;
  if (mode_ == MotionMode::coordinated && !(executor_.idle() && orders.path_ring_empty)) return;
  if (want != MotionMode::free && !may_leave_free()) {
    // Once a request: the mode stays as it is until somebody wants another.
    if (refused_mode_ != want) raise(faults_, Fault::not_homed);
    refused_mode_ = want;
    return;
  }
  if (want != MotionMode::free && !has_position()) {
    if (refused_mode_ != want) raise(faults_, Fault::kinematics_refused, -1, kinematics_.kind(), 3);
    refused_mode_ = want;
    return;
  }
  enter(want);
}

void Controller::enter(MotionMode mode) noexcept {
  mode_ = mode;
  refused_mode_ = MotionMode::free;
  // Joints know nothing of offsets: in joint mode they are a part of the position.
  if (mode == MotionMode::free) offsets_.reset();
  (void)settle();
}

void Controller::take_unhome(std::int32_t which) noexcept {
  if (!at_rest() || homing_.active()) {
    raise(faults_, Fault::home_busy, which);
    return;
  }
  if (HomingModule* const module = homing_.module(); module != nullptr)
    return module->unhome(which, enabled_, mode_);
  for (std::size_t j = 0; j < joints_; ++j) {
    const bool meant = which == -1 || which == static_cast<std::int32_t>(j) ||
                       (which == -2 && config_.joint[j].volatile_home);
    if (!meant) continue;
    // An extra joint that is homed follows its pin: motion(9), "only when motion is disabled".
    if (enabled_ && is_posthome(j))
      raise(faults_, Fault::home_failed, static_cast<std::int32_t>(j),
            static_cast<double>(HomeFailure::extra_while_on));
    else
      joint_[j].homed = false;
  }
}

void Controller::take_homing(const Inputs& in, const Orders& orders) noexcept {
  const Intent& want = *orders.values;
  if (want.home_seq == home_seen_) return;
  home_seen_ = want.home_seq;
  const auto refuse = [&](HomeFailure why) {
    raise(faults_, Fault::home_failed, want.home_joint, static_cast<double>(why));
  };
  if (!enabled_ || closing_down_) return refuse(HomeFailure::not_enabled);
  if (homing_.active() || !at_rest()) {
    raise(faults_, Fault::home_busy, want.home_joint);
    return;
  }
  if (mode_ != MotionMode::free) return refuse(HomeFailure::wrong_mode);
  if (in.homing_inhibit) return refuse(HomeFailure::inhibited);
  homing_.start(want.home_joint, joints_, joint_, config_, kinematics_, faults_);
}

void Controller::watch_jog_stop(const Inputs& in) noexcept {
  const bool soft = in.jog_stop && !jog_stop_before_,
             dead = in.jog_stop_immediate && !jog_dead_before_;
  jog_stop_before_ = in.jog_stop;
  jog_dead_before_ = in.jog_stop_immediate;
  if (homing_.active() || (!soft && !dead)) return;
  for (std::size_t j = 0; j < joints_; ++j)
    dead ? joint_[j].mover.stop_dead() : joint_[j].mover.stop();
  for (AxisMover& axis : axis_) dead ? axis.stop_dead() : axis.stop();
  // Asked for by the pin, so no news to the guard.
  if (dead) guard_.follow(joints_, joint_);
}

/// A probe that touches while it should not ends jogs and homing ([TRAJ]NO_PROBE_JOG_ERROR, NO_PROBE_HOME_ERROR allow it).
void Controller::watch_probe(const Inputs& in) noexcept {
  const bool touched = in.probe && !probe_before_;
  probe_before_ = in.probe;
  if (!touched || !enabled_) return;
  const bool homing = homing_.active() && !config_.probe_error_inhibit_home;
  const bool jog = jogging() && !config_.probe_error_inhibit_jog;
  if (!homing && !jog) return;
  raise(faults_, Fault::probe_unexpected);
  homing_.stop(joints_, joint_);
  for (std::size_t j = 0; j < joints_; ++j) joint_[j].mover.stop();
  for (AxisMover& axis : axis_) axis.stop();
}

Controller::Range Controller::joint_range(std::size_t j, const Intent& want) const noexcept {
  const JointConfig& c = config_.joint[j];
  Range range{c.min_limit, c.max_limit};
  const double here = joint_[j].mover.position();
  if (!joint_[j].homed) {
    // Nobody knows where the limits are: one whole travel either way.
    const double travel = std::min(range.high - range.low, kEndlessJog);
    range = {here - travel, here + travel};
  }
  if (want.override_limits) {
    if (joint_[j].neg_limit) range.low = here;
    if (joint_[j].pos_limit) range.high = here;
  }
  return range;
}

Controller::Range Controller::axis_range(std::size_t i, const Intent& want) const noexcept {
  const double offset = offsets_.pose()[i];
  Range range{axis_limit_[i].min_limit - offset, axis_limit_[i].max_limit - offset};
  for (std::size_t j = 0; j < joints_; ++j) {
    if (kinematics_.axis_of_joint(static_cast<std::int32_t>(j)) != static_cast<std::int32_t>(i))
      continue;
    // A leg that stands ahead of its partner gets to its limit first.
    range.low = std::max(range.low, config_.joint[j].min_limit - skew_[j] - offset);
    range.high = std::min(range.high, config_.joint[j].max_limit - skew_[j] - offset);
    if (!want.override_limits) continue;
    if (joint_[j].neg_limit) range.low = axis_[i].position();
    if (joint_[j].pos_limit) range.high = axis_[i].position();
  }
  return range;
}

bool Controller::may_jog(const Inputs& in, const Orders& orders) const noexcept {
  return enabled_ && !closing_down_ && orders.abort_epoch == acked_epoch_ && !in.jog_inhibit &&
         !homing_.active();
}

bool Controller::may_jog_joint(std::size_t j) const noexcept {
  // Joints that home together would be racked by a jog of one of them (manual, HOME_SEQUENCE).
  const bool bound = !joint_[j].homed && config_.joint[j].home_sequence < 0;
  return mode_ == MotionMode::free && !bound && !is_posthome(j);
}

bool Controller::axis_locked(std::size_t i) const noexcept {
  const std::int32_t j = config_.axis[i].locking_joint;
  return j >= 0 && j < static_cast<std::int32_t>(joints_) && !joint_[j].is_unlocked;
}

bool Controller::joint_locked(std::size_t j) const noexcept {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (config_.axis[i].locking_joint == static_cast<std::int32_t>(j)) return axis_locked(i);
  return false;
}

/// Jogs end where the lock is lost; homing waits for it by itself.
void Controller::watch_locks() noexcept {
  if (!locks_) return;
  for (std::size_t j = 0; j < joints_; ++j)
    if (mode_ == MotionMode::free && !homing_.active() && joint_locked(j)) joint_[j].mover.stop();
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (axis_locked(i)) axis_[i].stop();
}

void Controller::take_jogs(const Inputs& in, const Orders& orders) noexcept {
  const Intent& want = *orders.values;
  const bool ready = may_jog(in, orders);
  // A jog comes together with its mode, and what still goes off the path (a word of the spindle's) may keep motion in the old one
  // for some cycles. The jog waits for as long, unless it is not possible anyway; its end never waits.
  const bool refused = want.mode != MotionMode::free && want.mode == refused_mode_;
  const bool changes = ready && want.mode != mode_ && !refused && !away_;
  jog_waits_ = false;
  const auto waits = [&](const JogIntent& jog) {
    const bool one = changes && jog.kind != JogIntent::Kind::none;
    jog_waits_ = jog_waits_ || one;
    return one;
  };
  for (std::size_t j = 0; j < joints_; ++j) {
    if (want.joint_jog[j].seq == joint_jog_seen_[j] || waits(want.joint_jog[j])) continue;
    const Range range = joint_range(j, want);
    joint_wheel_[j].drives = false;
    if (ready && joint_locked(j) && want.joint_jog[j].kind != JogIntent::Kind::none) {
      joint_jog_seen_[j] = want.joint_jog[j].seq;
      raise(faults_, Fault::indexer_refused, static_cast<std::int32_t>(j),
            static_cast<double>(IndexerRefusal::locked), static_cast<double>(j));
      continue;
    }
    joint_[j].mover.set_limits(std::max(config_.joint[j].max_acc, kLeastAcc),
                               config_.joint[j].max_jerk);
    take_jog(want.joint_jog[j], joint_jog_seen_[j], ready && may_jog_joint(j), joint_[j].mover,
             static_cast<std::int32_t>(j), config_.joint[j].max_vel, range.low, range.high);
  }
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (want.axis_jog[i].seq == axis_jog_seen_[i] || waits(want.axis_jog[i])) continue;
    const bool exists = (kinematics_.axis_mask() >> i & 1U) != 0;
    const Range range = axis_range(i, want);
    axis_wheel_[i].drives = false;
    if (ready && axis_locked(i) && want.axis_jog[i].kind != JogIntent::Kind::none) {
      axis_jog_seen_[i] = want.axis_jog[i].seq;
      raise(faults_, Fault::indexer_refused, kAxisJog + static_cast<std::int32_t>(i),
            static_cast<double>(IndexerRefusal::locked), config_.axis[i].locking_joint);
      continue;
    }
    axis_[i].set_limits(std::max(axis_limit_[i].max_acc, kLeastAcc), axis_limit_[i].max_jerk);
    take_jog(want.axis_jog[i], axis_jog_seen_[i], ready && exists && may_jog_axes(), axis_[i],
             kAxisJog + static_cast<std::int32_t>(i), axis_limit_[i].max_vel, range.low,
             range.high);
  }
}

/// Manual, motion(9), jog-counts: each count moves the target by jog-scale; in velocity mode the target keeps no farther ahead than
/// the way to stop.
template <class Allowed, class RangeOf>
void Controller::turn_wheel(const WheelInputs& in, Wheel& wheel, const Allowed& allowed,
                            AxisMover& mover, double max_vel, double max_acc, double max_jerk,
                            const RangeOf& range_of) noexcept {
  // Unsigned, so that a counter may run over.
  const auto turned = static_cast<std::int32_t>(static_cast<std::uint32_t>(in.counts) -
                                                static_cast<std::uint32_t>(wheel.counts));
  const bool moved = wheel.known && turned != 0;
  wheel.counts = in.counts;
  wheel.known = true;
  if (!moved && !wheel.drives) return;
  max_acc = std::max(max_acc, kLeastAcc);
  if (wheel.drives && !mover.active()) {
    wheel.drives = false;
    mover.set_limits(max_acc, max_jerk);
  }
  // A jog by button goes first.
  if (!moved || !in.enable || (mover.active() && !wheel.drives) || !allowed()) return;
  const double way = turned * in.per_count;
  if (!std::isfinite(way) || way == 0) return;
  const bool fraction = in.accel_fraction > 0 && in.accel_fraction < 1;
  const double acc = fraction ? max_acc * in.accel_fraction : max_acc;
  // Not in the middle of a move, which could then not stop in time.
  if (!wheel.drives) mover.set_limits(acc, max_jerk);
  const double here = mover.position();
  double target = (wheel.drives ? mover.target() : here) + way;
  if (in.velocity_mode) {
    const double ahead = max_jerk > 0 ? stopping_distance(max_vel, RampLimits{acc, max_jerk})
                                      : max_vel * max_vel / (2 * acc);
    target = std::clamp(target, here - ahead, here + ahead);
  }
  // From outside the limits only the way back is open.
  const Range range = range_of();
  if (way > 0) target = std::min(target, std::max(range.high, here));
  if (way < 0) target = std::max(target, std::min(range.low, here));
  mover.go_to(target, max_vel);
  wheel.drives = true;
}

void Controller::take_wheels(const Inputs& in, const Orders& orders) noexcept {
  const Intent& want = *orders.values;
  const bool ready = may_jog(in, orders) && !in.jog_stop && !in.jog_stop_immediate;
  for (std::size_t j = 0; j < joints_; ++j)
    turn_wheel(
        in.joint_wheel[j], joint_wheel_[j],
        [&] { return ready && may_jog_joint(j) && !joint_locked(j); }, joint_[j].mover,
        config_.joint[j].max_vel, config_.joint[j].max_acc, config_.joint[j].max_jerk,
        [&] { return joint_range(j, want); });
  const std::uint32_t axes = kinematics_.axis_mask();
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if ((axes >> i & 1U) == 0) continue;
    turn_wheel(
        in.axis_wheel[i], axis_wheel_[i],
        [&] { return ready && may_jog_axes() && !axis_locked(i); }, axis_[i],
        axis_limit_[i].max_vel, axis_limit_[i].max_acc, axis_limit_[i].max_jerk,
        [&] { return axis_range(i, want); });
  }
}

void Controller::take_jog(const JogIntent& jog, std::uint32_t& seen, bool allowed, AxisMover& mover,
                          std::int32_t index, double speed_limit, double low,
                          double high) noexcept {
  seen = jog.seq;
  using Kind = JogIntent::Kind;
  if (jog.kind == Kind::none) {
    if (!homing_.active()) mover.stop();
    return;
  }
  if (!allowed || !std::isfinite(jog.vel) || !std::isfinite(jog.target)) {
    raise(faults_, Fault::jog_while_not_ready, index);
    return;
  }
  const double speed = std::min(std::abs(jog.vel), speed_limit);
  if (speed <= 0) {
    mover.stop();  // it would never arrive, and the machine never be at rest
    return;
  }
  const double here = mover.position();
  double target = jog.target;
  if (jog.kind == Kind::continuous) target = jog.vel > 0 ? here + kEndlessJog : here - kEndlessJog;
  if (jog.kind == Kind::incremental) target = (mover.active() ? mover.target() : here) + jog.target;
  const bool up = target > here, down = target < here;
  if ((up && here >= high - kAtLimit) || (down && here <= low + kAtLimit)) {
    raise(faults_, Fault::jog_beyond_limit, index, here, up ? high : low);
    return;
  }
  // From outside the limits only the way back is open.
  if (up) target = std::min(target, high);
  if (down) target = std::max(target, low);
  mover.go_to(target, speed);
}

void Controller::move(const Inputs& in, const Orders& orders, double dt) noexcept {
  const Intent& want = *orders.values;
  JointVector feedback{};
  for (std::size_t j = 0; j < joints_; ++j)
    feedback[j] = std::isfinite(joint_[j].pos_fb) ? joint_[j].pos_fb : joint_[j].pos_cmd;
  pose_fb_ = pose_;
  (void)kinematics_.forward(feedback, pose_fb_);
  if (!enabled_) {
    for (std::size_t j = 0; j < joints_; ++j)
      if (!is_posthome(j)) joint_[j].pos_cmd = feedback[j];
    pose_ = pose_fb_ - offsets_.pose();
    kinematics_moved_ = unplaced_ = false;
    guard_.follow(joints_, joint_);
    return;
  }
  if (homing_.module() == nullptr || mode_ == MotionMode::free)
    homing_.step(joints_, joint_, config_, faults_);
  const bool by_axes = mode_ != MotionMode::free;
  offsets_.take(in.offset, by_axes && !closing_down_ && all_homed());
  const std::uint32_t blocked = by_axes ? offsets_.blocked(pose_, pose_before_, dt) : 0;
  pose_before_ = pose_;
  for (std::size_t i = 0; blocked != 0 && i < rtapi::kAxes; ++i)
    if ((blocked >> i & 1U) != 0) axis_[i].stop();
  PathInputs path;
  path.stop = closing_down_ || orders.abort_epoch != acked_epoch_;
  path.stand = orders.hold || path.stop || away_;
  path.single_step = single_step_ = want.single_step;
  path.backwards = want.backwards;
  path.may_move = mode_ == MotionMode::coordinated;
  path.probe = in.probe;
  path.feed_hold = in.feed_hold;
  path.feed_inhibit = in.feed_inhibit || (blocked != 0 && !away_);
  path.feed_override = want.feed_override;
  path.rapid_override = want.rapid_override;
  path.adaptive_feed = in.adaptive_feed;
  path.max_vel_mm_s = want.max_vel_mm_s;
  path.pose_fb = pose_fb_ - offsets_.pose();
  for (std::size_t j = joints_; j-- > 0;)
    if (joint_[j].fb_stale || joint_[j].fb_was_stale)
      path.unseen_joint = static_cast<std::int32_t>(j);
  path.shift = shift_;
  path.spindle = in.spindle;
  path.plan_passes = in.plan_passes;
  for (std::size_t j = 0; j < joints_; ++j) path.unlocked |= joint_[j].is_unlocked ? 1U << j : 0U;
  executor_.step(path, dt, faults_);
  if (mode_ == MotionMode::free) {
    kinematics_moved_ = unplaced_ = false;
    JointVector q{};
    for (std::size_t j = 0; j < joints_; ++j) {
      if (!is_posthome(j)) joint_[j].mover.step(dt);
      q[j] = joint_[j].pos_cmd = joint_[j].mover.position();
    }
    (void)kinematics_.forward(q, pose_);
  } else {
    if (mode_ == MotionMode::coordinated && !away_) {
      pose_ = path_pose();
    } else {
      step_axes(dt);
    }
    if (!plain_kinematics_) pace_offsets();
    const PathSpan* under_way = away_ ? nullptr : executor_.move();
    const Pose offset_before = offsets_.pose();
    offsets_.step(pose_, under_way != nullptr ? under_way->end + shift_ : pose_, dt);
    if (!plain_kinematics_ && may_switch()) look_for_other_equations(pose_before_ + offset_before);
    if (!away_ && shift_leads_out())
      disable();
    else
      move_joints();
  }
  follow_posthome(in, dt);
  // Pins that lead have no jerk limit.
  std::uint32_t led = 0;
  for (std::size_t j = 0; j < joints_; ++j) led |= is_posthome(j) ? 1U << j : 0U;
  // Homing places joints.
  const std::uint32_t may_jump = mode_ == MotionMode::free ? ~0U : led;
  if (!enabled_)  // just now: drives off is no motion
    guard_.follow(joints_, joint_);
  else if (!guard_.check(joints_, joint_, config_, dt, led, may_jump, status_.current, faults_))
    disable();
  const bool on_path = mode_ == MotionMode::coordinated && !away_ && executor_.moving_item() &&
                       !executor_.retraces() && !executor_.follows_spindle();
  if (config_.path_check && on_path)
    path_oracle_.check(programmed_, executor_.pose(), executor_.current_seq(), status_.current,
                       faults_);
  take_up_play(dt);
}

void Controller::step_axes(double dt) noexcept {
  const std::uint32_t move = jogging_axes();
  if (move == 0) return jog_pace_.rest();
  if (plain_kinematics_)
    for (AxisMover& axis : axis_) axis.step(dt);
  else
    step_mixing_axes(dt);
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if ((move >> i & 1U) != 0) pose_[i] = axis_[i].position();
}

/// Kinematics have limits of joints that no axis alone stands for: the axes brake when a stop behind this cycle would lead beyond one of
/// them, or where there is no position.
void Controller::step_mixing_axes(double dt) noexcept {
  JogPace::Machine machine{kinematics_, config_.joint, mixed_share_, {}, offsets_.pose()};
  for (std::size_t j = 0; j < joints_; ++j) machine.near[j] = joint_[j].pos_cmd - skew_[j];
  const JogPace::Movers axis_before = axis_;
  const JogPace pace_before = jog_pace_;
  for (const bool faster : {true, false}) {
    jog_pace_.step(axis_, pose_, machine, dt, faster);
    const StopBehind stop = stop_from_here(jog_pace_.scale() * dt);
    if (stop == StopBehind::inside) return;
    axis_ = axis_before;
    jog_pace_ = pace_before;
    // To the edge of the workspace nothing goes as near as it can: joints have no end of speed there.
    if (stop == StopBehind::nowhere) break;
  }
  for (AxisMover& axis : axis_) axis.stop();
  jog_pace_.step(axis_, pose_, machine, dt);
}

/// A stop of all jogs from now on stays where there are positions, and within the limits of the joints; from outside a limit the
/// way back is open. `cycle_s`: what the movers' time went on in this cycle.
Controller::StopBehind Controller::stop_from_here(double cycle_s) const noexcept {
  JogPace::Movers axis = axis_;
  double longest_s = 0;
  for (AxisMover& mover : axis) {
    if (!mover.active()) continue;
    mover.stop();
    longest_s = std::max(longest_s, mover.rest_time());
  }
  const double part_s = longest_s / kPartsOfStop;
  std::array<JointVector, kPartsOfStop + 1> q;
  for (std::size_t part = 0; part <= kPartsOfStop; ++part) {
    Pose at = pose_;
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if (!axis_[i].active() && axis_[i].position() == pose_[i]) continue;
      at[i] = axis[i].position();
      axis[i].step(part_s);
    }
    q[part] = part > 0 ? q[part - 1] : JointVector{};
    for (std::size_t j = 0; j < joints_ && part == 0; ++j) q[0][j] = joint_[j].pos_cmd - skew_[j];
    if (!kinematics_.inverse(at + offsets_.pose(), q[part])) return StopBehind::nowhere;
  }
  for (std::size_t j = 0; j < joints_; ++j) {
    if (is_posthome(j) || !joint_[j].homed) continue;
    double least = q[0][j], most = q[0][j];
    // Where it turns before the first of them.
    const double speed = (q[0][j] - (joint_[j].pos_cmd - skew_[j])) * part_s / cycle_s;
    const double first = q[1][j] - q[0][j];
    if (std::abs(speed) > kAtLimit && first / speed < 0.5) {
      const double beyond = kBetween * speed * speed / (4 * (speed - first));
      (speed > 0 ? most : least) += beyond;
    }
    for (std::size_t part = 1; part <= kPartsOfStop; ++part) {
      const double here = q[part][j], came = here - q[part - 1][j];
      const double goes = part < kPartsOfStop ? q[part + 1][j] - here : 0;
      // Where it turns between two of them it goes farther than both: an eighth of the second difference.
      const bool turns = came * goes < 0 && std::abs(came) > kAtLimit && std::abs(goes) > kAtLimit;
      const double beyond = turns ? kBetween / 8 * std::abs(goes - came) : 0;
      least = std::min(least, came < 0 ? here - beyond : here);
      most = std::max(most, came > 0 ? here + beyond : here);
    }
    const double now = joint_[j].pos_cmd;
    const JointConfig& c = config_.joint[j];
    if (most + skew_[j] > std::max(c.max_limit, now)) return StopBehind::beyond;
    if (least + skew_[j] < std::min(c.min_limit, now)) return StopBehind::beyond;
  }
  return StopBehind::inside;
}

/// motion(9), "JOINT posthome pins". The pin's planner (limit3, simple_tp) is followed exactly while it keeps to the joint's limits; a pin
/// that jumps, or was elsewhere while the machine was off, is caught up with at the joint's own speed and acceleration.
void Controller::follow_posthome(const Inputs& in, double dt) noexcept {
  for (std::size_t j = joints_ - std::min(static_cast<std::size_t>(status_.extra_joints), joints_);
       j < joints_; ++j) {
    if (!is_posthome(j)) continue;
    Joint& joint = joint_[j];
    const JointConfig& c = config_.joint[j];
    if (!std::isfinite(in.joint[j].posthome_cmd)) continue;
    const double wanted =
        std::clamp(in.joint[j].posthome_cmd, std::min(c.min_limit, c.max_limit), c.max_limit);
    const double vel = (wanted - joint.pos_cmd) / dt;
    constexpr double kAllowance = 1 + 1e-6;
    const bool can = std::abs(vel) <= c.max_vel * kAllowance &&
                     std::abs(vel - joint.last_vel) <= c.max_acc * dt * kAllowance;
    if (can) {
      joint.mover.place(wanted);
    } else {
      if (!joint.mover.active()) joint.mover.start_at(joint.pos_cmd, joint.last_vel);
      joint.mover.go_to(wanted, c.max_vel);
      joint.mover.step(dt);
    }
    joint.pos_cmd = joint.mover.position();
  }
}

/// On top of the joint's own motion, so it gets the half of its limits that drives must have in reserve for it (LinuxCNC
/// manual, BACKLASH: step generators need 1.5 to 2 times the joint's acceleration).
void Controller::take_up_play(double dt) noexcept {
  constexpr double kShare = 0.5;
  constexpr double kStill =
      1e-6;  ///< speed that is rounding of the kinematics, not a direction (mm/s)
  for (std::size_t j = 0; j < joints_; ++j) {
    Joint& joint = joint_[j];
    const JointConfig& c = config_.joint[j];
    if (std::abs(joint.vel_cmd) > kStill) joint.direction = joint.vel_cmd > 0 ? 1 : -1;
    double wanted = 0.5 * joint.direction * c.backlash;
    // Before a joint is homed nobody knows its place on the screw, and home would depend on where it was.
    if (screws_ != nullptr && screws_[j].count > 0)
      wanted = joint.homed ? screw_correction(screws_[j], joint.pos_cmd, joint.direction) : 0.0;
    if (wanted != joint.backlash.target() || joint.backlash.active()) {
      joint.backlash.set_limits(std::max(kShare * c.max_acc, 1e-6), kShare * c.max_jerk);
      joint.backlash.go_to(wanted, kShare * c.max_vel);
      joint.backlash.step(dt);
    }
  }
}

void Controller::pace_offsets() noexcept {
  const auto used = offsets_.in_use();
  if (std::none_of(used.begin(), used.end(), [](const auto& o) { return o.vel > 0; })) return;
  OffsetPace::Machine machine{kinematics_, config_.joint, axis_limit_, 1 - mixed_share_, {}};
  for (std::size_t j = 0; j < joints_; ++j) machine.near[j] = joint_[j].pos_cmd - skew_[j];
  offsets_.set_pace(OffsetPace::at(pose_ + offsets_.pose(), used, machine));
}

/// The kinematics may know the length of the tool, by a net from motion.tooloffset.z: they have it in the next cycle.
void Controller::watch_tool_offset() noexcept {
  constexpr int kCycles = 3;
  const Pose& offset = executor_.tool_offset();
  if (offset != offset_before_)
    offset_told_ = plain_kinematics_ ? 0 : kCycles;
  else
    offset_told_ = std::max(offset_told_ - 1, 0);
  offset_before_ = offset;
}

/// Other equations must not throw the machine to where its position is by them. `was`: where it stood in the last cycle. An offset may be
/// moving, and goes on beside what the joints are elsewhere by.
void Controller::look_for_other_equations(const Pose& was) noexcept {
  JointVector q{};
  for (std::size_t j = 0; j < joints_; ++j) q[j] = joint_[j].pos_cmd - skew_[j];
  if (!kinematics_.inverse(was, q)) return;
  double farthest = 0;
  for (std::size_t j = 0; j < joints_; ++j)
    farthest = std::max(farthest, std::abs(joint_[j].pos_cmd - skew_[j] - q[j]));
  if (!(farthest > kOtherPlace)) return;
  kinematics_moved_ = true;
  for (std::size_t j = 0; j < joints_; ++j) skew_[j] = joint_[j].pos_cmd - q[j];
}

void Controller::move_joints() noexcept {
  JointVector q{};
  for (std::size_t j = 0; j < joints_; ++j) q[j] = joint_[j].pos_cmd - skew_[j];
  if (unplaced_ || !kinematics_.inverse(pose_ + offsets_.pose(), q)) {
    unplaced_ = false;
    raise(faults_, Fault::no_inverse, -1, 0, 0, status_.current);
    disable();
    return;
  }
  for (std::size_t j = 0; j < joints_; ++j) joint_[j].pos_cmd = q[j] + skew_[j];
}

}  // namespace kerf::motion
