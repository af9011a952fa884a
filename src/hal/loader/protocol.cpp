#include "hal/loader/protocol.hpp"

#include <cstring>

namespace kerf::hal {
namespace {

void put(std::string& out, std::uint32_t value) {
  char bytes[4];
  std::memcpy(bytes, &value, 4);
  out.append(bytes, 4);
}

bool take(std::string_view& in, std::uint32_t& value) {
  if (in.size() < 4) return false;
  std::memcpy(&value, in.data(), 4);
  in.remove_prefix(4);
  return true;
}

}  // namespace

std::string encode_request(std::uint32_t id, std::span<const std::string> argv) {
  std::string out;
  put(out, id);
  for (const auto& word : argv) {
    put(out, static_cast<std::uint32_t>(word.size()));
    out += word;
  }
  return out;
}

std::string encode_reply(const ReplyPacket& reply) {
  std::string out;
  put(out, reply.id);
  put(out, static_cast<std::uint32_t>(reply.status));
  out += reply.text;
  return out;
}

std::optional<RequestPacket> decode_request(std::string_view packet) {
  RequestPacket out;
  if (!take(packet, out.id)) return std::nullopt;
  while (!packet.empty()) {
    std::uint32_t size = 0;
    if (!take(packet, size) || size > packet.size()) return std::nullopt;
    out.argv.emplace_back(packet.substr(0, size));
    packet.remove_prefix(size);
  }
  return out;
}

std::optional<ReplyPacket> decode_reply(std::string_view packet) {
  ReplyPacket out;
  std::uint32_t status = 0;
  if (!take(packet, out.id) || !take(packet, status)) return std::nullopt;
  out.status = static_cast<std::int32_t>(status);
  out.text = packet;
  return out;
}

}  // namespace kerf::hal
