#include "hal/cmd/check.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "hal/capi/realtime_backend.hpp"
#include "hal/client/list_parameters.hpp"
#include "hal/client/session.hpp"
#include "hal/cmd/words.hpp"
#include "hal/loader/host.hpp"
#include "hal/tcl/check_tcl.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Status;

namespace {

std::string in_quotes(std::string_view s) { return "'" + std::string(s) + "'"; }
bool is_arrow(std::string_view w) { return w == "=>" || w == "<=" || w == "<=>"; }
std::string prefix_of(const std::string& name) { return name.substr(0, name.find('.')); }
/// A failure that has been reported.
Status reported() { return fail(Errc::ok, ""); }

std::vector<std::string> without_arrows(std::span<const std::string> w) {
  std::vector<std::string> out(w.begin(), w.end());
  std::erase_if(out, [](const std::string& word) { return is_arrow(word); });
  return out;
}

/// What the arrows around word i of a `net` say of the pin: in, out or unspecified. "=>" speaks of all pins behind it and "<=" of
/// the next one; a pin before the first arrow is at its other end.
Dir arrow_dir(std::span<const std::string> w, std::size_t i) {
  for (std::size_t left = i; left-- > 2;) {
    if (!is_arrow(w[left])) continue;
    if (w[left] == "=>") return Dir::in;
    return w[left] == "<=" && left + 1 == i ? Dir::out : Dir::unspecified;
  }
  const std::string after = i + 1 < w.size() && is_arrow(w[i + 1]) ? w[i + 1] : "";
  return after == "<=" ? Dir::in : after == "=>" ? Dir::out : Dir::unspecified;
}

class StillClock final : public rtapi::Clock {
 public:
  [[nodiscard]] rtapi::Nanos now() const noexcept override { return 0; }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }
};

class DeclaringDriver final : public HostDriver {
 public:
  [[nodiscard]] bool declares_only() const override { return true; }
};

/// Programs whose pins have other names than themselves, and those that Kerf starts without a loadusr.
constexpr const char* kKnownPrefixes[] = {"iocontrol", "halui"};

/// What could carry a program's pins: the names that its command line gives.
std::set<std::string> names_of_program(std::span<const std::string> words,
                                       const std::string& ready_name) {
  std::set<std::string> out;
  if (!ready_name.empty()) out.insert(ready_name);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool names_next = words[i] == "-c" || words[i] == "-n" || words[i] == "--name";
    if (names_next && i + 1 < words.size()) out.insert(words[i + 1]);
    // `python3 panel.py`: either may be the name.
    if (i <= 1 && words[i].rfind('-', 0) != 0) {
      const std::filesystem::path path(words[i]);
      out.insert(path.filename().string());
      out.insert(path.stem().string());
    }
  }
  return out;
}

bool is_program(const std::string& word) {
  if (word.find('/') != std::string::npos) return ::access(word.c_str(), X_OK) == 0;
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (::access((self.parent_path() / word).c_str(), X_OK) == 0) return true;
  const char* path = std::getenv("PATH");
  std::string_view rest(path != nullptr ? path : "/usr/bin:/bin");
  while (!rest.empty()) {
    const auto end = std::min(rest.find(':'), rest.size());
    if (::access((std::string(rest.substr(0, end)) + "/" + word).c_str(), X_OK) == 0) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

}  // namespace

std::string ScriptPlace::text() const {
  return line > 0 ? file + ":" + std::to_string(line) : file;
}

const char* level_name(Finding::Level level) {
  switch (level) {
    case Finding::Level::error: return "error";
    case Finding::Level::warning: return "warning";
    default: return "note";
  }
}

std::string Finding::text_line() const {
  return at.text() + ": " + level_name(level) + ": " + text;
}

/// While a component is made no file can be opened, so that a driver that does not ask declares_only() cannot reach its device
/// either. The loader itself may open the component's file.
class ScriptCheck::NoDevices final : public ModuleSource {
 public:
  explicit NoDevices(ModuleSource& source) : source_(source) { ::getrlimit(RLIMIT_NOFILE, &old_); }
  rtapi::Result<const Module*> open(std::string_view name) override {
    allow();
    auto module = source_.open(name);
    in_c_ = module.ok() && (*module)->c_library != nullptr;
    if (forbidden_) forbid();
    return module;
  }
  /// True when the last one opened is a module of the C API, which cannot ask declares_only().
  [[nodiscard]] bool in_c() const { return in_c_; }
  void close(const Module* module) override { source_.close(module); }
  [[nodiscard]] std::vector<std::string> names() const override { return source_.names(); }

  /// From now on until `end`.
  void begin() {
    in_c_ = false;
    forbidden_ = true;
    forbid();
  }
  void end() {
    forbidden_ = false;
    allow();
  }

 private:
  void forbid() const {
#if !defined(__SANITIZE_ADDRESS__)  // it opens pipes to see whether it may read an address
    const rlimit none{0, old_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
#endif
  }
  void allow() const { ::setrlimit(RLIMIT_NOFILE, &old_); }
  ModuleSource& source_;
  rlimit old_{};
  bool forbidden_{false};
  bool in_c_{false};
};

/// Takes the errors of commands; all else that they print is not wanted.
class ScriptCheck::Sink final : public CommandSink {
 public:
  explicit Sink(ScriptCheck& check) : check_(check) {}
  void out(std::string_view /*text*/) override {}
  void err(std::string_view /*text*/) override {}
  void complaint(const std::string& file, int line, std::string_view text) override {
    ScriptPlace at{file, line};
    if (line == 0) at.file = check_.top_file_;
    check_.add(Finding::Level::error, "command", at, std::string(text));
  }

 private:
  ScriptCheck& check_;
};

struct ScriptCheck::Machine {
  Machine(ScriptCheck& check, ModuleSource& source, const ini::IniFile* ini)
      : modules(source),
        host(std::move(Host::create(*segment, clock, modules, &driver)).value()),
        session(*host),
        view(*segment),
        sink(check),
        commander(session, ini != nullptr ? ini_lookup(*ini) : IniLookup{}, &sink) {
    commander.set_keep_going(true);
    capi::use_host(*host);
  }
  ~Machine() {
    (void)host->unload_all();
    capi::forget_host();
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;
  std::unique_ptr<rtapi::Segment> segment = rtapi::Segment::in_memory();
  StillClock clock;
  DeclaringDriver driver;
  NoDevices modules;
  std::unique_ptr<Host> host;
  LocalSession session;
  View view;
  Sink sink;
  Commander commander;
};

ScriptCheck::ScriptCheck(ModuleSource& modules, const ini::IniFile* ini)
    : modules_(modules),
      ini_(ini),
      machine_(std::make_unique<Machine>(*this, modules, ini)),
      loads_([this](const std::string& module) {
        return list_parameters(machine_->session, module);
      }) {
  for (const char* prefix : kKnownPrefixes) unknown_prefixes_.insert(prefix);
  machine_->commander.set_interceptor([this](Words w, const std::string& file, int line) {
    ScriptPlace at{file, line};
    if (line > 0) enter(file);
    return command(w, at);
  });
}

ScriptCheck::~ScriptCheck() = default;

const View& ScriptCheck::view() const { return machine_->view; }

void ScriptCheck::add(Finding::Level level, const char* kind, const ScriptPlace& at,
                      std::string text) {
  // Read twice for two passes, a line says the same again.
  for (const auto& f : findings_)
    if (f.at.line == at.line && f.at.file == at.file && f.text == text) return;
  findings_.push_back({level, kind, at, std::move(text)});
}

void ScriptCheck::enter(const std::string& file) {
  if (std::find(files_.begin(), files_.end(), file) == files_.end()) files_.push_back(file);
}

void ScriptCheck::run_file(const std::string& path, const std::vector<std::string>& arguments) {
  enter(path);
  top_file_ = path;
  if (std::filesystem::path(path).extension() == ".tcl") {
    if (tcl_files_ == nullptr)
      tcl_files_ = std::make_unique<TclFiles>(*this, machine_->session, ini_);
    return tcl_files_->run(path, arguments);
  }
  (void)machine_->commander.run_file(path);
}

void ScriptCheck::run_text(std::string_view text, const std::string& name) {
  enter(name);
  top_file_ = name;
  (void)machine_->commander.run_text(text, name);
}

std::vector<Finding> ScriptCheck::finish() {
  std::vector<Finding> out = findings_;
  for (auto& finding : analyse(machine_->view, trace_)) out.push_back(std::move(finding));
  const auto rank = [this](const Finding& f) {
    return std::find(files_.begin(), files_.end(), f.at.file) - files_.begin();
  };
  std::stable_sort(out.begin(), out.end(), [&rank](const Finding& a, const Finding& b) {
    const auto ra = rank(a), rb = rank(b);
    return ra != rb ? ra < rb : a.at.line < b.at.line;
  });
  return out;
}

// ---- an INI's files -----------------------------------------------------------------------------

std::string ScriptCheck::hal_file(const ini::Entry& entry) {
  // As the launcher looks for them: LIB: only in the library, others beside the INI first.
  std::string name = entry.value.substr(0, entry.value.find_first_of(" \t"));
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path top = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
  std::vector<fs::path> dirs{top / "hallib", top.parent_path().parent_path() / "configs/hallib",
                             top.parent_path() / "configs/hallib"};
  if (name.rfind("LIB:", 0) == 0)
    name = name.substr(4);
  else
    dirs.insert(dirs.begin(), ".");
  name = ini::expand_tilde(name);
  if (!name.empty() && name.front() == '/') dirs = {""};
  for (const auto& dir : dirs) {
    const fs::path path = dir == "." ? fs::path(name) : dir / name;
    if (fs::is_regular_file(path, error)) return path.string();
  }
  add(Finding::Level::error, "file", {entry.at.file, entry.at.line},
      "[HAL]" + entry.key + ": no file " + in_quotes(name));
  return {};
}

std::vector<ScriptCheck::HalFile> ScriptCheck::hal_files(const char* key) {
  std::vector<HalFile> out;
  for (const ini::Entry* entry : ini_->find_all("HAL", key)) {
    HalFile file{hal_file(*entry), {}};
    if (file.path.empty()) continue;
    if (auto words = split_words(entry->value); words.ok() && !words->empty())
      file.arguments.assign(words->begin() + 1, words->end());
    out.push_back(std::move(file));
  }
  return out;
}

void ScriptCheck::run_commands(const char* key) {
  for (const ini::Entry* entry : ini_->find_all("HAL", key)) {
    top_file_ = entry->at.file;
    (void)machine_->commander.run_line(entry->value, entry->at.file, entry->at.line);
  }
}

void ScriptCheck::run_two_pass(const std::vector<HalFile>& files) {
  std::vector<HalFile> twice;
  for (const auto& file : files) {
    std::ifstream in(file.path);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (tcl::is_excluded(text))
      run_file(file.path, file.arguments);
    else
      twice.push_back(file);
  }
  pass_ = Pass::gather;
  for (const auto& file : twice) run_file(file.path, file.arguments);
  for (const auto& module : loads_.modules()) {
    std::vector<std::string> words = module.words();
    words.insert(words.begin(), "loadrt");
    const ScriptPlace at{module.places.front().file, module.places.front().line};
    if (const auto done = load_realtime(words, at); done && !done->ok())
      add(Finding::Level::error, "command", at, done->error().message());
  }
  pass_ = Pass::rest;
  for (const auto& file : twice) run_file(file.path, file.arguments);
  pass_ = Pass::single;
}

void ScriptCheck::run_ini_files() {
  if (ini_ == nullptr) return;
  enter(ini_->name());
  strangers_ = true;  // screens and task start by other keys than loadusr
  if (ini_->find("HAL", "HALFILE") == nullptr) {
    const auto at = ini_->section_position("HAL");
    add(Finding::Level::error, "file", {at.file, at.line}, "no [HAL]HALFILE: nothing to check");
  }
  const auto files = hal_files("HALFILE");
  const ini::Entry* two_pass = ini_->find("HAL", "TWOPASS");
  if (two_pass != nullptr && !two_pass->value.empty())
    run_two_pass(files);
  else
    for (const auto& file : files) run_file(file.path, file.arguments);
  run_commands("HALCMD");
  for (const auto& file : hal_files("POSTGUI_HALFILE")) run_file(file.path, file.arguments);
  run_commands("POSTGUI_HALCMD");
}

// ---- commands -----------------------------------------------------------------------------------

struct ScriptCheck::Row {
  const char* name;
  std::size_t
      min;  ///< words that the check needs; with fewer the command itself says what is missing
  Done (ScriptCheck::*run)(Words w, const ScriptPlace& at);
};

ScriptCheck::Done ScriptCheck::command(Words w, const ScriptPlace& at) {
  static constexpr Row kRows[] = {
      {"loadrt", 2, &ScriptCheck::load_realtime},
      {"loadusr", 2, &ScriptCheck::load_user},
      {"unload", 2, &ScriptCheck::unload},
      {"unloadrt", 2, &ScriptCheck::unload},
      {"unloadusr", 2, &ScriptCheck::skip},
      {"waitusr", 2, &ScriptCheck::skip},
      {"net", 3, &ScriptCheck::net},
      {"linkps", 3, &ScriptCheck::link},
      {"linksp", 3, &ScriptCheck::link},
      {"linkpp", 3, &ScriptCheck::link},
      {"unlinkp", 2, &ScriptCheck::read_item},
      {"setp", 3, &ScriptCheck::set_item},
      {"getp", 2, &ScriptCheck::read_item},
      {"ptype", 2, &ScriptCheck::read_item},
      {"sets", 3, &ScriptCheck::set_signal},
      {"gets", 2, &ScriptCheck::read_signal},
      {"stype", 2, &ScriptCheck::read_signal},
      {"newsig", 3, &ScriptCheck::new_signal},
      {"delsig", 2, &ScriptCheck::delete_signal},
      {"addf", 3, &ScriptCheck::add_function},
      {"delf", 3, &ScriptCheck::read_item},
      {"save", 1, &ScriptCheck::skip},
      {"print", 1, &ScriptCheck::skip},
      {"sleep", 2, &ScriptCheck::skip},
      {"echo", 1, &ScriptCheck::skip},
      {"unecho", 1, &ScriptCheck::skip},
      {"help", 1, &ScriptCheck::skip},
  };
  if (pass_ == Pass::gather) {
    if (w[0] != "loadrt" || w.size() < 2) return w[0] == "source" ? Done{} : Done{Status{}};
    return loads_.add(w.subspan(1), {at.file, at.line});
  }
  if (pass_ == Pass::rest && w[0] == "loadrt" && w.size() >= 2) return Status{};
  for (const Row& row : kRows)
    if (w[0] == row.name && w.size() >= row.min) return (this->*row.run)(w, at);
  return std::nullopt;
}

ScriptCheck::Done ScriptCheck::skip(Words /*w*/, const ScriptPlace& /*at*/) { return Status{}; }

Status ScriptCheck::ask(Words w) {
  auto reply = machine_->session.request(w);
  if (!reply.ok()) return fail(reply.error().code, reply.error().message());
  if (!reply->ok()) return fail(static_cast<Errc>(reply->status), reply->text);
  return {};
}

bool ScriptCheck::is_unchecked(const std::string& name) const {
  const std::string prefix = prefix_of(name);
  if (unknown_prefixes_.count(prefix) > 0) return true;
  if (!strangers_ || prefix.size() == name.size()) return false;
  if (is_loadable(prefix)) return false;
  // A prefix unlike any that is known is a program's; one that is nearly known is a slip of the pen.
  std::set<std::string> known;
  for (const Kind kind : {Kind::pin, Kind::param, Kind::function})
    for (const auto& item : machine_->view.names(kind)) known.insert(prefix_of(item));
  return known.count(prefix) == 0 && rtapi::nearest_name(prefix, known).empty();
}

bool ScriptCheck::is_loadable(const std::string& prefix) const {
  const auto names = modules_.names();
  const auto plain = [](std::string name) {
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
  };
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return plain(name) == plain(prefix); });
}

void ScriptCheck::expect_unknown(const std::string& component) {
  unknown_prefixes_.insert(component);
  std::string dashes = component;
  std::replace(dashes.begin(), dashes.end(), '_', '-');
  unknown_prefixes_.insert(dashes);
  // The controller's items carry other names than its own.
  if (component == "motmod")
    for (const char* prefix :
         {"motion", "joint", "axis", "spindle", "motion-command-handler", "motion-controller"})
      unknown_prefixes_.insert(prefix);
}

ScriptCheck::Done ScriptCheck::load_realtime(Words w, const ScriptPlace& at) {
  machine_->modules.begin();
  const Status done = ask(w);
  machine_->modules.end();
  if (done.ok()) {
    trace_.loaded.emplace(w[1], at);
    return done;
  }
  if (done.error().code == Errc::exists && trace_.loaded.count(w[1]) > 0)
    return fail(done.error().code,
                done.error().message() + " (loaded at " + trace_.loaded.at(w[1]).text() + ")");
  // One error is enough: what it would have brought is not missed again in each line that uses it.
  expect_unknown(w[1]);
  for (const auto& word : w.subspan(2)) {
    if (word.rfind("names=", 0) != 0) continue;
    std::string_view rest = std::string_view(word).substr(6);
    while (!rest.empty()) {
      const auto end = std::min(rest.find(','), rest.size());
      unknown_prefixes_.insert(prefix_of(std::string(rest.substr(0, end))));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  if (!machine_->modules.in_c()) return done;
  strangers_ = true;  // its pins may have any names
  add(Finding::Level::warning, "device", at,
      done.error().message() +
          "; a component in C may need its device for this: what it exports is not checked");
  return Status{};
}

ScriptCheck::Done ScriptCheck::load_user(Words w, const ScriptPlace& at) {
  std::string ready_name;
  std::size_t i = 1;
  for (; i < w.size() && w[i].rfind('-', 0) == 0; ++i)
    if (w[i] == "-Wn" && i + 1 < w.size()) ready_name = w[++i];
  if (i >= w.size()) return std::nullopt;
  const Words program = w.subspan(i);
  for (const auto& name : names_of_program(program, ready_name)) unknown_prefixes_.insert(name);
  strangers_ = true;
  if (!is_program(program[0])) {
    add(Finding::Level::warning, "program", at,
        "program " + in_quotes(program[0]) + " is not found on this computer");
  }
  return Status{};
}

ScriptCheck::Done ScriptCheck::unload(Words w, const ScriptPlace& /*at*/) {
  if (unknown_prefixes_.count(w[1]) > 0) return Status{};
  const std::string words[] = {"unloadrt", w[1]};
  const Status done = ask(words);
  const auto& view = machine_->view;
  const auto functions = view.names(Kind::function);
  std::erase_if(trace_.loaded, [&](const auto& e) { return !view.find_component(e.first); });
  std::erase_if(trace_.links, [&](const auto& e) { return !view.find_pin(e.first); });
  std::erase_if(trace_.added, [&](const auto& e) {
    return std::find(functions.begin(), functions.end(), e.first) == functions.end();
  });
  return done;
}

std::string ScriptCheck::with_places(const std::string& text, const std::string& pin,
                                     const std::string& signal) const {
  // Names stand in quotes in every message.
  std::string out = text;
  const std::string_view said = std::string_view(text).substr(0, text.find("; did you mean"));
  bool placed = false;
  std::size_t begin = 0;
  while ((begin = said.find('\'', begin)) != std::string::npos) {
    const auto end = said.find('\'', begin + 1);
    if (end == std::string::npos) break;
    const std::string name(said.substr(begin + 1, end - begin - 1));
    begin = end + 1;
    if (const auto linked = trace_.links.find(name); linked != trace_.links.end()) {
      out += "; " + in_quotes(name) + " was linked at " + linked->second.text();
      placed = true;
    }
  }
  if (placed) return out;
  if (const auto place = trace_.signals.find(signal);
      place != trace_.signals.end() && text.find(in_quotes(signal)) != std::string::npos)
    return out + "; signal " + in_quotes(signal) + " is from " + place->second.text();
  // An instance may bear the name of another component; then its nearest pin has been named.
  if (const auto prefix = prefix_of(pin);
      trace_.loaded.count(prefix) == 0 && prefix.size() < pin.size() && is_loadable(prefix) &&
      text.find("did you mean '" + std::string(prefix) + ".") == std::string::npos)
    out += "; component " + in_quotes(prefix) + " is not loaded";
  return out;
}

/// Arrows are for people: HAL ignores them, so one that lies is never noticed.
void ScriptCheck::check_arrows(Words w, const ScriptPlace& at) {
  for (std::size_t i = 2; i < w.size(); ++i) {
    if (is_arrow(w[i])) continue;
    const auto pin = machine_->view.find_pin(w[i]);
    if (!pin || pin->dir == Dir::io) continue;
    const Dir says = arrow_dir(w, i);
    if (says == Dir::unspecified || says == pin->dir) continue;
    add(Finding::Level::warning, "arrow", at,
        "pin " + in_quotes(w[i]) + (pin->dir == Dir::out ? " writes" : " reads") + " signal " +
            in_quotes(w[1]) + ", the arrow points the other way");
  }
}

ScriptCheck::Done ScriptCheck::net(Words w, const ScriptPlace& at) {
  check_arrows(w, at);
  bool good = true, asked = false;
  for (std::size_t i = 2; i < w.size(); ++i) {
    const std::string& pin = w[i];
    if (is_arrow(pin)) continue;
    if (!machine_->view.find_pin(pin) && is_unchecked(pin)) {
      trace_.unchecked.push_back({pin, w[1], at, arrow_dir(w, i)});
      trace_.signals.emplace(w[1], at);
      if (!machine_->view.find_signal(w[1])) untyped_signals_.insert(w[1]);
      asked = true;
      continue;
    }
    // One by one, so that one bad pin does not hide the next, and the good ones are linked for the lines that follow.
    const std::string words[] = {"net", w[1], pin};
    const Status done = ask(words);
    asked = true;
    if (done.ok()) {
      trace_.links.emplace(pin, at);
      trace_.signals.emplace(w[1], at);
      untyped_signals_.erase(w[1]);
      continue;
    }
    good = false;
    add(Finding::Level::error, "command", at, with_places(done.error().message(), pin, w[1]));
  }
  if (!asked) return std::nullopt;
  return good ? Status{} : reported();
}

ScriptCheck::Done ScriptCheck::link(Words words, const ScriptPlace& at) {
  const auto w = without_arrows(words);
  if (w.size() != 3) return std::nullopt;
  const bool pins = w[0] == "linkpp";
  const std::string& pin = w[0] == "linksp" ? w[2] : w[1];
  const std::string& other = w[0] == "linksp" ? w[1] : w[2];
  const auto stranger = [this](const std::string& name) {
    return !machine_->view.find_pin(name) && is_unchecked(name);
  };
  if (stranger(pin) || (pins && stranger(other))) {
    const std::string signal = pins ? pin : other;
    trace_.signals.emplace(signal, at);
    for (const auto& name : {pin, other})
      if (stranger(name)) trace_.unchecked.push_back({name, signal, at, Dir::unspecified});
    return Status{};
  }
  const Status done = ask(w);
  if (!done.ok()) {
    add(Finding::Level::error, "command", at, with_places(done.error().message(), pin, other));
    return reported();
  }
  trace_.links.emplace(pin, at);
  if (pins) trace_.links.emplace(other, at);
  trace_.signals.emplace(pins ? pin : other, at);
  return done;
}

ScriptCheck::Done ScriptCheck::set_item(Words w, const ScriptPlace& at) {
  if (!machine_->view.find_item(w[1]) && is_unchecked(w[1])) {
    trace_.unchecked.push_back({w[1], "", at, Dir::unspecified});
    return Status{};
  }
  trace_.set_items.insert(w[1]);
  if (w.size() != 3) return std::nullopt;
  const Status done = ask(w);
  if (done.ok()) return done;
  add(Finding::Level::error, "command", at, with_places(done.error().message(), w[1], ""));
  return reported();
}

ScriptCheck::Done ScriptCheck::read_item(Words w, const ScriptPlace& at) {
  const auto& view = machine_->view;
  const auto functions = view.names(Kind::function);
  const bool known = view.find_item(w[1]).has_value() ||
                     std::find(functions.begin(), functions.end(), w[1]) != functions.end();
  if (known || !is_unchecked(w[1])) return std::nullopt;
  trace_.unchecked.push_back({w[1], "", at, Dir::unspecified});
  return Status{};
}

ScriptCheck::Done ScriptCheck::set_signal(Words w, const ScriptPlace& at) {
  trace_.set_signals.insert(w[1]);
  return read_signal(w, at);
}

ScriptCheck::Done ScriptCheck::read_signal(Words w, const ScriptPlace& /*at*/) {
  if (untyped_signals_.count(w[1]) > 0) return Status{};
  return std::nullopt;
}

ScriptCheck::Done ScriptCheck::delete_signal(Words w, const ScriptPlace& /*at*/) {
  const bool untyped = untyped_signals_.erase(w[1]) > 0;
  std::erase_if(trace_.unchecked, [&w](const UncheckedPin& pin) { return pin.signal == w[1]; });
  trace_.signals.erase(w[1]);
  if (untyped) return Status{};
  return std::nullopt;
}

ScriptCheck::Done ScriptCheck::new_signal(Words w, const ScriptPlace& at) {
  trace_.signals.emplace(w[1], at);
  untyped_signals_.erase(w[1]);
  return std::nullopt;
}

ScriptCheck::Done ScriptCheck::add_function(Words w, const ScriptPlace& at) {
  const auto functions = machine_->view.names(Kind::function);
  const bool known = std::find(functions.begin(), functions.end(), w[1]) != functions.end();
  if (!known && is_unchecked(w[1])) return Status{};
  const auto threads = machine_->view.names(Kind::thread);
  // The thread may be that of a component which could not be loaded.
  if (threads.empty() && known &&
      std::any_of(findings_.begin(), findings_.end(),
                  [](const Finding& f) { return f.level == Finding::Level::error; })) {
    trace_.added.emplace(w[1], at);
    return Status{};
  }
  const Status done = ask(w);
  if (done.ok()) {
    trace_.added.emplace(w[1], at);
    return done;
  }
  std::string text = done.error().message();
  if (const auto before = trace_.added.find(w[1]); before != trace_.added.end())
    text += "; it was added at " + before->second.text();
  return fail(done.error().code, text);
}

}  // namespace kerf::hal
