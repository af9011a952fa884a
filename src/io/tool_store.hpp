// ToolStore: the tool table of a running machine, shared by the threads of task.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "io/tool_table.hpp"

namespace kerf::io {

/// Readers take the table of the moment and keep it as long as they like; a change makes a new one and saves the file whole.
/// Changes touch the disk: not for the command thread.
class ToolStore {
 public:
  /// No file: the table starts empty and is not saved.
  ToolStore(std::string file, double unit_mm, bool random = false)
      : file_(std::move(file)), unit_mm_(unit_mm), random_(random) {}

  /// Reads the file (again). On error the present table stays in force.
  rtapi::Status load();
  [[nodiscard]] std::shared_ptr<const ToolTable> table() const;
  /// Adds or replaces one tool and saves.
  rtapi::Status put(const ToolEntry& entry);
  /// Moves tools to pockets (number, pocket) and saves once.
  rtapi::Status move(const std::vector<std::pair<int, int>>& pockets);

 private:
  rtapi::Status replace(ToolTable table);

  std::string file_;
  double unit_mm_;
  bool random_;
  mutable std::mutex mutex_;  ///< guards table_; held for pointer copies only
  std::mutex writer_;         ///< one change at a time, so that none is lost
  std::shared_ptr<const ToolTable> table_{std::make_shared<const ToolTable>()};
};

}  // namespace kerf::io
