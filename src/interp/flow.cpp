// Program flow: reading lines through the cache, frames, searching for labels. What the O-words do: flow_words.cpp.
//
// Nothing here loops over the program: a search for a label takes a bounded number of lines per execute_next().
#include <algorithm>
#include <cmath>

#include "interp/core.hpp"
#include "interp/flow_internal.hpp"

namespace kerf::interp {

namespace {

/// Lines looked at per execute_next() while searching a label.
constexpr int kSkipLines = 2000;
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
      p.labels.clear();
      flows.last_cached = nullptr;
    }
    return static_cast<std::uint32_t>(i);
  }
  flows.programs.push_back({std::move(path), std::move(source), {}, {}});
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
  flows.programs[0].labels.clear();
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
  f.start = where.place;
  f.numbered = flows.skip.numbered;
  f.times = flows.skip.times;
  if (!f.numbered) {
    for (int i = 0; i < kSubArguments; ++i) {
      f.saved[static_cast<std::size_t>(i)] = params.get(i + 1);
      params.set(i + 1, flows.skip.arguments[static_cast<std::size_t>(i)]);
    }
  }
  params.push_scope();
  if (settings.oword_nargs && !f.numbered)
    params.set_named(params.intern("n_args"),
                     {static_cast<double>(flows.skip.argument_count), nullptr});
  if (!f.numbered) sub_value = 0, sub_value_returned = false;
  flows.frames.push_back(std::move(f));
  return true;
}

void Core::leave_sub(bool has_value, double value) {
  const Frame& f = flows.frames.back();
  if (!f.numbered) {
    for (int i = 0; i < kSubArguments; ++i) params.set(i + 1, f.saved[static_cast<std::size_t>(i)]);
  }
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
  current = nullptr;
  if (s.to_sub) {
    not_found(s.numbered
                  ? "A numbered program (O with the number) stands behind the M98 that calls it"
                  : "Define the sub, or put it into a file of its name in the search path",
              current_file());
  } else {
    const std::string help = "The end of the O-word in line " + std::to_string(s.from.line + 1) +
                             " is missing: label " + s.label;
    fail(0, help.c_str(), "%s", kNoEnd);
  }
  error.line = s.from.line + 1;
  drop_frames();
  return Outcome::error;
}

bool Core::not_found(const char* help, std::string_view file) {
  const std::string& label = flows.skip.label;
  const bool numbered = label.empty() || label[0] != '<';
  return fail(0, help, "EOF in file:%s seeking o-word: o%s%s%s from line: %d",
              std::string(file).c_str(), numbered ? "<" : "", label.c_str(), numbered ? ">" : "",
              flows.skip.from.line + 1);
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
      // A numbered program stands behind its call (manual: "Fanuc-Style Numbered Programs").
      if (!s.to_sub || s.wrapped || s.numbered) return skip_failed();
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
    if (!parser_.peek_flow(line, b) || (flow_bit(b.flow) & s.stop_at) == 0) continue;
    if (b.label_expr.count > 0 && !flow_label(b, b.label)) continue;
    if (b.label != s.label) continue;
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
    const FileAndPlace where{f.program, b.after, b.flow == Flow::program_number};
    f.place = s.return_place;
    f.upcoming = nullptr;
    if (right_call(where) && enter_sub(where)) {
      flows.subs[s.label] = where;
      return Outcome::ok;
    }
    undo_block();
    return Outcome::error;
  }
  // An elseif or the while of a do is computed; every other landing just goes on behind the line.
  if (b.flow == Flow::elseif) {
    double condition = 0;
    if (!evaluate(b, b.arguments[0], condition)) return undo_block(), Outcome::error;
    if (condition == 0) start_skip(b, s.label, kNextBranch);
    return Outcome::ok;
  }
  if (b.flow == Flow::while_loop && find_loop(f, s.label) != nullptr) return run_flow(b);
  return Outcome::ok;
}

}  // namespace kerf::interp
