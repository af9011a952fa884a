// pid: proportional, integral and derivative controller with feed-forward.
#include <algorithm>
#include <cmath>

#include "hal/channels.hpp"

namespace kerf::components {

namespace {
/// A gain that tuning sets.
using Tuned = hal::detail::Sharing<double, hal::Dir::in, hal::PinCell>;
struct Loops : hal::ChannelList {
  bool debug{false};
};
Loops read_list(hal::Builder& b) noexcept {
  Loops out;
  static_cast<hal::ChannelList&>(out) = hal::channels_by_count(b, 3, 16);
  out.debug = b.arg("debug", "0", "1 shows inner values as pins") != "0";
  return out;
}
}  // namespace

class PidChannel : public hal::Channel {
 public:
  PidChannel(hal::Builder& b, std::size_t index, const Loops& list) noexcept
      : Channel(b, list.name(b, index)) {
    own_command_deriv_ = &command_deriv_.place().slot();
    own_feedback_deriv_ = &feedback_deriv_.place().slot();
    debug_ = list.debug;
    if (!debug_) return;
    error_i_out_.declare(b, whole_name("errorI"), "Integral of the error");
    error_d_out_.declare(b, whole_name("errorD"), "Derivative of the error");
    command_d_out_.declare(b, whole_name("commandD"), "Derivative of the command");
    command_dd_out_.declare(b, whole_name("commandDD"), "Second derivative of the command");
    command_ddd_out_.declare(b, whole_name("commandDDD"), "Third derivative of the command");
    ultimate_gain_.declare(b, whole_name("ultimate-gain"),
                           "Gain at which the loop would swing, from tuning");
    ultimate_period_.declare(b, whole_name("ultimate-period"),
                             "Period of that swing, from tuning [s]");
  }

 private:
  void do_pid_calcs(const hal::Period& period) noexcept {
    const double dt = period.seconds(), per_s = 1.0 / dt;
    if (tune_state_ != Tuning::off) {
      tune(command_ - feedback_, dt);
      return;
    }
    const double command = command_, feedback = feedback_;
    const bool enable = enable_;
    // A step of the position at the index is no motion: the derivatives stay what they are for this call.
    const bool indexed = index_before_ && !index_enable_;
    const double target = error_previous_target_ ? command_before_ : command;
    double error = target - feedback;
    if (indexed) error = command - feedback;
    error_ = error;
    if (tune_mode_) {
      begin_tuning();
      return;
    }
    index_before_ = index_enable_;
    error = limited(error, maxerror_);
    if (error > deadband_)
      error -= deadband_;
    else if (error < -deadband_)
      error += deadband_;
    else
      error = 0.0;
    if (!enable) error_i_ = 0.0;
    if (enable) {
      // An integral that is held while the output is at its limit does not wind up.
      if (limit_state_ * error <= 0.0) error_i_ += error * dt;
      error_i_ = limited(error_i_, max_error_i_);
    }
    command_d_before_ = command_d_;
    if (!indexed) free_command_d_ = (command - command_before_) * per_s;
    if (linked(command_deriv_, own_command_deriv_)) free_command_d_ = command_deriv_;
    if (!indexed) feedback_d_ = (feedback - feedback_before_) * per_s;
    if (linked(feedback_deriv_, own_feedback_deriv_)) feedback_d_ = feedback_deriv_;
    error_d_ = free_command_d_ - feedback_d_;
    error_d_ = limited(error_d_, max_error_d_);
    command_d_ = limited(free_command_d_, max_cmd_d_);
    feedback_before_ = feedback;
    const double command_dd_before = command_dd_;
    command_dd_ = limited((command_d_ - command_d_before_) * per_s, max_cmd_dd_);
    command_ddd_ = limited((command_dd_ - command_dd_before) * per_s, max_cmd_ddd_);
    command_before_ = command;
    double output = 0.0;
    if (!enable) {
      limit_state_ = 0;
    } else {
      output = bias_ + error * pgain_ + error_i_ * igain_ + error_d_ * dgain_ + command * ff0_ +
               command_d_ * ff1_ + command_dd_ * ff2_ + command_ddd_ * ff3_;
      const double most = maxoutput_;
      // A bound that is taken away while it acts leaves the output saturated until it is disabled, as in LinuxCNC.
      if (most != 0.0) {
        limit_state_ = 0;
        if (output > most) {
          output = most;
          limit_state_ = 1;
        } else if (output < -most) {
          output = -most;
          limit_state_ = -1;
        }
      }
    }
    output_ = output;
    const bool saturated = limit_state_ != 0;
    saturated_ = saturated;
    saturated_s_ = saturated ? saturated_s_.last() + dt : 0.0;
    saturated_count_ = saturated ? saturated_count_.last() + 1 : 0;
    show_sums();
  }
  void show_sums() noexcept {
    if (!debug_) return;
    error_i_out_ = error_i_;
    error_d_out_ = error_d_;
    command_d_out_ = command_d_;
    command_dd_out_ = command_dd_;
    command_ddd_out_ = command_ddd_;
  }

  hal::In<bool> enable_{pin<hal::In<bool>>(
      "enable", "True closes the loop; false: output and all inner sums are zero")};
  hal::In<double> command_{pin<hal::In<double>>("command", "Wanted value")};
  hal::In<double> command_deriv_{pin<hal::In<double>>(
      "command-deriv", "Change of command in a second; computed when nothing is linked")};
  hal::In<double> feedback_{pin<hal::In<double>>("feedback", "Actual value")};
  hal::In<double> feedback_deriv_{pin<hal::In<double>>(
      "feedback-deriv", "Change of feedback in a second; computed when nothing is linked")};
  hal::Out<double> error_{pin<hal::Out<double>>("error", "command - feedback")};
  hal::Out<double> output_{pin<hal::Out<double>>("output", "What the actuator is to do")};
  hal::Out<bool> saturated_{
      pin<hal::Out<bool>>("saturated", "True while the output is at its limit")};
  hal::Out<double> saturated_s_{
      pin<hal::Out<double>>("saturated-s", "Time for which it has been there [s]")};
  hal::Out<std::int32_t> saturated_count_{
      pin<hal::Out<std::int32_t>>("saturated-count", "Calls for which it has been there")};
  Tuned pgain_{pin<Tuned>("Pgain", "Output for one unit of error", 1.0)};
  Tuned igain_{pin<Tuned>("Igain", "Output for one unit of error times second", 0.0)};
  Tuned dgain_{pin<Tuned>("Dgain", "Output for one unit of error per second", 0.0)};
  hal::In<double> ff0_{pin<hal::In<double>>("FF0", "Output for one unit of command", 0.0)};
  Tuned ff1_{pin<Tuned>("FF1", "Output for one unit per second of command", 0.0)};
  hal::In<double> ff2_{
      pin<hal::In<double>>("FF2", "Output for one unit per second^2 of command", 0.0)};
  hal::In<double> ff3_{
      pin<hal::In<double>>("FF3", "Output for one unit per second^3 of command", 0.0)};
  hal::In<double> bias_{pin<hal::In<double>>("bias", "Added to the output", 0.0)};
  hal::In<double> deadband_{
      pin<hal::In<double>>("deadband", "Error that is ignored; a larger one is less by this", 0.0)};
  hal::In<double> maxerror_{pin<hal::In<double>>("maxerror", "Limit of the error", 0.0)};
  hal::In<double> max_error_i_{
      pin<hal::In<double>>("maxerrorI", "Limit of the error's integral", 0.0)};
  hal::In<double> max_error_d_{
      pin<hal::In<double>>("maxerrorD", "Limit of the error's derivative", 0.0)};
  hal::In<double> max_cmd_d_{
      pin<hal::In<double>>("maxcmdD", "Limit of the command's derivative", 0.0)};
  hal::In<double> max_cmd_dd_{
      pin<hal::In<double>>("maxcmdDD", "Limit of the command's second derivative", 0.0)};
  hal::In<double> max_cmd_ddd_{
      pin<hal::In<double>>("maxcmdDDD", "Limit of the command's third derivative", 0.0)};
  hal::In<double> maxoutput_{pin<hal::In<double>>("maxoutput", "Limit of the output", 0.0)};
  hal::In<bool> index_enable_{pin<hal::In<bool>>(
      "index-enable",
      "Linked to the encoder's: its falling edge is a step of the command that is no motion")};
  hal::In<bool> error_previous_target_{pin<hal::In<bool>>(
      "error-previous-target",
      "True: the error is that of the command of the last call, as the motion controller counts it",
      true)};
  hal::In<bool> tune_mode_{pin<hal::In<bool>>("tune-mode", "True: tuning instead of control")};
  hal::Io<bool> tune_start_{
      pin<hal::Io<bool>>("tune-start", "True starts tuning; false when it is done")};
  hal::Io<std::uint32_t> tune_type_{pin<hal::Io<std::uint32_t>>(
      "tune-type", "0 computes Pgain, Igain and Dgain; 1 Pgain, Igain and FF1", 0)};
  hal::Io<std::uint32_t> tune_cycles_{
      pin<hal::Io<std::uint32_t>>("tune-cycles", "Half cycles to measure", 50)};
  hal::Io<double> tune_effort_{pin<hal::Io<double>>("tune-effort", "Output while tuning", 0.5)};
  hal::Out<double> error_i_out_, error_d_out_, command_d_out_, command_dd_out_, command_ddd_out_,
      ultimate_gain_, ultimate_period_;

  /// A pin that is linked reads its signal, not the place that it was given.
  static bool linked(hal::In<double>& pin, const void* own) noexcept {
    return &pin.place().slot() != own;
  }
  enum class Tuning : std::uint8_t { off, idle, begins, up, down };
  static double limited(double value, double most) noexcept {
    // A bound below zero gives one of the two bounds for every value, as in LinuxCNC.
    if (most == 0.0) return value;
    return value > most ? most : value < -most ? -most : value;
  }
  /// From control to tuning. Control begins anew when it comes back.
  void begin_tuning() noexcept {
    tune_state_ = Tuning::idle;
    error_i_ = error_d_ = command_d_ = command_dd_ = 0.0;
    limit_state_ = 0;
    command_before_ = 0.0;
    output_ = 0.0;
    show_sums();
  }
  /// The relay: full effort towards the command, until enough half cycles are seen. Between the tunings the output stays.
  void tune(double error, double dt) noexcept {
    error_ = error;
    if (!enable_ || !tune_mode_) {
      tune_state_ = tune_mode_ ? Tuning::idle : Tuning::off;
      tune_start_ = false;
      output_ = bias_;
      return;
    }
    if (tune_state_ == Tuning::idle) {
      if (tune_start_) tune_state_ = Tuning::begins;
      return;
    }
    if (tune_state_ == Tuning::begins) {
      tune_state_ = Tuning::up;
      half_cycles_ = 0;
      cycle_s_ = amplitude_sum_ = peak_ = 0.0;
      relay_begins_ = true;
      show_cycle(0.0, 0.0);
    }
    const double effort = std::fabs(tune_effort_.get());
    if (!relay_begins_) peak_ = std::max(peak_, std::fabs(error));
    const bool crossed =
        (tune_state_ == Tuning::up && error < 0.0) || (tune_state_ == Tuning::down && error >= 0.0);
    // The first way is up, wherever the error is.
    if (crossed && !relay_begins_) {
      tune_state_ = tune_state_ == Tuning::up ? Tuning::down : Tuning::up;
      amplitude_sum_ += peak_;
      peak_ = 0.0;
      ++half_cycles_;
      if (half_cycles_ >= std::max<std::uint32_t>(tune_cycles_, 1)) {
        finish(effort);
        output_ = bias_;
        return;
      }
    }
    relay_begins_ = false;
    cycle_s_ += dt;
    output_ = bias_ + (tune_state_ == Tuning::up ? effort : -effort);
  }
  void show_cycle(double gain, double cycle_s) noexcept {
    if (!debug_) return;
    ultimate_gain_ = gain;
    ultimate_period_ = cycle_s;
  }
  void finish(double effort) noexcept {
    const auto halves = static_cast<double>(half_cycles_);
    const double amplitude = amplitude_sum_ / halves, cycle_s = 2.0 * cycle_s_ / halves;
    tune_state_ = Tuning::idle;
    tune_start_ = false;
    if (!(amplitude > 0.0) || !(cycle_s > 0.0)) return;
    const double gain = 4.0 * effort / (3.14159265358979323846 * amplitude);
    show_cycle(gain, cycle_s);
    if (tune_type_ == 0) {
      pgain_.set(0.6 * gain);
      igain_.set(1.2 * gain / cycle_s);
      dgain_.set(0.075 * gain * cycle_s);
    } else {
      pgain_.set(0.45 * gain);
      igain_.set(0.54 * gain / cycle_s);
      ff1_.set(1.0);
    }
  }
  const void* own_command_deriv_{nullptr};
  const void* own_feedback_deriv_{nullptr};
  double free_command_d_{0.0};  // before its limit
  double error_i_{0.0}, error_d_{0.0}, feedback_d_{0.0}, command_before_{0.0},
      feedback_before_{0.0};
  double command_d_{0.0}, command_d_before_{0.0}, command_dd_{0.0}, command_ddd_{0.0};
  double cycle_s_{0.0}, amplitude_sum_{0.0}, peak_{0.0};
  bool relay_begins_{false};
  std::uint32_t half_cycles_{0};
  int limit_state_{0};
  Tuning tune_state_{Tuning::off};
  bool debug_, index_before_{false};

  hal::Function do_pid_calcs_{
      function<PidChannel, &PidChannel::do_pid_calcs>("do-pid-calcs", "Computes the output")};
};

class Pid final : public hal::Component<Pid> {
 public:
  static constexpr hal::Info kInfo{
#ifdef KERF_AT_PID
      .name = "at_pid",
      .summary = "Obsolete name of pid, which tunes itself too; its pins are called as pid's",
#else
      .name = "pid",
      .summary = "Proportional, integral and derivative controller with feed-forward",
#endif
      .notes =
          "A limit of zero is no limit. While the output is limited the integral does not grow. "
          "With tune-mode on, tune-start drives the loop by a relay of the size of tune-effort "
          "around the command, and from the cycle that arises the gains are computed by the rules "
          "of Ziegler and Nichols. num_chan= or names= give the loops: three without, at most 16. "
          "debug=1 shows inner values as pins.",
      .singleton = true,
      .own_names = true};
  explicit Pid(hal::Builder& b) noexcept : Component(b) {
    const Loops list = read_list(b);
    channels_ = hal::make_array<PidChannel>(b, list.size, list);
  }

 private:
  hal::Array<PidChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Pid)
