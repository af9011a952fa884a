// HAL with all components, in private memory and virtual time, for scripts.
#pragma once

#include <memory>
#include <string>

#include "hal/client/session.hpp"
#include "hal/loader/host.hpp"
#include "hal/loader/realtime_host.hpp"
#include "rtapi/clock/local_scheduler.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal::test {

/// A wait runs the machine.
class SchedulerClock final : public rtapi::WaitClock {
 public:
  explicit SchedulerClock(rtapi::LocalScheduler& scheduler) : scheduler_(scheduler) {}
  [[nodiscard]] rtapi::Nanos now() const noexcept override { return scheduler_.now(); }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }
  void wait(const rtapi::WaitSpec& spec) override { scheduler_.run_until(spec.until); }
  void stop() noexcept override {}
  [[nodiscard]] bool stopped() const noexcept override { return false; }

 private:
  rtapi::LocalScheduler& scheduler_;
};

struct ScriptMachine {
  std::unique_ptr<rtapi::Segment> segment = rtapi::Segment::in_memory();
  rtapi::LocalScheduler scheduler;
  StaticSource modules{static_components()};
  std::unique_ptr<Host> host{std::move(Host::create(*segment, scheduler, modules)).value()};
  RealtimeHost realtime{*host};
  SchedulerClock clock{scheduler};
  LocalSession session{*host};

  ScriptMachine() { scheduler.add(realtime); }
  ~ScriptMachine() { scheduler.remove(realtime); }
};

}  // namespace kerf::hal::test
