#include "hal/cmd/prompt.hpp"

#include <editline/readline.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "rtapi/clock/join_clock.hpp"

namespace kerf::hal {
namespace {

// libedit's callbacks have no argument of ours.
const Commander* completing = nullptr;
std::vector<std::string> candidates;
std::size_t next_candidate = 0;

rtapi::WaitClock* line_clock = nullptr;

/// Ctrl-C ends what the present command waits for, and the session goes on. The other signals end the session: without its
/// input the editor gives the end of file.
void on_signal(int signal) {
  if (line_clock != nullptr) line_clock->stop();
  if (signal != SIGINT) ::close(STDIN_FILENO);
}

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
  if (start == 0) {
    candidates = Commander::command_names();
  } else {
    for (const Kind kind :
         {Kind::pin, Kind::param, Kind::signal, Kind::function, Kind::thread, Kind::component}) {
      const auto names = completing->view().names(kind);
      candidates.insert(candidates.end(), names.begin(), names.end());
    }
  }
  rl_attempted_completion_over = 1;  // no file names
  return rl_completion_matches(text, give_candidate);
}

}  // namespace

bool run_interactive(Commander& commander) {
  if (::isatty(STDIN_FILENO) == 0) return commander.run_file("-");
  completing = &commander;
  rl_readline_name = "halcmd";
  rl_attempted_completion_function = complete;
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
  bool good = true;
  int number = 0;
  while (!commander.quit_requested()) {
    char* line = ::readline("halcmd: ");
    if (line == nullptr) {
      std::puts("");
      break;
    }
    if (*line != '\0') ::add_history(line);
    const auto clock = rtapi::make_real_clock();
    line_clock = clock.get();
    commander.set_clock(clock.get());
    good = commander.run_line(line, "<stdin>", ++number);
    commander.set_clock(nullptr);
    line_clock = nullptr;
    std::free(line);  // NOLINT(cppcoreguidelines-no-malloc): readline's
  }
  completing = nullptr;
  return good;
}

}  // namespace kerf::hal
