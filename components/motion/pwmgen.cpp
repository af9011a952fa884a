// pwmgen: pulse width or pulse density modulation in software.
#include <algorithm>
#include <cmath>

#include "hal/channels.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

namespace {
struct Types : hal::ChannelList {
  std::string_view types;
};
Types read_list(hal::Builder& b) noexcept {
  Types out;
  out.types = b.arg("output_type", "", "Type of each channel: 0 pwm, 1 pwm and dir, 2 up and down");
  out.size = hal::count_fields(out.types);
  if (out.size < 1 || out.size > 8)
    b.fail("output_type= must have a type for each of 1 to 8 channels");
  std::string_view rest = out.types;
  while (!rest.empty() && !b.failed()) {
    const std::string_view type = hal::next_field(rest);
    if (type != "0" && type != "1" && type != "2") b.fail("output_type= takes 0, 1 and 2");
  }
  if (b.failed()) out.size = 0;
  return out;
}
}  // namespace

class PwmgenChannel : public hal::Channel {
 public:
  PwmgenChannel(hal::Builder& b, std::size_t index, const Types& list) noexcept
      : Channel(b, list.name(b, index)) {
    std::string_view types = list.types;
    for (std::size_t i = 0; i < index; ++i) hal::next_field(types);
    const std::string_view type = hal::next_field(types);
    type_ = type.empty() ? 0 : type[0] - '0';
    if (type_ == 2) {
      first_.declare(b, whole_name("up"), "Pulses for positive values");
      second_.declare(b, whole_name("down"), "Pulses for negative values");
    } else {
      first_.declare(b, whole_name("pwm"), "Pulses");
      if (type_ == 1) second_.declare(b, whole_name("dir"), "True for negative values");
    }
  }

  void make_pulses(const hal::Period& period) noexcept {
    dt_ns_ = period.nominal_ns;
    if (!running_) {
      timer_ns_ = high_left_ns_ = 0;
      set_outputs(false);
      return;
    }
    if (high_) high_left_ns_ -= dt_ns_;
    if (mode_ == Mode::pdm) {
      high_left_ns_ += high_ns_;
      set_outputs(high_left_ns_ > 0);
      return;
    }
    timer_ns_ += dt_ns_;
    const bool starts = timer_ns_ >= period_ns_;
    if (starts) timer_ns_ = period_ns_ > 0 ? timer_ns_ - period_ns_ : 0;
    if (mode_ == Mode::dithered) {
      if (starts) high_left_ns_ += high_ns_;
      set_outputs(high_left_ns_ > 0 && (starts || high_));
    } else {
      set_outputs((starts || high_) && timer_ns_ < high_ns_);
    }
  }

  void update(const hal::Period& period) noexcept {
    const std::int64_t dt_ns = dt_ns_ > 0 ? dt_ns_ : period.nominal_ns;
    if (const double scale = scale_; scale != known_scale_) {
      known_scale_ = scale;
      if (std::fabs(scale) < 1e-20) scale_ = 1.0;
      per_scale_ = 1.0 / scale_.get();
    }
    double most = rtapi::limited(max_dc_.get(), 0.0, 1.0),
           least = rtapi::limited(min_dc_.get(), 0.0, most);
    max_dc_ = most;
    min_dc_ = least;
    double frequency = pwm_freq_;
    const bool dither = dither_pwm_;
    const Mode mode_before = mode_;
    // A frequency below zero is none from the next call on. In this one plain pulses still have the duty that the period before allows.
    const bool rounds = !dither && frequency != 0.0;
    if (frequency <= 0.0) {
      mode_ = rounds ? Mode::plain : Mode::pdm;
      if (!rounds) calls_ = 0;
      period_ns_ = 0;
      pwm_freq_ = 0.0;
    } else {
      const double most_calls = 1e9 / static_cast<double>(dt_ns);
      if (frequency < kLeastFrequency || frequency > 0.5 * most_calls)
        pwm_freq_ = frequency = rtapi::limited(frequency, kLeastFrequency, 0.5 * most_calls);
      mode_ = dither ? Mode::dithered : Mode::plain;
      if (dither) {
        period_ns_ = static_cast<std::int64_t>(1e9 / frequency);
      } else {
        calls_ = std::max<std::int64_t>(2, std::llround(most_calls / frequency));
        period_ns_ = calls_ * dt_ns;
        if (enable_) pwm_freq_ = most_calls / static_cast<double>(calls_);
      }
    }
    if (mode_ != mode_before && (mode_ == Mode::plain || mode_before == Mode::plain))
      timer_ns_ = high_left_ns_ = 0;
    double duty = value_ * per_scale_ + offset_;
    const bool negative = duty < 0.0;
    double size = std::fabs(duty);
    if (type_ == 0 && negative) size = 0.0;
    size = rtapi::limited(size, least, most);
    const bool enable = enable_;
    if (enable && rounds) {
      const auto calls_high =
          static_cast<std::int64_t>(std::floor(size * static_cast<double>(calls_) + 0.5));
      high_ns_ = calls_high * dt_ns;
      size = calls_ > 0 ? static_cast<double>(calls_high) / static_cast<double>(calls_) : 0.0;
    } else {
      high_ns_ = mode_ == Mode::pdm
                     ? std::llround(size * static_cast<double>(dt_ns))
                     : static_cast<std::int64_t>(size * static_cast<double>(period_ns_));
    }
    negative_ = negative && type_ != 0;
    if (type_ == 1) second_ = negative_;
    running_ = enable;
    curr_dc_ = negative_ ? -size : size;
  }

 private:
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True: pulses; false: all outputs are low")};
  hal::In<double> value_{
      pin<hal::In<double>>("value", "Command: value / scale + offset is the duty")};
  hal::Io<double> scale_{pin<hal::Io<double>>("scale", "Value of full duty", 1.0)};
  hal::Io<double> offset_{pin<hal::Io<double>>("offset", "Added to the duty", 0.0)};
  hal::Io<double> pwm_freq_{pin<hal::Io<double>>(
      "pwm-freq", "Frequency [Hz], at most half that of make-pulses; 0 pulse density modulation",
      0.0)};
  hal::Io<bool> dither_pwm_{pin<hal::Io<bool>>(
      "dither-pwm", "True: pulses of different lengths make up the exact duty", false)};
  hal::Io<double> min_dc_{pin<hal::Io<double>>("min-dc", "Lowest duty", 0.0)};
  hal::Io<double> max_dc_{pin<hal::Io<double>>("max-dc", "Highest duty", 1.0)};
  hal::Out<double> curr_dc_{pin<hal::Out<double>>("curr-dc", "Duty now, -1 to 1")};
  hal::Out<bool> first_, second_;

  enum class Mode : std::uint8_t { pdm, plain, dithered };
  void set_outputs(bool high) noexcept {
    high_ = high;
    if (type_ == 2) {
      first_ = high && !negative_;
      second_ = high && negative_;
    } else {
      first_ = high;
    }
  }
  static constexpr double kLeastFrequency = 0.5;  // Hz, as LinuxCNC's
  std::int64_t dt_ns_{0}, timer_ns_{0}, period_ns_{0}, high_ns_{0}, high_left_ns_{0}, calls_{0};
  double known_scale_{1.0}, per_scale_{1.0};
  int type_{0};
  Mode mode_{Mode::pdm};
  bool running_{false}, negative_{false}, high_{false};
};

class Pwmgen final : public hal::Component<Pwmgen> {
 public:
  static constexpr hal::Info kInfo{
      .name = "pwmgen",
      .summary = "Pulse width or pulse density modulation in software",
      .notes =
          "output_type= has a number for each channel, at most 8: 0 pwm alone, 1 pwm and dir, 2 up "
          "and down. pwm-freq of zero makes pulse density modulation. Without dither-pwm the "
          "period and the duty are rounded to whole calls of make-pulses; with it they are right "
          "on the average.",
      .singleton = true,
      .example = "output_type=0,1,2",
      .lists = "output_type",
      .own_names = true};
  explicit Pwmgen(hal::Builder& b) noexcept : Component(b) {
    const Types list = read_list(b);
    channels_ = hal::make_array<PwmgenChannel>(b, list.size, list);
  }

 private:
  hal::Array<PwmgenChannel> channels_;

  void make_pulses(const hal::Period& period) noexcept {
    for (PwmgenChannel& c : channels_) c.make_pulses(period);
  }
  hal::Function make_pulses_{function<&Pwmgen::make_pulses>("make-pulses", "Makes the pulses")};

  void update(const hal::Period& period) noexcept {
    for (PwmgenChannel& c : channels_) c.update(period);
  }
  hal::Function update_{function<&Pwmgen::update>("update", "Computes the duty")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Pwmgen)
