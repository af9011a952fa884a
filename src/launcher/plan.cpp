#include "launcher/plan.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "ini/check.hpp"
#include "ini/convert.hpp"
#include "ini/reader.hpp"
#include "launcher/process.hpp"
#include "motion/api/flight_record.hpp"
#include "rtapi/base/suggest.hpp"

namespace kerf::launcher {

namespace fs = std::filesystem;

namespace {

bool is_file(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool ends_with(const std::string& text, std::string_view end) {
  return text.size() >= end.size() &&
         std::string_view(text).substr(text.size() - end.size()) == end;
}

std::vector<std::string> names_in(const std::string& dir, std::string_view suffix) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(dir, ignored)) {
    const std::string name = entry.path().filename().string();
    if (ends_with(name, suffix)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Planner {
 public:
  Planner(const ini::IniFile& file, const HalSearch& search)
      : file_(file), reader_(file), search_(search) {}

  LaunchPlan make() {
    std::error_code ignored;
    plan_.ini_path = fs::absolute(file_.name(), ignored).lexically_normal().string();
    plan_.ini_dir = fs::path(plan_.ini_path).parent_path().string();
    plan_.machine_name =
        reader_.has("EMC", "MACHINE") ? reader_.string("EMC", "MACHINE") : "machine";
    read_kerf();
    read_programs();
    read_modules();
    read_hal();
    read_safe_state();
    for (const ini::Diagnostic& d : ini::check_keys(file_, hal_use())) add(d);
    for (const ini::Diagnostic& d : reader_.complaints()) add(d);
    plan_.ok = std::none_of(plan_.diagnostics.begin(), plan_.diagnostics.end(),
                            [](const ini::Diagnostic& d) { return d.is_error; });
    return std::move(plan_);
  }

 private:
  void complain(const ini::Position& at, const std::string& text, bool is_error = true) {
    plan_.diagnostics.push_back({at, is_error, text});
  }

  /// The table and the launcher's own reading may find the same fault.
  void add(const ini::Diagnostic& diagnostic) {
    const std::string text = diagnostic.message();
    if (std::none_of(plan_.diagnostics.begin(), plan_.diagnostics.end(),
                     [&](const ini::Diagnostic& d) { return d.message() == text; }))
      plan_.diagnostics.push_back(diagnostic);
  }

  /// What the HAL files and commands take from the INI file.
  [[nodiscard]] ini::HalUse hal_use() const {
    ini::HalUse use;
    for (const auto* steps : {&plan_.hal, &plan_.postgui, &plan_.shutdown})
      for (const HalStep& step : *steps) {
        if (step.is_tcl())
          use.add_script(text_of(step.text));
        else
          use.add_text(step.is_file ? text_of(step.text) : step.text);
      }
    for (const ini::Entry* entry : file_.variables({})) use.add_text(entry->value);
    return use;
  }

  void read_kerf() {
    plan_.virtual_time = reader_.choice("KERF", "CLOCK") == 1;
    plan_.segment_mb = static_cast<std::size_t>(reader_.integer("KERF", "SEGMENT_MB"));
    constexpr const char* kTiming[] = {"sampled", "every", "off"};
    plan_.function_timing = kTiming[reader_.choice("KERF", "FUNCTION_TIMING")];
    plan_.rt_cpus = reader_.string("KERF", "RT_CPUS");
    plan_.record_keep = static_cast<int>(reader_.integer("KERF", "RECORD_KEEP"));
    plan_.record_dir = reader_.string("KERF", "RECORD_DIR");
    for (const ini::Entry* entry : file_.find_all("KERF", "RECORD_PIN")) {
      if (plan_.record_pins.size() == motion::kMaxRecordedPins)
        complain(entry->at, "[KERF]RECORD_PIN: at most " +
                                std::to_string(motion::kMaxRecordedPins) + " are recorded");
      plan_.record_pins.push_back(entry->value);
    }
    if (!plan_.record_dir.empty()) plan_.record_dir = resolve_from(plan_.ini_dir, plan_.record_dir);
    if (plan_.rt_cpus.find_first_not_of("0123456789,- ") != std::string::npos) {
      reader_.complain("KERF", "RT_CPUS",
                       "'" + plan_.rt_cpus + "': expected processor numbers such as 2,3 or 2-3");
    }
  }

  /// Path of a HAL file as the manual says it is searched; "" after a complaint.
  std::string find_hal_file(const ini::Entry& entry, std::string name, bool needed) {
    std::vector<std::string> dirs;
    if (name.rfind("LIB:", 0) == 0) {
      name = name.substr(4);
      dirs = search_.library;
    } else {
      dirs = search_.first;
      dirs.push_back(plan_.ini_dir);
      dirs.insert(dirs.end(), search_.library.begin(), search_.library.end());
    }
    name = ini::expand_tilde(name);
    if (!name.empty() && name.front() == '/') dirs = {""};
    for (const std::string& dir : dirs) {
      std::string path = resolve_from(dir, name);
      if (is_file(path)) return path;
    }
    std::vector<std::string> known;
    for (const std::string& dir : dirs) {
      for (const char* ending : {".hal", ".tcl"}) {
        const auto more =
            names_in(dir.empty() ? fs::path(name).parent_path().string() : dir, ending);
        known.insert(known.end(), more.begin(), more.end());
      }
    }
    std::string where;
    for (const std::string& dir : dirs)
      if (!dir.empty()) where += (where.empty() ? " in " : ", ") + dir;
    complain(entry.at,
             "[HAL]" + entry.key + ": no file '" + name + "'" + where +
                 rtapi::did_you_mean(fs::path(name).filename().string(), known),
             needed);
    return {};
  }

  void add_files(const char* key, std::vector<HalStep>& steps, bool needed = true) {
    for (const ini::Entry* entry : file_.find_all("HAL", key)) {
      std::vector<std::string> words = split_words(entry->value);
      if (words.empty()) continue;
      HalStep step{true, find_hal_file(*entry, words.front(), needed), entry->at};
      if (step.text.empty()) continue;
      words.erase(words.begin());
      step.arguments = std::move(words);
      if (!step.is_tcl() && !step.arguments.empty()) {
        complain(entry->at,
                 "[HAL]" + entry->key + " = " + entry->value +
                     ": only Tcl files take arguments; they are ignored",
                 false);
      }
      steps.push_back(std::move(step));
    }
  }

  void add_commands(const char* key, std::vector<HalStep>& steps) {
    for (const ini::Entry* entry : file_.find_all("HAL", key))
      if (!entry->value.empty()) steps.push_back({false, entry->value, entry->at});
  }

  void read_modules() {
    if (const ini::Entry* const homing = file_.find("EMCMOT", "HOMEMOD"); homing != nullptr)
      plan_.modules = homing_steps(homing->value, homing->at);
    const ini::Entry* const planner = file_.find("TRAJ", "TPMOD");
    if (planner == nullptr || planner->value.empty()) return;
    const auto words = split_words(planner->value);
    if (!words.empty() && words.front() != "tpmod")
      complain(planner->at,
               "[TRAJ]TPMOD = " + planner->value +
                   ": Kerf's planner certifies each plan against the machine's limits "
                   "and is a part of motmod; a module cannot replace it. Remove the key");
  }

  void read_hal() {
    add_files("HALFILE", plan_.hal);
    if (file_.find("HAL", "HALFILE") == nullptr) {
      complain(file_.section_position("HAL"),
               "no [HAL]HALFILE: nothing would load motion control and connect the machine");
    }
    add_commands("HALCMD", plan_.hal);
    // The screen does these; it may look elsewhere, and nobody asks for them without it.
    add_files("POSTGUI_HALFILE", plan_.postgui, plan_.display.empty());
    add_commands("POSTGUI_HALCMD", plan_.postgui);
    add_files("SHUTDOWN", plan_.shutdown);
    plan_.halui = reader_.string("HAL", "HALUI");
    plan_.two_pass = reader_.string("HAL", "TWOPASS");
    for (const char* off : {"off", "no", "false", "0"}) {
      if (ini::equal_ignoring_case(plan_.two_pass, off)) {
        reader_.complain(
            "HAL", "TWOPASS",
            "'" + plan_.two_pass + "' turns two passes on, as any text does; leave the value empty",
            false);
      }
    }
  }

  void read_safe_state() {
    for (const ini::Entry* entry : file_.find_all("SAFE_STATE", "PIN")) {
      const std::vector<std::string> words = split_words(entry->value);
      if (words.size() == 2)
        plan_.safe_pins.push_back({words[0], words[1], entry->at});
      else
        complain(entry->at, "[SAFE_STATE]PIN = " + entry->value +
                                ": expected a name and a value, such as motion.digital-out-03 0");
    }
    for (const ini::Entry* entry : file_.find_all("SAFE_STATE", "COMMAND")) {
      const std::vector<std::string> words = split_words(entry->value);
      if (words.empty() || find_program(words.front()).empty())
        complain(entry->at, "[SAFE_STATE]COMMAND = " + entry->value + ": no such program");
      else
        plan_.safe_commands.push_back(words);
    }
  }

  void read_programs() {
    if (const std::string task = reader_.string("TASK", "TASK"); !task.empty())
      plan_.task_program = task;
    plan_.display = split_words(reader_.string("DISPLAY", "DISPLAY"));
    for (const std::string& text : reader_.strings("APPLICATIONS", "APP"))
      if (!split_words(text).empty()) plan_.applications.push_back(text);
    plan_.applications_delay_s = reader_.real("APPLICATIONS", "DELAY");
    std::string open = reader_.string("DISPLAY", "OPEN_FILE");
    if (open == "\"\"") open.clear();
    if (!open.empty()) plan_.open_file = resolve_from(plan_.ini_dir, open);
  }

  const ini::IniFile& file_;
  ini::Reader reader_;
  const HalSearch& search_;
  LaunchPlan plan_;
};

}  // namespace

bool HalStep::is_tcl() const { return is_file && ends_with(text, ".tcl"); }

std::string resolve_from(const std::string& dir, const std::string& path) {
  const fs::path expanded = ini::expand_tilde(path);
  if (expanded.is_absolute() || dir.empty()) return expanded.lexically_normal().string();
  return (fs::path(dir) / expanded).lexically_normal().string();
}

std::vector<std::string> filter_for(const ini::IniFile& file, const std::string& program) {
  const std::string extension = fs::path(program).extension().string();
  if (extension.size() < 2) return {};
  const auto lists_it = [&](const ini::Entry* entry) {
    std::string endings =
        split_words(entry->value).empty() ? "" : split_words(entry->value).front();
    for (std::size_t from = 0; from < endings.size();) {
      const std::size_t comma = std::min(endings.find(',', from), endings.size());
      if (endings.substr(from, comma - from) == extension) return true;
      from = comma + 1;
    }
    return false;
  };
  const auto kinds = file.find_all("FILTER", "PROGRAM_EXTENSION");
  if (std::none_of(kinds.begin(), kinds.end(), lists_it)) return {};
  const ini::Entry* entry = file.find("FILTER", extension.substr(1));
  return entry == nullptr ? std::vector<std::string>{} : split_words(entry->value);
}

std::vector<std::string> split_words(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  bool inside = false;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote)
        quote = 0;
      else
        word += c;
    } else if (c == '"' || c == '\'') {
      quote = c;
      inside = true;
    } else if (c == ' ' || c == '\t') {
      if (inside) words.push_back(std::move(word));
      word.clear();
      inside = false;
    } else {
      word += c;
      inside = true;
    }
  }
  if (inside) words.push_back(std::move(word));
  return words;
}

std::vector<HalStep> homing_steps(const std::string& words, const ini::Position& at) {
  const auto module = split_words(words);
  if (module.empty() || module.front() == "homemod") return {};
  return {{false, "loadrt " + words, at}};
}

LaunchPlan make_plan(const ini::IniFile& file, const HalSearch& search) {
  return Planner(file, search).make();
}

}  // namespace kerf::launcher
