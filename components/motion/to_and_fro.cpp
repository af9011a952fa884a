// axistest and steptest: move one axis to and fro, for tuning a servo or a stepper. The build gives KERF_STEPPER, 0 or 1.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {
namespace {
constexpr bool kStepper = KERF_STEPPER != 0;

// Without linkage: there are several of the name.
class ToAndFro final : public hal::Component<ToAndFro> {
 public:
  static constexpr hal::Info kInfo{.name = kStepper ? "steptest" : "axistest",
                                   .summary = kStepper
                                                  ? "Moves one axis to and fro for tuning a stepper"
                                                  : "Moves one axis to and fro for tuning a servo",
                                   .notes =
                                       "For the test dialogs of the configuration wizards: connect "
                                       "it to a generator that limits speed and acceleration."};
  using Component::Component;

 private:
  hal::In<bool> jog_minus_{pin<hal::In<bool>>("jog-minus", "True moves towards lower positions")};
  hal::In<bool> jog_plus_{pin<hal::In<bool>>("jog-plus", "True moves towards higher positions")};
  hal::In<bool> run_{
      pin<hal::In<bool>>("run", "True moves to and fro around the position at its rising edge")};
  hal::In<double> maxvel_{pin<hal::In<double>>("maxvel", "Speed [units per second]")};
  hal::PinArray<hal::In<double>, 1> maxaccel_{
      pins<hal::In<double>, 1>("maxaccel", kStepper ? 1 : 0, "Acceleration [units per second^2]")};
  hal::In<double> amplitude_{pin<hal::In<double>>("amplitude", "Largest distance from the middle")};
  hal::In<std::int32_t> dir_{pin<hal::In<std::int32_t>>(
      "dir", "0 both sides, 1 the upper side only, 2 the lower side only")};
  hal::Out<double> position_cmd_{pin<hal::Out<double>>(
      "position-cmd",
      "Command for a generator in position mode, which makes the trapezoidal profile")};
  hal::In<double> position_fb_{pin<hal::In<double>>("position-fb", "Position of the generator")};
  hal::Out<bool> running_{pin<hal::Out<bool>>("running", "True while it runs to and fro")};
  hal::Out<double> run_target_{
      pin<hal::Out<double>>("run-target", "Where it goes now, while there is a plan")};
  hal::Out<double> run_start_{pin<hal::Out<double>>("run-start", "Position at the start")};
  hal::Out<double> run_low_{pin<hal::Out<double>>("run-low", "Lower end")};
  hal::Out<double> run_high_{pin<hal::Out<double>>("run-high", "Upper end")};
  hal::In<std::int32_t> pause_{
      pin<hal::In<std::int32_t>>("pause", "Time to wait at each end [s]", 0)};
  hal::Param<double> epsilon_{
      param<hal::Param<double>>("epsilon", "Distance at which an end counts as reached", 0.001)};
  hal::RoParam<double> elapsed_{
      param<hal::RoParam<double>>("elapsed", "Time waited at this end [s]")};
  bool started_{false}, returns_{false}, to_high_{false};
  double waited_s_{0.0};

  void update(const hal::Period& period) noexcept {
    const double at = position_fb_, maxvel = maxvel_;
    if (started_ && !run_) returns_ = true;
    if (returns_) {
      // The way back ends it.
      started_ = false;
      position_cmd_ = run_start_.last();
      returns_ = run_ || std::fabs(at - run_start_.last()) >= epsilon_;
      running_ = returns_;
      return;
    }
    if (!run_) {
      double command = at;
      // So far ahead that the generator, or what limits the axis behind axistest, keeps its speed.
      const double ahead = kStepper ? 2.0 * maxvel * period.seconds() : 10.0;
      if (jog_plus_) command = at + ahead;
      if (jog_minus_) command = at - ahead;
      // As LinuxCNC: at rest steptest takes no notice of a thousandth of the way of a period.
      const double least = 0.001 * maxvel * period.seconds();
      if (kStepper && !jog_plus_ && !jog_minus_ && std::fabs(at - position_cmd_.last()) <= least)
        return;
      position_cmd_ = command;
      return;
    }
    if (!started_) {
      started_ = true;
      const double amplitude = amplitude_;
      run_start_ = at;
      run_low_ = dir_ == 1 ? at : at - amplitude;
      run_high_ = dir_ == 2 ? at : at + amplitude;
      to_high_ = false;
      waited_s_ = 0.0;
      running_ = true;
    }
    const double end = to_high_ ? run_high_.last() : run_low_.last();
    if (std::fabs(at - end) < epsilon_) {
      if (waited_s_ > std::max(pause_.get(), 0)) {
        to_high_ = !to_high_;
        waited_s_ = 0.0;
      } else {
        waited_s_ += period.seconds();
      }
    }
    elapsed_ = waited_s_;
    position_cmd_ = to_high_ ? run_high_.last() : run_low_.last();
  }
  hal::Function update_{
      function<&ToAndFro::update>(kStepper ? "" : "update", "Computes position-cmd")};
};

}  // namespace
}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::ToAndFro)
