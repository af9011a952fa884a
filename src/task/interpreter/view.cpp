// What the interpreter thread shows of itself.
#include <algorithm>
#include <cstring>

#include "task/interpreter/interpreter_participant.hpp"

namespace kerf::task {

void InterpreterParticipant::fill_waiting(InterpreterView& view) const {
  view.waiting_for = waiting_for_;
  if (stopped_ && waiting_for_.object.empty()) {
    view.waiting_for.object = rtapi::FixedString<63>("step or resume");
    view.waiting_for.since_ns = stopped_at_;
  }
  // iov2: no order is begun before the changer has seen the abort behind the last one.
  if (tool_order_ != 0 && p_.io.state().waiting_abort_ack) {
    view.waiting_for.object = rtapi::FixedString<63>("the tool changer to acknowledge an abort");
    view.waiting_for.pin = rtapi::FixedString<63>("iocontrol.0.emc-abort-ack");
  }
  view.exec_state = ExecState::done;
  view.interp_state = InterpState::idle;
  if (run_.failed) view.exec_state = ExecState::error;
  if (!run_.active) return;
  const bool paused = stopped_ || barrier_.pausing || p_.exchange.paused.get() != 0;
  view.interp_state = paused ? InterpState::paused
                      : (run_.source_done || run_.sync_pending || ring_full_)
                          ? InterpState::waiting
                          : InterpState::reading;
  if (!executed())
    view.exec_state =
        ring_full_ ? ExecState::waiting_for_motion_queue : ExecState::waiting_for_motion;
  if (list_.empty() || !barrier_.begun) return;
  const TaskItemBody& body = list_.front().body;
  if (std::holds_alternative<ChangeTool>(body))
    view.exec_state = ExecState::waiting_for_motion_and_io;
  if (std::holds_alternative<UserMcodeRun>(body))
    view.exec_state = ExecState::waiting_for_system_cmd;
  if (std::holds_alternative<WaitInput>(body)) view.exec_state = ExecState::waiting_for_delay;
  if (std::holds_alternative<WaitOrient>(body))
    view.exec_state = ExecState::waiting_for_spindle_oriented;
}

void InterpreterParticipant::fill_prompt(InterpreterView& view) {
  view.prompt = {};
  if (!run_.active || list_.empty() || !barrier_.begun) return;
  std::string text;
  Prompt& prompt = view.prompt;
  if (const auto* pause = std::get_if<ProgramPause>(&list_.front().body)) {
    if (!barrier_.pausing) return;
    prompt.kind = pause->optional ? PromptKind::optional_stop
                  : pause->pallet ? PromptKind::pallet
                                  : PromptKind::stop;
    text = pause->optional ? "M1: the program stands"
           : pause->pallet ? "M60: change the pallet"
                           : "M0: the program stands";
  } else if (const auto* change = std::get_if<ChangeTool>(&list_.front().body)) {
    if (!p_.io.state().waiting_changed) return;
    prompt.kind = PromptKind::tool_change;
    prompt.tool = std::max(change->number, 0);
    const auto table = p_.tools.table();
    const io::ToolEntry* tool = table->find(prompt.tool);
    const bool named = tool != nullptr && !tool->remark.empty();
    text = prompt.tool == 0 && tool == nullptr
               ? "M6: no tool in the spindle"
               : "M6: tool " + std::to_string(prompt.tool) +
                     (named ? " (" + tool->remark + ")" : "") + " into the spindle";
  } else {
    return;
  }
  if (barrier_.prompt == 0) barrier_.prompt = ++prompts_;
  prompt.number = barrier_.prompt;
  prompt.text = rtapi::FixedString<127>(text);
}

void InterpreterParticipant::show() {
  const BlockRecord& at = history_.present();
  InterpreterView& view = view_;
  const InterpreterView before = view_;
  fill_waiting(view);
  fill_prompt(view);
  view.file = rtapi::FixedString<255>(file_);
  view.command = rtapi::FixedString<127>(command_);
  // While a negative adaptive feed runs the path backwards, motion is before the block that it had come to.
  const bool backwards =
      run_.active && status_.kind != motion::MotionKind::none && status_.current.id < at.tag.id;
  const motion::SourceTag& line = backwards ? status_.current : at.tag;
  view.source = rtapi::FixedString<255>(interp_.file_name(static_cast<std::uint32_t>(line.file)));
  view.current_line = line.line;
  view.call_level = line.call_level;
  view.main_line = line.main_line;
  view.block_id = at.tag.id;
  view.moved_id = history_.moved();
  view.read_line = interp_.next_line();
  view.program_lines = program_lines_;
  if (run_.active && !run_.mdi && program_lines_ > 0)
    progress_ = static_cast<double>(at.tag.main_line) / program_lines_;
  view.progress = progress_;
  const auto g = at.modal.active_g_codes();
  const auto m = at.modal.active_m_codes();
  const auto s = at.modal.settings();
  for (std::size_t i = 0; i < g.size(); ++i) view.g_codes[i] = g[i];
  for (std::size_t i = 0; i < m.size(); ++i) view.m_codes[i] = m[i];
  for (std::size_t i = 0; i < s.size(); ++i) view.settings[i] = s[i];
  view.g5x_index = at.modal.coord_system;
  view.program_units = at.modal.units == interp::Units::inch ? 1 : 2;
  view.g5x_offset = at.modal.frame.g5x();
  view.g92_offset = at.modal.frame.g92();
  view.tool_offset = at.modal.frame.tool();
  view.rotation_deg = at.modal.frame.rotation_deg();
  for (std::size_t i = 0; i < kMaxSpindles; ++i) view.spindle_rpm[i] = at.modal.speed_rpm[i];
  view.settled_epoch = aborting_ ? epoch_ - 1 : epoch_;
  view.idle = !run_.active && !aborting_ && p_.exchange.queued() == 0;
  view.running_program = run_.active && !run_.mdi;
  view.program_open = interp_.is_open();
  view.stopped = stopped_ || barrier_.pausing;
  view.failed = failed_;
  view.input_timeout = input_timeout_;
  // Padding that differs costs one write more, no harm.
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): see above
  if (std::memcmp(&before, &view, sizeof view) != 0) p_.exchange.show(view);
}

}  // namespace kerf::task
