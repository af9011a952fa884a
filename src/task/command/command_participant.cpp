#include "task/command/command_participant.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "motion/api/faults.hpp"
#include "rtapi/shm/socket.hpp"
#include "rtapi/sync/patient_read.hpp"
#include "task/api/message_reader.hpp"

namespace kerf::task {

namespace {

/// True for faults after which a running program cannot go on.
bool ends_program(motion::Fault fault) noexcept {
  using motion::Fault;
  switch (fault) {
    case Fault::home_failed:
    case Fault::home_no_switch:
    case Fault::home_busy:
    case Fault::jog_while_not_ready:
    case Fault::jog_beyond_limit:
    case Fault::limit_velocity:
    case Fault::limit_acceleration:
    case Fault::limit_jerk:
    case Fault::limit_path:
    case Fault::overrun:
    case Fault::sync_behind: return false;
    default: return true;
  }
}

}  // namespace

CommandParticipant::CommandParticipant(const Parts& parts) : p_(parts) {
  (void)rtapi::read_patiently(p_.motion.status, status_);
  epoch_ = p_.motion.intent.abort_epoch.observe();
  beats_ = p_.motion.intent.heartbeat.get();
  motion::Intent old;
  if (p_.motion.intent.values.version() > 0 && p_.motion.intent.values.read(old))
    want_ = old;  // sequence numbers go on
  machine_ = p_.setup.motion;
  debug_ = p_.setup.debug;
  want_.mode = motion::MotionMode::free;
  want_.max_vel_mm_s = machine_.traj_max_vel_mm_s;
  faults_seen_ = p_.motion.faults.newest.observe();
  messages_ = p_.shared.messages.newest.observe();
  for (std::size_t j = 0; j < p_.setup.screws.size() && j < motion::kMaxJoints; ++j)
    p_.motion.screw[j].write(p_.setup.screws[j]);
  p_.motion.config.write(machine_);
  enable_request_ = p_.motion.intent.enable.observe();
  p_.motion.intent.enable.publish(0);
  p_.motion.intent.hold.publish(0);
  write_intent();
}

CommandParticipant::~CommandParticipant() {
  p_.shared.ready.publish(0);
  for (auto& c : clients_) rtapi::close_fd(c->fd);
  if (listener_ >= 0) rtapi::close_fd(listener_);
}

void CommandParticipant::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(p_.shared.inbox);
  next.watch(p_.shared.to_command);
  next.watch(p_.motion.status_cell);
  now_ = now;
  if (!p_.motion.status.read(status_)) next.wake_at(now + rtapi::kReadAgain);
  io_ = p_.io.state();
  beat();
  p_.exchange.read_view(view_);  // a fault of the first block finds the program running
  take_faults();
  take_reports();
  p_.exchange.read_view(view_);
  update_machine();
  update_away();
  serve_clients();
  update_pending();
  go_back();
  write_status();
  write_journal();
  send_replies();
  p_.shared.ready.publish(1);
  next.wake_at(next_beat_);
  // A connection that cannot be taken now must not wake this thread all the time; the next beat looks again.
  if (accepts()) next.watch_fd(listener_);
  for (const auto& c : clients_) next.watch_fd(c->fd);
}

void CommandParticipant::beat() {
  if (now_ < next_beat_) return;
  p_.motion.intent.heartbeat.set(++beats_);
  next_beat_ = (now_ / kBeat + 1) * kBeat;
  read_ini_pins();
  stop_silent_jogs();
  for (rtapi::LogRecord record; p_.realtime_log != nullptr && p_.realtime_log->next(record);)
    if (record.level == rtapi::Level::error) say(MessageKind::error, rtapi::text_of(record));
}

void CommandParticipant::read_ini_pins() {
  if (p_.live == nullptr || p_.ini_pins == nullptr) return;
  std::vector<std::string> complaints;
  const motion::MachineConfig before = machine_;
  const bool changed = p_.live->take(p_.ini_pins->read(), machine_, complaints);
  for (const std::string& text : complaints) say(MessageKind::error, text);
  if (!changed) return;
  const motion::MachineConfig& now = machine_;
  // Motion takes it when nothing moves; until then the old limits hold.
  p_.motion.config.write(now);
  std::array<double, motion::kMaxJoints> at{};
  std::array<bool, motion::kMaxJoints> homed{};
  for (std::size_t j = 0; j < static_cast<std::size_t>(now.joints); ++j) {
    at[j] = status_.joint[j].pos_cmd;
    homed[j] = status_.joint[j].homed;
  }
  for (const std::string& text : beyond_new_limits(before, now, at, homed, p_.setup))
    say(MessageKind::error, text);
  // Who asked for the whole of the old limit has the whole of the new one.
  if (want_.max_vel_mm_s > now.traj_max_vel_mm_s ||
      want_.max_vel_mm_s == before.traj_max_vel_mm_s) {
    want_.max_vel_mm_s = now.traj_max_vel_mm_s;
    write_intent();
  }
}

void CommandParticipant::take_faults() {
  const std::uint64_t newest = p_.motion.faults.newest.observe();
  if (newest > faults_seen_ + motion::FaultLog::kSlots)
    faults_seen_ = newest - motion::FaultLog::kSlots;
  std::string stop;
  bool late = false;
  while (faults_seen_ < newest) {
    ++faults_seen_;
    motion::FaultRecord fault;
    if (!p_.motion.faults.slot[faults_seen_ % motion::FaultLog::kSlots].read(fault) ||
        fault.number != faults_seen_)
      continue;
    // Whoever typed a line of MDI knows which.
    const bool typed = fault.tag.call_level == 0 &&
                       std::any_of(pending_.begin(), pending_.end(), [](const auto& p) {
                         return p.second.begun && p.second.command == CommandId::mdi;
                       });
    const bool placed = fault.tag.line > 0 && !view_.idle && !typed;
    motion::FaultRecord shown = fault;
    if (placed || typed) shown.tag.line = 0;  // the message begins with its place
    last_fault_ = motion::fault_text(shown, machine_);
    // The machine may still be in a sub of another file. Before the first block is executed, the source is unknown and can only
    // be the program.
    const bool main = view_.source.empty() || fault.tag.call_level == 0;
    const auto& source = main ? view_.file : view_.source;
    say(MessageKind::error, last_fault_, placed ? std::string(source.view()) : std::string(),
        placed ? fault.tag.line : 0);
    late = late || fault.fault == motion::Fault::overrun;
    if (stop.empty() && ends_program(fault.fault)) stop = last_fault_;
  }
  if (late) after_overrun();
  if (stop.empty() || view_.idle) return;
  abort_all(abort_motion_error);
  // Whoever asked for what was running learns why it ended.
  std::vector<Ticket> ended;
  for (const auto& [ticket, pending] : pending_)
    if (pending.order && pending.begun) ended.push_back(ticket);
  for (const Ticket ticket : ended) {
    if (is_program(pending_.at(ticket).command)) ++programs_ended_;
    last_said_ = last_fault_;
    reply(ticket, CommandState::error, stop);
  }
}

void CommandParticipant::take_reports() {
  for (Report& report : p_.exchange.take_reports()) {
    switch (report.kind) {
      case Report::Kind::begun:
        if (const auto at = pending_.find(report.ticket); at != pending_.end()) {
          at->second.begun = true;
          reply(report.ticket, CommandState::running);
        }
        break;
      case Report::Kind::finished: {
        const auto at = pending_.find(report.ticket);
        if (at != pending_.end() &&
            (at->second.command == CommandId::run || at->second.command == CommandId::step))
          ++programs_ended_;
        if (at != pending_.end() && at->second.command == CommandId::open &&
            report.state == CommandState::error) {
          say(MessageKind::error, report.text);
          // What screens and scripts look for.
          say(MessageKind::error, "can't open " + at->second.file);
          last_said_ = report.text;
        }
        reply(report.ticket, report.state, report.text);
        break;
      }
      case Report::Kind::message: say(report.message, report.text, report.file, report.line); break;
      case Report::Kind::failed: {
        say(MessageKind::error, report.text, report.file, report.line);
        const auto at = pending_.find(report.ticket);
        if (at != pending_.end() && at->second.command != CommandId::mdi) ++programs_ended_;
        if (report.epoch == epoch_) abort_all(report.reason);
        reply(report.ticket, CommandState::error, report.text);
        break;
      }
      case Report::Kind::path_shift: take_shift(report); break;
      case Report::Kind::program_end: break;
    }
  }
}

/// A cycle came late, and the INI file wants more of it than a line in the log. With estop motion has switched off already.
void CommandParticipant::after_overrun() {
  if (machine_.overrun == motion::OverrunPolicy::estop)
    go_estop("estop, since a servo cycle came too late ([KERF]OVERRUN = estop)");
  else if (!view_.idle)
    pause();
}

std::string CommandParticipant::homing_failure(const Pending& pending) const {
  if (faults_seen_ != pending.fault_mark) return last_fault_;
  return pending.joint < 0 ? "not all joints are homed: HOME ALL homes those with a HOME_SEQUENCE"
                           : "joint " + std::to_string(pending.joint) + " was not homed";
}

bool CommandParticipant::homing(Ticket but) const {
  return status_.homing_active ||
         std::any_of(pending_.begin(), pending_.end(), [&](const auto& entry) {
           return entry.first != but && entry.second.command == CommandId::home &&
                  entry.second.epoch == epoch_;
         });
}

bool CommandParticipant::all_homed() const {
  return status_.all_homed && std::none_of(pending_.begin(), pending_.end(), [](const auto& entry) {
           return entry.second.command == CommandId::unhome;
         });
}

bool CommandParticipant::moving_orders(Ticket but) const {
  return std::any_of(pending_.begin(), pending_.end(), [&](const auto& entry) {
    const Pending& pending = entry.second;
    return entry.first != but && pending.order && pending.epoch == epoch_ &&
           (is_program(pending.command) || pending.command == CommandId::mdi);
  });
}

bool CommandParticipant::idle() const {
  for (const auto& [ticket, pending] : pending_)
    if (pending.order) return false;
  return view_.idle && !aborting() && at_rest() && !homing() && !jogs();
}

void CommandParticipant::update_pending() {
  std::vector<Ticket> tickets;
  for (const auto& [ticket, pending] : pending_)
    if (!pending.order) tickets.push_back(ticket);
  for (const Ticket ticket : tickets) {
    const Pending pending = pending_.at(ticket);
    switch (pending.command) {
      case CommandId::abort:
      case CommandId::state:
        // estop and off are done at rest; reset and on are ended by update_machine().
        if (pending.deadline == rtapi::kForever && view_.settled_epoch == epoch_ &&
            status_.acked_epoch == epoch_)
          reply(ticket, CommandState::done);
        break;
      case CommandId::wait:
        if (idle()) reply(ticket, CommandState::done);
        break;
      case CommandId::mode:
      case CommandId::teleop:
      case CommandId::motion_mode:
        if (status_.mode == want_.mode)
          reply(ticket, CommandState::done);
        else if (now_ >= pending.deadline)
          reply(ticket, CommandState::error, "motion did not change its mode");
        break;
      case CommandId::home: {
        if (pending.epoch != epoch_) {
          reply(ticket, CommandState::aborted, "aborted");
          break;
        }
        if (!taken(pending.intent) || status_.homing_active) break;
        const bool homed =
            pending.joint < 0 ? status_.all_homed : status_.joint[pending.joint].homed;
        // As in LinuxCNC: who has homed all joints jogs axes from then on.
        if (homed && status_.all_homed && mode_ == TaskMode::manual &&
            want_.mode == motion::MotionMode::free) {
          want_.mode = motion::MotionMode::teleop;
          write_intent();
        }
        reply(ticket, homed ? CommandState::done : CommandState::error,
              homed ? std::string() : homing_failure(pending));
        break;
      }
      case CommandId::away:
      case CommandId::back:
        if (pending.epoch != epoch_)
          reply(ticket, CommandState::aborted, "aborted");
        else if (pending.command == CommandId::back && returning_ == Returning::no && !status_.away)
          reply(ticket, CommandState::done);
        else if (pending.command == CommandId::away && status_.away)
          reply(ticket, CommandState::done);
        break;
      case CommandId::exchange_tool:
        if (pending.epoch != epoch_)
          reply(ticket, CommandState::aborted, "aborted");
        else if (pending.begun && status_.path_shift == want_.path_shift)
          reply(ticket, CommandState::done);
        break;
      case CommandId::unhome:
        if (taken(pending.intent)) reply(ticket, CommandState::done);
        break;
      default: break;
    }
  }
}

std::vector<OperatorMessage> CommandParticipant::newest_messages(std::uint64_t cursor) const {
  constexpr std::size_t kMost = 100;
  auto all = read_messages(p_.shared.messages, cursor);
  if (all.size() > kMost) all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(kMost));
  return all;
}

void CommandParticipant::say(MessageKind kind, const std::string& text, const std::string& file,
                             std::int32_t line) {
  last_said_ = text;
  OperatorMessage message;
  message.number = ++messages_;
  message.time_ns = now_;
  message.kind = kind;
  message.line = line;
  message.file = rtapi::FixedString<160>(file);
  const bool placed = file.empty() || text.rfind(file, 0) == 0;
  message.text = rtapi::FixedString<700>(
      placed ? text : file + (line > 0 ? ":" + std::to_string(line) : std::string()) + ": " + text);
  if (kind == MessageKind::error) ++error_messages_;
  p_.shared.messages.slot[message.number % MessageLog::kSlots].write(message);
  p_.shared.messages.newest.publish(message.number);
}

namespace {

void say_wait(WaitingFor& wait, const std::string& object, const std::string& pin) {
  wait.object = rtapi::FixedString<63>(object);
  wait.pin = rtapi::FixedString<63>(pin);
}

/// What a joint waits for in a state of its homing, as in joint.N.home-state; false: it only moves.
bool homing_wait(WaitingFor& wait, std::size_t j, std::int32_t state) {
  constexpr std::int32_t kFirstSwitch = 1, kLastSwitch = 4, kUnlock = 8, kIndex = 9, kLock = 10;
  const std::string joint = "joint." + std::to_string(j) + ".";
  const std::string of = " of joint " + std::to_string(j);
  if (state >= kFirstSwitch && state <= kLastSwitch)
    say_wait(wait, "the home switch" + of, joint + "home-sw-in");
  else if (state == kIndex)
    say_wait(wait, "the encoder's index" + of, joint + "index-enable");
  else if (state == kUnlock || state == kLock)
    say_wait(wait, (state == kUnlock ? "unlocking" : "locking") + of, joint + "is-unlocked");
  else
    return false;
  return true;
}

/// Everything that scales the feed and is 0: what the operator set, and the pin that he may look at.
void override_wait(WaitingFor& wait, const motion::MotionStatus& status,
                   const motion::Intent& want) {
  std::string what;
  const auto add = [&](bool is_zero, const char* name) {
    if (is_zero) what += what.empty() ? name : std::string(", ") + name;
  };
  add(status.enables.feed && want.feed_override <= 0, "feed override");
  add(want.rapid_override <= 0, "rapid override");
  add(want.max_vel_mm_s <= 0, "maximum velocity");
  // Its value is read in the servo cycle alone: with everything else above 0 it is this one.
  const bool adaptive = status.enables.adaptive;
  add(adaptive, "adaptive feed");
  say_wait(wait, what.empty() ? "a feed override above 0" : what + " above 0",
           adaptive ? "motion.adaptive-feed" : "");
}

void motion_wait(WaitingFor& wait, const motion::MotionStatus& status, const motion::Intent& want) {
  const std::string spindle = "spindle." + std::to_string(std::max(status.waiting_index, 0));
  if (status.away) return say_wait(wait, "return to the path, then resume", "");
  switch (status.waiting_for) {
    case motion::PathWait::none: break;
    case motion::PathWait::spindle_at_speed:
      return say_wait(wait, "the spindle to be at speed", spindle + ".at-speed");
    case motion::PathWait::orient:
      return say_wait(wait, "the spindle to be oriented", spindle + ".is-oriented");
    case motion::PathWait::dwell: return say_wait(wait, "the end of a dwell (G4)", "");
    case motion::PathWait::hold: return say_wait(wait, "resume", "");
    case motion::PathWait::feed_hold_pin:
      return say_wait(wait, "the end of feed hold", "motion.feed-hold");
    case motion::PathWait::feed_inhibit:
      return say_wait(wait, "the end of feed inhibit", "motion.feed-inhibit");
    case motion::PathWait::zero_override: return override_wait(wait, status, want);
    case motion::PathWait::spindle_index:
      return say_wait(wait, "the index of the spindle", spindle + ".index-enable");
    case motion::PathWait::spindle_turning:
      return say_wait(wait, "the spindle to turn", spindle + ".revs, " + spindle + ".speed-in");
    case motion::PathWait::indexer_unlocked:
    case motion::PathWait::indexer_locked: {
      const std::string joint = std::to_string(std::max(status.waiting_index, 0));
      const bool opens = status.waiting_for == motion::PathWait::indexer_unlocked;
      return say_wait(wait, (opens ? "unlocking of joint " : "locking of joint ") + joint,
                      "joint." + joint + ".is-unlocked");
    }
  }
  if (status.reverse && !status.path_empty && std::fabs(status.vel_mm_s) <= 0)
    return say_wait(wait, "the path to run forwards: backwards it ends here",
                    want.backwards ? "" : "motion.adaptive-feed");
  if (status.probing) return say_wait(wait, "the probe", "motion.probe-input");
  for (std::size_t j = 0; j < motion::kMaxJoints; ++j)
    if (status.joint[j].homing && homing_wait(wait, j, status.joint[j].home_state)) return;
}

}  // namespace

/// What motion waits for on its own, in words.
void CommandParticipant::path_wait(WaitingFor& wait) {
  wait = {};
  motion_wait(wait, status_, want_);
  if (!(wait.object == last_wait_.object && wait.pin == last_wait_.pin)) {
    last_wait_ = wait;
    last_wait_.since_ns = now_;
  }
  wait.since_ns = last_wait_.since_ns;
}

namespace {
ToolRecord tool_record(const io::ToolEntry& tool) {
  ToolRecord r;
  r.number = tool.number;
  r.pocket = tool.pocket;
  r.offset = tool.offset;
  r.diameter_mm = tool.diameter_mm;
  r.front_angle_deg = tool.front_angle_deg;
  r.back_angle_deg = tool.back_angle_deg;
  r.orientation = tool.orientation;
  r.comment = rtapi::FixedString<119>(tool.remark);
  return r;
}
}  // namespace

/// The table for clients; it changes seldom, and then as a whole.
void CommandParticipant::show_tools() {
  if (p_.tools == nullptr) return;
  const auto table = p_.tools->table();
  ToolSlots& slots = p_.shared.tools;
  const bool same_tool = shown_.tool_in_spindle == written_.tool_in_spindle && shown_.version != 0;
  if (table == tools_shown_ && same_tool) return;
  slots.version.publish(slots.version.observe() | 1U);
  rtapi::full_fence();  // readers see the odd number before any slot changes
  ToolRecord spindle;
  if (const auto* tool = table->find(io_.tool_in_spindle);
      tool != nullptr && io_.tool_in_spindle > 0)
    spindle = tool_record(*tool);
  slots.slot[0].write(spindle);
  std::size_t used = 1;
  for (const io::ToolEntry& tool : table->tools()) {
    if (used == ToolSlots::kSlots) break;
    slots.slot[used++].write(tool_record(tool));
  }
  slots.used.set(static_cast<std::uint32_t>(used));
  slots.version.publish(slots.version.observe() + 1);
  tools_shown_ = table;
}

void CommandParticipant::write_status() {
  TaskStatus& s = shown_;
  s.pid = p_.pid;
  s.task_state = state_;
  s.mode = mode_;
  s.interp_state = view_.interp_state;
  s.exec_state = view_.exec_state;
  s.file = view_.file;
  s.source = view_.source;
  s.command = view_.command;
  s.current_line = view_.current_line;
  s.read_line = view_.read_line;
  s.call_level = view_.call_level;
  s.program_lines = view_.program_lines;
  s.progress = view_.progress;
  s.program_open = view_.program_open;
  s.programs_ended = programs_ended_;
  s.queued_mdi = 0;
  for (const auto& [ticket, pending] : pending_)
    if (pending.command == CommandId::mdi && pending.order && !pending.begun) ++s.queued_mdi;
  s.paused = p_.exchange.paused.get() != 0 || view_.stopped;
  s.single_step = p_.exchange.stepping.get() != 0 ? 1 : 0;
  s.optional_stop = p_.exchange.optional_stop.get() != 0;
  s.block_delete = p_.exchange.block_delete.get() != 0;
  s.idle = idle();
  s.override_limits = want_.override_limits;
  std::copy(std::begin(view_.g_codes), std::end(view_.g_codes), std::begin(s.g_codes));
  std::copy(std::begin(view_.m_codes), std::end(view_.m_codes), std::begin(s.m_codes));
  std::copy(std::begin(view_.settings), std::end(view_.settings), std::begin(s.settings));
  s.g5x_index = view_.g5x_index;
  s.program_units = view_.program_units;
  s.g5x_offset = view_.g5x_offset;
  s.g92_offset = view_.g92_offset;
  s.tool_offset = view_.tool_offset;
  s.rotation_deg = view_.rotation_deg;
  s.tool_in_spindle = io_.tool_in_spindle;
  s.tool_from_pocket = io_.pocket_in_spindle;
  s.tool_prepped = io_.prepared_tool;
  s.pocket_prepped = io_.prepared_index;
  s.flood = io_.flood;
  s.mist = io_.mist;
  s.emc_enable_in = io_.emc_enable_in;
  s.feed_override = want_.feed_override;
  s.rapid_override = want_.rapid_override;
  std::copy(std::begin(want_.spindle_override), std::end(want_.spindle_override),
            std::begin(s.spindle_override));
  s.max_vel_mm_s = want_.max_vel_mm_s;
  s.waiting_for = view_.waiting_for;
  if (s.waiting_for.object.empty()) path_wait(s.waiting_for);
  if (resetting_) {
    say_wait(s.waiting_for, "the estop chain to close", "iocontrol.0.emc-enable-in");
    s.waiting_for.since_ns = reset_since_;
  }
  s.prompt = view_.prompt;
  if (!(s.waiting_for.pin == wait_pin_)) {
    wait_pin_ = s.waiting_for.pin;
    wait_net_ = rtapi::FixedString<63>(p_.net_of && !wait_pin_.empty() ? p_.net_of(wait_pin_.view())
                                                                       : std::string());
  }
  s.waiting_for.net = wait_net_;
  s.messages = messages_;
  s.errors = error_messages_;
  s.commands = counters_;
  s.abort_epoch = epoch_;
  s.clients = static_cast<std::int32_t>(clients_.size());
  s.echo_serial = echo_serial_;
  s.debug = debug_;
  s.last_failed = last_failed_;
  s.interpreter_error = view_.failed ? 5 : 0;
  s.input_timeout = view_.input_timeout;
  s.waiting_tool_prepared = io_.waiting_prepared;
  s.waiting_tool_changed = io_.waiting_changed;
  show_tools();
  // Padding that differs costs one write more, no harm.
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): see above
  if (s.version != 0 && std::memcmp(&s, &written_, sizeof s) == 0) return;
  ++s.version;
  s.time_ns = now_;
  written_ = s;
  p_.shared.status.write(s);
  p_.shared.status_cell.notify();
}

void CommandParticipant::shut_down() {
  close_journal();
  abort_all(abort_none);
  p_.motion.intent.enable.publish(0);
  p_.io.set_estop(true);
  for (auto& c : clients_)
    for (auto& packet : c->outbox) (void)rtapi::send_packet(c->fd, packet);
}

}  // namespace kerf::task
