// The commands that need no running HAL: `halcmd check`, `halcmd graph`, and all that the program `hal`
// has. Each takes the words
// from its own name on and returns the exit status: 0 good, 1 something is wrong with the input, 2 wrong use.
#pragma once

#include <span>
#include <string>

namespace kerf::hal {

int check_main(std::span<const std::string> words);
int graph_main(std::span<const std::string> words);
int describe_main(std::span<const std::string> words);

}  // namespace kerf::hal
