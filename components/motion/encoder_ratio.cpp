// encoder_ratio: electronic gear between two encoders.
#include "hal/channels.hpp"

namespace kerf::components {

namespace {
/// +1 or -1 at each edge, 0 when nothing has changed or an edge was missed.
class Quadrature {
 public:
  int step(bool a, bool b) noexcept {
    const int now = (a ? 1 : 0) ^ (b ? 3 : 0);  // 0 1 2 3 as A leads B
    const int by = (now - before_) & 3;
    before_ = now;
    return by == 1 ? 1 : by == 3 ? -1 : 0;
  }

 private:
  int before_{0};
};
}  // namespace

class EncoderRatioChannel : public hal::Channel {
 public:
  EncoderRatioChannel(hal::Builder& b, std::size_t index, const hal::ChannelList& list) noexcept
      : Channel(b, list.name(b, index)) {}

  void sample(const hal::Period&) noexcept {
    if (first_) {
      // Where the encoders stand is no count.
      first_ = false;
      (void)slave_phases_.step(slave_a_, slave_b_);
      (void)master_phases_.step(master_a_, master_b_);
      return;
    }
    slave_ += slave_phases_.step(slave_a_, slave_b_);
    const std::int64_t master = master_phases_.step(master_a_, master_b_);
    if (enable_) master_ += master;
  }

  void update(const hal::Period&) noexcept {
    const double slave_ppr = slave_ppr_, master_ppr = master_ppr_, slave_teeth = slave_teeth_;
    if (slave_ppr > 0.0) error_now_ += static_cast<double>(slave_) / slave_ppr;
    if (master_ppr > 0.0 && slave_teeth > 0.0)
      error_now_ -= static_cast<double>(master_) * master_teeth_ / (master_ppr * slave_teeth);
    slave_ = 0;
    master_ = 0;
    error_ = error_now_;
  }

 private:
  hal::In<bool> master_a_{pin<hal::In<bool>>("master-A", "First phase of the master's encoder")};
  hal::In<bool> master_b_{pin<hal::In<bool>>("master-B", "Second phase of the master's encoder")};
  hal::In<bool> slave_a_{pin<hal::In<bool>>("slave-A", "First phase of the slave's encoder")};
  hal::In<bool> slave_b_{pin<hal::In<bool>>("slave-B", "Second phase of the slave's encoder")};
  hal::In<bool> enable_{pin<hal::In<bool>>(
      "enable", "True couples slave and master; false: error is the slave's position")};
  hal::Out<double> error_{pin<hal::Out<double>>(
      "error", "Position of the slave minus that of the master times the ratio [revolutions]")};
  hal::Io<std::uint32_t> master_ppr_{
      pin<hal::Io<std::uint32_t>>("master-ppr", "Pulses of a revolution of the master", 0)};
  hal::Io<std::uint32_t> slave_ppr_{
      pin<hal::Io<std::uint32_t>>("slave-ppr", "Pulses of a revolution of the slave", 0)};
  hal::Io<std::uint32_t> master_teeth_{
      pin<hal::Io<std::uint32_t>>("master-teeth", "Teeth of the master's gear", 0)};
  hal::Io<std::uint32_t> slave_teeth_{
      pin<hal::Io<std::uint32_t>>("slave-teeth", "Teeth of the slave's gear", 0)};

  Quadrature slave_phases_, master_phases_;
  bool first_{true};
  std::int64_t slave_{0}, master_{0};  // since the last update
  double error_now_{0.0};
};

class EncoderRatio final : public hal::Component<EncoderRatio> {
 public:
  static constexpr hal::Info kInfo{
      .name = "encoder-ratio",
      .summary = "Electronic gear between two encoders",
      .notes =
          "Feed error to a PID loop that drives the slave. Each edge of an encoder counts as a "
          "pulse. num_chan= or names= give the channels, at most 8.",
      .singleton = true,
      .own_names = true};
  explicit EncoderRatio(hal::Builder& b) noexcept : Component(b) {
    const hal::ChannelList list = hal::channels_by_count(b, 1, 8);
    channels_ = hal::make_array<EncoderRatioChannel>(b, list.size, list);
  }

 private:
  hal::Array<EncoderRatioChannel> channels_;

  void sample(const hal::Period& period) noexcept {
    for (EncoderRatioChannel& c : channels_) c.sample(period);
  }
  hal::Function sample_{function<&EncoderRatio::sample>("sample", "Reads the encoders")};

  void update(const hal::Period& period) noexcept {
    for (EncoderRatioChannel& c : channels_) c.update(period);
  }
  hal::Function update_{function<&EncoderRatio::update>("update", "Computes error")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::EncoderRatio)
