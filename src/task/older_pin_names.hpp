// The pin names of older manuals ([RS274NGC]COMPAT), as aliases.
#pragma once

#include "hal/client/session.hpp"
#include "interp/environment.hpp"

namespace kerf::task {

/// Call it before the HAL files: the pins get their second names as soon as motmod has made them.
rtapi::Status ask_for_older_pin_names(hal::Session& session, interp::Compat compat);

}  // namespace kerf::task
