// Signals that end a program in order. From catch_stop_signals() on none is lost, also before there is a clock to stop.
//
//   int main() {
//     rtapi::catch_stop_signals({SIGINT, SIGTERM});
//     ...
//     const rtapi::StopOnSignal stop(*clock);     // a signal that came meanwhile stops it at once
#pragma once

#include <initializer_list>

namespace kerf::rtapi {

class WaitClock;

/// Installs the handler and ignores SIGPIPE. Once, at the beginning of main(). Blocking calls end with EINTR.
void catch_stop_signals(std::initializer_list<int> signals);

/// True after the first of them.
[[nodiscard]] bool stop_signal_came() noexcept;

/// While it lives, a signal stops the clock. One at a time.
class StopOnSignal {
 public:
  explicit StopOnSignal(WaitClock& clock) noexcept;
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
};

/// While it lives, threads that are started take no signals: the main thread alone does, so that a handler never works with a
/// clock that is being destroyed, nor in the middle of a realtime cycle.
class NoSignalsInThreads {
 public:
  NoSignalsInThreads() noexcept;
  ~NoSignalsInThreads();
  NoSignalsInThreads(const NoSignalsInThreads&) = delete;
  NoSignalsInThreads& operator=(const NoSignalsInThreads&) = delete;

 private:
  unsigned long
      old_mask_[16]{};  // a sigset_t, which <signal.h> would bring to all who include this
};

}  // namespace kerf::rtapi
