// Several commands in one request, done in order: for scripts, where a request each costs more than what it asks for.
//
//   const auto words = encode_batch(commands, false);    // stop at the first that fails
//   const Reply reply = host.command(words);             // 0, and in the text what failed
//   const auto failed = decode_failures(reply.text);
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/loader/protocol.hpp"

namespace kerf::hal {

using Command = std::vector<std::string>;

/// "batch", "all" or "stop", then for each command the number of its words and the words.
std::vector<std::string> encode_batch(std::span<const Command> commands, bool keep_going);
/// From the words behind "batch" on. nullopt: they are no batch.
struct Batch {
  bool keep_going{false};
  std::vector<Command> commands;
};
std::optional<Batch> decode_batch(std::span<const std::string> words);

/// What one command of a batch was refused with; `id` is its place, from 0.
std::string encode_failures(std::span<const ReplyPacket> failures);
std::optional<std::vector<ReplyPacket>> decode_failures(std::string_view text);

}  // namespace kerf::hal
