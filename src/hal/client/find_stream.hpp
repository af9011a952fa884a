// How programs find a stream that a component of the instance made.
#pragma once

#include <cstdint>
#include <string_view>

#include "hal/stream.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/shm/segment.hpp"

namespace kerf::hal {

/// not_found: no stream has this key. bad_argument: it has, and its columns are not those of `types`; "" accepts any.
rtapi::Result<Stream> find_stream(rtapi::Segment& segment, std::uint32_t key,
                                  std::string_view types = {});

}  // namespace kerf::hal
