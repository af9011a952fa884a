// RowWriter: what halstreamer does: puts the rows of a text into a streamer's FIFO.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include "hal/stream.hpp"
#include "hal/tools/stream_program.hpp"
#include "rtapi/base/result.hpp"

namespace kerf::hal {

/// One line of text as values of the columns `types`. The error is "field N: what is wrong"; fields count from 0, and what
/// stands behind the last column is left alone.
rtapi::Status parse_row(std::string_view types, const std::string& line, std::uint64_t* values);

class RowWriter final : public StreamTask {
 public:
  /// Reads the descriptor `in` to its end; lines that are wrong are named on `messages`. Both must outlive the writer.
  RowWriter(Stream stream, int in, std::FILE* messages);

  [[nodiscard]] const char* name() const noexcept override { return "halstreamer"; }
  void step(rtapi::Nanos now, rtapi::WaitSpec& next) override;

 private:
  enum class Input : std::uint8_t { more, wait, end };
  Input read_some();
  bool next_line(std::string& line);
  /// False when the FIFO has no room.
  bool put(const std::string& line);

  Stream stream_;
  int in_;
  bool blocks_;  ///< a terminal or a pipe: it may have nothing at present
  std::FILE* messages_;
  std::string text_;     ///< read and not yet used
  std::size_t used_{0};  ///< of text_
  std::size_t searched_{0};
  bool end_of_input_{false};
  std::int64_t line_number_{0};
};

}  // namespace kerf::hal
