#include "interp/core.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "interp/codes/families.hpp"
#include "interp/flow_internal.hpp"
#include "interp/script_self.hpp"

namespace kerf::interp {

Core::Core(Environment& environment, Canon& sink, const Settings& config, const Dialect& rows)
    : env(environment),
      canon(sink),
      settings(config),
      dialect(rows),
      compat(compat_row(config.compat)),
      scripts(config.scripts ? environment.scripts() : nullptr),
      parser_(rows, params, flows.labels) {
  for (const auto& family : dialect.families) {
    for (const CodeRow& r : family) {
      for (int code = r.code; code <= r.last; ++code) {
        if (r.letter == 'g')
          g_rows_[static_cast<std::size_t>(code)] = &r;
        else
          m_rows_[static_cast<std::size_t>(code)] = &r;
      }
    }
  }
  for (const LetterRow& r : dialect.letters)
    unused_[static_cast<std::size_t>(letter_index(r.letter))] = r.unused;
  add_remaps();
  flows.programs.emplace_back();
  flows.programs[0].source = make_text_source("");
}

const CodeRow* Core::row(char letter, int code) const {
  if (code < 0) return nullptr;
  const auto n = static_cast<std::size_t>(code);
  if (letter == 'g') return n < g_rows_.size() ? g_rows_[n] : nullptr;
  return n < m_rows_.size() ? m_rows_[n] : nullptr;
}

// --- errors ---

bool Core::set_error(std::size_t at, bool known, const char* help, const char* format,
                     std::va_list args) {
  char text[400];
  std::vsnprintf(text, sizeof text, format, args);
  error.text = text;
  error.help = help == nullptr ? "" : help;
  error.file = current_file();
  error.source = current != nullptr ? current->text : std::string_view();
  error.line = current != nullptr ? current->place.line + 1 : 0;
  error.column = known && current != nullptr ? parser_.column_of(current->text, at) : 0;
  error.call_level = flows.frames.empty() ? 0 : static_cast<std::int32_t>(flows.frames.size()) - 1;
  return false;
}

bool Core::fail(char letter, const char* help, const char* format, ...) {
  std::va_list args;
  va_start(args, format);
  const int i = letter == 0 ? -1 : letter_index(letter);
  const bool known = i >= 0 && (block_.mask >> i & 1U) != 0 && block_.source != nullptr;
  set_error(known ? block_.at[static_cast<std::size_t>(i)] : 0, known, help, format, args);
  va_end(args);
  return false;
}

bool Core::fail_at(std::size_t normalised, const char* help, const char* format, ...) {
  std::va_list args;
  va_start(args, format);
  set_error(normalised, true, help, format, args);
  va_end(args);
  return false;
}

std::string_view Core::current_file() const {
  if (flows.frames.empty()) return {};
  return flows.programs[flows.frames.back().program].path;
}

// --- life of a block ---

void Core::begin_block() {
  begin_flow();
  save_modes();
}

void Core::save_modes() {
  saved_ = state;
  saved_.line = line_before_;
  saved_tool_ = spindle_tool;
  modes_saved_ = true;
}

void Core::begin_flow() {
  line_before_ = state.line;
  modes_saved_ = false;
  block_program_ = flows.frames.empty() ? 0 : flows.frames.back().program;
  block_level_ = flows.frames.empty() ? 0 : static_cast<std::int32_t>(flows.frames.size()) - 1;
  out.clear();
  params.begin();
  tool_changes.clear();
  sync = SyncReason::none;
  ended = false;
  machine_place = false;
  block_.source = nullptr;
  compensation.undo();
}

void Core::undo_block() {
  if (modes_saved_) {
    state = saved_;
    spindle_tool = saved_tool_;
  }
  state.line = line_before_;
  out.clear();
  params.rollback();
  sync = SyncReason::none;
  ended = false;
  repeats.left = 0;
  compensation.undo();
}

Outcome Core::execute_next() {
  const Outcome o = attached_ ? execute_scripted() : execute_one();
  return o == Outcome::error && logs(LogLevel::errors) ? log_error() : o;
}

void Core::log(std::string_view what, std::int32_t line) {
  const std::string_view file = current_file();
  std::string text(file.empty() ? "MDI" : file);
  if (line > 0) text += ':' + std::to_string(line);
  env.log(text.append(": ").append(what));
}

Outcome Core::log_error() {
  env.log("error: " + error.message());
  return Outcome::error;
}

Outcome Core::execute_one() {
  if (repeats.left > 0) return next_repeat();
  if (flows.resume != nullptr) return resume_block();
  if (flows.skip.active) return continue_skip();
  if (flows.frames.empty()) return Outcome::idle;
  if (flows.profile != nullptr) return profile_step();
  if (flows.programs[flows.frames[0].program].stream != nullptr) forget_lines();
  ParsedBlock* b = nullptr;
  const LineRead r = read_block(b);
  if (r == LineRead::bad) return Outcome::error;
  if (r != LineRead::line) return read_problem(r);
  return execute_block(*b);
}

Outcome Core::read_problem(LineRead r) {
  current = nullptr;
  switch (r) {
    case LineRead::none_yet: return Outcome::needs_line;
    case LineRead::end: return end_of_file();
    case LineRead::too_long:
      fail(0,
           ("Split the line; " + std::to_string(dialect.longest_line) + " characters are possible")
               .c_str(),
           "Command too long");
      break;
    case LineRead::changed:
      fail(0, "Stop, check the file and start it again",
           "The program file was changed while it runs");
      break;
    default: fail(0, "", "Cannot read the program file"); break;
  }
  const Frame& f = flows.frames.back();
  error.line = f.place.line;
  return Outcome::error;
}

Outcome Core::end_of_file() {
  if (flows.frames.back().phase == ScriptPhase::execute) {
    leave_sub(false, 0);
    answer_ = {};
    return Outcome::ok;
  }
  if (flows.mdi && flows.frames.size() == 1) {
    drop_frames();
    return Outcome::idle;
  }
  const Frame& f = flows.frames.back();
  const std::int32_t lines = f.place.line;
  if (flows.frames.size() > 1) {
    const std::string help = "The sub " + flows.labels.text(f.sub) + " has no end in its file";
    fail(0, help.c_str(), "%s", kNoEnd);
  } else if (state.percent_file) {
    fail(0, "End the file with a line % or with M2", "File ended with no percent sign (%%)");
  } else {
    fail(0, "Add M2 as the last line", "%s", kNoEnd);
  }
  error.line = lines;
  drop_frames();
  return Outcome::error;
}

Outcome Core::execute_block(ParsedBlock& b) {
  // Without words nothing can touch the modes, and a copy of them would cost as much as the whole line.
  if (b.words.empty())
    begin_flow();
  else
    begin_block();
  current = &b;
  state.line = b.place.line + 1;
  if (block_level_ == 0) main_line_ = state.line;
  if (logs(LogLevel::blocks)) log(b.text, state.line);
  if (b.percent) {
    const bool first_line = flows.frames.size() == 1 && !flows.mdi && !state.percent_file &&
                            flows.loops.empty() && !flows.started;
    if (first_line) {
      state.percent_file = true;
      return Outcome::ok;
    }
    if (!state.percent_file || flows.mdi) {
      fail_at(0, "", "Bad character '%%' used");
      undo_block();
      return Outcome::error;
    }
    if (!compensation.end_program(false)) {
      undo_block();
      return Outcome::error;
    }
    out.call<&Canon::finish>();
    ended = true;
    return finish_block(b);
  }
  if (b.skip && block_delete) return Outcome::ok;
  if (!flows.mdi && (!b.words.empty() || !b.assignments.empty() || b.flow != Flow::none ||
                     b.comment != CommentKind::none))
    flows.started = true;
  if (b.flow != Flow::none) return run_flow(b);
  if (b.conditional) {
    ParsedBlock* const part = chosen_part(b);
    if (part == nullptr) return undo_block(), Outcome::error;
    return execute_block(*part);
  }
  if (!build(b, block_) || !store(b) || !run_comment(b) || !run_rows(block_) ||
      !compensation.has_room()) {
    undo_block();
    return Outcome::error;
  }
  return finish_block(b);
}

std::optional<Tool> Core::find_tool(int number) const {
  for (const Tool& t : changed_tools) {
    if (t.number == number) return t;
  }
  return env.find_tool(number);
}

namespace {
/// The digits behind the N of a line, as they are written.
std::string_view label_of(std::string_view line) {
  const std::size_t n = line.find_first_of("nN");
  if (n == std::string_view::npos) return {};
  std::size_t end = n + 1;
  while (end < line.size() && line[end] >= '0' && line[end] <= '9') ++end;
  return line.substr(n + 1, end - n - 1);
}
}  // namespace

Outcome Core::finish_block(const ParsedBlock& p) {
  for (const Tool& tool : tool_changes) {
    std::erase_if(changed_tools, [&](const Tool& t) { return t.number == tool.number; });
    changed_tools.push_back(tool);
  }
  const bool compensated = compensation.busy();
  if (!out.empty() || compensated) {
    SourceLine source;
    source.file_id = block_program_;
    source.line = p.place.line + 1;
    source.sequence = p.sequence;
    source.call_level = block_level_;
    source.main_line = main_line_;
    source.file = flows.programs[block_program_].path;
    source.text = p.text;
    if (p.sequence >= 0) source.label = label_of(p.text);
    if (repeats.left > 0) {
      repeats.source = source;
      repeats.file = source.file;
      repeats.text = source.text;
    }
    if (compensated)
      compensation.finish(source);
    else
      out.deliver(canon, source);
  }
  return block_done();
}

Outcome Core::block_done() {
  if (ended) {
    if (logs(LogLevel::calls)) log("program end", state.line);
    drop_frames();
    return Outcome::program_end;
  }
  return sync == SyncReason::none ? Outcome::ok : Outcome::needs_sync;
}

Outcome Core::next_repeat() {
  begin_block();
  current = nullptr;
  const Block& b = repeats.block;
  const CodeRow* r = row('g', repeats.code);
  bool ok = r != nullptr && r->run(*this, b, repeats.code);
  for (int i = 0; ok && repeats.left == 0 && i < b.row_count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    if (b.rows[n]->order > kOrderMotion) ok = b.rows[n]->run(*this, b, b.codes[n]);
  }
  if (!ok) {
    undo_block();
    error.file = repeats.file;
    error.source = repeats.text;
    error.line = repeats.source.line;
    return Outcome::error;
  }
  SourceLine source = repeats.source;
  source.file = repeats.file;
  source.text = repeats.text;
  if (source.sequence >= 0) source.label = label_of(repeats.text);
  out.deliver(canon, source);
  return block_done();
}

// --- execution ---

bool Core::run_rows(const Block& b) {
  Steps steps;  // NOLINT(*-member-init): filled below
  const auto add = [&](std::int16_t order, int code, const CodeRow* r) {
    int at = steps.count++;
    for (; at > 0 && steps.list[static_cast<std::size_t>(at - 1)].order > order; --at)
      steps.list[static_cast<std::size_t>(at)] = steps.list[static_cast<std::size_t>(at - 1)];
    steps.list[static_cast<std::size_t>(at)] = {order, static_cast<std::int16_t>(code), r};
  };
  if (b.has('f')) add(kOrderFeed, 'f', nullptr);
  if (b.has('s')) add(kOrderSpeed, 's', nullptr);
  if (b.has('t')) add(kOrderTool, 't', nullptr);
  for (int i = 0; i < b.row_count; ++i) {
    const CodeRow* r = b.rows[static_cast<std::size_t>(i)];
    if (r->run != nullptr) add(r->order, b.codes[static_cast<std::size_t>(i)], r);
  }
  if (b.motion != nullptr && b.motion_is_modal) add(kOrderMotion, b.motion_code, b.motion);
  return run_steps(b, steps, nullptr);
}

bool Core::run_steps(const Block& b, Steps& first, std::shared_ptr<RemapCall> call) {
  Steps* steps = call != nullptr ? &call->steps : &first;
  while (steps->next < steps->count) {
    const Step& s = steps->list[static_cast<std::size_t>(steps->next)];
    if (const Remap* r = remap_of(s); r != nullptr) {
      RemapCall* body = body_of(*r);
      if (body != nullptr && has_builtin(s)) {
        body->builtin_used = true;
      } else {
        if (call == nullptr) call = keep_block(b, *steps);
        steps = &call->steps;
        if (sync != SyncReason::none || repeats.left > 0) {
          flows.resume = std::move(call);  // what was asked before comes first
          return true;
        }
        const std::size_t level = flows.frames.size();
        if (!begin_remap(*r, call)) return false;
        if (flows.frames.size() > level) return true;
        continue;  // its body was a built-in function
      }
    }
    ++steps->next;
    if (state.cutter_comp != 400 && s.row != nullptr &&
        refused_by_compensation(*this, b, s.row->letter, s.code))
      return false;
    const bool ok = s.row != nullptr ? s.row->run(*this, b, s.code)
                    : s.code == 'f'  ? feed_word(b)
                    : s.code == 's'  ? speed_word(b)
                                     : tool_word(b);
    if (!ok) return false;
    if (repeats.left > 0) return true;  // the stop of this block comes behind the last repeat
  }
  return true;
}

bool Core::integer(const Block& b, char letter, int otherwise, int& value) {
  value = otherwise;
  if (!b.has(letter)) return true;
  double rounded = 0;
  if (!near_integer(b[letter], rounded) || std::fabs(rounded) > 1e9)
    return fail(letter, "", "Non integer value for integer");
  value = static_cast<int>(rounded);
  return true;
}

bool Core::feed_word(const Block& b) {
  const double f = b['f'];
  state.feed_word = f;
  if (state.feed_mode == ProgramFeedMode::inverse_time) {
    state.feed = f;  // becomes a feed per minute with each move
    return true;
  }
  state.feed = mm(f);
  out.call<&Canon::set_feed_rate>(state.feed, f);
  return true;
}

bool Core::speed_word(const Block& b) {
  const double s = b['s'];
  int spindle = 0;
  if (b.has('$') && !compat.spindle_word)
    return fail('$', "[RS274NGC]COMPAT = 2.7 knows one spindle", "Bad character '$' used");
  if (!integer(b, '$', 0, spindle)) return false;
  if (spindle < -1 || spindle >= settings.spindles)
    return fail('$', "[TRAJ]SPINDLES says how many spindles there are",
                "Invalid spindle ($) number in Spindle speed command");
  const int first = spindle < 0 ? 0 : spindle;
  const int last = spindle < 0 ? settings.spindles - 1 : spindle;
  for (int i = first; i <= last; ++i) {
    const auto n = static_cast<std::size_t>(i);
    state.speed_rpm[n] = s;
    announce_speed(*this, i);
  }
  state.speed_spindle = first;
  return true;
}

bool Core::tool_word(const Block& b) {
  int number = 0;
  if (!integer(b, 't', 0, number)) return false;
  if (number < 0) return fail('t', "", "Negative tool id (tool not found)");
  if (number == 0 && !settings.random_toolchanger) {
    state.selected_pocket = 0;
  } else {
    const auto tool = find_tool(number);
    if (!tool) {
      return fail('t', "Add the tool to the tool table, or choose another",
                  "Requested tool %d not found in the tool table", number);
    }
    state.selected_pocket = tool->pocket;
  }
  state.selected_tool = number;
  out.call<&Canon::select_tool>(number);
  return true;
}

// --- geometry shared by the families ---

bool Core::target(const Block& b, Pose& end) {
  end = state.position;
  const bool polar = b.has('@') || b.has('^');
  if (polar) {
    if (b.has('x') || b.has('y'))
      return fail(b.has('x') ? 'x' : 'y', "Use either",
                  "Cannot specify both polar coordinate and %c word", b.has('x') ? 'X' : 'Y');
    if (state.plane_code != 170)
      return fail(b.has('@') ? '@' : '^', "", "Cannot use polar coordinate except in G17 plane");
    double radius = std::hypot(state.position.x, state.position.y);
    // In radians all along, so that no rounding changes the last digit of LinuxCNC's figures.
    constexpr double kRadians = 3.14159265358979323846 / 180.0;
    double angle = std::atan2(state.position.y, state.position.x);
    if (state.distance == DistanceMode::incremental) {
      if (radius < 1e-9)
        return fail(
            b.has('@') ? '@' : '^', "",
            "Incremental motion with polar coordinates is indeterminate when at the origin");
      radius += b.has('@') ? mm(b['@']) : 0;
      angle += b.get('^', 0) * kRadians;
    } else {
      if (b.has('@')) radius = mm(b['@']);
      if (b.has('^')) angle = b['^'] * kRadians;
      if (!b.has('^') && radius != 0 && std::hypot(state.position.x, state.position.y) < 1e-9)
        return fail('@', "", "Must specify angle in polar coordinate if at the origin");
    }
    end.x = radius * std::cos(angle);
    end.y = radius * std::sin(angle);
  }
  if (b.g53) {
    if (state.cutter_comp != 400)
      return fail(0, "Write G40 before", "Cannot use g53 with cutter radius comp");
    if (state.distance == DistanceMode::incremental)
      return fail(0, "Write G90 before G53", "Cannot use g53 incremental");
    machine_place = true;
    // Axes that are not named stay; an offset rotation mixes X and Y, so go through machine coordinates.
    Pose machine = machine_position();
    for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
      if (b.has_axis(i)) machine[i] = axis_word(b, i);
    }
    end = state.frame.to_program(machine);
    return true;
  }
  for (std::size_t i = 0; i < rtapi::kAxes; ++i) {
    if (!b.has_axis(i)) continue;
    const double v = axis_word(b, i);
    end[i] = state.distance == DistanceMode::absolute ? v : end[i] + v;
  }
  return true;
}

void Core::set_frame(const CanonFrame& frame) {
  const Pose machine = machine_position();
  state.frame = frame;
  state.position = frame.to_program(machine);
}

void Core::replace_tool_offset(const Pose& offset) {
  const Pose before = state.frame.tool();
  const auto replace = [&](ModalState& modes) {
    if (modes.frame.tool() == before) modes.frame.use_tool_length_offset(offset);
  };
  for (auto& frame : flows.frames)
    if (frame.saved_state != nullptr) replace(*frame.saved_state);
  compensation.each_waiting(replace);
  replace(state);
}

// --- outside world ---

void Core::synchronize(const ExternalState& external) {
  params.begin();
  if (external.tool_in_spindle) {
    changed_tools.clear();
    const int number = *external.tool_in_spindle;
    const int pocket = external.pocket_in_spindle.value_or(spindle_tool.pocket);
    const auto tool =
        number > 0 || settings.random_toolchanger ? env.find_tool(number) : std::nullopt;
    spindle_tool = tool.value_or(Tool{});
    spindle_tool.number = number;
    spindle_tool.pocket = external.pocket_in_spindle ? pocket : tool ? tool->pocket : 0;
  }
  if (external.probe) {
    const Pose p = state.frame.to_program(external.probe->machine_position);
    params.set_pose(kProbe, p, state.unit_mm());
    params.set(kProbeSuccess, external.probe->tripped ? 1 : 0);
  }
  if (external.machine_position) {
    state.position = state.frame.to_program(*external.machine_position);
    compensation.start_again();
  }
  if (external.input_value) params.set(kInputValue, *external.input_value);
  if (external.toolchanger_fault) {
    params.set(kChangerFault, *external.toolchanger_fault != 0 ? 1 : 0);
    params.set(kChangerReason, *external.toolchanger_fault);
  }
  params.begin();
  sync = SyncReason::none;
}

void Core::abort() {
  repeats.left = 0;
  compensation.drop();
  state.cutter_comp = 400;
  flows.skip.active = false;
  drop_frames();
  if (LineStream* const s = stream(); s != nullptr && !flows.mdi) {
    Frame& f = flows.frames[0];
    f.go_to({s->end_offset(), f.place.line + s->drop_from(f.place.offset)});
  }
  store().drop_nurbs();
  state.percent_file = false;
}

void Core::restore(const ModalState& before) {
  store().restore(before);
  compensation.drop();
}

void Core::init() {
  repeats.left = 0;
  sticky_words.clear();
  flows.skip = {};
  flows.subs.clear();
  drop_frames();
  const Units machine_units = settings.machine_unit_mm == 25.4 ? Units::inch : Units::mm;
  compensation.drop();
  const Pose machine = machine_position();
  state = ModalState{};
  state.units = settings.start_units.value_or(machine_units);
  params.begin();
  int system = static_cast<int>(params.get(kCoordSystem));
  if (system < 1 || system > 9) system = 1;
  state.coord_system = system;
  const int base = kG5xOffset + 20 * (system - 1);
  CanonFrame f;
  f.set_g5x_offset(params.pose(base, settings.machine_unit_mm));
  f.set_xy_rotation(params.get(base + 9));
  if (params.get(kG92Applied) != 0) {
    if (settings.disable_g92_persistence) {
      params.set(kG92Applied, 0);
      for (int i = 0; i < 9; ++i) params.set(kG92Offset + i, 0);
    } else {
      f.set_g92_offset(params.pose(kG92Offset, settings.machine_unit_mm));
      state.g92_applied = true;
    }
  }
  state.frame = f;
  state.position = f.to_program(machine);
  out.clear();
  out.call<&Canon::use_length_units>(state.units);
  out.call<&Canon::set_g5x_offset>(system, f.g5x());
  out.call<&Canon::set_g92_offset>(f.g92());
  out.call<&Canon::set_xy_rotation>(f.rotation_deg());
  out.call<&Canon::set_feed_reference>();
  out.deliver(canon, {});
  if (scripts == nullptr || attached_) return;
  if (self_ == nullptr) self_ = std::make_unique<CoreSelf>(*this);
  script_problem_ = scripts->attach(*self_);
  attached_ = script_problem_.empty();
  if (!attached_) env.warning(script_problem_);
  out.deliver(canon, {});
}

}  // namespace kerf::interp
