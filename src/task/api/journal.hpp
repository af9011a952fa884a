// Journal: what the machine has executed last, in a file that outlives the power. docs/journal.md
//
// The file is a ring of kSlots records of kSlotBytes each, written in turn and never longer. A record carries its number, its length and
// a checksum; one that the end of the power tore is recognised, and the one before it counts. It tells what motion has executed, never
// what was only read, so it is never later than the machine.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "motion/api/limits.hpp"
#include "rtapi/base/pose.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::task {

/// A file as it was: its content counts, whatever its name or date.
struct FileMark {
  std::uint64_t size{0};
  std::uint64_t hash{0};  ///< FNV-1a, 64 bits
  friend bool operator==(const FileMark&, const FileMark&) = default;
};
[[nodiscard]] rtapi::Result<FileMark> mark_file(const std::string& path);

enum class RunState : std::uint8_t {
  running,  ///< the newest record says so: the power or task went in the middle of it
  paused,   ///< the same, with the program held
  stopped,  ///< aborted, by an operator or a fault
  ended     ///< to its end
};
[[nodiscard]] const char* to_string(RunState state) noexcept;

/// Lengths in mm, angles in degrees, speeds in rpm.
struct JournalRecord {
  std::uint64_t number{0};  ///< 1, 2, 3 ...
  std::int64_t time_ns{0};  ///< of the instance
  RunState state{RunState::running};
  std::string ini_file;
  std::string program;
  FileMark mark;
  bool marked{false};         ///< `mark` is known
  std::int32_t line{0};       ///< of the program, in execution; of a sub: the line that called it
  std::int32_t from_line{0};  ///< where this run began; 0 at the top
  std::string source;         ///< where that differs: the file of the sub, and its line
  std::int32_t source_line{0};
  std::uint64_t executed{0};   ///< motion's count of items that are done
  std::string why;             ///< of stopped: the last error, or ""
  rtapi::Pose position;        ///< machine coordinates
  std::vector<double> joints;  ///< commanded positions
  std::uint32_t homed{0};      ///< a bit a joint
  std::int32_t tool{0};
  rtapi::Pose tool_offset, g5x_offset, g92_offset;
  std::int32_t g5x_index{1};
  double rotation_deg{0};
  std::array<std::int32_t, 17> g_codes{};
  std::array<std::int32_t, 10> m_codes{};
  double feed{0}, speed{0};         ///< F and S
  std::vector<double> spindle_rpm;  ///< signed; 0: stands
  bool flood{false}, mist{false};
  std::uint64_t digital_out{0};
};

inline constexpr std::size_t kJournalSlots = 8;
inline constexpr std::size_t kJournalSlotBytes = 4096;

/// Where the journal of a machine stands: `wish` is [KERF]JOURNAL, beside the INI file unless it is absolute; "": in the user's folder for
/// state, by the name of the INI file; "off": "".
[[nodiscard]] std::string journal_path(const std::string& ini_file, const std::string& wish);

/// One slot, kJournalSlotBytes long. Too long a record loses its texts, never its numbers.
[[nodiscard]] std::string format_slot(const JournalRecord& record);
/// Nothing when the bytes are no whole record.
[[nodiscard]] rtapi::Result<JournalRecord> parse_slot(std::string_view bytes);
/// The newest whole record. not_found: there is no journal, or nothing in it.
[[nodiscard]] rtapi::Result<JournalRecord> read_journal(const std::string& path);
/// For an operator, a line each.
[[nodiscard]] std::string describe(const JournalRecord& record);

}  // namespace kerf::task
