// Where a line of a program stands: what must be known before a program may begin in its middle.
#pragma once

#include <cstdint>
#include <string>

#include "rtapi/base/result.hpp"

namespace kerf::task {

struct LinePlace {
  std::int32_t line{
      0};  ///< the first line with code at the wished one or behind it; 0: there is none
  std::string
      inside;  ///< "sub o<cut> (line 3)", "loop o100 (line 12)": runs more than once, or not in this place; "": once
};

/// Reads the O-words of the file, nothing else. Errors: the file cannot be read.
[[nodiscard]] rtapi::Result<LinePlace> find_line(const std::string& path, std::int32_t line);
/// The same of a text in memory.
[[nodiscard]] LinePlace find_line_in(std::string_view program, std::int32_t line);

}  // namespace kerf::task
