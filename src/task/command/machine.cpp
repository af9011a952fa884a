// Machine state, modes, homing and jogging.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "task/command/command_participant.hpp"

namespace kerf::task {

using motion::JogIntent;
using motion::MotionMode;

/// Those that wait for an estop reset or for the drives.
void CommandParticipant::end_state_tickets(CommandState how, const std::string& text) {
  std::vector<Ticket> ended;
  for (const auto& [ticket, pending] : pending_)
    if (pending.command == CommandId::state && pending.deadline != rtapi::kForever)
      ended.push_back(ticket);
  for (const Ticket ticket : ended) reply(ticket, how, text);
}

bool CommandParticipant::state_is_late(rtapi::Nanos after) const {
  return std::all_of(pending_.begin(), pending_.end(), [&](const auto& entry) {
    const Pending& pending = entry.second;
    return pending.command != CommandId::state || pending.deadline == rtapi::kForever ||
           now_ >= pending.deadline - kStateTime + after;
  });
}

std::string CommandParticipant::why_not_on() const {
  if (!state_is_late(kStateTime)) return {};
  // On a computer that is busy a second may pass before those that are asked have run at all: that is no answer yet.
  const bool asked = std::all_of(pending_.begin(), pending_.end(), [this](const auto& entry) {
    const Pending& pending = entry.second;
    return pending.command != CommandId::state || pending.deadline == rtapi::kForever ||
           status_.cycle >= pending.from_cycle + kCyclesToTurnOn;
  });
  const bool settled = view_.settled_epoch == epoch_;
  if ((!asked || !settled) && !state_is_late(kBusyTime)) return {};
  if (!asked)
    return "the machine did not turn on: motion does not run; is its function in a thread, and are "
           "the "
           "threads started?";
  if (status_.enabled && !settled)
    return "the machine did not turn on: the interpreter does not answer";
  return "the machine did not turn on; motion.enable or an amplifier says no";
}

void CommandParticipant::note_work() {
  const bool spins = std::any_of(std::begin(status_.spindle), std::end(status_.spindle),
                                 [](const motion::SpindleStatus& s) { return s.on; });
  if (state_ == TaskState::on && (spins || !idle())) worked_at_ = now_;
}

void CommandParticipant::update_machine() {
  note_work();
  p_.exchange.task_state.set(static_cast<std::uint32_t>(state_));
  p_.exchange.mode.set(static_cast<std::uint32_t>(mode_));
  if (resetting_) {
    if (io_.emc_enable_in && io_.user_enable) {
      resetting_ = false;
      state_ = TaskState::estop_reset;
      end_state_tickets(CommandState::done, {});
    } else if (state_is_late(kResetTime)) {
      resetting_ = false;
      p_.io.set_estop(true);
      const std::string why = "estop stays: iocontrol.0.emc-enable-in is FALSE";
      say(MessageKind::error, why);
      end_state_tickets(CommandState::error, why);
    }
  } else if (state_ != TaskState::estop && !io_.emc_enable_in) {
    go_estop("external estop: iocontrol.0.emc-enable-in is FALSE");
  }
  if (enabling_) {
    if (status_.enabled && status_.acked_epoch == epoch_ && view_.settled_epoch == epoch_) {
      enabling_ = false;
      state_ = TaskState::on;
      end_state_tickets(CommandState::done, {});
    } else if (const std::string why = why_not_on(); !why.empty()) {
      say(MessageKind::error, why);
      end_state_tickets(CommandState::error, why);
      go_off();
    }
  } else if (state_ == TaskState::on && !status_.enabled) {
    go_off();
  }
  // Overriding limits is for one jog off the switch.
  if (was_jogging_ && !status_.jogging && want_.override_limits) {
    want_.override_limits = false;
    write_intent();
  }
  was_jogging_ = status_.jogging;
  // A pause that came as the program ended held nothing, and must not hold what comes next.
  if (p_.exchange.paused.get() != 0 && idle()) {
    p_.motion.intent.hold.publish(0);
    p_.exchange.paused.set(0);
    held_spindles_known_ = false;
  }
  finish_block_step();
  if (block_step_due_ && taken(block_step_intent_)) begin_block_step();
  if (block_step_armed_ && taken(block_step_intent_)) release_block_step();
}

/// Motion stands at the end of the block that was asked for.
void CommandParticipant::finish_block_step() {
  if (!want_.single_step || block_step_armed_ || !taken(block_step_intent_) ||
      !(status_.held || status_.path_empty))
    return;
  const bool goes_on = p_.setup.step_by_moves && !status_.path_empty;
  if (goes_on && view_.block_id < status_.current.id) return;  // not known yet
  if (goes_on && view_.moved_id < status_.current.id) {
    // Motion has to see a hold between two blocks; for clients it is one step.
    p_.motion.intent.hold.publish(1);
    end_block_step();
    block_step_due_ = true;
    return;
  }
  // With an empty path the interpreter thread stands behind the block on its own.
  if (!status_.path_empty)
    pause();
  else
    end_block_step();
}

/// Behind a hold, or before its release, so that nothing moves for it.
void CommandParticipant::end_block_step() {
  block_step_due_ = block_step_armed_ = false;
  if (!want_.single_step) return;
  want_.single_step = false;
  block_step_intent_ = write_intent();
}

void CommandParticipant::abort_all(std::uint32_t reason) {
  p_.exchange.abort_reason.set(reason);
  p_.motion.intent.abort_epoch.publish(++epoch_);
  for (auto& seq : want_.spindle_stop_seq) ++seq;
  stop_jogs(kNobody);
  jog_intent_ = status_.intent_taken;  // the acknowledgement of the epoch says more
  end_away();
  want_.single_step = want_.backwards = false;
  block_step_due_ = block_step_armed_ = false;
  want_.path_shift = {};
  write_intent();
  p_.motion.intent.hold.publish(0);
  p_.exchange.paused.set(0);
  p_.exchange.stepping.set(0);
  p_.io.abort(epoch_, static_cast<std::int32_t>(reason));
  p_.exchange.wake_interpreter();
}

void CommandParticipant::go_estop(const char* why) {
  if (now_ - worked_at_ <= kJustNow) {
    worked_at_ = now_ - rtapi::kSecond;
    ++shown_.estops;
    shown_.estop_external = why != nullptr;
  }
  abort_all(why != nullptr ? abort_aux_estop : abort_state_estop);
  p_.motion.intent.enable.publish(0);
  p_.io.set_estop(true);
  enabling_ = resetting_ = false;
  end_state_tickets(CommandState::aborted, "estop came between");
  if (state_ != TaskState::estop && why != nullptr) say(MessageKind::error, why);
  state_ = TaskState::estop;
}

void CommandParticipant::go_off() {
  abort_all(abort_state_off);
  p_.motion.intent.enable.publish(0);
  if (enabling_) end_state_tickets(CommandState::aborted, "the machine was turned off");
  enabling_ = false;
  if (state_ != TaskState::estop) state_ = TaskState::estop_reset;
}

void CommandParticipant::do_state(Ticket ticket, const Request& request) {
  const std::string& wanted = request.text("state");
  Pending& pending = pending_[ticket];
  if (wanted == "estop") {
    go_estop(nullptr);
  } else if (wanted == "off") {
    go_off();
  } else if (wanted == "estop-reset") {
    if (state_ == TaskState::on) go_off();
    if (state_ != TaskState::estop) return reply(ticket, CommandState::done);
    if (!resetting_) reset_since_ = now_;
    resetting_ = true;
    pending.deadline = now_ + kStateTime;
    p_.io.request_reset();
  } else {
    if (state_ == TaskState::on) return reply(ticket, CommandState::done);
    if (state_ == TaskState::estop)
      return reply(ticket, CommandState::error,
                   "the machine is in estop: needs state estop-reset first");
    // A fresh epoch: what was queued while the drives were off is void.
    abort_all(abort_none);
    enabling_ = true;
    pending.deadline = now_ + kStateTime;
    if (++enable_request_ == 0) ++enable_request_;
    p_.motion.intent.enable.publish(enable_request_);
  }
  pending.epoch = epoch_;
}

void CommandParticipant::choose(TaskMode mode, MotionMode motion_mode) {
  mode_ = mode;
  want_.mode = motion_mode;
  back_to_.reset();
}

void CommandParticipant::set_mode(TaskMode mode) {
  const MotionMode motion_mode = mode != TaskMode::manual ? MotionMode::coordinated
                                 : all_homed()            ? MotionMode::teleop
                                                          : MotionMode::free;
  choose(mode, motion_mode);
  if (motion_mode != MotionMode::free) stop_jogs(kNobody);
  write_intent();
}

void CommandParticipant::go_back() {
  if (!back_to_ || !idle()) return;
  const Back back = *back_to_;
  set_mode(back.mode);
  if (back.mode != TaskMode::manual || back.motion != MotionMode::free) return;
  want_.mode = MotionMode::free;
  write_intent();
}

void CommandParticipant::do_mode(Ticket ticket, const Request& request) {
  const std::string& name = request.text("mode");
  const TaskMode mode = name == "manual" ? TaskMode::manual
                        : name == "auto" ? TaskMode::automatic
                                         : TaskMode::mdi;
  if (mode == mode_) {
    back_to_.reset();
    return reply(ticket, CommandState::done);
  }
  if (!idle())
    return reply(ticket, CommandState::error,
                 mode_ == TaskMode::automatic
                     ? "Can't switch mode while mode is AUTO and interpreter is not IDLE"
                     : "can't change the mode while something runs; abort or wait");
  set_mode(mode);
  // With the drives off motion stays where it is until they are on.
  if (state_ != TaskState::on) return reply(ticket, CommandState::done);
  pending_[ticket].deadline = now_ + kStateTime;
}

bool CommandParticipant::refuse_unless_on(Ticket ticket, const char* what) {
  if (state_ == TaskState::on) return false;
  const std::string text =
      std::string(what) + " cannot be executed until the machine is out of E-stop and turned on";
  say(MessageKind::error, text);
  reply(ticket, CommandState::error, text);
  return true;
}

void CommandParticipant::do_home(Ticket ticket, const Request& request) {
  const int joint = request.integer("joint", -1);
  if (refuse_unless_on(ticket, "command (EMC_JOINT_HOME)")) return;
  if (joint < -1 || joint >= p_.setup.motion.joints)
    return reply(ticket, CommandState::error,
                 "joint " + std::to_string(joint) + " does not exist: expected -1 to " +
                     std::to_string(p_.setup.motion.joints - 1));
  // A spindle's words move nothing, but while they are on the path it is not left.
  const bool on_path = status_.mode == MotionMode::coordinated && other_orders(ticket);
  if (!view_.idle || moving_orders(ticket) || on_path || homing(ticket) || jogs())
    return reply(ticket, CommandState::error, "can't home while something runs");
  choose(TaskMode::manual, MotionMode::free);
  want_.home_joint = joint;
  ++want_.home_seq;
  Pending& pending = pending_[ticket];
  pending.joint = joint;
  // Homing is a state of its own; what was homed and is homed again must not look done.
  pending.intent = write_intent();
}

void CommandParticipant::do_unhome(Ticket ticket, const Request& request) {
  const int joint = request.integer("joint", -1);
  if (joint < -2 || joint >= p_.setup.motion.joints)
    return reply(ticket, CommandState::error,
                 "joint " + std::to_string(joint) + " does not exist: expected -2 to " +
                     std::to_string(p_.setup.motion.joints - 1));
  if (state_ == TaskState::on &&
      (status_.mode != MotionMode::free || want_.mode != MotionMode::free)) {
    const std::string text = "must be in joint mode or disabled to unhome";
    say(MessageKind::error, text);
    return reply(ticket, CommandState::error, text);
  }
  if (homing()) return reply(ticket, CommandState::error, "can't unhome while the machine homes");
  want_.unhome_joint = joint;
  ++want_.unhome_seq;
  pending_[ticket].intent = write_intent();
}

JogIntent* CommandParticipant::find_jog(const std::string& what, bool& axis, std::size_t& index,
                                        std::string& why) {
  char* end = nullptr;
  const long number = std::strtol(what.c_str(), &end, 10);
  axis = end == what.c_str() || *end != '\0';
  if (!axis) {
    if (number < 0 || number >= p_.setup.motion.joints) {
      why = "joint " + what + " does not exist: expected 0 to " +
            std::to_string(p_.setup.motion.joints - 1);
      return nullptr;
    }
    index = static_cast<std::size_t>(number);
    return &want_.joint_jog[index];
  }
  const int at = what.size() == 1 ? rtapi::axis_index(what[0]) : -1;
  if (at < 0 || (p_.setup.motion.axis_mask & (1U << static_cast<unsigned>(at))) == 0) {
    why = "axis '" + what +
          "' does not exist: expected a letter of [TRAJ]COORDINATES or a joint number";
    return nullptr;
  }
  index = static_cast<std::size_t>(at);
  return &want_.axis_jog[index];
}

void CommandParticipant::do_jog(Ticket ticket, const Request& request, int client) {
  const std::string& what = request.text("what");
  bool axis = false;
  std::size_t index = 0;
  std::string why;
  JogIntent* jog = find_jog(what, axis, index, why);
  if (jog == nullptr) return reply(ticket, CommandState::error, why);
  if (refuse_unless_on(ticket, "jog")) return;
  const bool away = axis && status_.away && returning_ == Returning::no;
  const bool in_mode = request.flag("in-mode");
  if (!away && in_mode && (mode_ != TaskMode::manual || !view_.idle))
    return reply(ticket, CommandState::error,
                 "jog needs manual mode and an idle machine (mode manual)");
  if (axis && !away && want_.mode != MotionMode::teleop && (in_mode || !all_homed()))
    return reply(ticket, CommandState::error,
                 "jogging an axis needs teleop mode and homed joints (home, teleop on)");
  if (homing()) return reply(ticket, CommandState::error, "can't jog while the machine homes");
  if (!axis && (in_mode || status_.away) && want_.mode != MotionMode::free)
    return reply(ticket, CommandState::error, "jogging a joint needs joint mode (teleop off)");
  const MotionMode wanted = axis ? MotionMode::teleop : MotionMode::free;
  if (!away && (mode_ != TaskMode::manual || want_.mode != wanted)) {
    if (!idle())
      return reply(ticket, CommandState::error, "can't jog while something runs; abort or wait");
    stop_jogs(kNobody);
    // Mode and jog go out as one: motion changes the mode before it looks at jogs.
    choose(TaskMode::manual, wanted);
  }
  const bool rotary = axis ? rtapi::is_rotary(index) : p_.setup.motion.joint[index].rotary;
  const double unit = rotary ? p_.setup.angular_unit_deg : p_.setup.linear_unit_mm;
  const double speed = request.number("speed") * unit;
  JogLease lease;
  if (!request.has("distance")) lease.owner = client;
  if (request.has("lease")) {
    constexpr double kLeast = 0.05, kMost = 3600;  // below, beats of this thread are too far apart
    const double seconds = request.number("lease");
    if (!(seconds >= kLeast && seconds <= kMost) || request.has("distance"))
      return reply(ticket, CommandState::error,
                   "lease belongs to a jog without distance and is 0.05 to 3600 seconds");
    lease.silence = static_cast<rtapi::Nanos>(seconds * 1e9);
  }
  ++jog->seq;
  if (request.has("distance")) {
    jog->kind = JogIntent::Kind::incremental;
    jog->vel = std::fabs(speed);
    jog->target = std::copysign(1.0, speed) * request.number("distance") * unit;
  } else {
    jog->kind = JogIntent::Kind::continuous;
    jog->vel = speed;
    jog->target = 0;
  }
  (axis ? axis_lease_[index] : joint_lease_[index]) = lease;
  jog_intent_ = write_intent();
  reply(ticket, CommandState::done);
}

void CommandParticipant::do_jog_stop(Ticket ticket, const Request& request) {
  if (!request.has("what")) {
    stop_jogs(kNobody);
    return reply(ticket, CommandState::done);
  }
  bool axis = false;
  std::size_t index = 0;
  std::string why;
  JogIntent* jog = find_jog(request.text("what"), axis, index, why);
  if (jog == nullptr) return reply(ticket, CommandState::error, why);
  ++jog->seq;
  jog->kind = JogIntent::Kind::none;
  write_intent();
  reply(ticket, CommandState::done);
}

/// Stops the jogs that live by a client's connection; kNobody: all jogs.
void CommandParticipant::stop_jogs(int client) {
  bool any = false;
  const auto stop = [&](JogIntent& jog, JogLease& lease) {
    if (jog.kind == JogIntent::Kind::none || (client != kNobody && lease.owner != client)) return;
    ++jog.seq;
    jog.kind = JogIntent::Kind::none;
    lease = {};
    any = true;
  };
  for (std::size_t j = 0; j < motion::kMaxJoints; ++j) stop(want_.joint_jog[j], joint_lease_[j]);
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) stop(want_.axis_jog[a], axis_lease_[a]);
  if (any) write_intent();
}

rtapi::Nanos CommandParticipant::last_heard(int client) const {
  if (client == kLocal) return heard_local_;
  for (const auto& c : clients_)
    if (c->number == client) return c->heard;
  return 0;
}

/// The connection is there, but whoever holds it has not said that he lives: his program hangs, or his network is gone.
void CommandParticipant::stop_silent_jogs() {
  const auto watch = [&](const JogIntent& jog, const JogLease& lease, const std::string& what) {
    if (jog.kind != JogIntent::Kind::continuous || lease.silence == rtapi::kForever) return;
    const rtapi::Nanos silent = now_ - last_heard(lease.owner);
    if (silent <= lease.silence) return;
    say(MessageKind::error, "Jog of " + what + " stopped: its client said nothing for " +
                                std::to_string(silent / rtapi::kMillisecond) + " ms");
    stop_jogs(lease.owner);
  };
  for (std::size_t j = 0; j < motion::kMaxJoints; ++j)
    watch(want_.joint_jog[j], joint_lease_[j], "joint " + std::to_string(j));
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    watch(want_.axis_jog[a], axis_lease_[a], std::string("axis ") + rtapi::kAxisLetters[a]);
}

void CommandParticipant::do_teleop(Ticket ticket, const Request& request) {
  const bool on = request.flag("on");
  if (!view_.idle || moving_orders(ticket) || (on && homing()))
    return reply(ticket, CommandState::error,
                 "can't change between joint and teleop mode while something runs; abort or wait");
  if (on && !all_homed())
    return reply(ticket, CommandState::error, "teleop needs all joints homed");
  stop_jogs(kNobody);
  // Both belong to manual mode. Screens ask for them from idle MDI and auto mode too, before they start a program.
  choose(TaskMode::manual, on ? MotionMode::teleop : MotionMode::free);
  write_intent();
  if (state_ != TaskState::on) return reply(ticket, CommandState::done);
  pending_[ticket].deadline = now_ + kStateTime;
}

void CommandParticipant::do_motion_mode(Ticket ticket, const Request& request) {
  const std::string& name = request.text("mode");
  const MotionMode wanted = name == "free"     ? MotionMode::free
                            : name == "teleop" ? MotionMode::teleop
                                               : MotionMode::coordinated;
  if (want_.mode == wanted) return reply(ticket, CommandState::done);
  if (!view_.idle || moving_orders(ticket) || homing())
    return reply(ticket, CommandState::error,
                 "can't change the motion mode while something runs; abort or wait");
  if (wanted != MotionMode::free && !all_homed() && !machine_.no_force_homing)
    return reply(ticket, CommandState::error, "motion mode " + name + " needs all joints homed");
  stop_jogs(kNobody);
  choose(mode_, wanted);
  write_intent();
  if (state_ != TaskState::on) return reply(ticket, CommandState::done);
  pending_[ticket].deadline = now_ + kStateTime;
}

void CommandParticipant::do_joint_limit(Ticket ticket, const Request& request) {
  const int index = request.integer("joint");
  if (index < 0 || index >= machine_.joints)
    return reply(ticket, CommandState::error,
                 "joint " + std::to_string(index) + " does not exist: expected 0 to " +
                     std::to_string(machine_.joints - 1));
  motion::JointConfig& joint = machine_.joint[index];
  const double unit = p_.setup.joint_unit[static_cast<std::size_t>(index)];
  const double low = request.has("min") ? request.number("min") * unit : joint.min_limit;
  const double high = request.has("max") ? request.number("max") * unit : joint.max_limit;
  if (!(low < high))
    return reply(
        ticket, CommandState::error,
        "joint " + std::to_string(index) + ": the lower limit must be below the upper one");
  joint.min_limit = low;
  joint.max_limit = high;
  p_.motion.config.write(machine_);
  reply(ticket, CommandState::done);
}

}  // namespace kerf::task
