// ScriptCheck: what is wrong with HAL scripts, found without a machine.
//
//   hal::ScriptCheck check(modules, &ini_file);
//   check.run_file("core.hal");
//   check.run_file("custom.hal");
//   for (const auto& f : check.finish()) std::puts(f.text_line().c_str());
//
// The scripts are carried out in a HAL of this process's own, in private memory, where no thread runs, no program starts and no
// driver touches its device. So what is an error on the machine is an error here, with the same words. Unlike a run, a check
// goes on after an error, and afterwards looks at what the scripts have made as a whole.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "hal/cmd/commander.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/module_source.hpp"
#include "hal/tcl/loadrt_merge.hpp"
#include "ini/ini_file.hpp"

namespace kerf::hal {

class Host;

/// A line of a script.
struct ScriptPlace {
  std::string file;
  int line{0};  ///< 0: the file as a whole
  [[nodiscard]] std::string text() const;
};

struct Finding {
  enum class Level { error, warning, note };
  Level level{Level::error};
  std::string
      kind;  ///< "command" for an error of a command, else what the analysis looks for; see docs/hal-check.md
  ScriptPlace at;
  std::string text;
  /// "FILE:LINE: error: text".
  [[nodiscard]] std::string text_line() const;
};
const char* level_name(Finding::Level level);

/// A pin that belongs to a program or to something that could not be loaded, so nothing is known of it.
struct UncheckedPin {
  std::string name;
  std::string signal;  ///< empty: only set or read
  ScriptPlace at;
  Dir dir{Dir::unspecified};  ///< in or out, as the arrows of `net` say
};

/// What the scripts did, as far as HAL itself does not show it.
struct ScriptTrace {
  std::map<std::string, ScriptPlace> loaded;   ///< component -> its loadrt
  std::map<std::string, ScriptPlace> signals;  ///< signal -> its first line
  std::map<std::string, ScriptPlace> links;    ///< pin -> the line that linked it
  std::map<std::string, ScriptPlace> added;    ///< function -> its addf
  std::set<std::string> set_items;             ///< pins and parameters that were given a value
  std::set<std::string> set_signals;
  std::vector<UncheckedPin> unchecked;
};

/// Findings about what the scripts have made as a whole: signals without a writer, functions that never run, inputs that nobody
/// gives a value, values that arrive one cycle late, loops.
std::vector<Finding> analyse(const View& view, const ScriptTrace& trace);

class ScriptCheck {
 public:
  /// `ini` may be null; both must outlive the check.
  ScriptCheck(ModuleSource& modules, const ini::IniFile* ini);
  ~ScriptCheck();
  ScriptCheck(const ScriptCheck&) = delete;
  ScriptCheck& operator=(const ScriptCheck&) = delete;

  /// The files of [HAL]HALFILE, the commands of HALCMD, then POSTGUI_HALFILE and POSTGUI_HALCMD.
  void run_ini_files();
  /// Tcl files get their `arguments`.
  void run_file(const std::string& path, const std::vector<std::string>& arguments = {});
  void run_text(std::string_view text, const std::string& name);
  /// All findings, by file in the order of reading, then by line.
  std::vector<Finding> finish();

  /// What the scripts have made.
  [[nodiscard]] const View& view() const;
  [[nodiscard]] const ScriptTrace& trace() const { return trace_; }
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  using Words = std::span<const std::string>;
  using Done = std::optional<rtapi::Status>;
  class Sink;
  class NoDevices;
  class TclFiles;  ///< hal/tcl/check_tcl.hpp
  struct Machine;
  struct Row;

  Done command(Words w, const ScriptPlace& at);
  Done load_realtime(Words w, const ScriptPlace& at);
  Done load_user(Words w, const ScriptPlace& at);
  Done unload(Words w, const ScriptPlace& at);
  Done net(Words w, const ScriptPlace& at);
  Done link(Words w, const ScriptPlace& at);
  Done set_item(Words w, const ScriptPlace& at);
  Done read_item(Words w, const ScriptPlace& at);
  Done set_signal(Words w, const ScriptPlace& at);
  Done read_signal(Words w, const ScriptPlace& at);
  Done delete_signal(Words w, const ScriptPlace& at);
  Done new_signal(Words w, const ScriptPlace& at);
  Done add_function(Words w, const ScriptPlace& at);
  Done skip(Words w, const ScriptPlace& at);

  rtapi::Status ask(Words w);
  /// The text with the places of other lines that it speaks of.
  [[nodiscard]] std::string with_places(const std::string& text, const std::string& pin,
                                        const std::string& signal) const;
  [[nodiscard]] bool is_loadable(const std::string& prefix) const;
  void check_arrows(Words w, const ScriptPlace& at);
  /// True when nothing is known about a pin of this name, which is no item of the private HAL.
  [[nodiscard]] bool is_unchecked(const std::string& name) const;
  void expect_unknown(const std::string& component);
  void add(Finding::Level level, const char* kind, const ScriptPlace& at, std::string text);
  /// A HAL file that the INI file names, with its words.
  struct HalFile {
    std::string path;
    std::vector<std::string> arguments;
  };
  [[nodiscard]] std::string hal_file(const ini::Entry& entry);
  /// The files of a key that are there; complaints about the others.
  std::vector<HalFile> hal_files(const char* key);
  void run_commands(const char* key);
  /// [HAL]TWOPASS: all loadrt first, those of one module as one.
  void run_two_pass(const std::vector<HalFile>& files);
  void enter(const std::string& file);

  ModuleSource& modules_;
  const ini::IniFile* ini_;
  std::unique_ptr<Machine> machine_;
  std::unique_ptr<TclFiles> tcl_files_;
  std::string top_file_;
  std::vector<std::string> files_;
  std::vector<Finding> findings_;
  ScriptTrace trace_;
  std::set<std::string>
      unknown_prefixes_;  ///< of pins of programs, and of what could not be loaded
  std::set<std::string>
      untyped_signals_;  ///< those with unchecked pins only: HAL does not know them
  enum class Pass { single, gather, rest };
  Pass pass_{Pass::single};
  tcl::LoadrtMerge loads_;
  bool strangers_{false};  ///< something was started whose pins have any name
};

/// What `halcmd check --json` prints; docs/hal-json.md has the keys.
std::string check_json(const ScriptCheck& check, const std::vector<Finding>& findings);

/// Reads a machine's INI file and sets the variables that HAL files find in their environment; what is wrong with it goes to
/// stderr. `enter_folder`: its HAL files are to be read.
bool load_machine_ini(const std::string& path, bool enter_folder, ini::LoadResult& ini);

}  // namespace kerf::hal
