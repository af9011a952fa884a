#include "hal/cmd/commander.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "hal/cmd/json.hpp"
#include "hal/cmd/show.hpp"
#include "hal/core/value_text.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

void CommandSink::out(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}
void CommandSink::err(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); }
void CommandSink::remark(const std::string& file, int line, std::string_view text) {
  err(file + ":" + std::to_string(line) + ": " + std::string(text) + "\n");
}
void CommandSink::complaint(const std::string& file, int line, std::string_view text) {
  err(file + ":" + std::to_string(line) + ": " + std::string(text) + "\n");
}

namespace {
constexpr std::size_t kAny = SIZE_MAX;
constexpr int kDeepestSource = 20;
constexpr const char* kDeadWriter =
    "the realtime host died while it changed HAL: nothing can be read";
std::string quoted(std::string_view s) { return "'" + std::string(s) + "'"; }
bool is_arrow(std::string_view w) { return w == "=>" || w == "<=" || w == "<=>"; }
}  // namespace

struct Commander::Row {
  const char* name;
  std::size_t min;
  std::size_t max;
  bool arrows;  ///< =>, <= and <=> are taken out
  Done (Commander::*run)(Words w);
  const char* usage;
  const char* help;
};

std::span<const Commander::Row> Commander::rows() {
  static constexpr Row kRows[] = {
      {"loadrt", 1, kAny, false, &Commander::load_realtime, "loadrt NAME [PARAMETER=VALUE ...]",
       "Loads a realtime component."},
      {"loadusr", 1, kAny, false, &Commander::load_user,
       "loadusr [-W | -Wn NAME | -w [-i]] PROGRAM [ARGUMENT ...]",
       "Starts a program. -W waits until its component is ready, -Wn gives that component's name, "
       "-w "
       "waits for the end of the "
       "program, -i ignores its exit status."},
      {"waitusr", 1, 1, false, &Commander::wait_user, "waitusr NAME",
       "Waits until a user component has left HAL."},
      {"unload", 1, 1, false, &Commander::unload, "unload NAME | all",
       "Unloads a component of either kind."},
      {"unloadrt", 1, 1, false, &Commander::unload_realtime, "unloadrt NAME | all",
       "Unloads a realtime component."},
      {"unloadusr", 1, 1, false, &Commander::unload_user, "unloadusr NAME | all",
       "Asks a user component to end."},
      {"lock", 0, 1, false, &Commander::forward, "lock [none | tune | all]",
       "Forbids changes of HAL."},
      {"unlock", 0, 1, false, &Commander::forward, "unlock [tune | all]",
       "Allows changes of HAL again."},
      {"net", 1, kAny, true, &Commander::net, "net SIGNAL PIN ...",
       "Links pins to a signal, which is made if need be. All pins are linked or none."},
      {"linkpp", 2, 2, true, &Commander::link_pins, "linkpp PIN PIN",
       "Links two pins by a signal named as the first."},
      {"linkps", 2, 2, true, &Commander::link, "linkps PIN SIGNAL", "Links a pin to a signal."},
      {"linksp", 2, 2, true, &Commander::link, "linksp SIGNAL PIN", "Links a signal to a pin."},
      {"unlinkp", 1, 1, false, &Commander::forward, "unlinkp PIN",
       "Takes a pin off its signal; it keeps the value."},
      {"newsig", 2, 2, false, &Commander::forward, "newsig SIGNAL TYPE", "Makes a signal."},
      {"delsig", 1, 1, false, &Commander::forward, "delsig SIGNAL",
       "Deletes a signal; its pins are unlinked."},
      {"setp", 2, 2, false, &Commander::set_item, "setp NAME VALUE, or NAME = VALUE",
       "Sets a writable parameter or an unlinked input pin."},
      {"getp", 1, 1, false, &Commander::get_item, "getp NAME",
       "Prints the value of a parameter or pin."},
      {"ptype", 1, 1, false, &Commander::item_type, "ptype NAME",
       "Prints the type of a parameter or pin."},
      {"sets", 2, 2, false, &Commander::forward, "sets SIGNAL VALUE",
       "Sets a signal that no pin writes."},
      {"gets", 1, 1, false, &Commander::get_signal, "gets SIGNAL", "Prints the value of a signal."},
      {"stype", 1, 1, false, &Commander::signal_type, "stype SIGNAL",
       "Prints the type of a signal."},
      {"addf", 2, 3, false, &Commander::forward, "addf FUNCTION THREAD [POSITION]",
       "Adds a function to a thread: at the end, at a position from the front (1, 2 ...) or from "
       "the "
       "end (-1, -2 ...)."},
      {"delf", 2, 2, false, &Commander::forward, "delf FUNCTION THREAD",
       "Takes a function out of a thread."},
      {"show", 0, kAny, false, &Commander::show,
       "show [comp | pin | sig | param | funct | thread | alias | all] [PATTERN ...]",
       "Prints items of HAL, all or those that match."},
      {"list", 1, kAny, false, &Commander::list,
       "list comp | pin | sig | param | funct | thread [PATTERN ...]", "Prints names on one line."},
      {"status", 0, 1, false, &Commander::status, "status [lock | mem | all]",
       "Prints the state of HAL itself."},
      {"start", 0, 0, false, &Commander::forward, "start",
       "Lets the realtime threads run their functions."},
      {"stop", 0, 0, false, &Commander::forward, "stop",
       "Stops the functions of the realtime threads."},
      {"source", 1, 1, false, &Commander::source, "source FILE",
       "Does the commands of another file."},
      {"sleep", 1, 1, false, &Commander::sleep, "sleep SECONDS",
       "Waits; on the virtual clock, virtual seconds."},
      {"echo", 0, 0, false, &Commander::echo_on, "echo", "Prints commands before they are done."},
      {"unecho", 0, 0, false, &Commander::echo_off, "unecho", "Ends echo."},
      {"print", 0, 1, false, &Commander::print, "print [MESSAGE]",
       "Prints file, line and a message."},
      {"debug", 1, 1, false, &Commander::debug, "debug LEVEL",
       "Sets the level of messages, 0 to 5."},
      {"help", 0, 1, false, &Commander::help, "help [COMMAND]", "Explains commands."},
      {"quit", 0, 0, false, &Commander::quit, "quit", "Ends the reading of commands."},
      {"exit", 0, 0, false, &Commander::quit, "exit", "Ends the reading of commands."},
  };
  return kRows;
}

Commander::Commander(Session& session, IniLookup ini, CommandSink* sink)
    : session_(session),
      ini_(std::move(ini)),
      sink_(sink != nullptr ? sink : &default_sink_),
      view_(session.segment()) {}

std::vector<std::string> Commander::command_names() {
  std::vector<std::string> out;
  for (const Row& row : rows()) out.emplace_back(row.name);
  return out;
}

std::string Commander::help_text(std::string_view command) {
  std::string out;
  for (const Row& row : rows()) {
    if (command.empty()) {
      out += "  " + std::string(row.name) +
             std::string(12 - std::min<std::size_t>(11, std::strlen(row.name)), ' ') + row.help +
             "\n";
    } else if (command == row.name) {
      return std::string(row.usage) + "\n  " + row.help + "\n";
    }
  }
  if (command.empty()) return out;
  return "No help for unknown command " + quoted(command) + "\n";
}

// ---- reading ------------------------------------------------------------------------------------

struct Commander::LineJoiner {
  std::string text;
  int first_line{0};
  /// True when `text` is whole.
  bool add(std::string_view line, int number) {
    if (first_line == 0) first_line = number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!line.empty() && line.back() == '\\') {
      text += line.substr(0, line.size() - 1);
      text += ' ';
      return false;
    }
    text += line;
    return true;
  }
  void clear() {
    text.clear();
    first_line = 0;
  }
};

bool Commander::run_text(std::string_view text, const std::string& name) {
  bool good = true;
  LineJoiner joiner;
  int number = 0;
  while (!text.empty() && !quit_ && !stopped()) {
    const auto end = std::min(text.find('\n'), text.size());
    const bool whole = joiner.add(text.substr(0, end), ++number);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!whole && !text.empty()) continue;
    good = run_line(joiner.text, name, joiner.first_line) && good;
    joiner.clear();
    if (!good && !keep_going_) return false;
  }
  return good;
}

bool Commander::run_file(const std::string& path) {
  const bool is_stdin = path == "-";
  std::FILE* f = is_stdin ? stdin : std::fopen(path.c_str(), "re");
  if (f == nullptr) {
    report("Could not open hal file " + quoted(path) + ": " + std::strerror(errno));
    return false;
  }
  const std::string name = is_stdin ? "<stdin>" : path;
  bool good = true;
  LineJoiner joiner;
  int number = 0;
  char* buffer = nullptr;
  std::size_t capacity = 0;
  ssize_t n = 0;
  // Line by line: stdin may be a pipe whose writer waits for answers.
  while (!quit_ && !stopped() && (n = ::getline(&buffer, &capacity, f)) >= 0) {
    std::string_view line(buffer, static_cast<std::size_t>(n));
    if (!line.empty() && line.back() == '\n') line.remove_suffix(1);
    if (!joiner.add(line, ++number)) continue;
    good = run_line(joiner.text, name, joiner.first_line) && good;
    joiner.clear();
    if (!good && !keep_going_) break;
  }
  if (!joiner.text.empty() && (good || keep_going_))
    good = run_line(joiner.text, name, joiner.first_line) && good;
  std::free(buffer);  // NOLINT(cppcoreguidelines-no-malloc): getline's
  if (!is_stdin) std::fclose(f);
  return good;
}

bool Commander::run_line(std::string_view line, const std::string& file, int line_number) {
  const std::string old_file = std::exchange(file_, file);
  const int old_line = std::exchange(line_, line_number);
  bool good = false;
  auto text = substitute(without_comment(line), ini_);
  if (!text.ok()) {
    report(text.error().message());
  } else if (auto words = split_words(*text); !words.ok()) {
    report(words.error().message());
  } else {
    // print shows its message as it was written, with the quotes.
    if (words->empty() || words->front() != "print") {
      for (auto& word : *words) word = unquoted(word);
    }
    if (echo_ && !words->empty()) sink_->err(*text + "\n");
    good = run(std::move(*words));
  }
  file_ = old_file;
  line_ = old_line;
  return good;
}

bool Commander::run_words(Words words) {
  std::vector<std::string> out;
  for (const auto& word : words) {
    auto text = substitute(word, ini_);
    if (!text.ok()) {
      report(text.error().message());
      return false;
    }
    out.push_back(std::move(*text));
  }
  return run(std::move(out));
}

bool Commander::run_exact(std::vector<std::string> words, const std::string& file,
                          int line_number) {
  const std::string old_file = std::exchange(file_, file);
  const int old_line = std::exchange(line_, line_number);
  const bool good = run(std::move(words));
  file_ = old_file;
  line_ = old_line;
  return good;
}

bool Commander::run(std::vector<std::string> words) {
  if (words.empty()) return true;
  if (words.size() == 3 && words[1] == "=") words = {"setp", words[0], words[2]};
  if (interceptor_) {
    if (const auto done = interceptor_(words, file_, line_); done) {
      if (!done->ok() && done->error().code != Errc::ok) report(done->error().message());
      return done->ok();
    }
  }
  for (const Row& row : rows()) {
    if (words[0] != row.name) continue;
    if (row.arrows) std::erase_if(words, [](const std::string& w) { return is_arrow(w); });
    const std::size_t given = words.size() - 1;
    Status done;
    if (given < row.min || given > row.max) {
      const std::string least = row.min == row.max ? ""
                                : given < row.min  ? "at least "
                                                   : "at most ";
      done = fail(Errc::bad_argument, words[0] + " requires " + least +
                                          std::to_string(given < row.min ? row.min : row.max) +
                                          " arguments, " + std::to_string(given) + " given");
    } else {
      done = (this->*row.run)(words);
    }
    if (done.ok()) return true;
    if (done.error().code != Errc::ok) report(done.error().message());
    return false;
  }
  report("Unknown command " + quoted(words[0]) + rtapi::did_you_mean(words[0], command_names()));
  return false;
}

void Commander::report(const std::string& text) {
  last_error_ = text;
  error(text);
}

void Commander::error(const std::string& text) {
  if (level_ == Level::silent) return;
  if (json_) return sink_->err(error_json(file_, line_, text));
  sink_->complaint(file_, line_, text);
}

void Commander::say(const std::string& text) {
  if (level_ < Level::verbose) return;
  sink_->remark(file_, line_, text);
}

// ---- commands of the host -----------------------------------------------------------------------

Status Commander::ask_host(Words w) {
  auto reply = session_.request(w);
  if (!reply.ok()) {
    return fail(reply.error().code,
                "the realtime host does not answer: " + reply.error().message());
  }
  if (!reply->ok()) return fail(static_cast<Errc>(reply->status), reply->text);
  return {};
}

std::string Commander::done_text(Words w) const {
  const std::string& c = w[0];
  if (c == "start") return "Realtime threads started";
  if (c == "stop") return "Realtime threads stopped";
  if (c == "addf") return "Function " + quoted(w[1]) + " added to thread " + quoted(w[2]);
  if (c == "delf") return "Function " + quoted(w[1]) + " removed from thread " + quoted(w[2]);
  if (c == "unlinkp") return "Pin " + quoted(w[1]) + " unlinked";
  if (c == "newsig") return "Signal " + quoted(w[1]) + " created";
  if (c == "delsig") return "Signal " + quoted(w[1]) + " deleted";
  if (c == "sets") return "Signal " + quoted(w[1]) + " set to " + w[2];
  if (c == "linkps") return "Pin " + quoted(w[1]) + " linked to signal " + quoted(w[2]);
  if (c == "linksp") return "Pin " + quoted(w[2]) + " linked to signal " + quoted(w[1]);
  return {};
}

Status Commander::forward(Words w) {
  KERF_CHECK(ask_host(w));
  if (const auto text = done_text(w); !text.empty()) say(text);
  return {};
}

Status Commander::link(Words w) { return forward(w); }

Status Commander::link_pins(Words w) {
  error("Warning: linkpp command is deprecated, use 'net'");
  return forward(w);
}

Status Commander::net(Words w) {
  KERF_CHECK(ask_host(w));
  for (std::size_t i = 2; i < w.size(); ++i)
    say("Pin " + quoted(w[i]) + " linked to signal " + quoted(w[1]));
  return {};
}

Status Commander::load_realtime(Words w) {
  KERF_CHECK(ask_host(w));
  say("Realtime module " + quoted(w[1]) + " loaded");
  return {};
}

Status Commander::unload_realtime(Words w) {
  KERF_CHECK(ask_host(w));
  say("Realtime module " + quoted(w[1]) + " unloaded");
  return {};
}

Status Commander::set_item(Words w) {
  KERF_CHECK(ask_host(w));
  const bool param = level_ >= Level::verbose && view_.find_param(w[1]).has_value();
  say(std::string(param ? "Parameter " : "Pin ") + quoted(w[1]) + " set to " + w[2]);
  return {};
}

// ---- reading values -----------------------------------------------------------------------------

Result<ItemInfo> Commander::find_item(const std::string& name) const {
  if (auto item = view_.find_item(name)) return *item;
  if (view_.stuck()) return fail(Errc::dead, kDeadWriter);
  auto known = view_.names(Kind::pin);
  const auto params = view_.names(Kind::param);
  known.insert(known.end(), params.begin(), params.end());
  return fail(Errc::not_found,
              "pin or parameter " + quoted(name) + " not found" + rtapi::did_you_mean(name, known));
}

Result<SignalInfo> Commander::find_signal(const std::string& name) const {
  if (auto signal = view_.find_signal(name)) return *signal;
  if (view_.stuck()) return fail(Errc::dead, kDeadWriter);
  return fail(Errc::not_found, "signal " + quoted(name) + " not found" +
                                   rtapi::did_you_mean(name, view_.names(Kind::signal)));
}

Status Commander::get_item(Words w) {
  KERF_TRY(const ItemInfo item, find_item(w[1]));
  sink_->out(json_ ? value_json(item.name, item.type, item.raw)
                   : plain_value_text(item.type, item.raw) + "\n");
  return {};
}

Status Commander::item_type(Words w) {
  KERF_TRY(const ItemInfo item, find_item(w[1]));
  sink_->out(json_ ? type_json(item.name, item.type) : std::string(type_name(item.type)) + "\n");
  return {};
}

Status Commander::get_signal(Words w) {
  KERF_TRY(const SignalInfo signal, find_signal(w[1]));
  sink_->out(json_ ? value_json(signal.name, signal.type, signal.raw)
                   : plain_value_text(signal.type, signal.raw) + "\n");
  return {};
}

Status Commander::signal_type(Words w) {
  KERF_TRY(const SignalInfo signal, find_signal(w[1]));
  sink_->out(json_ ? type_json(signal.name, signal.type)
                   : std::string(type_name(signal.type)) + "\n");
  return {};
}

Status Commander::show(Words w) {
  const Words patterns = w.size() > 2 ? w.subspan(2) : Words{};
  const std::string item = w.size() > 1 ? w[1] : "";
  KERF_TRY(const std::string text,
           json_ ? show_json(view_, item, patterns) : show_text(view_, item, patterns, script_));
  sink_->out(text);
  return {};
}

Status Commander::list(Words w) {
  KERF_TRY(const std::string text,
           json_ ? list_json(view_, w[1], w.subspan(2)) : list_text(view_, w[1], w.subspan(2)));
  sink_->out(text);
  return {};
}

Status Commander::status(Words w) {
  const std::string item = w.size() > 1 ? w[1] : "";
  KERF_TRY(const std::string text, json_ ? status_json(view_, item) : status_text(view_, item));
  sink_->out(text);
  return {};
}

// ---- the rest -----------------------------------------------------------------------------------

Status Commander::source(Words w) {
  if (depth_ >= kDeepestSource)
    return fail(Errc::bad_argument, "source is nested too deep; does a file source itself?");
  ++depth_;
  const bool good = run_file(w[1]);
  --depth_;
  // The reason has been reported with its own place.
  if (!good) return fail(Errc::ok, "");
  return {};
}

Status Commander::print(Words w) {
  error("HALCMD MSG: " + (w.size() > 1 ? w[1] : std::string()));
  return {};
}

Status Commander::echo_on(Words /*w*/) {
  echo_ = true;
  return {};
}

Status Commander::echo_off(Words /*w*/) {
  echo_ = false;
  return {};
}

Status Commander::help(Words w) {
  sink_->out(help_text(w.size() > 1 ? w[1] : ""));
  return {};
}

Status Commander::quit(Words /*w*/) {
  quit_ = true;
  return {};
}

Status Commander::debug(Words w) {
  auto level = parse_value(Type::u32, w[1]);
  if (!level.ok() || *level > 5)
    return fail(Errc::bad_argument, "debug level " + quoted(w[1]) + " is not 0 to 5");
  return {};
}

}  // namespace kerf::hal
