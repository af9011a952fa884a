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
  /// The line that begins at byte `offset`, without its end; valid until the next call. `next` is where the following
  /// line begins.
  [[nodiscard]] virtual LineRead read(std::uint64_t offset, std::string_view& line,
                                      std::uint64_t& next) = 0;
};

/// Reads with pread in chunks, so memory does not grow with the file. Remembers size and time of the file: `changed`
/// when it is edited while it runs.
[[nodiscard]] rtapi::Result<std::unique_ptr<LineSource>> open_file_source(const std::string& path);
[[nodiscard]] std::unique_ptr<LineSource> make_text_source(std::string text);

}  // namespace kerf::interp
