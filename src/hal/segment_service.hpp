// The segment that a component is loaded into, for one that looks at values by their place in it.
#pragma once

#include <string_view>

namespace kerf::hal {

/// static_cast<const rtapi::Segment*>(builder().find_service(kSegmentService)), while it is constructed; nullptr: there is none.
inline constexpr std::string_view kSegmentService = "segment";

}  // namespace kerf::hal
