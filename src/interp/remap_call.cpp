// Remapped codes while a program runs: a block stops at such a code, its body runs like a sub call, then the rest of the
// block follows. Manual: "Remap Extending G-code", "Remapped code execution".
#include <cstdio>

#include "interp/codes/families.hpp"
#include "interp/core.hpp"
#include "interp/remap_glue.hpp"

namespace kerf::interp {

namespace {

constexpr std::int16_t kGroupOrder[] = {kOrderStop,    kOrderIo,      kOrderToolChange,
                                        kOrderSpindle, kOrderCoolant, kOrderOverride,
                                        kOrderUser};  // groups 4 to 10

/// Body of a code that exists only by its remap: begin_remap() runs instead.
bool new_code(Core& c, const Block&, int) {
  return c.fail(0, "", "maximum nesting of remapped blocks exceeded");
}

std::size_t word_slot(int letter) { return letter == 'f' ? 0 : letter == 's' ? 1 : 2; }

}  // namespace

void Core::add_remaps() {
  remap_rows_.reserve(settings.remaps.size());
  for (const Remap& r : settings.remaps) {
    if (r.letter != 'g' && r.letter != 'm') {
      remap_words_[word_slot(r.letter)] = &r;
      continue;
    }
    const CodeRow* builtin = row(r.letter, r.code);
    CodeRow fresh = builtin != nullptr ? *builtin : CodeRow{};
    if (builtin == nullptr) {
      fresh.run = new_code;
      fresh.axes = r.letter == 'g' ? AxisUse::optional : AxisUse::none;
    }
    fresh.letter = r.letter;
    fresh.code = fresh.last = r.code;
    fresh.group = r.group;
    fresh.order = r.letter == 'g' ? kOrderMotion : kGroupOrder[r.group - 4];
    fresh.remap = &r;
    remap_rows_.push_back(fresh);
    (r.letter == 'g' ? g_rows_ : m_rows_)[static_cast<std::size_t>(r.code)] = &remap_rows_.back();
  }
}

bool Core::has_builtin(const Step& s) { return s.row == nullptr || s.row->run != new_code; }

const Remap* Core::remap_of(const Step& s) const {
  return s.row != nullptr ? s.row->remap : remap_words_[word_slot(s.code)];
}

RemapCall* Core::body_of(const Remap& r) const {
  for (std::size_t i = flows.frames.size(); i-- > 0;) {
    RemapCall* call = flows.frames[i].remap.get();
    if (call != nullptr && call->remap == &r) return call;
  }
  return nullptr;
}

int Core::remap_level() const {
  int level = 0;
  for (const Frame& f : flows.frames)
    level += f.remap != nullptr && f.remap->remap != nullptr ? 1 : 0;
  return level;
}

std::shared_ptr<RemapCall> Core::keep_block(const Block& b, const Steps& steps) const {
  auto call = std::make_shared<RemapCall>();
  if (b.source != nullptr) call->parsed = *call->memory.keep(*b.source);
  call->block = b;
  call->block.source = &call->parsed;
  call->steps = steps;
  return call;
}

bool Core::check_remap_words(const Remap& r, const Block& b) {
  std::string missing, wanting;
  for (const char word : r.words) {
    if (word < 'A' || word > 'Z' || b.has(static_cast<char>(word + 32))) continue;
    missing += missing.empty() ? " missing: " : ",";
    missing += word;
  }
  if (r.feed && state.feed <= 0) wanting += "F>0,";
  const auto spindle = static_cast<std::size_t>(state.speed_spindle);
  if (r.spindle && state.speed_rpm[spindle] <= 0) wanting += "S>0,";
  if (missing.empty() && wanting.empty()) return true;
  return fail(0,
              missing.empty() ? "Set the feed or the speed on a line before"
                              : "Add the words that the code needs",
              "user-defined %s:%s%s", r.name.c_str(), missing.c_str(), wanting.c_str());
}

bool Core::begin_remap(const Remap& r, const std::shared_ptr<RemapCall>& call) {
  if (remap_level() >= dialect.call_levels)
    return fail(0, "The code calls itself; call it with another code inside its body",
                "maximum nesting of remapped blocks exceeded");
  if (!check_remap_words(r, call->block)) return false;
  ++call->steps.next;
  call->remap = &r;
  call->builtin_used = false;
  const bool python = !r.python.empty();
  if (python && !is_script("remap", r.python)) return glue(r.python, *call);
  flows.skip.begin_call();
  if (!enter_remap_sub(r)) return false;
  Frame& body = flows.frames.back();
  body.remap = call;
  pass_remap_words(r, *call);
  if (python || r.prolog.empty()) {
    if (python) body.phase = ScriptPhase::body;
    return true;
  }
  if (is_script("remap", r.prolog)) {
    body.phase = ScriptPhase::prolog;
    return true;
  }
  if (glue(r.prolog, *call)) return true;
  leave_sub(false, 0);
  error.file = current_file();  // the line is the caller's
  return false;
}

bool Core::enter_remap_sub(const Remap& r) {
  if (!r.python.empty()) {
    flows.skip.label = flows.labels.named(r.python);
    const Frame& f = flows.frames.back();
    return enter_sub(Sub{{f.program, f.place}, nullptr}, nullptr);
  }
  std::string name;
  bool digits = true;
  for (const char c : r.ngc) {
    name += c >= 'A' && c <= 'Z' && !settings.no_downcase_oword ? static_cast<char>(c + 32) : c;
    digits = digits && c >= '0' && c <= '9';
  }
  Skip& s = flows.skip;
  s.label = digits ? flows.labels.number(name) : flows.labels.named("<" + name + ">");
  s.from = current != nullptr ? current->place : Place{};
  if (const auto hit = flows.subs.find(s.label); hit != flows.subs.end())
    return enter_sub(hit->second, &hit->second.body);
  if (flows.frames.size() > static_cast<std::size_t>(dialect.call_levels))
    return enter_sub({}, nullptr);
  std::string path = env.find_sub(r.ngc);
  if (path.empty()) path = env.find_sub(name);
  const Program* program = path.empty() ? nullptr : open_program(path);
  if (program == nullptr)
    return fail(0, "REMAP names it; put NAME.ngc into PROGRAM_PREFIX or SUBROUTINE_PATH",
                "INTERP_REMAP: NGC file not found: ngc=%s", r.ngc.c_str());
  return enter_file_sub(static_cast<std::uint32_t>(program - flows.programs.data()));
}

void Core::pass_remap_words(const Remap& r, const RemapCall& call) {
  int position = 0;
  for (const char word : r.words) {
    const char letter = word >= 'A' && word <= 'Z' ? static_cast<char>(word + 32) : word;
    const bool there = call.block.has(letter);
    if (r.positional)
      params.set(++position, there ? call.block[letter] : 0);
    else if (there)
      (void)set_local(std::string_view(&letter, 1), call.block[letter]);
  }
  if (r.line_number) (void)set_local("n", call.parsed.place.line + 1);
}

bool Core::set_local(std::string_view name, double value) {
  params.set_named(params.intern(name), Value{value, nullptr});
  return true;
}

double Core::local(std::string_view name, double otherwise) {
  const Value* v = params.find(params.intern(name));
  return v == nullptr ? otherwise : v->number;
}

// prolog= and epilog=, in the scope of the body.
bool Core::glue(const std::string& function, RemapCall& call) {
  if (const NativeGlue native = find_native_glue(function); native != nullptr)
    return native(*this, call);
  return fail(0, "[PYTHON]TOPLEVEL names the script that must define it",
              "'%s' is not a Python callable function", function.c_str());
}

bool Core::end_remap(Frame& body) {
  RemapCall& call = *body.remap;
  const std::string& epilog = call.remap->epilog;
  if (epilog.empty()) return true;
  if (!is_script("remap", epilog)) return glue(epilog, call);
  body.phase = ScriptPhase::epilog;
  body.started = false;
  return true;
}

// The rest of a block, after the body of a remapped code in it.
Outcome Core::resume_block() {
  const std::shared_ptr<RemapCall> call = std::exchange(flows.resume, nullptr);
  begin_block();
  current = &call->parsed;
  state.line = call->parsed.place.line + 1;
  block_ = call->block;
  const bool good = run_steps(call->block, call->steps, call);
  if (!good) undo_block();
  const Outcome o = good ? finish_block(call->parsed) : Outcome::error;
  current = nullptr;
  return o;
}

}  // namespace kerf::interp
