#include "hal/tcl/prompt.hpp"

#include <editline/readline.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <vector>

#include "hal/tcl/script.hpp"
#include "rtapi/log/log.hpp"

namespace kerf::hal::tcl {
namespace {

// libedit's callbacks have no argument of ours.
TclHal* completing = nullptr;
std::vector<std::string> candidates;
std::size_t next_candidate = 0;
volatile sig_atomic_t typing = 0;

char* give_candidate(const char* text, int state) {
  if (state == 0) next_candidate = 0;
  while (next_candidate < candidates.size()) {
    const std::string& c = candidates[next_candidate++];
    if (c.rfind(text, 0) == 0) return ::strdup(c.c_str());
  }
  return nullptr;
}

char** complete(const char* text, int start, int /*end*/) {
  candidates.clear();
  rl_attempted_completion_over = 1;  // no file names
  auto halcmd = completing->commander();
  if (start == 0) {
    candidates = Commander::command_names();
  } else if (halcmd.ok()) {
    for (const Kind kind :
         {Kind::pin, Kind::param, Kind::signal, Kind::function, Kind::thread, Kind::component}) {
      const auto names = (*halcmd)->view().names(kind);
      candidates.insert(candidates.end(), names.begin(), names.end());
    }
  }
  return rl_completion_matches(text, give_candidate);
}

std::optional<std::string> next_line(bool terminal, bool first) {
  char* line = nullptr;
  if (terminal) {
    typing = 1;
    line = ::readline(first ? "haltcl: " : "> ");
    typing = 0;
    if (line == nullptr) {
      std::puts("");
      return std::nullopt;
    }
    if (*line != '\0') ::add_history(line);
  } else {
    std::size_t capacity = 0;
    if (::getline(&line, &capacity, stdin) < 0) {
      std::free(line);  // NOLINT(cppcoreguidelines-no-malloc): getline's
      return std::nullopt;
    }
  }
  std::string out(line);
  std::free(line);  // NOLINT(cppcoreguidelines-no-malloc): readline's
  if (out.empty() || out.back() != '\n') out += '\n';
  return out;
}

void evaluate(Tcl_Interp* interpreter, const std::string& command) {
  const int code = Tcl_RecordAndEval(interpreter, command.c_str(), TCL_EVAL_GLOBAL);
  if (Tcl_Channel out = Tcl_GetStdChannel(TCL_STDOUT); out != nullptr) Tcl_Flush(out);
  const std::string result = Tcl_GetStringResult(interpreter);
  if (code == TCL_ERROR)
    std::fprintf(stderr, "%s\n", result.c_str());
  else if (!result.empty())
    std::printf("%s\n", result.c_str());
  std::fflush(stdout);
}

}  // namespace

bool at_prompt() { return typing != 0; }

bool run_prompt(TclHal& words, const ini::IniFile* ini, const std::string& program,
                const std::function<void()>& before) {
  auto interpreter = Interpreter::create(words, ini);
  if (!interpreter.ok()) {
    rtapi::log_error(interpreter.error());
    return false;
  }
  (*interpreter)->set_arguments(program, {});
  const bool terminal = ::isatty(STDIN_FILENO) != 0;
  Tcl_SetVar((*interpreter)->tcl(), "tcl_interactive", terminal ? "1" : "0", TCL_GLOBAL_ONLY);
  completing = &words;
  rl_readline_name = "haltcl";
  rl_attempted_completion_function = complete;
  std::string command;
  while (auto line = next_line(terminal, command.empty())) {
    command += *line;
    if (Tcl_CommandComplete(command.c_str()) == 0) continue;
    before();
    evaluate((*interpreter)->tcl(), command);
    command.clear();
  }
  completing = nullptr;
  return true;
}

}  // namespace kerf::hal::tcl
