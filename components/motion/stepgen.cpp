// stepgen: step pulses in software; with KERF_FREQGEN freqgen, its velocity control under the names of old.
#include <algorithm>
#include <cmath>

#include "hal/channels.hpp"
#include "rtapi/base/limited.hpp"

namespace kerf::components {

namespace {
#ifdef KERF_FREQGEN
constexpr bool kFreqgen = true;
#else
constexpr bool kFreqgen = false;
#endif
constexpr std::size_t kMostChannels = 16;
constexpr int kMostPhases = 5;
constexpr int kUserType = 15;

/// What the phases of one step type show at each place of its cycle; bit 0 is phase A.
struct Pattern {
  int phases;
  int length;
  std::uint8_t states[10];
};
/// Types 2 to 14.
constexpr Pattern kPatterns[]{
    {2, 4, {1, 3, 2, 0}},                            // quadrature
    {3, 3, {1, 2, 4}},                               // three phases, full steps
    {3, 6, {1, 3, 2, 6, 4, 5}},                      // and half steps
    {4, 4, {1, 2, 4, 8}},                            // four phases, unipolar, one at a time
    {4, 4, {3, 6, 12, 9}},                           // two at a time
    {4, 4, {1, 7, 14, 8}},                           // bipolar, one winding at a time
    {4, 4, {5, 6, 10, 9}},                           // both windings
    {4, 8, {1, 3, 2, 6, 4, 12, 8, 9}},               // unipolar half steps
    {4, 8, {1, 5, 7, 6, 14, 10, 8, 9}},              // bipolar half steps
    {5, 5, {1, 2, 4, 8, 16}},                        // five phases, full steps
    {5, 5, {3, 6, 12, 24, 17}},                      // two at a time
    {5, 10, {1, 3, 2, 6, 4, 12, 8, 24, 16, 17}},     // half steps
    {5, 10, {3, 7, 6, 14, 12, 28, 24, 25, 17, 19}},  // two or three at a time
};

struct Settings : hal::ChannelList {
  std::string_view types, controls;
  Pattern user{};
  [[nodiscard]] static hal::Name name(const hal::Builder&, std::size_t index) noexcept {
    return hal::numbered(kFreqgen ? "freqgen.#" : "stepgen.#", index);
  }
};

std::string_view field_of(std::string_view list, std::size_t index) noexcept {
  for (std::size_t i = 0; i < index; ++i) hal::next_field(list);
  return hal::next_field(list);
}

/// The places of user_step_type=; false when they are wrong.
bool read_user_pattern(std::string_view text, Pattern& out) noexcept {
  std::uint8_t all = 0;
  while (!text.empty()) {
    std::string_view field = hal::next_field(text);
    if (field.size() > 2 && field[0] == '0' && (field[1] == 'x' || field[1] == 'X'))
      field.remove_prefix(2);
    if (field.empty() || field.size() > 2 || out.length == 10) return false;
    unsigned value = 0;
    for (const char c : field) {
      const unsigned digit = c >= '0' && c <= '9'   ? static_cast<unsigned>(c - '0')
                             : c >= 'a' && c <= 'f' ? static_cast<unsigned>(c - 'a') + 10
                             : c >= 'A' && c <= 'F' ? static_cast<unsigned>(c - 'A') + 10
                                                    : 99;
      if (digit > 15) return false;
      value = value * 16 + digit;
    }
    if (value > 31) return false;
    all = static_cast<std::uint8_t>(all | value);
    out.states[out.length++] = static_cast<std::uint8_t>(value);
  }
  while (out.phases < kMostPhases && (all >> out.phases) != 0) ++out.phases;
  return out.length > 0;
}

Settings read_settings(hal::Builder& b) noexcept {
  Settings out;
  out.types = b.arg("step_type", "", "Step type of each channel, 0 to 15");
  if (!kFreqgen)
    out.controls = b.arg("ctrl_type", "", "Control of each channel: p position, v velocity");
  const std::string_view user =
      b.arg("user_step_type", "", "States of the phases for step type 15");
  out.size = hal::count_fields(out.types);
  if (out.size < 1 || out.size > kMostChannels)
    b.fail("step_type= must have a type for each of 1 to 16 channels");
  for (std::size_t i = 0; i < out.size && !b.failed(); ++i) {
    std::size_t type = 0;
    if (!hal::parse_count(field_of(out.types, i), type) || type > kUserType)
      b.fail("step_type= takes numbers from 0 to 15");
    const std::string_view control = field_of(out.controls, i);
    if (!control.empty() && control != "p" && control != "P" && control != "v" && control != "V")
      b.fail("ctrl_type= takes p and v");
    if (type == kUserType && out.user.length == 0 && !read_user_pattern(user, out.user))
      b.fail("user_step_type= must have 1 to 10 states from 0 to 0x1F for step type 15");
  }
  if (b.failed()) out.size = 0;
  return out;
}
/// One motor. make_pulses() follows a place that moves with `speed_`; a step that the times do not allow yet holds the place back, so
/// that no step is lost.
class StepgenChannel : public hal::Channel {
 public:
  StepgenChannel(hal::Builder& b, std::size_t index, const Settings& list) noexcept
      : Channel(b, Settings::name(b, index)) {
    std::size_t type = 0;
    hal::parse_count(field_of(list.types, index), type);
    type_ = static_cast<int>(type);
    const std::string_view control = field_of(list.controls, index);
    velocity_mode_ = kFreqgen || control == "v" || control == "V";
    if (type_ >= 2) pattern_ = type_ == kUserType ? list.user : kPatterns[type_ - 2];
    declare_items(b);
  }

  void make_pulses(const hal::Period& period) noexcept {
    if (base_ns_ == 0 && type_ >= 2) show_phases();
    base_ns_ = period.nominal_ns;
    for (std::int64_t* left : {&high_left_ns_, &low_left_ns_, &dir_left_ns_, &setup_left_ns_})
      *left = std::max<std::int64_t>(*left - base_ns_, 0);
    if (type_ < 2 && high_left_ns_ == 0 && high_) end_pulse();
    if (!enabled_) return;
    const std::int64_t wanted = place_ + addend_;
    const bool forward = addend_ >= 0;
    if (addend_ != 0 && !turn(forward)) return;  // the place waits with the motor
    const std::int64_t step = (wanted >> kFraction) - steps_;
    if (step == 0) {
      place_ = wanted;
    } else if (may_step()) {
      place_ = wanted;
      do_step(forward);
    } else {
      // As far as the end of this step, no further.
      place_ = forward ? ((steps_ + 1) << kFraction) - 1 : steps_ << kFraction;
    }
    rawcounts_ = static_cast<std::int32_t>(steps_);
  }

  void capture_position(const hal::Period&) noexcept {
    counts_ = static_cast<std::int32_t>(steps_);
    position_fb_ = (static_cast<double>(place_) / kOne - 0.5) / scale();
  }

  void update_freq(const hal::Period& period) noexcept {
    const double scale_now = scale();
    if (base_ns_ == 0) {  // the period of make_pulses is not known before its first call
      command_before_ = velocity_mode_ ? 0.0 : command_.get() * scale_now;
      return;
    }
    const double dt = period.seconds(), base_s = static_cast<double>(base_ns_) * 1e-9;
    round_times();
    const double size = std::fabs(scale_now);
    // The fastest row of steps that the times allow.
    double most = fastest(base_s);
    const double asked = std::fabs(maxvel_.get()) * size;
    if (asked > 0.0) {
      if (asked > most) maxvel_ = most / size;
      most = std::min(most, asked);
    }
    double change = std::fabs(maxaccel_.get()) * size * dt;
    if (change == 0.0) change = most;  // no limit
    enabled_ = enable_;
    if (!enabled_) {
      speed_ = 0.0;
      addend_ = 0;
      // The command may jump while the motor stands.
      command_before_ = command_.get() * scale_now;
      frequency_ = 0.0;
      return;
    }
    double wanted = 0.0;
    if (velocity_mode_) {
      wanted = command_ * scale_now;
    } else {
      wanted = follow(command_ * scale_now, change / dt, dt);
    }
    wanted = rtapi::limited(wanted, -most, most);
    speed_ = rtapi::limited(wanted, speed_ - change, speed_ + change);
    addend_ = std::llround(speed_ * base_s * kOne);
    frequency_ = speed_;
  }

 private:
  static constexpr int kFraction = 32;
  static constexpr double kOne = 4294967296.0;

  void declare_items(hal::Builder& b) noexcept {
    command_.declare(
        b,
        whole_name(kFreqgen         ? "velocity"
                   : velocity_mode_ ? "velocity-cmd"
                                    : "position-cmd"),
        velocity_mode_ ? "Commanded speed [units per second]" : "Commanded position [units]");
    steplen_ns_.declare(
        b, whole_name("steplen"),
        type_ < 2 ? "Length of a pulse [ns]" : "Shortest time between two steps [ns]", 1);
    if (type_ < 2) {
      stepspace_ns_.declare(b, whole_name("stepspace"), "Shortest time between two pulses [ns]", 1);
      outputs_[0].declare(b, whole_name(type_ == 0 ? "step" : "up"),
                          type_ == 0 ? "Pulse for each step" : "Pulse for each step forwards");
      outputs_[1].declare(
          b, whole_name(type_ == 0 ? "dir" : "down"),
          type_ == 0 ? "False forwards, true backwards" : "Pulse for each step backwards");
    }
    if (type_ == 0) {
      dirsetup_ns_.declare(b, whole_name("dirsetup"),
                           "Shortest time from a change of dir to a pulse [ns]", 1);
      dirhold_ns_.declare(b, whole_name("dirhold"),
                          "Shortest time from a pulse to a change of dir [ns]", 1);
    } else {
      dirdelay_ns_.declare(b, whole_name("dirdelay"),
                           "Shortest time between a step forwards and one backwards [ns]", 1);
    }
    for (int i = 0; type_ >= 2 && i < pattern_.phases; ++i) {
      hal::Name name("phase-");
      const char letter = static_cast<char>('A' + i);
      name.append(std::string_view(&letter, 1));
      outputs_[i].declare(b, whole_name(name), "Output for this phase of the motor");
    }
  }

  [[nodiscard]] double scale() noexcept {
    const double scale = position_scale_;
    if (std::fabs(scale) >= 1e-20) return scale;
    position_scale_ = 1.0;
    return 1.0;
  }

  [[nodiscard]] std::int64_t whole_calls(std::int64_t ns) const noexcept {
    return (ns + base_ns_ - 1) / base_ns_ * base_ns_;
  }

  /// What the parameters say, in whole calls of make_pulses.
  void round_times() noexcept {
    if (steplen_ns_ == 0) steplen_ns_ = 1U;
    high_ns_ = whole_calls(steplen_ns_);
    if (type_ < 2) space_ns_ = whole_calls(stepspace_ns_);
    if (type_ == 0) {
      setup_ns_ = whole_calls(dirsetup_ns_);
      hold_ns_ = whole_calls(dirhold_ns_);
    } else {
      hold_ns_ = whole_calls(dirdelay_ns_);
    }
  }

  /// Steps per second.
  [[nodiscard]] double fastest(double base_s) const noexcept {
    const double between_s =
        static_cast<double>(type_ < 2 ? high_ns_ + space_ns_ : high_ns_) * 1e-9;
    return 1.0 / std::max(between_s, base_s);
  }

  /// True when a step in this direction may come; starts the change of direction when it may.
  bool turn(bool forward) noexcept {
    if (forward == forward_) return setup_left_ns_ == 0;
    if (dir_left_ns_ > 0 || high_) return false;
    forward_ = forward;
    if (type_ == 0) {
      outputs_[1] = !forward;
      setup_left_ns_ = setup_ns_;
      return setup_left_ns_ == 0;
    }
    return true;
  }

  [[nodiscard]] bool may_step() const noexcept {
    return type_ < 2 ? !high_ && low_left_ns_ == 0 : high_left_ns_ == 0;
  }

  void do_step(bool forward) noexcept {
    steps_ += forward ? 1 : -1;
    high_left_ns_ = high_ns_;
    if (type_ < 2) {
      high_ = true;
      outputs_[type_ == 1 && !forward ? 1 : 0] = true;
    } else {
      show_phases();
      dir_left_ns_ = high_ns_ + hold_ns_;
    }
  }

  void end_pulse() noexcept {
    high_ = false;
    outputs_[0] = false;
    if (type_ == 1) outputs_[1] = false;
    low_left_ns_ = space_ns_;
    dir_left_ns_ = hold_ns_;
  }

  void show_phases() noexcept {
    std::int64_t place = steps_ % pattern_.length;
    if (place < 0) place += pattern_.length;
    for (int i = 0; i < pattern_.phases; ++i) outputs_[i] = (pattern_.states[place] >> i & 1) != 0;
  }

  /// The speed that brings the place to the command, which moves on as it did in the last period.
  double follow(double command, double accel, double dt) noexcept {
    const double command_speed = (command - command_before_) / dt;
    command_before_ = command;
    const double missing = command - (static_cast<double>(place_) / kOne - 0.5);
    const double size = std::fabs(missing), step = accel * dt;
    // Near: there after this period. Far: the speed from which it can still be braked in whole periods.
    const double closing = size <= step * dt
                               ? size / dt
                               : std::sqrt(0.25 * step * step + 2.0 * accel * size) - 0.5 * step;
    return command_speed + std::copysign(std::min(closing, size / dt), missing);
  }

  hal::Out<std::int32_t> counts_{
      pin<hal::Out<std::int32_t>>("counts", "Position at the last capture-position [steps]")};
  hal::Out<double> position_fb_{
      pin<hal::Out<double>>("position-fb", "Position, finer than a step [units]")};
  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "True makes steps", kFreqgen)};
  hal::RoParam<double> frequency_{
      param<hal::RoParam<double>>("frequency", "Step rate [steps per second]")};
  hal::Param<double> maxaccel_{param<hal::Param<double>>(
      "maxaccel", "Highest acceleration [units per second^2], 0 no limit")};
  hal::Param<double> maxvel_{param<hal::Param<double>>(
      "maxvel", "Highest speed [units per second], 0 what the times allow")};
  hal::Param<double> position_scale_{param<hal::Param<double>>(
      kFreqgen ? "velocity-scale" : "position-scale", "Steps of one unit", 1.0)};
  hal::RoParam<std::int32_t> rawcounts_{
      param<hal::RoParam<std::int32_t>>("rawcounts", "Position at the last make-pulses [steps]")};
  hal::In<double> command_;
  hal::Param<std::uint32_t> steplen_ns_, stepspace_ns_, dirsetup_ns_, dirhold_ns_, dirdelay_ns_;
  hal::Out<bool> outputs_[kMostPhases];

  Pattern pattern_{};
  int type_{0};
  bool velocity_mode_{false}, enabled_{false}, high_{false}, forward_{true};
  std::int64_t base_ns_{0}, place_{std::int64_t{1} << (kFraction - 1)}, addend_{0}, steps_{0};
  std::int64_t high_ns_{1}, space_ns_{1}, setup_ns_{1}, hold_ns_{1};
  std::int64_t high_left_ns_{0}, low_left_ns_{0}, dir_left_ns_{0}, setup_left_ns_{0};
  double speed_{0.0}, command_before_{0.0};  // in steps
};

class Stepgen final : public hal::Component<Stepgen> {
 public:
  static constexpr hal::Info kInfo{
      .name = kFreqgen ? "freqgen" : "stepgen",
      .summary = kFreqgen ? "Step pulses of a wanted frequency" : "Step pulse generator",
      .notes = kFreqgen ? "stepgen with ctrl_type=v under the names that older HAL files have: "
                          "velocity times "
                          "velocity-scale is the frequency. step_type= is that of stepgen. enable "
                          "is true at the start."
                        : "step_type= has a number for each motor, at most 16: 0 step and dir, 1 "
                          "up and down, 2 "
                          "quadrature, 3 and 4 three phases "
                          "(full, half steps), 5 and 6 unipolar and 7 and 8 bipolar four phases, 9 "
                          "and 10 their "
                          "half steps, 11 to 14 five phases, 15 "
                          "the states of user_step_type=. ctrl_type= has p (position, the usual) "
                          "or v (velocity) "
                          "for each. Times are rounded up to "
                          "whole calls of make-pulses. A step that the times do not allow yet is "
                          "late, and never "
                          "lost.",
      .singleton = true,
      .example = "step_type=0,2,5",
      .lists = kFreqgen ? "step_type user_step_type" : "step_type ctrl_type user_step_type",
      .own_names = true};
  explicit Stepgen(hal::Builder& b) noexcept : Component(b) {
    const Settings list = read_settings(b);
    channels_ = hal::make_array<StepgenChannel>(b, list.size, list);
  }

 private:
  hal::Array<StepgenChannel> channels_;

  void make_pulses(const hal::Period& period) noexcept {
    for (StepgenChannel& c : channels_) c.make_pulses(period);
  }
  hal::Function make_pulses_{function<&Stepgen::make_pulses>("make-pulses", "Makes the pulses")};
  void capture_position(const hal::Period& period) noexcept {
    for (StepgenChannel& c : channels_) c.capture_position(period);
  }
  hal::Function capture_position_{
      function<&Stepgen::capture_position>("capture-position", "Writes counts and position-fb")};
  void update_freq(const hal::Period& period) noexcept {
    for (StepgenChannel& c : channels_) c.update_freq(period);
  }
  hal::Function update_freq_{
      function<&Stepgen::update_freq>("update-freq", "Computes the step rate from the command")};
};

}  // namespace
}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Stepgen)
