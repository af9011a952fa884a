// Program flow: reading lines through the cache, frames, searching for labels. What the O-words do: flow_words.cpp.
//
// Nothing here loops over the program: a search for a label takes a bounded number of lines per execute_next().
#include <algorithm>
#include <cmath>
#include <string>

#include "interp/core.hpp"
#include "interp/flow_internal.hpp"

namespace kerf::interp {

namespace {

/// Where to go on in a block that a search may remember; null when it may not.
Jump* memory_of(const ParsedBlock& b, Jump& jump) {
  return b.cached && b.label_expr.count == 0 ? &jump : nullptr;
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
      p.labels.clear();
      p.stream = nullptr;
      p.goes_back = false;
      forget_blocks(static_cast<std::uint32_t>(i));
    }
    return static_cast<std::uint32_t>(i);
  }
  flows.programs.push_back({std::move(path), std::move(source), nullptr, {}, nullptr, false});
  return static_cast<std::uint32_t>(flows.programs.size() - 1);
}

void Core::forget_blocks(std::uint32_t program) {
  Program& p = flows.programs[program];
  if (p.cache == nullptr) return;
  cached_bytes_ -= p.cache->bytes();
  p.cache->clear();
  for (auto& [label, sub] : flows.subs) {
    if (sub.where.program == program) sub.body = nullptr;
  }
}

ParsedBlock* Core::cache_block(const ParsedBlock& b) {
  if (cached_bytes_ >= kMostCachedBytes) return nullptr;
  auto& cache = flows.programs[b.program].cache;
  if (cache == nullptr) cache = std::make_unique<BlockCache>();
  const std::size_t before = cache->bytes();
  ParsedBlock* const kept = cache->keep(b);
  cached_bytes_ += cache->bytes() - before;
  return kept;
}

LineRead Core::read_block(ParsedBlock*& b) {
  Frame& f = flows.frames.back();
  if (f.upcoming != nullptr) {
    b = f.upcoming;
    f.go_behind(*b);
    return LineRead::line;
  }
  const Program& program = flows.programs[f.program];
  if (program.cache != nullptr) {
    if (ParsedBlock* const hit = program.cache->find(f.place.offset); hit != nullptr) {
      b = hit;
      if (f.link != nullptr) *f.link = hit;
      f.go_behind(*hit);
      return LineRead::line;
    }
  }
  const LineRead r = parse_line(f.program, f.place, scratch_);
  if (r != LineRead::line && r != LineRead::bad) {
    if (r == LineRead::too_long) f.go_to(scratch_.after);
    return r;
  }
  b = &scratch_;
  // Lines of loops and subs run again.
  const bool again =
      flows.frames.size() > 1 || flows.loops.size() > f.first_loop || program.goes_back;
  if (r == LineRead::line && again) {
    if (ParsedBlock* const kept = cache_block(scratch_); kept != nullptr) {
      b = kept;
      if (f.link != nullptr) *f.link = kept;
    }
  }
  f.go_behind(*b);
  if (r == LineRead::bad) {
    begin_block();
    current = b;
    fail_at(parser_.error_at(), "", "%s", parser_.error());
  }
  return r;
}

// Reads and parses the line at `place`; `bad` when it cannot be parsed.
LineRead Core::parse_line(std::uint32_t program, const Place& place, ParsedBlock& b) {
  std::string_view line;
  std::uint64_t next = 0;
  const LineRead r = flows.programs[program].source->read(place.offset, line, next);
  b.after = {next, place.line + 1};
  if (r != LineRead::line) return r;
  bool good = parser_.parse(line, b);
  if (!good && b.skip && block_delete) {  // nobody reads a deleted block
    b = {};
    b.skip = good = true;
  }
  b.text = line;
  b.program = program;
  b.place = place;
  b.after = {next, place.line + 1};
  return good ? LineRead::line : LineRead::bad;
}

Program* Core::open_program(const std::string& path) {
  auto source = open_file_source(path, dialect.longest_line);
  if (!source) return nullptr;
  return &flows.programs[add_program(path, std::move(*source))];
}

void Core::close_main() {
  repeats.left = 0;
  drop_frames();  // an MDI line in progress
  drop_frames();
  flows.frames.clear();
  flows.loops.clear();
  flows.subs.clear();
  flows.labels = {};
  // Paths stay, since calls that are still queued name them; open files and parsed lines do not.
  for (std::uint32_t i = 1; i < flows.programs.size(); ++i) {
    forget_blocks(i);
    flows.programs[i].source = nullptr;
    flows.programs[i].stream = nullptr;
    flows.programs[i].cache = nullptr;
    flows.programs[i].labels.clear();
  }
}

void Core::open_main(const std::string& path, std::unique_ptr<LineSource> source) {
  close_main();
  Frame f;
  f.program = add_program(path, std::move(source));
  flows.frames.push_back(std::move(f));
  if (logs(LogLevel::calls)) log("program begins");
}

void Core::open_stream(const std::string& name) {
  auto source = std::make_unique<LineStream>(dialect.longest_line);
  LineStream* const stream = source.get();
  open_main(name, std::move(source));
  flows.programs[flows.frames[0].program].stream = stream;
}

LineStream* Core::stream() const {
  const Frame* main = !flows.parked.empty()                 ? &flows.parked[0]
                      : !flows.mdi && !flows.frames.empty() ? &flows.frames[0]
                                                            : nullptr;
  return main == nullptr ? nullptr : flows.programs[main->program].stream;
}

// Lines of a stream that no loop and no sub needs again go, and so do their parsed copies.
void Core::forget_lines() {
  Frame& f = flows.frames[0];
  Program& p = flows.programs[f.program];
  if (flows.frames.size() > 1 || flows.mdi || !flows.loops.empty()) return;
  p.stream->forget_before(f.place.offset);
  constexpr std::size_t kMany = std::size_t{1} * 1024 * 1024;
  if (p.cache == nullptr || p.cache->bytes() < kMany) return;
  forget_blocks(f.program);
  f.go_to(f.place);
}

Outcome Core::execute_mdi(std::string_view text) {
  repeats.left = 0;
  if (flows.mdi) drop_frames();
  // Files of subs may have been edited since the last MDI line; the open program's own subs stay.
  const std::uint32_t main = flows.frames.empty() ? 0 : flows.frames[0].program;
  for (auto i = flows.subs.begin(); i != flows.subs.end();)
    i = i->second.where.program == main && main != 0 ? std::next(i) : flows.subs.erase(i);
  flows.programs[0].source = make_text_source(std::string(text), dialect.longest_line);
  forget_blocks(0);
  flows.programs[0].labels.clear();
  for (Frame& f : flows.frames) f.link = nullptr;  // it may have been one of those subs
  flows.parked = std::move(flows.frames);
  flows.parked_resume = std::move(flows.resume);
  flows.parked_profile = std::move(flows.profile);
  flows.frames.clear();
  flows.frames.emplace_back().first_loop = flows.loops.size();
  flows.mdi = true;
  if (logs(LogLevel::calls)) log(text);
  const Outcome o = execute_next();
  if (o == Outcome::idle) return Outcome::ok;  // an empty line
  if (o == Outcome::error) drop_frames();
  return o;
}

// --- frames ---

void Core::drop_frames() {
  bool functions = false;
  for (const Frame& f : flows.frames) functions = functions || f.started;
  if (functions) scripts->abandon();
  while (flows.frames.size() > 1) leave_sub(false, 0);
  flows.skip.active = false;
  flows.resume.reset();
  if (!flows.frames.empty()) flows.loops.resize(flows.frames[0].first_loop);
  flows.profile.reset();
  if (flows.mdi) {
    flows.frames = std::move(flows.parked);
    flows.resume = std::move(flows.parked_resume);
    flows.profile = std::move(flows.parked_profile);
    flows.parked.clear();
    flows.mdi = false;
    return;
  }
  // A stream goes on where it is; a file begins anew.
  if (!flows.frames.empty()) flows.frames[0].go_to(stream() ? flows.frames[0].place : Place{});
  flows.started = false;
  state.percent_file = false;
}

bool Core::enter_sub(const Sub& sub, ParsedBlock** link) {
  if (flows.frames.size() > static_cast<std::size_t>(dialect.call_levels))
    return fail(0, "A sub that calls itself needs a way out", "Too many subroutine levels");
  if (logs(LogLevel::calls)) log("call of o" + flows.labels.text(flows.skip.label), state.line);
  Frame& f = flows.frames.emplace_back();
  f.program = sub.where.program;
  f.place = sub.where.place;
  f.upcoming = sub.body;
  f.link = sub.body == nullptr ? link : nullptr;
  f.sub = flows.skip.label;
  f.first_loop = flows.loops.size();
  f.start = sub.where.place;
  f.numbered = flows.skip.numbered;
  f.times = flows.skip.times;
  params.begin();
  if (!f.numbered) f.saved = params.exchange_arguments(flows.skip.arguments);
  params.push_scope();
  if (settings.oword_nargs && !f.numbered)
    params.set_named(params.intern("n_args"),
                     {static_cast<double>(flows.skip.argument_count), nullptr});
  if (!f.numbered) sub_value = 0, sub_value_returned = false;
  return true;
}

void Core::leave_sub(bool has_value, double value) {
  const Frame& f = flows.frames.back();
  if (f.phase == ScriptPhase::execute) {  // it has no arguments and no names of its own
    flows.loops.resize(f.first_loop);
    flows.frames.pop_back();
    return;
  }
  if (!f.numbered) params.exchange_arguments(f.saved);
  params.begin();
  params.pop_scope();
  sub_value = has_value ? value : 0;
  sub_value_returned = has_value;
  flows.loops.resize(f.first_loop);
  flows.frames.pop_back();
}

bool Core::return_from_sub(bool has_value, double value) {
  sub_value = has_value ? value : 0;
  sub_value_returned = has_value;
  Frame& f = flows.frames.back();
  if (f.remap != nullptr) {
    save_modes();
    if (!end_remap(f)) {
      leave_sub(has_value, value);
      return false;
    }
    if (f.phase == ScriptPhase::epilog) return true;  // a function, which comes first
  }
  return finish_return(has_value, value);
}

bool Core::finish_return(bool has_value, double value) {
  Frame& f = flows.frames.back();
  const std::unique_ptr<ModalState> was = f.restore_on_return ? std::move(f.saved_state) : nullptr;
  const int tool_then = f.saved_tool;
  const std::shared_ptr<RemapCall> remapped = f.remap;
  if (was != nullptr) save_modes();
  leave_sub(has_value, value);
  if (remapped != nullptr && remapped->steps.next < remapped->steps.count) flows.resume = remapped;
  return was == nullptr || restore_modes(*this, *was, tool_then);
}

// --- searching ---

void Core::start_skip(ParsedBlock& b, Label label, FlowMask stop_at) {
  search(b, b.jump, label, stop_at);
}

void Core::search(ParsedBlock& b, Jump& jump, Label label, FlowMask stop_at) {
  Frame& f = flows.frames.back();
  Skip& s = flows.skip;
  s.landing = jump.landing;
  if (jump.known) {
    flows.loops.resize(flows.loops.size() - jump.leaves);
    f.go_to(jump.to, b, jump);
    return;
  }
  s.active = true;
  s.depth = 0;
  s.open = flows.loops.size();
  s.label = label;
  s.stop_at = stop_at;
  s.from = b.place;
  s.program = f.program;
  s.place = f.place;
  s.origin = memory_of(b, jump);
  s.to_sub = s.sub_file = s.wrapped = false;
}

Outcome Core::skip_failed() {
  Skip& s = flows.skip;
  s.active = false;
  current = nullptr;
  if (s.to_sub) {
    not_found(s.sub_file ? "The file must define the sub of its name"
              : s.numbered
                  ? "A numbered program (O with the number) stands behind the M98 that calls it"
                  : "Define the sub, or put it into a file of its name in the search path",
              flows.programs[s.program].path);
  } else if (s.label == Label::nested) {
    fail(0, "The end of the statement in this line is missing", "%s", kNoEnd);
  } else {
    const std::string help = "The end of the O-word in line " + std::to_string(s.from.line + 1) +
                             " is missing: label " + flows.labels.text(s.label);
    fail(0, help.c_str(), "%s", kNoEnd);
  }
  error.line = s.from.line + 1;
  if (!s.sub_file) drop_frames();
  return Outcome::error;
}

bool Core::not_found(const char* help, std::string_view file) {
  const std::string label = flows.labels.text(flows.skip.label);
  const bool numbered = label[0] != '<';
  return fail(0, help, "EOF in file:%s seeking o-word: o%s%s%s from line: %d",
              std::string(file).c_str(), numbered ? "<" : "", label.c_str(), numbered ? ">" : "",
              flows.skip.from.line + 1);
}

Outcome Core::continue_skip() {
  Skip& s = flows.skip;
  if (s.landing != nullptr) {
    flows.frames.back().go_behind(*s.landing);
    return land(*s.landing);
  }
  if (s.stop_at == flow_bit(Flow::go_to)) return look_for_line();
  std::uint64_t bytes = 0;
  for (int i = 0; i < kSkipLines && bytes < kSkipBytes; ++i) {
    std::string_view line;
    std::uint64_t next = 0;
    const LineRead r = flows.programs[s.program].source->read(s.place.offset, line, next);
    if (r == LineRead::none_yet && !s.to_sub) return Outcome::needs_line;
    if (r == LineRead::none_yet) return skip_failed();  // a sender waits for the answer to its call
    if (r == LineRead::end) {
      // A numbered program stands behind its call (manual: "Fanuc-Style Numbered Programs").
      if (!s.to_sub || s.wrapped || s.numbered) return skip_failed();
      s.wrapped = true;
      s.place = {};
      continue;
    }
    if (r != LineRead::line) {
      s.active = false;
      return read_problem(r);
    }
    bytes += line.size();
    const Place here = s.place;
    s.place = {next, here.line + 1};
    ParsedBlock& b = scratch_;
    if (!parser_.peek_flow(line, b) || (s.label == Label::nested && s.passes(b))) continue;
    if ((flow_bit(b.flow) & s.stop_at) == 0) {
      b.text = line;
      b.program = s.program;
      b.place = here;
      if (!passed_over(b)) return Outcome::error;
      continue;
    }
    Label label{};
    if (!flow_label(b, label) || label != s.label) continue;
    b.text = line;
    b.program = s.program;
    b.place = here;
    b.after = s.place;
    return found(b);
  }
  return Outcome::ok;
}

// A line that is not the one looked for: another use of the label, or a sub inside of a sub.
bool Core::passed_over(ParsedBlock& b) {
  Skip& s = flows.skip;
  if (s.to_sub || b.nested || b.statement || b.label_expr.count != 0) return true;
  const bool in_sub = s.stop_at == flow_bit(Flow::endsub);
  if (in_sub ? b.flow != Flow::sub : b.label != s.label) return true;
  begin_flow();
  current = &b;
  state.line = b.place.line + 1;
  if (in_sub ? nested_sub() : right_use(b, b.label)) return true;
  s.active = false;
  undo_block();
  return false;
}

// The line that was looked for is read.
Outcome Core::found(ParsedBlock& b) {
  Skip& s = flows.skip;
  if (s.to_sub) return land(b);
  Frame& f = flows.frames.back();
  f.go_to(b.after);
  if (s.origin == nullptr) return land(b);
  if (b.flow != Flow::elseif && b.flow != Flow::while_loop && !b.nested) {
    s.origin->to = b.after;
    s.origin->known = true;
    f.link = &s.origin->block;
    return land(b);
  }
  ParsedBlock* const kept = cache_block(b);
  s.origin->landing = kept;
  if (kept == nullptr) return land(b);
  f.go_behind(*kept);
  return land(*kept);
}

// The line that was looked for takes effect.
Outcome Core::land(ParsedBlock& b) {
  Skip& s = flows.skip;
  s.active = false;
  begin_flow();
  current = &b;
  state.line = b.place.line + 1;
  if (s.to_sub) {
    const Sub sub{{s.program, b.after, b.flow == Flow::program_number}, nullptr};
    if (right_call(sub.where) && enter_sub(sub, nullptr)) {
      Sub& known = flows.subs.insert_or_assign(s.label, sub).first->second;
      flows.frames.back().link = &known.body;
      return Outcome::ok;
    }
    undo_block();
    return Outcome::error;
  }
  if (b.flow == Flow::endsub && flows.programs[b.program].stream != nullptr)
    flows.programs[b.program].stream->keep_before(b.after.offset);
  // An elseif or the while of a do is computed; every other landing just goes on behind the line.
  if (b.flow == Flow::elseif) {
    double condition = 0;
    if (!evaluate(b, b.arguments[0], condition)) return undo_block(), Outcome::error;
    if (condition == 0)
      search(b, b.otherwise, s.label, kNextBranch);
    else if (b.nested)
      enter_nested(b, Flow::if_block);
    return Outcome::ok;
  }
  if (b.nested && b.flow == Flow::else_block) enter_nested(b, Flow::if_block);
  if (b.flow == Flow::while_loop && !b.nested && find_loop(flows, s.label) != nullptr)
    return run_flow(b);
  return Outcome::ok;
}

}  // namespace kerf::interp
