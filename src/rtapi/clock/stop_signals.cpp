#include "rtapi/clock/stop_signals.hpp"

#include <pthread.h>
#include <signal.h>

#include <cstring>

#include "rtapi/clock/clock.hpp"
#include "rtapi/sync/cell.hpp"

namespace kerf::rtapi {

namespace {

// A signal handler has no other place to look.
Word<std::uint32_t> came;
Word<WaitClock*> clock_to_stop;

void on_signal(int /*signal*/) {
  came.set(1);
  // Fence here and in StopOnSignal: of "set the flag, look for a clock" and "set the clock, look at the flag" one sees the other.
  full_fence();
  if (WaitClock* clock = clock_to_stop.observe(); clock != nullptr) clock->stop();
}

static_assert(sizeof(sigset_t) <= 16 * sizeof(unsigned long));

}  // namespace

void catch_stop_signals(std::initializer_list<int> signals) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int signal : signals) ::sigaction(signal, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
}

bool stop_signal_came() noexcept { return came.get() != 0; }

StopOnSignal::StopOnSignal(WaitClock& clock) noexcept {
  clock_to_stop.publish(&clock);
  full_fence();
  if (stop_signal_came()) clock.stop();
}

StopOnSignal::~StopOnSignal() { clock_to_stop.publish(nullptr); }

NoSignalsInThreads::NoSignalsInThreads() noexcept {
  sigset_t all;
  sigset_t old;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &old);
  std::memcpy(old_mask_, &old, sizeof old);
}

NoSignalsInThreads::~NoSignalsInThreads() {
  sigset_t old;
  std::memcpy(&old, old_mask_, sizeof old);
  pthread_sigmask(SIG_SETMASK, &old, nullptr);
}

}  // namespace kerf::rtapi
