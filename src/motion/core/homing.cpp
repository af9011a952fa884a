#include "motion/core/homing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kerf::motion {
namespace {

constexpr std::int32_t kNoGroup = -1;

bool has_sequence(const JointConfig& c) noexcept { return c.home_sequence != kNoHomeSequence; }

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

double final_speed(const JointConfig& c) noexcept {
  return c.home_final_vel > 0 ? std::min(c.home_final_vel, c.max_vel) : c.max_vel;
}

}  // namespace

void Homing::fail(std::size_t j, Fault fault, double value, FaultList& faults) noexcept {
  raise(faults, fault, static_cast<std::int32_t>(j), value);
  failed_ = true;
}

void Homing::start(std::int32_t joint, std::size_t joints, Joint* state,
                   const MachineConfig& config, FaultList& faults) noexcept {
  failed_ = false;
  single_ = -1;
  all_ = joint < 0;
  if (all_) {
    sequence_ = next_group(joints, config, 0);
    if (sequence_ == kNoGroup) {
      raise(faults, Fault::home_failed, -1, static_cast<double>(HomeFailure::nothing_to_home));
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
  active_ = true;
  begin_group(joints, state, config, faults);
}

void Homing::begin_group(std::size_t joints, Joint* state, const MachineConfig& config,
                         FaultList& faults) noexcept {
  together_ = false;
  bool any = false;
  for (std::size_t j = 0; j < joints; ++j) {
    const JointConfig& c = config.joint[j];
    const bool member = single_ >= 0 ? static_cast<std::int32_t>(j) == single_
                                     : has_sequence(c) && std::abs(c.home_sequence) == sequence_;
    if (!member) continue;
    // An absolute encoder that is homed keeps its home.
    if ((c.home_flags & home_no_rehome) != 0 && state[j].homed) continue;
    if (single_ < 0 && c.home_sequence < 0) together_ = true;
    if (!begin_joint(j, state[j], c, faults)) break;
    any = true;
  }
  if (failed_)
    stop(joints, state);
  else if (!any && !all_)
    active_ = false;
}

bool Homing::begin_joint(std::size_t j, Joint& joint, const JointConfig& c,
                         FaultList& faults) noexcept {
  const auto refuse = [&](HomeFailure why) {
    fail(j, Fault::home_failed, static_cast<double>(why), faults);
    return false;
  };
  const bool absolute = (c.home_flags & home_absolute_encoder) != 0;
  if (!absolute) {
    if ((c.home_flags & home_use_index) != 0) return refuse(HomeFailure::index_unsupported);
    if (c.home_search_vel == 0 && c.home_latch_vel != 0)
      return refuse(HomeFailure::index_unsupported);
    if (c.home_search_vel != 0 && c.home_latch_vel == 0) return refuse(HomeFailure::latch_vel_zero);
    if ((c.home_flags & home_is_shared) != 0 && joint.home_switch)
      return refuse(HomeFailure::switch_closed);
  }
  joint.homed = false;
  joint.homing = true;
  joint.ignore_limits = (c.home_flags & home_ignore_limits) != 0;
  joint.mover.place(joint.pos_cmd);
  if (absolute || c.home_search_vel == 0) {
    joint.shift(c.home_offset - joint.pos_cmd);
    joint.home_state = wait_sequence;
    return true;
  }
  if (joint.home_switch) {
    joint.home_state = backoff_first;
    seek(joint, c, -c.home_search_vel, search_bound(c));
  } else {
    joint.home_state = search;
    seek(joint, c, c.home_search_vel, search_bound(c));
  }
  return true;
}

void Homing::seek(Joint& joint, const JointConfig& c, double velocity, double bound) noexcept {
  const double speed = std::min(std::abs(velocity), c.max_vel);
  joint.mover.go_to(joint.mover.position() + (velocity > 0 ? bound : -bound), speed);
}

void Homing::set_home(Joint& joint, const JointConfig& c) noexcept {
  // The feedback of this cycle is where the switch changed.
  joint.shift(c.home_offset - joint.pos_fb);
  joint.mover.stop();
  joint.home_state = latch_stop;
}

void Homing::step_joint(std::size_t j, Joint& joint, const JointConfig& c,
                        FaultList& faults) noexcept {
  const bool at_rest = !joint.mover.active();
  const bool same_direction = (c.home_search_vel > 0) == (c.home_latch_vel > 0);
  const double latch_bound = c.home_latch_dist > 0 ? c.home_latch_dist : search_bound(c);
  switch (joint.home_state) {
    case backoff_first:
      if (!joint.home_switch) {
        joint.mover.stop();
        if (at_rest) {
          joint.home_state = search;
          seek(joint, c, c.home_search_vel, search_bound(c));
        }
      } else if (at_rest) {
        fail(j, Fault::home_failed, static_cast<double>(HomeFailure::switch_stuck), faults);
      }
      return;
    case search:
      if (joint.home_switch) {
        joint.mover.stop();
        if (!at_rest) return;
        joint.home_state = same_direction ? backoff_final : latch;
        if (same_direction)
          seek(joint, c, -c.home_search_vel, search_bound(c));
        else
          seek(joint, c, c.home_latch_vel, latch_bound);
      } else if (at_rest) {
        fail(j, Fault::home_no_switch, search_bound(c), faults);
      }
      return;
    case backoff_final:
      if (!joint.home_switch) {
        joint.mover.stop();
        if (at_rest) {
          joint.home_state = latch;
          seek(joint, c, c.home_latch_vel, latch_bound);
        }
      } else if (at_rest) {
        fail(j, Fault::home_failed, static_cast<double>(HomeFailure::switch_stuck), faults);
      }
      return;
    case latch:
      if (joint.home_switch == same_direction)
        set_home(joint, c);
      else if (at_rest)
        fail(j, Fault::home_no_switch, latch_bound, faults);
      return;
    case latch_stop:
      if (at_rest) joint.home_state = wait_sequence;
      return;
    case final_move:
      if (!at_rest) return;
      joint.home_state = idle;
      joint.homing = false;
      joint.ignore_limits = false;
      joint.homed = true;
      return;
    default: return;
  }
}

void Homing::step(std::size_t joints, Joint* state, const MachineConfig& config,
                  FaultList& faults) noexcept {
  if (!active_) return;
  bool all_wait = true, any = false;
  for (std::size_t j = 0; j < joints; ++j) {
    if (!state[j].homing) continue;
    step_joint(j, state[j], config.joint[j], faults);
    if (!state[j].homing) continue;
    any = true;
    if (state[j].home_state < wait_sequence) all_wait = false;
  }
  if (failed_) {
    stop(joints, state);
    return;
  }
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = state[j];
    if (!joint.homing || joint.home_state != wait_sequence || (together_ && !all_wait)) continue;
    const JointConfig& c = config.joint[j];
    joint.home_state = final_move;
    if ((c.home_flags & home_no_final_move) == 0) joint.mover.go_to(c.home, final_speed(c));
  }
  if (any) return;
  const std::int32_t next = all_ ? next_group(joints, config, sequence_ + 1) : kNoGroup;
  if (next == kNoGroup) {
    active_ = false;
    return;
  }
  sequence_ = next;
  begin_group(joints, state, config, faults);
}

void Homing::stop(std::size_t joints, Joint* state) noexcept {
  for (std::size_t j = 0; j < joints; ++j) {
    if (!state[j].homing) continue;
    state[j].mover.stop();
    state[j].homing = false;
    state[j].ignore_limits = false;
    state[j].home_state = idle;
  }
  active_ = false;
}

}  // namespace kerf::motion
