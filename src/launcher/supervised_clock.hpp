// SupervisedClock: the launcher's clock. Each wait also looks after signals, child processes and the launcher's own chores.
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <string>
#include <utility>

#include "launcher/process.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::launcher {

/// Why the machine is to be taken down.
struct StopReason {
  enum class Kind { none, signal, part_died, display_closed };
  Kind kind{Kind::none};
  std::string text;  ///< for the user; empty for a signal
};

/// Makes SIGINT, SIGTERM and SIGHUP readable at a descriptor, for the whole process and its whole life. By handlers, not by a
/// mask, since a mask would go on to children that others start. Gives the descriptor.
int catch_stop_signals();

class SupervisedClock final : public rtapi::WaitClock {
 public:
  SupervisedClock(rtapi::Segment& segment, std::unique_ptr<rtapi::WaitClock> clock, int signal_fd);
  ~SupervisedClock() override;
  SupervisedClock(const SupervisedClock&) = delete;
  SupervisedClock& operator=(const SupervisedClock&) = delete;

  [[nodiscard]] rtapi::Nanos now() const noexcept override { return clock_->now(); }
  [[nodiscard]] bool is_virtual() const noexcept override { return clock_->is_virtual(); }
  void wait(const rtapi::WaitSpec& spec) override;
  void stop() noexcept override;
  /// A signal came, or a watched process ended.
  [[nodiscard]] bool stopped() const noexcept override {
    return reason_.kind != StopReason::Kind::none || clock_->stopped();
  }
  [[nodiscard]] const StopReason& reason() const { return reason_; }
  /// From now on neither a signal nor deaths end waits: the machine is being taken down. What is not done after 5 s of real time,
  /// or at a second signal, is left: stopped() then stays true.
  void begin_teardown();

  /// Watches a process. `ends_session`: its regular end is the user's wish (a screen), not a failure.
  void watch_child(Child& child, bool ends_session = false);
  /// Called at least every `period` of instance time during waits that do not hold time.
  void set_chore(std::function<void()> chore, rtapi::Nanos period);

  /// Both at each wait: what else to wait for, and a look at it.
  void set_lookout(std::function<void(rtapi::WaitSpec&)> add, std::function<void()> look_at) {
    add_ = std::move(add);
    look_at_ = std::move(look_at);
  }

  /// Calls `task` once, when `delay` of instance time has passed.
  void call_after(rtapi::Nanos delay, std::function<void()> task);
  /// Programs that others have started here (loadusr, and what their parents left): `told` is called for each that ends from now
  /// on, before its process number is free again. Not while somebody else waits for a program. {}: no more.
  void watch_strays(std::function<void(pid_t, const ExitState&)> told);

  /// Waits until `done` or until stopped, while time stands on a virtual clock; looks every millisecond of real time. False:
  /// stopped, or `limit_ms` of real time has passed.
  bool hold_until(const std::function<bool()>& done, int limit_ms);
  /// The same while time goes on.
  bool wait_until(const std::function<bool()>& done, int limit_ms);
  /// Lets `duration` of instance time pass. False: stopped.
  bool pass(rtapi::Nanos duration);

 private:
  struct Watched {
    Child* child;
    bool ends_session;
  };
  void look();
  void look_for_strays();
  [[nodiscard]] bool watches(pid_t pid) const;
  /// True when it has, which may be the reason to stop.
  bool has_ended(Watched& watched);
  bool poll_until(const std::function<bool()>& done, int limit_ms, bool hold);

  rtapi::Segment& segment_;
  std::unique_ptr<rtapi::WaitClock> clock_;
  int signal_fd_;
  int tick_fd_{-1};
  bool tearing_down_{false};
  std::list<Watched> children_;
  std::function<void()> chore_;
  std::function<void(pid_t, const ExitState&)> told_;
  std::function<void(rtapi::WaitSpec&)> add_;
  std::function<void()> look_at_;
  std::list<std::pair<rtapi::Nanos, std::function<void()>>> timers_;
  rtapi::Nanos chore_period_{rtapi::kForever};
  rtapi::Nanos next_chore_{rtapi::kForever};
  StopReason reason_;
};

}  // namespace kerf::launcher
