#include "hal/cmd/prompt.hpp"

#include <editline/readline.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rtapi/clock/join_clock.hpp"

namespace kerf::hal {
namespace {

constexpr int kHistoryLines = 1000;

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

/// What may stand behind a command: kinds of names for its first word and for those after it, or fixed words.
struct Place {
  const char* command;
  std::vector<Kind> first;
  std::vector<Kind> rest;
  std::vector<std::string> words;
};
const std::vector<Kind> no_kind;
const std::vector<Kind> items{Kind::pin, Kind::param};
const std::vector<Kind> everything{Kind::pin,      Kind::param,  Kind::signal,
                                   Kind::function, Kind::thread, Kind::component};

const std::vector<Place>& places() {
  static const std::vector<Place> all_places{
      {"net", {Kind::signal}, {Kind::pin}, {}},
      {"linkps", {Kind::pin}, {Kind::signal}, {}},
      {"linksp", {Kind::signal}, {Kind::pin}, {}},
      {"linkpp", {Kind::pin}, {Kind::pin}, {}},
      {"unlinkp", {Kind::pin}, no_kind, {}},
      {"getp", items, no_kind, {}},
      {"setp", items, no_kind, {}},
      {"ptype", items, no_kind, {}},
      {"gets", {Kind::signal}, no_kind, {}},
      {"sets", {Kind::signal}, no_kind, {}},
      {"stype", {Kind::signal}, no_kind, {}},
      {"delsig", {Kind::signal}, no_kind, {"all"}},
      {"newsig", no_kind, no_kind, {}},
      {"addf", {Kind::function}, {Kind::thread}, {}},
      {"delf", {Kind::function}, {Kind::thread}, {}},
      {"unload", {Kind::component}, no_kind, {"all"}},
      {"unloadrt", {Kind::component}, no_kind, {"all"}},
      {"unloadusr", {Kind::component}, no_kind, {"all"}},
      {"waitusr", {Kind::component}, no_kind, {}},
      {"alias", no_kind, items, {"pin", "param"}},
      {"unalias", no_kind, items, {"pin", "param"}},
      {"lock", no_kind, no_kind, {"none", "tune", "all"}},
      {"unlock", no_kind, no_kind, {"tune", "all"}},
      {"status", no_kind, no_kind, {"lock", "mem", "all"}},
      {"timing", no_kind, everything, {"every", "sampled", "off", "reset"}},
      {"list", no_kind, everything, {"comp", "pin", "sig", "param", "funct", "thread"}},
      {"show",
       no_kind,
       everything,
       {"all", "alias", "comp", "pin", "pinexact", "sig", "param", "funct", "thread"}},
      {"save",
       no_kind,
       no_kind,
       {"all", "allu", "comp", "alias", "sig", "sigu", "link", "linka", "net", "neta", "netl",
        "netla", "param", "unconnectedinpins", "thread"}},
  };
  return all_places;
}

void add_names(const std::vector<Kind>& kinds) {
  for (const Kind kind : kinds) {
    const auto names = completing->view().names(kind);
    candidates.insert(candidates.end(), names.begin(), names.end());
  }
}

char** complete(const char* text, int start, int /*end*/) {
  candidates.clear();
  const std::string_view before(rl_line_buffer, static_cast<std::size_t>(start));
  const auto begin = before.find_first_not_of(" \t");
  if (begin == std::string_view::npos) {
    candidates = Commander::command_names();
  } else {
    const std::string_view line = before.substr(begin);
    const std::string_view command = line.substr(0, line.find_first_of(" \t"));
    const bool first = line.find_first_not_of(" \t", command.size()) == std::string_view::npos;
    const auto& all = places();
    const auto place =
        std::find_if(all.begin(), all.end(), [&](const Place& p) { return command == p.command; });
    if (command == "help") {
      candidates = Commander::command_names();
    } else if (place == all.end()) {
      add_names(everything);
    } else {
      add_names(first ? place->first : place->rest);
      if (first) candidates.insert(candidates.end(), place->words.begin(), place->words.end());
    }
  }
  // File names are for what loads files and programs.
  rl_attempted_completion_over = before.find("source") == std::string_view::npos &&
                                         before.find("load") == std::string_view::npos
                                     ? 1
                                     : 0;
  return rl_completion_matches(text, give_candidate);
}

std::string history_file() {
  const char* home = std::getenv("HOME");
  return home == nullptr || *home == '\0' ? std::string() : std::string(home) + "/.halcmd_history";
}

/// `check` and `graph` are done by another program, beside this one: they load components into a HAL of their own.
std::optional<rtapi::Status> run_beside(std::span<const std::string> words) {
  if (words[0] != "check" && words[0] != "graph") return std::nullopt;
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  std::string program = (self.parent_path() / "hal").string();
  std::vector<std::string> texts(words.begin(), words.end());
  std::vector<char*> argv{program.data()};
  for (auto& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  std::fflush(stdout);
  pid_t pid = -1;
  if (const int error =
          ::posix_spawn(&pid, program.c_str(), nullptr, nullptr, argv.data(), environ);
      error != 0)
    return rtapi::fail(rtapi::Errc::not_found, program + ": " + std::strerror(error));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  // It has said itself what is wrong.
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return rtapi::fail(rtapi::Errc::ok, "");
  return rtapi::Status{};
}

}  // namespace

bool run_interactive(Commander& commander) {
  commander.set_interceptor([](std::span<const std::string> words, const std::string& /*file*/,
                               int /*line*/) { return run_beside(words); });
  if (::isatty(STDIN_FILENO) == 0) return commander.run_file("-");
  completing = &commander;
  rl_readline_name = "halcmd";
  rl_attempted_completion_function = complete;
  const std::string history = history_file();
  ::using_history();
  ::stifle_history(kHistoryLines);
  if (!history.empty()) (void)::read_history(history.c_str());
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
  bool good = true;
  int number = 0;
  std::string last;
  while (!commander.quit_requested()) {
    char* line = ::readline("halcmd: ");
    if (line == nullptr) {
      std::puts("");
      break;
    }
    if (*line != '\0' && last != line) {
      ::add_history(line);
      last = line;
    }
    const auto clock = rtapi::make_real_clock();
    line_clock = clock.get();
    commander.set_clock(clock.get());
    good = commander.run_line(line, "<stdin>", ++number);
    commander.set_clock(nullptr);
    line_clock = nullptr;
    std::free(line);  // NOLINT(cppcoreguidelines-no-malloc): readline's
  }
  if (!history.empty()) (void)::write_history(history.c_str());
  completing = nullptr;
  return good;
}

}  // namespace kerf::hal
