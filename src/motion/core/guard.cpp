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
    state[j].last_vel = state[j].vel_cmd = state[j].acc_cmd = 0;
  }
}

void Guard::check(std::size_t joints, Joint* state, const MachineConfig& config, double dt,
                  const SourceTag& tag, FaultList& faults) noexcept {
  const double rate = 1.0 / dt;
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = state[j];
    const JointConfig& c = config.joint[j];
    const double step = joint.pos_cmd - joint.last_pos;
    joint.vel_cmd = step * rate;
    joint.acc_cmd = (joint.vel_cmd - joint.last_vel) * rate;
    joint.last_pos = joint.pos_cmd;
    joint.last_vel = joint.vel_cmd;
    if (broken_) continue;
    const double vel = std::abs(joint.vel_cmd), acc = std::abs(joint.acc_cmd);
    const double vel_limit = c.max_vel * kVelocityAllowance + kRounding * rate;
    const double acc_limit = c.max_acc * kAccelerationAllowance + kRounding * rate * rate;
    if (vel <= vel_limit && acc <= acc_limit) continue;
    // A step of several cycles' travel is a jump, not a speed.
    const Fault fault = !(vel <= 4 * vel_limit) ? Fault::limit_continuity
                        : vel > vel_limit       ? Fault::limit_velocity
                                                : Fault::limit_acceleration;
    raise(faults, fault, static_cast<std::int32_t>(j),
          fault == Fault::limit_acceleration ? acc : vel,
          fault == Fault::limit_acceleration ? c.max_acc : c.max_vel, tag);
    broken_ = true;
  }
}

}  // namespace kerf::motion
