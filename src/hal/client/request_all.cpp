#include "hal/client/request_all.hpp"

#include "rtapi/shm/socket.hpp"

namespace kerf::hal {
namespace {

/// Words of one request: with their lengths, and with a number before each command, they fit a packet.
constexpr std::size_t kMostBytes = rtapi::kMaxPacket / 4;

std::size_t bytes_of(const Command& command) {
  std::size_t bytes = 0;
  for (const auto& word : command) bytes += word.size() + 2 * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace

rtapi::Result<std::vector<RefusedCommand>> request_all(Session& session,
                                                       std::span<const Command> commands,
                                                       bool keep_going) {
  std::vector<RefusedCommand> refused;
  for (std::size_t begin = 0; begin < commands.size();) {
    std::size_t end = begin;
    std::size_t bytes = 0;
    do {
      bytes += bytes_of(commands[end++]);
    } while (end < commands.size() && bytes < kMostBytes);
    const auto words = encode_batch(commands.subspan(begin, end - begin), keep_going);
    KERF_TRY(const Reply reply, session.request(std::span<const std::string>(words)));
    const auto failures = decode_failures(reply.text);
    if (!reply.ok() || !failures) return rtapi::fail(rtapi::Errc::protocol, reply.text);
    for (const auto& failure : *failures)
      refused.push_back({begin + failure.id, {failure.status, failure.text}});
    if (!refused.empty() && !keep_going) break;
    begin = end;
  }
  return refused;
}

}  // namespace kerf::hal
