// sampler: records pins each cycle for halsampler.
#include "hal/stream.hpp"

#include "hal/component.hpp"
#include "hal/stream_channels.hpp"

namespace kerf::components {

class SamplerChannel : public hal::StreamChannelBase<hal::In<std::uint64_t>> {
 public:
  SamplerChannel(hal::Builder& b, std::size_t index, const hal::StreamChannel* configs) noexcept
      : StreamChannelBase(b, "sampler.#", hal::kSamplerKey, index, configs) {
    if (!stream_.valid()) return;
    curr_depth_.declare(b, named("curr-depth"), "Samples that wait in the FIFO");
    full_.declare(b, named("full"), "True while the FIFO has no room for a sample");
    enable_.declare(b, named("enable"), "True takes a sample at each call", true);
    overruns_.declare(b, named("overruns"), "Samples lost for want of room; may be set back");
    sample_num_.declare(b, named("sample-num"),
                        "Number that the next sample gets; may be set back");
    b.add_function(
        prefix(),
        [](void* object, const hal::Period&) noexcept {
          static_cast<SamplerChannel*>(object)->sample();
        },
        this, "Takes one sample of all pins of this channel");
  }

 private:
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
        overruns_ = count_on(overruns_);
      }
      sample_num_ = count_on(number);
    }
    curr_depth_ = static_cast<std::int32_t>(stream_.size());
    full_ = stream_.full();
  }

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
      .example = "cfg=bfs depth=100",
      .lists = "cfg depth"};

  explicit Sampler(hal::Builder& b) noexcept : Component(b), channels_(b) {}

 private:
  hal::StreamChannelSet<SamplerChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Sampler)
