// halcmd: HAL from the command line, from a file or interactively.
#include <getopt.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include "hal/client/user_component.hpp"
#include "hal/cmd/commander.hpp"
#include "hal/cmd/front_doors.hpp"
#include "hal/cmd/options.hpp"
#include "hal/cmd/prompt.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/log/log.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

rtapi::WaitClock* wait_clock = nullptr;  // for the signal handler

void on_signal(int /*signal*/) {
  if (wait_clock != nullptr) wait_clock->stop();
}

void print_help() {
  std::puts(
      "Usage: halcmd [OPTIONS] [COMMAND [ARGUMENT ...]]\n"
      "       halcmd [OPTIONS] -f [FILE]\n"
      "\n"
      "  -f [FILE]   commands from FILE (default: stdin), not from the command line\n"
      "  -i INI      values for [SECTION]KEY in commands\n"
      "  -k          keep going after a failed command\n"
      "  -q          print errors only (default)\n"
      "  -Q          print nothing\n"
      "  -s          output for scripts: no titles, one line each\n"
      "  -v          print the result of every command\n"
      "  -V          print more\n"
      "  -e          echo commands to stderr\n"
      "  -R          accepted; there is no lock to release\n"
      "  --json      show, list, status, getp, gets, ptype and stype print JSON\n"
      "  -h [NAME]   this text, or that of one command\n"
      "\n"
      "Without a command, commands are read interactively. They are:\n");
  std::fputs(hal::Commander::help_text("").c_str(), stdout);
}

/// Scripts of a known end hold the virtual clock while they run; a person or a pipe must not.
rtapi::Result<std::unique_ptr<rtapi::WaitClock>> choose_clock(rtapi::Segment& segment,
                                                              bool bounded) {
  if (bounded) return rtapi::join_clock(segment, rtapi::Role::user_component, "halcmd");
  return rtapi::make_real_clock();
}

int fail(const rtapi::Error& error) {
  rtapi::log_error(error);
  return 1;
}

int connect_and_run(hal::HalcmdOptions& options, const std::vector<std::string>& words) {
  const std::string instance = rtapi::default_instance();
  auto segment = rtapi::Segment::attach(instance);
  if (!segment.ok()) return fail(segment.error());
  auto session = hal::SocketSession::connect(**segment);
  if (!session.ok()) return fail(session.error());

  const std::string file = options.from_file ? (words.empty() ? "-" : words[0]) : "";
  struct stat st {};
  const bool bounded = options.from_file
                           ? file != "-" && ::stat(file.c_str(), &st) == 0 && S_ISREG(st.st_mode)
                           : !words.empty();
  auto clock = choose_clock(**segment, bounded);
  if (!clock.ok()) return fail(clock.error());
  wait_clock = clock->get();
  if (bounded) (*session)->use_clock(clock->get());

  // Shows itself as long as it runs, as scripts expect of `show comp`.
  hal::UserComponent self(**session, "halcmd" + std::to_string(::getpid()));
  if (auto ready = self.ready(); !ready.ok()) return fail(ready.error());
  hal::Commander commander(**session);
  commander.set_clock(clock->get());
  options.apply(commander);
  bool good = true;
  if (options.from_file)
    good = commander.run_file(file);
  else if (!words.empty())
    good = commander.run_words(words);
  else
    good = hal::run_interactive(commander);
  self.leave();
  session->reset();
  wait_clock = nullptr;
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("halcmd");
  hal::HalcmdOptions options;
  int c = 0;
  constexpr int kJson = 256;
  const option long_options[] = {
      {"help", no_argument, nullptr, 'h'}, {"json", no_argument, nullptr, kJson}, {}};
  // '+': the command's own words may begin with '-'.
  while ((c = ::getopt_long(argc, argv, "+efi:kqQRsvVh", long_options, nullptr)) != -1) {
    if (c == 'h') {
      if (optind < argc)
        std::fputs(hal::Commander::help_text(argv[optind]).c_str(), stdout);
      else
        print_help();
      return 0;
    }
    if (c == kJson) {
      options.json = true;
      continue;
    }
    if (!options.take(c, optarg)) return 255;
  }
  std::vector<std::string> words(argv + optind, argv + argc);
  if (!options.from_file && !words.empty() && (words[0] == "check" || words[0] == "graph")) {
    if (!options.ini_path.empty()) words.insert(words.end(), {"-i", options.ini_path});
    if (options.json) words.emplace_back("--json");
    return words[0] == "check" ? hal::check_main(words) : hal::graph_main(words);
  }
  if (!options.load_ini()) return 1;
  struct sigaction action {};
  action.sa_handler = on_signal;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  return connect_and_run(options, words);
}
