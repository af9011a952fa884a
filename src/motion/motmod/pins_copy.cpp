// Pins to plain values and back.
#include <cmath>

#include "motion/motmod/motmod.hpp"

namespace kerf::motion {
namespace {
constexpr double kMmPerInch = 25.4;
constexpr double kDegrees = 57.29577951308232;

/// Of joints and axes alike. `scale`: machine units in 1 mm.
template <class Pins>
void read_wheel(const Pins& p, double scale, WheelInputs& out) noexcept {
  out = {p.jog_enable, p.jog_vel_mode, p.jog_counts, p.jog_scale / scale, p.jog_accel_fraction};
}
}  // namespace

void MotionPins::add_debug_params() noexcept {
  using hal::make_param;
  using hal::numbered;
  using hal::RoParam;
  for (std::size_t i = 0; i < 4; ++i) {
    (void)make_param<RoParam<double>>(b, numbered("motion.debug-float-#", i), "Not used");
    (void)make_param<RoParam<double>>(b, numbered("tc.#.pos", i), "Not used");
    (void)make_param<RoParam<double>>(b, numbered("tc.#.vel", i), "Not used");
    (void)make_param<RoParam<double>>(b, numbered("tc.#.acc", i), "Not used");
  }
  for (std::size_t i = 0; i < 2; ++i) {
    (void)make_param<RoParam<bool>>(b, numbered("motion.debug-bit-#", i), "Not used");
    (void)make_param<RoParam<std::int32_t>>(b, numbered("motion.debug-s32-#", i), "Not used");
  }
  (void)make_param<RoParam<double>>(b, "traj.pos_out", "Not used");
  (void)make_param<RoParam<double>>(b, "traj.vel_out", "Not used");
  (void)make_param<RoParam<std::uint32_t>>(b, "traj.active_tc", "Not used");
}

void Motmod::read_inputs() noexcept {
  Inputs& in = inputs_.in;
  in.enable = pins_.enable;
  in.feed_hold = pins_.feed_hold;
  in.feed_inhibit = pins_.feed_inhibit;
  in.homing_inhibit = pins_.homing_inhibit;
  in.jog_inhibit = pins_.jog_inhibit;
  in.jog_stop = pins_.jog_stop;
  in.jog_stop_immediate = pins_.jog_stop_immediate;
  in.probe = pins_.probe_input;
  in.adaptive_feed = pins_.adaptive_feed;
  const std::uint64_t errors = io_.errors();
  in.misc_errors = errors;
  controller_->status().misc_error = errors;
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    const JointPins& p = joint_[j];
    const std::size_t first_extra = joint_.size() - posthome_cmd_.size();
    const double posthome =
        j < first_extra ? 0.0 : posthome_cmd_[j - first_extra].get() / joint_scale(j);
    in.joint[j] = {p.motor_pos_fb / joint_scale(j),
                   posthome,
                   p.home_sw_in,
                   p.neg_lim_sw_in,
                   p.pos_lim_sw_in,
                   p.amp_fault_in,
                   p.index_enable,
                   has_unlock(j) && is_unlocked_[j].get(),
                   p.fb_stale};
    read_wheel(p, joint_scale(j), in.joint_wheel[j]);
  }
  for (std::size_t i = 0; i < axis_.size(); ++i) {
    if ((axes_read_ >> i & 1U) == 0) continue;
    const double k = rtapi::is_rotary(i) ? 1.0 : scale_;
    const AxisPins& p = axis_[i];
    read_wheel(p, k, in.axis_wheel[i]);
    in.offset[i] = {p.eoffset_enable, p.eoffset_clear, p.eoffset_counts, p.eoffset_scale / k};
  }
  for (std::size_t n = 0; n < spindle_.size(); ++n) {
    const SpindlePins& p = spindle_[n];
    in.spindle[n] = {p.revs,     p.speed_in, p.orient_fault, p.amp_fault_in,
                     p.at_speed, p.inhibit,  p.is_oriented,  p.index_enable};
  }
}

void Motmod::write_joint(std::size_t j) noexcept {
  JointPins& p = joint_[j];
  const JointStatus& s = controller_->status().joint[j];
  const Joint& joint = controller_->joint(j);
  const double k = joint_scale(j);
  const bool moves = joint.mover.active();
  p.active = s.active;
  p.amp_enable_out = s.enabled;
  p.error = s.error;
  p.f_errored = joint.ferrored;
  p.faulted = s.faulted;
  p.free_tp_enable = moves;
  // Only on order: in between it belongs to the encoder.
  if (joint.index_order != 0) p.index_enable = joint.index_order > 0;
  if (has_unlock(j)) unlock_[j] = controller_->unlocks(j);
  p.homed = s.homed;
  p.homing = s.homing;
  p.in_position = s.in_position;
  p.wheel_jog_active = controller_->joint_wheel_active(j);
  p.kb_jog_active = moves && !s.homing && !controller_->joint_wheel_active(j);
  p.neg_hard_limit = s.min_hard_limit;
  p.pos_hard_limit = s.max_hard_limit;
  p.home_state = s.home_state;
  p.acc_cmd = s.acc_cmd * k;
  p.jerk_cmd = s.jerk_cmd * k;
  p.vel_cmd = s.vel_cmd * k;
  p.pos_cmd = s.pos_cmd * k;
  p.coarse_pos_cmd = s.pos_cmd * k;
  p.pos_fb = s.pos_fb * k;
  p.fb_extrapolated = s.fb_extrapolated;
  p.fb_lost = s.fb_lost;
  p.f_error = s.ferror * k;
  p.f_error_lim = s.ferror_limit * k;
  p.free_pos_cmd = joint.mover.target() * k;
  p.free_vel_lim = joint.mover.speed_limit() * k;
  p.motor_offset = s.motor_offset * k;
  p.backlash_corr = joint.backlash.target() * k;
  p.backlash_filt = joint.backlash.position() * k;
  p.backlash_vel = joint.backlash.speed() * k;
  p.motor_pos_cmd = (s.pos_cmd + s.motor_offset + joint.backlash.position()) * k;
}

void Motmod::write_axes() noexcept {
  const Pose& pose = controller_->status().pos_cmd;
  for (std::size_t i = 0; i < axis_.size(); ++i) {
    if ((axis_mask_ >> i & 1U) == 0) continue;
    AxisPins& p = axis_[i];
    const AxisMover& mover = controller_->axis(i);
    const double k = rtapi::is_rotary(i) ? 1.0 : scale_;
    p.pos_cmd = pose[i] * k;
    p.eoffset = controller_->offsets().pose()[i] * k;
    p.eoffset_request = controller_->offsets().request(i) * k;
    p.teleop_pos_cmd = mover.target() * k;
    p.teleop_vel_cmd = mover.speed() * k;
    p.teleop_vel_lim = mover.speed_limit() * k;
    p.teleop_tp_enable = mover.active();
    p.wheel_jog_active = controller_->axis_wheel_active(i);
    p.kb_jog_active = mover.active() && !controller_->axis_wheel_active(i);
  }
}

void Motmod::write_spindle(std::size_t n) noexcept {
  SpindlePins& p = spindle_[n];
  const SpindleOutputs& out = controller_->spindles().outputs(n);
  p.on = out.on;
  p.forward = out.forward;
  p.reverse = out.reverse;
  p.brake = out.brake;
  p.orient = out.orient;
  p.locked = out.locked;
  p.orient_angle = out.orient_angle_deg;
  p.orient_mode = out.orient_mode;
  p.speed_out = out.speed_rpm;
  p.speed_out_abs = std::abs(out.speed_rpm);
  p.speed_out_rps = out.speed_rpm / 60.0;
  p.speed_out_rps_abs = std::abs(out.speed_rpm) / 60.0;
  p.speed_cmd_rps = out.command_rps;
  // Only on order: in between it belongs to the encoder.
  if (out.index_order != 0) p.index_enable = out.index_order > 0;
}

/// Machine units of a path length: that of a rotary move is in degrees, which have no scale.
double Motmod::path_scale(const PathSpan* move) const noexcept {
  return move != nullptr && move->piece.feed.metric == 3 ? 1.0 : scale_;
}

void Motmod::write_motion(const hal::Period& period) noexcept {
  const MotionStatus& s = controller_->status();
  for (const FaultRecord& record : controller_->faults())
    coord_error_ =
        coord_error_ || (s.mode == MotionMode::coordinated && record.fault != Fault::none);
  if (s.acked_epoch != last_ack_) coord_error_ = false;
  last_ack_ = s.acked_epoch;
  pins_.coord_error = coord_error_;
  pins_.coord_mode = s.mode == MotionMode::coordinated;
  pins_.teleop_mode = s.mode == MotionMode::teleop;
  pins_.sync_in_step = s.sync_in_step;
  pins_.sync_lag = s.sync_lag_mm * scale_;
  pins_.sync_run_in = s.sync_run_in_mm * scale_;
  pins_.eoffset_active = controller_->offsets().active();
  pins_.eoffset_limited = controller_->offsets().limited();
  pins_.in_position = s.in_position;
  pins_.tp_reverse = s.reverse;
  pins_.is_all_homed = s.all_homed;
  pins_.jog_is_active = s.jogging;
  pins_.motion_enabled = s.enabled;
  pins_.on_soft_limit = s.soft_limit;
  const PathSpan* move = controller_->executor().move();
  const double k = path_scale(move);
  pins_.current_vel = s.vel_mm_s * k;
  pins_.distance_to_go = s.distance_to_go * k;
  pins_.requested_vel = s.requested_vel_mm_s * k;
  const double feed = move != nullptr ? controller_->executor().commanded_feed() : 0.0;
  pins_.feed_upm = feed * k * 60.0;
  pins_.feed_mm_per_second = feed;
  pins_.feed_mm_per_minute = feed * 60.0;
  pins_.feed_inches_per_second = feed / kMmPerInch;
  pins_.feed_inches_per_minute = feed / kMmPerInch * 60.0;
  pins_.servo_last_period = static_cast<std::uint32_t>(period.actual_ns);
  write_move(s);
}

void Motmod::write_move(const MotionStatus& s) noexcept {
  const bool runs = s.planned_items > 0;
  pins_.motion_type = static_cast<std::int32_t>(s.kind);
  pins_.program_line = runs ? s.current.line : 0;
  pins_.interp_motion_type = static_cast<std::int32_t>(s.kind);
  pins_.interp_line_number = s.current.line;
  const PathSpan* move = controller_->executor().move();
  const bool circle = move != nullptr && move->piece.shape == path::Piece::Shape::arc;
  pins_.interp_iscircle = circle;
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    pins_.tooloffset[i] = s.tool_offset[i] * (rtapi::is_rotary(i) ? 1.0 : scale_);
  if (move == nullptr) return;
  pins_.interp_feedrate = move->requested * path_scale(move) * 60.0;
  if (circle) {
    for (std::size_t i = 0; i < 3; ++i) pins_.interp_arc_center[i] = move->piece.a[i] * scale_;
    pins_.interp_arc_radius = move->piece.radius * scale_;
    return;
  }
  const double heading = move->heading * kDegrees;
  pins_.interp_heading = heading;
  pins_.interp_normal_heading = heading + 90.0;
}

}  // namespace kerf::motion
