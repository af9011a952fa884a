// Statements without O-words: IF and WHILE that nest, GOTO, IF THEN ELSE on one line. Which of them a dialect has, and how they are
// written, its rows say (StatementRow).
#include <algorithm>

#include "interp/core.hpp"
#include "interp/flow_internal.hpp"

namespace kerf::interp {

// --- IF ... ENDIF, WHILE ... ENDWHILE ---

void Core::enter_nested(const ParsedBlock& b, Flow kind) {
  flows.loops.push_back({Label::nested, kind, b.place, b.after, 0});
}

bool Core::nested_step(ParsedBlock& b, bool condition) {
  Frame& f = flows.frames.back();
  auto& open = flows.loops;
  const auto inside = [&](Flow kind) {
    return open.size() > f.first_loop && open.back().label == Label::nested &&
           open.back().kind == kind;
  };
  switch (b.flow) {
    case Flow::if_block:
      if (condition)
        enter_nested(b, Flow::if_block);
      else
        start_skip(b, Label::nested, kNextBranch);
      return true;
    case Flow::while_loop: {
      const bool again = inside(Flow::while_loop) && open.back().start.offset == b.place.offset;
      if (condition && !again) enter_nested(b, Flow::while_loop);
      if (!condition) {
        if (again) open.pop_back();
        start_skip(b, Label::nested, flow_bit(Flow::endwhile));
      }
      return true;
    }
    default: break;
  }
  if (!inside(b.flow == Flow::endwhile ? Flow::while_loop : Flow::if_block))
    return fail(0, "What it belongs to is missing, or a jump led into the block",
                "A statement ends here that did not begin");
  if (b.flow == Flow::endwhile) {
    f.go_to(open.back().start, b, b.jump);
    return true;
  }
  open.pop_back();
  if (b.flow != Flow::endif) start_skip(b, Label::nested, kEndIf);
  return true;
}

// --- GOTO ---

// A line between a GOTO and its target: what ends there is left.
void Core::pass_line(std::string_view line) {
  Skip& s = flows.skip;
  const std::size_t first = flows.frames.back().first_loop;
  ParsedBlock& b = scratch_;
  if (s.open == first || !parser_.peek_flow(line, b)) return;
  if (b.nested) {
    if (!s.passes(b) && (b.flow == Flow::endif || b.flow == Flow::endwhile) &&
        flows.loops[s.open - 1].label == Label::nested)
      --s.open;
    return;
  }
  Label label{};
  if (b.flow != Flow::endwhile && b.flow != Flow::endrepeat && b.flow != Flow::while_loop) return;
  if (!flow_label(b, label)) return;
  for (std::size_t i = s.open; i-- > first;) {
    if (flows.loops[i].label == label) s.open = i;
  }
}

// A number is looked for behind the GOTO first, then from the top of the file.
Outcome Core::look_for_line() {
  Skip& s = flows.skip;
  Frame& f = flows.frames.back();
  std::uint64_t bytes = 0;
  for (int i = 0; i < kSkipLines && bytes < kSkipBytes; ++i) {
    std::string_view line;
    std::uint64_t next = 0;
    const LineRead r = flows.programs[s.program].source->read(s.place.offset, line, next);
    const bool endless =
        r == LineRead::none_yet;  // a stream neither goes back nor waits for a line
    if (r == LineRead::end && !s.wrapped) {
      s.wrapped = true;
      s.place = {};
      continue;
    }
    if (r != LineRead::line && r != LineRead::end && !endless) {
      s.active = false;
      return read_problem(r);
    }
    const Place here = s.place;
    if (r == LineRead::end || endless || (s.wrapped && here.offset > s.from.offset)) {
      s.active = false;
      current = nullptr;
      fail(0, "Write the number behind an N at the beginning of that line", "No line N%s to go to",
           flows.labels.text(s.label).c_str());
      error.line = s.from.line + 1;
      drop_frames();
      return Outcome::error;
    }
    bytes += line.size();
    s.place = {next, here.line + 1};
    if (parser_.peek_sequence(line) != static_cast<std::int64_t>(s.label)) {
      if (!s.wrapped) pass_line(line);
      continue;
    }
    if (s.wrapped) {  // what began before the target is still in progress there
      const auto before = [&](const Loop& l) { return l.start.offset < here.offset; };
      const auto first = flows.loops.begin() + static_cast<std::ptrdiff_t>(f.first_loop);
      s.open = static_cast<std::size_t>(std::find_if_not(first, flows.loops.end(), before) -
                                        flows.loops.begin());
      flows.programs[s.program].goes_back = true;
    }
    if (s.origin != nullptr) {
      s.origin->leaves = static_cast<std::uint32_t>(flows.loops.size() - s.open);
      s.origin->to = here;
      s.origin->known = true;
    }
    s.active = false;
    flows.loops.resize(s.open);
    f.go_to(here);
    return Outcome::ok;
  }
  return Outcome::ok;
}

// --- IF THEN ELSE ---

ParsedBlock* Core::chosen_part(ParsedBlock& b) {
  double condition = 0;
  if (!evaluate(b, b.arguments[0], condition)) return nullptr;
  chosen_ = b;
  chosen_.conditional = chosen_.cached = false;
  chosen_.words = condition != 0 ? b.words.first(b.else_words) : b.words.subspan(b.else_words);
  chosen_.assignments = condition != 0 ? b.assignments.first(b.else_assignments)
                                       : b.assignments.subspan(b.else_assignments);
  return &chosen_;
}

}  // namespace kerf::interp
