// Components that have a stream a channel (sampler, streamer): the lists cfg= and depth=, and what their channels have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/channels.hpp"
#include "hal/component.hpp"
#include "hal/stream.hpp"

namespace kerf::hal {

/// Channels of one component.
inline constexpr std::size_t kStreamChannels = 8;

/// What loadrt said of one channel.
struct StreamChannel {
  std::string_view types;
  std::uint32_t depth{0};
};

struct StreamChannels {
  StreamChannel channel[kStreamChannels];
  std::size_t size{0};
};

namespace detail {
inline void complain(Builder& b, std::string_view what, std::string_view about,
                     std::string_view expected = {}) noexcept {
  rtapi::FixedString<240> text;
  text.append(what);
  text.append(about);
  text.append(expected);
  b.fail(text);
}

inline bool parse_depth(std::string_view text, std::uint32_t& out) noexcept {
  std::uint64_t value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9' || value > kMaxStreamDepth) return false;
    value = value * 10 + static_cast<std::uint64_t>(c - '0');
  }
  out = static_cast<std::uint32_t>(value);
  return !text.empty() && value >= 1 && value <= kMaxStreamDepth;
}

inline bool read_channel(Builder& b, std::string_view types, std::string_view depth,
                         StreamChannel& out) noexcept {
  if (types.empty() || depth.empty()) {
    complain(b, "cfg= and depth= have lists of different lengths", "");
  } else if (types.size() > kStreamColumns) {
    complain(b, "more than 21 pins in cfg=", types);
  } else if (!parse_depth(depth, out.depth)) {
    complain(b, "depth= must be a number from 1 to 10000000, not ", depth);
  } else if (!good_stream_types(types)) {
    complain(b, "unknown type letter in cfg=", types, "; the letters are b f s u l k");
  }
  out.types = types;
  return !b.failed();
}
}  // namespace detail

/// Reads and checks both lists. Empty, and the builder has failed, when they are wrong.
inline StreamChannels read_stream_channels(Builder& b) noexcept {
  std::string_view cfg = b.arg("cfg", "", "Letters of the pins of each channel");
  std::string_view depth = b.arg("depth", "", "Samples that each channel's FIFO holds");
  StreamChannels out;
  if (b.failed()) return out;
  if (cfg.empty() || depth.empty()) {
    detail::complain(b, cfg.empty() ? "cfg=" : "depth=", " is missing");
    return out;
  }
  for (std::size_t n = 0; !cfg.empty() || !depth.empty(); ++n) {
    if (n == kStreamChannels) {
      detail::complain(b, "more than 8 channels", "");
      return {};
    }
    if (!detail::read_channel(b, next_field(cfg), next_field(depth), out.channel[n])) {
      return {};
    }
    out.size = n + 1;
  }
  return out;
}

/// The stream of one channel in memory of the instance; not valid, and the builder has failed, when there is none.
inline Stream make_channel_stream(Builder& b, std::uint32_t key,
                                  const StreamChannel& channel) noexcept {
  std::byte* memory = b.shared_block(
      stream_memory_name(key), Stream::bytes(channel.depth, channel.types.size()), kStreamAbi);
  return memory == nullptr ? Stream() : Stream::create(memory, channel.depth, channel.types);
}

/// One channel: its stream, a pin a column ("COMPONENT.N.pin.M", `Pin` an In or Out of raw slots), and the names of its other pins.
template <class Pin>
class StreamChannelBase {
 public:
  void close() noexcept {
    if (stream_.valid()) stream_.close();
  }

 protected:
  /// `name` with a '#' for the channel's number. Without a stream there are no columns, and the builder has failed.
  StreamChannelBase(Builder& b, std::string_view name, std::uint32_t first_key, std::size_t index,
                    const StreamChannel* configs) noexcept
      : prefix_(numbered(name, index)),
        stream_(
            make_channel_stream(b, first_key + static_cast<std::uint32_t>(index), configs[index])) {
    for (std::size_t i = 0; stream_.valid() && i < stream_.columns(); ++i) {
      columns_.add(b, named(numbered("pin.#", i)),
                   "Value of this column; its type is the letter in cfg=", 0, stream_.type(i));
    }
  }

  [[nodiscard]] const Name& prefix() const noexcept { return prefix_; }
  [[nodiscard]] Name named(std::string_view suffix) const noexcept {
    Name out = prefix_;
    out.append(".");
    out.append(suffix);
    return out;
  }
  /// The next number of the whole range of s32 and round again.
  static std::int32_t count_on(std::int32_t n) noexcept {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(n) + 1U);
  }

  // Realtime state of the derived class, which alone uses them.
  Name prefix_;                            // NOLINT(*-non-private-member-variables-in-classes)
  Stream stream_;                          // NOLINT(*-non-private-member-variables-in-classes)
  PinArray<Pin, kStreamColumns> columns_;  // NOLINT(*-non-private-member-variables-in-classes)
};

/// All channels that loadrt asked for. Programs at the other ends learn of its end.
template <class Channel>
class StreamChannelSet {
 public:
  explicit StreamChannelSet(Builder& b) noexcept {
    const StreamChannels configs = read_stream_channels(b);
    channels_ =
        make_array<Channel>(b, configs.size, static_cast<const StreamChannel*>(configs.channel));
  }
  ~StreamChannelSet() {
    for (Channel& channel : channels_) channel.close();
  }
  StreamChannelSet(const StreamChannelSet&) = delete;
  StreamChannelSet& operator=(const StreamChannelSet&) = delete;

 private:
  Array<Channel> channels_;
};

}  // namespace kerf::hal
