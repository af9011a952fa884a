#include "motion/core/homing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kerf::motion {
namespace {

constexpr std::int32_t kNoGroup = -1;
constexpr double kLeastAcc = 1e-6;  ///< movers divide by it

bool has_sequence(const JointConfig& c) noexcept { return c.home_sequence != kNoHomeSequence; }
bool has(const JointConfig& c, HomeFlag flag) noexcept { return (c.home_flags & flag) != 0; }

/// The lowest |sequence| of at least `from`, or kNoGroup.
std::int32_t next_group(std::size_t joints, const MachineConfig& config,
                        std::int32_t from) noexcept {
  std::int32_t best = kNoGroup;
  for (std::size_t j = 0; j < joints; ++j) {
    if (!has_sequence(config.joint[j])) continue;
    const std::int32_t group = std::abs(config.joint[j].home_sequence);
    if (group >= from && (best == kNoGroup || group < best)) best = group;
  }
  return best;
}

/// Bound of a search: the INI's, else twice the joint's travel.
double search_bound(const JointConfig& c) noexcept {
  if (c.home_search_dist > 0) return c.home_search_dist;
  return 2.0 * std::min(c.max_limit - c.min_limit, 1e6);
}
double latch_bound(const JointConfig& c) noexcept {
  return c.home_latch_dist > 0 ? c.home_latch_dist : search_bound(c);
}

double final_speed(const JointConfig& c) noexcept {
  return c.home_final_vel > 0 ? std::min(c.home_final_vel, c.max_vel) : c.max_vel;
}

bool same_direction(const JointConfig& c) noexcept {
  return (c.home_search_vel > 0) == (c.home_latch_vel > 0);
}

/// The order of phases, for those who wait for each other.
int rank(std::int32_t state) noexcept {
  switch (state) {
    case Homing::wait_unlock: return 0;
    case Homing::backoff_first: return 1;
    case Homing::search: return 2;
    case Homing::backoff_final: return 3;
    case Homing::latch:
    case Homing::index_search:
    case Homing::latch_stop: return 4;
    default: return 5;
  }
}

}  // namespace

void Homing::fail(std::size_t j, Fault fault, double value, FaultList& faults,
                  double limit) noexcept {
  // The first one tells the story.
  if (!failed_) raise(faults, fault, static_cast<std::int32_t>(j), value, limit);
  failed_ = true;
}

bool Homing::is_member(std::size_t j, const MachineConfig& config) const noexcept {
  const JointConfig& c = config.joint[j];
  return single_ >= 0 ? static_cast<std::int32_t>(j) == single_
                      : has_sequence(c) && std::abs(c.home_sequence) == sequence_;
}

void Homing::start(std::int32_t joint, std::size_t joints, Joint* state,
                   const MachineConfig& config, const Kinematics& kinematics,
                   FaultList& faults) noexcept {
  if (module_ != nullptr) {
    module_->start(joint);
    active_ = module_->active();
    return;
  }
  failed_ = false;
  single_ = -1;
  all_ = joint < 0;
  if (all_) {
    sequence_ = next_group(joints, config, 0);
    if (sequence_ == kNoGroup) {
      raise(faults, Fault::home_failed, -1, static_cast<double>(HomeFailure::nothing_to_home));
      return;
    }
    if (sequence_ > 1) {
      raise(faults, Fault::home_failed, -1, static_cast<double>(HomeFailure::sequence_gap),
            sequence_);
      return;
    }
  } else {
    if (static_cast<std::size_t>(joint) >= joints) {
      raise(faults, Fault::home_failed, joint, static_cast<double>(HomeFailure::no_such_joint));
      return;
    }
    const JointConfig& c = config.joint[joint];
    if (has_sequence(c) && c.home_sequence < 0)
      sequence_ = -c.home_sequence;
    else
      single_ = joint;
  }
  if (!possible(joints, config, faults)) return;
  for (std::size_t j = 0; j < joints; ++j)
    axis_[j] = kinematics.axis_of_joint(static_cast<std::int32_t>(j));
  active_ = true;
  begin_group(joints, state, config, faults);
}

/// What the INI file cannot mean is said before anything moves.
bool Homing::possible(std::size_t joints, const MachineConfig& config,
                      FaultList& faults) const noexcept {
  for (std::size_t j = 0; j < joints; ++j) {
    const JointConfig& c = config.joint[j];
    if (!(all_ ? has_sequence(c) : is_member(j, config))) continue;
    if (has(c, home_absolute_encoder)) continue;
    const bool index = has(c, home_use_index);
    HomeFailure why{};
    if (c.home_search_vel != 0 && c.home_latch_vel == 0)
      why = HomeFailure::latch_vel_zero;
    else if (index && c.home_latch_vel == 0)
      why = HomeFailure::index_without_vel;
    else if (!index && c.home_search_vel == 0 && c.home_latch_vel != 0)
      why = HomeFailure::latch_alone;
    else
      continue;
    raise(faults, Fault::home_failed, static_cast<std::int32_t>(j), static_cast<double>(why));
    return false;
  }
  return true;
}

void Homing::begin_group(std::size_t joints, Joint* state, const MachineConfig& config,
                         FaultList& faults) noexcept {
  together_ = false;
  bool any = false;
  const auto meant = [&](std::size_t j) {
    // An absolute encoder that is homed keeps its home.
    return is_member(j, config) && !(has(config.joint[j], home_no_rehome) && state[j].homed);
  };
  for (std::size_t j = 0; j < joints; ++j) {
    if (!meant(j)) continue;
    const JointConfig& c = config.joint[j];
    if (single_ < 0 && c.home_sequence < 0) together_ = true;
    if (has(c, home_is_shared) && !has(c, home_absolute_encoder) && c.home_search_vel != 0 &&
        state[j].home_switch)
      fail(j, Fault::home_failed, static_cast<double>(HomeFailure::switch_closed), faults);
  }
  if (failed_) return stop(joints, state);
  for (std::size_t j = 0; j < joints; ++j) {
    if (!meant(j)) continue;
    state[j].homed = false;
    state[j].homing = any = true;
  }
  find_partners(joints, state, config);
  for (std::size_t j = 0; j < joints; ++j)
    if (state[j].homing) begin_joint(j, state, config);
  if (!any && !all_) active_ = false;
}

void Homing::find_partners(std::size_t joints, const Joint* state,
                           const MachineConfig& config) noexcept {
  for (std::size_t j = 0; j < joints; ++j) {
    Leg& leg = leg_[j] = Leg{};
    leg.partners = 1U << j;
    if (!together_ || !state[j].homing || axis_[j] < 0) continue;
    for (std::size_t p = 0; p < joints; ++p) {
      if (state[p].homing && axis_[p] == axis_[j] && !has(config.joint[p], home_absolute_encoder))
        leg.partners |= 1U << p;
    }
  }
}

void Homing::begin_joint(std::size_t j, Joint* state, const MachineConfig& config) noexcept {
  Joint& joint = state[j];
  joint.ignore_limits = has(config.joint[j], home_ignore_limits);
  joint.mover.place(joint.pos_cmd);
  // Legs brake alike.
  double acc = config.joint[j].max_acc, jerk = config.joint[j].max_jerk;
  for_partners(j, [&](std::size_t p) {
    acc = std::min(acc, config.joint[p].max_acc);
    jerk = least_jerk(jerk, config.joint[p].max_jerk);
  });
  joint.mover.set_limits(std::max(acc, kLeastAcc), jerk);
  if (has(config.joint[j], home_unlock_first)) {
    joint.unlock = true;
    joint.home_state = wait_unlock;
    return;
  }
  begin_moving(j, state, config);
}

/// The first phase that the joint needs.
void Homing::begin_moving(std::size_t j, Joint* state, const MachineConfig& config) noexcept {
  Joint& joint = state[j];
  const JointConfig& c = config.joint[j];
  leg_[j].ready = false;
  if (has(c, home_absolute_encoder) || (c.home_search_vel == 0 && c.home_latch_vel == 0)) {
    joint.shift(c.home_offset - joint.pos_cmd);
    joint.home_state = wait_sequence;
    return;
  }
  if (c.home_search_vel == 0) {
    seek(j, state, config, index_search, c.home_latch_vel, latch_bound(c));
    joint.index_armed = true;
    joint.index_order = 1;
    return;
  }
  bool closed = false;
  for_partners(j, [&](std::size_t p) { closed = closed || state[p].home_switch; });
  if (closed)
    seek(j, state, config, backoff_first, -c.home_search_vel, search_bound(c));
  else
    seek(j, state, config, search, c.home_search_vel, search_bound(c));
}

void Homing::seek(std::size_t j, Joint* state, const MachineConfig& config, std::int32_t phase,
                  double velocity, double bound) noexcept {
  Leg& leg = leg_[j];
  double speed = std::min(std::abs(velocity), config.joint[j].max_vel);
  for_partners(j, [&](std::size_t p) {
    const JointConfig& c = config.joint[p];
    const bool fine = phase == latch || phase == index_search;
    const double own = std::abs(fine ? c.home_latch_vel : c.home_search_vel);
    speed = std::min(speed, std::min(own > 0 ? own : c.max_vel, c.max_vel));
  });
  leg.ready = leg.seen = false;
  leg.speed = std::copysign(speed, velocity);
  leg.bound = bound;
  leg.goal = state[j].mover.position() + std::copysign(bound, velocity);
  state[j].home_state = phase;
  state[j].mover.go_to(leg.goal, speed);
}

bool Homing::partners_ready(std::size_t j, const Joint* state) const noexcept {
  bool all = true;
  const int here = rank(state[j].home_state);
  for_partners(j, [&](std::size_t p) {
    const int there = rank(state[p].home_state);
    all = all && (there > here || (there == here && leg_[p].ready));
  });
  return all;
}

/// Off the switch: all legs until the last of them is.
void Homing::back_off(std::size_t j, Joint* state, const MachineConfig& config,
                      FaultList& faults) noexcept {
  Leg& leg = leg_[j];
  Joint& joint = state[j];
  const bool at_rest = !joint.mover.active();
  // After a search that went beyond a short cam the switch has to be met once more.
  leg.seen = leg.seen || joint.home_switch || joint.home_state == backoff_first;
  bool off = true;
  for_partners(j, [&](std::size_t p) {
    const bool same = state[p].home_state == joint.home_state;
    off = off && same && leg_[p].seen && !state[p].home_switch;
  });
  leg.ready = off && at_rest;
  if (off) {
    joint.mover.stop();
    return;
  }
  if (lost_switch(j, joint)) {
    fail(j, Fault::home_failed, static_cast<double>(HomeFailure::switch_lost), faults, leg.overrun);
    return;
  }
  if (!at_rest) return;
  if (std::abs(joint.mover.position() - leg.goal) > 1e-6) {
    joint.mover.go_to(leg.goal, std::abs(leg.speed));  // it bounced
    return;
  }
  // Of several legs, the one to blame.
  std::size_t stuck = j;
  for_partners(j, [&](std::size_t p) { stuck = state[p].home_switch ? p : stuck; });
  fail(stuck, Fault::home_failed, static_cast<double>(HomeFailure::switch_stuck), faults,
       config.joint[stuck].home_search_dist);
}

/// On the way back from a search: it is past the place where the switch was by as much as the search overran it.
bool Homing::lost_switch(std::size_t j, const Joint& joint) const noexcept {
  const Leg& leg = leg_[j];
  if (leg.seen || joint.home_state == backoff_first) return false;
  const double back =
      std::abs(joint.mover.position() - (leg.goal - std::copysign(leg.bound, leg.speed)));
  return back > 2 * leg.overrun + std::abs(joint.pos_cmd - joint.pos_fb);
}

void Homing::find_edge(std::size_t j, Joint& joint, const JointConfig& c,
                       FaultList& faults) noexcept {
  Leg& leg = leg_[j];
  leg.seen = leg.seen || joint.home_switch;
  const bool edge = same_direction(c) ? joint.home_switch : leg.seen && !joint.home_switch;
  if (edge && has(c, home_use_index)) {
    joint.home_state = index_search;
    joint.index_armed = true;
    joint.index_order = 1;
  } else if (edge && (joint.fb_stale || joint.fb_was_stale)) {
    fail(j, Fault::home_failed, static_cast<double>(HomeFailure::stale_feedback), faults);
  } else if (edge) {
    // The feedback of this cycle is where the switch changed.
    joint.shift(c.home_offset - joint.pos_fb);
    found(joint);
  } else if (!same_direction(c) && lost_switch(j, joint)) {
    fail(j, Fault::home_failed, static_cast<double>(HomeFailure::switch_lost), faults, leg.overrun);
  } else if (!joint.mover.active()) {
    fail(j, Fault::home_no_switch, leg.bound, faults);
  }
}

void Homing::found(Joint& joint) noexcept {
  joint.mover.stop();
  joint.home_state = latch_stop;
}

void Homing::watch_index(std::size_t j, Joint& joint, const JointConfig& c) noexcept {
  if (!joint.index_armed || joint.index_enable || joint.fb_stale) return;
  joint.index_armed = false;
  // Without a counter that begins anew the place counts that the joint had in the very cycle.
  leg_[j].late = joint.fb_was_stale && has(c, home_index_no_encoder_reset);
  if (!has(c, home_index_no_encoder_reset)) {
    // The encoder counts from its index on. Where the drive wants to be does not change with it.
    const double lag = joint.ferror;
    joint.motor_offset = -c.home_offset - joint.backlash.position();
    joint.pos_fb = joint.motor_pos_fb - joint.motor_offset - joint.backlash.position();
    joint.rename(joint.pos_fb + lag - joint.pos_cmd);
  } else {
    joint.shift(c.home_offset - joint.pos_fb);
  }
  found(joint);
}

void Homing::step_joint(std::size_t j, Joint* state, const MachineConfig& config,
                        FaultList& faults) noexcept {
  Joint& joint = state[j];
  const JointConfig& c = config.joint[j];
  Leg& leg = leg_[j];
  const bool at_rest = !joint.mover.active();
  switch (joint.home_state) {
    case wait_unlock: leg.ready = joint.is_unlocked; return;
    case backoff_first:
    case backoff_final: return back_off(j, state, config, faults);
    case search:
      if (!leg.seen && joint.home_switch) {
        leg.seen = true;
        leg.edge = joint.mover.position();
      }
      if (leg.seen) {
        joint.mover.stop();
        leg.ready = at_rest;
        leg.overrun = std::abs(joint.mover.position() - leg.edge);
      } else if (at_rest) {
        fail(j, Fault::home_no_switch, leg.bound, faults);
      }
      return;
    case latch: return find_edge(j, joint, c, faults);
    case index_search:
      if (at_rest)
        fail(j, Fault::home_failed, static_cast<double>(HomeFailure::no_index), faults, leg.bound);
      return;
    case latch_stop:
      if (leg.late)
        fail(j, Fault::home_failed, static_cast<double>(HomeFailure::stale_feedback), faults);
      leg.ready = at_rest;
      return;
    case final_move:
      if (!at_rest) return;
      joint.unlock = false;
      joint.home_state = wait_lock;
      [[fallthrough]];
    case wait_lock:
      if (!has(c, home_unlock_first) || !joint.is_unlocked) finish(joint);
      return;
    default: return;
  }
}

void Homing::finish(Joint& joint) noexcept {
  joint.home_state = idle;
  joint.homing = false;
  joint.ignore_limits = false;
  joint.homed = true;
}

/// From a phase to the next.
void Homing::go_on(std::size_t j, Joint* state, const MachineConfig& config) noexcept {
  const JointConfig& c = config.joint[j];
  switch (state[j].home_state) {
    case wait_unlock: return begin_moving(j, state, config);
    case backoff_first: return seek(j, state, config, search, c.home_search_vel, search_bound(c));
    case search:
      if (same_direction(c))
        return seek(j, state, config, backoff_final, -c.home_search_vel, search_bound(c));
      [[fallthrough]];
    case backoff_final: return seek(j, state, config, latch, c.home_latch_vel, latch_bound(c));
    case latch_stop: state[j].home_state = wait_sequence; return;
    default: return;
  }
}

void Homing::start_final_moves(std::size_t joints, Joint* state,
                               const MachineConfig& config) noexcept {
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = state[j];
    if (!joint.homing || joint.home_state != wait_sequence) continue;
    const JointConfig& c = config.joint[j];
    joint.home_state = final_move;
    double speed = final_speed(c);
    for_partners(j, [&](std::size_t p) { speed = std::min(speed, final_speed(config.joint[p])); });
    if (!has(c, home_no_final_move)) joint.mover.go_to(c.home, speed);
  }
}

void Homing::lock_if_at_rest(Joint& joint) noexcept {
  if (joint.homing || joint.mover.active()) return;
  joint.unlock = false;
  joint.ignore_limits = false;
}

void Homing::step(std::size_t joints, Joint* state, const MachineConfig& config,
                  FaultList& faults) noexcept {
  if (module_ != nullptr) return module_->step();
  for (std::size_t j = 0; j < joints; ++j) lock_if_at_rest(state[j]);
  if (!active_) return;
  bool any = false;
  for (std::size_t j = 0; j < joints; ++j)
    if (state[j].homing) step_joint(j, state, config, faults);
  if (failed_) {
    stop(joints, state);
    return;
  }
  // All look at the same moment, then all go on.
  std::uint32_t going = 0;
  for (std::size_t j = 0; j < joints; ++j)
    if (state[j].homing && leg_[j].ready && partners_ready(j, state)) going |= 1U << j;
  for (std::size_t j = 0; j < joints; ++j)
    if ((going >> j & 1U) != 0) go_on(j, state, config);
  bool all_wait = true;
  for (std::size_t j = 0; j < joints; ++j) {
    if (!state[j].homing) continue;
    any = true;
    all_wait = all_wait && rank(state[j].home_state) >= rank(wait_sequence);
  }
  if (!together_ || all_wait) start_final_moves(joints, state, config);
  if (any) return;
  if (next_sequence(joints, config, faults))
    begin_group(joints, state, config, faults);
  else
    active_ = false;
}

/// Manual, HOME_SEQUENCE: home all ends where the numbers do not follow one another.
bool Homing::next_sequence(std::size_t joints, const MachineConfig& config,
                           FaultList& faults) noexcept {
  const std::int32_t next = all_ ? next_group(joints, config, sequence_ + 1) : kNoGroup;
  if (next == kNoGroup) return false;
  if (next > sequence_ + 1) {
    raise(faults, Fault::home_failed, -1, static_cast<double>(HomeFailure::sequence_gap), next);
    return false;
  }
  sequence_ = next;
  return true;
}

void Homing::look_at_module(std::size_t joints, Joint* state) noexcept {
  if (module_ == nullptr) return;
  for (std::size_t j = 0; j < joints; ++j) module_->set_unlocked(j, state[j].is_unlocked);
  module_->read_pins();
  active_ = module_->active();
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = state[j];
    const bool homing = module_->homing(j);
    // The drive moves by itself, and its counter may begin anew: also in the cycle in which it is done.
    if (homing || joint.homing) {
      joint.rename(joint.pos_fb - joint.pos_cmd);
      joint.mover.place(joint.pos_cmd);
      joint.lag = 0;
    }
    joint.homing = homing;
    joint.homed = module_->homed(j);
    joint.home_state = homing ? search : idle;
    joint.unlock = module_->wants_unlock(j);
  }
}

void Homing::stop(std::size_t joints, Joint* state) noexcept {
  if (module_ != nullptr) {
    for (std::size_t j = 0; j < joints; ++j)
      if (module_->homing(j)) module_->cancel(static_cast<std::int32_t>(j));
    active_ = module_->active();
    return;
  }
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = state[j];
    if (!joint.homing) continue;
    joint.mover.stop();
    joint.homing = false;
    joint.home_state = idle;
    if (joint.index_armed) joint.index_order = -1;
    joint.index_armed = false;
    // Limits that are ignored stay so until it stands: lock_if_at_rest().
  }
  active_ = false;
}

}  // namespace kerf::motion
