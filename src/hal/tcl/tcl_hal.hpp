// TclHal: halcmd's commands in a Tcl interpreter.
//
//   hal::tcl::TclHal words([&]() -> rtapi::Result<hal::tcl::Attachment> { return {{&session, clock}}; });
//   words.install(interpreter);                 // net, setp, hal ..., parse_ini
//
// Every documented word of halcmd is a Tcl command; `hal WORD ...` does any word, also those whose names are Tcl's own (list, gets,
// source, exit). A command's result is what it prints; show, save and help print to stdout, unless `hal` stands before them. A
// failed command is a Tcl error.
#pragma once

#include <tcl.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/cmd/commander.hpp"
#include "hal/tcl/loadrt_merge.hpp"
#include "ini/ini_file.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal::tcl {

/// What HAL commands work on; both outlive the TclHal.
struct Attachment {
  Session* session{nullptr};
  rtapi::WaitClock* clock{nullptr};  ///< nullptr: waiting commands are errors
};

/// What commands do while the HAL files of a machine are read twice ([HAL]TWOPASS).
enum class Pass {
  single,   ///< everything, at once: no TWOPASS
  collect,  ///< loadrt is kept for later, loadusr is done, and so is `hal list` and the like; the rest does nothing
  execute,  ///< loadrt and loadusr have been done; the rest is
};

/// A script's file and line at this moment, innermost; file "" when Tcl does not know.
Place script_place(Tcl_Interp* interpreter);

class TclHal {
 public:
  /// Called at the first command that needs HAL, and again after an error.
  using Attach = std::function<rtapi::Result<Attachment>()>;

  explicit TclHal(Attach attach);
  ~TclHal();
  TclHal(const TclHal&) = delete;
  TclHal& operator=(const TclHal&) = delete;

  /// Adds the commands to an interpreter, which must not outlive this object.
  void install(Tcl_Interp* interpreter);
  /// `after MS` waits on the clock of the attachment, so that virtual time passes. Before install(); for programs that join the clock.
  void set_after_on_clock(bool on) { after_on_clock_ = on; }
  /// A global array for each section, each element the list of the key's values; those of an earlier file stay first.
  static int set_ini_arrays(Tcl_Interp* interpreter, const ini::IniFile& file);
  /// Values for [SECTION]KEY in .hal files that scripts source.
  void set_ini(IniLookup ini) { ini_ = std::move(ini); }

  /// Another clock than the attachment's.
  void set_clock(rtapi::WaitClock* clock);
  void set_pass(Pass pass) { pass_ = pass; }
  [[nodiscard]] Pass pass() const { return pass_; }
  /// What Pass::collect has found.
  [[nodiscard]] LoadrtMerge& loads() { return loads_; }
  /// Called for `source FILE.hal` while a pass other than `single` is on, or somebody looks on.
  void set_hal_file_reader(std::function<rtapi::Status(const std::string&)> read) {
    read_hal_file_ = std::move(read);
  }

  /// Who looks on, for checks of scripts. Scripts' places are then known for all commands, and `source FILE.hal` is left to the reader
  /// of HAL files.
  struct Observer {
    Commander::Interceptor intercept;
    /// A command has failed; true: the script goes on as if it had not.
    std::function<bool(const std::string& error, const Place& at)> failed;
  };
  void set_observer(Observer observer) { observer_ = std::move(observer); }

  /// What a command came to.
  struct Outcome {
    bool ok{true};
    std::string result;      ///< value, remarks, or the error
    std::string printed;     ///< for stdout
    std::string warnings{};  ///< for stderr
  };
  /// One command, words as they are, whatever the pass. `as_result`: what it prints is its result, as behind the word `hal`.
  Outcome run(const std::vector<std::string>& words, const Place& at, bool as_result = false);

  /// What attach() gave, once.
  rtapi::Result<Attachment> attachment();
  /// The commander, attached; its errors go to the Outcome of the running command only, so print what last_error() says.
  rtapi::Result<Commander*> commander();
  /// True while a command runs, for signal handlers.
  [[nodiscard]] bool busy() const { return busy_; }

 private:
  class Sink;
  struct Command;
  static int call(void* data, Tcl_Interp* interpreter, int count, Tcl_Obj* const words[]);
  int call_word(Tcl_Interp* interpreter, const Command& command, int count, Tcl_Obj* const* words);
  int finish(Tcl_Interp* interpreter, const Outcome& outcome);
  Outcome skip_or_run(std::vector<std::string> words, const Place& at, bool prefixed);
  Outcome source(const std::string& path);
  int wait_ms(Tcl_Interp* interpreter, rtapi::WaitClock& clock, long milliseconds);
  Place place(Tcl_Interp* interpreter) const;

  Attach attach_;
  Attachment attached_;
  std::unique_ptr<Sink> sink_;
  std::unique_ptr<Commander> commander_;
  IniLookup ini_;
  Pass pass_{Pass::single};
  LoadrtMerge loads_;  ///< asks the attachment's host what modules declare
  std::function<rtapi::Status(const std::string&)> read_hal_file_;
  Observer observer_;
  bool after_on_clock_{false};
  bool busy_{false};
};

}  // namespace kerf::hal::tcl
