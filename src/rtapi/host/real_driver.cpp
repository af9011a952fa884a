#include "rtapi/host/real_driver.hpp"

#include <sched.h>

#include <algorithm>
#include <charconv>
#include <string>

#include "hal/core/overrun_text.hpp"
#include "rtapi/clock/join_clock.hpp"
#include "rtapi/clock/stop_signals.hpp"
#include "rtapi/log/log.hpp"

namespace kerf::hal {

namespace {
constexpr int kHighestPriority = 80;
constexpr int kLowestPriority = 50;
constexpr int kPatienceMs = 3000;  ///< three times the longest period that a thread may have

/// What to say of the thread's last overrun.
std::string report_text(const rtapi::Segment& segment, const ThreadRunner& thread,
                        const rtapi::ThreadStats& stats) {
  for (const auto& timing : View(segment).timings()) {
    if (timing.name != thread.name()) continue;
    if (auto text = overrun_text(timing); !text.empty()) return text;
  }
  const std::string period = std::to_string(thread.period_ns()) + " ns";
  const std::string head = std::string("thread ") + thread.name() + " ";
  if (stats.last_overrun_ns < thread.period_ns())
    return head + "was woken later than its period of " + period +
           ": the machine was busy otherwise";
  return head + "overran its period of " + period + ": a cycle took " +
         std::to_string(stats.last_overrun_ns) + " ns; 'halcmd timing every' finds the function";
}

}  // namespace

rtapi::Result<std::vector<int>> parse_cpus(std::string_view text) {
  std::vector<int> cpus;
  const auto wrong = [&](const std::string& why) {
    return rtapi::fail(rtapi::Errc::bad_argument,
                       "processors '" + std::string(text) + "': " + why + "; give 2,3 or 2-3");
  };
  std::string_view rest = text;
  while (!rest.empty()) {
    const auto comma = std::min(rest.find(','), rest.size());
    std::string_view part = rest.substr(0, comma);
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    while (!part.empty() && part.back() == ' ') part.remove_suffix(1);
    if (part.empty()) continue;
    const auto number = [](std::string_view digits, int& out) {
      const auto end = digits.data() + digits.size();
      const auto parsed = std::from_chars(digits.data(), end, out);
      return parsed.ec == std::errc() && parsed.ptr == end && out >= 0 && out < CPU_SETSIZE;
    };
    int first = 0;
    const auto dash = part.find('-');
    if (!number(part.substr(0, dash), first))
      return wrong("no number in '" + std::string(part) + "'");
    int last = first;
    if (dash != std::string_view::npos && !number(part.substr(dash + 1), last))
      return wrong("no number in '" + std::string(part) + "'");
    if (last < first) return wrong("'" + std::string(part) + "' runs backwards");
    for (int cpu = first; cpu <= last; ++cpu) {
      if (std::find(cpus.begin(), cpus.end(), cpu) == cpus.end()) cpus.push_back(cpu);
    }
  }
  return cpus;
}

rtapi::Status RealDriver::thread_added(ThreadRunner& thread) {
  int place = 0;
  while (
      std::any_of(cyclic_.begin(), cyclic_.end(), [&](const auto& c) { return c.place == place; }))
    ++place;
  rtapi::CyclicThread::Config config;
  config.name = rtapi::FixedString<31>(thread.name());
  config.period_ns = thread.period_ns();
  // The fastest is made first and may interrupt the others.
  config.priority = std::max(kLowestPriority, kHighestPriority - place);
  if (!cpus_.empty())
    config.cpu = cpus_[std::min(static_cast<std::size_t>(place), cpus_.size() - 1)];
  config.cycle = &ThreadRunner::cycle;
  config.self = &thread;
  auto cyclic = std::make_unique<rtapi::CyclicThread>(config);
  thread.record().priority = config.priority;
  thread.record().ticking.publish(1);
  const rtapi::NoSignalsInThreads no_signals;
  // Whole multiples of the period, so that the cycles of several threads keep their places, and apart from the kernel's own tick.
  const auto period = thread.period_ns();
  const auto status =
      cyclic->start((clock_.now() - rtapi::kCyclePhase) / period * period + rtapi::kCyclePhase);
  if (!status.ok()) {
    thread.record().ticking.publish(0);
    return status;
  }
  cyclic_.push_back({&thread, std::move(cyclic), place});
  return {};
}

void RealDriver::thread_removed(ThreadRunner& thread) {
  for (auto it = cyclic_.begin(); it != cyclic_.end(); ++it) {
    if (it->runner != &thread) continue;
    it->thread->stop();
    thread.record().ticking.publish(0);
    cyclic_.erase(it);
    return;
  }
}

rtapi::Status RealDriver::participant_added(rtapi::Participant& participant) {
  KERF_TRY(auto clock, rtapi::join_clock(segment_, participant.role(), participant.name()));
  auto& worker = workers_.emplace_back();
  worker.participant = &participant;
  worker.clock = std::move(clock);
  const rtapi::NoSignalsInThreads no_signals;
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
    if (c.overrun_reported) continue;  // once a thread: `halcmd timing` tells the rest
    const auto stats = c.thread->stats();
    if (stats.overruns == 0 && c.runner->record().overrun.version() == 0) continue;
    c.overrun_reported = true;
    rtapi::log_message(rtapi::Level::warning, "%s",
                       report_text(segment_, *c.runner, stats).c_str());
  }
}

}  // namespace kerf::hal
