#include "task/interpreter/interpreter_participant.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "rtapi/sync/patient_read.hpp"

namespace kerf::task {

using interp::Outcome;

namespace {

constexpr std::size_t kListLimit = 64;  ///< items read ahead of the ring
constexpr int kWorkPerStep = 256;       ///< so that the clock is looked at
constexpr int kSilentBlocks = 4096;     ///< blocks in a row that ask nothing of the machine ...
constexpr rtapi::Nanos kSilentTime = 100'000;  ///< ... cost this time
constexpr rtapi::Nanos kModeTime = 2 * rtapi::kSecond;
constexpr double kSamePlace =
    1e-6;  ///< mm, degrees: closer than this the machine stands where the program thinks

/// Lines of a file, without keeping it.
std::int32_t count_lines(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return 0;
  std::int32_t lines = 0;
  char last = '\n';
  char buffer[65536];
  for (ssize_t n = 0; (n = ::read(fd, buffer, sizeof buffer)) > 0;) {
    lines += static_cast<std::int32_t>(std::count(buffer, buffer + n, '\n'));
    last = buffer[n - 1];
  }
  ::close(fd);
  return last == '\n' ? lines : lines + 1;
}

bool far_apart(const rtapi::Pose& a, const rtapi::Pose& b) {
  for (std::size_t i = 0; i < rtapi::kAxes; ++i)
    if (std::fabs(a[i] - b[i]) > kSamePlace) return true;
  return false;
}

}  // namespace

InterpreterParticipant::InterpreterParticipant(const Parts& parts)
    : p_(parts),
      canon_(list_, p_.setup.tools),
      interp_(p_.environment, canon_, p_.setup.interp),
      parameter_file_(p_.setup.paths.parameter_file) {
  (void)rtapi::read_patiently(p_.motion.status, status_);
  epoch_ = p_.motion.intent.abort_epoch.observe();
  // A motion that outlived an earlier task has seen numbers already.
  last_seq_ = std::max({status_.executed_seq, status_.current_seq, p_.motion.path.pushed()});
  canon_.start_tags_after(status_.current.id);
  canon_.set_indexers(p_.setup.interp.indexer_mask);
}

InterpreterParticipant::~InterpreterParticipant() {
  if (log_ != nullptr) std::fclose(log_);
  if (probe_log_ != nullptr) std::fclose(probe_log_);
}

rtapi::Status InterpreterParticipant::init() {
  rtapi::Status loaded;
  if (!p_.setup.paths.parameter_file.empty()) {
    loaded = parameter_file_.load(interp_.parameters());
    if (!loaded.ok() && loaded.error().code == rtapi::Errc::not_found)
      loaded = {};  // the first start of a new machine
  }
  interp_.init();
  if (loaded.ok() && !interp_.script_problem().empty())
    loaded = rtapi::fail(rtapi::Errc::bad_argument, interp_.script_problem());
  if (loaded.ok() && !p_.setup.startup_code.empty()) {
    Outcome outcome = interp_.execute_mdi(p_.setup.startup_code);
    while (outcome == Outcome::ok) outcome = interp_.execute_next();
    if (outcome == Outcome::error)
      loaded = rtapi::fail(rtapi::Errc::syntax,
                           "[RS274NGC]RS274NGC_STARTUP_CODE: " + interp_.error().message());
  }
  // Nothing of this is for the machine; what lasts is announced with the first order.
  list_.clear();
  announce_ = true;
  const io::IoState io = p_.io.state();
  interp_.set_tool_in_spindle(io.tool_in_spindle, io.pocket_in_spindle);
  history_.reset(interp_.modal(), canon_.state());
  show();
  return loaded;
}

void InterpreterParticipant::shut_down() {
  (void)rtapi::read_patiently(p_.motion.status, status_);
  interp_.abort();
  interp_.restore(history_.stopped_at(status_.current.id).modal);
}

rtapi::Status InterpreterParticipant::save_parameters() {
  if (p_.setup.paths.parameter_file.empty()) return {};
  return parameter_file_.save(interp_.parameters());
}

void InterpreterParticipant::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  next.watch(p_.shared.to_interpreter);
  next.watch(p_.motion.status_cell);
  now_ = now;
  pushed_ = false;
  // Status first, epoch second: a status that is used was written before the abort was acknowledged.
  if (!p_.motion.status.read(status_)) next.wake_at(now + rtapi::kReadAgain);
  canon_.set_output_counts(status_.digital_count, status_.analog_count);
  follow_abort();
  if (aborting_) resynchronise();
  if (!aborting_ && seek_)
    search(next);
  else if (!aborting_)
    work(next);
  // Their place is told late while much is queued behind it.
  if (!asides_.empty()) next.wake_at(now + std::max(status_.servo_period_ns, rtapi::kMillisecond));
  check_limits(next);
  user_.drain();
  user_.add_to(next, p_.segment);
  hear_database(next);
  if (pushed_) p_.motion.path_cell.notify();
  const bool only_waits = !aborting_ && run_.active && (run_.source_done || run_.sync_pending) &&
                          !ring_full_ && !executed();
  p_.motion.awaited_seq.set(only_waits ? pending_seq_ : 0);
  show();
  // Behind the view, so that whoever hears of an end also sees it.
  for (Report& report : reports_) p_.exchange.report(std::move(report));
  reports_.clear();
}

void InterpreterParticipant::follow_abort() {
  const std::uint32_t epoch = p_.motion.intent.abort_epoch.observe();
  if (epoch == epoch_) return;
  epoch_ = epoch;
  seek_.reset();
  list_.clear();
  asides_.clear();
  barrier_ = {};
  tool_order_ = 0;
  news_ = {};
  pending_seq_ = settling_seq_ = 0;
  stopped_ = false;
  ring_full_ = false;
  waiting_for_ = {};
  user_.terminate();
  if (run_.active) finish_ticket(CommandState::aborted, "aborted");
  run_ = {};
  shift_ = {};
  exchange_order_ = 0;
  aborting_ = true;
}

void InterpreterParticipant::resynchronise() {
  (void)user_.poll();
  if (user_.running() || status_.acked_epoch != epoch_) return;
  const BlockRecord& at = history_.stopped_at(status_.current.id);
  interp::ModalState modal = at.modal;
  CanonState canon = at.canon;
  if (at.tool_awaited) {
    modal.frame.use_tool_length_offset(at.offset_before);
    canon.frame.use_tool_length_offset(at.offset_before);
    modal.tool_offset_code = at.offset_code_before;
  }
  // The abort stopped these, whatever the block had asked for.
  modal.direction.fill(interp::SpindleDirection::stopped);
  modal.orienting.fill(false);
  modal.mist = modal.flood = false;
  interp_.abort();
  interp_.restore(modal);
  canon_.restore(canon);
  canon_.forget_outputs();
  canon_.set_position(status_.pos_cmd);
  const io::IoState io = p_.io.state();
  interp_.synchronize({.machine_position = status_.pos_cmd,
                       .tool_in_spindle = io.tool_in_spindle,
                       .pocket_in_spindle = io.pocket_in_spindle});
  announce_ = true;
  aborting_ = false;
  run_on_abort(p_.exchange.abort_reason.get());
  history_.reset(interp_.modal(), canon_.state());
}

void InterpreterParticipant::work(rtapi::WaitSpec& next) {
  interp_.set_block_delete(p_.exchange.block_delete.get() != 0);
  for (int i = 0; i < kWorkPerStep; ++i) {
    if (p_.motion.intent.abort_epoch.observe() != epoch_) break;
    if (seek_) {
      next.wake_at(now_);
      return;
    }
    note_stepping();
    bool moved = exchange_tools();
    moved = run_asides() || moved;
    moved = pump(next) || moved;
    history_.advance(status_.executed_seq, status_.current_seq);
    moved = synchronise_if_due() || moved;
    moved = step_stop() || moved;
    moved = read_block() || moved;
    moved = finish_run() || moved;
    moved = next_order() || moved;
    if (!moved) return;
  }
  // A program that computes without end (waiting for a pin in a loop) must let time pass, or nothing ever changes.
  const bool computes = silent_blocks_ >= kSilentBlocks;
  if (computes) silent_blocks_ = 0;
  next.wake_at(computes ? now_ + kSilentTime : now_);
}

bool InterpreterParticipant::motion_ready() const {
  const bool any_mode = run_.active && run_.by_hand;
  return status_.enabled && status_.path_shift == shift_ &&
         (any_mode || status_.mode == motion::MotionMode::coordinated);
}

bool InterpreterParticipant::push(const PathBody& body, const motion::SourceTag& tag) {
  motion::PathItem item;
  item.epoch = epoch_;
  item.seq = last_seq_ + 1;
  item.tag = tag;
  item.apart = aside_before_next_ ? 1 : 0;
  item.body = body;
  ring_full_ = !p_.motion.path.push(item);
  if (ring_full_) return false;
  news_.probe = news_.probe || std::holds_alternative<motion::ProbeMove>(body);
  pending_seq_ = ++last_seq_;
  last_tag_ = tag.id;
  const auto* tool = std::get_if<motion::ToolOffset>(&body);
  if (tool != nullptr && !status_.shifts_path && tool->offset != status_.tool_offset)
    settling_seq_ = last_seq_;
  run_.in_thread = std::holds_alternative<motion::SyncMove>(body) ||
                   (run_.in_thread && !motion::ends_thread(body) &&
                    !std::holds_alternative<motion::Marker>(body));
  aside_before_next_ = false;
  pushed_ = true;
  return true;
}

bool InterpreterParticipant::read_block() {
  if (!run_.active || run_.failed || run_.source_done || run_.sync_pending || stopped_ ||
      list_.size() >= kListLimit)
    return false;
  // One block after another; but whether a thread goes on says the block behind.
  if (run_.stepping && (!list_.empty() || (run_.step.begun() && !run_.in_thread))) return false;
  if (!motion_ready()) {
    if (now_ - run_.since > kModeTime)
      fail_here(status_.enabled ? "motion did not come into coordinated mode"
                                : "the drives are not enabled");
    return false;
  }
  if (announce_) {
    announce_ = false;
    BlockRecord record = history_.present();
    const std::size_t before = list_.size();
    canon_.announce(canon_.new_tag());
    record.tag = canon_.tag();
    record.tag.line = record.tag.main_line = 0;
    record.first_seq = record.last_seq = 0;
    record.pending = static_cast<int>(list_.size() - before);
    record.has_items = true;
    history_.add(record);
    run_.step.allow(canon_.tag().id);
  }
  canon_.new_tag();
  if (p_.setup.tools.at_g30)
    canon_.set_g30(interp_.parameters().pose(interp::kG30Home, p_.setup.linear_unit_mm));
  const std::size_t before = list_.size();
  BlockRecord record;
  record.offset_before = interp_.modal().frame.tool();
  record.offset_code_before = interp_.modal().tool_offset_code;
  ++run_.blocks;
  const bool held = interp_.waiting();
  if (held) canon_.begin_delivery(interp_);
  Outcome outcome = Outcome::ok;
  if (run_.mdi && !run_.mdi_begun) {
    run_.mdi_begun = true;
    outcome = interp_.execute_mdi(run_.text);
  } else {
    outcome = interp_.execute_next();
  }
  silent_blocks_ = list_.size() > before ? 0 : silent_blocks_ + 1;
  if (held) record_delivered();
  take_outcome(outcome, held ? list_.size() : before, record);
  place_items(before);
  if (run_.stepping && !run_.step.begun() && list_.size() > before)
    run_.step.begin(list_[before].tag.id);
  return true;
}

// Blocks that waited behind a compensated move each get a record of their own; the block that was executed goes on alone.
void InterpreterParticipant::record_delivered() {
  const auto& blocks = canon_.end_delivery();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::size_t end = i + 1 < blocks.size() ? blocks[i + 1].first_item : list_.size();
    BlockRecord record;
    record.tag = blocks[i].tag;
    record.pending = static_cast<int>(end - blocks[i].first_item);
    record.has_items = record.pending > 0;
    record.modal = blocks[i].modal;
    record.canon = blocks[i].canon;
    record.offset_before = record.modal.frame.tool();
    record.offset_code_before = record.modal.tool_offset_code;
    note_extent(blocks[i].first_item, end, record);
    history_.add(record);
  }
  if (!blocks.empty()) canon_.new_tag();
}

void InterpreterParticipant::take_outcome(Outcome outcome, std::size_t items_before,
                                          BlockRecord record) {
  // The next block must find the new table; a block that is only read ahead must not change it.
  if (queue_tool_changes() && outcome == Outcome::ok) run_.sync_pending = true;
  if (outcome == Outcome::error) {
    const auto& error = interp_.error();
    std::string text = error.message();
    if (const std::string caret = error.caret(); !caret.empty())
      text.append("\n").append(error.source).append("\n").append(caret);
    list_.push_back(TaskItem{canon_.tag(), ProgramError{std::move(text), error.file, error.line}});
    run_.source_done = run_.read_error = true;
  }
  if (outcome == Outcome::idle || outcome == Outcome::program_end) run_.source_done = true;
  if (outcome == Outcome::needs_sync) run_.sync_pending = true;
  // Where the machine stands with the other tool, only its kinematics know.
  if (record.offset_before != interp_.modal().frame.tool() && !status_.shifts_path)
    run_.sync_pending = true;
  record.tag = canon_.tag();
  record.tool_awaited =
      std::any_of(list_.begin() + static_cast<std::ptrdiff_t>(items_before), list_.end(),
                  [](const TaskItem& i) { return std::holds_alternative<ChangeTool>(i.body); });
  record.pending = static_cast<int>(list_.size() - items_before);
  record.has_items = record.pending > 0;
  record.modal = interp_.modal();
  record.canon = canon_.state();
  record.machine_place = interp_.used_machine_place();
  note_extent(items_before, list_.size(), record);
  history_.add(record);
}

void InterpreterParticipant::hear_database(rtapi::WaitSpec& next) {
  for (std::string& text : p_.tools.database_news()) {
    Report report;
    report.message = MessageKind::error;
    report.text = std::move(text);
    reports_.push_back(std::move(report));
  }
  for (const int fd : p_.tools.database_fds()) next.watch_fd(fd);
}

rtapi::Status InterpreterParticipant::load_tools() {
  KERF_CHECK(p_.tools.load());
  // The tool in the spindle has a new row too.
  const io::IoState io = p_.io.state();
  interp_.set_tool_in_spindle(io.tool_in_spindle, io.pocket_in_spindle);
  return {};
}

bool InterpreterParticipant::queue_tool_changes() {
  StoreTools store{canon_.take_tool_changes(), canon_.take_reload()};
  if (store.tools.empty() && !store.reload) return false;
  list_.push_back(TaskItem{canon_.tag(), std::move(store)});
  return true;
}

void InterpreterParticipant::store_tools(const StoreTools& store) {
  const auto complain = [this](const std::string& text) {
    Report report;
    report.message = MessageKind::error;
    report.text = text;
    reports_.push_back(std::move(report));
  };
  for (const interp::Tool& tool : store.tools) {
    io::ToolEntry entry;
    entry.number = tool.number;
    entry.pocket = tool.pocket;
    entry.offset = tool.offset;
    entry.diameter_mm = tool.diameter_mm;
    entry.front_angle_deg = tool.front_angle_deg;
    entry.back_angle_deg = tool.back_angle_deg;
    entry.orientation = tool.orientation;
    if (auto saved = p_.tools.put(entry); !saved.ok())
      complain("the tool table is not saved: " + saved.error().message());
  }
  if (!store.reload) return;
  if (auto loaded = load_tools(); !loaded.ok()) complain(loaded.error().message());
}

std::optional<motion::Pose> InterpreterParticipant::moved_position() const {
  // Only a machine that was moved by somebody else is asked where it stands: rounding must not creep into programs. The way to the
  // tool change position is the canon's own; the interpreter knows nothing of it.
  const interp::ModalState& modal = interp_.modal();
  if (!far_apart(status_.place, canon_.state().position) &&
      (interp_.beside_path() || !far_apart(status_.place, modal.frame.to_machine(modal.position))))
    return std::nullopt;
  return status_.place;
}

void InterpreterParticipant::sync_position() {
  const auto moved = moved_position();
  if (!moved) return;
  canon_.set_position(*moved);
  interp_.synchronize({.machine_position = *moved});
}

void InterpreterParticipant::tell_interpreter() {
  interp::ExternalState state;
  if (news_.tool) {
    const io::IoState io = p_.io.state();
    state.tool_in_spindle = io.tool_in_spindle;
    state.pocket_in_spindle = io.pocket_in_spindle;
    if (p_.setup.tools.v2) {
      state.toolchanger_fault = io.changer_fault ? io.changer_reason : 0;
    }
  }
  if (news_.input) state.input_value = input_value_;
  if (news_.probe)
    state.probe = interp::ExternalState::Probe{status_.probed, status_.probe_tripped};
  news_ = {};
  state.machine_position = moved_position();
  if (state.machine_position) canon_.set_position(*state.machine_position);
  interp_.synchronize(state);
  if (probe_log_ == nullptr || !state.probe || !state.probe->tripped) return;
  for (int i = 0; i < 9; ++i)
    std::fprintf(probe_log_, i == 0 ? "%f" : " %f", interp_.parameters().get(interp::kProbe + i));
  std::fputc('\n', probe_log_);
  std::fflush(probe_log_);
}

bool InterpreterParticipant::synchronise_if_due() {
  if (!run_.sync_pending || !list_.empty() || !asides_.empty() || tool_order_ != 0 || !executed())
    return false;
  tell_interpreter();
  run_.sync_pending = false;
  return true;
}

// Single step, of what motion does not have yet: the rule is in motion/api/step.hpp.
void InterpreterParticipant::note_stepping() {
  const bool stepping = run_.active && !run_.mdi && p_.exchange.stepping.get() != 0;
  if (stepping && !run_.stepping) {
    stepped_to_ = executed() ? history_.present().tag.id : 0;
    run_.step.allow(last_tag_);
    // At M0 a step is the block behind it.
    if (!executed() || !asides_.empty() || (barrier_.marked && !barrier_.pausing))
      run_.step.begin(last_tag_);
  }
  if (!stepping) run_.step.release();
  run_.stepping = stepping;
}

/// While stepping: whether the item at the head of the list may begin.
bool InterpreterParticipant::step_allows(const TaskItem& item) {
  if (!run_.stepping || run_.step.covers(item.tag.id)) return true;
  const auto* body = std::get_if<PathBody>(&item.body);
  if (run_.in_thread && body != nullptr && !motion::ends_thread(*body)) {
    run_.step.begin(item.tag.id);
    return true;
  }
  if (run_.step.begun() || stopped_ || !executed() || !asides_.empty()) return false;
  return run_.step.takes(item.tag.id);
}

bool InterpreterParticipant::step_stop() {
  if (!run_.active || run_.mdi || run_.failed) return false;
  if (!stopped_) {
    // A held queue: motion itself steps through it.
    if (status_.held) stepped_to_ = history_.present().tag.id;
    const bool rest = !list_.empty() && run_.step.covers(list_.front().tag.id);
    if (!run_.step.begun() || rest || !asides_.empty() || !executed() ||
        (run_.source_done && list_.empty()))
      return false;
    run_.step.release();
    if (p_.setup.step_by_moves && history_.moved() <= stepped_to_) return true;
    stepped_to_ = history_.present().tag.id;
    stopped_ = true;
    stopped_at_ = now_;
    step_resumes_ = p_.exchange.resumes.get();
    return true;
  }
  if (p_.exchange.resumes.get() == step_resumes_) return false;
  stopped_ = false;
  return true;
}

bool InterpreterParticipant::finish_run() {
  if (!run_.active || run_.failed || !run_.source_done || run_.sync_pending || stopped_)
    return false;
  if (!list_.empty() || !asides_.empty() || tool_order_ != 0 || !executed()) return false;
  tell_interpreter();  // the block that ended the program may have changed the tool
  if (!run_.mdi) progress_ = 1;
  finish_ticket(CommandState::done);
  run_ = {};
  return true;
}

void InterpreterParticipant::finish_ticket(CommandState state, const std::string& text) {
  if (run_.ticket == 0) return;
  Report report;
  report.kind = Report::Kind::finished;
  report.ticket = std::exchange(run_.ticket, 0);
  report.state = state;
  report.text = text;
  reports_.push_back(std::move(report));
}

void InterpreterParticipant::fail_here(const std::string& text) {
  // A barrier in progress is where the machine stands; the history may not have followed yet.
  fail_at(barrier_.begun && !list_.empty() ? list_.front().tag : history_.present().tag, text);
}

void InterpreterParticipant::fail_at(const motion::SourceTag& tag, const std::string& text) {
  fail(text, run_.mdi ? std::string() : interp_.file_name(static_cast<std::uint32_t>(tag.file)),
       tag.line);
}

namespace {
/// "MDI:1:7: text", "help" on a second line -> "text"
std::string without_place(const std::string& text) {
  std::size_t from = 0;
  if (text.rfind("MDI:", 0) == 0)
    if (const auto colon = text.find(": "); colon != std::string::npos) from = colon + 2;
  return text.substr(from, text.find('\n') - from);
}
}  // namespace

void InterpreterParticipant::fail(const std::string& text, const std::string& file,
                                  std::int32_t line) {
  Report report;
  report.text = text;
  const std::string place = file.empty() ? std::string() : file + ':' + std::to_string(line) + ": ";
  if (!place.empty() && text.rfind(file, 0) != 0) report.text = place + text;
  report.file = file;
  report.line = line;
  report.message = MessageKind::error;
  failed_ = true;
  // A line of MDI that fails at rest harms nobody: the spindle may go on turning. Everything else is an abort.
  const bool quiet =
      run_.mdi && asides_.empty() && tool_order_ == 0 && executed() && !user_.running();
  if (quiet) {
    report.kind = Report::Kind::message;
    // Whoever typed the line hears all; other operators need no place in a line that they do not see.
    const std::string shown = report.text;
    report.text = without_place(report.text);
    reports_.push_back(std::move(report));
    finish_ticket(CommandState::error, shown);
    list_.clear();
    barrier_ = {};
    waiting_for_ = {};
    news_ = {};
    interp_.abort();
    run_ = {};
    run_on_abort(abort_interpreter_error_mdi);
    history_.reset(interp_.modal(), canon_.state());
    drop_mdi_orders();
    return;
  }
  report.kind = Report::Kind::failed;
  report.epoch = epoch_;
  report.reason = run_.mdi                              ? abort_interpreter_error_mdi
                  : run_.source_done && run_.read_error ? abort_interpreter_error
                                                        : abort_exec_error;
  report.ticket = std::exchange(run_.ticket, 0);
  reports_.push_back(std::move(report));
  run_.failed = true;
}

/// What was sent before the failure was known is not wanted behind it.
void InterpreterParticipant::drop_mdi_orders() {
  for (const Order& order : p_.exchange.take_mdi(epoch_)) {
    Report report;
    report.kind = Report::Kind::finished;
    report.ticket = order.ticket;
    report.state = CommandState::aborted;
    report.text = "an earlier MDI line failed";
    reports_.push_back(std::move(report));
  }
}

bool InterpreterParticipant::next_order() {
  if (run_.active) return false;
  Order order;
  if (!p_.exchange.take(order)) return false;
  if (static_cast<std::int32_t>(order.epoch - epoch_) > 0) {
    // An abort has come since this step began; the order is one behind it.
    p_.exchange.put_back(std::move(order));
    return false;
  }
  run_.ticket = order.ticket;
  check_.reset();
  if (order.epoch != epoch_) {
    finish_ticket(CommandState::aborted, "aborted");
    return true;
  }
  rtapi::Status result;
  switch (order.kind) {
    case Order::Kind::open:
      result = open_program(p_.environment.find_program(order.text));
      check_due_ = result.ok() && p_.setup.check_limits;
      break;
    case Order::Kind::reload_tools: result = load_tools(); break;
    case Order::Kind::put_tool: result = put_tool(order.tool); break;
    case Order::Kind::reset: reset_state(); break;
    case Order::Kind::synch: sync_position(); break;
    case Order::Kind::save: result = save_parameters(); break;
    case Order::Kind::run:
    case Order::Kind::step:
    case Order::Kind::mdi: begin_run(order); return true;
  }
  finish_ticket(result.ok() ? CommandState::done : CommandState::error,
                result.ok() ? std::string() : result.error().message());
  run_ = {};
  return true;
}

/// A remark is kept by the table; offsets of axes that the caller does not give, too.
rtapi::Status InterpreterParticipant::put_tool(const io::ToolEntry& tool) {
  io::ToolEntry entry = tool;
  if (const io::ToolEntry* old = p_.tools.table()->find(tool.number); old != nullptr) {
    entry = *old;
    entry.offset.x = tool.offset.x;
    entry.offset.z = tool.offset.z;
    entry.diameter_mm = tool.diameter_mm;
    entry.front_angle_deg = tool.front_angle_deg;
    entry.back_angle_deg = tool.back_angle_deg;
    entry.orientation = tool.orientation;
  }
  KERF_CHECK(p_.tools.put(entry));
  return load_tools();
}

/// As after the program's end, and nothing of an error is left.
void InterpreterParticipant::reset_state() {
  interp_.abort();
  interp_.init();
  list_.clear();
  announce_ = true;
  failed_ = false;
  const io::IoState io = p_.io.state();
  interp_.set_tool_in_spindle(io.tool_in_spindle, io.pocket_in_spindle);
  sync_position();
  history_.reset(interp_.modal(), canon_.state());
}

rtapi::Status InterpreterParticipant::open_program(const std::string& path) {
  if (auto opened = interp_.open(path); !opened.ok()) return opened;
  file_ = path;
  program_lines_ = count_lines(path);
  progress_ = 0;
  return {};
}

void InterpreterParticipant::begin_run(const Order& order) {
  run_.mdi = order.kind == Order::Kind::mdi;
  run_.by_hand = order.by_hand;
  if (run_.mdi) {
    run_.text = order.text;
    command_ = order.text;
  } else if (file_.empty()) {
    finish_ticket(CommandState::error, "no program is open");
    return;
  } else if (auto opened = open_program(file_);
             !opened.ok()) {  // from the start, as the file is now
    finish_ticket(CommandState::error, opened.error().message());
    return;
  }
  run_.active = true;
  failed_ = false;
  run_.since = now_;
  if (!(shift_ == motion::Pose{})) {
    // Nothing of the path that it was for is left.
    shift_ = {};
    ask_shift(0);
  }
  sync_position();
  history_.reset(interp_.modal(), canon_.state());
  Report report;
  report.kind = Report::Kind::begun;
  report.ticket = order.ticket;
  reports_.push_back(std::move(report));
  if (!run_.mdi) check_due_ = false;  // each move is looked at as it comes
  if (order.line > 0) begin_seek(order);
}

}  // namespace kerf::task
