// `kerf resume`: what was running when the power or a process went, and how it goes on. docs/journal.md
#pragma once

#include "launcher/console.hpp"
#include "launcher/options.hpp"

namespace kerf::launcher {

/// Reports what the machine's journal says; with options.resume_run it has the running machine go on, by run from line. Gives the exit
/// code. Nothing moves without --run.
int resume(const Options& options, Console& console);

}  // namespace kerf::launcher
