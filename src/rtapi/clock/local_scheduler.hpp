// All participants of a machine in one thread, in virtual time: how tests run whole machines.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rtapi/clock/clock.hpp"

namespace kerf::rtapi {

/// The same order as the virtual clock of real processes: at one instant participants run one at a time, by role and then by
/// order of addition, until all are quiet; then time moves to the next wake-up.
class LocalScheduler final : public Clock {
 public:
  [[nodiscard]] Nanos now() const noexcept override { return now_; }
  [[nodiscard]] bool is_virtual() const noexcept override { return true; }

  /// A new participant runs at the present instant.
  void add(Participant& participant);
  void remove(Participant& participant);

  /// Runs all that happens up to and including `until`; then now() is `until`.
  void run_until(Nanos until);
  /// Runs until `done` is true (looked at each time all participants are quiet at an instant, also while outside work holds time) or until `limit`. Gives done().
  bool run_until(const std::function<bool()>& done, Nanos limit);

  /// Longest real time, in ms, that outside work may hold virtual time before run_until gives up and names who held it.
  void set_hold_limit_ms(int ms) { hold_limit_ms_ = ms; }
  /// Who held time too long, or "".
  [[nodiscard]] const std::string& stuck() const { return stuck_; }

 private:
  struct Entry {
    Participant* participant;
    WaitSpec spec;
  };
  [[nodiscard]] static bool is_due(const Entry& entry, Nanos now) noexcept;
  /// Runs participants until all are quiet at now_. True: outside work holds time.
  bool settle();
  /// Waits in real time for the outside work of those that hold time. False: it took too long.
  bool wait_outside();
  /// Earliest wake-up of all.
  [[nodiscard]] Nanos next_wake() const noexcept;

  Nanos now_{0};
  std::vector<Entry> entries_;
  int hold_limit_ms_{60000};
  std::string stuck_;
};

}  // namespace kerf::rtapi
