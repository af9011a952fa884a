// Waiting for other processes, by the real clock.
#pragma once

#include <functional>

#include "rtapi/clock/join_clock.hpp"

namespace kerf::hal::test {

/// True as soon as `condition` holds; false when it does not within `seconds`.
inline bool eventually(const std::function<bool()>& condition, int seconds = 60) {
  const auto clock = rtapi::make_real_clock();
  const rtapi::Nanos limit = clock->now() + seconds * rtapi::kSecond;
  while (!condition()) {
    if (clock->now() > limit) return false;
    rtapi::WaitSpec spec;
    spec.wake_at(clock->now() + 2 * rtapi::kMillisecond);
    clock->wait(spec);
  }
  return true;
}

}  // namespace kerf::hal::test
