#include "hal/tcl/tcl_hal.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <utility>

#include "hal/client/list_parameters.hpp"
#include "hal/cmd/words.hpp"

namespace kerf::hal::tcl {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

/// Words that are Tcl commands. list, gets and exit stay Tcl's own; `hal list` and `hal gets` are HAL's.
constexpr auto kCommands = std::to_array<const char*>(
    {"addf",   "alias",   "debug",    "delf",      "delsig", "echo",   "getp",   "help",  "linkpp",
     "linkps", "linksp",  "loadrt",   "loadusr",   "lock",   "net",    "newsig", "print", "ptype",
     "save",   "setp",    "sets",     "show",      "start",  "status", "stop",   "stype", "unalias",
     "unecho", "unlinkp", "unloadrt", "unloadusr", "unlock", "waitusr"});
/// Tcl commands that are also words of HAL: which one is meant shows in the arguments.
constexpr auto kShared = std::to_array<const char*>({"source", "unload"});
/// Words that change nothing: `hal WORD` does them in the first pass too.
constexpr auto kReading =
    std::to_array<const char*>({"list", "gets", "getp", "ptype", "stype", "show", "status", "help",
                                "save", "print", "echo", "unecho", "debug"});
/// Words whose text is for people: it goes to stdout, and the result is empty.
constexpr auto kPrinting = std::to_array<const char*>({"show", "save", "help", "source"});

template <std::size_t N>
bool is_one_of(const std::array<const char*, N>& names, std::string_view word) {
  return std::find(names.begin(), names.end(), word) != names.end();
}

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

std::string text_of(Tcl_Obj* object) {
  int size = 0;
  const char* text = Tcl_GetStringFromObj(object, &size);
  return {text, static_cast<std::size_t>(size)};
}

Tcl_Obj* object_of(std::string_view text) {
  return Tcl_NewStringObj(text.data(), static_cast<int>(text.size()));
}

std::string without_newline(std::string text) {
  if (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// To a channel of Tcl's, so that it comes in order with what `puts` writes.
void print(int which, const std::string& text) {
  Tcl_Channel channel = text.empty() ? nullptr : Tcl_GetStdChannel(which);
  if (channel == nullptr) return;
  Tcl_Obj* object = object_of(without_newline(text) + "\n");
  Tcl_IncrRefCount(object);
  Tcl_WriteObj(channel, object);
  Tcl_DecrRefCount(object);
  Tcl_Flush(channel);
}

/// A copy of what an array's element holds: a second INI file adds its values.
Tcl_Obj* values_so_far(Tcl_Interp* interpreter, const std::string& section,
                       const std::string& key) {
  Tcl_Obj* old = Tcl_GetVar2Ex(interpreter, section.c_str(), key.c_str(), TCL_GLOBAL_ONLY);
  return old != nullptr ? Tcl_DuplicateObj(old) : Tcl_NewListObj(0, nullptr);
}

/// loadrt's words as halcmd would have them: the list `$::KINS(KINEMATICS)` is "{trivkins coordinates=xyz}" when the value has
/// a blank, and no module's name has one; quotes around values go.
std::vector<std::string> loadrt_words(const std::vector<std::string>& words) {
  std::vector<std::string> out{words[0]};
  for (std::size_t i = 1; i < words.size(); ++i) {
    std::string word = words[i];
    if (i == 1 && word.size() > 2 && word.front() == '{' && word.back() == '}')
      word = word.substr(1, word.size() - 2);
    if (i == 1) {
      if (auto parts = split_words(unquoted(word)); parts.ok()) {
        for (const auto& part : *parts) out.push_back(part);
        continue;
      }
    }
    out.push_back(unquoted(word));
  }
  return out;
}

}  // namespace

/// Keeps what a command says.
class TclHal::Sink final : public CommandSink {
 public:
  void out(std::string_view text) override { (printing ? printed : said) += text; }
  void err(std::string_view text) override { said += text; }
  void complaint(const std::string& file, int line, std::string_view text) override {
    const std::size_t before = said.size();
    if (placing) said += Place{file, line}.text() + ": ";
    remark(file, line, text);
    complaints += said.substr(before);
  }
  void remark(const std::string& /*file*/, int /*line*/, std::string_view text) override {
    said += text;
    said += '\n';
  }
  void begin(bool prints, bool places = false) {
    printing = prints;
    placing = places;
    said.clear();
    complaints.clear();
    printed.clear();
  }
  bool printing{false};  ///< for stdout
  bool placing{false};   ///< messages with file and line
  std::string said, complaints, printed;
};

/// What a Tcl command of ours is.
struct TclHal::Command {
  TclHal* self;
  enum class Kind { hal, word, expression, source, unload, after, parse_ini } kind;
  std::string word;
  Tcl_ObjCmdProc* before{nullptr};  ///< Tcl's own command of that name
  void* before_data{nullptr};
};

TclHal::TclHal(Attach attach)
    : attach_(std::move(attach)),
      sink_(std::make_unique<Sink>()),
      loads_([this](const std::string& module) -> std::optional<std::vector<std::string>> {
        const auto attached = attachment();
        if (!attached.ok()) return std::nullopt;
        return list_parameters(*attached->session, module);
      }) {}
TclHal::~TclHal() = default;

void TclHal::install(Tcl_Interp* interpreter) {
  using Kind = Command::Kind;
  const auto add = [&](const char* name, Kind kind) {
    auto* command = new Command{this, kind, name};
    Tcl_CmdInfo info;
    if (Tcl_GetCommandInfo(interpreter, name, &info) != 0 && info.isNativeObjectProc != 0) {
      command->before = info.objProc;
      command->before_data = info.objClientData;
    }
    Tcl_CreateObjCommand(interpreter, name, &TclHal::call, command,
                         [](void* data) { delete static_cast<Command*>(data); });
  };
  add("hal", Kind::hal);
  add("parse_ini", Kind::parse_ini);
  for (const char* name : kCommands) {
    const bool expression = std::string_view(name) == "setp" || std::string_view(name) == "sets";
    add(name, expression ? Kind::expression : Kind::word);
  }
  add(kShared[0], Kind::source);
  add(kShared[1], Kind::unload);
  if (after_on_clock_) add("after", Kind::after);
}

int TclHal::call(void* data, Tcl_Interp* interpreter, int count, Tcl_Obj* const words[]) {
  const auto& command = *static_cast<const Command*>(data);
  return command.self->call_word(interpreter, command, count, words);
}

int TclHal::call_word(Tcl_Interp* interpreter, const Command& command, int count,
                      Tcl_Obj* const* words) {
  using Kind = Command::Kind;
  std::vector<std::string> texts;
  texts.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) texts.push_back(text_of(words[i]));
  texts[0] = command.word;  // it may have been called by another name, such as ::net
  switch (command.kind) {
    case Kind::hal: {
      if (count < 2) {
        Tcl_WrongNumArgs(interpreter, 1, words, "command ...");
        return TCL_ERROR;
      }
      texts.erase(texts.begin());
      if (texts[0] == "--commands") {
        std::string names;
        for (const auto& name : Commander::command_names())
          if (name != "quit" && name != "exit") names += (names.empty() ? "" : " ") + name;
        Tcl_SetObjResult(interpreter, object_of(names));
        return TCL_OK;
      }
      if (texts[0] == "quit" || texts[0] == "exit") return Tcl_Eval(interpreter, "exit");
      return finish(interpreter, skip_or_run(std::move(texts), place(interpreter), true));
    }
    case Kind::expression: {
      if (count != 3) {
        Tcl_WrongNumArgs(interpreter, 1, words, "p v");
        return TCL_ERROR;
      }
      if (pass_ == Pass::collect) return TCL_OK;
      Tcl_Obj* value = nullptr;
      if (Tcl_ExprObj(interpreter, words[2], &value) != TCL_OK) return TCL_ERROR;
      texts[2] = text_of(value);
      Tcl_DecrRefCount(value);
      break;
    }
    case Kind::source:
      if (count != 2 || !ends_with(texts[1], ".hal"))
        return command.before(command.before_data, interpreter, count, words);
      break;
    case Kind::unload:
      // A library has a path or an ending; a component has neither.
      if (count != 2 || texts[1].find('/') != std::string::npos || ends_with(texts[1], ".so") ||
          texts[1].front() == '-')
        return command.before(command.before_data, interpreter, count, words);
      break;
    case Kind::after: {
      long milliseconds = 0;
      const bool plain =
          count == 2 && Tcl_GetLongFromObj(nullptr, words[1], &milliseconds) == TCL_OK;
      const auto attached = plain ? attachment() : Result<Attachment>(Attachment{});
      if (!attached.ok() || attached->clock == nullptr || !attached->clock->is_virtual())
        return command.before(command.before_data, interpreter, count, words);
      return wait_ms(interpreter, *attached->clock, milliseconds);
    }
    case Kind::parse_ini: {
      if (count != 2) {
        Tcl_WrongNumArgs(interpreter, 1, words, "filename");
        return TCL_ERROR;
      }
      const auto loaded = ini::IniFile::load(texts[1]);
      if (loaded.ok) return set_ini_arrays(interpreter, loaded.file);
      std::string all;
      for (const auto& d : loaded.diagnostics) all += d.message() + "\n";
      return finish(interpreter, {false, without_newline(all), ""});
    }
    case Kind::word: break;
  }
  return finish(interpreter, skip_or_run(std::move(texts), place(interpreter), false));
}

int TclHal::wait_ms(Tcl_Interp* interpreter, rtapi::WaitClock& clock, long milliseconds) {
  const rtapi::Nanos until = clock.now() + milliseconds * rtapi::kMillisecond;
  busy_ = true;
  while (clock.now() < until && !clock.stopped()) {
    rtapi::WaitSpec spec;
    spec.wake_at(until);
    clock.wait(spec);
  }
  busy_ = false;
  if (!clock.stopped()) return TCL_OK;
  return finish(interpreter, {false, "after: stopped", ""});
}

int TclHal::finish(Tcl_Interp* interpreter, const Outcome& outcome) {
  print(TCL_STDOUT, outcome.printed);
  print(TCL_STDERR, outcome.warnings);
  Tcl_SetObjResult(interpreter, object_of(outcome.result));
  if (outcome.ok) return TCL_OK;
  Tcl_SetErrorCode(interpreter, "HAL", nullptr);
  return TCL_ERROR;
}

TclHal::Outcome TclHal::skip_or_run(std::vector<std::string> words, const Place& at,
                                    bool prefixed) {
  const std::string word = words[0];
  const bool loads = word == "loadrt" || word == "loadusr";
  const bool left_to_reader = pass_ != Pass::single || observer_.intercept;
  if (word == "source" && words.size() == 2 && left_to_reader && read_hal_file_) {
    if (const Status done = read_hal_file_(words[1]); !done.ok())
      return {false, done.error().message(), ""};
    return {};
  }
  if (word == "loadrt") words = loadrt_words(words);
  if (pass_ == Pass::execute && loads) return {};
  if (pass_ == Pass::collect) {
    if (word == "loadrt") {
      const std::span<const std::string> all(words);
      if (const Status added = loads_.add(all.subspan(1), at); !added.ok())
        return {false, added.error().message(), ""};
      return {};
    }
    if (word != "loadusr" && !(prefixed && is_one_of(kReading, word))) return {};
  }
  return run(words, at, prefixed);
}

Place TclHal::place(Tcl_Interp* interpreter) const {
  return pass_ == Pass::collect || observer_.intercept ? script_place(interpreter) : Place{};
}

TclHal::Outcome TclHal::run(const std::vector<std::string>& words, const Place& at,
                            bool as_result) {
  auto halcmd = commander();
  if (!halcmd.ok()) return {false, halcmd.error().message(), ""};
  if (words[0] == "source" && words.size() == 2) return source(words[1]);
  // What a program prints comes after what the script has printed.
  if (words[0] == "loadusr")
    if (Tcl_Channel out = Tcl_GetStdChannel(TCL_STDOUT); out != nullptr) Tcl_Flush(out);
  sink_->begin(!as_result && is_one_of(kPrinting, words[0]));
  (*halcmd)->set_level(Commander::Level::verbose);
  busy_ = true;
  const bool good = (*halcmd)->run_exact(words, at.file.empty() ? "<tcl>" : at.file, at.line);
  busy_ = false;
  Outcome outcome{good, without_newline(good ? sink_->said : sink_->complaints), sink_->printed};
  if (!good && observer_.failed && observer_.failed(outcome.result, at)) return {};
  return outcome;
}

TclHal::Outcome TclHal::source(const std::string& path) {
  if (::access(path.c_str(), R_OK) != 0)
    return {false, "cannot read HAL file '" + path + "': " + std::strerror(errno), ""};
  sink_->begin(true, true);
  commander_->set_level(Commander::Level::errors);
  commander_->set_ini(ini_);
  busy_ = true;
  const bool good = commander_->run_file(path);
  busy_ = false;
  Outcome outcome{good, "", std::move(sink_->printed)};
  // Nobody looks at the result of a script that has gone well.
  (good ? outcome.warnings : outcome.result) = without_newline(std::move(sink_->said));
  return outcome;
}

Result<Attachment> TclHal::attachment() {
  if (attached_.session == nullptr) {
    KERF_TRY(attached_, attach_());
  }
  return attached_;
}

void TclHal::set_clock(rtapi::WaitClock* clock) {
  attached_.clock = clock;
  if (commander_) commander_->set_clock(clock);
}

Result<Commander*> TclHal::commander() {
  if (!commander_) {
    KERF_TRY(const Attachment attached, attachment());
    commander_ = std::make_unique<Commander>(*attached.session, ini_, sink_.get());
    commander_->set_clock(attached.clock);
    if (observer_.intercept) commander_->set_interceptor(observer_.intercept);
  }
  return commander_.get();
}

int TclHal::set_ini_arrays(Tcl_Interp* interpreter, const ini::IniFile& file) {
  for (const auto& section : file.sections()) {
    std::vector<std::pair<std::string, Tcl_Obj*>> lists;
    std::map<std::string, std::size_t> known;
    for (const ini::Entry* entry : file.variables(section)) {
      const auto [at, is_new] = known.try_emplace(entry->key, lists.size());
      if (is_new) lists.emplace_back(entry->key, values_so_far(interpreter, section, entry->key));
      Tcl_ListObjAppendElement(nullptr, lists[at->second].second, object_of(entry->value));
    }
    for (auto& [key, list] : lists) {
      if (Tcl_SetVar2Ex(interpreter, section.c_str(), key.c_str(), list,
                        TCL_GLOBAL_ONLY | TCL_LEAVE_ERR_MSG) == nullptr)
        return TCL_ERROR;
    }
  }
  return TCL_OK;
}

Place script_place(Tcl_Interp* interpreter) {
  // The state is kept: asking must not change errorInfo or the result of the script.
  Tcl_InterpState state = Tcl_SaveInterpState(interpreter, TCL_OK);
  Place place;
  // Tcl makes the names of files absolute; users know the ones they wrote.
  static constexpr const char* kAsk =
      "apply {{} {for {set i [info frame]} {$i > 0} {incr i -1} {set f [info frame $i]; "
      "if {[dict get $f type] ne {source}} continue; set file [dict get $f file]; "
      "if {$file eq [file normalize [info script]]} {set file [info script]}; "
      "return [list $file [dict get $f line]]}}}";
  if (Tcl_EvalEx(interpreter, kAsk, -1, TCL_EVAL_GLOBAL) == TCL_OK) {
    int size = 0;
    Tcl_Obj** parts = nullptr;
    if (Tcl_ListObjGetElements(nullptr, Tcl_GetObjResult(interpreter), &size, &parts) == TCL_OK &&
        size == 2) {
      place.file = text_of(parts[0]);
      Tcl_GetIntFromObj(nullptr, parts[1], &place.line);
    }
  }
  Tcl_RestoreInterpState(interpreter, state);
  return place;
}

}  // namespace kerf::hal::tcl
