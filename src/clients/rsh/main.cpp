// linuxcncrsh: a text shell over TCP for a running machine.
#include <getopt.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "clients/common/machine_view.hpp"
#include "clients/rsh/live_machine.hpp"
#include "clients/rsh/server.hpp"
#include "clients/rsh/text.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"
#include "task/api/client.hpp"

namespace {

using namespace kerf;

constexpr const char* kUsage =
    "usage: linuxcncrsh [OPTIONS] [-- -ini FILE]\n"
    "\n"
    "Listens on a TCP port for people and programs that command a running machine by lines of\n"
    "text: telnet or nc will do. Only this computer may connect, unless --listen says otherwise.\n"
    "\n"
    "  -p, --port PORT           port; default 5007; 0: a free one, which is printed\n"
    "  -l, --listen ADDRESS      address to listen on; default 127.0.0.1; any: all of IPv4\n"
    "  -n, --name NAME           server name in the answer to HELLO; default EMCNETSVR\n"
    "  -w, --connectpw PASSWORD  password of HELLO; default EMC\n"
    "  -e, --enablepw PASSWORD   password of SET ENABLE; default EMCTOO\n"
    "  -s, --sessions N          at most so many connections; default -1: no limit\n"
    "  -d, --path FOLDER         SET OPEN looks for programs there too\n"
    "      --instance NAME       instance; default: KERF_INSTANCE, else by user id\n"
    "      --man                 print the list of commands as it stands in the manual page\n"
    "  -h, --help                this text\n"
    "  -ini FILE                 the machine's INI file; default: that of the running machine\n";

struct Options {
  rsh::Server::Options server;
  rsh::Shell shell;
  std::string ini;
  std::string instance{rtapi::default_instance()};
};

int usage_error(const std::string& what) {
  std::fprintf(stderr, "linuxcncrsh: %s\n%s", what.c_str(), kUsage);
  return 2;
}

/// Takes `-ini FILE` and the `--` before it out of the words: it is not spelt as other options are.
bool take_ini(std::vector<char*>& words, std::string& ini) {
  for (std::size_t i = 1; i < words.size();) {
    const std::string word = words[i];
    if (word == "--") {
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (word == "-ini" || word == "--ini") {
      if (i + 1 == words.size()) return false;
      ini = words[i + 1];
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i),
                  words.begin() + static_cast<std::ptrdiff_t>(i + 2));
    } else {
      ++i;
    }
  }
  return true;
}

bool read_number(const char* text, long least, long most, int& out) {
  const auto value = rsh::to_integer(text);
  if (!value || *value < least || *value > most) return false;
  out = static_cast<int>(*value);
  return true;
}

/// 0: go on; else the exit status is the value minus one.
int read_options(int argc, char** argv, Options& o) {
  std::vector<char*> words(argv, argv + argc);
  if (!take_ini(words, o.ini)) return 1 + usage_error("-ini needs a value");
  constexpr int kInstance = 256, kMan = 257;  // options without a letter
  const option known[]{{"port", required_argument, nullptr, 'p'},
                       {"listen", required_argument, nullptr, 'l'},
                       {"name", required_argument, nullptr, 'n'},
                       {"connectpw", required_argument, nullptr, 'w'},
                       {"enablepw", required_argument, nullptr, 'e'},
                       {"sessions", required_argument, nullptr, 's'},
                       {"path", required_argument, nullptr, 'd'},
                       {"instance", required_argument, nullptr, kInstance},
                       {"man", no_argument, nullptr, kMan},
                       {"help", no_argument, nullptr, 'h'},
                       {nullptr, 0, nullptr, 0}};
  words.push_back(nullptr);
  const int count = static_cast<int>(words.size()) - 1;
  opterr = 0;
  for (int c = 0;
       (c = getopt_long(count, words.data(), ":p:l:n:w:e:s:d:h", known, nullptr)) != -1;) {
    switch (c) {
      case 'p':
        if (!read_number(optarg, 0, 65535, o.server.port))
          return 1 + usage_error("--port " + std::string(optarg) + ": expected 0 to 65535");
        break;
      case 's':
        if (!read_number(optarg, -1, 100000, o.server.max_sessions))
          return 1 + usage_error("--sessions " + std::string(optarg) + ": expected -1 or more");
        break;
      case 'l': o.server.address = optarg; break;
      case 'n': o.shell.name = optarg; break;
      case 'w': o.shell.connect_password = optarg; break;
      case 'e': o.shell.enable_password = optarg; break;
      case 'd': o.shell.program_folder = optarg; break;
      case kInstance: o.instance = optarg; break;
      case kMan: std::fputs(rsh::manual_list().c_str(), stdout); return 1;
      case 'h': std::fputs(kUsage, stdout); return 1;
      case ':':
        return 1 + usage_error(std::string(words[static_cast<std::size_t>(optind) - 1]) +
                               " needs a value");
      default:
        return 1 + usage_error("unknown option '" +
                               std::string(words[static_cast<std::size_t>(optind) - 1]) + "'");
    }
  }
  if (optind < count)
    return 1 +
           usage_error("unexpected '" + std::string(words[static_cast<std::size_t>(optind)]) + "'");
  return 0;
}

int fail_with(const rtapi::Error& error) {
  std::fprintf(stderr, "linuxcncrsh: %s\n", error.message().c_str());
  return 1;
}

/// Ends the server when task has gone, and when a session asked for it.
class Watch final : public rtapi::Participant {
 public:
  Watch(rsh::Server& server, task::Client& task, const rsh::Shell& shell, rtapi::WaitClock& clock)
      : server_(server), task_(task), shell_(shell), clock_(clock) {}
  [[nodiscard]] const char* name() const noexcept override { return server_.name(); }
  [[nodiscard]] rtapi::Role role() const noexcept override { return server_.role(); }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override {
    server_.step(now, next);
    (void)task_.poll();
    if (!task_.connected() || shell_.shutdown) return clock_.stop();
    next.watch_fd(task_.fd());
  }

 private:
  rsh::Server& server_;
  task::Client& task_;
  const rsh::Shell& shell_;
  rtapi::WaitClock& clock_;
};

/// A HAL file may start this program before task is there.
rtapi::Result<std::unique_ptr<clients::MachineView>> attach(const std::string& instance,
                                                            rtapi::WaitClock& patience) {
  constexpr int kTries = 600;
  for (int tries = 1;; ++tries) {
    auto view = clients::MachineView::attach(instance);
    if (view.ok() || view.error().code != rtapi::Errc::not_found || tries == kTries ||
        patience.stopped())
      return view;
    if (tries == 20)
      std::fprintf(stderr, "linuxcncrsh: waiting: %s\n", view.error().message().c_str());
    rtapi::WaitSpec spec;
    spec.wake_at(patience.now() + 100 * rtapi::kMillisecond);
    patience.wait(spec);
  }
}

rtapi::Result<std::unique_ptr<clients::MachineView>> attach(const std::string& instance) {
  const auto clock = rtapi::make_real_clock();
  const rtapi::StopOnSignal stop(*clock);
  return attach(instance, *clock);
}

/// Ends the whole machine: its owner takes everything down, this program too.
void end_machine(const rtapi::Segment& segment) {
  const auto& header = segment.header();
  const auto pid = header.owner_pid.observe();
  if (pid > 1 && rtapi::process_lives(pid, header.owner_start))
    (void)::kill(static_cast<pid_t>(pid), SIGTERM);
}

int run(Options& options) {
  rtapi::catch_stop_signals({SIGINT, SIGTERM, SIGHUP});
  auto view = attach(options.instance);
  if (!view.ok()) return rtapi::stop_signal_came() ? 0 : fail_with(view.error());
  const std::string ini = options.ini.empty() ? (*view)->stat().ini_filename : options.ini;
  auto answers = rsh::IniAnswers::load(ini);
  if (!answers.ok()) return fail_with(answers.error());
  auto task = task::Client::connect((*view)->segment());
  if (!task.ok()) return fail_with(task.error());

  rsh::Server server(options.shell, [&]() -> rtapi::Result<std::unique_ptr<rsh::Machine>> {
    auto client = task::Client::connect((*view)->segment());
    if (!client.ok()) return rtapi::Failure{client.error()};
    return std::unique_ptr<rsh::Machine>(
        new rsh::LiveMachine(**view, std::move(*client), *answers, options.shell.program_folder));
  });
  server.watch((*view)->task_shared().status_cell, (*view)->task_shared().reply_cell);
  if (auto listening = server.listen(options.server); !listening.ok())
    return fail_with(listening.error());
  auto clock = rtapi::join_clock((*view)->segment(), server.role(), server.name());
  if (!clock.ok()) return fail_with(clock.error());
  std::printf("linuxcncrsh: listening on %s\n", server.place().c_str());
  std::fflush(stdout);
  {
    const rtapi::StopOnSignal stop(**clock);
    Watch watch(server, **task, options.shell, **clock);
    rtapi::run_participant(**clock, watch);
  }
  if (options.shell.shutdown) end_machine((*view)->segment());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("linuxcncrsh");
  Options options;
  if (const int end = read_options(argc, argv, options); end != 0) return end - 1;
  return run(options);
}
