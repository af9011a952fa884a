// streamer: writes pins from what halstreamer sends, a row at a time.
#include "hal/stream.hpp"

#include "hal/component.hpp"
#include "hal/stream_channels.hpp"

namespace kerf::components {

/// When a row is due, as the pin clock-mode says.
enum ClockMode : std::int32_t { each_call = 0, falling_edge = 1, rising_edge = 2, any_edge = 3 };

class StreamerChannel : public hal::StreamChannelBase<hal::Out<std::uint64_t>> {
 public:
  StreamerChannel(hal::Builder& b, std::size_t index, const hal::StreamChannel* configs) noexcept
      : StreamChannelBase(b, "streamer.#", hal::kStreamerKey, index, configs) {
    if (!stream_.valid()) return;
    curr_depth_.declare(b, named("curr-depth"), "Rows in the FIFO before this call takes one");
    empty_.declare(b, named("empty"), "True when this call found no row in the FIFO", true);
    enable_.declare(b, named("enable"), "True lets rows through to the pins", true);
    underruns_.declare(b, named("underruns"), "Rows that were due and not there; may be set back");
    clock_.declare(b, named("clock"), "Edges on which a row is due, see clock-mode");
    clock_mode_.declare(
        b, named("clock-mode"),
        "When a row is due: 0 at each call, 1 at the falling edge of clock, 2 at the rising edge, "
        "3 at both");
    b.add_function(
        prefix(),
        [](void* object, const hal::Period&) noexcept {
          static_cast<StreamerChannel*>(object)->update();
        },
        this, "Writes the next row to the pins of this channel");
  }

 private:
  bool due() noexcept {
    const bool now = clock_;
    const bool rises = now && !last_clock_;
    const bool falls = !now && last_clock_;
    last_clock_ = now;
    switch (clock_mode_) {
      case each_call: return true;
      case falling_edge: return falls;
      case rising_edge: return rises;
      case any_edge: return rises || falls;
      default: return false;
    }
  }

  void update() noexcept {
    const std::uint32_t waiting = stream_.size();
    curr_depth_ = static_cast<std::int32_t>(waiting);
    empty_ = waiting == 0;
    const bool wanted = due();  // also while disabled: an edge then is gone for good
    if (!wanted || !enable_) return;
    std::uint64_t row[hal::kStreamColumns];
    if (!stream_.read(row)) {
      underruns_ = count_on(underruns_);
      return;
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      columns_[i] = hal::stream_value(stream_.type(i), row[i]);
    }
  }

  hal::Out<std::int32_t> curr_depth_;
  hal::Out<bool> empty_;
  hal::In<bool> enable_;
  hal::Io<std::int32_t> underruns_;
  hal::In<bool> clock_;
  hal::In<std::int32_t> clock_mode_;
  bool last_clock_{false};
};

class Streamer final : public hal::Component<Streamer> {
 public:
  static constexpr hal::Info kInfo{
      .name = "streamer",
      .summary = "Plays data from a file to pins in real time",
      .notes =
          "The program halstreamer fills the FIFO of a channel with rows of text; each call of "
          "streamer.N takes one out and writes its columns to the channel's pins, or, with a clock "
          "mode other than 0, only the calls that see the edge do. cfg= has a letter for each pin: "
          "b bit, f float, s s32, u u32, l s64, k u64 (either case), at most 21; depth= is how "
          "many rows the FIFO holds. Both take a list with commas, one entry a channel, up to 8 "
          "channels. A row that is due and not there is counted in underruns, and the pins keep "
          "their values.",
      .singleton = true,
      .example = "cfg=bfs depth=100",
      .lists = "cfg depth"};

  explicit Streamer(hal::Builder& b) noexcept : Component(b), channels_(b) {}

 private:
  hal::StreamChannelSet<StreamerChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Streamer)
