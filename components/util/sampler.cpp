// sampler: records pins each cycle for halsampler.
#include "hal/stream.hpp"

#include "hal/component.hpp"

namespace kerf::components {

namespace {
constexpr std::size_t kMaxChannels = 8;
constexpr std::int64_t kMaxDepth = 10'000'000;

/// Cuts the text up to the next comma off the front of `list`.
std::string_view next_field(std::string_view& list) noexcept {
  const std::size_t comma = list.find(',');
  const std::size_t size = comma == std::string_view::npos ? list.size() : comma;
  const std::string_view field(list.data(), size);
  list.remove_prefix(comma == std::string_view::npos ? size : size + 1);
  return field;
}

void complain(hal::Builder& b, std::string_view what, std::string_view about,
              std::string_view expected = {}) noexcept {
  rtapi::FixedString<240> text;
  text.append(what);
  text.append(about);
  text.append(expected);
  b.fail(text);
}
}  // namespace

/// What loadrt said of one channel.
struct SamplerConfig {
  std::string_view types;
  std::uint32_t depth{0};
};

class SamplerChannel {
 public:
  SamplerChannel(hal::Builder& b, std::size_t index, const SamplerConfig* configs) noexcept {
    const SamplerConfig& config = configs[index];
    const hal::Name prefix = hal::numbered("sampler.#", index);
    std::byte* block =
        b.shared_block(hal::stream_block_name("sampler", index),
                       hal::Stream::bytes(config.depth, config.types.size()), hal::kStreamAbi);
    if (block == nullptr) return;
    stream_ = hal::Stream::create(block, config.depth, config.types);

    for (std::size_t i = 0; i < config.types.size(); ++i) {
      columns_.add(hal::In<std::uint64_t>(
          b.add_pin(name(prefix, hal::numbered("pin.#", i)), hal::stream_type(config.types[i]),
                    hal::Dir::in, 0, "Value of this column; its type is the letter in cfg=")));
    }
    curr_depth_ = hal::make_pin<hal::Out<std::int32_t>>(b, name(prefix, "curr-depth"),
                                                        "Samples that wait in the FIFO");
    full_ = hal::make_pin<hal::Out<bool>>(b, name(prefix, "full"),
                                          "True while the FIFO has no room for a sample");
    enable_ = hal::make_pin<hal::In<bool>>(b, name(prefix, "enable"),
                                           "True takes a sample at each call", true);
    overruns_ = hal::make_pin<hal::Io<std::int32_t>>(
        b, name(prefix, "overruns"), "Samples lost for want of room; may be set back");
    sample_num_ = hal::make_pin<hal::Io<std::int32_t>>(
        b, name(prefix, "sample-num"), "Number that the next sample gets; may be set back");
    b.add_function(
        prefix,
        [](void* object, const hal::Period&) noexcept {
          static_cast<SamplerChannel*>(object)->sample();
        },
        this, "Takes one sample of all pins of this channel");
  }

  void close() noexcept {
    if (stream_.valid()) stream_.close();
  }

 private:
  static hal::Name name(hal::Name prefix, std::string_view suffix) noexcept {
    prefix.append(".");
    prefix.append(suffix);
    return prefix;
  }

  void sample() noexcept {
    if (enable_) {
      const std::int32_t number = sample_num_;
      if (std::uint64_t* row = stream_.begin_row(); row != nullptr) {
        for (std::size_t i = 0; i < columns_.size(); ++i) row[i] = columns_[i];
        stream_.commit(number, lost_);
        lost_ = 0;
      } else {
        ++lost_;
        overruns_ = next(overruns_);
      }
      sample_num_ = next(number);
    }
    curr_depth_ = static_cast<std::int32_t>(stream_.size());
    full_ = stream_.full();
  }
  /// Counts through the whole range of s32 and round again.
  static std::int32_t next(std::int32_t n) noexcept {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(n) + 1U);
  }

  hal::Stream stream_;
  hal::PinArray<hal::In<std::uint64_t>, hal::kStreamColumns>
      columns_;  // slots as they are, any type
  hal::Out<std::int32_t> curr_depth_;
  hal::Out<bool> full_;
  hal::In<bool> enable_;
  hal::Io<std::int32_t> overruns_;
  hal::Io<std::int32_t> sample_num_;
  std::uint64_t lost_{0};
};

class Sampler final : public hal::Component<Sampler> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sampler",
      .summary = "Records pins in real time",
      .notes =
          "Each call of sampler.N takes one sample of the channel's pins into a FIFO, from which "
          "the "
          "program halsampler prints them. cfg= has a letter for each pin: b bit, f float, s s32, "
          "u "
          "u32, l s64, k u64 (either case), at most 21; depth= is how many samples the FIFO holds. "
          "Both take a list with commas, one entry a channel, up to 8 channels; use one channel a "
          "thread. A sample that finds the FIFO full is lost and counted in overruns; its number "
          "is used up, so gaps can be measured.",
      .singleton = true};

  explicit Sampler(hal::Builder& b) noexcept : Component(b) { make_channels(b); }
  ~Sampler() {
    for (SamplerChannel& channel : channels_) channel.close();
  }

 private:
  void make_channels(hal::Builder& b) noexcept {
    std::string_view cfg = text_arg("cfg", "", "Letters of the pins of each channel");
    std::string_view depth = text_arg("depth", "", "Samples that each channel's FIFO holds");
    if (b.failed()) return;
    if (cfg.empty() || depth.empty()) {
      return complain(b, cfg.empty() ? "cfg=" : "depth=", " is missing");
    }
    SamplerConfig configs[kMaxChannels];
    std::size_t n = 0;
    for (; !cfg.empty() || !depth.empty(); ++n) {
      if (n == kMaxChannels) return complain(b, "more than 8 channels", "");
      if (!read_config(b, next_field(cfg), next_field(depth), configs[n])) return;
    }
    channels_ = hal::make_array<SamplerChannel>(b, n, static_cast<const SamplerConfig*>(configs));
  }

  bool read_config(hal::Builder& b, std::string_view types, std::string_view depth_text,
                   SamplerConfig& out) noexcept {
    std::int64_t depth = 0;
    if (types.empty() || depth_text.empty()) {
      complain(b, "cfg= and depth= have lists of different lengths", "");
    } else if (types.size() > hal::kStreamColumns) {
      complain(b, "more than 21 pins in cfg=", types);
    } else if (!parse_int(depth_text, depth) || depth < 1 || depth > kMaxDepth) {
      complain(b, "depth= must be a number from 1 to 10000000, not ", depth_text);
    }
    for (std::size_t i = 0; i < types.size(); ++i) {
      if (hal::stream_type(types[i]) == hal::Type::unspecified) {
        complain(b, "unknown type letter in cfg=", types, "; the letters are b f s u l k");
      }
    }
    out = {types, static_cast<std::uint32_t>(depth)};
    return !b.failed();
  }

  hal::Array<SamplerChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Sampler)
