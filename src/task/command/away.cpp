// Away from the path and back: pause, jog, look, change the tool, return, resume. Motion keeps the path; here is the way back.
#include <algorithm>
#include <cmath>

#include "task/command/command_participant.hpp"

namespace kerf::task {

using motion::JogIntent;

namespace {
constexpr double kThere = 1e-7;  ///< mm, degrees
}  // namespace

bool CommandParticipant::refuse_away(Ticket ticket) {
  if (status_.away || want_.away) {
    reply(ticket, CommandState::error,
          "the machine is away from the path: return leads back to it, then resume");
    return true;
  }
  for (std::size_t n = 0; held_spindles_known_ && n < motion::kMaxSpindles; ++n) {
    if (held_direction_[n] == 0) continue;
    const auto& spindle = status_.spindle[n];
    const bool turns = spindle.on && spindle.direction == held_direction_[n];
    if (turns && spindle.at_speed) continue;
    const std::string name = "spindle " + std::to_string(n);
    const std::string way = held_direction_[n] > 0 ? "forward" : "reverse";
    std::string why = name;
    if (turns)
      why.append(" is not at its speed yet: spindle.")
          .append(std::to_string(n))
          .append(".at-speed");
    else
      why.append(" turned ")
          .append(way)
          .append(" when the program was held: start it again (spindle ")
          .append(way)
          .append(") before resume, or abort");
    reply(ticket, CommandState::error, why);
    return true;
  }
  held_spindles_known_ = false;
  return false;
}

bool CommandParticipant::program_held() const {
  return !view_.idle && (p_.exchange.paused.get() != 0 || view_.stopped);
}

void CommandParticipant::remember_spindles() {
  if (held_spindles_known_) return;
  for (std::size_t n = 0; n < motion::kMaxSpindles; ++n)
    held_direction_[n] = status_.spindle[n].on ? status_.spindle[n].direction : 0;
  held_spindles_known_ = true;
}

void CommandParticipant::do_away(Ticket ticket) {
  if (refuse_unless_on(ticket, "away")) return;
  if (view_.idle || status_.mode != motion::MotionMode::coordinated)
    return reply(ticket, CommandState::error, "nothing runs whose path could be left");
  remember_spindles();
  p_.motion.intent.hold.publish(1);
  p_.exchange.paused.set(1);
  want_.away = true;
  end_block_step();
  write_intent();
  pending_[ticket].epoch = epoch_;
  p_.exchange.wake_interpreter();
}

void CommandParticipant::do_back(Ticket ticket) {
  if (!status_.away)
    return reply(ticket, CommandState::error, "the machine is not away from the path");
  if (refuse_unless_on(ticket, "return")) return;
  stop_jogs(kNobody);
  pending_[ticket].epoch = epoch_;
  returning_ = Returning::out;
  const auto retract = static_cast<std::size_t>(p_.setup.retract_axis());
  if (p_.setup.retract_axis() >= 0 && status_.place[retract] > status_.pos_cmd[retract] + kThere)
    go(retract, status_.place[retract]);
  return_intent_ = want_.serial;
}

void CommandParticipant::go(std::size_t axis, double target) {
  JogIntent& jog = want_.axis_jog[axis];
  ++jog.seq;
  jog.kind = JogIntent::Kind::absolute;
  jog.vel = rtapi::is_rotary(axis)
                ? machine_.axis[axis].max_vel
                : std::min(machine_.axis[axis].max_vel, p_.setup.default_vel_mm_s > 0
                                                            ? p_.setup.default_vel_mm_s
                                                            : machine_.axis[axis].max_vel);
  jog.target = target;
  axis_lease_[axis] = {};
  write_intent();
}

/// Each leg begins when the one before it stands.
void CommandParticipant::update_away() {
  if (returning_ == Returning::no || !taken(return_intent_) || status_.jogging) return;
  const int retract = p_.setup.retract_axis();
  if (returning_ == Returning::there) {
    returning_ = Returning::no;
    return;
  }
  if (returning_ == Returning::in) {
    returning_ = Returning::there;
    bool there = true;
    for (std::size_t a = 0; a < rtapi::kAxes; ++a)
      there = there && std::fabs(status_.place[a] - status_.pos_cmd[a]) <= kThere;
    if (there) {
      want_.away = false;
      return_intent_ = write_intent();
      return;
    }
    // Somebody stopped the jog: still away.
    returning_ = Returning::no;
    std::vector<Ticket> stopped;
    for (const auto& [ticket, pending] : pending_)
      if (pending.command == CommandId::back) stopped.push_back(ticket);
    for (const Ticket ticket : stopped)
      reply(ticket, CommandState::error, "the way back was stopped; return tries again");
    return;
  }
  const bool across = returning_ == Returning::out;
  returning_ = across ? Returning::across : Returning::in;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    const bool in = static_cast<int>(a) == retract;
    if (in != across && std::fabs(status_.place[a] - status_.pos_cmd[a]) > kThere)
      go(a, status_.place[a]);
  }
  return_intent_ = want_.serial;
}

/// The interpreter thread knows tools and the path's offsets; it answers, or asks for a shift of the path.
void CommandParticipant::do_exchange_tool(Ticket ticket, const Request& request) {
  if (refuse_unless_on(ticket, "exchange-tool")) return;
  const int tool = request.integer("tool", -1);
  if (request.has("tool") && tool < 1)
    return reply(ticket, CommandState::error,
                 "exchange-tool: " + std::to_string(tool) + ": expected the number of a tool");
  if (!status_.away || returning_ != Returning::no)
    return reply(ticket, CommandState::error,
                 "tools of a held path are exchanged beside it: away first, then jog, exchange the "
                 "tool, exchange-tool, return and resume");
  pending_[ticket].epoch = epoch_;
  p_.exchange.ask({ticket, tool});
}

void CommandParticipant::take_shift(const Report& report) {
  if (report.epoch != epoch_) return;
  want_.path_shift = report.shift;
  write_intent();
  if (const auto at = pending_.find(report.ticket); at != pending_.end()) at->second.begun = true;
}

/// An abort forgets the path.
void CommandParticipant::end_away() {
  want_.away = false;
  returning_ = Returning::no;
  held_spindles_known_ = false;
}

}  // namespace kerf::task
