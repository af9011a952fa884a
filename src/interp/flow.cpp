// Program flow: reading lines through the cache, O-words, sub calls. Manual: "O Codes".
//
// Nothing here loops over the program: a search for a label takes a bounded number of lines per execute_next().
#include <algorithm>
#include <cmath>

#include "interp/core.hpp"

namespace kerf::interp {

namespace {

/// Lines looked at per execute_next() while searching a label.
constexpr int kSkipLines = 2000;
/// Lines of a sub's own file that may precede its definition.
constexpr int kLongestSubFile = 200000;

constexpr FlowMask kEndIf = flow_bit(Flow::endif);
constexpr FlowMask kNextBranch = flow_bit(Flow::elseif) | flow_bit(Flow::else_block) | kEndIf;

const char* keyword(Flow f) {
  constexpr const char* kNames[] = {"",       "sub",       "endsub", "call",    "return",   "if",
                                    "elseif", "else",      "endif",  "while",   "endwhile", "do",
                                    "repeat", "endrepeat", "break",  "continue"};
  return kNames[static_cast<std::size_t>(f)];
}

FlowMask loop_end(Flow kind) {
  return flow_bit(kind == Flow::repeat_loop ? Flow::endrepeat
                  : kind == Flow::do_loop   ? Flow::while_loop
                                            : Flow::endwhile);
}

Loop* find_loop(Frame& f, const std::string& label) {
  for (std::size_t i = f.loops.size(); i-- > 0;) {
    if (f.loops[i].label == label) return &f.loops[i];
  }
  return nullptr;
}

/// Leaves `label`'s loop and those inside it; with `keep` only those inside.
void close_loops(Frame& f, const std::string& label, bool keep) {
  if (find_loop(f, label) == nullptr) return;
  while (!f.loops.empty()) {
    const bool hit = f.loops.back().label == label;
    if (hit && keep) return;
    f.loops.pop_back();
    if (hit) return;
  }
}

}  // namespace

// --- files ---

std::uint32_t Core::add_program(std::string path, std::unique_ptr<LineSource> source) {
  for (std::size_t i = 1; i < flows.programs.size(); ++i) {
    Program& p = flows.programs[i];
    if (p.path != path) continue;
    const auto uses = [i](const Frame& f) { return f.program == i; };
    if (std::none_of(flows.frames.begin(), flows.frames.end(), uses) &&
        std::none_of(flows.parked.begin(), flows.parked.end(), uses)) {
      p.source = std::move(source);
      p.cache.clear();
      flows.last_cached = nullptr;
    }
    return static_cast<std::uint32_t>(i);
  }
  flows.programs.push_back({std::move(path), std::move(source), {}});
  return static_cast<std::uint32_t>(flows.programs.size() - 1);
}

LineRead Core::read_block(ParsedBlock*& b) {
  Frame& f = flows.frames.back();
  if (f.upcoming != nullptr) {
    b = f.upcoming;
    f.place = b->after;
    f.upcoming = b->next;
    return LineRead::line;
  }
  Program& program = flows.programs[f.program];
  const bool keep =
      (!f.loops.empty() || flows.frames.size() > 1) && program.cache.size() < kMostCached;
  if (!program.cache.empty()) {
    if (const auto hit = program.cache.find(f.place.offset); hit != program.cache.end()) {
      b = hit->second.get();
      f.place = b->after;
      f.upcoming = b->next;
      return LineRead::line;
    }
  }
  std::string_view line;
  std::uint64_t next = 0;
  const LineRead r = program.source->read(f.place.offset, line, next);
  if (r == LineRead::end) return r;
  const Place here = f.place;
  if (r == LineRead::changed || r == LineRead::failed) return r;
  f.place = {next, here.line + 1};
  if (r != LineRead::line) return r;
  std::unique_ptr<ParsedBlock> fresh;
  if (keep) fresh = std::make_unique<ParsedBlock>();
  ParsedBlock& parsed = keep ? *fresh : scratch_;
  bool good = parser_.parse(line, parsed);
  if (!good && parsed.skip && block_delete) {  // nobody reads a deleted block
    parsed.clear();
    good = true;
  }
  parsed.text.assign(line);
  parsed.place = here;
  parsed.after = f.place;
  b = &parsed;
  if (!good) {
    begin_block();
    if (keep) scratch_.text.assign(line), scratch_.place = here, b = &scratch_;
    current = b;
    fail_at(parser_.error_at(), "", "%s", parser_.error());
    return LineRead::bad;
  }
  if (keep) {
    ParsedBlock* before = flows.last_cached;
    b = program.cache.emplace(here.offset, std::move(fresh)).first->second.get();
    if (before != nullptr && flows.last_cached_program == f.program &&
        before->after.offset == here.offset)
      before->next = b;
    flows.last_cached = b;
    flows.last_cached_program = f.program;
  }
  return LineRead::line;
}

Program* Core::open_program(const std::string& path) {
  auto source = open_file_source(path);
  if (!source) return nullptr;
  flows.last_cached = nullptr;
  return &flows.programs[add_program(path, std::move(*source))];
}

void Core::close_main() {
  repeats.left = 0;
  drop_frames();  // an MDI line in progress
  drop_frames();
  flows.frames.clear();
  flows.subs.clear();
}

void Core::open_main(const std::string& path, std::unique_ptr<LineSource> source) {
  close_main();
  Frame f;
  f.program = add_program(path, std::move(source));
  flows.frames.push_back(std::move(f));
}

Outcome Core::execute_mdi(std::string_view text) {
  repeats.left = 0;
  if (flows.mdi) drop_frames();
  // Files of subs may have been edited since the last MDI line; the open program's own subs stay.
  const std::uint32_t main = flows.frames.empty() ? 0 : flows.frames[0].program;
  for (auto i = flows.subs.begin(); i != flows.subs.end();)
    i = i->second.program == main && main != 0 ? std::next(i) : flows.subs.erase(i);
  flows.programs[0].source = make_text_source(std::string(text));
  flows.programs[0].cache.clear();
  flows.last_cached = nullptr;
  flows.parked = std::move(flows.frames);
  flows.parked_resume = std::move(flows.resume);
  flows.frames.clear();
  flows.frames.emplace_back();
  flows.mdi = true;
  const Outcome o = execute_next();
  if (o == Outcome::idle) return Outcome::ok;  // an empty line
  if (o == Outcome::error) drop_frames();
  return o;
}

// --- frames ---

void Core::drop_frames() {
  while (flows.frames.size() > 1) leave_sub(false, 0);
  flows.skip.active = false;
  flows.resume.reset();
  if (flows.mdi) {
    flows.frames = std::move(flows.parked);
    flows.resume = std::move(flows.parked_resume);
    flows.parked.clear();
    flows.mdi = false;
    return;
  }
  if (!flows.frames.empty()) {
    Frame& main = flows.frames[0];
    main.place = {};
    main.upcoming = nullptr;
    main.loops.clear();
  }
  flows.started = false;
  state.percent_file = false;
}

bool Core::enter_sub(const FileAndPlace& where) {
  if (flows.frames.size() > kMostLevels)
    return fail(0, "A sub that calls itself needs a way out", "Too many subroutine levels");
  Frame f;
  f.program = where.program;
  f.place = where.place;
  f.sub = flows.skip.label;
  for (int i = 0; i < kSubArguments; ++i) {
    f.saved[static_cast<std::size_t>(i)] = params.get(i + 1);
    params.set(i + 1, flows.skip.arguments[static_cast<std::size_t>(i)]);
  }
  params.push_scope();
  sub_value = 0;
  sub_value_returned = false;
  flows.frames.push_back(std::move(f));
  return true;
}

void Core::leave_sub(bool has_value, double value) {
  const Frame& f = flows.frames.back();
  for (int i = 0; i < kSubArguments; ++i) params.set(i + 1, f.saved[static_cast<std::size_t>(i)]);
  params.pop_scope();
  sub_value = has_value ? value : 0;
  sub_value_returned = has_value;
  flows.frames.pop_back();
  params.begin();
}

bool Core::return_from_sub(bool has_value, double value) {
  const Frame& f = flows.frames.back();
  const std::optional<ModalState> was = f.restore_on_return ? f.saved_state : std::nullopt;
  const int tool_then = f.saved_tool;
  const std::shared_ptr<RemapCall> remapped = f.remap;
  sub_value = has_value ? value : 0;
  sub_value_returned = has_value;
  if (remapped != nullptr && !end_remap(f)) {
    leave_sub(has_value, value);
    return false;
  }
  leave_sub(has_value, value);
  if (remapped != nullptr && remapped->steps.next < remapped->steps.count) flows.resume = remapped;
  return !was || restore_modes(*this, *was, tool_then);
}

// --- searching ---

void Core::start_skip(ParsedBlock& b, const std::string& label, FlowMask stop_at) {
  Frame& f = flows.frames.back();
  f.upcoming = nullptr;
  if (b.jump_known) {
    f.place = b.jump;
    return;
  }
  Skip& s = flows.skip;
  s.active = true;
  s.label = label;
  s.stop_at = stop_at;
  s.from = b.place;
  s.origin = &b == &scratch_ || &b == &skip_scratch_ || b.label_expr.count > 0 ? nullptr : &b;
  s.to_sub = s.wrapped = false;
}

Outcome Core::skip_failed() {
  Skip& s = flows.skip;
  s.active = false;
  char line[32];
  std::snprintf(line, sizeof line, "%d", s.from.line + 1);
  const bool numbered = !s.label.empty() && s.label[0] != '<';
  current = nullptr;
  fail(0,
       s.to_sub ? "Define the sub before the call, or in a file of its name in the search path"
                : "Add the missing end of the O-word",
       "EOF in file:%s seeking o-word: o%s%s%s from line: %s", std::string(current_file()).c_str(),
       numbered ? "<" : "", s.label.c_str(), numbered ? ">" : "", line);
  error.line = s.from.line + 1;
  drop_frames();
  return Outcome::error;
}

Outcome Core::continue_skip() {
  Skip& s = flows.skip;
  Frame& f = flows.frames.back();
  Program& program = flows.programs[f.program];
  for (int i = 0; i < kSkipLines; ++i) {
    std::string_view line;
    std::uint64_t next = 0;
    const LineRead r = program.source->read(f.place.offset, line, next);
    if (r == LineRead::end) {
      if (!s.to_sub || s.wrapped) return skip_failed();
      s.wrapped = true;
      f.place = {};
      continue;
    }
    if (r != LineRead::line) {
      s.active = false;
      return read_problem(r);
    }
    const Place here = f.place;
    f.place = {next, here.line + 1};
    ParsedBlock& b = skip_scratch_;
    if (!parser_.peek_flow(line, b) || (flow_bit(b.flow) & s.stop_at) == 0 || b.label != s.label)
      continue;
    b.text.assign(line);
    b.place = here;
    b.after = f.place;
    // A landing that computes something is searched again each time; the others become a jump.
    if (s.origin != nullptr && b.flow != Flow::elseif && b.flow != Flow::while_loop) {
      s.origin->jump = b.after;
      s.origin->jump_known = true;
    }
    return land(b);
  }
  return Outcome::ok;
}

// The line that was looked for is reached.
Outcome Core::land(ParsedBlock& b) {
  Skip& s = flows.skip;
  s.active = false;
  Frame& f = flows.frames.back();
  begin_block();
  current = &b;
  state.line = b.place.line + 1;
  if (s.to_sub) {
    const FileAndPlace where{f.program, b.after};
    flows.subs[s.label] = where;
    f.place = s.return_place;
    f.upcoming = nullptr;
    if (enter_sub(where)) return Outcome::ok;
    undo_block();
    return Outcome::error;
  }
  // An elseif or the while of a do is computed; every other landing just goes on behind the line.
  if (b.flow == Flow::elseif) {
    double condition = 0;
    if (!evaluate(b, b.arguments[0], condition)) return undo_block(), Outcome::error;
    if (condition == 0) start_skip(b, std::string(b.label), kNextBranch);
    return Outcome::ok;
  }
  if (b.flow == Flow::while_loop && find_loop(f, b.label) != nullptr) return run_flow(b);
  return Outcome::ok;
}

// --- O-words ---

bool Core::flow_label(ParsedBlock& b, std::string& label) {
  if (b.label_expr.count == 0) {
    label = b.label;
    return true;
  }
  double v = 0;
  if (!evaluate(b, b.label_expr, v)) return false;
  if (v < 0 || std::fabs(v - std::nearbyint(v)) > kTolerance || v > 1e9)
    return fail_at(1, "", "Bad format unsigned integer");
  label = std::to_string(static_cast<long>(std::nearbyint(v)));
  return true;
}

Outcome Core::run_flow(ParsedBlock& b) {
  std::string& label = flow_label_;
  double condition = 0;
  const bool good = flow_label(b, label) && (b.flow == Flow::call || b.arguments.empty() ||
                                             evaluate(b, b.arguments[0], condition));
  if (!good || !run_comment(b) || !flow_step(b, label, condition)) {
    undo_block();
    return Outcome::error;
  }
  return finish_block(b);
}

bool Core::undefined_label(const ParsedBlock& b, const std::string& label) {
  return fail(0, "The beginning with the same label is missing, or a jump led into the block",
              "%d: undefined O-word label: 'o%s %s'", b.place.line + 1, label.c_str(),
              keyword(b.flow));
}

bool Core::flow_step(ParsedBlock& b, const std::string& label, double condition) {
  Frame& f = flows.frames.back();
  switch (b.flow) {
    case Flow::sub: return define_sub(b, label);
    case Flow::endsub:
    case Flow::ret:
      if (f.sub.empty())
        return fail(0, "return and endsub stand inside a sub",
                    "%d: not in a subroutine definition: 'o%s %s'", b.place.line + 1, label.c_str(),
                    keyword(b.flow));
      return return_from_sub(!b.arguments.empty(), condition);
    case Flow::call: return call_sub(b, label);
    case Flow::if_block:
      if (condition == 0) start_skip(b, label, kNextBranch);
      return true;
    case Flow::elseif:
    case Flow::else_block: start_skip(b, label, kEndIf); return true;
    case Flow::endif: return true;
    case Flow::do_loop:
      close_loops(f, label, false);
      f.loops.push_back({label, Flow::do_loop, b.place, b.after, 0});
      return true;
    case Flow::while_loop: return run_while(b, label, condition != 0);
    case Flow::repeat_loop: {
      close_loops(f, label, false);
      const double n = std::floor(condition + kTolerance);
      if (n < 1)
        start_skip(b, label, loop_end(Flow::repeat_loop));
      else
        f.loops.push_back({label, Flow::repeat_loop, b.place, b.after,
                           static_cast<std::int64_t>(std::min(n, 9e15))});
      return true;
    }
    default: return loop_end_step(b, label);
  }
}

bool Core::run_while(ParsedBlock& b, const std::string& label, bool condition) {
  Frame& f = flows.frames.back();
  Loop* loop = find_loop(f, label);
  if (loop != nullptr && loop->kind == Flow::do_loop) {
    if (condition) {
      f.place = loop->body;
      f.upcoming = nullptr;
      close_loops(f, label, true);
    } else {
      close_loops(f, label, false);
    }
    return true;
  }
  if (!condition) {
    if (loop != nullptr) close_loops(f, label, false);
    start_skip(b, label, loop_end(Flow::while_loop));
    return true;
  }
  if (loop != nullptr)
    close_loops(f, label, true);
  else
    f.loops.push_back({label, Flow::while_loop, b.place, b.after, 0});
  return true;
}

bool Core::loop_end_step(ParsedBlock& b, const std::string& label) {
  Frame& f = flows.frames.back();
  Loop* loop = find_loop(f, label);
  const bool matches =
      loop != nullptr && (b.flow == Flow::break_loop || b.flow == Flow::continue_loop ||
                          loop_end(loop->kind) == flow_bit(b.flow));
  if (!matches) return undefined_label(b, label);
  close_loops(f, label, true);
  loop = &f.loops.back();
  if (b.flow == Flow::break_loop ||
      (b.flow == Flow::continue_loop && loop->kind == Flow::do_loop)) {
    const FlowMask end = loop_end(loop->kind);
    if (b.flow == Flow::break_loop) f.loops.pop_back();
    start_skip(b, label, end);
    return true;
  }
  if (loop->kind == Flow::repeat_loop) {
    if (--loop->left > 0) {
      f.place = loop->body;
      f.upcoming = nullptr;
    } else {
      f.loops.pop_back();
      if (b.flow == Flow::continue_loop) start_skip(b, label, loop_end(Flow::repeat_loop));
    }
    return true;
  }
  f.place = loop->start;
  f.upcoming = nullptr;
  return true;
}

bool Core::define_sub(ParsedBlock& b, const std::string& label) {
  Frame& f = flows.frames.back();
  if (!f.sub.empty())
    return fail(0, "End the sub before the next one begins",
                "%d: nested subroutine definition: 'o%s sub'", b.place.line + 1, label.c_str());
  flows.subs[label] = {f.program, b.after};
  start_skip(b, label, flow_bit(Flow::endsub));
  return true;
}

bool Core::call_sub(ParsedBlock& b, const std::string& label) {
  Skip& s = flows.skip;
  s.arguments.fill(0);
  for (std::size_t i = 0; i < b.arguments.size(); ++i) {
    if (!evaluate(b, b.arguments[i], s.arguments[i])) return false;
  }
  s.label = label;
  if (const auto hit = flows.subs.find(label); hit != flows.subs.end())
    return enter_sub(hit->second);
  if (flows.frames.size() > kMostLevels) return enter_sub({});
  const bool named = label[0] == '<';
  const std::string name = named ? label.substr(1, label.size() - 2) : label;
  const std::string path = env.find_sub(name);
  Frame& f = flows.frames.back();
  s.from = b.place;
  s.origin = nullptr;
  s.to_sub = true;
  s.stop_at = flow_bit(Flow::sub);
  if (!path.empty()) {
    const Program* program = open_program(path);
    if (program == nullptr)
      return fail(0, "Check that the file can be read", "Unable to open file <%s>", path.c_str());
    // Look for the definition from the top of that file; the frame is the sub's own until then.
    const auto id = static_cast<std::uint32_t>(program - flows.programs.data());
    return enter_file_sub(id);
  }
  s.return_place = f.place;
  s.wrapped = false;
  s.active = true;
  f.upcoming = nullptr;
  return true;
}

// Reads a sub's file for its definition. The file is one of its own, so no program line runs before the sub is found.
bool Core::enter_file_sub(std::uint32_t program) {
  Place place;
  std::string_view line;
  std::uint64_t next = 0;
  const std::string label = flows.skip.label;
  while (place.line < kLongestSubFile &&
         flows.programs[program].source->read(place.offset, line, next) == LineRead::line) {
    place = {next, place.line + 1};
    ParsedBlock& b = skip_scratch_;
    if (!parser_.peek_flow(line, b) || b.flow != Flow::sub) continue;
    flows.subs.insert_or_assign(b.label, FileAndPlace{program, place});
    if (b.label == label) return enter_sub({program, place});
  }
  const bool numbered = label[0] != '<';
  return fail(0, "The file must define the sub of its name",
              "EOF in file:%s seeking o-word: o%s%s%s from line: %d",
              flows.programs[program].path.c_str(), numbered ? "<" : "", label.c_str(),
              numbered ? ">" : "", flows.skip.from.line + 1);
}

}  // namespace kerf::interp
