// LineSource: the lines of a program, from a file in chunks, from memory, or from a sender that waits for an answer to each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "rtapi/base/result.hpp"

namespace kerf::interp {

/// `bad`: the line was read but cannot be parsed. `none_yet`: a stream's next line has not come.
enum class LineRead : std::uint8_t { line, end, too_long, changed, failed, bad, none_yet };

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

/// Lines that come one by one. What a loop or a sub may need again stays, by the interpreter's calls; the rest is forgotten, so a
/// stream may be endless.
class LineStream final : public LineSource {
 public:
  /// Bytes of lines that wait or stay.
  static constexpr std::size_t kMostKept = std::size_t{16} * 1024 * 1024;

  explicit LineStream(std::size_t longest_line = kLongestLine) : longest_line_(longest_line) {}
  /// One line, with or without its end. Error: too much is kept.
  [[nodiscard]] rtapi::Status push(std::string_view line);
  /// No more lines come.
  void end() { ended_ = true; }

  LineRead read(std::uint64_t offset, std::string_view& line, std::uint64_t& next) override;
  /// What stands before `offset` and was not kept is not read again.
  void forget_before(std::uint64_t offset);
  /// What stands before `offset` and is still there stays.
  void keep_before(std::uint64_t offset) { fresh_ = std::max(fresh_, offset); }
  /// Lines that were pushed and not read are no longer wanted; how many.
  std::int32_t drop_from(std::uint64_t offset);
  [[nodiscard]] std::uint64_t end_offset() const noexcept { return end_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  std::map<std::uint64_t, std::string> lines_;
  std::uint64_t end_{0};
  std::uint64_t fresh_{0};  ///< lines before this are forgotten, or stay for good
  std::size_t bytes_{0}, longest_line_;
  bool ended_{false};
};

}  // namespace kerf::interp
