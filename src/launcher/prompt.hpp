// The line at which an operator types G-code.
#pragma once

#include <string>
#include <vector>

#include "launcher/console.hpp"
#include "launcher/supervised_clock.hpp"
#include "launcher/task_link.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::launcher {

/// What a line means: a command of task in words ({"home"}, {"mdi", "G0 X1"}), or nothing for an empty line.
[[nodiscard]] std::vector<std::string> words_of_line(const std::string& line);

/// Until end of file, `quit`, or until the machine is taken down.
rtapi::Status run_prompt(SupervisedClock& clock, TaskLink& task, Console& console);

}  // namespace kerf::launcher
