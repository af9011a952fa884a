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
/// One motor. make_pulses() moves a place by `addend_` each call, which itself runs towards `target_`; crossing the border of a step
/// makes one. Turning back before the times of the last step are over holds the place still, as LinuxCNC does. A pulse that dir has
/// not been set up for comes late, and is not lost.
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
    base_ns_ = period.nominal_ns;
    for (std::int64_t* left : {&high_left_ns_, &low_left_ns_, &turn_left_ns_, &setup_left_ns_})
      *left = std::max<std::int64_t>(*left - base_ns_, 0);
    if (type_ >= 2) {
      show_phases();
    } else if (high_ && high_left_ns_ == 0) {
      end_pulse();
    }
    // Once the motor may turn, it is move() that knows the way: the command may have turned back meanwhile.
    if (held_ && (turn_left_ns_ > 0 || !enable_)) face(addend_);
    if (!enable_) {
      drop_owed_steps();
      return;
    }
    move();
    const std::int64_t owed = owed_steps();
    if (owed != 0 && may_step(owed < 0)) do_step(owed < 0);
    rawcounts_ = static_cast<std::int32_t>(steps_);
  }

  void capture_position(const hal::Period&) noexcept {
    const double scale = position_scale_;
    if (scale != 0.0 && std::fabs(scale) < 1e-20) position_scale_ = 1.0;
    counts_ = static_cast<std::int32_t>(steps_);
    // Without a scale nothing moves.
    position_fb_ = scale == 0.0 ? 0.0 : position_steps() / position_scale_;
  }

  void update_freq(const hal::Period& period) noexcept {
    const double scale = position_scale_, size = std::fabs(scale);
    const double dt = period.seconds(), base_s = static_cast<double>(base_ns_) * 1e-9;
    round_times();
    const double command = command_ * scale;
    const double command_speed = (command - command_before_) / dt;
    command_before_ = command;  // also while the motor stands: then it may jump
    if (!enable_) {
      addend_ = target_ = 0;
      frequency_ = speed_ = 0.0;
      return;
    }
    // The fastest row of steps that the times allow, and what of the limits lies below it.
    const double most = bounded(maxvel_, size, 1.0, fastest(base_s));
    const double change = bounded(maxaccel_, size, dt, most);
    double wanted = 0.0;  // of a command that is no number
    if (std::isfinite(velocity_mode_ ? command : command_speed))
      wanted = velocity_mode_ ? rtapi::limited(command, -most, most)
                              : follow(command, command_speed, change, dt);
    wanted = rtapi::limited(wanted, speed_ - change, speed_ + change);
    wanted = rtapi::limited(wanted, -most, most);
    frequency_ = speed_ = wanted;
    target_ = static_cast<std::int64_t>(wanted * base_s * kOne);
    // At least the smallest there is, as in LinuxCNC: truncated to nothing, a gentle acceleration would never move the motor.
    addend_change_ =
        std::max<std::int64_t>(static_cast<std::int64_t>(change / dt * base_s * base_s * kOne), 1);
  }

 private:
  /// Of a step. With these and truncated products samples agree with LinuxCNC's to the last digit.
  static constexpr int kFraction = 28;
  static constexpr double kOne = 268435456.0;
  static constexpr std::int64_t kHalf = std::int64_t{1} << (kFraction - 1);

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

  /// What the parameters say, in whole calls of make_pulses.
  void round_times() noexcept {
    if (steplen_ns_ == 0) steplen_ns_ = 1U;
    if (type_ == 0 && dirsetup_ns_ == 0 && dirhold_ns_ == 0) dirhold_ns_ = 1U;
    if (type_ == 1 && dirdelay_ns_ == 0) dirdelay_ns_ = 1U;
    round_time(steplen_ns_, high_ns_);
    space_ns_ = setup_ns_ = 0;
    if (type_ < 2) round_time(stepspace_ns_, space_ns_);
    if (type_ == 0) round_time(dirsetup_ns_, setup_ns_);
    round_time(type_ == 0 ? dirhold_ns_ : dirdelay_ns_, hold_ns_);
  }

  void round_time(hal::Param<std::uint32_t>& parameter, std::int64_t& time) noexcept {
    time = (parameter + base_ns_ - 1) / base_ns_ * base_ns_;
    parameter = static_cast<std::uint32_t>(std::min<std::int64_t>(time, UINT32_MAX));
  }

  /// What a limit of the user's allows in this time [steps], a unit of it being `size`. Without one, and where it asks for more,
  /// `most` it is.
  static double bounded(hal::Param<double>& limit, double size, double time_s,
                        double most) noexcept {
    if (limit < 0.0) limit = 0.0;
    const double asked = limit * size * time_s;
    if (asked > most) limit = most / (size * time_s);
    return asked > 0.0 && asked < most ? asked : most;
  }

  /// Steps per second.
  [[nodiscard]] double fastest(double base_s) const noexcept {
    return 1.0 / std::max(static_cast<double>(high_ns_ + space_ns_) * 1e-9, base_s);
  }

  [[nodiscard]] double position_steps() const noexcept {
    return static_cast<double>(place_ - kHalf) / kOne;
  }

  /// Between the place and the pulses made: none, or what dir is not yet set up for.
  [[nodiscard]] std::int64_t owed_steps() const noexcept { return (place_ >> kFraction) - steps_; }

  /// Whoever disables the motor wants no more steps, not even late ones.
  void drop_owed_steps() noexcept {
    const std::int64_t lowest = steps_ << kFraction;
    place_ = std::clamp(place_, lowest, lowest + (std::int64_t{1} << kFraction) - 1);
  }

  void move() noexcept {
    if (held_) {
      if (turn_left_ns_ > 0) return;
      held_ = false;
    }
    const bool before = addend_ < 0;
    addend_ += std::clamp(target_ - addend_, -addend_change_, addend_change_);
    held_ = (addend_ < 0) != before && turn_left_ns_ > 0;
    face(addend_);
    if (!held_) place_ += addend_;
  }

  /// Sets dir to where the place goes, as early as the last pulse allows; before that, to where pulses are owed.
  void face(std::int64_t addend) noexcept {
    const std::int64_t owed = owed_steps(), way = owed != 0 ? owed : addend;
    if (type_ != 0 || way == 0 || (way < 0) == backward_) return;
    if (high_ || turn_left_ns_ > setup_ns_) return;
    backward_ = way < 0;
    outputs_[1] = backward_;
    setup_left_ns_ = setup_ns_;
  }

  [[nodiscard]] bool may_step(bool backward) const noexcept {
    if (high_left_ns_ > 0 || setup_left_ns_ > 0) return false;
    // Up and down are pulses on two pins: between them is dirdelay, not stepspace.
    if (backward != backward_) return type_ != 0 && turn_left_ns_ == 0;
    return low_left_ns_ == 0;
  }

  void do_step(bool backward) noexcept {
    steps_ += backward ? -1 : 1;
    backward_ = backward;
    high_left_ns_ = high_ns_;
    turn_left_ns_ = high_ns_ + hold_ns_ + setup_ns_;
    if (type_ < 2) {
      high_ = true;
      outputs_[type_ == 1 && backward ? 1 : 0] = true;
    } else {
      show_phases();
    }
  }

  void end_pulse() noexcept {
    high_ = false;
    outputs_[0] = false;
    if (type_ == 1) outputs_[1] = false;
    low_left_ns_ = space_ns_;
  }

  void show_phases() noexcept {
    std::int64_t place = steps_ % pattern_.length;
    if (place < 0) place += pattern_.length;
    for (int i = 0; i < pattern_.phases; ++i) outputs_[i] = (pattern_.states[place] >> i & 1) != 0;
  }

  /// The speed [steps/s] that leads to the moving command, a period and a half behind it, as LinuxCNC does: the place is where the
  /// command was in the middle of the period before. `change` is the most that the speed may change in a period.
  [[nodiscard]] double follow(double command, double command_speed, double change,
                              double dt) const noexcept {
    double accel = std::copysign(change * (1.0 / dt), command_speed > speed_ ? 1.0 : -1.0);
    // As fast as the command after this time; the place will have gone on until then, and the command too.
    const double match_s = (command_speed - speed_) / accel;
    const double place = position_steps() + 0.5 * (command_speed + speed_) * match_s;
    const double error = place - (command + command_speed * (match_s - 1.5 * dt));
    if (match_s < dt) {
      constexpr double kNear = 1e-4;  // steps
      return std::fabs(error) < kNear ? command_speed : command_speed - 0.5 * error / dt;
    }
    // Further away: towards the command's speed, or from it if the place gets nearer by that.
    if (std::fabs(error - 2.0 * (2.0 * accel * dt * match_s)) < std::fabs(error)) accel = -accel;
    return speed_ + accel * dt;
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
  bool velocity_mode_{false}, high_{false}, backward_{false};
  bool held_{false};  // the place waits until the motor may turn
  /// Of make_pulses; before its first call, LinuxCNC takes this for it.
  std::int64_t base_ns_{50'000};
  /// In parts of a step; it begins in the middle of one.
  std::int64_t place_{kHalf}, addend_{0}, target_{0}, addend_change_{0};
  std::int64_t steps_{0};
  std::int64_t high_ns_{1}, space_ns_{1}, setup_ns_{1}, hold_ns_{1};
  std::int64_t high_left_ns_{0}, low_left_ns_{0}, turn_left_ns_{0}, setup_left_ns_{0};
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
                          "whole calls of make-pulses. In position mode the motor follows a period "
                          "and a half behind the command, every motor by the same time, so that a "
                          "path stays what it is; position-fb is half a period behind the command "
                          "of the cycle before, which FERROR and MIN_FERROR have to allow (at "
                          "100 mm/s and 1 ms 0.05 mm). A step that dirsetup does not allow yet "
                          "is late, and lost only when the motor is disabled meanwhile.",
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
