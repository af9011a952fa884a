#include "rtapi/host/real_driver.hpp"

#include "rtapi/clock/join_clock.hpp"
#include "rtapi/log/log.hpp"

namespace kerf::hal {

namespace {
constexpr int kHighestPriority = 80;
constexpr int kLowestPriority = 50;
constexpr int kPatienceMs = 3000;  ///< three times the longest period that a thread may have
}  // namespace

rtapi::Status RealDriver::thread_added(ThreadRunner& thread) {
  rtapi::CyclicThread::Config config;
  config.name = rtapi::FixedString<31>(thread.name());
  config.period_ns = thread.period_ns();
  // The fastest is made first and may interrupt the others.
  config.priority = std::max(kLowestPriority, kHighestPriority - made_);
  config.cpu = cpu_;
  config.cycle = &ThreadRunner::cycle;
  config.self = &thread;
  config.breadcrumb = thread.breadcrumb();
  auto cyclic = std::make_unique<rtapi::CyclicThread>(config);
  thread.record().ticking.publish(1);
  // Whole multiples of the period, so that the cycles of several threads keep their places.
  const auto status = cyclic->start(clock_.now() / thread.period_ns() * thread.period_ns());
  if (!status.ok()) {
    thread.record().ticking.publish(0);
    return status;
  }
  ++made_;
  cyclic_.push_back({&thread, std::move(cyclic)});
  return {};
}

void RealDriver::thread_removed(ThreadRunner& thread) {
  for (auto it = cyclic_.begin(); it != cyclic_.end(); ++it) {
    if (it->runner != &thread) continue;
    it->thread->stop();
    thread.record().ticking.publish(0);
    cyclic_.erase(it);
    if (cyclic_.empty()) made_ = 0;
    return;
  }
}

rtapi::Status RealDriver::participant_added(rtapi::Participant& participant) {
  KERF_TRY(auto clock, rtapi::join_clock(segment_, participant.role(), participant.name()));
  auto& worker = workers_.emplace_back();
  worker.participant = &participant;
  worker.clock = std::move(clock);
  worker.thread =
      std::thread([&worker] { rtapi::run_participant(*worker.clock, *worker.participant); });
  return {};
}

void RealDriver::participant_removed(rtapi::Participant& participant) {
  for (auto it = workers_.begin(); it != workers_.end(); ++it) {
    if (it->participant != &participant) continue;
    it->clock->stop();
    it->thread.join();
    workers_.erase(it);
    return;
  }
}

bool RealDriver::wait_for_threads(int attempt) {
  if (attempt >= kPatienceMs) return false;
  const auto own = rtapi::make_real_clock();  // the main clock may have been stopped already
  rtapi::WaitSpec spec;
  spec.wake_at(own->now() + rtapi::kMillisecond);
  own->wait(spec);
  return true;
}

void RealDriver::report_overruns() {
  for (auto& c : cyclic_) {
    const auto stats = c.thread->stats();
    if (stats.overruns == c.overruns_seen) continue;
    const bool first = c.overruns_seen == 0;
    c.overruns_seen = stats.overruns;
    if (!first) continue;  // once a thread: the counters tell the rest
    if (stats.last_overrun_ns < c.runner->period_ns()) {
      rtapi::log_message(
          rtapi::Level::warning,
          "thread %s was woken later than its period of %lld ns: the machine was busy otherwise",
          c.runner->name(), static_cast<long long>(c.runner->period_ns()));
      continue;
    }
    rtapi::log_message(
        rtapi::Level::warning,
        "thread %s overran its period of %lld ns: a cycle took %lld ns, in function %s",
        c.runner->name(), static_cast<long long>(c.runner->period_ns()),
        static_cast<long long>(stats.last_overrun_ns),
        stats.last_overrun_in != nullptr ? stats.last_overrun_in : "(none)");
  }
}

}  // namespace kerf::hal
