#include "clients/motion_logger/stand_in.hpp"

#include <algorithm>

namespace kerf::motion_logger {

using namespace motion;

void StandIn::log(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) sink_(line);
}

void StandIn::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(shared_.path_cell);
  next.wake_at(now + kPeriod);
  take_config();
  take_wishes();
  take_path();
  ++status_.cycle;
  status_.time_ns = now;
  status_.servo_period_ns = kPeriod;
  status_.path_empty = shared_.path.empty();
  status_.place = status_.pos_cmd;
  shared_.status.write(status_);
  shared_.status_cell.notify();
}

void StandIn::take_config() {
  MachineConfig now;
  if (!shared_.config.read(now, 2) || now.joints == 0) return;
  log(changes(config_, now));
  config_ = now;
  status_.joints = now.joints;
  status_.spindles = now.spindles;
}

void StandIn::take_wishes() {
  // Task raises the abort epoch before it writes what goes with it, so the values are read first: with new values the epoch is new too,
  // and an abort always stands before its consequences.
  Intent values;
  const bool known = shared_.intent.values.version() != 0 && shared_.intent.values.read(values, 2);
  IntentWords words;
  words.abort_epoch = shared_.intent.abort_epoch.observe();
  words.enable = shared_.intent.enable.observe() != 0;
  words.hold = shared_.intent.hold.observe() != 0;
  IntentWords aborted = words_;
  aborted.abort_epoch = words.abort_epoch;
  log(changes(words_, aborted));
  carry_out(aborted);
  if (known) {
    log(changes(intent_, values, config_.spindles));
    carry_out(values);
  }
  // Drives and hold change last, as task has it when it aborts and then turns on.
  log(changes(words_, words));
  carry_out(words);
}

void StandIn::carry_out(const IntentWords& now) {
  if (words_.hold && !now.hold) step_block_ = 0;
  words_ = now;
  status_.acked_epoch = now.abort_epoch;
  status_.enabled = status_.amp_ready = now.enable;
  status_.held = now.hold;
  for (std::int32_t j = 0; j < status_.joints; ++j) status_.joint[j].enabled = now.enable;
}

void StandIn::carry_out(const Intent& now) {
  if (now.home_seq != intent_.home_seq) home(now.home_joint, true);
  if (now.unhome_seq != intent_.unhome_seq) home(now.unhome_joint, false);
  if (now.single_step != intent_.single_step) step_block_ = 0;
  carry_out_jogs(now);
  carry_out_switches(now);
  intent_ = now;
  status_.mode = now.mode;
  status_.intent_taken = now.serial;
  status_.feed_override = now.feed_override;
  status_.rapid_override = now.rapid_override;
}

void StandIn::carry_out_jogs(const Intent& now) {
  for (std::size_t j = 0; j < kMaxJoints; ++j) {
    const JogIntent& jog = now.joint_jog[j];
    if (jog.seq == intent_.joint_jog[j].seq) continue;
    double& at = status_.joint[j].pos_cmd;
    if (jog.kind == JogIntent::Kind::incremental) at += jog.target;
    if (jog.kind == JogIntent::Kind::absolute) at = jog.target;
    status_.joint[j].pos_fb = at;
  }
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    const JogIntent& jog = now.axis_jog[a];
    if (jog.seq == intent_.axis_jog[a].seq) continue;
    Pose end = status_.pos_cmd;
    if (jog.kind == JogIntent::Kind::incremental) end[a] += jog.target;
    if (jog.kind == JogIntent::Kind::absolute) end[a] = jog.target;
    move_to(end);
  }
}

void StandIn::carry_out_switches(const Intent& now) {
  for (std::size_t s = 0; s < kMaxSpindles; ++s) {
    if (now.spindle_stop_seq[s] != intent_.spindle_stop_seq[s]) stop_spindle(s);
    if (now.brake[s].seq != intent_.brake[s].seq) {
      if (now.brake[s].value) stop_spindle(s);
      status_.spindle[s].brake = now.brake[s].value;
    }
    if (now.spindle_override_enable[s].seq != intent_.spindle_override_enable[s].seq)
      status_.enables.spindle[s] = now.spindle_override_enable[s].value;
  }
  for (std::size_t n = 0; n < kMaxDigital; ++n)
    if (now.digital_out[n].seq != intent_.digital_out[n].seq)
      set_digital(n, now.digital_out[n].value);
  for (std::size_t n = 0; n < kMaxAnalog; ++n)
    if (now.analog_out[n].seq != intent_.analog_out[n].seq)
      status_.analog_out[n] = now.analog_out[n].value;
  if (now.feed_override_enable.seq != intent_.feed_override_enable.seq)
    status_.enables.feed = now.feed_override_enable.value;
  if (now.adaptive_feed_enable.seq != intent_.adaptive_feed_enable.seq)
    status_.enables.adaptive = now.adaptive_feed_enable.value;
  if (now.feed_hold_enable.seq != intent_.feed_hold_enable.seq)
    status_.enables.feed_hold = now.feed_hold_enable.value;
}

void StandIn::take_path() {
  while (const PathItem* item = shared_.path.front()) {
    // An item of an epoch that was begun since the wishes were read comes after them.
    if (item->epoch != words_.abort_epoch) take_wishes();
    if (item->epoch == words_.abort_epoch) {
      if (words_.hold) return;
      if (intent_.single_step) {
        if (step_block_ == 0) step_block_ = item->tag.id;
        if (step_block_ != item->tag.id) return;
      }
      sink_(text_of(*item));
      execute(*item);
    }
    shared_.path.pop();
  }
}

void StandIn::execute(const PathItem& item) {
  status_.current = item.tag;
  status_.current_seq = status_.executed_seq = item.seq;
  std::visit(Overloaded{
                 [this](const LinearMove& m) {
                   status_.kind = m.kind;
                   move_to(m.end);
                 },
                 [this](const ArcMove& m) {
                   status_.kind = m.kind;
                   move_to(m.end);
                 },
                 [this](const CubicMove& m) {
                   status_.kind = MotionKind::feed;
                   move_to(m.end);
                 },
                 [](const Dwell&) {},
                 [this](const OutputChange& o) {
                   const auto n = static_cast<std::size_t>(std::max(0, o.index));
                   if (!o.analog)
                     set_digital(n, o.value != 0);
                   else if (n < kMaxAnalog)
                     status_.analog_out[n] = o.value;
                 },
                 [this](const SpindleChange& s) {
                   if (s.spindle < 0 || s.spindle >= static_cast<int>(kMaxSpindles)) return;
                   SpindleStatus& spindle = status_.spindle[s.spindle];
                   using Action = SpindleChange::Action;
                   if (s.action == Action::stop)
                     return stop_spindle(static_cast<std::size_t>(s.spindle));
                   if (s.action == Action::orient) {
                     stop_spindle(static_cast<std::size_t>(s.spindle));
                     spindle.orient_state = 2;
                     return;
                   }
                   spindle.orient_state = 0;
                   if (s.action != Action::set_speed) {
                     spindle.on = true;
                     spindle.brake = false;
                     spindle.direction = s.action == Action::forward ? 1 : -1;
                   }
                   spindle.speed_rpm = s.speed_rpm * (spindle.direction < 0 ? -1 : 1);
                 },
                 [](const PathControl&) {},
                 [this](const OverrideEnable& o) { status_.enables = o; },
                 [this](const ToolOffset& t) { status_.tool_offset = t.offset; },
                 [this](const ProbeMove& p) {
                   status_.kind = MotionKind::probing;
                   status_.probe_tripped = true;
                   status_.probed = p.end;
                   move_to(p.end);
                 },
                 [](const Marker&) {},
                 [this](const SyncMove& m) {
                   status_.kind = MotionKind::feed;
                   move_to(m.end);
                 },
                 [this](const TapMove&) { status_.kind = MotionKind::feed; },
                 [](const FeedPerRev&) {},
             },
             item.body);
}

/// As long as the kinematics are plain: joint j is the j-th axis of the machine.
void StandIn::move_to(const Pose& end) {
  status_.pos_cmd = status_.pos_fb = end;
  std::int32_t j = 0;
  for (std::size_t a = 0; a < rtapi::kAxes && j < status_.joints; ++a) {
    if ((config_.axis_mask & (1U << a)) == 0) continue;
    status_.joint[j].pos_cmd = status_.joint[j].pos_fb = end[a];
    ++j;
  }
}

void StandIn::home(std::int32_t joint, bool homed) {
  Pose end = status_.pos_cmd;
  std::int32_t j = 0;
  for (std::size_t a = 0; a < rtapi::kAxes && j < status_.joints; ++a) {
    if ((config_.axis_mask & (1U << a)) == 0) continue;
    if (homed && (joint < 0 || joint == j)) end[a] = config_.joint[j].home;
    ++j;
  }
  status_.all_homed = status_.joints > 0;
  for (j = 0; j < status_.joints; ++j) {
    JointStatus& one = status_.joint[j];
    const bool meant = joint == j || joint == -1 || (joint == -2 && config_.joint[j].volatile_home);
    if (meant) one.homed = homed;
    status_.all_homed = status_.all_homed && one.homed;
  }
  if (homed) move_to(end);
}

void StandIn::stop_spindle(std::size_t spindle) {
  SpindleStatus& s = status_.spindle[spindle];
  s.on = false;
  s.brake = true;
  s.direction = 0;
  s.speed_rpm = 0;
  s.orient_state = 0;
}

void StandIn::set_digital(std::size_t index, bool on) {
  if (index >= kMaxDigital) return;
  const std::uint64_t bit = std::uint64_t{1} << index;
  status_.digital_out = on ? status_.digital_out | bit : status_.digital_out & ~bit;
}

}  // namespace kerf::motion_logger
