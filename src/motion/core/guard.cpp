#include "motion/core/guard.hpp"

#include <cmath>

namespace kerf::motion {
namespace {
/// Below this a step is rounding (mm, degrees): points of path, sums of offsets.
constexpr double kRounding = 4e-9;
}  // namespace

void Guard::reset(std::size_t joints, Joint* state) noexcept {
  broken_ = false;
  follow(joints, state);
}

void Guard::follow(std::size_t joints, Joint* state) noexcept {
  for (std::size_t j = 0; j < joints; ++j) {
    state[j].last_pos = state[j].pos_cmd;
    state[j].last_vel = state[j].vel_cmd = state[j].acc_cmd = state[j].jerk_cmd = 0;
  }
}

bool Guard::check(std::size_t joints, Joint* state, const MachineConfig& config, double dt,
                  std::uint32_t led, std::uint32_t may_jump, const SourceTag& tag,
                  FaultList& faults) noexcept {
  const double rate = 1.0 / dt;
  bool moves = true;
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = state[j];
    const JointConfig& c = config.joint[j];
    const double before = joint.last_pos, step = joint.pos_cmd - before;
    joint.vel_cmd = step * rate;
    const double acc_before = joint.acc_cmd;
    joint.acc_cmd = (joint.vel_cmd - joint.last_vel) * rate;
    joint.jerk_cmd = (joint.acc_cmd - acc_before) * rate;
    joint.last_pos = joint.pos_cmd;
    joint.last_vel = joint.vel_cmd;
    const double vel = std::abs(joint.vel_cmd), acc = std::abs(joint.acc_cmd);
    const double vel_limit = c.max_vel * kVelocityAllowance + kRounding * rate;
    const double acc_limit = c.max_acc * kAccelerationAllowance + kRounding * rate * rate;
    // A speed alone may come from limits that were lowered under way. What is no number counts too.
    if (!(acc * dt <= kJump * vel_limit) && (may_jump >> j & 1U) == 0) {
      raise(faults, Fault::limit_continuity, static_cast<std::int32_t>(j), vel, c.max_vel, tag);
      broken_ = true;
      moves = false;
      joint.pos_cmd = joint.last_pos = before;
      joint.vel_cmd = joint.last_vel = joint.acc_cmd = joint.jerk_cmd = 0;
    }
    if (broken_) continue;
    const double jerk = std::abs(joint.jerk_cmd);
    const double jerk_limit = c.max_jerk * kJerkAllowance + kRounding * rate * rate * rate;
    const bool jerky = (led >> j & 1U) == 0 && c.max_jerk > 0 && !(jerk <= jerk_limit);
    if (vel <= vel_limit && acc <= acc_limit && !jerky) continue;
    broken_ = true;
    const auto index = static_cast<std::int32_t>(j);
    // A step of several cycles' travel is a jump, not a speed.
    if (!(vel <= kJump * vel_limit))
      raise(faults, Fault::limit_continuity, index, vel, c.max_vel, tag);
    else if (vel > vel_limit)
      raise(faults, Fault::limit_velocity, index, vel, c.max_vel, tag);
    else if (!(acc <= acc_limit))
      raise(faults, Fault::limit_acceleration, index, acc, c.max_acc, tag);
    else
      raise(faults, Fault::limit_jerk, index, jerk, c.max_jerk, tag);
  }
  return moves;
}

}  // namespace kerf::motion
