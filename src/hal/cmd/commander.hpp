// Commander: does halcmd's commands, one line or a whole file, through a Session.
//
//   hal::LocalSession session(host);
//   hal::Commander halcmd(session, hal::ini_lookup(ini_file));
//   if (!halcmd.run_file("core.hal")) ...       // messages went to the sink with FILE:LINE
//
// Structure is changed by the realtime host; show, list, getp, gets, ptype and stype read the segment.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/client/session.hpp"
#include "hal/cmd/words.hpp"
#include "hal/core/view.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

/// Where texts go; the default prints to stdout and stderr.
class CommandSink {
 public:
  virtual ~CommandSink() = default;
  virtual void out(std::string_view text);
  virtual void err(std::string_view text);
  /// A command failed. The default gives err() "FILE:LINE: text".
  virtual void complaint(const std::string& file, int line, std::string_view text);
  /// What a command did, at Level::verbose. The default gives out() "FILE:LINE: text".
  virtual void remark(const std::string& file, int line, std::string_view text);
};

class Commander {
 public:
  enum class Level { silent, errors, verbose, debug };
  /// Sees each command, substituted and in words, before it is done. What it returns takes the command's place; nothing: the
  /// command is done as usual.
  using Interceptor = std::function<std::optional<rtapi::Status>(
      std::span<const std::string> words, const std::string& file, int line)>;

  explicit Commander(Session& session, IniLookup ini = {}, CommandSink* sink = nullptr);
  ~Commander();
  Commander(const Commander&) = delete;
  Commander& operator=(const Commander&) = delete;

  void set_level(Level level) { level_ = level; }
  void set_script_mode(bool on) { script_ = on; }
  void set_keep_going(bool on) { keep_going_ = on; }
  void set_echo(bool on) { echo_ = on; }
  void set_ini(IniLookup ini) { ini_ = std::move(ini); }
  void set_interceptor(Interceptor interceptor) { interceptor_ = std::move(interceptor); }
  /// show, list, status, getp, gets, ptype and stype print JSON (docs/hal-json.md), and so do errors.
  void set_json(bool on) { json_ = on; }
  /// What loadusr -W, waitusr, sleep and the host's answers are waited for on. Without it the first three are errors.
  void set_clock(rtapi::WaitClock* clock) {
    clock_ = clock;
    session_.use_clock(clock);
  }

  /// Called once, before the first command that shows the components of HAL or starts a program: the time to appear as one.
  void set_presence(std::function<void()> appear) { appear_ = std::move(appear); }

  /// Reads a file ("-": stdin) to its end, to the first error (unless keep-going) or to `quit`. False: something failed.
  /// Commands that only change HAL are sent many at a time; what is done, and what is reported where, is as if they were
  /// sent one by one.
  bool run_file(const std::string& path);
  /// Text of a file that is elsewhere; `name` stands in messages.
  bool run_text(std::string_view text, const std::string& name);
  /// One line, as it stands in a file.
  bool run_line(std::string_view line, const std::string& file, int line_number);
  /// Words of a command line, as they are: the shell has substituted and split.
  bool run_words(std::span<const std::string> words);
  /// Words that are final: nothing is substituted, not even '$' or '['. File and line stand in messages.
  bool run_exact(std::vector<std::string> words, const std::string& file, int line_number);

  /// True after `quit` or `exit`.
  [[nodiscard]] bool quit_requested() const { return quit_; }
  /// The last error without its place.
  [[nodiscard]] const std::string& last_error() const { return last_error_; }
  [[nodiscard]] const View& view() const { return view_; }
  /// Names of all commands, for completion.
  static std::vector<std::string> command_names();
  /// The text of `help`.
  static std::string help_text(std::string_view command);

 private:
  using Words = std::span<const std::string>;
  using Done = rtapi::Status;
  struct Row;
  static std::span<const Row> rows();

  /// A command that the host has not been asked for yet.
  struct Waiting {
    const Row* row;
    std::vector<std::string> words;
    std::string file;
    int line;
  };
  class Reader;

  bool read_lines(Reader& reader, bool batched);
  bool run(std::vector<std::string> words);
  bool run_row(const Row& row, Words words);
  /// Has the host do what is waiting. False: one failed; those after it are dropped, unless keep-going.
  bool settle();
  void command_failed(const Row& row, const rtapi::Error& error);
  /// True when a stop was asked for: nothing more of a script is done, not even with keep-going.
  [[nodiscard]] bool stopped() const { return clock_ != nullptr && clock_->stopped(); }
  void report(const std::string& text);
  void say(const std::string& text);
  void error(const std::string& text);

  Done forward(Words w);
  Done load_realtime(Words w);
  Done unload_realtime(Words w);
  Done unload(Words w);
  Done load_user(Words w);
  Done wait_user(Words w);
  Done unload_user(Words w);
  Done new_signal(Words w);
  Done delete_signal(Words w);
  Done link_pins(Words w);
  Done alias(Words w);
  Done get_item(Words w);
  Done item_type(Words w);
  Done get_signal(Words w);
  Done signal_type(Words w);
  Done show(Words w);
  Done timing(Words w);
  Done list(Words w);
  Done status(Words w);
  Done save(Words w);
  Done exact(Words w);
  Done source(Words w);
  Done print(Words w);
  Done echo_on(Words w);
  Done echo_off(Words w);
  Done help(Words w);
  Done quit(Words w);
  Done sleep(Words w);
  Done debug(Words w);
  Done ask_host(Words w);
  [[nodiscard]] std::string done_text(Words w) const;
  rtapi::Result<ItemInfo> find_item(const std::string& name) const;
  rtapi::Result<SignalInfo> find_signal(const std::string& name) const;
  Done wait_ready(pid_t pid, const std::string& component, const std::string& program);
  Done wait_exit(pid_t pid, const std::string& program, bool ignore_status);
  void wait_reaped(pid_t pid);

  Session& session_;
  IniLookup ini_;
  Interceptor interceptor_;
  std::function<void()> appear_;
  CommandSink default_sink_;
  CommandSink* sink_;
  View view_;
  rtapi::WaitClock* clock_{nullptr};
  Level level_{Level::errors};
  bool script_{false};
  bool keep_going_{false};
  bool echo_{false};
  bool json_{false};
  bool quit_{false};
  bool batched_{false};
  std::vector<Waiting> waiting_;
  int depth_{0};
  std::string file_{"<commandline>"};
  int line_{0};
  std::string last_error_;
};

}  // namespace kerf::hal
