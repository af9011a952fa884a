// Options of rs274, and the menu that asks for them when it is started without -g.
#pragma once

#include <cstdio>
#include <optional>
#include <string>

namespace kerf::interp {

/// What happens after a block in error (-n).
enum class OnError { go_on, mdi, stop };

struct Rs274Options {
  std::string tools, parameters, ini, input, output;
  std::optional<int> log_level;  ///< over [RS274NGC]LOG_LEVEL
  OnError on_error{OnError::stop};
  bool block_delete{false}, stack{false}, batch{false};
};

/// Asks on `in` until "start interpreting" is chosen or the input ends; questions go to `ask`. False: a file that was
/// named there cannot be read.
[[nodiscard]] bool run_menu(Rs274Options& options, std::FILE* in, std::FILE* ask);

}  // namespace kerf::interp
