// [RS274NGC]ON_ABORT_COMMAND: lines that run after an abort, to bring modes and outputs into a known state. They never move the
// machine and never wait: what asks for that is left out and the operator is told. Manual: "Error handling: dealing with abort".
#include "task/interpreter/interpreter_participant.hpp"

namespace kerf::task {

namespace {

constexpr int kMostBlocks = 2000;

/// What an abort may do: outputs at once, and the end of a spindle's turning. `drives`: motion takes items at all.
bool allowed(const TaskItem& item, bool drives) {
  if (is_aside(item)) return true;
  if (!is_path(item) || !drives) return false;
  const auto& body = std::get<PathBody>(item.body);
  if (const auto* output = std::get_if<motion::OutputChange>(&body)) return !output->synchronised;
  if (const auto* spindle = std::get_if<motion::SpindleChange>(&body))
    return spindle->action == motion::SpindleChange::Action::stop;
  return std::holds_alternative<motion::PathControl>(body) ||
         std::holds_alternative<motion::OverrideEnable>(body) ||
         std::holds_alternative<motion::ToolOffset>(body);
}

/// What turns or flows when the machine is off stays off.
void leave_coolant_off(TaskItem& item) {
  auto* coolant = std::get_if<SetCoolant>(&item.body);
  if (coolant == nullptr) return;
  if (coolant->flood > 0) coolant->flood = -1;
  if (coolant->mist > 0) coolant->mist = -1;
}

/// Without drives nothing of these can happen, and the next program announces them anyway.
bool is_mode(const TaskItem& item) {
  if (!is_path(item)) return false;
  const auto& body = std::get<PathBody>(item.body);
  return std::holds_alternative<motion::PathControl>(body) ||
         std::holds_alternative<motion::OverrideEnable>(body) ||
         std::holds_alternative<motion::ToolOffset>(body) ||
         std::holds_alternative<motion::SpindleChange>(body);
}

}  // namespace

void InterpreterParticipant::run_on_abort(std::uint32_t reason) {
  const std::string& command = p_.setup.on_abort_command;
  if (command.empty() || reason == abort_none) return;
  const auto complain = [&](const std::string& what) {
    Report report;
    report.message = MessageKind::error;
    report.text = "[RS274NGC]ON_ABORT_COMMAND: " + what;
    reports_.push_back(std::move(report));
  };
  const auto turned = interp_.modal().direction;
  const auto oriented = interp_.modal().orienting;
  canon_.new_tag();
  interp::Outcome o = interp_.execute_mdi(command + " [" + std::to_string(reason) + "]");
  for (int i = 0; o == interp::Outcome::ok && i < kMostBlocks; ++i) o = interp_.execute_next();
  if (o == interp::Outcome::error) complain(interp_.error().message());
  if (o == interp::Outcome::ok) complain("it does not end; it was stopped");
  if (o == interp::Outcome::needs_sync)
    complain("it asks to wait (tool change, M0, M66, probe, user M-code); its rest was left out");
  if (o != interp::Outcome::idle) interp_.abort();

  const bool drives = motion_ready();
  bool moves = false, starts = false;
  std::deque<TaskItem> kept;
  for (TaskItem& item : list_) {
    if (!status_.enabled) leave_coolant_off(item);
    if (is_path(item))
      if (const auto* spindle = std::get_if<motion::SpindleChange>(&std::get<PathBody>(item.body)))
        starts = starts || spindle->action == motion::SpindleChange::Action::forward ||
                 spindle->action == motion::SpindleChange::Action::reverse ||
                 spindle->action == motion::SpindleChange::Action::orient;
    if (allowed(item, drives))
      kept.push_back(std::move(item));
    else
      moves =
          moves || (is_path(item) && !is_mode(item) &&
                    !std::holds_alternative<motion::OutputChange>(std::get<PathBody>(item.body)));
  }
  list_ = std::move(kept);
  if (moves) complain("an abort does not move the machine; its moves were left out");
  if (starts) complain("an abort starts no spindle; its M3, M4 or M19 was left out");
  // Interpreter and canon are as the machine is, whatever the lines asked for.
  interp::ModalState modal = interp_.modal();
  CanonState canon = canon_.state();
  for (std::size_t n = 0; n < modal.direction.size(); ++n) {
    if (modal.direction[n] != interp::SpindleDirection::stopped) modal.direction[n] = turned[n];
    modal.orienting[n] = modal.orienting[n] && oriented[n];
    canon.direction[n] =
        static_cast<std::int8_t>(modal.direction[n] == interp::SpindleDirection::stopped     ? 0
                                 : modal.direction[n] == interp::SpindleDirection::clockwise ? 1
                                                                                             : -1);
  }
  if (!status_.enabled) modal.flood = modal.mist = false;
  interp_.restore(modal);
  canon_.restore(canon);
  canon_.set_position(status_.pos_cmd);
  interp_.synchronize({.machine_position = status_.pos_cmd});
}

}  // namespace kerf::task
