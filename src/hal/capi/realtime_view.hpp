// What calls from realtime functions look at.
#pragma once

#include <cstddef>

#include "rtapi/clock/clock.hpp"

namespace kerf::hal::capi {

/// Filled in by whoever makes the backend; what it points to lives as long as the backend.
struct RealtimeView {
  std::byte* base{nullptr};  ///< of the segment
  const rtapi::Clock* clock{nullptr};
};
RealtimeView& realtime_view() noexcept;

}  // namespace kerf::hal::capi
