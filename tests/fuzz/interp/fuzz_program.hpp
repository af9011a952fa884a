// One fuzzed program, from text to canonical calls.
#pragma once

#include <string_view>

namespace kerf::interp {

/// The first byte chooses how it runs, the rest is the program. Breaks off with a message when something holds that must not:
/// a block in error made a call, a call has a number that is none, the state does not fit what was said.
void run_fuzzed(std::string_view data);

}  // namespace kerf::interp
