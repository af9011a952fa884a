// haltcl's interactive session.
#pragma once

#include <functional>
#include <string>

#include "hal/tcl/tcl_hal.hpp"
#include "ini/ini_file.hpp"

namespace kerf::hal::tcl {

/// Commands from the terminal, with editing and completion, or from a pipe, to the end of input. False: Tcl did not start.
/// `before` is called before each command.
bool run_prompt(TclHal& words, const ini::IniFile* ini, const std::string& program,
                const std::function<void()>& before);
/// True while a line is being typed, when Ctrl-C is for nobody. For signal handlers.
bool at_prompt();

}  // namespace kerf::hal::tcl
