// The interactive mode of halcmd and halrun.
#pragma once

#include "hal/cmd/commander.hpp"

namespace kerf::hal {

/// At a terminal: line editing, history, completion of commands and names, and an error does not end the session. Otherwise
/// the lines of stdin as a file. Takes over SIGINT, SIGTERM and SIGHUP. False when a command failed.
bool run_interactive(Commander& commander);

}  // namespace kerf::hal
