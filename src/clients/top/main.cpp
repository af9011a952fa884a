// linuxcnctop: the status of a running machine as text, once or as it changes.
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "clients/common/machine_view.hpp"
#include "clients/top/rows.hpp"
#include "rtapi/base/suggest.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/process.hpp"

namespace {

using namespace kerf;

constexpr const char* kUsage =
    "usage: linuxcnctop [-p | --once] [--json] [--interval SECONDS] [--instance NAME] [NAME ...]\n"
    "\n"
    "Shows the status of a running machine under the names of LinuxCNC's Python module, and goes "
    "on\n"
    "showing it. NAME: only these (position, task_state, ...).\n"
    "\n"
    "  -p, --once           print it once, a line a name, and end; so also when the output is no "
    "terminal\n"
    "  --json               print it once as one JSON object\n"
    "  --interval SECONDS   time between two looks (0.2)\n"
    "  --instance NAME      instance; default: KERF_INSTANCE, else by user id\n"
    "  -ini FILE            ignored, as screens are started with it (--ini too)\n"
    "  -h, --help           this text\n";

struct Options {
  bool once{false}, json{false};
  double interval_s{0.2};
  std::string instance{rtapi::default_instance()};
  std::vector<std::string> names;
};

int usage_error(const std::string& what) {
  std::fprintf(stderr, "linuxcnctop: %s\n%s", what.c_str(), kUsage);
  return 2;
}

/// 0: go on; else the exit status is the value minus one.
int read_options(int argc, char** argv, Options& options) {
  const auto known = clients::top::names();
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      std::fputs(kUsage, stdout);
      return 1;
    }
    if (word == "--once" || word == "-p") {
      options.once = true;
    } else if (word == "--json") {
      options.json = true;
    } else if (word == "--interval" || word == "--instance" || word == "-ini" || word == "--ini") {
      if (++i == argc) return 1 + usage_error(word + " needs a value");
      if (word == "--instance") options.instance = argv[i];
      if (word != "--interval") continue;
      char* end = nullptr;
      options.interval_s = std::strtod(argv[i], &end);
      if (end == argv[i] || *end != '\0' || !(options.interval_s >= 0.01))
        return 1 + usage_error("--interval " + std::string(argv[i]) +
                               ": expected seconds, at least 0.01");
    } else if (!word.empty() && word[0] == '-') {
      return 1 + usage_error("unknown option '" + word + "'");
    } else {
      bool found = false;
      for (const auto name : known) found = found || name == word;
      if (!found)
        return 1 +
               usage_error("no '" + word + "' in the status" + rtapi::did_you_mean(word, known));
      options.names.push_back(word);
    }
  }
  return 0;
}

/// "name  value", further lines of a value below it.
std::string page(const clients::Stat& stat, const std::vector<std::string>& wanted) {
  std::vector<std::string> shown = wanted;
  if (shown.empty())
    for (const auto name : clients::top::names()) shown.emplace_back(name);
  constexpr std::size_t kWidth = 24;
  std::string out;
  for (const std::string& name : shown) {
    const std::string value = clients::top::text(stat, name);
    std::string indent = name + std::string(name.size() < kWidth ? kWidth - name.size() : 1, ' ');
    for (std::size_t at = 0; at <= value.size();) {
      const auto end = std::min(value.find('\n', at), value.size());
      out += indent + value.substr(at, end - at) + "\n";
      indent = std::string(kWidth, ' ');
      at = end + 1;
    }
  }
  return out;
}

/// As much of it as the terminal has room for.
void show(const std::string& text) {
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 2;
  const std::size_t rows = known ? size.ws_row - 1U : 24U, columns = known ? size.ws_col : 80U;
  std::string out = "\033[H";
  std::size_t line = 0, at = 0;
  for (; at < text.size() && line < rows; ++line) {
    const auto end = text.find('\n', at);
    out += text.substr(at, std::min(end - at, columns)) + "\033[K\n";
    at = end + 1;
  }
  if (at < text.size()) out += "... more: name those that you want";
  out += "\033[J";
  std::fputs(out.c_str(), stdout);
  std::fflush(stdout);
}

int run(const Options& options) {
  rtapi::catch_stop_signals({SIGINT, SIGTERM, SIGHUP});
  auto view = clients::MachineView::attach(options.instance);
  if (!view.ok()) {
    std::fprintf(stderr, "linuxcnctop: %s\n", view.error().message().c_str());
    return 1;
  }
  if (options.json) {
    std::printf("%s\n", clients::top::json((*view)->stat(), options.names).c_str());
    return 0;
  }
  if (options.once || isatty(STDOUT_FILENO) != 1) {
    std::fputs(page((*view)->stat(), options.names).c_str(), stdout);
    return 0;
  }
  // Who looks at a screen has real time.
  const auto clock = rtapi::make_real_clock();
  const rtapi::StopOnSignal stop(*clock);
  std::fputs("\033[2J", stdout);
  while (!clock->stopped()) {
    // The memory of a machine that has ended stays readable here, as it was.
    const auto task = static_cast<pid_t>((*view)->task().pid);
    if (!(*view)->poll() || (task > 0 && !rtapi::process_lives(task, 0))) {
      std::fprintf(stderr, "linuxcnctop: the machine has ended\n");
      return 1;
    }
    show(page((*view)->stat(), options.names));
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + rtapi::seconds(options.interval_s));
    clock->wait(spec);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("linuxcnctop");
  Options options;
  if (const int end = read_options(argc, argv, options); end != 0) return end - 1;
  return run(options);
}
