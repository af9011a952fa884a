// halrun: a realtime environment for one HAL file or one interactive session, in halcmd's language or in Tcl, taken down in every
// case.
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
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/owner_lock.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/socket.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

constexpr int kPatienceMs = 2000;

void print_help() {
  std::puts(
      "Usage: halrun [-I] [HALCMD OPTIONS] [FILE.hal | FILE.tcl]\n"
      "       halrun -T [HALCMD OPTIONS] [FILE.hal | FILE.tcl]\n"
      "       halrun -U\n"
      "\n"
      "Starts a realtime environment, does the commands of FILE by halcmd or haltcl, and takes "
      "everything down again.\n"
      "Without FILE, and after it with -I or -T, commands are read interactively.\n"
      "\n"
      "  -I          interactive halcmd before taking down\n"
      "  -T          interactive haltcl before taking down\n"
      "  -U          end the environment of this instance by force\n"
      "  -f FILE     the same as FILE\n"
      "  -i INI      values for [SECTION]KEY, or $::SECTION(KEY) in Tcl\n"
      "  -k, -q, -Q, -s, -v, -V, -e: as for halcmd, for .hal files\n"
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

  /// Returns when it answers requests; a stop of the clock ends the wait.
  rtapi::Status start(const std::string& instance, rtapi::WaitClock& clock) {
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
    while (!rtapi::is_readable(fd_)) {
      if (clock.stopped()) return rtapi::fail(rtapi::Errc::cancelled, "stopped by a signal");
      rtapi::WaitSpec spec;
      spec.watch_fd(fd_);
      clock.wait(spec);
    }
    char byte = 0;
    if (::read(fd_, &byte, 1) != 1)
      return rtapi::fail(rtapi::Errc::dead, "rtapi_app did not start");
    return {};
  }

  /// Readable when it has died.
  [[nodiscard]] int fd() const { return fd_; }

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

/// Waits until the process is dead; false after `patience_ms`.
bool dies_within(std::int64_t pid, std::uint64_t start, int patience_ms) {
  const auto clock = rtapi::make_real_clock();
  for (int waited = 0; rtapi::process_lives(pid, start); ++waited) {
    if (waited >= patience_ms) return false;
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + rtapi::kMillisecond);
    clock->wait(spec);
  }
  return true;
}

void end_process(std::int64_t pid, std::uint64_t start) {
  if (pid <= 1 || pid == ::getpid() || !rtapi::process_lives(pid, start)) return;
  ::kill(static_cast<pid_t>(pid), SIGTERM);
  ::kill(static_cast<pid_t>(pid), SIGCONT);  // it may be stopped
  if (dies_within(pid, start, kPatienceMs)) return;
  ::kill(static_cast<pid_t>(pid), SIGKILL);
  (void)dies_within(pid, start, kPatienceMs);
}

/// Whatever state the instance is in, nothing of it stays: the owner that is named in the segment, the one that has the lock (its
/// segment may be half-made), and every process of this or an earlier run.
int force_end(const std::string& instance) {
  std::string run_id;
  if (auto segment = rtapi::Segment::attach(instance); segment.ok()) {
    const auto& header = (*segment)->header();
    run_id = std::string(header.run_id.view());
    end_process(header.owner_pid.get(), header.owner_start);
  }
  end_process(rtapi::OwnerLock::taker(instance), 0);
  (void)rtapi::end_processes_of_run(run_id, kPatienceMs);
  (void)rtapi::end_processes_of_instance(instance, kPatienceMs);
  // Its guard may be at the same work.
  const auto clock = rtapi::make_real_clock();
  const rtapi::Nanos limit = clock->now() + kPatienceMs * rtapi::kMillisecond;
  while (!rtapi::Segment::remove(instance) && clock->now() < limit) {
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + 10 * rtapi::kMillisecond);
    clock->wait(spec);
  }
  if (!rtapi::Segment::remove(instance)) {
    const std::int64_t owner = rtapi::OwnerLock::taker(instance);
    rtapi::log_message(
        rtapi::Level::error, "instance '%s' could not be ended: process %lld (%s) holds it",
        instance.c_str(), static_cast<long long>(owner), rtapi::process_name(owner).c_str());
    return 1;
  }
  return 0;
}

/// What the command line asks for.
struct Wish {
  hal::HalcmdOptions options;
  std::string file;  ///< "": none; "-": stdin
  bool interactive{false};
  bool interactive_tcl{false};
  [[nodiscard]] bool tcl_file() const {
    return file.size() > 4 && file.compare(file.size() - 4, 4, ".tcl") == 0;
  }
};

/// haltcl with the terminal, as a child in this process group; gives its exit status. A stop of the clock ends it, and
/// so does the end of the realtime host, which shows at `realtime_fd`.
int run_haltcl(const Wish& wish, const std::string& file, rtapi::WaitClock& clock,
               int realtime_fd) {
  if (clock.stopped()) return 1;
  std::vector<std::string> words{program_folder() + "/haltcl"};
  if (!wish.options.ini_path.empty()) words.insert(words.end(), {"-i", wish.options.ini_path});
  if (!file.empty()) words.push_back(file);
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::execv(argv[0], argv.data());
    std::fprintf(stderr, "halrun: %s: %s\n", argv[0], std::strerror(errno));
    ::_exit(127);
  }
  if (pid < 0) return 1;
  // A person's Ctrl-C is for the command that they wait for.
  if (file.empty()) ::signal(SIGINT, SIG_IGN);
  const int pidfd = rtapi::open_pidfd(pid);
  int status = -1;
  while ((status = hal::child_status(pid)) < 0 && !clock.stopped()) {
    if (rtapi::is_readable(realtime_fd)) {
      rtapi::log_message(rtapi::Level::error, "the realtime host died");
      break;
    }
    rtapi::WaitSpec spec;
    spec.watch_fd(realtime_fd);
    if (pidfd >= 0)
      spec.watch_fd(pidfd);
    else
      spec.wake_at(clock.now() + 10 * rtapi::kMillisecond);
    clock.wait(spec);
  }
  rtapi::close_fd(pidfd);
  if (status < 0) {
    ::kill(pid, SIGTERM);
    if (!dies_within(pid, 0, kPatienceMs)) ::kill(pid, SIGKILL);
    (void)dies_within(pid, 0, kPatienceMs);
    status = hal::child_status(pid);
    if (status == 0) status = 1;
  }
  return status;
}

/// Gives halrun's exit status.
int run_commands(rtapi::Segment& segment, const Wish& wish, rtapi::WaitClock& clock,
                 int realtime_fd) {
  auto session = hal::SocketSession::connect(segment);
  if (!session.ok()) {
    rtapi::log_error(session.error());
    return 1;
  }
  (*session)->use_clock(&clock);
  int status = 0;
  {
    hal::UserComponent self(**session, "halcmd" + std::to_string(::getpid()));
    (void)self.ready();
    hal::Commander commander(**session);
    commander.set_clock(&clock);
    wish.options.apply(commander);
    if (wish.tcl_file())
      status = run_haltcl(wish, wish.file, clock, realtime_fd);
    else if (!wish.file.empty())
      status = commander.run_file(wish.file) ? 0 : 1;
    // What a person types fails before their eyes; only the file's status counts.
    if (wish.interactive && !clock.stopped()) (void)hal::run_interactive(commander);
    if (wish.interactive_tcl && !clock.stopped()) (void)run_haltcl(wish, "", clock, realtime_fd);
    (*session)->use_clock(&clock);
    hal::Commander last(**session);
    last.set_level(hal::Commander::Level::silent);
    const std::string words[] = {"unloadusr", "all"};
    (void)last.run_words(words);
  }
  return clock.stopped() && status == 0 && !wish.interactive ? 1 : status;
}

/// -1: go on; else the exit status. Codes are those of the peer's halrun.
int parse(int argc, char** argv, const std::string& instance, Wish& wish) {
  int c = 0;
  const option long_options[] = {{"help", no_argument, nullptr, 'h'}, {}};
  while ((c = ::getopt_long(argc, argv, "+ef:i:kqQRsvVhIUT", long_options, nullptr)) != -1) {
    switch (c) {
      case 'h': print_help(); return 0;
      case 'U': return force_end(instance);
      case 'I': wish.interactive = true; break;
      case 'T': wish.interactive_tcl = true; break;
      case 'f': wish.file = optarg; break;
      default:
        if (wish.options.take(c, optarg)) break;
        std::fputs("Try: halrun -h\n", stderr);
        return 1;
    }
  }
  if (argc - optind > (wish.file.empty() ? 1 : 0)) {
    rtapi::log_message(rtapi::Level::error, "one file only: what is '%s'?", argv[argc - 1]);
    return 1;
  }
  if (optind < argc) wish.file = argv[optind];
  if (wish.file.empty() && !wish.interactive_tcl) wish.interactive = true;
  if (wish.file.empty() || wish.file == "-") return -1;
  const bool known = wish.tcl_file() || std::filesystem::path(wish.file).extension() == ".hal";
  if (!known) {
    rtapi::log_message(rtapi::Level::error, "'%s': expected a file that ends in .hal or .tcl",
                       wish.file.c_str());
    return 1;
  }
  if (::access(wish.file.c_str(), R_OK) != 0) {
    rtapi::log_message(rtapi::Level::error, "could not open file '%s': %s", wish.file.c_str(),
                       std::strerror(errno));
    return wish.tcl_file() ? 1 : 255;
  }
  return -1;
}

/// Programs and packages that scripts name are those beside this one.
void set_environment(const std::string& instance) {
  const auto prepend = [](const char* name, const std::string& first, const char* rest) {
    const char* old = std::getenv(name);
    if (old != nullptr && *old != '\0') rest = old;
    ::setenv(name, *rest != '\0' ? (first + rest).c_str() : first.c_str(), 1);
  };
  const std::string folder = program_folder();
  prepend("PATH", folder + ":", "/usr/bin:/bin");
  prepend("PYTHONPATH", std::filesystem::path(folder).parent_path().string() + "/python:", "");
  prepend("TCLLIBPATH", std::filesystem::path(folder).parent_path().string() + "/tcl ", "");
  ::setenv("KERF_INSTANCE", instance.c_str(), 1);
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::catch_stop_signals({SIGTERM, SIGINT, SIGHUP});
  const auto clock = rtapi::make_real_clock();
  const rtapi::StopOnSignal stop(*clock);
  rtapi::set_program_name("halrun");
  Wish wish;
  const std::string instance = rtapi::default_instance();
  if (const int end = parse(argc, argv, instance, wish); end >= 0) return end;
  if (!wish.options.load_ini()) return 255;

  set_environment(instance);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphans of orphans come back here
  RealtimeProcess realtime;
  if (auto started = realtime.start(instance, *clock); !started.ok()) {
    rtapi::log_error(started.error());
    return 1;
  }
  int exit_status = 1;
  std::string run_id;
  if (auto segment = rtapi::Segment::attach(instance); segment.ok()) {
    run_id = std::string((*segment)->header().run_id.view());
    if (!run_id.empty()) ::setenv("KERF_RUN_ID", run_id.c_str(), 1);
    exit_status = run_commands(**segment, wish, *clock, realtime.fd());
  } else {
    rtapi::log_error(segment.error());
  }
  realtime.stop();
  (void)rtapi::end_processes_of_run(run_id, kPatienceMs);
  (void)rtapi::Segment::remove(instance);
  return exit_status;
}
