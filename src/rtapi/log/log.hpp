// Messages: from realtime code through a ring in the segment, from everything else straight to stderr.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "rtapi/base/fixed_string.hpp"
#include "rtapi/base/result.hpp"
#include "rtapi/sync/cell.hpp"
#include "rtapi/sync/seq_cell.hpp"

namespace kerf::rtapi {

/// Values of the published message levels.
enum class Level : std::int32_t { error = 1, warning = 2, info = 3, debug = 4 };

/// A message from realtime code: fixed text and up to four numbers; the reader makes the line.
struct LogRecord {
  std::uint64_t number{0};  ///< 1, 2, 3 ...
  Level level{Level::info};
  std::int32_t values{0};  ///< how many of `value` count
  double value[4]{};
  FixedString<255> text;
};

/// One block "log" a segment. Writers: any number of realtime threads; each message takes a slot of its own by one atomic
/// addition. A reader that falls more than kSlots behind has lost the oldest, and sees it from the numbers.
class LogRing {
 public:
  static constexpr const char* kBlock = "log";
  static constexpr std::uint64_t kSlots = 256;
  /// @rt.
  void write(Level level, std::string_view text, double a = 0, double b = 0, double c = 0,
             double d = 0, int values = 0) noexcept {
    LogRecord record;
    record.number = next_.add(1);
    record.level = level;
    record.values = values;
    record.value[0] = a;
    record.value[1] = b;
    record.value[2] = c;
    record.value[3] = d;
    record.text.assign(text);
    slot_[record.number % kSlots].write(record);
  }
  [[nodiscard]] std::uint64_t newest() const noexcept { return next_.get(); }
  /// False while the slot is being written or when the message is gone.
  [[nodiscard]] bool read(std::uint64_t number, LogRecord& out) const noexcept {
    return slot_[number % kSlots].read(out) && out.number == number;
  }

 private:
  Word<std::uint64_t> next_{0};
  SeqCell<LogRecord> slot_[kSlots];
};

class Segment;
/// The segment's ring; made when it has none.
[[nodiscard]] Result<LogRing*> open_log(Segment& segment);

/// Reads the ring from the moment of its construction on.
class LogReader {
 public:
  explicit LogReader(const LogRing& ring) : ring_(ring), seen_(ring.newest()) {}
  /// The next message. False: none yet.
  [[nodiscard]] bool next(LogRecord& out);
  /// Prints what is new; gives how many.
  int drain();

 private:
  const LogRing& ring_;
  std::uint64_t seen_;
};
/// A message's line.
[[nodiscard]] std::string text_of(const LogRecord& record);

/// Prefix of this program's messages ("milltask: ..."); the text must outlive the program.
void set_program_name(const char* name) noexcept;
/// Messages above this level are dropped; default warning.
void set_log_level(Level level) noexcept;
[[gnu::format(printf, 2, 3)]] void log_message(Level level, const char* fmt, ...) noexcept;
void log_error(const Error& error) noexcept;

}  // namespace kerf::rtapi
