// multiswitch: steps a true bit up and down.
#include "hal/channels.hpp"

namespace kerf::components {

namespace {
struct Sizes : hal::ChannelList {
  std::string_view sizes;
};
Sizes read_list(hal::Builder& b) noexcept {
  Sizes out;
  out.sizes = b.arg("cfg", "", "Number of bits of each instance");
  if (out.sizes.empty()) out.sizes = b.arg("personality", "4", "Number of bits of each instance");
  static_cast<hal::ChannelList&>(out) = hal::channels_of(b, hal::count_fields(out.sizes));
  return out;
}
}  // namespace

class MultiswitchChannel : public hal::Channel {
 public:
  MultiswitchChannel(hal::Builder& b, std::size_t index, const Sizes& list) noexcept
      : Channel(b, list.name(b, index)) {
    std::string_view sizes = list.sizes;
    for (std::size_t i = 0; i < index; ++i) hal::next_field(sizes);
    if (!hal::parse_count(hal::next_field(sizes), size_) || size_ < 1 || size_ > 32) {
      b.fail("cfg= must be a list of sizes from 1 to 32");
      size_ = 0;
      return;
    }
    top_position_ = static_cast<std::uint32_t>(size_) - 1U;
    for (std::size_t i = 0; i < size_; ++i)
      bits_[i].declare(b, whole_name(hal::numbered("bit-##", i)), "True at this position");
  }

 private:
  void update(const hal::Period&) noexcept {
    const bool up = up_, down = down_;
    const auto top = static_cast<std::int64_t>(top_position_.get());
    std::int64_t position = position_;
    if (up && !up_before_) ++position;
    if (down && !down_before_) --position;
    up_before_ = up;
    down_before_ = down;
    if (position < 0) position = top;
    if (position > top) position = 0;
    position_ = static_cast<std::int32_t>(position);
    for (std::size_t i = 0; i < size_; ++i) bits_[i] = static_cast<std::int64_t>(i) == position;
  }

  hal::In<bool> up_{pin<hal::In<bool>>("up", "A rising edge steps to the next bit")};
  hal::In<bool> down_{pin<hal::In<bool>>("down", "A rising edge steps to the bit before")};
  hal::Param<std::uint32_t> top_position_{
      param<hal::Param<std::uint32_t>>("top-position", "Highest position", 0)};
  hal::Param<std::int32_t> position_{
      param<hal::Param<std::int32_t>>("position", "Position; may be set", 0)};
  hal::Out<bool> bits_[32]{};
  std::size_t size_{0};
  bool up_before_{false}, down_before_{false};
  hal::Function update_{
      function<MultiswitchChannel, &MultiswitchChannel::update>("", "Steps and writes the bits")};
};

class Multiswitch final : public hal::Component<Multiswitch> {
 public:
  static constexpr hal::Info kInfo{
      .name = "multiswitch",
      .summary = "Steps a true bit up and down",
      .notes =
          "cfg= has the number of bits of each instance; personality= does the same. A step past "
          "either end goes on at the other.",
      .singleton = true,
      .example = "cfg=3",
      .lists = "cfg",
      .own_names = true};
  explicit Multiswitch(hal::Builder& b) noexcept : Component(b) {
    const Sizes list = read_list(b);
    channels_ = hal::make_array<MultiswitchChannel>(b, list.size, list);
  }

 private:
  hal::Array<MultiswitchChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Multiswitch)
