#include "hal/tcl/check_tcl.hpp"

#include <tcl.h>

#include <cstdlib>

#include "hal/tcl/script.hpp"
#include "hal/tcl/tcl_hal.hpp"

namespace kerf::hal {

using rtapi::Result;
using rtapi::Status;

namespace {

/// A script that waits for a value which only a running machine would give never ends.
constexpr int kMostSeconds = 10;
constexpr int kMostCommands = 2'000'000;

/// An error within `catch` or `try` is the script's own business.
constexpr const char* kPrelude = R"tcl(
namespace eval ::kerf_check {
  variable depth 0
  variable ended 0
}
proc exec args {}
proc socket args {error "socket: a check opens no connections"}
proc puts args {}
proc flush args {}
proc after args {}
proc vwait args {}
proc exit {{status 0}} {set ::kerf_check::ended 1; error "exit"}
rename open ::kerf_check::open
proc open {name {access r} args} {
  if {[string index $name 0] eq "|" || $access ni {r rb RDONLY}} {error "open $name: a check writes no files"}
  ::kerf_check::open $name $access {*}$args
}
rename file ::kerf_check::file
proc file {what args} {
  if {$what in {delete rename copy mkdir link tempfile}} return
  uplevel 1 [list ::kerf_check::file $what {*}$args]
}
rename catch ::kerf_check::catch
proc catch args {
  incr ::kerf_check::depth
  set code [uplevel 1 [list ::kerf_check::catch {*}$args]]
  incr ::kerf_check::depth -1
  return $code
}
rename try ::kerf_check::try
proc try args {
  incr ::kerf_check::depth
  ::kerf_check::catch {uplevel 1 [list ::kerf_check::try {*}$args]} result options
  incr ::kerf_check::depth -1
  return -options $options $result
}
)tcl";

bool is_true(Tcl_Interp* interpreter, const char* variable) {
  Tcl_Obj* value = Tcl_GetVar2Ex(interpreter, variable, nullptr, TCL_GLOBAL_ONLY);
  int number = 0;
  return value != nullptr && Tcl_GetIntFromObj(nullptr, value, &number) == TCL_OK && number > 0;
}

/// "FILE:LINE: message\n trace" as Interpreter::run_file gives it.
std::pair<ScriptPlace, std::string> place_and_text(const std::string& error,
                                                   const std::string& path) {
  const std::string line = error.substr(0, error.find('\n'));
  const auto first = line.find(':');
  const auto second = first == std::string::npos ? first : line.find(": ", first + 1);
  if (second == std::string::npos) return {{path, 0}, line};
  const std::string number = line.substr(first + 1, second - first - 1);
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos)
    return {{path, 0}, line};
  return {{line.substr(0, first), std::atoi(number.c_str())}, line.substr(second + 2)};
}

}  // namespace

struct ScriptCheck::TclFiles::State {
  State(ScriptCheck& owner, Session& session, const ini::IniFile* file)
      : check(owner), ini(file), words([&session]() -> Result<tcl::Attachment> {
          return tcl::Attachment{&session, nullptr};
        }) {
    if (ini != nullptr) words.set_ini(ini_lookup(*ini));
    words.set_hal_file_reader([this](const std::string& path) -> Status {
      check.run_file(path);
      return {};
    });
    tcl::TclHal::Observer observer;
    observer.intercept = [this](std::span<const std::string> w, const std::string& name, int line) {
      if (line > 0) check.enter(name);
      return check.command(w, {name, line});
    };
    observer.failed = [this](const std::string& text, const tcl::Place& at) {
      if (running != nullptr && is_true(running, "::kerf_check::depth")) return false;
      if (!text.empty()) check.add(Finding::Level::error, "command", {at.file, at.line}, text);
      return true;
    };
    words.set_observer(std::move(observer));
  }

  ScriptCheck& check;
  const ini::IniFile* ini;
  tcl::TclHal words;
  Tcl_Interp* running{nullptr};
};

ScriptCheck::TclFiles::TclFiles(ScriptCheck& check, Session& session, const ini::IniFile* ini)
    : state_(std::make_unique<State>(check, session, ini)) {}
ScriptCheck::TclFiles::~TclFiles() = default;

void ScriptCheck::TclFiles::run(const std::string& path,
                                const std::vector<std::string>& arguments) {
  State& s = *state_;
  auto made = tcl::Interpreter::create(s.words, s.ini);
  if (!made.ok())
    return s.check.add(Finding::Level::error, "tcl", {path, 0}, made.error().message());
  tcl::Interpreter& interpreter = **made;
  Tcl_Interp* const tcl = interpreter.tcl();
  interpreter.set_arguments("haltcl", arguments);
  if (s.check.pass_ != Pass::single)
    interpreter.set_pass_number(s.check.pass_ == Pass::gather ? 0 : 1);
  if (Tcl_Eval(tcl, kPrelude) != TCL_OK)
    return s.check.add(Finding::Level::error, "tcl", {path, 0}, Tcl_GetStringResult(tcl));
  Tcl_Time until;
  Tcl_GetTime(&until);
  until.sec += kMostSeconds;
  Tcl_LimitSetTime(tcl, &until);
  Tcl_LimitTypeSet(tcl, TCL_LIMIT_TIME);
  Tcl_LimitSetCommands(tcl, kMostCommands);
  Tcl_LimitTypeSet(tcl, TCL_LIMIT_COMMANDS);
  Tcl_Interp* const before = std::exchange(s.running, tcl);
  const auto result = interpreter.run_file(path);
  s.running = before;
  if (result.ok() || is_true(tcl, "::kerf_check::ended")) return;
  const bool endless = Tcl_LimitExceeded(tcl) != 0;
  auto [at, text] = place_and_text(result.error(), path);
  if (endless)
    text =
        "the script does not end in a check, which passes no time; what follows was not looked at";
  s.check.add(endless ? Finding::Level::warning : Finding::Level::error, "tcl", at, text);
}

}  // namespace kerf::hal
