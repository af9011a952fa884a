// How an overrun is told, in the log and by `halcmd timing`.
#pragma once

#include <string>

#include "hal/core/view.hpp"

namespace kerf::hal {

/// One line without its end; empty when the thread has no overrun to tell of.
std::string overrun_text(const ThreadTiming& timing);

}  // namespace kerf::hal
