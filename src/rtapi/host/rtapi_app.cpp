// rtapi_app: the realtime process of an instance.
//
// Maps the instance's segment (or makes it), runs HAL threads and components, and answers halcmd and the other programs. It ends
// on SIGTERM and SIGINT, and when its supervisor dies: the descriptor KERF_SUPERVISOR_FD then reaches its end of file. Without a
// supervisor the machine goes off first.
#include <fcntl.h>
#include <getopt.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "hal/capi/messages.hpp"
#include "hal/capi/realtime_backend.hpp"
#include "hal/core/view.hpp"
#include "hal/loader/host.hpp"
#include "hal/loader/module_source.hpp"
#include "hal/loader/realtime_host.hpp"
#include "hal/loader/server.hpp"
#include "hal/switch_off.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/host/real_driver.hpp"
#include "rtapi/log/log.hpp"
#include "rtapi/shm/leftovers.hpp"
#include "rtapi/shm/process.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/thread/cyclic_thread.hpp"

namespace {

using namespace kerf;  // NOLINT(google-build-using-namespace): the program's own file

constexpr rtapi::Nanos kHousekeeping = 100 * rtapi::kMillisecond;
/// Apart from the cycles of all threads whose period is an eighth of a millisecond or a multiple of it, also with the 50 us by which
/// the kernel may be late: an ordinary thread that wakes at the same instant would delay the cycle.
constexpr rtapi::Nanos kBetweenCycles = 190'000;
constexpr int kPatienceMs = 1000;

struct Options {
  std::string instance;
  bool make_virtual{false};
  std::string cpus;
  std::size_t segment_bytes{rtapi::Segment::kDefaultBytes};
  hal::TimingMode timing{hal::TimingMode::sampled};
};

void print_help() {
  std::puts(
      "Usage: rtapi_app [OPTIONS]\n"
      "\n"
      "Runs HAL's realtime threads and components for one instance. Started by kerf and halrun.\n"
      "\n"
      "  --instance NAME    the instance (default: KERF_INSTANCE, else by user)\n"
      "  --virtual          a new instance runs on virtual time\n"
      "  --cpu LIST         processors of the realtime threads, the fastest first: 2,3 or 2-3\n"
      "                     (default: KERF_RT_CPUS, else any)\n"
      "  --function-timing every|sampled|off\n"
      "                     time each function in every cycle, in every 16th, or none\n"
      "                     (default: KERF_FUNCTION_TIMING, else sampled)\n"
      "  --segment-mb N     shared memory of a new instance (default 64)\n"
      "  --help             this text");
}

/// False: exit with `status`.
bool parse_options(int argc, char** argv, Options& o, int& status) {
  static constexpr option kLong[] = {{"instance", required_argument, nullptr, 'n'},
                                     {"virtual", no_argument, nullptr, 'v'},
                                     {"cpu", required_argument, nullptr, 'c'},
                                     {"segment-mb", required_argument, nullptr, 'm'},
                                     {"function-timing", required_argument, nullptr, 't'},
                                     {"help", no_argument, nullptr, 'h'},
                                     {nullptr, 0, nullptr, 0}};
  o.instance = rtapi::default_instance();
  if (const char* cpus = std::getenv("KERF_RT_CPUS"); cpus != nullptr && *cpus != '\0')
    o.cpus = cpus;
  if (const char* timing = std::getenv("KERF_FUNCTION_TIMING"); timing != nullptr)
    o.timing = hal::timing_mode_of(timing).value_or(o.timing);
  int c = 0;
  while ((c = ::getopt_long(argc, argv, "h", kLong, nullptr)) != -1) {
    switch (c) {
      case 'n': o.instance = optarg; break;
      case 'v': o.make_virtual = true; break;
      case 'c': o.cpus = optarg; break;
      case 'm':
        o.segment_bytes = static_cast<std::size_t>(std::max(1, std::atoi(optarg))) << 20U;
        break;
      case 't':
        if (const auto mode = hal::timing_mode_of(optarg)) {
          o.timing = *mode;
          break;
        }
        rtapi::log_message(rtapi::Level::error,
                           "--function-timing '%s' is not every, sampled or off", optarg);
        status = 1;
        return false;
      case 'h':
        print_help();
        status = 0;
        return false;
      default: status = 1; return false;
    }
  }
  if (!rtapi::valid_instance_name(o.instance)) {
    rtapi::log_message(rtapi::Level::error, "'%s' is not a name for an instance",
                       o.instance.c_str());
    status = 1;
    return false;
  }
  return true;
}

/// The supervisor's end of a pipe or socket pair.
class Supervisor {
 public:
  Supervisor() {
    const char* text = std::getenv("KERF_SUPERVISOR_FD");
    if (text == nullptr || *text == '\0') return;
    const int fd = std::atoi(text);
    if (fd > 2 && ::fcntl(fd, F_SETFD, FD_CLOEXEC) == 0) fd_ = fd;
  }
  void watch(rtapi::WaitSpec& spec) const {
    if (fd_ >= 0) spec.watch_fd(fd_);
  }
  /// One byte says that requests are answered from now on; a supervisor that gave a pipe hears nothing.
  void say_ready() const {
    if (fd_ >= 0) (void)!::write(fd_, "R", 1);
  }
  [[nodiscard]] bool dead() const {
    if (fd_ < 0) return false;
    pollfd p{fd_, POLLIN, 0};
    if (::poll(&p, 1, 0) <= 0) return false;
    char byte = 0;
    return (p.revents & POLLIN) == 0 || ::read(fd_, &byte, 1) == 0;
  }

 private:
  int fd_{-1};
};

/// What the main thread does: on the real clock requests, on the virtual one also the cycles and the other participants.
class MainParticipant final : public rtapi::Participant {
 public:
  MainParticipant(hal::Host& host, hal::Server& server, Supervisor& supervisor,
                  rtapi::WaitClock& clock, hal::RealDriver& driver, const rtapi::LogRing& log)
      : host_(host),
        server_(server),
        supervisor_(supervisor),
        clock_(clock),
        driver_(driver),
        cycles_(host, &server),
        log_(log) {
    server_.before_reply([this] { print_messages(); });
  }
  [[nodiscard]] const char* name() const noexcept override { return "rtapi_app"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::realtime_host; }
  [[nodiscard]] bool orphaned() const { return orphaned_; }

  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override {
    print_messages();
    if (orphaned_ || is_orphaned_at(now)) {
      if (!orphaned_) begin_orphaned(now);
      // On the real clock there may be hardware: drivers write that the machine is off, and kerf's guard sets what else is declared
      // for that. It ends this process when it has; a guard that is dead too does not.
      if (clock_.is_virtual() || now - orphaned_at_ >= kOrphanTime) {
        clock_.stop();
        return;
      }
      next.wake_at(orphaned_at_ + kOrphanTime);
    } else {
      supervisor_.watch(next);
    }
    if (!clock_.is_virtual()) {
      if (!server_.serve_all()) next.wake_at(now);
      server_.watch(now, next);
      driver_.report_overruns();
      next.wake_at((now / kHousekeeping + 1) * kHousekeeping + kBetweenCycles);
      return;
    }
    // The planner comes next in the order of the virtual clock, so it may as well run in this thread.
    cycles_.step(now, next);
    for (auto* participant : host_.participants()) {
      rtapi::WaitSpec own;
      participant->step(now, own);
      next.wake_at(own.until);
      // A cell of our own memory is notified by this very thread, in the cycles above; other processes cannot look at it.
      for (const auto& cell : own.cells)
        if (host_.segment().contains(cell.cell)) (void)next.cells.push_back(cell);
      for (const int fd : own.fds) next.watch_fd(fd);
      next.holds_time = next.holds_time || own.holds_time;
    }
  }

 private:
  /// Not in each cycle of virtual time: it is a system call. While time stands a step looks each time, so a wait is ended by what it has to find.
  [[nodiscard]] bool is_orphaned_at(rtapi::Nanos now) {
    if (clock_.is_virtual() && now > stepped_at_ && now - looked_at_ < kLookEvery) {
      stepped_at_ = now;
      return false;
    }
    stepped_at_ = looked_at_ = now;
    return supervisor_.dead();
  }
  /// The drives go off in the next cycle, however late the guard gets its turn.
  void begin_orphaned(rtapi::Nanos now) {
    orphaned_at_ = now;
    orphaned_ = true;
    host_.segment().begin_end();  // the next start waits for it
    const auto* off = static_cast<const hal::SwitchOff*>(host_.service(hal::kSwitchOff));
    if (off != nullptr) off->now(off->machine);
  }
  /// What realtime code has said since the last time.
  void print_messages() {
    (void)log_.drain();
    (void)hal::capi::drain_messages();
  }

  hal::Host& host_;
  hal::Server& server_;
  Supervisor& supervisor_;
  rtapi::WaitClock& clock_;
  hal::RealDriver& driver_;
  hal::RealtimeHost cycles_;
  rtapi::LogReader log_;
  static constexpr rtapi::Nanos kOrphanTime = 1000 * rtapi::kMillisecond;
  static constexpr rtapi::Nanos kLookEvery = 10 * rtapi::kMillisecond;
  bool orphaned_{false};
  rtapi::Nanos orphaned_at_{0};
  rtapi::Nanos stepped_at_{-1}, looked_at_{-kLookEvery};
};

int fail(const rtapi::Error& error) {
  rtapi::log_error(error);
  return 1;
}

/// Each client costs two descriptors, and each component one while it is opened.
void raise_descriptor_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  (void)::setrlimit(RLIMIT_NOFILE, &limit);
}

rtapi::Result<std::unique_ptr<rtapi::Segment>> open_segment(const Options& o, bool& made) {
  // One that has a realtime host already may be that of a run which is ending and has not said so yet.
  constexpr rtapi::Nanos kNotice = 200 * rtapi::kMillisecond;
  const auto clock = rtapi::make_real_clock();
  for (const rtapi::Nanos begin = clock->now();;) {
    auto found = rtapi::Segment::attach(o.instance, rtapi::Access::whole);
    if (!found.ok()) break;
    const auto& header = (*found)->header();
    // A segment whose maker is dead is a leftover: create() below removes it, or waits for one that is ending.
    if (!rtapi::process_lives(header.owner_pid.get(), header.owner_start) ||
        header.ending.get() != 0)
      break;
    if (!hal::View(**found).attached() || clock->now() - begin > kNotice) return found;
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + 5 * rtapi::kMillisecond);
    clock->wait(spec);
  }
  rtapi::MakeHooks hooks;
  hooks.waits = [](const std::string& text) {
    std::fprintf(stderr, "rtapi_app: %s\n", text.c_str());
  };
  KERF_TRY(auto segment, rtapi::Segment::create(o.instance, o.segment_bytes, hooks));
  made = true;
  KERF_CHECK(rtapi::make_clock(
      *segment, o.make_virtual ? rtapi::ClockMode::virtual_time : rtapi::ClockMode::real));
  return segment;
}

/// Ends what was started in this run, and takes the instance's name away.
void take_down(const rtapi::Segment& segment) {
  (void)rtapi::end_processes_of_run(segment.header().run_id.view(), kPatienceMs);
  (void)rtapi::Segment::remove(segment.instance());
}

/// How the run ended.
struct End {
  int status{0};
  bool orphaned{false};
};

End run(const Options& o, Supervisor& supervisor, rtapi::Segment& segment, bool made) {
  auto log = rtapi::open_log(segment);
  if (!log.ok()) return {fail(log.error())};
  const bool is_virtual = rtapi::clock_mode(segment) == rtapi::ClockMode::virtual_time;
  if (!is_virtual) {
    const auto rights = rtapi::acquire_realtime_rights();
    if (!rights.text.empty()) rtapi::log_message(rtapi::Level::warning, "%s", rights.text.c_str());
  }
  auto clock = rtapi::join_clock(segment, rtapi::Role::realtime_host, "rtapi_app");
  if (!clock.ok()) return {fail(clock.error())};
  const rtapi::StopOnSignal stop(**clock);
  auto cpus = hal::parse_cpus(o.cpus);
  if (!cpus.ok()) return {fail(cpus.error())};
  hal::DlopenSource modules;
  hal::RealDriver driver(segment, **clock, std::move(*cpus));
  auto host = hal::Host::create(segment, **clock, modules, is_virtual ? nullptr : &driver);
  if (!host.ok() && host.error().code == rtapi::Errc::exists) {
    rtapi::log_message(rtapi::Level::error,
                       "instance '%s' has a realtime host already; 'halrun -U' ends it",
                       o.instance.c_str());
    return {1};
  }
  if (!host.ok()) return {fail(host.error())};
  if (!is_virtual) (*host)->set_cycle_counter(rtapi::CycleCounter::calibrated());
  (*host)->set_timing_mode(o.timing);
  hal::capi::use_host(**host);
  auto server = hal::Server::open(**host, segment, o.instance);
  if (!server.ok()) return {fail(server.error())};
  MainParticipant participant(**host, **server, supervisor, **clock, driver, **log);
  supervisor.say_ready();
  rtapi::run_participant(**clock, participant);
  const End end{0, participant.orphaned()};
  // A new run of the instance may wait for the end of this one.
  if (made || end.orphaned) segment.header().owner_pid.set(0);
  if (auto unloaded = (*host)->unload_all(); !unloaded.ok()) {
    // The thread that hangs cannot be joined, nor anything be destroyed that it uses: the process ends as it is.
    rtapi::log_error(unloaded.error());
    if (made || end.orphaned) take_down(segment);
    std::_Exit(1);
  }
  hal::capi::forget_host();
  server->reset();
  host->reset();
  return end;
}

}  // namespace

int main(int argc, char** argv) {
  rtapi::catch_stop_signals({SIGTERM, SIGINT});
  rtapi::set_program_name("rtapi_app");
  hal::capi::start_realtime();
  Options options;
  int status = 0;
  if (!parse_options(argc, argv, options, status)) return status;
  // Set for whatever libraries of components look at it.
  ::setenv("KERF_INSTANCE", options.instance.c_str(), 1);
  raise_descriptor_limit();
  Supervisor supervisor;
  bool made = false;
  auto segment = open_segment(options, made);
  if (!segment.ok()) return fail(segment.error());

  const End end = run(options, supervisor, **segment, made);
  // A living launcher tears down its own children; without one it is done here.
  if (made || end.orphaned) take_down(**segment);
  return end.status;
}
