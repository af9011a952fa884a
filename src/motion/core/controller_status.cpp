// What a cycle says of itself.
#include <algorithm>
#include <cmath>

#include "motion/core/controller.hpp"

namespace kerf::motion {
namespace {
constexpr double kOnLimit = 1e-6;
}

void Controller::fill_joint(std::size_t j) noexcept {
  const Joint& joint = joint_[j];
  const JointConfig& c = config_.joint[j];
  JointStatus& s = status_.joint[j];
  s.pos_cmd = joint.pos_cmd;
  s.pos_fb = joint.pos_fb;
  s.vel_cmd = joint.vel_cmd;
  s.acc_cmd = joint.acc_cmd;
  s.jerk_cmd = joint.jerk_cmd;
  s.ferror = joint.ferror;
  s.ferror_limit = joint.ferror_limit;
  s.ferror_high = joint.ferror_high;
  s.motor_offset = joint.motor_offset;
  s.fb_lost = joint.fb_lost;
  s.fb_extrapolated = joint.fb_stale && joint.fb_known;
  s.home_state = joint.home_state;
  s.homed = joint.homed;
  s.homing = joint.homing;
  s.active = true;
  s.enabled = enabled_;
  s.in_position = !joint.mover.active() && joint.vel_cmd == 0;
  s.faulted = joint.faulted;
  s.error = joint.error;
  s.min_hard_limit = joint.neg_limit;
  s.max_hard_limit = joint.pos_limit;
  s.min_soft_limit = joint.homed && joint.pos_cmd <= c.min_limit + kOnLimit;
  s.max_soft_limit = joint.homed && joint.pos_cmd >= c.max_limit - kOnLimit;
}

void Controller::fill_status(const Inputs& in, const Orders& orders, double dt,
                             std::int64_t now_ns) noexcept {
  MotionStatus& s = status_;
  ++s.cycle;
  s.time_ns = now_ns;
  s.servo_period_ns = std::llround(dt * 1e9);
  s.acked_epoch = acked_epoch_;
  s.mode = mode_;
  s.intent_taken = intent_taken_;
  if (!jog_waits_) intent_taken_ = orders.values->serial;
  executor_.fill(s);
  s.pos_cmd = pose_;
  s.external_offset = offsets_.pose();
  s.away = away_;
  s.place = away_ ? path_pose() : pose_;
  s.path_shift = shift_;
  s.shifts_path = plain_kinematics_;
  s.tool_offset = s.tool_offset + shift_;
  s.pos_fb = pose_fb_;
  s.enabled = enabled_;
  s.in_position = at_rest();
  s.path_empty = orders.path_ring_empty && executor_.idle();
  s.held = executor_.at_rest() && (orders.hold || executor_.step_done());
  s.homing_active = homing_.active();
  s.jogging = jogging();
  s.all_homed = true;
  s.soft_limit = false;
  s.amp_ready = in.enable;
  for (std::size_t j = 0; j < joints_; ++j) {
    fill_joint(j);
    s.all_homed = s.all_homed && joint_[j].homed;
    s.soft_limit = s.soft_limit || s.joint[j].min_soft_limit || s.joint[j].max_soft_limit;
    s.joint[j].on_limit_override = orders.values->override_limits;
  }
  s.feed_override = orders.values->feed_override;
  s.rapid_override = orders.values->rapid_override;
  s.digital_out = outputs_.digital;
  s.probe_input = in.probe;
  s.kinematics_type = static_cast<std::int32_t>(kinematics_.type());
  s.kinematics_kind = kinematics_.kind();
  s.kinematics_pending = kinematics_moved_ || offset_told_ > 0;
  s.enables = executor_.enables();
  const double pace = plain_kinematics_ ? 1 : jog_pace_.scale();
  const std::uint32_t axes = kinematics_.axis_mask();
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if ((axes >> i & 1U) != 0) s.axis_vel[i] = axis_[i].speed() * pace;
  s.faults = fault_number_;
  s.joints = static_cast<std::int32_t>(joints_);
  s.spindles = static_cast<std::int32_t>(spindle_count_);
  for (std::size_t n = 0; n < spindle_count_; ++n) spindles_.fill(n, in.spindle[n], s.spindle[n]);
}

void Controller::note_changes() noexcept {
  const MotionStatus& s = status_;
  Digest now;
  now.faults = s.faults;
  now.acked = s.acked_epoch;
  now.intent = s.intent_taken;
  now.shift = s.path_shift;
  if (executor_.retraces()) now.retraced = s.current.id;
  const bool flag[] = {s.enabled, s.path_empty,    s.held,       s.homing_active,
                       s.jogging, s.probe_tripped, s.in_position};
  for (std::size_t i = 0; i < std::size(flag); ++i) now.flags |= flag[i] ? 1U << i : 0U;
  now.flags |= static_cast<std::uint32_t>(s.mode) << 8U | static_cast<std::uint32_t>(s.waiting_for)
                                                              << 12U;
  for (std::size_t j = 0; j < joints_; ++j) now.homed |= s.joint[j].homed ? 1U << j : 0U;
  for (std::size_t n = 0; n < spindle_count_; ++n)
    now.homed ^= static_cast<std::uint32_t>(s.spindle[n].orient_state) << (16 + 2 * n);
  const bool went_on = s.executed_seq != executed_before_, more = !(now == digest_);
  executed_before_ = s.executed_seq;
  changed_ = went_on || more;
  only_went_on_ = went_on && !more;
  if (more) digest_ = now;
}

}  // namespace kerf::motion
