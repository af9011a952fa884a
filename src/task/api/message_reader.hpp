// Reads the operator messages behind a cursor.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "task/api/status.hpp"

namespace kerf::task {

/// Messages with numbers above `cursor`, which is moved on. `lost`: how many were overwritten before they were read.
inline std::vector<OperatorMessage> read_messages(const MessageLog& log, std::uint64_t& cursor,
                                                  std::uint64_t* lost = nullptr) {
  std::vector<OperatorMessage> out;
  const std::uint64_t newest = log.newest.observe();
  if (newest < cursor) cursor = 0;  // task was started anew
  std::uint64_t from = cursor + 1;
  if (newest > MessageLog::kSlots && from < newest - MessageLog::kSlots + 1)
    from = newest - MessageLog::kSlots + 1;
  for (std::uint64_t n = from; n <= newest; ++n) {
    OperatorMessage m;
    if (log.slot[n % MessageLog::kSlots].read(m) && m.number == n) out.push_back(m);
  }
  if (lost != nullptr) *lost = newest - cursor - out.size();
  cursor = newest;
  return out;
}

/// As a JSON array: [{"number":1,"kind":11,"text":"...","file":"...","line":0,"time_ns":0}, ...]. (protocol.cpp)
[[nodiscard]] std::string format_messages(const std::vector<OperatorMessage>& messages);

}  // namespace kerf::task
