// Power, safety and the order of things in a cycle.
#include "motion/core/controller.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "motion/core/planner/ceilings.hpp"

namespace kerf::motion {
namespace {
/// Below this a joint's distance from what the inverse kinematics say is rounding (mm, degrees).
constexpr double kSameJoint = 1e-9;
}  // namespace

Controller::Controller(const Kinematics& kinematics, SpanRing& spans, const PlanSlots& slots,
                       FaultRing& planner_faults, std::int32_t joints,
                       std::int32_t spindles) noexcept
    : kinematics_(kinematics),
      spans_(spans),
      planner_faults_(planner_faults),
      joints_(
          static_cast<std::size_t>(std::clamp(joints, 0, static_cast<std::int32_t>(kMaxJoints)))),
      spindle_count_(static_cast<std::size_t>(
          std::clamp(spindles, 0, static_cast<std::int32_t>(kMaxSpindles)))),
      executor_(spans, slots, spindles_, outputs_),
      programmed_(slots.programmed) {}

/// An axis without a jerk limit takes as long to its acceleration as the slowest joint that it moves with others.
void Controller::bring_up_slowly() noexcept {
  double rise_s = 0;
  for (std::size_t j = 0; j < joints_; ++j) {
    const JointConfig& c = config_.joint[j];
    if (c.max_jerk > 0 && kinematics_.axis_of_joint(static_cast<std::int32_t>(j)) < 0)
      rise_s = std::max(rise_s, c.max_acc / c.max_jerk);
  }
  for (AxisConfig& limit : axis_limit_)
    if (rise_s > 0 && !(limit.max_jerk > 0)) limit.max_jerk = limit.max_acc / rise_s;
}

void Controller::configure(const MachineConfig& config) noexcept {
  const bool first = !configured_;
  config_ = config;
  start_due_ = !start_taken_;
  configured_ = true;
  if (first) apply_safe_outputs();
  executor_.configure(config.max_feed_override, config.adaptive_only_slows,
                      config.adaptive_reverses, path_limits_of(kinematics_, config).axes);
  spindles_.configure(config, static_cast<std::int32_t>(spindle_count_));
  for (std::size_t j = 0; j < joints_; ++j)
    joint_[j].mover.set_limits(std::max(config.joint[j].max_acc, 1e-6), config.joint[j].max_jerk);
  plain_kinematics_ = true;
  for (std::size_t j = 0; j + static_cast<std::size_t>(status_.extra_joints) < joints_; ++j)
    plain_kinematics_ =
        plain_kinematics_ && kinematics_.axis_of_joint(static_cast<std::int32_t>(j)) >= 0;
  locks_ = false;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    locks_ = locks_ || config.axis[i].locking_joint >= 0;
    AxisConfig& limit = axis_limit_[i] = config.axis[i];
    for (std::size_t j = 0; j < joints_; ++j) {
      if (kinematics_.axis_of_joint(static_cast<std::int32_t>(j)) != static_cast<std::int32_t>(i))
        continue;
      const JointConfig& c = config.joint[j];
      limit.max_vel = std::min(limit.max_vel, c.max_vel);
      limit.max_acc = std::min(limit.max_acc, c.max_acc);
      limit.max_jerk = least_jerk(limit.max_jerk, c.max_jerk);
      limit.min_limit = std::max(limit.min_limit, c.min_limit);
      limit.max_limit = std::min(limit.max_limit, c.max_limit);
    }
  }
  if (!plain_kinematics_) bring_up_slowly();
  mixed_share_ = share_beside_offsets(config, axes_of(kinematics_.axis_mask(), config));
  offsets_.configure(axis_limit_, kinematics_.axis_mask());
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    AxisConfig& limit = axis_limit_[i];
    const double rest = 1 - limit.offset_av_ratio;
    limit.max_vel *= rest;
    limit.max_acc *= rest;
    limit.max_jerk *= rest;
    axis_[i].set_limits(std::max(limit.max_acc, 1e-6), limit.max_jerk);
  }
}

void Controller::adopt(const MachineConfig& config) noexcept {
  if (!configured_) return;
  for (std::size_t j = 0; j < joints_; ++j) {
    const JointConfig& from = config.joint[j];
    JointConfig& to = config_.joint[j];
    to.ferror = from.ferror;
    to.min_ferror = from.min_ferror;
    to.backlash = from.backlash;
    if (homing_.active()) continue;  // its phases agreed on the old ones
    to.home = from.home;
    to.home_offset = from.home_offset;
    to.home_sequence = from.home_sequence;
  }
}

bool Controller::at_rest() const noexcept {
  if (!executor_.at_rest()) return false;
  for (std::size_t j = 0; j < joints_; ++j) {
    if (joint_[j].mover.active() && !is_posthome(j)) return false;
  }
  return jogging_axes() == 0;
}

void Controller::step(const Inputs& in, const Orders& orders, double dt,
                      std::int64_t now_ns) noexcept {
  faults_.clear();
  spindles_.begin_cycle();
  if (refused_.why != 0) raise(faults_, Fault::kinematics_refused, -1, refused_.kind, refused_.why);
  refused_ = {};
  while (const FaultRecord* record = planner_faults_.front()) {
    if (!faults_.push_back(*record)) break;
    planner_faults_.pop();
  }
  read_feedback(in);
  if (start_due_) take_start_positions();
  watch_overrun(in, dt);
  watch_feedback();
  watch_heartbeat(orders, dt);
  switch_power(in, orders);
  take_requests(orders);
  stop_everything(orders);
  switch_mode(orders);
  watch_away(orders);
  take_shift(orders);
  watch_jog_stop(in);
  watch_probe(in);
  watch_locks();
  take_wheels(in, orders);
  take_homing(in, orders);
  take_jogs(in, orders);
  move(in, orders, dt);
  finish_abort(orders);
  double factors[kMaxSpindles];
  for (std::size_t n = 0; n < spindle_count_; ++n)
    factors[n] =
        executor_.enables().spindle[n] ? std::max(orders.values->spindle_override[n], 0.0) : 1.0;
  spindles_.step(in.spindle, factors,
                 pose_.x + offsets_.pose().x - executor_.tool_offset().x - shift_.x, faults_);
  for (FaultRecord& record : faults_) {
    record.number = ++fault_number_;
    record.time_ns = now_ns;
  }
  watch_tool_offset();
  fill_status(in, orders, dt, now_ns);
  note_changes();
}

void Controller::read_feedback(const Inputs& in) noexcept {
  for (std::size_t j = 0; j < joints_; ++j) {
    Joint& joint = joint_[j];
    const JointInputs& source = in.joint[j];
    read_position(joint, source);
    joint.pos_fb = joint.motor_pos_fb - joint.motor_offset - joint.backlash.position();
    joint.home_switch = source.home_switch;
    joint.neg_limit = source.neg_limit;
    joint.pos_limit = source.pos_limit;
    joint.amp_fault = source.amp_fault;
    joint.is_unlocked = source.is_unlocked;
    joint.index_enable = source.index_enable;
    joint.index_order = 0;
    if (homing_.module() == nullptr) homing_.watch_index(j, joint, config_.joint[j]);
  }
  homing_.look_at_module(joints_, joint_);
}

/// What cannot be read is where it would be if the motor goes on following as it did.
void Controller::read_position(Joint& joint, const JointInputs& source) noexcept {
  const double command = joint.pos_cmd + joint.motor_offset + joint.backlash.position();
  joint.fb_was_stale = joint.fb_stale;
  joint.fb_stale = source.fb_stale;
  if (joint.fb_stale) {
    ++joint.fb_lost;
    if (joint.fb_known && enabled_) joint.motor_pos_fb = command - joint.lag;
    if (joint.fb_known) return;
  }
  joint.fb_known = joint.fb_known || !joint.fb_stale;
  joint.motor_pos_fb = source.motor_pos_fb;
  joint.lag = command - joint.motor_pos_fb;
}

/// Some cycles without feedback are the price of some links; more of them, and the machine stops while it still knows where it is.
void Controller::watch_feedback() noexcept {
  for (std::size_t j = 0; j < joints_; ++j) {
    lost_[j].note(joint_[j].fb_stale);
    const std::int32_t lost = lost_[j].count();
    if (!enabled_ || closing_down_ || is_posthome(j) || lost <= config_.stale_cycles) continue;
    raise(faults_, Fault::stale_feedback, static_cast<std::int32_t>(j), lost, config_.stale_cycles,
          status_.current);
    joint_[j].error = true;
    closing_down_ = true;
  }
}

/// The motors stand where they stand; what joints call that place is what they called it when the machine went off.
void Controller::take_start_positions() noexcept {
  start_due_ = false;
  for (std::size_t j = 0; j < joints_; ++j) {
    const JointConfig& c = config_.joint[j];
    if (!c.has_start || !std::isfinite(joint_[j].pos_fb)) continue;
    joint_[j].shift(c.start - joint_[j].pos_fb);
    start_taken_ = true;
  }
}

void Controller::watch_heartbeat(const Orders& orders, double dt) noexcept {
  if (!enabled_ || orders.heartbeat != heartbeat_) {
    heartbeat_ = orders.heartbeat;
    heartbeat_age_s_ = 0;
    return;
  }
  heartbeat_age_s_ += dt;
  if (closing_down_ || heartbeat_age_s_ <= config_.heartbeat_timeout_s) return;
  raise(faults_, Fault::heartbeat_lost, -1, heartbeat_age_s_, config_.heartbeat_timeout_s,
        status_.current);
  closing_down_ = true;
  if (config_.lost_heartbeat_is_off) disable();
}

/// A cycle that came late was a gap in what the drives were told. What it cost is over; what is left is to stop before the next.
void Controller::watch_overrun(const Inputs& in, double dt) noexcept {
  const double limit_s = config_.overrun_periods * dt;
  if (config_.overrun == OverrunPolicy::warn || !enabled_ || in.since_last_s <= limit_s) return;
  raise(faults_, Fault::overrun, -1, in.since_last_s * 1e3, limit_s * 1e3, status_.current);
  if (config_.overrun == OverrunPolicy::estop) disable();
}

void Controller::switch_power(const Inputs& in, const Orders& orders) noexcept {
  if (!orders.enable) {
    armed_ = true;
    if (enabled_) disable();
    return;
  }
  // Off and on again between two cycles: the off counts too.
  if (orders.enable_request != enable_request_) {
    enable_request_ = orders.enable_request;
    armed_ = true;
    if (enabled_) {
      disable();
      return;  // the drives see it for a cycle
    }
  }
  if (enabled_) {
    if (machine_fault(in, orders) || (closing_down_ && at_rest() && offsets_.at_rest())) disable();
    return;
  }
  if (!armed_ || !configured_) return;
  armed_ = false;  // whatever comes of it, the next try needs a new request
  if (may_enable(in, orders)) enable();
}

bool Controller::may_enable(const Inputs& in, const Orders& orders) noexcept {
  if (machine_fault(in, orders)) return false;
  // Where it stands must be seen; how often it was lost before counts no more.
  for (std::size_t j = 0; j < joints_; ++j) {
    if (!joint_[j].fb_stale || is_posthome(j)) continue;
    raise(faults_, Fault::stale_feedback, static_cast<std::int32_t>(j), lost_[j].count(),
          config_.stale_cycles);
    joint_[j].error = true;
    return false;
  }
  return true;
}

bool Controller::machine_fault(const Inputs& in, const Orders& orders) noexcept {
  if (!in.enable) {
    raise(faults_, Fault::enable_lost, -1, 0, 0, status_.current);
    return true;
  }
  if (in.misc_errors != 0) {
    raise(faults_, Fault::amp_fault, -1, std::countr_zero(in.misc_errors), 0, status_.current);
    return true;
  }
  for (std::size_t n = 0; n < spindle_count_; ++n) {
    if (!in.spindle[n].amp_fault) continue;
    raise(faults_, Fault::spindle_fault, static_cast<std::int32_t>(n), 0, 0, status_.current);
    return true;
  }
  bool any = false;
  for (std::size_t j = 0; j < joints_; ++j) any = joint_fault(j, orders) || any;
  return any;
}

bool Controller::joint_fault(std::size_t j, const Orders& orders) noexcept {
  Joint& joint = joint_[j];
  const JointConfig& c = config_.joint[j];
  const auto index = static_cast<std::int32_t>(j);
  joint.faulted = joint.amp_fault;
  if (joint.amp_fault) {
    raise(faults_, Fault::amp_fault, index, 0, 0, status_.current);
    return joint.error = true;
  }
  // Overriding is for jogging off a switch: it never opens the limits to the path or to homing.
  const bool over =
      orders.values->override_limits && !homing_.active() && mode_ != MotionMode::coordinated;
  if (!joint.ignore_limits && !over && (joint.neg_limit || joint.pos_limit)) {
    raise(faults_, joint.neg_limit ? Fault::joint_hard_limit_min : Fault::joint_hard_limit_max,
          index, joint.pos_fb, 0, status_.current);
    return joint.error = true;
  }
  // A position that is no number compares with nothing: neither the limits below nor the drive would notice it.
  if (!std::isfinite(joint.pos_fb)) {
    raise(faults_, Fault::following_error, index, joint.pos_fb, c.ferror, status_.current);
    joint.ferrored = true;
    return joint.error = true;
  }
  // The feedback of an extra joint counts while it homes, and no more.
  if (!enabled_ || is_posthome(j)) return false;
  // Manual, FERROR: the limit grows with the speed, from MIN_FERROR to FERROR at the joint's full speed.
  joint.ferror = joint.pos_cmd - joint.pos_fb;
  joint.ferror_high = std::max(joint.ferror_high, std::abs(joint.ferror));
  joint.ferror_limit =
      c.min_ferror < c.ferror
          ? std::max(c.min_ferror, c.ferror * std::min(std::abs(joint.vel_cmd) / c.max_vel, 1.0))
          : c.ferror;
  if (std::abs(joint.ferror) <= joint.ferror_limit) return false;
  raise(faults_, Fault::following_error, index, joint.ferror, joint.ferror_limit, status_.current);
  joint.ferrored = true;
  return joint.error = true;
}

bool Controller::has_position() const noexcept {
  JointVector q{};
  for (std::size_t j = 0; j < joints_; ++j) q[j] = joint_[j].pos_cmd;
  Pose pose = pose_;
  return kinematics_.forward(q, pose) && kinematics_.inverse(pose, q);
}

bool Controller::switch_kinematics(Kinematics& kinematics, std::int32_t kind) noexcept {
  constexpr std::int32_t kNoSuchKind = 1, kNoPosition = 2;
  const std::int32_t before = kinematics.kind();
  if (!kinematics.switch_to(kind)) {
    refused_ = {kind, kNoSuchKind};
    return false;
  }
  // In joint mode the joints need no position; who leaves it is asked again.
  if (mode_ != MotionMode::free && !has_position()) {
    (void)kinematics.switch_to(before);
    refused_ = {kind, kNoPosition};
    return false;
  }
  (void)settle();
  return true;
}

bool Controller::settle() noexcept {
  JointVector q{};
  for (std::size_t j = 0; j < joints_; ++j) {
    joint_[j].mover.place(joint_[j].pos_cmd);
    q[j] = joint_[j].pos_cmd;
  }
  const bool placed = kinematics_.forward(q, pose_);
  // What the pose cannot say: a joint of a gantry that stands beside its partner stays beside it.
  JointVector back = q;
  const bool known = kinematics_.inverse(pose_, back);
  for (std::size_t j = 0; j < joints_; ++j) {
    const double skew = q[j] - back[j];
    skew_[j] = known && std::abs(skew) > kSameJoint ? skew : 0.0;
  }
  pose_ = pose_ - offsets_.pose();
  pose_before_ = pose_;
  kinematics_moved_ = false;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) axis_[i].place(pose_[i]);
  jog_pace_.rest();
  fold_shift();
  executor_.place(pose_);
  return placed && known;
}

void Controller::enable() noexcept {
  enabled_ = true;
  closing_down_ = false;
  heartbeat_age_s_ = 0;
  for (std::size_t j = 0; j < joints_; ++j) {
    Joint& joint = joint_[j];
    if (!is_posthome(j)) joint.pos_cmd = joint.pos_fb;
    joint.error = joint.ferrored = joint.faulted = false;
    joint.ferror = joint.ferror_high = 0;
    joint.lag = 0;
    lost_[j].begin(config_.stale_window);
  }
  offsets_.reset();
  if (!settle()) mode_ = MotionMode::free;
  guard_.reset(joints_, joint_);
  path_oracle_.reset();
}

void Controller::apply_safe_outputs() noexcept {
  const SafeOutputs& safe = config_.safe;
  outputs_.digital = (outputs_.digital & ~safe.digital_mask) | (safe.digital & safe.digital_mask);
  for (std::size_t i = 0; i < kMaxAnalog; ++i)
    if ((safe.analog_mask >> i & 1U) != 0) outputs_.analog[i] = safe.analog[i];
}

void Controller::disable() noexcept {
  enabled_ = false;
  apply_safe_outputs();
  closing_down_ = false;
  homing_.stop(joints_, joint_);
  spindles_.stop_all();
  executor_.void_epoch(std::max(acked_epoch_, std::uint32_t{1}));
  fold_shift();
  away_ = false;
  for (std::size_t j = 0; j < joints_; ++j) {
    joint_[j].mover.place(joint_[j].pos_cmd);
    joint_[j].ignore_limits = joint_[j].unlock = false;
    if (config_.joint[j].volatile_home) joint_[j].homed = false;
  }
  if (homing_.module() != nullptr) homing_.module()->unhome(-2, false, mode_);
  for (AxisMover& axis : axis_) axis.place(axis.position());
  offsets_.stop_dead();
}

void Controller::take_requests(const Orders& orders) noexcept {
  const Intent& want = *orders.values;
  for (std::size_t n = 0; n < spindle_count_; ++n) {
    if (want.spindle_stop_seq[n] == spindle_stop_seen_[n]) continue;
    spindle_stop_seen_[n] = want.spindle_stop_seq[n];
    spindles_.stop(static_cast<std::int32_t>(n));
  }
  if (want.wishes != wishes_seen_) take_wishes(want);
  if (want.unhome_seq != unhome_seen_) {
    unhome_seen_ = want.unhome_seq;
    take_unhome(want.unhome_joint);
  }
}

void Controller::take_wishes(const Intent& want) noexcept {
  wishes_seen_ = want.wishes;
  const auto fresh = [](const auto& wish, std::uint32_t& seen) {
    if (wish.seq == seen) return false;
    seen = wish.seq;
    return true;
  };
  for (std::size_t i = 0; i < kMaxDigital; ++i) {
    if (!fresh(want.digital_out[i], seen_.digital_out[i])) continue;
    const std::uint64_t bit = std::uint64_t{1} << i;
    outputs_.digital = want.digital_out[i].value ? outputs_.digital | bit : outputs_.digital & ~bit;
  }
  for (std::size_t i = 0; i < kMaxAnalog; ++i) {
    if (fresh(want.analog_out[i], seen_.analog_out[i]))
      outputs_.analog[i] = want.analog_out[i].value;
  }
  OverrideEnable enables = executor_.enables();
  if (fresh(want.feed_override_enable, seen_.feed)) enables.feed = want.feed_override_enable.value;
  if (fresh(want.adaptive_feed_enable, seen_.adaptive))
    enables.adaptive = want.adaptive_feed_enable.value;
  if (fresh(want.feed_hold_enable, seen_.feed_hold))
    enables.feed_hold = want.feed_hold_enable.value;
  for (std::size_t n = 0; n < kMaxSpindles; ++n) {
    if (fresh(want.spindle_override_enable[n], seen_.spindle[n]))
      enables.spindle[n] = want.spindle_override_enable[n].value;
    if (fresh(want.brake[n], seen_.brake[n]))
      spindles_.brake(static_cast<std::int32_t>(n), want.brake[n].value);
    // Never of a machine that stops or is off.
    if (fresh(want.spindle_restart[n], seen_.restart[n]) && enabled_ && !closing_down_)
      spindles_.restart(static_cast<std::int32_t>(n), want.spindle_restart[n].value);
  }
  executor_.set_enables(enables);
}

/// Abort: stop where we are; then finish_abort() forgets all that is older and says so.
void Controller::stop_everything(const Orders& orders) noexcept {
  const bool abort = orders.abort_epoch != acked_epoch_;
  if (!abort && !closing_down_) return;
  homing_.stop(joints_, joint_);
  for (std::size_t j = 0; j < joints_; ++j) joint_[j].mover.stop();
  for (AxisMover& axis : axis_) axis.stop();
  // An abort stops what the program and jogs do; offsets follow their pins.
  if (closing_down_) offsets_.stop();
}

void Controller::finish_abort(const Orders& orders) noexcept {
  if (orders.abort_epoch == acked_epoch_ || !at_rest()) return;
  executor_.drop_before(orders.abort_epoch);
  fold_shift();
  if (away_) executor_.place(pose_);
  away_ = false;
  spindles_.abort_orient();
  acked_epoch_ = orders.abort_epoch;
}

ServoView Controller::view() const noexcept {
  ServoView v;
  fill(v);
  return v;
}

void Controller::fill(ServoView& v) const noexcept {
  v.acked_epoch = acked_epoch_;
  v.void_epoch = executor_.voided();
  v.executed_seq = executor_.executed_seq();
  v.place = executor_.place_number();
  v.pose = executor_.pose();
  v.shift = shift_;
  for (std::size_t j = 0; j < joints_; ++j) {
    v.skew[j] = skew_[j];
    v.joint[j] = joint_[j].pos_cmd - skew_[j];
  }
  v.scale = executor_.scale();
  v.law = executor_.law_place();
  v.cycle = status_.cycle;
  v.single_step = single_step_;
  v.takes_moves = enabled_ && mode_ == MotionMode::coordinated;
}

}  // namespace kerf::motion
