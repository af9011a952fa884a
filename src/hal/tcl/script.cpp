#include "hal/tcl/script.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>

#include "hal/cmd/words.hpp"

namespace kerf::hal::tcl {

using rtapi::Errc;
using rtapi::fail;
using rtapi::Result;
using rtapi::Status;

namespace {

constexpr int kDeepestSource = 20;

std::string result_text(Tcl_Interp* interpreter) { return Tcl_GetStringResult(interpreter); }

/// FILE:LINE of the innermost file that Tcl's trace names: `(file "x.tcl" line 3)`.
std::string place_in(const std::string& trace) {
  static constexpr std::string_view kFile = "(file \"";
  static constexpr std::string_view kLine = "\" line ";
  const auto begin = trace.find(kFile);
  if (begin == std::string::npos) return {};
  const auto name = begin + kFile.size();
  const auto middle = trace.find(kLine, name);
  const auto end = middle == std::string::npos ? middle : trace.find(')', middle);
  if (end == std::string::npos) return {};
  return trace.substr(name, middle - name) + ":" +
         trace.substr(middle + kLine.size(), end - middle - kLine.size()) + ": ";
}

Result<std::string> text_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  if (in) text << in.rdbuf();
  if (!in)
    return fail(Errc::not_found, "cannot read HAL file '" + path + "': " + std::strerror(errno));
  return text.str();
}

/// What scripts have written comes before what others write.
void flush_tcl() {
  if (Tcl_Channel out = Tcl_GetStdChannel(TCL_STDOUT); out != nullptr) Tcl_Flush(out);
}

int refuse_exit(void* /*data*/, Tcl_Interp* interpreter, int /*count*/, Tcl_Obj* const* /*words*/) {
  Tcl_SetObjResult(interpreter,
                   Tcl_NewStringObj("exit: HAL files after this one are still to be done; end this "
                                    "one with return",
                                    -1));
  return TCL_ERROR;
}

}  // namespace

TwoPassOptions TwoPassOptions::parse(std::string_view text) {
  TwoPassOptions options;
  std::string word;
  for (const char c : std::string(text) + ",") {
    if (c != ',' && c != ' ' && c != '\t') {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      continue;
    }
    // `nodelete` is about temporary files, of which there are none.
    if (word == "verbose") options.verbose = true;
    word.clear();
  }
  return options;
}

bool is_tcl_file(std::string_view path) {
  return path.size() >= 4 && path.substr(path.size() - 4) == ".tcl";
}

// ---- Interpreter --------------------------------------------------------------------------------

Result<std::unique_ptr<Interpreter>> Interpreter::create(TclHal& words, const ini::IniFile* ini) {
  static const bool found = [] {
    Tcl_FindExecutable(nullptr);
    return true;
  }();
  (void)found;
  std::unique_ptr<Interpreter> out(new Interpreter(Tcl_CreateInterp()));
  if (Tcl_Init(out->interpreter_) != TCL_OK)
    return fail(Errc::not_found, "Tcl does not start: " + result_text(out->interpreter_));
  words.install(out->interpreter_);
  Tcl_PkgProvide(out->interpreter_, "Hal", "1.0");
  if (ini != nullptr && TclHal::set_ini_arrays(out->interpreter_, *ini) != TCL_OK)
    return fail(Errc::bad_argument, ini->name() + ": " + result_text(out->interpreter_));
  return out;
}

Interpreter::~Interpreter() { Tcl_DeleteInterp(interpreter_); }

void Interpreter::set_arguments(const std::string& program,
                                const std::vector<std::string>& arguments) {
  Tcl_Obj* list = Tcl_NewListObj(0, nullptr);
  for (const auto& a : arguments)
    Tcl_ListObjAppendElement(nullptr, list, Tcl_NewStringObj(a.c_str(), -1));
  Tcl_SetVar2Ex(interpreter_, "argv", nullptr, list, TCL_GLOBAL_ONLY);
  Tcl_SetVar2Ex(interpreter_, "argc", nullptr, Tcl_NewIntObj(static_cast<int>(arguments.size())),
                TCL_GLOBAL_ONLY);
  Tcl_SetVar(interpreter_, "argv0", program.c_str(), TCL_GLOBAL_ONLY);
  Tcl_SetVar(interpreter_, "tcl_interactive", "0", TCL_GLOBAL_ONLY);
}

void Interpreter::set_pass_number(int number) {
  const std::string script =
      "namespace eval ::tp {proc passnumber {} {return " + std::to_string(number) + "}}";
  Tcl_Eval(interpreter_, script.c_str());
}

void Interpreter::forbid_exit() {
  Tcl_CreateObjCommand(interpreter_, "exit", &refuse_exit, nullptr, nullptr);
}

Result<void, std::string> Interpreter::run_file(const std::string& path) {
  // HAL files are UTF-8, as INI files are, whatever the locale.
  Tcl_Obj* name = Tcl_NewStringObj(path.c_str(), -1);
  Tcl_IncrRefCount(name);
  const int code = Tcl_FSEvalFileEx(interpreter_, name, "utf-8");
  Tcl_DecrRefCount(name);
  if (code == TCL_OK || code == TCL_RETURN) return {};
  const std::string message = result_text(interpreter_);
  const char* trace = Tcl_GetVar(interpreter_, "::errorInfo", TCL_GLOBAL_ONLY);
  const std::string full = trace != nullptr && *trace != '\0' ? trace : message;
  return rtapi::Failure{place_in(full) + full};
}

// ---- ScriptRunner -------------------------------------------------------------------------------

ScriptRunner::ScriptRunner(TclHal& words, const ini::IniFile* ini, CommandSink* sink)
    : words_(words), ini_(ini), sink_(sink != nullptr ? sink : &default_sink_) {
  if (ini_ != nullptr) lookup_ = ini_lookup(*ini_);
  words_.set_ini(lookup_);
}

Result<Commander*> ScriptRunner::halcmd() {
  if (!halcmd_) {
    KERF_TRY(const Attachment attached, words_.attachment());
    halcmd_ = std::make_unique<Commander>(*attached.session, lookup_, sink_);
    halcmd_->set_clock(attached.clock);
  }
  return halcmd_.get();
}

/// Prints the reason, unless it has been printed.
bool ScriptRunner::failed(const std::string& text) {
  if (!text.empty()) sink_->err(text + "\n");
  return false;
}

bool ScriptRunner::run_file(const HalFile& file) {
  auto interpreter = Interpreter::create(words_, ini_);
  if (!interpreter.ok()) return failed(interpreter.error().message());
  (*interpreter)->set_arguments(program_, file.arguments);
  if (exit_forbidden_) (*interpreter)->forbid_exit();
  const auto done = (*interpreter)->run_file(file.path);
  flush_tcl();
  return done.ok() || failed(done.error());
}

void ScriptRunner::detail(const std::string& text) const {
  if (!verbose_) return;
  std::printf("twopass: %s\n", text.c_str());
  std::fflush(stdout);
}

bool ScriptRunner::run_two_pass(std::span<const HalFile> files, const TwoPassOptions& options) {
  verbose_ = options.verbose;
  words_.set_hal_file_reader([this](const std::string& path) { return read_hal_file(path); });
  detail("pass0:BEGIN");
  bool good = run_excluded(files) && run_pass(files, Pass::collect) && run_merged();
  if (good) {
    detail("pass0:END");
    detail("pass1:BEGIN");
    good = run_pass(files, Pass::execute);
    if (good) detail("pass1:END");
  }
  words_.set_pass(Pass::single);
  words_.set_hal_file_reader({});
  return good;
}

/// Files with #NOTWOPASS are done before all others, as halcmd -k -v does them.
bool ScriptRunner::run_excluded(std::span<const HalFile> files) {
  for (const auto& file : files) {
    detail("found " + file.path);
    auto text = text_of_file(file.path);
    if (!text.ok()) return failed(text.error().message());
    if (is_tcl_file(file.path) || !is_excluded(*text)) continue;
    detail("sourcing " + file.path + " without two passes");
    auto commander = halcmd();
    if (!commander.ok()) return failed(commander.error().message());
    (*commander)->set_level(Commander::Level::verbose);
    (*commander)->set_keep_going(true);
    (void)(*commander)->run_file(file.path);
    halcmd_.reset();
  }
  return true;
}

bool ScriptRunner::run_pass(std::span<const HalFile> files, Pass pass) {
  words_.set_pass(pass);
  // One interpreter a pass: files of a pass share their variables, and lists that the first pass made do not grow in the second.
  auto interpreter = Interpreter::create(words_, ini_);
  if (!interpreter.ok()) return failed(interpreter.error().message());
  (*interpreter)->set_pass_number(pass == Pass::collect ? 0 : 1);
  (*interpreter)->forbid_exit();
  for (const auto& file : files) {
    if (is_tcl_file(file.path)) {
      detail("sourcing " + file.path);
      (*interpreter)->set_arguments(program_, file.arguments);
      const auto done = (*interpreter)->run_file(file.path);
      flush_tcl();
      if (!done.ok()) return failed(done.error());
      continue;
    }
    const auto text = text_of_file(file.path);
    if (text.ok() && is_excluded(*text)) continue;
    detail("sourcing " + file.path);
    if (const Status done = read_hal_file(file.path); !done.ok())
      return failed(done.error().message());
  }
  return true;
}

bool ScriptRunner::run_merged() {
  for (const auto& module : words_.loads().modules()) {
    std::vector<std::string> words = module.words();
    std::string line = "loadrt";
    for (const auto& word : words) line += " " + word;
    detail(line);
    words.insert(words.begin(), "loadrt");
    const auto outcome = words_.run(words, module.places.front());
    if (!outcome.ok) return failed(module.places_text() + ": " + line + "\n" + outcome.result);
  }
  return true;
}

Status ScriptRunner::read_hal_file(const std::string& path) {
  if (depth_ >= kDeepestSource)
    return fail(Errc::bad_argument,
                path + ": source is nested too deep; does a file source itself?");
  KERF_TRY(const std::string text, text_of_file(path));
  ++depth_;
  Status done;
  std::istringstream in(text);
  std::string line, joined;
  int number = 0, first = 0;
  while (done.ok() && std::getline(in, line)) {
    ++number;
    if (first == 0) first = number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty() && line.back() == '\\') {
      joined += line.substr(0, line.size() - 1) + ' ';
      if (in.peek() != std::char_traits<char>::eof()) continue;
      line.clear();
    }
    done = do_line(joined + line, {path, first});
    joined.clear();
    first = 0;
  }
  --depth_;
  return done;
}

Status ScriptRunner::do_line(const std::string& line, const Place& at) {
  const auto wrong = [&](const rtapi::Error& e) {
    return fail(e.code, at.text() + ": " + e.message());
  };
  auto text = substitute(without_comment(line), lookup_);
  if (!text.ok()) return wrong(text.error());
  auto words = split_words(*text);
  if (!words.ok()) return wrong(words.error());
  if (words->empty()) return {};
  if (words->front() != "print")
    for (auto& word : *words) word = unquoted(word);
  return do_words(std::move(*words), line, at);
}

Status ScriptRunner::do_words(std::vector<std::string> words, const std::string& line,
                              const Place& at) {
  const bool collecting = words_.pass() == Pass::collect;
  if (words[0] == "source" && words.size() == 2) return read_hal_file(words[1]);
  if (words[0] == "loadrt") {
    if (!collecting) return {};
    const auto added = words_.loads().add(std::span<const std::string>(words).subspan(1), at);
    return added.ok() ? added
                      : fail(added.error().code, at.text() + ": " + added.error().message());
  }
  if ((words[0] == "loadusr") != collecting) return {};
  if (collecting) detail("pass0: " + line);
  KERF_TRY(Commander * commander, halcmd());
  if (commander->run_line(line, at.file, at.line)) return {};
  return fail(Errc::ok, "");  // printed, with its place
}

}  // namespace kerf::hal::tcl
