// What task does itself, in its place in the program: tools, coolant, messages, user M-codes, M0, M66, M19, program end.
#include <unistd.h>

#include <cmath>
#include <cstdlib>

#include "task/interpreter/interpreter_participant.hpp"

namespace kerf::task {

using Kind = io::ToolOrder::Kind;

namespace {

std::string pin_number(int n) {
  char text[16];
  std::snprintf(text, sizeof text, "%02d", n);
  return text;
}

/// What fits into an operator's message beside its place: whole lines from the end, or the end of the last line.
std::string last_of(const std::string& text) {
  constexpr std::size_t kMost = 300;
  if (text.size() <= kMost) return text;
  std::size_t from = text.size() - kMost;
  if (const std::size_t line = text.find('\n', from); line != std::string::npos)
    from = line + 1;
  else
    while (from < text.size() && (static_cast<unsigned char>(text[from]) & 0xC0U) == 0x80U) ++from;
  return "... " + text.substr(from);
}

}  // namespace

bool InterpreterParticipant::pump(rtapi::WaitSpec& next) {
  bool moved = false;
  while (!list_.empty() && !run_.failed) {
    TaskItem& item = list_.front();
    if (!step_allows(item)) return moved;
    if (is_path(item)) {
      if (!motion_ready() || !settled() || !push(std::get<PathBody>(item.body), item.tag))
        return moved;
      history_.queued(item.tag.id, last_seq_);
    } else if (is_aside(item)) {
      asides_.push_back({pending_seq_, std::move(item)});
      aside_before_next_ = true;
    } else {
      if (!barrier_.marked) {
        // The marker carries the tag, so that everybody sees at which line the machine stands.
        if (!settled() || !push(motion::Marker{item.tag.id}, item.tag)) return moved;
        barrier_.marked = true;
        barrier_.marker_seq = last_seq_;
        history_.marked(item.tag.id, last_seq_);
        moved = true;
      }
      if (!executed() || !asides_.empty() || !tool_order_ended()) return moved;
      if (!barrier_.begun) {
        if (p_.exchange.paused.get() != 0) return moved;
        barrier_.begun = true;
        barrier_.since = now_;
        barrier_.resumes = p_.exchange.resumes.get();
        if (!begin_barrier(item)) return true;  // failed; the list may be gone
        moved = true;
      }
      if (!poll_barrier(item, next)) return moved;
      history_.done(item.tag.id);
      barrier_ = {};
      waiting_for_ = {};
    }
    if (list_.empty()) return true;
    list_.pop_front();
    moved = true;
  }
  return moved;
}

bool InterpreterParticipant::run_asides() {
  bool moved = false;
  (void)tool_order_ended();  // a failure ends the loop below
  while (!asides_.empty() && !run_.failed) {
    Aside& aside = asides_.front();
    if (aside.after_seq != 0 && status_.executed_seq < aside.after_seq) return moved;
    if (!run_aside(aside.item)) return moved;
    history_.done(aside.item.tag.id);
    asides_.pop_front();
    moved = true;
  }
  return moved;
}

/// True when io has no order of ours. A tool that cannot be prepared is a failure of the program.
bool InterpreterParticipant::tool_order_ended() {
  if (tool_order_ == 0 || !tool_order_is_prepare_) return true;
  const io::IoState state = p_.io.state();
  if (state.finished_order < tool_order_) return false;
  tool_order_ = 0;
  waiting_for_ = {};
  if (state.finished_well) return true;
  fail_at(prepare_tag_, std::string(state.failure.view()));
  return false;
}

bool InterpreterParticipant::run_aside(TaskItem& item) {
  if (const auto* tool = std::get_if<PrepareTool>(&item.body)) {
    if (tool_order_ != 0) return false;
    tool_order_ = p_.io.order(Kind::prepare, tool->number, epoch_);
    tool_order_is_prepare_ = true;
    prepare_tag_ = item.tag;
    waiting_for_.object =
        rtapi::FixedString<63>("tool " + std::to_string(tool->number) + " to be prepared");
    waiting_for_.pin = rtapi::FixedString<63>("iocontrol.0.tool-prepared");
    waiting_for_.since_ns = now_;
  } else if (const auto* coolant = std::get_if<SetCoolant>(&item.body)) {
    const auto wish = [](int v) { return v < 0 ? std::nullopt : std::optional<bool>(v != 0); };
    p_.io.set_coolant(epoch_, wish(coolant->flood), wish(coolant->mist));
  } else if (const auto* message = std::get_if<ShowMessage>(&item.body)) {
    Report report;
    report.message = message->kind;
    report.text = message->text;
    report.line = item.tag.line;
    reports_.push_back(std::move(report));
  } else if (const auto* print = std::get_if<PrintText>(&item.body)) {
    std::fprintf(stderr, "%s\n", print->text.c_str());
  } else if (const auto* log = std::get_if<LogText>(&item.body)) {
    log_text(*log);
  }
  return true;
}

void InterpreterParticipant::log_text(const LogText& log) {
  if (log.kind == LogText::Kind::text) {
    if (log_ != nullptr) std::fprintf(log_, "%s\n", log.text.c_str());
    return;
  }
  const bool of_probes =
      log.kind == LogText::Kind::probe_open || log.kind == LogText::Kind::probe_close;
  std::FILE*& file = of_probes ? probe_log_ : log_;
  if (file != nullptr) std::fclose(file);
  file = nullptr;
  if (log.kind == LogText::Kind::close || log.kind == LogText::Kind::probe_close) return;
  file = std::fopen(log.text.c_str(), log.kind == LogText::Kind::append ? "ae" : "we");
  if (file != nullptr) return;
  Report report;
  report.message = MessageKind::error;
  report.text = "cannot open the log file " + log.text;
  reports_.push_back(std::move(report));
}

/// False: it failed.
bool InterpreterParticipant::begin_barrier(TaskItem& item) {
  const auto wait_for = [&](const std::string& object, const std::string& pin) {
    waiting_for_.object = rtapi::FixedString<63>(object);
    waiting_for_.pin = rtapi::FixedString<63>(pin);
    waiting_for_.since_ns = now_;
  };
  if (const auto* change = std::get_if<ChangeTool>(&item.body)) {
    tool_order_is_prepare_ = false;
    barrier_.order = tool_order_ = p_.io.order(Kind::change, change->number, epoch_);
    wait_for("the tool change", "iocontrol.0.tool-changed");
  } else if (std::holds_alternative<StartChange>(item.body)) {
    tool_order_is_prepare_ = false;
    barrier_.order = tool_order_ = p_.io.order(Kind::start, -1, epoch_);
    wait_for("the tool changer to be ready for M6", "iocontrol.0.start-change-ack");
  } else if (const auto* number = std::get_if<SetToolNumber>(&item.body)) {
    tool_order_is_prepare_ = false;
    barrier_.order = tool_order_ = p_.io.order(Kind::set_number, number->number, epoch_);
  } else if (const auto* run = std::get_if<UserMcodeRun>(&item.body)) {
    wait_for("M" + std::to_string(run->number) + " to end", "");
    return start_user_program(*run);
  } else if (std::holds_alternative<ProgramPause>(item.body)) {
    wait_for("resume", "");
  } else if (const auto* input = std::get_if<WaitInput>(&item.body)) {
    wait_for(std::string(input->analog ? "analog" : "digital") + " input " +
                 std::to_string(input->index),
             std::string(input->analog ? "motion.analog-in-" : "motion.digital-in-") +
                 pin_number(input->index));
  } else if (const auto* orient = std::get_if<WaitOrient>(&item.body)) {
    wait_for("spindle " + std::to_string(orient->spindle) + " to be oriented",
             "spindle." + std::to_string(orient->spindle) + ".is-oriented");
  } else if (std::holds_alternative<ProgramEnd>(item.body)) {
    // Also what the operator switched on; and before a disk that may be slow.
    p_.io.set_coolant(epoch_, false, false);
    if (auto saved = save_parameters(); !saved.ok()) {
      Report report;
      report.message = MessageKind::error;
      report.text = "the parameter file is not saved: " + saved.error().message();
      reports_.push_back(std::move(report));
    }
    Report report;
    report.kind = Report::Kind::program_end;
    reports_.push_back(std::move(report));
  } else if (const auto* store = std::get_if<StoreTools>(&item.body)) {
    store_tools(*store);
  } else if (const auto* error = std::get_if<ProgramError>(&item.body)) {
    if (error->file.empty() && error->line == 0)
      fail_here(error->text);
    else
      fail(error->text, error->file, error->line);
    return false;
  }
  return true;
}

bool InterpreterParticipant::poll_barrier(TaskItem& item, rtapi::WaitSpec& next) {
  if (std::holds_alternative<ChangeTool>(item.body)) return poll_tool("tool change");
  if (std::holds_alternative<SetToolNumber>(item.body)) return poll_tool("M61");
  if (std::holds_alternative<StartChange>(item.body)) return poll_tool("tool change");
  if (const auto* run = std::get_if<UserMcodeRun>(&item.body)) return poll_user_program(*run);
  if (const auto* pause = std::get_if<ProgramPause>(&item.body)) return poll_pause(*pause);
  if (const auto* input = std::get_if<WaitInput>(&item.body)) return poll_input(*input, next);
  if (const auto* orient = std::get_if<WaitOrient>(&item.body)) return poll_orient(*orient, next);
  return true;
}

bool InterpreterParticipant::poll_tool(const char* what) {
  const io::IoState state = p_.io.state();
  if (barrier_.order == 0 || state.finished_order < barrier_.order) return false;
  tool_order_ = 0;
  if (state.finished_well && state.changer_fault &&
      std::holds_alternative<ChangeTool>(list_.front().body)) {
    Report report;
    report.message = MessageKind::text;
    report.text = "the tool changer reports " + std::to_string(state.changer_reason) +
                  ": the tool was not changed";
    report.line = list_.front().tag.line;
    reports_.push_back(std::move(report));
  }
  if (state.finished_well) {
    history_.tool_changed(list_.front().tag.id);
    return news_.tool = true;
  }
  fail_here(std::string(what) + ": " + std::string(state.failure.view()));
  return false;
}

bool InterpreterParticipant::start_user_program(const UserMcodeRun& run) {
  const motion::SourceTag& tag = list_.front().tag;
  std::vector<std::pair<std::string, std::string>> env;
  env.emplace_back("KERF_LINE", std::to_string(tag.line));
  env.emplace_back("KERF_FILE", interp_.file_name(static_cast<std::uint32_t>(tag.file)));
  const rtapi::Pose program = canon_.state().frame.to_program(status_.pos_cmd);
  for (std::size_t a = 0; a < rtapi::kAxes; ++a) {
    char text[40];
    const double unit = rtapi::is_rotary(a) ? p_.setup.angular_unit_deg : p_.setup.linear_unit_mm;
    std::snprintf(text, sizeof text, "%.6f", program[a] / unit);
    env.emplace_back(std::string("KERF_") + rtapi::kAxisLetters[a], text);
  }
  env.emplace_back("KERF_STATE", run_.mdi ? "mdi" : "auto");
  env.emplace_back("KERF_INSTANCE", p_.instance);
  auto started = user_.start(run.path, {run.p, run.q}, env);
  if (started.ok()) return true;
  fail_here("M" + std::to_string(run.number) + ": " + started.error().message());
  return false;
}

bool InterpreterParticipant::poll_user_program(const UserMcodeRun& run) {
  const auto end = user_.poll();
  if (!end) return false;
  // In 2.7 nobody looks at the exit status.
  if (end->status == 0 || p_.setup.interp.compat == interp::Compat::v2_7) return true;
  std::string text = "M" + std::to_string(run.number) + " (" + run.path + ") ended with " +
                     (end->status > 128 ? "signal " + std::to_string(end->status - 128)
                                        : "exit status " + std::to_string(end->status));
  if (!end->error_text.empty()) text += ": " + last_of(end->error_text);
  fail_here(text);
  return false;
}

bool InterpreterParticipant::poll_pause(const ProgramPause& pause) {
  // A line of MDI stops at its end anyway, but a sub that it calls has more lines.
  const bool at_end = run_.mdi && list_.front().tag.call_level == 0;
  if (at_end || (pause.optional && !barrier_.pausing && p_.exchange.optional_stop.get() == 0))
    return true;
  const bool waited = barrier_.pausing;
  barrier_.pausing = p_.exchange.resumes.get() == barrier_.resumes;
  // The step that ends the wait is the block behind it.
  if (waited && !barrier_.pausing) run_.step.release();
  return !barrier_.pausing;
}

bool InterpreterParticipant::poll_input(const WaitInput& wait, rtapi::WaitSpec& next) {
  const auto index = static_cast<std::size_t>(wait.index);
  const std::int32_t count = wait.analog ? status_.analog_count : status_.digital_count;
  if (wait.index < 0 || wait.index >= count) {
    fail_here("M66: there is no " + std::string(wait.analog ? "analog" : "digital") + " input " +
              std::to_string(wait.index) + ": motmod has " + std::to_string(count) + " (" +
              (wait.analog ? "num_aio" : "num_dio") + ")");
    return false;
  }
  const bool high = !wait.analog && (status_.digital_in >> index & 1U) != 0;
  bool met = false;
  switch (wait.mode) {
    case interp::WaitMode::immediate: met = true; break;
    case interp::WaitMode::rise:
      met = barrier_.armed && high;
      barrier_.armed = barrier_.armed || !high;
      break;
    case interp::WaitMode::fall:
      met = barrier_.armed && !high;
      barrier_.armed = barrier_.armed || high;
      break;
    case interp::WaitMode::high: met = high; break;
    case interp::WaitMode::low: met = !high; break;
  }
  if (met) {
    input_value_ = wait.analog ? status_.analog_in[index] : high ? 1 : 0;
    input_timeout_ = false;
    news_.input = true;
    return true;
  }
  const rtapi::Nanos end = barrier_.since + rtapi::seconds(wait.timeout_s);
  if (now_ >= end) {
    input_value_ = -1;
    input_timeout_ = true;
    news_.input = true;
    return true;
  }
  // Inputs have no cell: they are looked at once a servo cycle.
  next.wake_at(std::min(end, now_ + std::max(status_.servo_period_ns, rtapi::kMillisecond)));
  return false;
}

bool InterpreterParticipant::poll_orient(const WaitOrient& wait, rtapi::WaitSpec& next) {
  const auto& spindle = status_.spindle[static_cast<std::size_t>(wait.spindle)];
  if (spindle.orient_state == 2) return true;
  const std::string name = "spindle " + std::to_string(wait.spindle);
  if (spindle.orient_state == 3) {
    fail_here("M19: " + name + " could not be oriented, orient-fault " +
              std::to_string(spindle.orient_fault));
    return false;
  }
  const rtapi::Nanos end = barrier_.since + rtapi::seconds(wait.timeout_s);
  if (now_ >= end) {
    fail_here("M19: " + name + " was not oriented within " + std::to_string(wait.timeout_s) +
              " s: spindle." + std::to_string(wait.spindle) + ".is-oriented is FALSE");
    return false;
  }
  next.wake_at(std::min(end, now_ + std::max(status_.servo_period_ns, rtapi::kMillisecond)));
  return false;
}

}  // namespace kerf::task
