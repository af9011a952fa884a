// What the journal is told: where the running program is, by what motion has executed.
#include <algorithm>

#include "task/command/command_participant.hpp"
#include "task/journal_writer.hpp"

namespace kerf::task {

namespace {
constexpr rtapi::Nanos kAtMost = 50 * rtapi::kMillisecond;    ///< between two lines that are told
constexpr rtapi::Nanos kAtLeast = 250 * rtapi::kMillisecond;  ///< of one long move
}  // namespace

/// A program was asked for; the record of the one before stays until the first item of this one is under way.
void CommandParticipant::journal_begin(std::int32_t from_line) {
  if (p_.journal == nullptr) return;
  journal_ = {};
  // Where it begins in its middle is where it would begin again.
  journal_.line = journal_.from_line = from_line;
  journal_.expected = true;
  journal_.epoch = epoch_;
  journal_.before_seq = std::max(status_.executed_seq, status_.current_seq);
}

void CommandParticipant::journal_end(CommandState state, const std::string& text) {
  if (p_.journal == nullptr) return;
  journal_.expected = false;
  if (!journal_.begun) return;
  journal_.ending = true;
  journal_.end = state == CommandState::done ? RunState::ended : RunState::stopped;
  journal_.why = state == CommandState::done ? std::string() : text;
}

JournalRecord CommandParticipant::journal_record() const {
  const TaskStatus& s = shown_;
  JournalRecord r;
  r.time_ns = now_;
  r.state = journal_.ending ? journal_.end : s.paused ? RunState::paused : RunState::running;
  r.ini_file = p_.setup.ini_file;
  r.program = std::string(s.file.view());
  r.line = journal_.line;
  r.from_line = journal_.from_line;
  if (s.call_level > 0) {
    r.source = std::string(s.source.view());
    r.source_line = s.current_line;
  }
  r.executed = status_.executed_seq;
  r.why = journal_.why;
  r.position = status_.place;
  for (int j = 0; j < status_.joints; ++j) {
    r.joints.push_back(status_.joint[j].pos_cmd);
    if (status_.joint[j].homed) r.homed |= 1U << static_cast<unsigned>(j);
  }
  r.tool = s.tool_in_spindle;
  r.tool_offset = s.tool_offset;
  r.g5x_offset = s.g5x_offset;
  r.g92_offset = s.g92_offset;
  r.g5x_index = s.g5x_index;
  r.rotation_deg = s.rotation_deg;
  std::copy(std::begin(s.g_codes), std::end(s.g_codes), r.g_codes.begin());
  std::copy(std::begin(s.m_codes), std::end(s.m_codes), r.m_codes.begin());
  r.feed = s.settings[1];
  r.speed = s.settings[2];
  for (int n = 0; n < status_.spindles; ++n)
    r.spindle_rpm.push_back(status_.spindle[n].on ? status_.spindle[n].speed_rpm : 0);
  r.flood = s.flood;
  r.mist = s.mist;
  r.digital_out = status_.digital_out;
  return r;
}

void CommandParticipant::write_journal() {
  if (p_.journal == nullptr) return;
  if (const std::string failure = p_.journal->take_failure(); !failure.empty())
    say(MessageKind::error, failure);
  if (journal_.expected && !journal_.begun && view_.running_program &&
      status_.current_seq > journal_.before_seq) {
    journal_.begun = true;
    p_.journal->begin_program();
  }
  if (!journal_.begun) return;
  // The place of a program that was stopped is known when it stands.
  if (journal_.ending && !at_rest()) return;
  if (view_.main_line > 0) journal_.line = view_.main_line;
  const bool moved_on =
      view_.current_line != journal_.told_line || shown_.paused != journal_.told_paused;
  if (!journal_.ending && now_ < journal_.told_at + (moved_on ? kAtMost : kAtLeast)) return;
  if (!p_.journal->post(journal_record())) return;
  journal_.told_at = now_;
  journal_.told_line = view_.current_line;
  journal_.told_paused = shown_.paused;
  if (journal_.ending) journal_ = {};
}

/// The machine is taken down in the middle of a program.
void CommandParticipant::close_journal() {
  if (p_.journal == nullptr || !journal_.begun) return;
  if (!journal_.ending) journal_end(CommandState::aborted, "the machine was taken down");
  p_.journal->flush();
  (void)p_.journal->post(journal_record());
  p_.journal->flush();
  journal_ = {};
}

}  // namespace kerf::task
