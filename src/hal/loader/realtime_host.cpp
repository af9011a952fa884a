#include "hal/loader/realtime_host.hpp"

#include <algorithm>

#include "hal/loader/server.hpp"
#include "rtapi/thread/cycle_now.hpp"

namespace kerf::hal {

void RealtimeHost::look_at_threads(rtapi::Nanos now) {
  if (seen_changes_ == host_.thread_changes()) return;
  seen_changes_ = host_.thread_changes();
  const auto old = due_;
  due_.clear();
  for (ThreadRunner* thread : host_.threads()) {
    Due due{thread, (now / thread->period_ns() + 1) * thread->period_ns()};
    for (const Due& d : old) {
      if (d.thread == thread) due.at = d.at;
    }
    due_.push_back(due);
  }
}

void RealtimeHost::step(rtapi::Nanos now, rtapi::WaitSpec& next) {
  if (server_ != nullptr) {
    const bool cycles =
        std::any_of(due_.begin(), due_.end(), [now](const Due& due) { return due.at <= now; });
    if (!cycles || server_->was_told() || now - served_ >= kServeEvery) {
      served_ = now;
      if (!server_->serve_all()) next.wake_at(now);
    }
    server_->watch(now, next);
  }
  look_at_threads(now);
  const bool running = host_.running();
  for (Due& due : due_) {
    const rtapi::Nanos period = due.thread->period_ns();
    // Started just now: the first cycle comes at the next whole multiple, not for the time that was spent stopped.
    if (!running || !was_running_) due.at = (now / period + 1) * period;
    if (due.at <= now) {
      rtapi::CycleNow cycle{due.at, period};
      const rtapi::InCycle in_cycle(cycle);
      due.thread->run_cycle(due.at, now);
      due.at = cycle.next();
      if (due.at <= now) due.at += ((now - due.at) / period + 1) * period;
    }
    // Stopped threads have nothing to do; `start` comes as a request and wakes this participant.
    if (running) next.wake_at(due.at);
  }
  was_running_ = running;
  if (!running && server_ == nullptr) next.watch(host_.registry().root().changed);
}

}  // namespace kerf::hal
