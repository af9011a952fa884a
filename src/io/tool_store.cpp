#include "io/tool_store.hpp"

namespace kerf::io {

rtapi::Status ToolStore::load() {
  if (file_.empty()) return {};
  const std::lock_guard change(writer_);
  KERF_TRY(ToolTable table, ToolTable::load(file_, unit_mm_, random_));
  const std::lock_guard lock(mutex_);
  table_ = std::make_shared<const ToolTable>(std::move(table));
  return {};
}

std::shared_ptr<const ToolTable> ToolStore::table() const {
  const std::lock_guard lock(mutex_);
  return table_;
}

rtapi::Status ToolStore::put(const ToolEntry& entry) {
  const std::lock_guard change(writer_);
  ToolTable next = *table();
  next.put(entry);
  return replace(std::move(next));
}

rtapi::Status ToolStore::move(const std::vector<std::pair<int, int>>& pockets) {
  const std::lock_guard change(writer_);
  ToolTable next = *table();
  for (const auto& [number, pocket] : pockets) next.set_pocket(number, pocket);
  return replace(std::move(next));
}

rtapi::Status ToolStore::replace(ToolTable table) {
  auto next = std::make_shared<const ToolTable>(std::move(table));
  {
    const std::lock_guard lock(mutex_);
    table_ = next;
  }
  // The table is in force even if the disk is full: the machine works by it, the error tells the operator.
  return file_.empty() ? rtapi::Status{} : next->save(file_, unit_mm_);
}

}  // namespace kerf::io
