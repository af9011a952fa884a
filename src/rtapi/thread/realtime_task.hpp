// RealtimeTask: code of a component that runs on a realtime thread of its own, beside HAL's threads (rtapi_task_new of the C API).
//
// The code calls wait() for its next period. On the real clock the task is a SCHED_FIFO thread. On the virtual clock it is a participant:
// its thread runs only while step() waits for it, so virtual time stands still meanwhile. Code that does not come to its next wait() is
// named, and virtual time goes on without it.
#pragma once

#include <memory>
#include <string>

#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/thread/cycle_now.hpp"

namespace kerf::rtapi {

class RealtimeTask final : public Participant {
 public:
  struct Config {
    void (*code)(void*){nullptr};
    void* argument{nullptr};
    int priority{0};
    int id{0};         ///< the maker's number for it
    std::string name;  ///< for messages
    const Clock* clock{nullptr};
  };
  explicit RealtimeTask(const Config& config);
  /// As stop().
  ~RealtimeTask() override;
  RealtimeTask(const RealtimeTask&) = delete;
  RealtimeTask& operator=(const RealtimeTask&) = delete;

  /// Runs the code, or lets it go on after pause(). `period` 0: free running, wait() returns at once (on the virtual clock a
  /// millisecond later). busy: it runs already.
  Status start(Nanos period);
  /// @rt. Stands in its next wait() until start(), from any thread.
  void pause() noexcept;
  /// Ends the thread in its next wait(), at the latest after a period. False after three seconds: the code does not call it.
  bool stop();
  /// True when the code waits, has ended or was never started; false when it does not come to that within three seconds.
  [[nodiscard]] bool comes_to_wait() const;

  /// @rt. The task that the calling thread is; nullptr on any other.
  static RealtimeTask* current() noexcept;
  [[nodiscard]] int id() const noexcept;
  /// @rt. By the task itself: until the next period.
  void wait();
  /// @rt. By the task itself: periods count from now on.
  void resync() noexcept;

  // On the virtual clock.
  [[nodiscard]] const char* name() const noexcept override;
  [[nodiscard]] Role role() const noexcept override { return Role::realtime_host; }
  void step(Nanos now, WaitSpec& next) override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kerf::rtapi
