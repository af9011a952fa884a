// Functions in Python while a program runs: as bodies, prologs and epilogs of remapped codes, and as O-word subs. Each works in
// a frame of its own and goes on once per execute_next(). Manual: "Calling conventions: NGC to Python", "Python to NGC".
#include "interp/core.hpp"
#include "interp/script_self.hpp"

namespace kerf::interp {

Core::~Core() {
  if (attached_) scripts->detach();
}

bool Core::is_script(std::string_view module, std::string_view function) const {
  return attached_ && scripts->has(module, function);
}

bool Core::enter_function(const ParsedBlock& b, Label label) {
  flows.skip.label = label;
  const Frame& caller = flows.frames.back();
  if (!enter_sub(Sub{{caller.program, caller.place}, nullptr}, nullptr)) return false;
  Frame& f = flows.frames.back();
  f.remap = std::make_shared<RemapCall>();
  f.remap->parsed = *f.remap->memory.keep(b);
  f.remap->block.source = &f.remap->parsed;
  f.phase = ScriptPhase::body;
  return true;
}

ScriptCall Core::make_call(const Frame& f) const {
  ScriptCall call;
  const Remap* r = f.remap->remap;
  if (r == nullptr) {
    call.module = "oword";
    const std::string& label = flows.labels.text(f.sub);
    call.function = label.size() > 2 && label[0] == '<' ? label.substr(1, label.size() - 2) : label;
    for (std::size_t i = 0; i < f.remap->parsed.arguments.size(); ++i)
      call.arguments.push_back(params.get(static_cast<int>(i) + 1));
    return call;
  }
  call.module = "remap";
  call.function = f.phase == ScriptPhase::prolog   ? r->prolog
                  : f.phase == ScriptPhase::epilog ? r->epilog
                                                   : r->python;
  const Block& b = f.remap->block;
  for (const char word : r->words) {
    const char letter = word >= 'A' && word <= 'Z' ? static_cast<char>(word + 32) : word;
    if (b.has(letter)) call.words.emplace_back(std::string(1, letter), b[letter]);
  }
  if (r->line_number) call.words.emplace_back("n", f.remap->parsed.place.line + 1);
  return call;
}

Outcome Core::execute_scripted() {
  const bool waiting = repeats.left == 0 && flows.resume == nullptr && !flows.skip.active;
  const ScriptPhase phase =
      waiting && !flows.frames.empty() ? flows.frames.back().phase : ScriptPhase::none;
  const bool function = phase != ScriptPhase::none && phase != ScriptPhase::execute;
  const Outcome o = function ? go_on_script() : execute_one();
  return o == Outcome::error ? answer_error() : o;
}

Outcome Core::go_on_script() {
  begin_block();
  Frame& f = flows.frames.back();
  const std::shared_ptr<RemapCall> call = f.remap;
  current = &call->parsed;
  block_ = call->block;
  state.line = call->parsed.place.line + 1;
  const bool started = std::exchange(f.started, true);
  const ScriptStep step =
      started ? scripts->resume(std::exchange(answer_, {})) : scripts->call(make_call(f));
  Outcome o = Outcome::ok;
  switch (step.kind) {
    case ScriptStep::Kind::execute:
      push_execute(step);
      o = finish_block(call->parsed);
      break;
    case ScriptStep::Kind::finish:
      if (sync == SyncReason::none) ask_sync(SyncReason::script);
      o = finish_block(call->parsed);
      break;
    case ScriptStep::Kind::done: o = end_script(step, call); break;
    case ScriptStep::Kind::failed:
      leave_sub(false, 0);  // first: the error is the caller's line
      (void)script_failed(step);
      undo_block();
      o = Outcome::error;
      break;
  }
  current = nullptr;
  return o;
}

Outcome Core::end_script(const ScriptStep& step, const std::shared_ptr<RemapCall>& call) {
  if (step.finish_first && sync == SyncReason::none) ask_sync(SyncReason::script);
  Frame& f = flows.frames.back();
  bool good = true;
  if (f.phase == ScriptPhase::prolog) {
    f.phase = ScriptPhase::none;  // the sub follows
    f.started = false;
  } else if (f.phase == ScriptPhase::epilog) {
    good = finish_return(sub_value_returned, sub_value);
  } else {
    good = finish_return(step.value.has_value(), step.value.value_or(0));
  }
  if (good) return finish_block(call->parsed);
  undo_block();
  return Outcome::error;
}

bool Core::script_failed(const ScriptStep& step) {
  return fail(0, step.help.c_str(), "%s", step.text.c_str());
}

// Lines that a function wants executed are a program of their own; the scope of names is that of the function.
void Core::push_execute(const ScriptStep& step) {
  const std::uint32_t program = add_program("(python " + std::to_string(flows.frames.size()) + ")",
                                            make_text_source(step.text, dialect.longest_line));
  Frame& f = flows.frames.emplace_back();
  f.program = program;
  f.place.line = step.line > 0 ? step.line - 1 : state.line - 1;
  f.first_loop = flows.loops.size();
  f.phase = ScriptPhase::execute;
}

// An error in lines that a function wanted executed is the function's: it may handle it.
Outcome Core::answer_error() {
  auto& frames = flows.frames;
  std::size_t at = frames.size();
  while (at > 0 && frames[at - 1].phase != ScriptPhase::execute) --at;
  if (at == 0) return Outcome::error;
  while (frames.size() >= at) leave_sub(false, 0);
  repeats.left = 0;
  flows.resume.reset();
  flows.skip.active = false;
  answer_ = {false, error.text, error.source, error.line};
  return Outcome::ok;
}

// ;py, and (py, ...)
bool Core::run_statement(std::string_view text) {
  if (!attached_) {
    env.warning(script_problem_.empty()
                    ? "a py comment is ignored: the machine has no Python ([PYTHON]TOPLEVEL)"
                    : script_problem_);
    return true;
  }
  const ScriptStep step = scripts->run(text);
  return step.kind == ScriptStep::Kind::done || script_failed(step);
}

bool Core::script_parameter(const std::string& name, Value& value) {
  if (!is_script("namedparams", name)) return false;
  ScriptCall call;
  call.module = "namedparams";
  call.function = name;
  const ScriptStep step = scripts->call(std::move(call));
  if (step.kind != ScriptStep::Kind::done) {
    env.warning("#<" + name + ">: " + step.text);
    return false;
  }
  value = {step.value.value_or(0), nullptr};
  return true;
}

}  // namespace kerf::interp
