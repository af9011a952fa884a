// LineSource: the lines of a program, from a file in chunks or from memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "rtapi/base/result.hpp"

namespace kerf::interp {

/// `bad`: the line was read but cannot be parsed.
enum class LineRead : std::uint8_t { line, end, too_long, changed, failed, bad };

class LineSource {
 public:
  virtual ~LineSource() = default;
  /// too_long: `next` is behind that line, or the end when it has none.
  /// The line that begins at byte `offset`, without its end; valid until the next call. `next` is where the following
  /// line begins.
  [[nodiscard]] virtual LineRead read(std::uint64_t offset, std::string_view& line,
                                      std::uint64_t& next) = 0;
};

/// Longest line of a program when nobody says otherwise; blanks and comments count.
inline constexpr std::size_t kLongestLine = std::size_t{2} * 1024 * 1024;

/// Reads with pread in chunks, so memory does not grow with the file. A file of one chunk runs as it was when opened; of a
/// larger one size and time are remembered: `changed` when it is edited while it runs.
[[nodiscard]] rtapi::Result<std::unique_ptr<LineSource>> open_file_source(
    const std::string& path, std::size_t longest_line = kLongestLine);
[[nodiscard]] std::unique_ptr<LineSource> make_text_source(std::string text,
                                                           std::size_t longest_line = kLongestLine);

}  // namespace kerf::interp
