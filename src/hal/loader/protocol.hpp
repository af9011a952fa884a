// Packets between the realtime host and its clients, one request or reply each.
//
// Request: u32 id, then for each word u32 length and its bytes. Reply: u32 id, i32 status, then the text to the end of the packet.
// Numbers in the machine's byte order: both ends are on one machine. A client may send any number of requests before it reads;
// replies come in the order of the requests.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::hal {

inline constexpr const char* kHalService = "hal";

struct RequestPacket {
  std::uint32_t id{0};
  std::vector<std::string> argv;
};
struct ReplyPacket {
  std::uint32_t id{0};
  std::int32_t status{0};
  std::string text;
};

std::string encode_request(std::uint32_t id, std::span<const std::string> argv);
std::string encode_reply(const ReplyPacket& reply);
/// nullopt: not a request.
std::optional<RequestPacket> decode_request(std::string_view packet);
std::optional<ReplyPacket> decode_reply(std::string_view packet);

}  // namespace kerf::hal
