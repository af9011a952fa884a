#include "hal/cmd/commander.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "hal/client/request_all.hpp"
#include "hal/cmd/json.hpp"
#include "hal/cmd/save.hpp"
#include "hal/cmd/show.hpp"
#include "hal/cmd/timing_table.hpp"
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
  out(file + ":" + std::to_string(line) + ": " + std::string(text) + "\n");
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
/// Commands that the host is asked for at once: so many fit one request with names and errors of the greatest length.
constexpr std::size_t kMostWaiting = 128;

/// Whether a component of ours would be seen.
bool shows_components(std::span<const std::string> w) {
  const bool all = w.size() < 2 || w[1] == "all";
  if (w[0] == "show") return all || w[1] == "comp";
  if (w[0] == "list") return !all && w[1] == "comp";
  if (w[0] == "status") return all || w[1] == "mem";
  return w[0] == "loadusr" || w[0] == "waitusr";
}
}  // namespace

struct Commander::Row {
  enum Flags : unsigned {
    arrows = 1,   ///< =>, <= and <=> are taken out
    batch = 2,    ///< only the host has to do with it: it may be sent together with others
    refused = 4,  ///< a reason from the host stands after "NAME failed: "
  };
  const char* name;
  std::size_t min;
  std::size_t max;
  unsigned flags;
  Done (Commander::*run)(Words w);
  const char* usage;
  const char* help;
  const char* failed{nullptr};  ///< the name in messages, where it is not the command's
};

std::span<const Commander::Row> Commander::rows() {
  constexpr unsigned kLink = Row::arrows | Row::batch | Row::refused;
  static constexpr Row kRows[] = {
      {"loadrt", 1, kAny, 0, &Commander::load_realtime, "loadrt NAME [PARAMETER=VALUE ...]",
       "Loads a realtime component."},
      {"loadusr", 1, kAny, 0, &Commander::load_user,
       "loadusr [-W | -Wn NAME | -w] [-i] PROGRAM [ARGUMENT ...]",
       "Starts a program. -W waits until its component is ready, -n gives that component's name, "
       "-w waits for the end of the program, -i ignores its exit status."},
      {"waitusr", 1, 1, 0, &Commander::wait_user, "waitusr NAME",
       "Waits until a user component has left HAL."},
      {"unload", 1, 1, 0, &Commander::unload, "unload NAME | all",
       "Unloads a component of either kind."},
      {"unloadrt", 1, 1, 0, &Commander::unload_realtime, "unloadrt NAME | all",
       "Unloads a realtime component."},
      {"unloadusr", 1, 1, 0, &Commander::unload_user, "unloadusr NAME | all",
       "Asks a user component to end."},
      {"lock", 0, 1, 0, &Commander::forward, "lock [none | tune | all]", "Forbids changes of HAL."},
      {"unlock", 0, 1, 0, &Commander::forward, "unlock [tune | all]",
       "Allows changes of HAL again."},
      {"net", 1, kAny, Row::arrows | Row::batch, &Commander::forward, "net SIGNAL PIN ...",
       "Links pins to a signal, which is made if need be. All pins are linked or none."},
      {"linkpp", 2, 2, Row::arrows | Row::refused, &Commander::link_pins, "linkpp PIN PIN",
       "Links two pins by a signal named as the first."},
      {"linkps", 2, 2, kLink, &Commander::forward, "linkps PIN SIGNAL", "Links a pin to a signal.",
       "link"},
      {"linksp", 2, 2, kLink, &Commander::forward, "linksp SIGNAL PIN", "Links a signal to a pin.",
       "link"},
      {"unlinkp", 1, 1, Row::batch | Row::refused, &Commander::forward, "unlinkp PIN",
       "Takes a pin off its signal; it keeps the value.", "unlink"},
      {"newsig", 2, 2, Row::refused, &Commander::new_signal, "newsig SIGNAL TYPE",
       "Makes a signal of type bit, float, s32, u32, s64, u64 or port."},
      {"delsig", 1, 1, Row::refused, &Commander::delete_signal, "delsig SIGNAL | all",
       "Deletes a signal; its pins are unlinked."},
      {"alias", 3, 3, Row::refused, &Commander::alias, "alias pin | param NAME ALIAS",
       "Gives a pin or a parameter a second name; both find it, show prints the new one."},
      {"unalias", 2, 2, Row::refused, &Commander::alias, "unalias pin | param NAME",
       "Takes the second name away."},
      {"setp", 2, 2, Row::batch, &Commander::forward, "setp NAME VALUE, or NAME = VALUE",
       "Sets a writable parameter or an unlinked input pin."},
      {"getp", 1, 1, 0, &Commander::get_item, "getp NAME",
       "Prints the value of a parameter or pin."},
      {"ptype", 1, 1, 0, &Commander::item_type, "ptype NAME",
       "Prints the type of a parameter or pin."},
      {"sets", 2, 2, Row::batch, &Commander::forward, "sets SIGNAL VALUE",
       "Sets a signal that no pin writes."},
      {"gets", 1, 1, 0, &Commander::get_signal, "gets SIGNAL", "Prints the value of a signal."},
      {"stype", 1, 1, 0, &Commander::signal_type, "stype SIGNAL", "Prints the type of a signal."},
      {"addf", 2, 3, Row::batch | Row::refused, &Commander::forward,
       "addf FUNCTION THREAD [POSITION]",
       "Adds a function to a thread: at the end, at a position from the front (1, 2 ...) or from "
       "the end (-1, -2 ...)."},
      {"delf", 2, 2, Row::batch | Row::refused, &Commander::forward, "delf FUNCTION THREAD",
       "Takes a function out of a thread."},
      {"show", 0, kAny, 0, &Commander::show,
       "show [comp | pin | pinexact | sig | param | funct | thread | alias | all] [PATTERN ...]",
       "Prints items of HAL: all, or those whose name begins with or matches a pattern; with "
       "pinexact, has to be equal to it. -tTYPE before the patterns of pin, sig and param takes "
       "those of one type."},
      {"list", 1, kAny, 0, &Commander::list,
       "list comp | pin | sig | param | funct | thread [PATTERN ...]", "Prints names on one line."},
      {"save", 0, 2, 0, &Commander::save,
       "save [comp | alias | sig | sigu | link | linka | net | neta | netl | netla | param | "
       "unconnectedinpins | thread | all | allu] [FILE]",
       "Prints commands that make HAL as it is. A final 'a' of link and net means arrows; sigu: "
       "signals without pins. all (default) is comp, alias, sigu, netla, param, thread; allu also "
       "the values of unconnected pins."},
      {"status", 0, 1, 0, &Commander::status, "status [lock | mem | all]",
       "Prints the state of HAL itself."},
      {"timing", 0, kAny, 0, &Commander::timing,
       "timing [PATTERN ...] | every | sampled | off | reset",
       "Prints what threads and functions cost, times each function in every cycle, in every 16th "
       "or never, or starts the figures anew."},
      {"start", 0, 0, Row::refused, &Commander::forward, "start",
       "Lets the realtime threads run their functions."},
      {"stop", 0, 0, Row::refused, &Commander::forward, "stop",
       "Stops the functions of the realtime threads."},
      {"source", 1, 1, 0, &Commander::source, "source FILE", "Does the commands of another file."},
      {"sleep", 1, 1, 0, &Commander::sleep, "sleep SECONDS",
       "Waits; on the virtual clock, virtual seconds."},
      {"echo", 0, 0, 0, &Commander::echo_on, "echo", "Prints commands before they are done."},
      {"unecho", 0, 0, 0, &Commander::echo_off, "unecho", "Ends echo."},
      {"print", 0, 1, 0, &Commander::print, "print [MESSAGE]",
       "Prints file, line and a message; one with blanks needs quotes."},
      {"debug", 1, 1, 0, &Commander::debug, "debug LEVEL",
       "Sets the level of messages: 0 none, 1 errors, 2 warnings, 3 information, 4 and 5 more."},
      {"setexact_for_test_suite_only", 0, 0, 0, &Commander::exact, "setexact_for_test_suite_only",
       "Does nothing: periods are exact. Only before the first thread."},
      {"help", 0, 1, 0, &Commander::help, "help [COMMAND]", "Explains commands."},
      {"quit", 0, 0, 0, &Commander::quit, "quit", "Ends the reading of commands."},
      {"exit", 0, 0, 0, &Commander::quit, "exit", "Ends the reading of commands."},
  };
  return kRows;
}

Commander::Commander(Session& session, IniLookup ini, CommandSink* sink)
    : session_(session),
      ini_(std::move(ini)),
      sink_(sink != nullptr ? sink : &default_sink_),
      view_(session.segment()) {}

Commander::~Commander() = default;

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
  return "No help for unknown command " + quoted(command) +
         rtapi::did_you_mean(command, command_names()) + "\n";
}

// ---- doing --------------------------------------------------------------------------------------

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
  const auto of_name = [](const std::string& name) {
    const auto all = rows();
    return std::find_if(all.begin(), all.end(), [&](const Row& r) { return name == r.name; });
  };
  auto row = of_name(words[0]);
  if (row == rows().end() && words.size() == 3 && words[1] == "=") {
    words = {"setp", words[0], words[2]};
    row = of_name(words[0]);
  }
  if (interceptor_) {
    if (const auto done = interceptor_(words, file_, line_); done) {
      if (!done->ok() && done->error().code != Errc::ok) report(done->error().message());
      return done->ok();
    }
  }
  if (row != rows().end()) {
    if ((row->flags & Row::arrows) != 0)
      std::erase_if(words, [](const std::string& w) { return is_arrow(w); });
    const std::size_t given = words.size() - 1;
    if (given >= row->min && given <= row->max) {
      // Whoever looks at each command, or wants each one's result told, gets them one by one.
      if (batched_ && (row->flags & Row::batch) != 0 && level_ <= Level::errors && !interceptor_) {
        waiting_.push_back({&*row, std::move(words), file_, line_});
        return waiting_.size() < kMostWaiting || settle();
      }
      const bool settled = settle();
      return (settled || keep_going_) && run_row(*row, words) && settled;
    }
  }
  const bool settled = settle();
  if (!settled && !keep_going_) return false;
  if (row == rows().end()) {
    report("Unknown command " + quoted(words[0]) + rtapi::did_you_mean(words[0], command_names()));
    return false;
  }
  const std::size_t given = words.size() - 1;
  const std::string least = row->min == row->max ? "" : given < row->min ? "at least " : "at most ";
  report(words[0] + " requires " + least + std::to_string(given < row->min ? row->min : row->max) +
         " arguments, " + std::to_string(given) + " given");
  return false;
}

bool Commander::run_row(const Row& row, Words words) {
  if (appear_ && shows_components(words)) std::exchange(appear_, {})();
  const Status done = (this->*row.run)(words);
  if (!done.ok() && done.error().code != Errc::ok) command_failed(row, done.error());
  return done.ok();
}

void Commander::command_failed(const Row& row, const rtapi::Error& error) {
  const std::string reason = error.message();
  const bool named =
      (row.flags & Row::refused) != 0 && error.code != Errc::syntax && error.code != Errc::dead;
  report(named ? std::string(row.failed != nullptr ? row.failed : row.name) + " failed: " + reason
               : reason);
}

bool Commander::settle() {
  if (waiting_.empty()) return true;
  const std::vector<Waiting> waiting = std::exchange(waiting_, {});
  const std::string old_file = file_;
  const int old_line = line_;
  const auto at = [&](const Waiting& command) {
    file_ = command.file;
    line_ = command.line;
  };
  bool good = true;
  if (waiting.size() == 1) {
    at(waiting[0]);
    good = run_row(*waiting[0].row, waiting[0].words);
  } else {
    std::vector<std::vector<std::string>> commands;
    commands.reserve(waiting.size());
    for (const auto& w : waiting) commands.push_back(w.words);
    const auto failures = request_all(session_, commands, keep_going_);
    if (!failures.ok()) {
      at(waiting[0]);
      good = false;
      // They went together: which of them was the last one is not known.
      report("the realtime host does not answer: " + failures.error().message() +
             "; a component may have crashed in one of the " + std::to_string(waiting.size()) +
             " commands from here to line " + std::to_string(waiting.back().line));
    } else {
      for (const auto& failure : *failures) {
        const Waiting& command = waiting[std::min(failure.index, waiting.size() - 1)];
        at(command);
        good = false;
        command_failed(*command.row,
                       fail(static_cast<Errc>(failure.reply.status), failure.reply.text).error);
      }
    }
  }
  file_ = old_file;
  line_ = old_line;
  return good;
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
                "the realtime host does not answer: " + reply.error().message() +
                    (reply.error().code == Errc::dead ? "; a component may have crashed" : ""));
  }
  if (!reply->ok()) return fail(static_cast<Errc>(reply->status), reply->text);
  return {};
}

std::string Commander::done_text(Words w) const {
  const std::string& c = w[0];
  const auto linked = [](const std::string& pin, const std::string& signal) {
    return "Pin " + quoted(pin) + " linked to signal " + quoted(signal);
  };
  if (c == "start") return "Realtime threads started";
  if (c == "stop") return "Realtime threads stopped";
  if (c == "lock") return "Locking completed";
  if (c == "unlock") return "Unlocking completed";
  if (c == "addf") return "Function " + quoted(w[1]) + " added to thread " + quoted(w[2]);
  if (c == "delf") return "Function " + quoted(w[1]) + " removed from thread " + quoted(w[2]);
  if (c == "unlinkp") return "Pin " + quoted(w[1]) + " unlinked";
  if (c == "delsig") return "Signal " + quoted(w[1]) + " deleted";
  if (c == "sets") return "Signal " + quoted(w[1]) + " set to " + w[2];
  if (c == "linkps") return linked(w[1], w[2]);
  if (c == "linksp") return linked(w[2], w[1]);
  if (c == "alias") return w[1] + " " + quoted(w[2]) + " aliased to " + quoted(w[3]);
  if (c == "unalias") return w[1] + " " + quoted(w[2]) + " unaliased";
  if (c == "setp") {
    const bool param = view_.find_param(w[1]).has_value();
    return std::string(param ? "Parameter " : "Pin ") + quoted(w[1]) + " set to " + w[2];
  }
  return {};
}

Status Commander::forward(Words w) {
  KERF_CHECK(ask_host(w));
  if (level_ < Level::verbose) return {};
  if (w[0] == "net") {
    for (std::size_t i = 2; i < w.size(); ++i)
      say("Pin " + quoted(w[i]) + " linked to signal " + quoted(w[1]));
  } else if (const auto text = done_text(w); !text.empty()) {
    say(text);
  }
  return {};
}

Status Commander::new_signal(Words w) {
  // The peer takes type names in any case.
  std::string type = w[2];
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (type_from_name(type) == Type::unspecified) {
    return fail(Errc::syntax, "Unknown signal type " + quoted(w[2]) +
                                  "; known are bit, float, s32, u32, s64, u64, port");
  }
  const std::string words[] = {w[0], w[1], type};
  return forward(words);
}

Status Commander::delete_signal(Words w) {
  if (w[1] != "all") return forward(w);
  for (const auto& name : view_.names(Kind::signal)) {
    const std::string words[] = {w[0], name};
    KERF_CHECK(forward(words));
  }
  return {};
}

Status Commander::link_pins(Words w) {
  error("Warning: linkpp command is deprecated, use 'net'");
  return forward(w);
}

Status Commander::alias(Words w) {
  if (w[1] != "pin" && w[1] != "param") {
    return fail(Errc::syntax,
                w[0] + " failed: the first word is pin or param, not " + quoted(w[1]));
  }
  return forward(w);
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

Status Commander::timing(Words w) {
  if (w.size() == 2 && (w[1] == "reset" || timing_mode_of(w[1]))) return forward(w);
  const Words patterns = w.subspan(1);
  KERF_TRY(const std::string text,
           json_ ? timing_json(view_, patterns) : timing_text(view_, patterns, script_));
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

Status Commander::save(Words w) {
  KERF_TRY(const std::string text, save_text(view_, w.size() > 1 ? w[1] : ""));
  if (w.size() < 3) {
    sink_->out(text);
    return {};
  }
  std::FILE* f = std::fopen(w[2].c_str(), "we");
  bool good = f != nullptr && std::fwrite(text.data(), 1, text.size(), f) == text.size();
  if (f != nullptr && std::fclose(f) != 0) good = false;
  if (!good)
    return fail(Errc::system,
                "Can't open 'save' destination " + quoted(w[2]) + "; " + std::strerror(errno));
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
  sink_->out("Echo on\n");
  return {};
}

Status Commander::echo_off(Words /*w*/) {
  echo_ = false;
  sink_->out("Echo off\n");
  return {};
}

/// The peer pretends that its base period was exact; ours is.
Status Commander::exact(Words /*w*/) {
  if (!view_.names(Kind::thread).empty()) {
    return fail(Errc::busy, "HAL_LIB: Cannot run 'setexact' after a thread has been created");
  }
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
  const auto level = parse_value(Type::s32, w[1]);
  if (!level.ok() || *level > 5)
    return fail(Errc::bad_argument, "Debug level must be >=0 and <= 5");
  return forward(w);
}

}  // namespace kerf::hal
