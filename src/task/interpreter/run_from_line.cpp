// Run from line: the program is read to the line without a word to the machine (ProgramSeek); then the machine is brought into
// the state that the line would have found, and the program goes on. docs/run-from-line.md
#include <cmath>

#include "task/interpreter/interpreter_participant.hpp"

namespace kerf::task {

using motion::LinearMove;
using motion::MotionKind;

namespace {
constexpr int kBlocksPerStep = 4096;
constexpr rtapi::Nanos kSearchTime = 100'000;  ///< these blocks cost this time
constexpr double kDefaultPlungeSpeed = 5;      ///< mm/s
constexpr double kNoLimit = 1e9;
constexpr double kSamePlace = 1e-6;  ///< mm, degrees
}  // namespace

void InterpreterParticipant::begin_seek(const Order& order) {
  const io::IoState io = p_.io.state();
  seek_ = std::make_unique<ProgramSeek>(ProgramSeek::Parts{p_.environment, canon_, list_, p_.setup},
                                        interp_, io.tool_in_spindle, io.pocket_in_spindle,
                                        order.seek_end);
  seek_->interpreter().set_block_delete(p_.exchange.block_delete.get() != 0);
  waiting_for_.object =
      rtapi::FixedString<63>("line " + std::to_string(order.line) + " to be found");
  waiting_for_.since_ns = now_;
  if (!seek_->open(file_, order.line)) refuse_seek("run from line " + std::to_string(order.line));
}

void InterpreterParticipant::refuse_seek(const std::string& what) {
  const std::string text = what + ": " + seek_->refusal();
  seek_.reset();
  waiting_for_ = {};
  Report report;
  report.message = MessageKind::error;
  report.text = text;
  reports_.push_back(std::move(report));
  finish_ticket(CommandState::error, text);
  run_ = {};
}

void InterpreterParticipant::search(rtapi::WaitSpec& next) {
  const std::string what = "run from line " + std::to_string(seek_->line());
  for (int i = 0; i < kBlocksPerStep; ++i) {
    if (abort_came()) return;
    switch (seek_->step()) {
      case ProgramSeek::Step::more: continue;
      case ProgramSeek::Step::refused: refuse_seek(what); break;
      case ProgramSeek::Step::found: end_seek(what); break;
    }
    next.wake_at(now_);
    return;
  }
  next.wake_at(now_ + kSearchTime);
}

void InterpreterParticipant::end_seek(const std::string& what) {
  waiting_for_ = {};
  const io::IoState io = p_.io.state();
  MachineNow now{io.tool_in_spindle, io.flood,        io.mist, status_.digital_out,
                 status_.analog_out, status_.pos_cmd, {},      {}};
  std::array<std::int32_t, motion::kMaxSpindles> direction{};
  std::array<double, motion::kMaxSpindles> rpm{};
  for (std::size_t n = 0; n < motion::kMaxSpindles; ++n) {
    direction[n] = status_.spindle[n].on ? status_.spindle[n].direction : 0;
    rpm[n] = status_.spindle[n].speed_rpm;
  }
  now.spindle_direction = direction.data();
  now.spindle_rpm = rpm.data();
  std::string text;
  for (const std::string& line : seek_differences(*seek_, seek_->interpreter().modal(),
                                                  canon_.state(), now, p_.setup.motion.spindles))
    text += (text.empty() ? "" : "\n") + line;
  if (text.empty()) text = "nothing differs";
  if (seek_->end() == SeekEnd::check) {
    seek_.reset();
    finish_ticket(CommandState::done, text);
    run_ = {};
    return;
  }
  Report report;
  report.message = MessageKind::text;
  report.text = what + ": " + text;
  reports_.push_back(std::move(report));
  interp_.swap(seek_->interpreter());
  approach();
  seek_->keep();
  seek_.reset();
}

/// Queues what brings the machine to the state of canon and interpreter: out of the work, tool, outputs, spindle, coolant, to
/// the place, and down at feed.
void InterpreterParticipant::approach() {
  const CanonState wanted = canon_.state();
  const interp::ModalState modal = interp_.modal();
  const CanonState from = seek_->from_canon();
  const io::IoState io = p_.io.state();

  BlockRecord record;
  record.machine_place = true;
  record.offset_before = from.frame.tool();
  record.offset_code_before = seek_->from_modal().tool_offset_code;
  canon_.new_tag();
  interp::SourceLine place;
  place.file_id = interp_.current_file();
  place.line = place.main_line = seek_->line();
  place.file = interp_.file_name(place.file_id);
  canon_.next_block(place);
  const auto add = [this](auto body) {
    list_.push_back(TaskItem{canon_.tag(), TaskItemBody(PathBody(body))});
  };
  const auto add_own = [this](auto body) {
    list_.push_back(TaskItem{canon_.tag(), TaskItemBody(std::move(body))});
  };
  rtapi::Pose at = from.position;
  const auto go = [&](const rtapi::Pose& to, double vel_mm_s, MotionKind kind) {
    if (to == at) return;
    if (kind == MotionKind::traverse)
      canon_.add_rapid(at, to, kind);
    else
      add(LinearMove{to, vel_mm_s, kind});
    at = to;
  };
  const bool new_tool = io.tool_in_spindle != seek_->tool();
  bool away = false;
  for (std::size_t a = 0; a < rtapi::kAxes; ++a)
    away = away || std::fabs(at[a] - wanted.position[a]) > kSamePlace;
  // Corners of these moves are not rounded, and the operator may slow them.
  motion::PathControl sharp;
  sharp.mode = motion::PathControl::Mode::exact_stop;
  add(sharp);
  add(motion::OverrideEnable{});
  if (from.feed_mode == interp::FeedMode::per_revolution) add(motion::FeedPerRev{});
  add(motion::ToolOffset{from.frame.tool()});
  const int retract = p_.setup.retract_axis();
  const auto up = [&] {
    if (retract < 0) return;
    const auto a = static_cast<std::size_t>(retract);
    const double limit = p_.setup.motion.axis[a].max_limit;
    const bool to_limit = a == 2 && limit < kNoLimit;
    rtapi::Pose to = at;
    to[a] = std::max(at[a], to_limit ? limit : seek_->highest(a));
    go(to, 0, MotionKind::traverse);
  };
  if (new_tool || away) up();
  // The way to the tool and its change are the canon's own.
  canon_.set_position(at);
  if (new_tool && seek_->tool_by_number()) {
    canon_.change_tool_number(seek_->tool());
  } else if (new_tool) {
    if (p_.setup.tools.at_g30)
      canon_.set_g30(interp_.parameters().pose(interp::kG30Home, p_.setup.linear_unit_mm));
    canon_.select_tool(seek_->tool());
    canon_.change_tool();
    at = canon_.state().position;
    away = true;
  }
  canon_.restore(wanted);
  add(motion::ToolOffset{wanted.frame.tool()});
  if (wanted.tool_awaits_change && wanted.selected_tool >= 0)
    add_own(PrepareTool{wanted.selected_tool});
  for (const auto& [which, output] : seek_->outputs())
    if (output.value) add(motion::OutputChange{which.second, which.first, false, 0, *output.value});
  for (int n = 0; n < p_.setup.motion.spindles; ++n) {
    const auto direction = wanted.direction[static_cast<std::size_t>(n)];
    if (direction != 0)
      canon_.start_spindle(n, direction > 0 ? interp::SpindleDirection::clockwise
                                            : interp::SpindleDirection::counterclockwise);
    else if (status_.spindle[n].on)
      canon_.stop_spindle(n);
  }
  add_own(SetCoolant{modal.flood ? 1 : 0, modal.mist ? 1 : 0});
  if (away) {
    up();  // a tool change may have gone down
    rtapi::Pose over = wanted.position;
    if (retract >= 0) {
      const auto a = static_cast<std::size_t>(retract);
      over[a] = std::max(at[a], wanted.position[a]);
    }
    go(over, 0, MotionKind::traverse);
    const bool per_minute = wanted.feed_mode == interp::FeedMode::per_minute &&
                            wanted.linear_mm_min > 0 &&
                            modal.feed_mode == interp::ProgramFeedMode::per_minute;
    go(wanted.position, per_minute ? wanted.linear_mm_min / 60.0 : kDefaultPlungeSpeed,
       MotionKind::feed);
  }
  add(wanted.path);
  add(wanted.overrides);
  if (wanted.feed_mode == interp::FeedMode::per_revolution) add(canon_.feed_per_rev());
  if (seek_->end() == SeekEnd::hold) add_own(ProgramPause{false});
  for (const auto& [which, output] : seek_->outputs())
    if (output.pending)
      add(motion::OutputChange{which.second, which.first, true, 0, *output.pending});
  if (!seek_->log_file().empty()) add_own(LogText{LogText::Kind::append, seek_->log_file()});
  canon_.restore(wanted);

  announce_ = false;
  record.tag = canon_.tag();
  record.tool_awaited = new_tool;
  record.pending = static_cast<int>(list_.size());
  record.has_items = true;
  record.modal = modal;
  record.canon = wanted;
  history_.add(record);
  run_.sync_pending = true;  // the tool in the spindle is what the changer says
}

}  // namespace kerf::task
