// CLOCK_MONOTONIC, for real machines.
#pragma once

#include "rtapi/clock/clock.hpp"

namespace kerf::rtapi {

/// Waits by ppoll. Cells are looked at every kTick: the realtime threads that notify them make no system calls, so nobody can
/// be woken by them.
class RealClock final : public WaitClock {
 public:
  static constexpr Nanos kTick = kMillisecond;
  RealClock();
  ~RealClock() override;
  RealClock(const RealClock&) = delete;
  RealClock& operator=(const RealClock&) = delete;

  [[nodiscard]] Nanos now() const noexcept override;
  [[nodiscard]] bool is_virtual() const noexcept override { return false; }
  void wait(const WaitSpec& spec) override;
  void stop() noexcept override;
  [[nodiscard]] bool stopped() const noexcept override { return stop_.requested(); }

 private:
  StopWord stop_;
  int stop_fd_{-1};
};

/// @rt. CLOCK_MONOTONIC now.
Nanos monotonic_now() noexcept;

/// Seconds since 1970, for people: it jumps when the computer's clock is set, so nothing may wait by it.
double wall_time_s() noexcept;

}  // namespace kerf::rtapi
