// supply: outputs that follow settings, for tests.
#include "hal/channels.hpp"

namespace kerf::components {

class SupplyChannel : public hal::Channel {
 public:
  SupplyChannel(hal::Builder& b, std::size_t index, const hal::ChannelList& list) noexcept
      : Channel(b, list.name(b, index)) {}

 private:
  void update(const hal::Period&) noexcept {
    const bool d = d_;
    const double value = value_;
    q_ = d;
    not_q_ = !d;
    variable_ = value;
    negative_variable_ = -value;
  }

  hal::Out<bool> q_{pin<hal::Out<bool>>("q", "What d says")};
  hal::Out<bool> not_q_{pin<hal::Out<bool>>("_q", "The opposite of q", true)};
  hal::Out<double> variable_{pin<hal::Out<double>>("variable", "What value says")};
  hal::Out<double> negative_variable_{
      pin<hal::Out<double>>("_variable", "The negative of variable")};
  hal::Io<bool> d_{pin<hal::Io<bool>>("d", "Sets q")};
  hal::Io<double> value_{pin<hal::Io<double>>("value", "Sets variable")};

  hal::Function update_{function<SupplyChannel, &SupplyChannel::update>(
      "update", "Copies the settings to the outputs")};
};

class Supply final : public hal::Component<Supply> {
 public:
  static constexpr hal::Info kInfo{
      .name = "supply",
      .summary = "Outputs that follow settings, for tests",
      .notes =
          "setp and sets do the same today. num_chan= gives the number of channels, at most 8.",
      .singleton = true,
      .own_names = true};
  explicit Supply(hal::Builder& b) noexcept : Component(b) {
    const hal::ChannelList list = hal::channels_by_count(b, 1, 8);
    channels_ = hal::make_array<SupplyChannel>(b, list.size, list);
  }

 private:
  hal::Array<SupplyChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Supply)
