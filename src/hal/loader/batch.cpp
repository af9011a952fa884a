#include "hal/loader/batch.hpp"

#include <charconv>
#include <cstring>

namespace kerf::hal {

std::vector<std::string> encode_batch(std::span<const Command> commands, bool keep_going) {
  std::vector<std::string> words{"batch", keep_going ? "all" : "stop"};
  for (const auto& command : commands) {
    words.push_back(std::to_string(command.size()));
    words.insert(words.end(), command.begin(), command.end());
  }
  return words;
}

std::optional<Batch> decode_batch(std::span<const std::string> words) {
  if (words.empty() || (words[0] != "all" && words[0] != "stop")) return std::nullopt;
  Batch batch;
  batch.keep_going = words[0] == "all";
  for (std::size_t i = 1; i < words.size();) {
    const std::string& text = words[i++];
    std::size_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size() || count > words.size() - i)
      return std::nullopt;
    const auto first = words.begin() + static_cast<std::ptrdiff_t>(i);
    batch.commands.emplace_back(first, first + static_cast<std::ptrdiff_t>(count));
    i += count;
  }
  return batch;
}

// Each failure is a reply packet with its length before it.
std::string encode_failures(std::span<const ReplyPacket> failures) {
  std::string out;
  for (const auto& failure : failures) {
    const std::string packet = encode_reply(failure);
    const auto size = static_cast<std::uint32_t>(packet.size());
    char bytes[sizeof size];
    std::memcpy(bytes, &size, sizeof size);
    out.append(bytes, sizeof size);
    out += packet;
  }
  return out;
}

std::optional<std::vector<ReplyPacket>> decode_failures(std::string_view text) {
  std::vector<ReplyPacket> failures;
  while (!text.empty()) {
    std::uint32_t size = 0;
    if (text.size() < sizeof size) return std::nullopt;
    std::memcpy(&size, text.data(), sizeof size);
    text.remove_prefix(sizeof size);
    if (size > text.size()) return std::nullopt;
    auto failure = decode_reply(text.substr(0, size));
    if (!failure) return std::nullopt;
    failures.push_back(std::move(*failure));
    text.remove_prefix(size);
  }
  return failures;
}

}  // namespace kerf::hal
