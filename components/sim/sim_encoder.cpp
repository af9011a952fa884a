// sim_encoder: simulated quadrature encoder.
#include <algorithm>
#include <cmath>

#include "hal/channels.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

class SimEncoderChannel : public hal::Channel {
 public:
  SimEncoderChannel(hal::Builder& b, std::size_t index, const hal::ChannelList& list) noexcept
      : Channel(b, list.name(b, index)) {}

  void make_pulses(const hal::Period& period) noexcept {
    place_ += step_;
    const std::int64_t turn = std::max<std::int64_t>(per_turn_, 4);
    while (place_ >= kOne) {
      place_ -= kOne;
      count_ = count_ + 1 >= turn ? 0 : count_ + 1;
    }
    while (place_ < 0) {
      place_ += kOne;
      count_ = count_ <= 0 ? turn - 1 : count_ - 1;
    }
    const auto quarter = static_cast<std::uint64_t>(count_ & 3);
    phase_a_ = quarter < 2;
    phase_b_ = quarter == 1 || quarter == 2;
    phase_z_ = count_ == 0;
    period_s_ = period.seconds();
  }

  void update_speed(const hal::Period&) noexcept {
    double scale = scale_;
    if (std::fabs(scale) < 1e-20) scale_ = scale = 1.0;
    per_turn_ = std::int64_t{ppr_} * 4;
    // How often make-pulses runs is not known before its first call.
    double counts = speed_ / scale * static_cast<double>(per_turn_) * period_s_;
    counts = rtapi::limited(counts, -1.0, 1.0);
    step_ = static_cast<std::int64_t>(counts * kOne);
    // A whole count a call forwards is more than 32 bits hold: it turns backwards, as LinuxCNC's.
    if (step_ >= kOne) step_ = -kOne;
  }

 private:
  hal::Out<bool> phase_a_{pin<hal::Out<bool>>("phase-A", "First phase")};
  hal::Out<bool> phase_b_{pin<hal::Out<bool>>("phase-B", "Second phase")};
  hal::Out<bool> phase_z_{
      pin<hal::Out<bool>>("phase-Z", "Index pulse, one count wide, once a revolution")};
  hal::In<double> speed_{pin<hal::In<double>>("speed", "Speed [units of scale]")};
  hal::Io<std::uint32_t> ppr_{pin<hal::Io<std::uint32_t>>("ppr", "Pulses of a revolution", 100)};
  hal::Io<double> scale_{
      pin<hal::Io<double>>("scale", "Units of speed that are a revolution per second", 1.0)};
  hal::In<std::int32_t> rawcounts_{
      pin<hal::In<std::int32_t>>("rawcounts", "Accepted for the files that link it")};

  static constexpr std::int64_t kOne = std::int64_t{1} << 31;  // a count, as LinuxCNC divides it
  std::int64_t place_{0}, step_{0}, count_{0}, per_turn_{400};
  double period_s_{0.0};  // of make-pulses
};

class SimEncoder final : public hal::Component<SimEncoder> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-encoder",
      .summary = "Simulated quadrature encoder",
      .notes =
          "Four counts make a pulse. Run make-pulses at least four times as often as there are "
          "pulses. num_chan= or names= give the channels, at most 8.",
      .singleton = true,
      .own_names = true};
  explicit SimEncoder(hal::Builder& b) noexcept : Component(b) {
    const hal::ChannelList list = hal::channels_by_count(b, 1, 8);
    channels_ = hal::make_array<SimEncoderChannel>(b, list.size, list);
  }

 private:
  hal::Array<SimEncoderChannel> channels_;

  void make_pulses(const hal::Period& period) noexcept {
    for (SimEncoderChannel& c : channels_) c.make_pulses(period);
  }
  hal::Function make_pulses_{
      function<&SimEncoder::make_pulses>("make-pulses", "Writes the phases")};

  void update_speed(const hal::Period& period) noexcept {
    for (SimEncoderChannel& c : channels_) c.update_speed(period);
  }
  hal::Function update_speed_{
      function<&SimEncoder::update_speed>("update-speed", "Reads the speed")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimEncoder)
