// siggen: signal generator.
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

namespace {
constexpr double kTwoPi = 6.283185307179586476925;
constexpr std::int64_t kMaxChannels = 16;
}  // namespace

class SiggenChannel {
 public:
  SiggenChannel(hal::Builder& b, std::size_t index) noexcept
      : b_(&b), prefix_(index == 0 ? b.prefix() : hal::numbered("siggen.#", index)) {
    b.add_function(
        whole_name("update"),
        [](void* object, const hal::Period& period) noexcept {
          static_cast<SiggenChannel*>(object)->update(period);
        },
        this, "Computes the next sample of all waves");
    b_ = nullptr;
  }

 private:
  hal::Name whole_name(std::string_view suffix) noexcept {
    hal::Name name = prefix_;
    name.append(".");
    name.append(suffix);
    if (name.truncated()) b_->fail("a channel's name is too long");
    return name;
  }
  template <class Pin>
  Pin make(std::string_view suffix, std::string_view doc, typename Pin::Item initial) noexcept {
    return hal::make_pin<Pin>(*b_, whole_name(suffix), doc, initial);
  }

  void update(const hal::Period& period) noexcept {
    const double amplitude = amplitude_, offset = offset_;
    if (reset_) {
      phase_ = 0.5;
    } else {
      double step = frequency_ * period.seconds();
      if (!(step <= 0.5)) step = 0.5;  // NaN too
      if (step < -0.5) step = -0.5;
      phase_ += step;
      if (phase_ >= 1.0) phase_ -= 1.0;
      if (phase_ < 0.0) phase_ += 1.0;
    }
    const bool high = phase_ > 0.5;
    clock_ = high;
    square_ = offset + (high ? amplitude : -amplitude);
    triangle_ = offset + amplitude * (high ? 4.0 * phase_ - 3.0 : 1.0 - 4.0 * phase_);
    sawtooth_ = offset + amplitude * (2.0 * phase_ - 1.0);
    // sin(pi) is not quite zero in floating point, and reset promises zero.
    sine_ = offset + (reset_ ? 0.0 : amplitude * std::sin(kTwoPi * phase_));
    cosine_ = offset + amplitude * std::cos(kTwoPi * phase_);
  }

  hal::Builder* b_;  // only while constructed
  hal::Name prefix_;
  hal::In<double> frequency_{make<hal::In<double>>(
      "frequency", "Frequency [Hz], bounded to half of the rate of calls", 1.0)};
  hal::In<double> amplitude_{
      make<hal::In<double>>("amplitude", "Peak of the waves above offset", 1.0)};
  hal::In<double> offset_{make<hal::In<double>>("offset", "Added to all waves", 0.0)};
  hal::In<bool> reset_{make<hal::In<bool>>(
      "reset", "While true all waves stand in the middle of their period", false)};
  hal::Out<bool> clock_{
      make<hal::Out<bool>>("clock", "True in the second half of each period", false)};
  hal::Out<double> square_{
      make<hal::Out<double>>("square", "Low in the first half of the period, then high", 0)};
  hal::Out<double> sine_{make<hal::Out<double>>("sine", "Sine wave, from zero upwards", 0.0)};
  hal::Out<double> cosine_{
      make<hal::Out<double>>("cosine", "Cosine wave, from the peak downwards", 0.0)};
  hal::Out<double> triangle_{
      make<hal::Out<double>>("triangle", "Falls while square is low, then rises", 0.0)};
  hal::Out<double> sawtooth_{
      make<hal::Out<double>>("sawtooth", "Rises over the period, then drops", 0.0)};
  double phase_{0.0};  // place in the period, 0 to 1
};

class Siggen final : public hal::Component<Siggen> {
 public:
  static constexpr hal::Info kInfo{
      .name = "siggen",
      .summary = "Signal generator",
      .notes =
          "Each channel makes a square, sine, cosine, triangle and sawtooth wave of one frequency, "
          "amplitude and offset, and a clock bit. num_chan= gives the number of channels (at most "
          "16, default 1), named siggen.0, siggen.1, ...; or names= gives a name for each. Run "
          "update many times a period: above half the rate of calls the frequency is cut. A "
          "negative "
          "frequency runs the waves backwards. Changes of frequency do not make the waves jump."};

  explicit Siggen(hal::Builder& b) noexcept : Component(b) {
    // The loader makes an instance a channel; num_chan= is the older way, and the first instance's to do.
    const std::int64_t channels = int_arg("num_chan", 1, "Number of channels, instead of names=");
    if (b.failed()) return;
    if (channels < 1 || channels > kMaxChannels) {
      b.fail("num_chan= must be from 1 to 16");
    } else if (channels != 1 && b.prefix().view() != "siggen.0") {
      b.fail("num_chan= goes with neither count= nor names=");
    } else {
      channels_ = hal::make_array<SiggenChannel>(b, static_cast<std::size_t>(channels));
    }
  }

 private:
  hal::Array<SiggenChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Siggen)
