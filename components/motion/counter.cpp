// counter: counts the pulses of a spindle.
#include <cmath>

#include "hal/channels.hpp"

namespace kerf::components {

class CounterChannel : public hal::Channel {
 public:
  CounterChannel(hal::Builder& b, std::size_t index, const hal::ChannelList& list) noexcept
      : Channel(b, list.name(b, index)) {}

  void update_counters(const hal::Period&) noexcept {
    const bool a = phase_a_, z = phase_z_;
    if (a && !a_before_) ++raw_;
    if (z && !z_before_ && index_enable_) {
      zero_ = raw_;
      index_enable_ = false;
    }
    a_before_ = a;
    z_before_ = z;
    rawcounts_ = static_cast<std::int32_t>(raw_);
  }

  void capture_position(const hal::Period& period) noexcept {
    if (reset_) {
      raw_ = zero_ = captured_ = 0;
      rawcounts_ = 0;
    }
    double scale = position_scale_;
    if (std::fabs(scale) < 1e-20) position_scale_ = scale = 1.0;
    counts_ = static_cast<std::int32_t>(raw_ - zero_);
    position_ = static_cast<double>(static_cast<std::int32_t>(raw_ - zero_)) / scale;
    velocity_ = static_cast<double>(static_cast<std::int32_t>(raw_ - captured_)) /
                (scale * period.seconds());
    captured_ = raw_;
  }

 private:
  hal::In<bool> phase_a_{pin<hal::In<bool>>("phase-A", "Pulses to count")};
  hal::In<bool> phase_z_{pin<hal::In<bool>>("phase-Z", "Index pulse")};
  hal::Io<bool> index_enable_{pin<hal::Io<bool>>(
      "index-enable",
      "True: the next rising edge of phase-Z sets counts to zero and this to false")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "True sets counts and rawcounts to zero")};
  hal::Out<std::int32_t> counts_{
      pin<hal::Out<std::int32_t>>("counts", "Pulses since the last reset or index")};
  hal::Out<double> position_{pin<hal::Out<double>>("position", "counts / position-scale")};
  hal::Out<double> velocity_{pin<hal::Out<double>>("velocity", "Change of position in a second")};
  hal::Io<double> position_scale_{
      pin<hal::Io<double>>("position-scale", "Counts of one unit", 1.0)};
  hal::Out<std::int32_t> rawcounts_{
      pin<hal::Out<std::int32_t>>("rawcounts", "Pulses since the start")};

  std::uint32_t raw_{0}, zero_{0}, captured_{0};  // wrap around
  bool a_before_{false}, z_before_{false};
};

class Counter final : public hal::Component<Counter> {
 public:
  static constexpr hal::Info kInfo{.name = "counter",
                                   .summary = "Counts the pulses of a spindle",
                                   .notes =
                                       "Only rising edges of phase-A count, upwards. New files "
                                       "should use encoder with counter-mode.",
                                   .singleton = true,
                                   .own_names = true};
  explicit Counter(hal::Builder& b) noexcept : Component(b) {
    const hal::ChannelList list = hal::channels_by_count(b, 1, 8);
    channels_ = hal::make_array<CounterChannel>(b, list.size, list);
  }

 private:
  hal::Array<CounterChannel> channels_;

  void update_counters(const hal::Period& period) noexcept {
    for (CounterChannel& c : channels_) c.update_counters(period);
  }
  hal::Function update_counters_{
      function<&Counter::update_counters>("update-counters", "Samples the inputs and counts")};

  void capture_position(const hal::Period& period) noexcept {
    for (CounterChannel& c : channels_) c.capture_position(period);
  }
  hal::Function capture_position_{function<&Counter::capture_position>(
      "capture-position", "Brings the counts to the other outputs")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Counter)
