// The state at a standstill, out and in again.
#include <algorithm>

#include "motion/core/planner/ceilings.hpp"
#include "motion/core/rest_state.hpp"

namespace kerf::motion {

void Executor::save(Rest& r) const noexcept {
  r.scale = scale_, r.back_scale = back_scale_;
  r.pose = pose_, r.tool_offset = tool_offset_, r.probed = probed_;
  r.distance = distance_, r.requested = requested_, r.commanded_feed = commanded_feed_;
  r.probe_before = probe_before_, r.after_traverse = after_traverse_;
  r.probe_tripped = probe_tripped_;
  r.step = step_, r.executed_seq = executed_seq_, r.current_seq = current_seq_;
  r.place_number = place_number_;
  r.min_epoch = min_epoch_, r.void_epoch = void_epoch_;
  r.current = current_, r.enables = enables_;
  r.sync_digital_mask = sync_digital_mask_, r.sync_digital = sync_digital_;
  r.sync_analog_mask = sync_analog_mask_;
  r.indexer = indexer_, r.locking = locking_;
  std::copy(std::begin(sync_analog_), std::end(sync_analog_), std::begin(r.sync_analog));
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(kMaxSpindles); ++n)
    r.observer[n] = sync_.observer(n);
  sync_.save_speeds(r.slow_rps, r.feed_rps);
}

void Executor::restore(const Rest& r) noexcept {
  place(r.pose);
  scale_ = r.scale, back_scale_ = r.back_scale;
  tool_offset_ = r.tool_offset, probed_ = r.probed;
  distance_ = r.distance, requested_ = r.requested, commanded_feed_ = r.commanded_feed;
  probe_before_ = r.probe_before, after_traverse_ = r.after_traverse;
  probe_tripped_ = r.probe_tripped;
  step_ = r.step, executed_seq_ = r.executed_seq, current_seq_ = r.current_seq;
  place_number_ = r.place_number;
  min_epoch_ = r.min_epoch, void_epoch_ = r.void_epoch;
  current_ = r.current, enables_ = r.enables;
  sync_digital_mask_ = r.sync_digital_mask, sync_digital_ = r.sync_digital;
  sync_analog_mask_ = r.sync_analog_mask;
  indexer_ = r.indexer, locking_ = r.locking;
  std::copy(std::begin(r.sync_analog), std::end(r.sync_analog), std::begin(sync_analog_));
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(kMaxSpindles); ++n)
    sync_.take_over(n, r.observer[n]);
  sync_.restore_speeds(r.slow_rps, r.feed_rps);
}

void Controller::save(Rest& r) const noexcept {
  r.config = config_;
  r.outputs = outputs_;
  r.spindles = spindles_;
  executor_.save(r.executor);
  std::copy(std::begin(joint_), std::end(joint_), std::begin(r.joint));
  std::copy(std::begin(skew_), std::end(skew_), std::begin(r.skew));
  std::copy(std::begin(axis_), std::end(axis_), std::begin(r.axis));
  std::copy(std::begin(joint_wheel_), std::end(joint_wheel_), std::begin(r.joint_wheel));
  std::copy(std::begin(axis_wheel_), std::end(axis_wheel_), std::begin(r.axis_wheel));
  r.guard = guard_;
  r.enabled = enabled_, r.armed = armed_, r.single_step = single_step_, r.away = away_;
  r.start_taken = start_taken_, r.closing_down = closing_down_;
  r.jog_stop_before = jog_stop_before_, r.jog_dead_before = jog_dead_before_;
  r.probe_before = probe_before_;
  r.kind = kinematics_.kind();
  r.mode = mode_, r.refused_mode = refused_mode_;
  r.enable_request = enable_request_, r.acked_epoch = acked_epoch_;
  r.pose = pose_, r.pose_fb = pose_fb_, r.pose_before = pose_before_;
  r.offsets = offsets_;
  std::copy(std::begin(axis_limit_), std::end(axis_limit_), std::begin(r.axis_limit));
  r.heartbeat = heartbeat_, r.fault_number = fault_number_, r.cycle = status_.cycle;
  r.heartbeat_age_s = heartbeat_age_s_;
  std::copy(std::begin(joint_jog_seen_), std::end(joint_jog_seen_), std::begin(r.joint_jog_seen));
  std::copy(std::begin(axis_jog_seen_), std::end(axis_jog_seen_), std::begin(r.axis_jog_seen));
  std::copy(std::begin(spindle_stop_seen_), std::end(spindle_stop_seen_),
            std::begin(r.spindle_stop_seen));
  r.home_seen = home_seen_, r.unhome_seen = unhome_seen_, r.wishes_seen = wishes_seen_;
  r.seen = seen_;
}

void Controller::restore(const Rest& r) noexcept {
  configure(r.config);
  start_due_ = false;
  outputs_ = r.outputs;
  spindles_ = r.spindles;
  executor_.restore(r.executor);
  std::copy(std::begin(r.joint), std::end(r.joint), std::begin(joint_));
  std::copy(std::begin(r.skew), std::end(r.skew), std::begin(skew_));
  std::copy(std::begin(r.axis), std::end(r.axis), std::begin(axis_));
  std::copy(std::begin(r.joint_wheel), std::end(r.joint_wheel), std::begin(joint_wheel_));
  std::copy(std::begin(r.axis_wheel), std::end(r.axis_wheel), std::begin(axis_wheel_));
  guard_ = r.guard;
  enabled_ = r.enabled, armed_ = r.armed, single_step_ = r.single_step, away_ = r.away;
  start_taken_ = r.start_taken, closing_down_ = r.closing_down;
  jog_stop_before_ = r.jog_stop_before, jog_dead_before_ = r.jog_dead_before;
  probe_before_ = r.probe_before;
  mode_ = r.mode, refused_mode_ = r.refused_mode;
  enable_request_ = r.enable_request, acked_epoch_ = r.acked_epoch;
  pose_ = r.pose, pose_fb_ = r.pose_fb, pose_before_ = r.pose_before;
  offsets_ = r.offsets;
  std::copy(std::begin(r.axis_limit), std::end(r.axis_limit), std::begin(axis_limit_));
  heartbeat_ = r.heartbeat, fault_number_ = r.fault_number, status_.cycle = r.cycle;
  heartbeat_age_s_ = r.heartbeat_age_s;
  std::copy(std::begin(r.joint_jog_seen), std::end(r.joint_jog_seen), std::begin(joint_jog_seen_));
  std::copy(std::begin(r.axis_jog_seen), std::end(r.axis_jog_seen), std::begin(axis_jog_seen_));
  std::copy(std::begin(r.spindle_stop_seen), std::end(r.spindle_stop_seen),
            std::begin(spindle_stop_seen_));
  home_seen_ = r.home_seen, unhome_seen_ = r.unhome_seen, wishes_seen_ = r.wishes_seen;
  seen_ = r.seen;
  offset_before_ = executor_.tool_offset();
}

}  // namespace kerf::motion
