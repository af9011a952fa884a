// ToolStore: the tool table of a running machine, shared by the threads of task.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "io/tool_database.hpp"
#include "io/tool_table.hpp"

namespace kerf::io {

/// Readers take the table of the moment and keep it as long as they like; a change makes a new one and saves the file whole.
/// Changes touch the disk: not for the command thread.
class ToolStore {
 public:
  /// No file: the table starts empty and is not saved.
  ToolStore(std::string file, double unit_mm, bool random = false)
      : file_(std::move(file)), unit_mm_(unit_mm), random_(random) {}

  /// From now on the tools are those of a program; there is no file then. The tool in the spindle of a random changer is kept in
  /// `spindle_file`.
  void use_database(ToolDatabase::Options options, std::string spindle_file);

  /// Reads the file, or asks the database (again; one that has ended is started anew). On error the present table stays in force.
  rtapi::Status load();
  [[nodiscard]] std::shared_ptr<const ToolTable> table() const;
  /// Adds or replaces one tool and saves.
  rtapi::Status put(const ToolEntry& entry);
  /// Moves tools to pockets (number, pocket) and saves once.
  rtapi::Status move(const std::vector<std::pair<int, int>>& pockets);
  /// `tool` is in the spindle now, 0: nothing; `before` went to pocket `to` of a random changer. Only a database is told.
  rtapi::Status in_spindle(int tool, int before, int to);
  /// What the database has said since the last call, for the operator. Never waits.
  [[nodiscard]] std::vector<std::string> database_news();
  /// Descriptors that tell of it; empty without a database.
  [[nodiscard]] std::vector<int> database_fds() const;

 private:
  rtapi::Status replace(ToolTable table);
  rtapi::Status load_database();
  [[nodiscard]] std::shared_ptr<ToolDatabase> database() const;

  std::string file_;
  double unit_mm_;
  bool random_;
  ToolDatabase::Options database_options_;
  std::string spindle_file_;
  std::shared_ptr<ToolDatabase> database_;  ///< also guarded by mutex_
  mutable std::mutex mutex_;                ///< guards table_; held for pointer copies only
  std::mutex writer_;                       ///< one change at a time, so that none is lost
  std::shared_ptr<const ToolTable> table_{std::make_shared<const ToolTable>()};
};

}  // namespace kerf::io
