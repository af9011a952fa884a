// What task would complain of, asked of the task program itself: limits that contradict each other, REMAP lines, the tool table.
#pragma once

#include <string>
#include <vector>

namespace kerf::launcher {

struct TaskCheck {
  bool ok{true};                   ///< task would start
  std::vector<std::string> lines;  ///< its complaints
};

/// Runs `program --check --ini INI`.
[[nodiscard]] TaskCheck check_task(const std::string& program, const std::string& ini);

}  // namespace kerf::launcher
