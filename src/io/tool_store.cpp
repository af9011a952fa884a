#include "io/tool_store.hpp"

#include <cstdio>
#include <cstdlib>

namespace kerf::io {

void ToolStore::use_database(ToolDatabase::Options options, std::string spindle_file) {
  database_options_ = std::move(options);
  spindle_file_ = std::move(spindle_file);
  file_.clear();
}

std::shared_ptr<ToolDatabase> ToolStore::database() const {
  const std::lock_guard lock(mutex_);
  return database_;
}

/// The database may take its time, so io, which only tells it things, must not wait behind `writer_` meanwhile.
rtapi::Status ToolStore::load_database() {
  std::shared_ptr<ToolDatabase> db = database();
  if (db == nullptr || !db->running()) {
    KERF_TRY(std::unique_ptr<ToolDatabase> started, ToolDatabase::start(database_options_));
    db = std::move(started);
    const std::lock_guard lock(mutex_);
    database_ = db;
  }
  KERF_TRY(const std::string text, db->get());
  if (std::getenv("DB_SHOW") != nullptr) std::fputs(text.c_str(), stdout);
  KERF_TRY(ToolTable table,
           ToolTable::parse(text, "answer of " + database_options_.command, unit_mm_, random_));
  if (random_) {
    // Which tool is in the spindle is the machine's knowledge.
    if (auto kept = ToolTable::load(spindle_file_, unit_mm_, random_);
        kept.ok() && !kept->tools().empty() && table.find_pocket(0) == nullptr)
      table.set_pocket(kept->tools().front().number, 0);
  }
  const std::lock_guard lock(mutex_);
  table_ = std::make_shared<const ToolTable>(std::move(table));
  return {};
}

rtapi::Status ToolStore::in_spindle(int tool, int before, int to) {
  const auto db = database();
  if (db == nullptr) return {};
  const auto line = [](const char* what, int number, int pocket) {
    return what + std::to_string(number) + " P" + std::to_string(pocket);
  };
  if (!random_) {
    db->tell(tool == 0 ? std::string("u T0 P0") : line("l T", tool, 0));
    return {};
  }
  db->tell(line("u T", before < 0 ? 0 : before, to));
  db->tell(line("l T", tool, 0));
  ToolTable spindle;
  if (const ToolEntry* entry = table()->find(tool); entry != nullptr) spindle.put(*entry);
  return spindle.save(spindle_file_, unit_mm_);
}

std::vector<std::string> ToolStore::database_news() {
  const auto db = database();
  return db == nullptr ? std::vector<std::string>{} : db->pump();
}

std::vector<int> ToolStore::database_fds() const {
  const auto db = database();
  if (db == nullptr || !db->running()) return {};
  return {db->answer_fd(), db->timer_fd()};
}

rtapi::Status ToolStore::load() {
  if (!database_options_.command.empty()) return load_database();
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
  const rtapi::Status saved = replace(std::move(next));
  if (const auto db = database(); db != nullptr) {
    ToolTable one;
    if (const ToolEntry* whole = table()->find(entry.number); whole != nullptr) one.put(*whole);
    std::string text = one.text(unit_mm_);
    while (!text.empty() && text.back() == '\n') text.pop_back();
    db->tell("p " + text);
  }
  return saved;
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
