// How rtapi_app runs what components bring: HAL threads as cyclic realtime threads, participants as ordinary ones.
#pragma once

#include <list>
#include <memory>
#include <string_view>
#include <thread>
#include <vector>

#include "hal/loader/host.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"
#include "rtapi/thread/cyclic_thread.hpp"

namespace kerf::hal {

class RealDriver final : public HostDriver {
 public:
  /// `clock` is the main thread's. The first thread, which is the fastest, runs on the first of `cpus`, the next on the next, and
  /// all that are left on the last, so that the fastest has its CPU alone. No cpus: any.
  RealDriver(rtapi::Segment& segment, rtapi::WaitClock& clock, std::vector<int> cpus)
      : segment_(segment), clock_(clock), cpus_(std::move(cpus)) {}

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
    int place;  ///< 0: the first thread; free again when the thread is removed
    bool overrun_reported{false};
  };
  struct Worker {
    rtapi::Participant* participant;
    std::unique_ptr<rtapi::WaitClock> clock;
    std::thread thread;
  };
  rtapi::Segment& segment_;
  rtapi::WaitClock& clock_;
  std::vector<int> cpus_;
  std::list<Cyclic> cyclic_;
  std::list<Worker> workers_;
};

/// "2,3", "2-5" or a mixture: processor numbers in the order given. bad_argument names what is wrong.
rtapi::Result<std::vector<int>> parse_cpus(std::string_view text);

}  // namespace kerf::hal
