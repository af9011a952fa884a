// halrun: a realtime environment for one HAL file or one interactive session, taken down in every case.
#include <getopt.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "hal/client/user_component.hpp"
#include "hal/cmd/commander.hpp"
#include "hal/cmd/options.hpp"
#include "hal/cmd/processes.hpp"
#include "hal/cmd/prompt.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

constexpr int kPatienceMs = 2000;
rtapi::WaitClock* wait_clock = nullptr;  // for the signal handler

void on_signal(int /*signal*/) {
  if (wait_clock != nullptr) wait_clock->stop();
}

void print_help() {
  std::puts(
      "Usage: halrun [-I] [HALCMD OPTIONS] [FILE.hal]\n"
      "       halrun -U\n"
      "\n"
      "Starts a realtime environment, does the commands of FILE, and takes everything down again.\n"
      "Without FILE, or with -I after it, commands are read interactively.\n"
      "\n"
      "  -I          interactive session before taking down\n"
      "  -U          end the environment of this instance by force\n"
      "  -f FILE     the same as FILE\n"
      "  -i INI, -k, -q, -Q, -s, -v, -V, -e: as for halcmd\n"
      "  -h          this text");
}

std::string program_folder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path().string();
}

/// rtapi_app as a child that dies with this process.
class RealtimeProcess {
 public:
  ~RealtimeProcess() { stop(); }

  rtapi::Status start(const std::string& instance) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      return rtapi::fail(rtapi::Errc::system, std::string("socketpair: ") + std::strerror(errno));
    const std::string path = program_folder() + "/rtapi_app";
    const std::string fd_text = std::to_string(ends[1]);
    const std::string option = "--instance=" + instance;
    pid_ = ::fork();
    if (pid_ == 0) {
      // A group of its own: Ctrl-C is for halrun, which then ends it in order.
      ::setpgid(0, 0);
      int copy = ::dup(ends[1]);  // without close-on-exec
      ::setenv("KERF_SUPERVISOR_FD", std::to_string(copy).c_str(), 1);
      ::execl(path.c_str(), path.c_str(), option.c_str(), nullptr);
      std::fprintf(stderr, "halrun: %s: %s\n", path.c_str(), std::strerror(errno));
      ::_exit(127);
    }
    ::close(ends[1]);
    fd_ = ends[0];
    if (pid_ < 0)
      return rtapi::fail(rtapi::Errc::system, std::string("fork: ") + std::strerror(errno));
    char byte = 0;
    ssize_t n = 0;
    do {
      n = ::read(fd_, &byte, 1);
    } while (n < 0 && errno == EINTR);
    if (n != 1) return rtapi::fail(rtapi::Errc::dead, "rtapi_app did not start");
    return {};
  }

  /// The end of the socket makes it take everything down.
  void stop() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
    if (pid_ <= 0) return;
    const auto clock = rtapi::make_real_clock();
    for (int waited = 0;; ++waited) {
      int status = 0;
      const pid_t done = ::waitpid(pid_, &status, WNOHANG);
      if (done != 0) break;
      if (waited == kPatienceMs * 3) ::kill(pid_, SIGKILL);
      rtapi::WaitSpec spec;
      spec.wake_at(clock->now() + rtapi::kMillisecond);
      clock->wait(spec);
    }
    pid_ = -1;
  }

 private:
  pid_t pid_{-1};
  int fd_{-1};
};

int force_end(const std::string& instance) {
  std::string run_id;
  {
    auto segment = rtapi::Segment::attach(instance);
    if (!segment.ok()) return 0;
    const auto& header = (*segment)->header();
    run_id = std::string(header.run_id.view());
    const std::int64_t owner = header.owner_pid.get();
    const auto clock = rtapi::make_real_clock();
    for (int waited = 0; rtapi::process_lives(owner, header.owner_start); ++waited) {
      if (waited == 0) ::kill(static_cast<pid_t>(owner), SIGTERM);
      if (waited == kPatienceMs) ::kill(static_cast<pid_t>(owner), SIGKILL);
      if (waited > 2 * kPatienceMs) break;
      rtapi::WaitSpec spec;
      spec.wake_at(clock->now() + rtapi::kMillisecond);
      clock->wait(spec);
    }
  }
  (void)rtapi::end_processes_of_run(run_id, kPatienceMs);
  if (!rtapi::Segment::remove(instance)) {
    rtapi::log_message(rtapi::Level::error, "instance '%s' could not be ended", instance.c_str());
    return 1;
  }
  return 0;
}

bool run_commands(rtapi::Segment& segment, const hal::HalcmdOptions& options,
                  const std::string& file, bool interactive) {
  auto session = hal::SocketSession::connect(segment);
  if (!session.ok()) {
    rtapi::log_error(session.error());
    return false;
  }
  const auto clock = rtapi::make_real_clock();
  wait_clock = clock.get();
  bool good = true;
  {
    hal::UserComponent self(**session, "halcmd" + std::to_string(::getpid()));
    (void)self.ready();
    hal::Commander commander(**session);
    commander.set_clock(clock.get());
    options.apply(commander);
    if (!file.empty()) good = commander.run_file(file);
    if (interactive && !clock->stopped()) good = hal::run_interactive(commander) && good;
    hal::Commander last(**session);
    last.set_level(hal::Commander::Level::silent);
    const std::string words[] = {"unloadusr", "all"};
    (void)last.run_words(words);
  }
  wait_clock = nullptr;
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::set_program_name("halrun");
  hal::HalcmdOptions options;
  bool interactive = false;
  const std::string instance = rtapi::default_instance();
  int c = 0;
  const option long_options[] = {{"help", no_argument, nullptr, 'h'}, {}};
  while ((c = ::getopt_long(argc, argv, "+efi:kqQRsvVhIUT", long_options, nullptr)) != -1) {
    if (c == 'h') {
      print_help();
      return 0;
    }
    if (c == 'U') return force_end(instance);
    if (c == 'I') {
      interactive = true;
    } else if (c == 'T') {
      rtapi::log_message(rtapi::Level::error, "-T: this build has no haltcl");
      return 1;
    } else if (!options.take(c, optarg)) {
      return 255;
    }
  }
  const std::string file = optind < argc ? argv[optind] : options.from_file ? "-" : "";
  if (file.empty()) interactive = true;
  if (!options.load_ini()) return 1;

  // Programs that scripts call by name are those beside this one; orphans of orphans come back here.
  const char* path = std::getenv("PATH");
  ::setenv("PATH", (program_folder() + ":" + (path != nullptr ? path : "/usr/bin:/bin")).c_str(),
           1);
  ::setenv("KERF_INSTANCE", instance.c_str(), 1);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  struct sigaction action {};
  action.sa_handler = on_signal;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGHUP, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);

  RealtimeProcess realtime;
  if (auto started = realtime.start(instance); !started.ok()) {
    rtapi::log_error(started.error());
    return 1;
  }
  bool good = false;
  std::string run_id;
  if (auto segment = rtapi::Segment::attach(instance); segment.ok()) {
    run_id = std::string((*segment)->header().run_id.view());
    good = run_commands(**segment, options, file, interactive);
  } else {
    rtapi::log_error(segment.error());
  }
  realtime.stop();
  (void)rtapi::end_processes_of_run(run_id, kPatienceMs);
  (void)rtapi::Segment::remove(instance);
  return good ? 0 : 1;
}
