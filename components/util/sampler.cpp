// sampler: records pins each cycle for halsampler.
#include "hal/stream.hpp"

#include "hal/component.hpp"
#include "hal/stream_channels.hpp"

namespace kerf::components {

class SamplerChannel {
 public:
  SamplerChannel(hal::Builder& b, std::size_t index, const hal::StreamChannel* configs) noexcept {
    const hal::StreamChannel& config = configs[index];
    const hal::Name prefix = hal::numbered("sampler.#", index);
    stream_ =
        hal::make_channel_stream(b, hal::kSamplerKey + static_cast<std::uint32_t>(index), config);
    if (!stream_.valid()) return;

    for (std::size_t i = 0; i < stream_.columns(); ++i) {
      columns_.add(hal::In<std::uint64_t>(
          b.add_pin(name(prefix, hal::numbered("pin.#", i)), stream_.type(i), hal::Dir::in, 0,
                    "Value of this column; its type is the letter in cfg=")));
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
        for (std::size_t i = 0; i < columns_.size(); ++i) {
          row[i] = hal::stream_value(stream_.type(i), columns_[i]);
        }
        // Rows of a stream are numbered from 1, samples from 0.
        stream_.commit(static_cast<std::uint64_t>(std::int64_t{number} + 1));
      } else {
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
};

class Sampler final : public hal::Component<Sampler> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sampler",
      .summary = "Records pins in real time",
      .notes =
          "Each call of sampler.N takes one sample of the channel's pins into a FIFO, from which "
          "the program halsampler prints them. cfg= has a letter for each pin: b bit, f float, s "
          "s32, u u32, l s64, k u64 (either case), at most 21; depth= is how many samples the FIFO "
          "holds. Both take a list with commas, one entry a channel, up to 8 channels; use one "
          "channel a thread. A sample that finds the FIFO full is lost and counted in overruns; "
          "its number is used up, so gaps can be measured.",
      .singleton = true,
      .example = "cfg=bfs depth=100"};

  explicit Sampler(hal::Builder& b) noexcept : Component(b) {
    const hal::StreamChannels configs = hal::read_stream_channels(b);
    channels_ = hal::make_array<SamplerChannel>(
        b, configs.size, static_cast<const hal::StreamChannel*>(configs.channel));
  }
  ~Sampler() {
    for (SamplerChannel& channel : channels_) channel.close();
  }

 private:
  hal::Array<SamplerChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Sampler)
