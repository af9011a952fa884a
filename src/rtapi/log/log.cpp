#include "rtapi/log/log.hpp"

#include <cstdarg>
#include <cstdio>
#include <string>

#include "rtapi/shm/segment.hpp"

namespace kerf::rtapi {

namespace {

// A program has one name and one level; both are set in main before threads start.
const char* program_name = "kerf";     // NOLINT(readability-identifier-naming): not a constant
Level program_level = Level::warning;  // NOLINT(readability-identifier-naming): not a constant

const char* level_text(Level level) {
  switch (level) {
    case Level::error: return "error: ";
    case Level::warning: return "warning: ";
    case Level::info:
    case Level::debug: break;
  }
  return "";
}

}  // namespace

Result<LogRing*> open_log(Segment& segment) {
  auto found = segment.find<LogRing>(LogRing::kBlock);
  if (found.ok()) return found;
  return segment.make<LogRing>(LogRing::kBlock);
}

std::string text_of(const LogRecord& record) {
  std::string line(record.text.view());
  for (int i = 0; i < record.values && i < 4; ++i) {
    char number[32];
    std::snprintf(number, sizeof number, " %.10g", record.value[i]);
    line += number;
  }
  return line;
}

bool LogReader::next(LogRecord& out) {
  const std::uint64_t newest = ring_.newest();
  if (newest - seen_ > LogRing::kSlots) {
    log_message(Level::warning, "%llu messages of realtime code were lost",
                static_cast<unsigned long long>(newest - seen_ - LogRing::kSlots));
    seen_ = newest - LogRing::kSlots;
  }
  while (seen_ < newest) {
    const bool whole = ring_.read(seen_ + 1, out);
    if (!whole && seen_ + 1 == newest) return false;  // being written: next time
    ++seen_;
    if (whole) return true;
  }
  return false;
}

int LogReader::drain() {
  int printed = 0;
  for (LogRecord record; next(record); ++printed)
    log_message(record.level, "%s", text_of(record).c_str());
  return printed;
}

void set_program_name(const char* name) noexcept { program_name = name; }
void set_log_level(Level level) noexcept { program_level = level; }

void log_message(Level level, const char* fmt, ...) noexcept {
  if (level > program_level) return;
  char text[1024];
  std::va_list args;
  va_start(args, fmt);
  std::vsnprintf(text, sizeof text, fmt, args);
  va_end(args);
  // One call a line, so that lines of several processes do not mix.
  std::fprintf(stderr, "%s: %s%s\n", program_name, level_text(level), text);
}

void log_error(const Error& error) noexcept {
  log_message(Level::error, "%s", error.message().c_str());
}

}  // namespace kerf::rtapi
