// RealtimeHost: runs a Host as a participant, requests and thread cycles in one thread. For the virtual clock and for tests; on
// the real clock rtapi_app gives each HAL thread a CyclicThread.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/loader/host.hpp"
#include "rtapi/clock/clock.hpp"

namespace kerf::hal {

class Server;

/// Cycles fall on whole multiples of a thread's period, unless a function moves them (CycleNow). At one instant the faster thread runs before the slower one.
class RealtimeHost final : public rtapi::Participant {
 public:
  explicit RealtimeHost(Host& host, Server* server = nullptr) : host_(host), server_(server) {}
  [[nodiscard]] const char* name() const noexcept override { return "rtapi_app"; }
  [[nodiscard]] rtapi::Role role() const noexcept override { return rtapi::Role::realtime_host; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

 private:
  struct Due {
    ThreadRunner* thread;
    rtapi::Nanos at;
  };
  /// Between cycles requests that nobody has told of are looked for this often: each look is a system call.
  static constexpr rtapi::Nanos kServeEvery = 10 * rtapi::kMillisecond;
  void look_at_threads(rtapi::Nanos now);

  Host& host_;
  Server* server_;
  std::vector<Due> due_;
  bool was_running_{false};
  rtapi::Nanos served_{0};
  std::uint64_t seen_changes_{UINT64_MAX};
};

}  // namespace kerf::hal
