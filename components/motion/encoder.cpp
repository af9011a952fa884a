// encoder: software counting of quadrature encoders.
#include <cmath>

#include "hal/channels.hpp"

namespace kerf::components {

namespace {
/// Place in the cycle of the phases, 0 1 2 3 as A leads B.
class Phases {
 public:
  /// Whether a counts in counter-mode: its rising edge. It is remembered as B would be; so LinuxCNC does, and the first call
  /// after a change of the mode sees one edge more or less than there was.
  bool rises(bool a) noexcept {
    const bool now = a && before_ == 0;
    before_ = a && (before_ == 0 || before_ == 3) ? 3 : 0;
    return now;
  }
  /// +1 or -1 at an edge; 0 without one, or when one was missed.
  int step(bool a, bool b) noexcept {
    const int now = place(a, b);
    const int by = (now - before_) & 3;
    before_ = now;
    return by == 1 ? 1 : by == 3 ? -1 : 0;
  }
  /// Of the four steps of a cycle the one that counts: the two states where A and B are different and equal.
  [[nodiscard]] int whole_cycle(int by) const noexcept {
    if (by > 0) return before_ == 1 ? 1 : 0;
    return before_ == 0 ? -1 : 0;
  }

 private:
  static int place(bool a, bool b) noexcept { return (a ? 1 : 0) ^ (b ? 3 : 0); }
  int before_{0};
};
}  // namespace

class EncoderChannel : public hal::Channel {
 public:
  EncoderChannel(hal::Builder& b, std::size_t index, const hal::ChannelList& list) noexcept
      : Channel(b, list.name(b, index)) {}

  void update_counters(const hal::Period& period) noexcept {
    const bool a = phase_a_, b = phase_b_;
    bool index = phase_z_ && !z_before_;
    z_before_ = phase_z_;
    int by = 0;
    if (counter_mode_) {
      if (phases_.rises(a)) {
        by = 1;
        if (gap_ends(missing_teeth_)) {
          by += missing_teeth_;
          index = true;
        }
      }
    } else {
      by = phases_.step(a, b);
      if (!x4_mode_ && by != 0) by = phases_.whole_cycle(by);
    }
    if (by != 0) {
      raw_ += static_cast<std::uint32_t>(by);
      count_time_ns_ = time_ns_;
      new_counts_ = true;
    }
    if (index && armed_) {
      zero_ = raw_;
      armed_ = false;
      index_seen_ = true;
    }
    const bool latch = latch_input_;
    if (latch != latch_before_ && (latch ? latch_rising_ : latch_falling_)) latched_ = raw_;
    latch_before_ = latch;
    rawcounts_ = static_cast<std::int32_t>(raw_);
    time_ns_ += period.nominal_ns;
  }

  void capture_position(const hal::Period&) noexcept {
    double scale = position_scale_;
    if (std::fabs(scale) < 1e-20) position_scale_ = scale = 1.0;
    if (reset_) zero_ = raw_;
    if (index_seen_) {
      index_seen_ = false;
      index_enable_ = false;
    }
    armed_ = index_enable_;
    const auto counts = static_cast<std::int32_t>(raw_ - zero_);
    const double position = counts / scale;
    const double since_s = static_cast<double>(time_ns_ - count_time_ns_) * 1e-9;
    // Counts per second; not velocity * scale: LinuxCNC divides, so that coarse scales time out.
    const double estimate = min_speed_estimate_;
    const double least = (estimate == 0.0 ? 1.0 : estimate) / std::fabs(scale);
    if (new_counts_) {
      new_counts_ = false;
      const double between_s = static_cast<double>(count_time_ns_ - captured_time_ns_) * 1e-9;
      // The first counts after a stop say when it moved, not how fast.
      if (counts_seen_ < 2)
        ++counts_seen_;
      else if (between_s > 0.0)
        speed_ = reset_
                     ? 0.0
                     : static_cast<double>(static_cast<std::int32_t>(raw_ - captured_)) / between_s;
      captured_ = raw_;
      captured_time_ns_ = count_time_ns_;
    } else if (since_s > 0.0) {
      // No count for so long: it cannot be faster than one count in that time. A minimum below
      // zero is none that any speed could reach.
      const double most = 1.0 / since_s;
      if (std::fabs(speed_) > most) speed_ = std::copysign(most, speed_);
      if (least < 0.0 || since_s * least >= 1.0) {
        speed_ = 0.0;
        counts_seen_ = 0;
      }
    }
    counts_ = counts;
    position_ = position;
    position_interpolated_ = position + speed_ * since_s / scale;
    velocity_ = speed_ / scale;
    velocity_rpm_ = speed_ / scale * 60.0;
    const auto counts_latched = static_cast<std::int32_t>(latched_ - zero_);
    counts_latched_ = counts_latched;
    position_latched_ = counts_latched / scale;
  }

 private:
  hal::In<bool> phase_a_{pin<hal::In<bool>>("phase-A", "First phase")};
  hal::In<bool> phase_b_{pin<hal::In<bool>>("phase-B", "Second phase")};
  hal::In<bool> phase_z_{pin<hal::In<bool>>("phase-Z", "Index pulse")};
  hal::Io<bool> index_enable_{pin<hal::Io<bool>>(
      "index-enable",
      "True: the next rising edge of phase-Z sets counts to zero and this to false")};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "True sets counts and position to zero")};
  hal::Out<std::int32_t> rawcounts_{pin<hal::Out<std::int32_t>>(
      "rawcounts", "Counts since the start, not affected by index or reset")};
  hal::Out<std::int32_t> counts_{
      pin<hal::Out<std::int32_t>>("counts", "Counts since the last index or reset")};
  hal::Out<double> position_{pin<hal::Out<double>>("position", "counts / position-scale")};
  hal::Out<double> position_interpolated_{pin<hal::Out<double>>(
      "position-interpolated",
      "position plus what velocity adds since the last count; not for closing a loop")};
  hal::Out<double> velocity_{pin<hal::Out<double>>("velocity", "Speed [units per second]")};
  hal::Out<double> velocity_rpm_{pin<hal::Out<double>>("velocity-rpm", "Speed [units per minute]")};
  hal::Io<double> position_scale_{
      pin<hal::Io<double>>("position-scale", "Counts of one unit", 1.0)};
  hal::Io<bool> x4_mode_{pin<hal::Io<bool>>(
      "x4-mode", "True: each edge of both phases counts; false: one count a cycle", true)};
  hal::Io<bool> counter_mode_{pin<hal::Io<bool>>(
      "counter-mode", "True: rising edges of phase-A count and phase-B is not used", false)};
  hal::In<std::int32_t> missing_teeth_{pin<hal::In<std::int32_t>>(
      "missing-teeth", "Teeth that the gap has which serves as index, in counter-mode", 0)};
  hal::In<double> min_speed_estimate_{pin<hal::In<double>>(
      "min-speed-estimate",
      "velocity falls to zero once no count has come for position-scale / min-speed-estimate "
      "seconds; 0 is taken for 1",
      1.0)};
  hal::In<bool> latch_input_{pin<hal::In<bool>>("latch-input", "Its edges latch the position")};
  hal::In<bool> latch_rising_{
      pin<hal::In<bool>>("latch-rising", "True: rising edges of latch-input latch", true)};
  hal::In<bool> latch_falling_{
      pin<hal::In<bool>>("latch-falling", "True: falling edges of latch-input latch", true)};
  hal::Out<std::int32_t> counts_latched_{pin<hal::Out<std::int32_t>>(
      "counts-latched", "counts at the last latch, by the index of now")};
  hal::Out<double> position_latched_{
      pin<hal::Out<double>>("position-latched", "position at the last latch")};

  /// Whether this rising edge comes after the gap of missing teeth: later than the teeth that are there.
  bool gap_ends(std::int32_t missing) noexcept {
    const std::int64_t gap = time_ns_ - edge_time_ns_, usual = usual_gap_ns_;
    edge_time_ns_ = time_ns_;
    const bool ends = missing > 0 && usual > 0 && gap * 2 > usual * (2 * std::int64_t{missing} + 1);
    if (!ends) usual_gap_ns_ = gap;
    return ends;
  }
  Phases phases_;
  std::uint32_t raw_{0}, zero_{0}, captured_{0}, latched_{0};  // wrap around
  std::int64_t time_ns_{0}, count_time_ns_{0}, captured_time_ns_{0};
  std::int64_t edge_time_ns_{0}, usual_gap_ns_{0};
  double speed_{0.0};   // counts per second
  int counts_seen_{0};  // since it stood, up to 2
  bool armed_{false}, index_seen_{false}, new_counts_{false}, z_before_{false},
      latch_before_{false};
};

class Encoder final : public hal::Component<Encoder> {
 public:
  static constexpr hal::Info kInfo{
      .name = "encoder",
      .summary = "Software counting of quadrature encoders",
      .notes =
          "update-counters samples the phases and must run at least as often as there are edges; "
          "capture-position scales what it has counted. velocity is taken from the times of the "
          "counts and so is fine at low speed. In counter-mode only rising edges of phase-A count, "
          "upwards. num_chan= or names= give the channels: three without, at most 8.",
      .singleton = true,
      .own_names = true};
  explicit Encoder(hal::Builder& b) noexcept : Component(b) {
    const hal::ChannelList list = hal::channels_by_count(b, 3, 8);
    channels_ = hal::make_array<EncoderChannel>(b, list.size, list);
  }

 private:
  hal::Array<EncoderChannel> channels_;

  void update_counters(const hal::Period& period) noexcept {
    for (EncoderChannel& c : channels_) c.update_counters(period);
  }
  hal::Function update_counters_{
      function<&Encoder::update_counters>("update-counters", "Samples the phases and counts")};

  void capture_position(const hal::Period& period) noexcept {
    for (EncoderChannel& c : channels_) c.capture_position(period);
  }
  hal::Function capture_position_{function<&Encoder::capture_position>(
      "capture-position", "Scales the counts and estimates the speed")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Encoder)
