// What the O-words, M98 and M99 do. Manual: "O Codes", "Fanuc-Style Numbered Programs".
//
// A label belongs to the sub that it stands in (or to the main program) and begins one block there; names of subs are known
// everywhere.
#include <algorithm>
#include <cmath>

#include "interp/codes/families.hpp"
#include "interp/core.hpp"
#include "interp/flow_internal.hpp"

namespace kerf::interp {

namespace {

/// Lines of a sub's own file that may precede its definition.
constexpr int kLongestSubFile = 20000;

const char* keyword(Flow f) {
  constexpr const char* kNames[] = {"",       "sub",       "endsub", "call",    "return",   "if",
                                    "elseif", "else",      "endif",  "while",   "endwhile", "do",
                                    "repeat", "endrepeat", "break",  "continue"};
  const auto i = static_cast<std::size_t>(f);
  return i < std::size(kNames) ? kNames[i] : "";
}

FlowMask loop_end(Flow kind) {
  return flow_bit(kind == Flow::repeat_loop ? Flow::endrepeat
                  : kind == Flow::do_loop   ? Flow::while_loop
                                            : Flow::endwhile);
}

/// Leaves `label`'s loop and those inside it; with `keep` only those inside.
void close_loops(Flows& flows, Label label, bool keep) {
  const Loop* loop = find_loop(flows, label);
  if (loop == nullptr) return;
  const auto index = static_cast<std::size_t>(loop - flows.loops.data());
  flows.loops.resize(index + (keep ? 1 : 0));
}

/// The line as written, without the blanks behind it.
std::string written(const ParsedBlock& b) {
  return std::string(b.text.substr(0, b.text.find_last_not_of(" \t\r") + 1));
}

/// Label as the message about a sub defined twice has it.
std::string bare(const std::string& label) {
  return label.size() > 2 && label[0] == '<' ? label.substr(1, label.size() - 2) : label;
}

}  // namespace

bool Core::flow_label(const ParsedBlock& b, Label& label) {
  label = b.label;
  if (b.label_expr.count == 0) return true;
  double v = 0, rounded = 0;
  if (!evaluate(b, b.label_expr, v)) return false;
  if (!near_integer(v, rounded) || std::fabs(rounded) > 1e9)
    return fail_at(1, "The number of an O-word is an integer", "Non integer value for integer");
  label = flows.labels.number(static_cast<long>(rounded));
  return true;
}

// Comments beside O-words do nothing, active ones included.
Outcome Core::run_flow(ParsedBlock& b) {
  if (b.flow >= Flow::program_number) return run_numbered(b);
  Label label{};
  double condition = 0;
  const bool good = flow_label(b, label) && (b.flow == Flow::call || b.arguments.empty() ||
                                             evaluate(b, b.arguments[0], condition));
  if (!good || !flow_step(b, label, condition)) {
    undo_block();
    return Outcome::error;
  }
  return finish_block(b);
}

// --- labels ---

bool Core::label_problem(const char* help, const std::string& text) {
  if (!settings.oword_warnonly) return fail(0, help, "%s", text.c_str());
  env.warning(text);
  return true;
}

LabelUse* Core::label_use(Label label) {
  const Frame& f = flows.frames.back();
  auto& labels = flows.programs[f.program].labels;
  const auto hit = labels.find(label_key(f.sub, label));
  return hit == labels.end() ? nullptr : &hit->second;
}

// A block begins: its label must not begin another one. `while` behind a `do` of the label ends that one.
bool Core::begin_label(ParsedBlock& b, Label label) {
  if (b.label_known || b.statement) return true;
  const LabelUse here{b.flow, b.place.line + 1, b.place.offset};
  LabelUse* use = label_use(label);
  if (use == nullptr) {
    const Frame& f = flows.frames.back();
    auto& labels = flows.programs[f.program].labels;
    if (labels.size() < kMostLabels) labels.emplace(label_key(f.sub, label), here);
  } else if (b.flow == Flow::do_loop || (stream() != nullptr && !find_loop(flows, label))) {
    *use = here;  // a sender may use a label again
  } else if (use->offset != here.offset &&
             !(b.flow == Flow::while_loop && use->kind == Flow::do_loop)) {
    const std::string number = std::to_string(here.line) + ": duplicate O-word label";
    const std::string line = '\'' + written(b) + '\'';
    const std::string other = std::to_string(use->line);
    if (!label_problem("Give each block of a sub, and of the main program, a label of its own",
                       b.flow == Flow::if_block
                           ? number + " - already defined in line " + other + ": " + line
                           : number + ": " + line + " - defined in line " + other))
      return false;
  }
  b.label_known = b.label_expr.count == 0;
  return true;
}

// A word inside or at the end of a block: the label must begin a block of one of these kinds.
bool Core::inside_label(ParsedBlock& b, Label label, FlowMask kinds) {
  if (b.label_known || b.statement) return true;
  const LabelUse* use = label_use(label);
  const std::string number = std::to_string(b.place.line + 1);
  if (use == nullptr) {
    const bool all_known = flows.programs[flows.frames.back().program].labels.size() < kMostLabels;
    if (all_known) return undefined_label(b);
  } else if ((kinds & flow_bit(use->kind)) == 0) {
    const char* what = b.flow == Flow::elseif || b.flow == Flow::else_block          ? "'if' "
                       : b.flow == Flow::break_loop || b.flow == Flow::continue_loop ? "while/do "
                                                                                     : "";
    return label_problem("The label must be that of the block",
                         number + ": no matching " + what + "label: '" + written(b) + "' (found '" +
                             keyword(use->kind) + "' in line " + std::to_string(use->line) + ')');
  }
  b.label_known = b.label_expr.count == 0;
  return true;
}

bool Core::undefined_label(const ParsedBlock& b) {
  return label_problem(
      "The beginning with the same label is missing, or a jump led into the block",
      std::to_string(b.place.line + 1) + ": undefined O-word label: '" + written(b) + '\'');
}

/// A word that is passed over must fit to its label as if it were carried out.
bool Core::right_use(ParsedBlock& b, Label label) {
  constexpr FlowMask kWhile = flow_bit(Flow::while_loop), kDo = flow_bit(Flow::do_loop);
  switch (b.flow) {
    case Flow::if_block:
    case Flow::while_loop:
    case Flow::do_loop:
    case Flow::repeat_loop: return begin_label(b, label);
    case Flow::elseif:
    case Flow::else_block:
    case Flow::endif: return inside_label(b, label, flow_bit(Flow::if_block));
    case Flow::endwhile: return inside_label(b, label, kWhile);
    case Flow::endrepeat: return inside_label(b, label, flow_bit(Flow::repeat_loop));
    case Flow::break_loop:
    case Flow::continue_loop: return inside_label(b, label, kWhile | kDo);
    default: return true;
  }
}

bool Core::nested_sub() {
  return fail(0, "End the sub before the next one begins", "Nested subroutine definition");
}

// --- blocks ---

bool Core::flow_step(ParsedBlock& b, Label label, double condition) {
  constexpr FlowMask kIf = flow_bit(Flow::if_block);
  if (b.nested) return nested_step(b, condition != 0);
  switch (b.flow) {
    case Flow::go_to:
      if (b.arguments.empty() || condition != 0) start_skip(b, label, flow_bit(Flow::go_to));
      return true;
    case Flow::sub: return define_sub(b, label);
    case Flow::endsub:
    case Flow::ret: return end_sub(b, condition);
    case Flow::call: return call_sub(b, label);
    case Flow::if_block:
      if (!begin_label(b, label)) return false;
      if (condition == 0) start_skip(b, label, kNextBranch);
      return true;
    case Flow::elseif:
    case Flow::else_block:
      if (!inside_label(b, label, kIf)) return false;
      start_skip(b, label, kEndIf);
      return true;
    case Flow::endif: return inside_label(b, label, kIf);
    case Flow::do_loop:
      if (!begin_label(b, label)) return false;
      close_loops(flows, label, false);
      flows.loops.push_back({label, Flow::do_loop, b.place, b.after, 0});
      return true;
    case Flow::while_loop: return run_while(b, label, condition != 0);
    case Flow::repeat_loop: {
      if (!begin_label(b, label)) return false;
      close_loops(flows, label, false);
      const double n = std::floor(condition + 0.5);
      if (n < 1)
        start_skip(b, label, loop_end(Flow::repeat_loop));
      else
        flows.loops.push_back({label, Flow::repeat_loop, b.place, b.after,
                               static_cast<std::int64_t>(std::min(n, 9e15))});
      return true;
    }
    default: return loop_end_step(b, label);
  }
}

bool Core::run_while(ParsedBlock& b, Label label, bool condition) {
  Frame& f = flows.frames.back();
  Loop* loop = find_loop(flows, label);
  if (loop != nullptr && loop->kind == Flow::do_loop) {
    if (condition) {
      f.go_to(loop->body, b, b.jump);
      close_loops(flows, label, true);
    } else {
      close_loops(flows, label, false);
    }
    return true;
  }
  if (!begin_label(b, label)) return false;
  if (!condition) {
    if (loop != nullptr) close_loops(flows, label, false);
    start_skip(b, label, loop_end(Flow::while_loop));
    return true;
  }
  if (loop != nullptr)
    close_loops(flows, label, true);
  else
    flows.loops.push_back({label, Flow::while_loop, b.place, b.after, 0});
  return true;
}

bool Core::loop_end_step(ParsedBlock& b, Label label) {
  Frame& f = flows.frames.back();
  constexpr FlowMask kWhile = flow_bit(Flow::while_loop), kDo = flow_bit(Flow::do_loop);
  const bool leaves = b.flow == Flow::break_loop || b.flow == Flow::continue_loop;
  if (!inside_label(b, label,
                    leaves                      ? kWhile | kDo
                    : b.flow == Flow::endrepeat ? flow_bit(Flow::repeat_loop)
                                                : kWhile))
    return false;
  Loop* loop = find_loop(flows, label);
  if (loop == nullptr) return undefined_label(b);
  if (!leaves && loop_end(loop->kind) != flow_bit(b.flow)) return true;  // warned of already
  close_loops(flows, label, true);
  loop = &flows.loops.back();
  if (b.flow == Flow::break_loop ||
      (b.flow == Flow::continue_loop && loop->kind == Flow::do_loop)) {
    const FlowMask end = loop_end(loop->kind);
    if (b.flow == Flow::break_loop) flows.loops.pop_back();
    start_skip(b, label, end);
    return true;
  }
  if (loop->kind == Flow::repeat_loop) {
    if (--loop->left > 0) {
      f.go_to(loop->body, b, b.jump);
    } else {
      flows.loops.pop_back();
      if (b.flow == Flow::continue_loop) start_skip(b, label, loop_end(Flow::repeat_loop));
    }
    return true;
  }
  f.go_to(loop->start, b, b.jump);
  return true;
}

// --- subs ---

bool Core::define_sub(ParsedBlock& b, Label label) {
  Frame& f = flows.frames.back();
  if (f.is_sub()) return nested_sub();
  const FileAndPlace here{f.program, b.after, false};
  if (const auto known = flows.subs.find(label); known == flows.subs.end()) {
    if (flows.subs.size() == kMostSubs)
      return fail(0, "Put subs that a program does not call into files of their own",
                  "Too many subroutines");
    flows.subs.emplace(label, Sub{here, nullptr});
  } else if (known->second.where.program != here.program ||
             known->second.where.place.offset != here.place.offset) {
    if (!label_problem(
            "A name stands for one sub",
            "File:" + flows.programs[f.program].path + " line:" + std::to_string(b.place.line + 1) +
                " redefining sub: o|" + bare(flows.labels.text(label)) +
                "| already defined in file:" + flows.programs[known->second.where.program].path))
      return false;
  }
  start_skip(b, label, flow_bit(Flow::endsub));
  return true;
}

bool Core::end_sub(const ParsedBlock& b, double value) {
  const Frame& f = flows.frames.back();
  if (!f.is_sub())
    return label_problem("return and endsub stand inside a sub",
                         std::to_string(b.place.line + 1) + ": not in a subroutine definition: '" +
                             written(b) + '\'');
  if (f.numbered)
    return fail(0, "Write M99", "Fanuc 'O....' subroutine definition must end with 'M99'");
  return return_from_sub(!b.arguments.empty(), value);
}

// O-subs are called by `call`, numbered programs by M98 (manual: "Fanuc-Style Numbered Programs").
bool Core::right_call(const FileAndPlace& where) {
  if (where.numbered == flows.skip.numbered) return true;
  return where.numbered ? fail(0, "Write M98 P with the number",
                               "Fanuc 'O....' subroutine must be called with 'M98'")
                        : fail(0, "Write O with the number, and call",
                               "'O.... sub' subroutine must be called with 'O.... call'");
}

bool Core::call_sub(ParsedBlock& b, Label label) {
  Skip& s = flows.skip;
  s.begin_call();
  s.argument_count = b.arguments.size();
  for (std::size_t i = 0; i < b.arguments.size(); ++i) {
    if (!evaluate(b, b.arguments[i], s.arguments[i])) return false;
  }
  return find_and_enter(b, label);
}

bool Core::find_and_enter(const ParsedBlock& b, Label label) {
  Skip& s = flows.skip;
  s.label = label;
  if (!s.numbered && is_script("oword", bare(flows.labels.text(label))))
    return enter_function(b, label);
  if (const auto hit = flows.subs.find(label); hit != flows.subs.end())
    return right_call(hit->second.where) && enter_sub(hit->second, &hit->second.body);
  if (flows.frames.size() > static_cast<std::size_t>(dialect.call_levels))
    return enter_sub({}, nullptr);
  const std::string path = env.find_sub(bare(flows.labels.text(label)));
  const Frame& f = flows.frames.back();
  s.from = b.place;
  s.origin = nullptr;
  s.landing = nullptr;
  s.to_sub = true;
  s.stop_at = kSubBegins;
  s.program = f.program;
  s.place = f.place;
  s.sub_file = s.wrapped = !path.empty();
  if (s.sub_file) {
    // The definition is looked for from the top of that file.
    const Program* program = open_program(path);
    if (program == nullptr)
      return fail(0, "Check that the file can be read", "Unable to open file <%s>", path.c_str());
    s.program = static_cast<std::uint32_t>(program - flows.programs.data());
    s.place = {};
  }
  s.active = true;
  return true;
}

// For the bodies of remapped codes, which cannot wait for a search: reads the file now. The block in progress stays as it is.
bool Core::enter_file_sub(std::uint32_t program) {
  if (current == &scratch_) {
    held_text_ = scratch_.text;  // it may be of the same file
    scratch_.text = held_text_;
  }
  Parser parser(dialect, params, flows.labels);
  Place place;
  std::string_view line;
  std::uint64_t next = 0;
  const Label label = flows.skip.label;
  while (place.line < kLongestSubFile &&
         flows.programs[program].source->read(place.offset, line, next) == LineRead::line) {
    place = {next, place.line + 1};
    ParsedBlock b;
    if (!parser.peek_flow(line, b) || (flow_bit(b.flow) & kSubBegins) == 0 || b.label != label)
      continue;
    const Sub sub{{program, place, b.flow == Flow::program_number}, nullptr};
    if (!right_call(sub.where) || !enter_sub(sub, nullptr)) return false;
    flows.subs.insert_or_assign(label, sub);
    return true;
  }
  return not_found("The file must define the sub of its name", flows.programs[program].path);
}

// --- numbered programs ---

// O100 alone, M98 and M99.
Outcome Core::run_numbered(ParsedBlock& b) {
  bool good = true;
  if (b.flow == Flow::program_number) {
    Label label{};
    good = flow_label(b, label) &&
           (!settings.disable_fanuc_style_sub ||
            fail(0, "Write a keyword behind it, or allow numbered programs",
                 "DISABLE_FANUC_STYLE_SUB disabled in INI file, but found bare O-word"));
  } else {
    good = build(b, block_) && numbered_alone(block_) &&
           (b.flow == Flow::call_number ? call_numbered(b) : return_numbered());
  }
  if (good) return finish_block(b);
  undo_block();
  return Outcome::error;
}

bool Core::numbered_alone(const Block& b) {
  constexpr LetterMask kOwn = letters("pl");
  if (b.row_count == 1 && (b.mask & ~kOwn) == 0 && b.source->assignments.empty()) return true;
  return fail(0, "M98 and M99 stand on a line of their own", "Unexpected character after O-word");
}

bool Core::call_numbered(ParsedBlock& b) {
  if (settings.disable_fanuc_style_sub)
    return fail(0, "Use O-words, or allow numbered programs",
                "DISABLE_FANUC_STYLE_SUB set in INI file, but found m98");
  int number = 0, times = 1;
  if (!block_.has('p'))
    return fail(0, "P is the number of the program to call", "Found 'm98' code with no P-word");
  if (!integer(block_, 'p', 0, number) || !integer(block_, 'l', 1, times)) return false;
  if (times < 0) return fail('l', "L says how often the program runs", "Negative l word used");
  if (times == 0) return true;
  Skip& s = flows.skip;
  s.numbered = true;
  s.times = times;
  return find_and_enter(b, flows.labels.number(number));
}

bool Core::return_numbered() {
  Frame& f = flows.frames.back();
  if (!f.is_sub()) return end_or_restart();
  if (!f.numbered)
    return fail(0, "Write endsub or return with the label of the sub",
                "'O.... endsub' or 'O.... return' must follow 'O.... sub' subroutine definition");
  if (--f.times <= 0) return return_from_sub(false, 0);
  f.go_to(f.start);
  flows.loops.resize(f.first_loop);
  params.pop_scope();
  params.push_scope();
  params.begin();
  const std::unique_ptr<ModalState> was = f.restore_on_return ? std::move(f.saved_state) : nullptr;
  f.saved_state = nullptr;
  f.restore_on_return = false;
  return was == nullptr || restore_modes(*this, *was, f.saved_tool);
}

// M99 in the main program begins it anew; where nothing moves (a preview, a listing) that would never end, so it ends there.
bool Core::end_or_restart() {
  if (!settings.is_task || flows.mdi || stream() != nullptr) return end_program(*this, 2);
  reset_g92_at_end(*this);
  flows.frames[0].go_to({});
  flows.loops.resize(flows.frames[0].first_loop);
  flows.started = false;
  state.percent_file = false;
  return true;
}

}  // namespace kerf::interp
