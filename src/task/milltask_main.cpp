// milltask: the process of task.
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <future>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "hal/client/session.hpp"
#include "ini/ini_file.hpp"
#include "io/tool_store.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/thread/cyclic_thread.hpp"
#include "task/machine_config.hpp"
#include "task/task.hpp"

namespace {

using namespace kerf;

constexpr const char* kUsage =
    "usage: milltask --ini FILE [--instance NAME | --check]\n"
    "\n"
    "Interprets G-code and sequences the machine of a running instance: started by kerf, which\n"
    "gives it KERF_INSTANCE and KERF_SUPERVISOR_FD, and ended by it.\n"
    "\n"
    "  --ini FILE        machine file (-ini FILE works too)\n"
    "  --instance NAME   instance; default: KERF_INSTANCE, else by user id\n"
    "  --check           only report what is wrong with the INI file and the tool table\n";

struct Options {
  std::string ini;
  std::string instance{rtapi::default_instance()};
  bool check{false};
};

int usage_error(const std::string& what) {
  std::fprintf(stderr, "milltask: %s\n%s", what.c_str(), kUsage);
  return 2;
}

/// 0: go on; else the exit status is the value minus one.
int read_options(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      std::fputs(kUsage, stdout);
      return 1;
    }
    if (word == "--check") {
      options.check = true;
      continue;
    }
    if (word != "--ini" && word != "-ini" && word != "--instance")
      return 1 +
             usage_error("unknown option '" + word + "': expected --ini, --instance or --check");
    if (++i == argc) return 1 + usage_error(word + " needs a value");
    (word == "--instance" ? options.instance : options.ini) = argv[i];
  }
  if (options.ini.empty()) return 1 + usage_error("--ini FILE is missing");
  return 0;
}

/// Says when it is time to end: a signal, or the end of the supervisor.
class Ending {
 public:
  Ending() {
    sigset_t set;
    ::sigemptyset(&set);
    for (const int s : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&set, s);
    // Before any thread exists, so that all threads inherit it.
    ::sigprocmask(SIG_BLOCK, &set, nullptr);
    ::signal(SIGPIPE, SIG_IGN);
    signal_fd_ = ::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    if (const char* fd = std::getenv("KERF_SUPERVISOR_FD"); fd != nullptr && *fd != '\0')
      supervisor_ = std::atoi(fd);
  }
  /// True: end now. Waits at most `ms` (-1: for ever).
  bool wait(int ms) const {
    pollfd fds[2]{{signal_fd_, POLLIN, 0}, {supervisor_, POLLIN | POLLHUP, 0}};
    if (::poll(fds, supervisor_ >= 0 ? 2 : 1, ms) <= 0) return false;
    if ((fds[0].revents & POLLIN) != 0) {
      say_who_asked();
      return true;
    }
    if (fds[1].revents == 0) return false;
    char byte = 0;
    // Data on the line means nothing; only its end does.
    return ::read(supervisor_, &byte, 1) <= 0;
  }

 private:
  /// A machine that goes down in the middle of a program must not be a riddle: other programs look for processes named milltask, too.
  void say_who_asked() const {
    signalfd_siginfo info{};
    if (::read(signal_fd_, &info, sizeof info) != sizeof info || info.ssi_code != SI_USER) return;
    const auto sender = static_cast<pid_t>(info.ssi_pid);
    if (sender == ::getppid() || sender == ::getpid()) return;
    std::string name;
    std::ifstream("/proc/" + std::to_string(sender) + "/comm") >> name;
    std::fprintf(stderr, "milltask: process %d (%s) asked it to end (%s)\n", sender,
                 name.empty() ? "gone already" : name.c_str(),
                 ::strsignal(static_cast<int>(info.ssi_signo)));
  }
  int signal_fd_{-1};
  int supervisor_{-1};
};

/// A thread for one participant; or on virtual time, where one runs at a time anyway, for all.
class Runner {
 public:
  /// Returns when the thread has joined the clock: the order of joining is the order at one instant.
  rtapi::Status start(rtapi::Segment& segment, std::span<rtapi::Participant* const> participants) {
    std::promise<rtapi::Status> joined;
    auto result = joined.get_future();
    // The heartbeat and an operator's stop must not wait for other programs. On virtual time there is no hurry.
    const bool hurries = rtapi::clock_mode(segment) == rtapi::ClockMode::real &&
                         participants.front()->role() == rtapi::Role::task_command;
    thread_ = std::thread([this, &segment, participants, hurries, &joined] {
      auto shared = rtapi::SharedThread::join(segment, participants);
      if (!shared.ok()) return joined.set_value(rtapi::Failure{shared.error()});
      shared_ = std::move(*shared);
      joined.set_value({});
      if (hurries) (void)rtapi::prefer_this_thread();
      shared_->run();
    });
    return result.get();
  }
  void stop() {
    if (shared_) shared_->stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::unique_ptr<rtapi::SharedThread> shared_;
  std::thread thread_;
};

int fail_with(const rtapi::Error& error) {
  std::fprintf(stderr, "milltask: %s\n", error.message().c_str());
  return 1;
}

/// False: told to end, or failed (`status` then is 1).
bool wait_for_motion(task::Task& task, const Ending& ending, int& status) {
  constexpr int kStepMs = 20, kNoticeMs = 5000, kLimitMs = 60000;
  for (int waited = 0;; waited += kStepMs) {
    auto connected = task.connect();
    if (connected.ok()) return true;
    if (connected.error().code != rtapi::Errc::not_found || waited >= kLimitMs) {
      status = fail_with(connected.error());
      return false;
    }
    if (waited == kNoticeMs)
      std::fprintf(stderr, "milltask: waiting: %s\n", connected.error().message().c_str());
    if (ending.wait(kStepMs)) return false;
  }
}

/// The session on which HAL pins are made: the host may be starting still.
rtapi::Result<std::unique_ptr<hal::SocketSession>> open_session(rtapi::Segment& segment,
                                                                const Ending& ending) {
  for (int tries = 0;; ++tries) {
    auto session = hal::SocketSession::connect(segment);
    if (session.ok() || tries >= 250 || ending.wait(20)) return session;
  }
}

/// The complaints that would keep this machine from starting, and the warnings.
int check(const Options& options) {
  auto loaded = ini::IniFile::load(options.ini);
  for (const auto& d : loaded.diagnostics) std::fprintf(stderr, "%s\n", d.message().c_str());
  if (!loaded.ok) return 1;
  const task::SetupResult read = task::read_machine_setup(loaded.file);
  std::fputs(read.text().c_str(), stderr);
  io::ToolStore tools(read.setup.tools.table_file, read.setup.linear_unit_mm,
                      read.setup.tools.random_changer);
  const auto loaded_tools = tools.load();
  const bool absent = !loaded_tools.ok() && loaded_tools.error().code == rtapi::Errc::not_found;
  if (!loaded_tools.ok())
    std::fprintf(stderr, "%s: %s\n", absent ? "warning: no tool table" : "error",
                 loaded_tools.error().message().c_str());
  return read.ok && (loaded_tools.ok() || absent) ? 0 : 1;
}

int run(const Options& options) {
  const Ending ending;
  auto loaded = ini::IniFile::load(options.ini);
  for (const auto& d : loaded.diagnostics)
    std::fprintf(stderr, "milltask: %s\n", d.message().c_str());
  if (!loaded.ok) return 1;
  auto segment = rtapi::Segment::attach(options.instance);
  if (!segment.ok()) return fail_with(segment.error());
  auto session = open_session(**segment, ending);
  if (!session.ok()) return fail_with(session.error());

  task::TaskOptions task_options;
  task_options.pid = ::getpid();
  task_options.journal_thread = true;
  task::Task task(loaded.file, **segment, session->get(), task_options);
  if (auto prepared = task.prepare(); !prepared.ok()) return fail_with(prepared.error());
  std::fputs(task.warnings().c_str(), stderr);
  int status = 0;
  if (!wait_for_motion(task, ending, status)) return status;

  const std::vector<rtapi::Participant*> participants = task.participants();
  const bool shares = rtapi::clock_mode(**segment) == rtapi::ClockMode::virtual_time;
  const std::size_t each = shares ? participants.size() : 1;
  std::vector<std::unique_ptr<Runner>> runners;
  bool failed = false;
  for (std::size_t i = 0; i < participants.size() && !failed; i += each) {
    runners.push_back(std::make_unique<Runner>());
    const auto joined = runners.back()->start(**segment, std::span(participants).subspan(i, each));
    if (joined.ok()) continue;
    status = fail_with(joined.error());
    failed = true;
  }
  while (!failed && !ending.wait(-1)) {
  }
  task.end_scripts();
  for (auto& r : runners) r->stop();
  task.shut_down();
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("milltask");
  Options options;
  if (const int end = read_options(argc, argv, options); end != 0) return end - 1;
  return options.check ? check(options) : run(options);
}
