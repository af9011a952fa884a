// How rtapi_app runs what components bring: HAL threads as cyclic realtime threads, participants as ordinary ones.
#pragma once

#include <list>
#include <memory>
#include <thread>

#include "hal/loader/host.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/thread/cyclic_thread.hpp"

namespace kerf::hal {

class RealDriver final : public HostDriver {
 public:
  /// `clock` is the main thread's; `cpu` -1: any.
  RealDriver(rtapi::Segment& segment, rtapi::WaitClock& clock, int cpu)
      : segment_(segment), clock_(clock), cpu_(cpu) {}

  rtapi::Status thread_added(ThreadRunner& thread) override;
  void thread_removed(ThreadRunner& thread) override;
  rtapi::Status participant_added(rtapi::Participant& participant) override;
  void participant_removed(rtapi::Participant& participant) override;
  bool wait_for_threads(int attempt) override;
  /// Reports a thread's first overrun to the log: which function, how long. Call it now and then.
  void report_overruns();

 private:
  struct Cyclic {
    ThreadRunner* runner;
    std::unique_ptr<rtapi::CyclicThread> thread;
    bool overrun_reported{false};
  };
  struct Worker {
    rtapi::Participant* participant;
    std::unique_ptr<rtapi::WaitClock> clock;
    std::thread thread;
  };
  rtapi::Segment& segment_;
  rtapi::WaitClock& clock_;
  int cpu_;
  int made_{0};
  std::list<Cyclic> cyclic_;
  std::list<Worker> workers_;
};

}  // namespace kerf::hal
