// Programs, MDI, overrides and the operator's switches.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "task/api/message_reader.hpp"
#include "task/command/command_participant.hpp"

namespace kerf::task {
void CommandParticipant::execute(Ticket ticket, const Request& request, int client) {
  switch (request.command->id) {
    case CommandId::state: return do_state(ticket, request);
    case CommandId::mode: return do_mode(ticket, request);
    case CommandId::home: return do_home(ticket, request);
    case CommandId::unhome: return do_unhome(ticket, request);
    case CommandId::jog: return do_jog(ticket, request, client);
    case CommandId::jog_stop: return do_jog_stop(ticket, request);
    case CommandId::jog_keep: return reply(ticket, CommandState::done);
    case CommandId::teleop: return do_teleop(ticket, request);
    case CommandId::open:
    case CommandId::run:
    case CommandId::pause:
    case CommandId::resume:
    case CommandId::tool_table: return do_program(ticket, request);
    case CommandId::step: return do_step(ticket);
    case CommandId::direction: return do_direction(ticket, request.text("way") == "reverse");
    case CommandId::answer: return do_answer(ticket, request);
    case CommandId::away: return do_away(ticket);
    case CommandId::back: return do_back(ticket);
    case CommandId::exchange_tool: return do_exchange_tool(ticket, request);
    case CommandId::tool_changed:
      if (!io_.waiting_changed && !io_.waiting_prepared)
        return reply(ticket, CommandState::error, "no tool change is waited for");
      p_.io.confirm();
      return reply(ticket, CommandState::done);
    case CommandId::abort: {
      abort_all(abort_user);
      pending_[ticket].epoch = epoch_;
      return;
    }
    case CommandId::mdi: return do_mdi(ticket, request);
    case CommandId::feed_override:
    case CommandId::rapid_override:
    case CommandId::spindle_override:
    case CommandId::max_velocity: return do_override(ticket, request);
    case CommandId::spindle: return do_spindle(ticket, request);
    case CommandId::flood:
    case CommandId::mist:
    case CommandId::optional_stop:
    case CommandId::block_delete:
    case CommandId::override_limits: return do_switch(ticket, request);
    case CommandId::digital_out:
    case CommandId::analog_out: return do_output(ticket, request);
    case CommandId::brake:
    case CommandId::feed_override_enable:
    case CommandId::adaptive_feed:
    case CommandId::feed_hold:
    case CommandId::spindle_override_enable: return do_enable(ticket, request);
    case CommandId::joint_limit: return do_joint_limit(ticket, request);
    case CommandId::motion_mode: return do_motion_mode(ticket, request);
    case CommandId::tool_offset: return do_tool_offset(ticket, request);
    case CommandId::reset_interpreter:
    case CommandId::synch: return do_program(ticket, request);
    case CommandId::debug:
      debug_ = request.integer("level");
      return reply(ticket, CommandState::done);
    case CommandId::wait: return;
    case CommandId::errors: {
      auto cursor = static_cast<std::uint64_t>(std::max(0, request.integer("since")));
      return reply(ticket, CommandState::done, format_messages(newest_messages(cursor)));
    }
    case CommandId::message: {
      const std::string& kind = request.text("kind");
      say(kind == "error"     ? MessageKind::error
          : kind == "display" ? MessageKind::display
                              : MessageKind::text,
          request.text("text"));
      return reply(ticket, CommandState::done);
    }
    case CommandId::help: return reply(ticket, CommandState::done, help_text());
  }
  reply(ticket, CommandState::error, "unknown command");
}

void CommandParticipant::do_answer(Ticket ticket, const Request& request) {
  const Prompt& prompt = view_.prompt;
  if (prompt.kind == PromptKind::none)
    return reply(ticket, CommandState::error, "nothing is asked");
  const auto number = static_cast<std::uint64_t>(
      std::max(0, request.integer("prompt", static_cast<int>(prompt.number))));
  if (number != prompt.number)
    return reply(ticket, CommandState::error,
                 "question " + std::to_string(number) + " is not asked now; the present one is " +
                     std::to_string(prompt.number) + ": " + std::string(prompt.text.view()));
  if (prompt.kind == PromptKind::tool_change) {
    p_.io.confirm();
  } else {
    // A pause of the operator's own stays.
    p_.exchange.resumes.add(1);
    p_.exchange.wake_interpreter();
  }
  reply(ticket, CommandState::done);
}

void CommandParticipant::post(Order order, Ticket ticket) {
  pending_[ticket].order = true;
  order.epoch = epoch_;
  order.ticket = ticket;
  p_.exchange.post(std::move(order));
}

void CommandParticipant::post(Order::Kind kind, Ticket ticket, const std::string& text,
                              bool by_hand) {
  Order order;
  order.kind = kind;
  order.by_hand = by_hand;
  order.text = text;
  post(std::move(order), ticket);
}

bool CommandParticipant::refuse_unless_homed(Ticket ticket, const char* text) {
  if (all_homed() || p_.setup.motion.no_force_homing) return false;
  say(MessageKind::error, text);
  reply(ticket, CommandState::error, text);
  return true;
}

bool CommandParticipant::other_orders(Ticket ticket) const {
  return std::any_of(pending_.begin(), pending_.end(),
                     [ticket](const auto& p) { return p.first != ticket && p.second.order; });
}

void CommandParticipant::do_program(Ticket ticket, const Request& request) {
  const auto order_runs = [this, ticket] { return other_orders(ticket); };
  switch (request.command->id) {
    case CommandId::open:
      if (order_runs() || !view_.idle)
        return reply(ticket, CommandState::error, "can't open a program while something runs");
      pending_[ticket].file = request.text("file");
      return post(Order::Kind::open, ticket, request.text("file"));
    case CommandId::tool_table:
      if (order_runs() || !view_.idle)
        return reply(ticket, CommandState::error, "can't read the tool table while something runs");
      return post(Order::Kind::reload_tools, ticket, {});
    case CommandId::reset_interpreter:
    case CommandId::synch: {
      const bool reset = request.command->id == CommandId::reset_interpreter;
      // A program under way is in step with the machine as it is.
      if (order_runs() || !view_.idle)
        return reset ? reply(ticket, CommandState::error,
                             "can't reset the interpreter while something runs; abort first")
                     : reply(ticket, CommandState::done);
      return post(reset ? Order::Kind::reset : Order::Kind::synch, ticket, {});
    }
    case CommandId::run: {
      if (refuse_unless_on(ticket, "command (EMC_TASK_PLAN_RUN)")) return;
      if (refuse_unless_homed(ticket, "Can't run a program when not homed")) return;
      const int line = request.integer("line");
      if (line < 0)
        return reply(
            ticket, CommandState::error,
            "run: line " + std::to_string(line) + ": expected 0 (from the start) or a line");
      // An open that was asked for just before is fine: orders keep their order.
      const bool only_opens =
          std::all_of(pending_.begin(), pending_.end(), [ticket](const auto& p) {
            return p.first == ticket || !p.second.order || p.second.command == CommandId::open;
          });
      if (!only_opens || homing() || jogs())
        return reply(ticket, CommandState::error, "can't run a program while something runs");
      set_mode(TaskMode::automatic);
      p_.exchange.stepping.set(0);
      Order order;
      order.kind = Order::Kind::run;
      order.line = line;
      const std::string& then = request.text("then");
      order.seek_end = then == "check"  ? SeekEnd::check
                       : then == "hold" ? SeekEnd::hold
                                        : SeekEnd::run;
      // A question about the start of the program is one about its first line.
      if (order.seek_end != SeekEnd::run && line == 0) order.line = 1;
      if (order.seek_end != SeekEnd::check) journal_begin(line);
      return post(std::move(order), ticket);
    }
    case CommandId::pause:
      // What is being aborted is no more; a hold behind the abort would stop what comes next.
      if (aborting() || (view_.idle && !order_runs()))
        return reply(ticket, CommandState::error, "nothing runs that could pause");
      pause();
      return reply(ticket, CommandState::done);
    default:  // resume
      if (refuse_away(ticket)) return;
      end_block_step();
      p_.motion.intent.hold.publish(0);
      p_.exchange.paused.set(0);
      p_.exchange.stepping.set(0);
      p_.exchange.resumes.add(1);
      p_.exchange.wake_interpreter();
      return reply(ticket, CommandState::done);
  }
}

void CommandParticipant::pause() {
  p_.motion.intent.hold.publish(1);
  p_.exchange.paused.set(1);
  end_block_step();
  p_.exchange.wake_interpreter();
}

void CommandParticipant::do_step(Ticket ticket) {
  if (refuse_away(ticket)) return;
  if (refuse_unless_on(ticket, "command (EMC_TASK_PLAN_STEP)")) return;
  if (refuse_unless_homed(ticket, "Can't run a program when not homed")) return;
  if (aborting())
    return reply(ticket, CommandState::error, "can't step while the program is being aborted");
  if (want_.backwards)
    return reply(ticket, CommandState::error,
                 "steps go forwards: set the direction to forward, or resume");
  const bool running = std::any_of(pending_.begin(), pending_.end(), [](const auto& p) {
    return p.second.order &&
           (p.second.command == CommandId::run || p.second.command == CommandId::step);
  });
  if (!running && (!view_.idle || moving_orders(ticket) || homing() || jogs()))
    return reply(ticket, CommandState::error, "can't step while something else runs");
  p_.exchange.stepping.set(1);
  // Whoever saw the last step stand may be quicker than this thread; motion has to see the hold between the two.
  finish_block_step();
  if (!running) {
    set_mode(TaskMode::automatic);
    journal_begin(0);
    post(Order::Kind::step, internal_ticket(CommandId::step), {});
    return reply(ticket, CommandState::done);
  }
  block_step_due_ = !taken(block_step_intent_);
  if (!block_step_due_) begin_block_step();
  reply(ticket, CommandState::done);
}

/// A program that was held in the middle of its queue goes on to the end of the block in execution; motion itself stands there. The
/// hold ends when motion knows of that: a write that it cannot read in the cycle of the release would let the whole path go.
void CommandParticipant::begin_block_step() {
  block_step_due_ = false;
  block_step_armed_ = p_.motion.intent.hold.observe() != 0;
  if (block_step_armed_) {
    want_.single_step = true;
    block_step_intent_ = write_intent();
  }
  p_.exchange.paused.set(0);
  p_.exchange.resumes.add(1);
  p_.exchange.wake_interpreter();
}

void CommandParticipant::release_block_step() {
  block_step_armed_ = false;
  p_.motion.intent.hold.publish(0);
  // Behind the word: who has taken it has seen the release.
  block_step_intent_ = write_intent();
}

/// Only of a path that is held: nothing turns round under way.
void CommandParticipant::do_direction(Ticket ticket, bool backwards) {
  if (refuse_away(ticket)) return;
  if (view_.idle && !other_orders(ticket))
    return reply(ticket, CommandState::error, "no program runs whose direction could be set");
  if (p_.motion.intent.hold.observe() == 0)
    return reply(ticket, CommandState::error,
                 "pause the program first; resume then runs it the way that is set");
  want_.backwards = backwards;
  write_intent();
  reply(ticket, CommandState::done);
}

void CommandParticipant::do_mdi(Ticket ticket, const Request& request) {
  if (request.flag("in-mode") && mode_ != TaskMode::mdi && state_ == TaskState::on)
    return reply(ticket, CommandState::error, "Must be in MDI mode to issue MDI command");
  do_mdi(ticket, request.text("text"), false, request.flag("and-back"));
}

void CommandParticipant::do_mdi(Ticket ticket, const std::string& text, bool by_hand,
                                bool and_back) {
  if (refuse_unless_on(ticket, "command (EMC_TASK_PLAN_EXECUTE)")) return;
  if (!by_hand && refuse_unless_homed(ticket, "Can't issue MDI command when not homed")) return;
  std::int32_t queued = 0;
  for (const auto& [other, pending] : pending_) {
    if (!pending.order || other == ticket) continue;
    if (pending.command != CommandId::mdi && pending.command != CommandId::spindle &&
        pending.command != CommandId::open)
      return reply(ticket, CommandState::error, "can't issue MDI command while a program runs");
    if (!pending.begun) ++queued;
  }
  if (!by_hand && (homing() || jogs()))
    return reply(ticket, CommandState::error,
                 "can't issue MDI command while the machine homes or jogs");
  if (by_hand && homing() && status_.mode == motion::MotionMode::coordinated)
    return reply(ticket, CommandState::error, "the machine is just beginning to home");
  if (queued >= p_.setup.mdi_queue)
    return reply(
        ticket, CommandState::error,
        "the MDI queue is full: [TASK]MDI_QUEUED_COMMANDS = " + std::to_string(p_.setup.mdi_queue));
  // An idle machine in AUTO takes MDI and stays in AUTO; from manual it goes to MDI. Nothing moves by a spindle's words.
  if (!by_hand) {
    auto back_to = and_back ? back_to_ : std::nullopt;
    if (and_back && mode_ != TaskMode::mdi) back_to = Back{mode_, want_.mode};
    set_mode(mode_ == TaskMode::manual || and_back ? TaskMode::mdi : mode_);
    back_to_ = back_to;
  }
  post(Order::Kind::mdi, ticket, text, by_hand);
}

void CommandParticipant::do_override(Ticket ticket, const Request& request) {
  const double value = request.number("value");
  if (value < 0)
    return reply(
        ticket, CommandState::error,
        std::string(request.command->name) + ": " + std::to_string(value) + " is negative");
  const auto& limits = p_.setup.limits;
  switch (request.command->id) {
    case CommandId::feed_override:
      want_.feed_override = std::min(value, limits.max_feed_override);
      break;
    case CommandId::rapid_override: want_.rapid_override = std::min(value, 1.0); break;
    case CommandId::spindle_override: {
      const int spindle = request.integer("spindle");
      if (spindle < 0 || spindle >= p_.setup.motion.spindles)
        return reply(ticket, CommandState::error,
                     "spindle " + std::to_string(spindle) + " does not exist");
      want_.spindle_override[spindle] =
          std::clamp(value, limits.min_spindle_override,
                     std::max(limits.min_spindle_override, limits.max_spindle_override));
      break;
    }
    default:
      want_.max_vel_mm_s = std::min(value * p_.setup.linear_unit_mm, machine_.traj_max_vel_mm_s);
      break;
  }
  write_intent();
  reply(ticket, CommandState::done);
}

void CommandParticipant::do_spindle(Ticket ticket, const Request& request) {
  const int spindle = request.integer("spindle");
  if (refuse_spindle(ticket, spindle)) return;
  const std::string& action = request.text("action");
  if (action == "off") {
    if (program_held()) remember_spindles();
    ++want_.spindle_stop_seq[spindle];
    write_intent();
    return reply(ticket, CommandState::done);
  }
  // Beside a held path it can only turn again as the program had it.
  if (held_spindles_known_ && program_held() && (action == "forward" || action == "reverse")) {
    const std::int32_t direction = action == "forward" ? 1 : -1;
    if (held_direction_[static_cast<std::size_t>(spindle)] != direction)
      return reply(ticket, CommandState::error,
                   "spindle " + std::to_string(spindle) + " did not turn " + action +
                       " when the program was held");
    want_.spindle_restart[spindle].wish(direction);
    wish();
    return reply(ticket, CommandState::done);
  }
  double speed = request.number("speed", view_.spindle_rpm[spindle]);
  const double step = p_.setup.motion.spindle[spindle].increment_rpm;
  if (action == "increase") speed += step;
  if (action == "decrease") speed = std::max(0.0, speed - step);
  // By the same way as a program's spindle words, so that there is one order of things and one modal state.
  char line[96];
  const bool turn = action == "forward" || action == "reverse";
  const char* code = action == "reverse" || (turn && speed < 0) ? "M4" : "M3";
  // Without a speed it turns as it last did, at constant surface speed too; a speed in rpm ends that.
  if (turn && !request.has("speed"))
    std::snprintf(line, sizeof line, "%s $%d", code, spindle);
  else if (turn)
    std::snprintf(line, sizeof line, "G97 S%.6f %s $%d", std::fabs(speed), code, spindle);
  else
    std::snprintf(line, sizeof line, "S%.6f $%d", std::fabs(speed), spindle);
  do_mdi(ticket, line, true, false);
}

void CommandParticipant::do_switch(Ticket ticket, const Request& request) {
  const bool on = request.flag("on");
  switch (request.command->id) {
    case CommandId::flood:
    case CommandId::mist: {
      if (on && refuse_unless_on(ticket, "coolant")) return;
      const bool flood = request.command->id == CommandId::flood;
      p_.io.set_coolant(epoch_, flood ? std::optional<bool>(on) : std::nullopt,
                        flood ? std::nullopt : std::optional<bool>(on));
      break;
    }
    case CommandId::optional_stop: p_.exchange.optional_stop.set(on ? 1 : 0); break;
    case CommandId::block_delete: p_.exchange.block_delete.set(on ? 1 : 0); break;
    default:
      want_.override_limits = on;
      write_intent();
      break;
  }
  reply(ticket, CommandState::done);
}

void CommandParticipant::do_output(Ticket ticket, const Request& request) {
  const bool analog = request.command->id == CommandId::analog_out;
  const int index = request.integer("index");
  const int count = std::min<int>(analog ? status_.analog_count : status_.digital_count, 64);
  if (index < 0 || index >= count)
    return reply(ticket, CommandState::error,
                 std::string(analog ? "motion.analog-out-" : "motion.digital-out-") +
                     std::to_string(index) + " does not exist: motmod has " +
                     std::to_string(count) + (analog ? " (num_aio)" : " (num_dio)"));
  if (analog)
    want_.analog_out[index].wish(request.number("value"));
  else
    want_.digital_out[index].wish(request.flag("on"));
  wish();
  reply(ticket, CommandState::done);
}

bool CommandParticipant::refuse_spindle(Ticket ticket, int spindle) {
  if (spindle >= 0 && spindle < machine_.spindles) return false;
  reply(ticket, CommandState::error,
        "spindle " + std::to_string(spindle) + " does not exist: expected 0 to " +
            std::to_string(machine_.spindles - 1));
  return true;
}

void CommandParticipant::do_enable(Ticket ticket, const Request& request) {
  const bool on = request.flag("on");
  const int spindle = request.integer("spindle");
  if (refuse_spindle(ticket, spindle)) return;
  switch (request.command->id) {
    case CommandId::brake: want_.brake[spindle].wish(on); break;
    case CommandId::feed_override_enable: want_.feed_override_enable.wish(on); break;
    case CommandId::adaptive_feed: want_.adaptive_feed_enable.wish(on); break;
    case CommandId::feed_hold: want_.feed_hold_enable.wish(on); break;
    default: want_.spindle_override_enable[spindle].wish(on); break;
  }
  wish();
  reply(ticket, CommandState::done);
}

void CommandParticipant::do_tool_offset(Ticket ticket, const Request& request) {
  if (other_orders(ticket) || !view_.idle)
    return reply(ticket, CommandState::error, "can't change the tool table while something runs");
  const int number = request.integer("tool"), orientation = request.integer("orientation");
  if (number < 1 || orientation < 0 || orientation > 9)
    return reply(ticket, CommandState::error,
                 number < 1 ? "tool " + std::to_string(number) + ": expected a number above 0"
                            : "orientation " + std::to_string(orientation) + ": expected 0 to 9");
  const double unit = p_.setup.linear_unit_mm;
  Order order;
  order.kind = Order::Kind::put_tool;
  order.tool.number = number;
  order.tool.pocket = number;
  order.tool.offset.z = request.number("z") * unit;
  order.tool.offset.x = request.number("x") * unit;
  order.tool.diameter_mm = request.number("diameter") * unit;
  order.tool.front_angle_deg = request.number("front");
  order.tool.back_angle_deg = request.number("back");
  order.tool.orientation = orientation;
  post(std::move(order), ticket);
}

}  // namespace kerf::task
