// Many commands with few round trips.
#pragma once

#include <span>
#include <vector>

#include "hal/client/session.hpp"
#include "hal/loader/batch.hpp"

namespace kerf::hal {

struct RefusedCommand {
  std::size_t index;  ///< in what was asked for
  Reply reply;
};
/// Has the host do the commands in order: up to the first that fails, or all of them. Gives those that failed.
rtapi::Result<std::vector<RefusedCommand>> request_all(Session& session,
                                                       std::span<const Command> commands,
                                                       bool keep_going);

}  // namespace kerf::hal
