#include "rtapi/thread/cyclic_thread.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

#include "rtapi/clock/real_clock.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/patient_read.hpp"
#include "rtapi/sync/seq_cell.hpp"
#include "rtapi/thread/cycle_now.hpp"

namespace kerf::rtapi {

namespace {

/// Stack that a realtime thread touches before its first cycle, so that no cycle takes a page fault.
constexpr std::size_t kPrefaultedStack = 256U << 10U;
/// Address space only: nothing behind it is touched but what is used, and thread-local data of libraries lies in it too.
constexpr std::size_t kStack = 8U << 20U;

void sleep_until(Nanos t) noexcept {
  const timespec ts{static_cast<time_t>(t / kSecond), static_cast<long>(t % kSecond)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &ts, nullptr) == EINTR) {
  }
}

/// Processors that sleep deeply take up to some 100 us to wake. The wish holds while the file is open, that is until the process ends.
bool forbid_deep_sleep() noexcept {
  static const int fd = [] {
    const int opened = ::open("/dev/cpu_dma_latency", O_RDWR | O_CLOEXEC);
    const std::int32_t allowed_us = 0;
    if (opened >= 0 && ::write(opened, &allowed_us, sizeof allowed_us) == sizeof allowed_us)
      return opened;
    if (opened >= 0) ::close(opened);
    return -1;
  }();
  return fd >= 0;
}

[[gnu::noinline]] void touch_stack() noexcept {
  char page[kPrefaultedStack];
  for (std::size_t i = 0; i < kPrefaultedStack; i += 4096) page[i] = 0;
  asm volatile("" : : "r"(page) : "memory");  // the writes above are wanted
}

}  // namespace

void Timing::add(std::int64_t ns) noexcept {
  if (count == 0 || ns < min_ns) min_ns = ns;
  if (count == 0 || ns > max_ns) max_ns = ns;
  ++count;
  sum_ns += static_cast<double>(ns);
  const auto us = static_cast<std::uint64_t>(std::max<std::int64_t>(ns, 0) / 1000);
  const int bin = us < 2 ? 0 : static_cast<int>(std::bit_width(us)) - 1;
  ++bins[std::min(bin, kBins - 1)];
}

RightsReport acquire_realtime_rights() {
  RightsReport report;
  std::string text;
  // Future mappings are locked when they are touched (ONFAULT), so that reserved address space costs nothing.
  report.locked_memory = mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
  if (!report.locked_memory)
    text +=
        "memory is not locked (page faults may delay a cycle): raise 'memlock' in "
        "/etc/security/limits.d. ";
  sched_param param{};
  param.sched_priority = 1;
  int old_policy = 0;
  sched_param old_param{};
  pthread_getschedparam(pthread_self(), &old_policy, &old_param);
  if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &param) == 0) {
    report.scheduler = true;
    pthread_setschedparam(pthread_self(), old_policy, &old_param);
  } else {
    text +=
        "SCHED_FIFO is not allowed (any program may delay a cycle): raise 'rtprio' in "
        "/etc/security/limits.d. ";
  }
  report.no_deep_sleep = forbid_deep_sleep();
  std::ifstream flag("/sys/kernel/realtime");
  int value = 0;
  report.preempt_rt = static_cast<bool>(flag >> value) && value == 1;
  if (!report.preempt_rt)
    text +=
        "the kernel is not PREEMPT_RT (delays of milliseconds are normal): install "
        "linux-image-rt-amd64. ";
  if (!text.empty()) text += "Good for simulation, not for cutting.";
  report.text = FixedString<400>(text);
  return report;
}

bool prefer_this_thread() noexcept {
  sched_param param{};
  param.sched_priority = 1;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO | SCHED_RESET_ON_FORK, &param) == 0;
}

struct CyclicThread::State {
  Config config;
  pthread_t thread{};
  bool started{false};
  StopWord stop;
  Word<std::uint32_t> granted{0};
  Nanos first{0};
  ThreadStats stats;               // the thread's own
  SeqCell<ThreadStats> published;  // a copy of it after each cycle

  static void* main(void* argument) noexcept {
    static_cast<State*>(argument)->run();
    return nullptr;
  }

  void run() noexcept {
    sched_param param{};
    param.sched_priority = config.priority;
    granted.set(pthread_setschedparam(pthread_self(), SCHED_FIFO, &param) == 0 ? 1 : 0);
    if (config.cpu >= 0) {
      cpu_set_t cpus;
      CPU_ZERO(&cpus);
      CPU_SET(static_cast<unsigned>(config.cpu), &cpus);
      pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus);
    }
    touch_stack();
    CycleNow now{first, config.period_ns};
    const InCycle in_cycle(now);
    while (!stop.requested()) {
      sleep_until(now.reference);
      if (stop.requested()) break;
      const Nanos begin = monotonic_now();
      config.cycle(config.self, now.reference, begin);
      const Nanos end = monotonic_now();
      stats.wake_up.add(begin - now.reference);
      stats.execution.add(end - begin);
      Nanos scheduled = now.next();
      if (end > scheduled) {
        ++stats.overruns;
        stats.last_overrun_cycle = stats.execution.count;
        stats.last_overrun_ns = end - begin;
        // Cycles that are lost are lost: catching up would run the machine's time faster than the clock.
        scheduled += (end - scheduled) / config.period_ns * config.period_ns + config.period_ns;
      }
      now.reference = scheduled;
      now.correction = 0;
      published.write(stats);
    }
  }
};

CyclicThread::CyclicThread(const Config& config) : state_(std::make_unique<State>()) {
  state_->config = config;
}

CyclicThread::~CyclicThread() { stop(); }

Status CyclicThread::start(Nanos start_at) {
  if (state_->started) return {};
  state_->stop.clear();
  state_->first = (start_at == 0 ? monotonic_now() : start_at) + state_->config.period_ns;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStack);
  const int error = pthread_create(&state_->thread, &attributes, &State::main, state_.get());
  pthread_attr_destroy(&attributes);
  if (error != 0)
    return fail(Errc::system, std::string("cannot start thread ") + state_->config.name.c_str() +
                                  ": " + std::strerror(error));
  pthread_setname_np(state_->thread, std::string(state_->config.name.view().substr(0, 15)).c_str());
  state_->started = true;
  return {};
}

void CyclicThread::stop() {
  if (!state_ || !state_->started) return;
  state_->stop.request();
  pthread_join(state_->thread, nullptr);
  state_->started = false;
}

bool CyclicThread::realtime() const noexcept { return state_->granted.get() != 0; }

ThreadStats CyclicThread::stats() const noexcept {
  ThreadStats copy;
  if (!read_patiently(state_->published, copy)) copy = {};
  return copy;
}

}  // namespace kerf::rtapi
