// sim_toolchanger: a tool changer with a carousel and an arm, which can be made to fail at each of its steps.
#include <algorithm>
#include <cmath>

#include "hal/component.hpp"

namespace kerf::components {

class SimToolchanger final : public hal::Component<SimToolchanger> {
 public:
  static constexpr hal::Info kInfo{
      .name = "sim-toolchanger",
      .summary = "Simulated tool changer: carousel, arm, drawbar, and faults at each step",
      .notes =
          "Connect prepare, prep-pocket, prepared, change and changed to tool-prepare, "
          "tool-prep-pocket, tool-prepared, tool-change and tool-changed of iocontrol.0. On "
          "prepare the carousel turns the short way until prep-pocket is at the arm. On change the "
          "arm goes to the spindle, the drawbar opens, arm and spindle swap their tools, the "
          "drawbar closes and the arm goes home; then changed is true until change falls. The tool "
          "taken out stands in the pocket that the new one came from. A change that is called off "
          "half-way is brought to its end without an answer, as a real arm must be; busy is true "
          "until then.\n\n"
          "state: 0 idle, 1 carousel turns, 2 prepared, 3 arm goes out, 4 drawbar opens, 5 swap, 6 "
          "drawbar closes, 7 arm goes home, 8 changed, 9 fault. The step whose number stands in "
          "fault-step fails. With report-faults false the changer just stands there and never "
          "answers; with true, fault comes after fault-timeout, and reason is the step. A fault at "
          "step 2 takes prepared back, one at step 8 changed. After a fault reset brings the "
          "drawbar closed and the arm home, and the changer is idle; fault-step should be 0 by "
          "then. While enable is false, or permit as the arm would go out, everything stands and "
          "goes on afterwards."};
  using Component::Component;

 private:
  enum State : std::int32_t {
    idle = 0,
    turning,
    prepared,
    arm_out,
    opening,
    swapping,
    closing,
    arm_home,
    changed,
    failed,
  };

  hal::In<bool> enable_{pin<hal::In<bool>>("enable", "False: no power, everything stands", true)};
  hal::In<bool> prepare_{pin<hal::In<bool>>("prepare", "True asks for prep-pocket at the arm")};
  hal::In<std::int32_t> prep_pocket_{
      pin<hal::In<std::int32_t>>("prep-pocket", "Pocket of the next tool, 1 to pockets")};
  hal::Out<bool> prepared_{pin<hal::Out<bool>>("prepared", "prep-pocket is at the arm")};
  hal::In<bool> change_{pin<hal::In<bool>>("change", "True asks for the change")};
  hal::Out<bool> changed_{pin<hal::Out<bool>>("changed", "The tool is in the spindle")};
  hal::In<bool> permit_{
      pin<hal::In<bool>>("permit", "The spindle stands where the arm may go to it", true)};
  hal::In<std::int32_t> fault_step_{
      pin<hal::In<std::int32_t>>("fault-step", "Number of the step that fails, 0: none")};
  hal::In<bool> report_faults_{
      pin<hal::In<bool>>("report-faults", "False: a step that fails just never ends", true)};
  hal::In<bool> reset_{pin<hal::In<bool>>("reset", "True ends a fault")};
  hal::Out<bool> fault_{pin<hal::Out<bool>>("fault", "A step did not end in time")};
  hal::Out<std::int32_t> reason_{
      pin<hal::Out<std::int32_t>>("reason", "The step that failed last, 0: none")};
  hal::Out<std::int32_t> state_{pin<hal::Out<std::int32_t>>("state", "The step, see above")};
  hal::Out<bool> busy_{pin<hal::Out<bool>>("busy", "Something moves, or should")};
  hal::Out<std::int32_t> pocket_{
      pin<hal::Out<std::int32_t>>("pocket", "Pocket at the arm, 0: between two", 1)};
  hal::Out<double> position_{
      pin<hal::Out<double>>("position", "Place of the carousel [pockets]", 1.0)};
  hal::Out<std::int32_t> spindle_pocket_{pin<hal::Out<std::int32_t>>(
      "spindle-pocket", "Pocket that the tool in the spindle came from, 0: none yet")};
  hal::Out<bool> arm_is_home_{pin<hal::Out<bool>>("arm-home", "The arm is out of the way", true)};
  hal::Out<bool> arm_is_out_{pin<hal::Out<bool>>("arm-out", "The arm holds the tools")};
  hal::Out<bool> clamped_{pin<hal::Out<bool>>("clamped", "The drawbar is closed", true)};
  hal::Out<bool> motor_fwd_{
      pin<hal::Out<bool>>("motor-fwd", "The carousel turns to higher pockets")};
  hal::Out<bool> motor_rev_{
      pin<hal::Out<bool>>("motor-rev", "The carousel turns to lower pockets")};

  hal::Param<std::int32_t> pockets_{
      param<hal::Param<std::int32_t>>("pockets", "Pockets of the carousel", 16)};
  hal::Param<double> pocket_s_{
      param<hal::Param<double>>("pocket-time", "Time from a pocket to the next [s]", 0.25)};
  hal::Param<double> arm_s_{
      param<hal::Param<double>>("arm-time", "Time of the arm's way [s]", 0.4)};
  hal::Param<double> clamp_s_{
      param<hal::Param<double>>("clamp-time", "Time of the drawbar's way [s]", 0.2)};
  hal::Param<double> swap_s_{param<hal::Param<double>>("swap-time", "Time of the swap [s]", 0.5)};
  hal::Param<double> fault_timeout_s_{param<hal::Param<double>>(
      "fault-timeout", "Time until a step that does not end is a fault [s]", 5.0)};

  State step_{idle};
  double place_{1.0};  // of the carousel
  std::int32_t target_{1};
  double left_s_{0.0};     // of the step
  double overdue_s_{0.0};  // since the step should have ended
  bool wanted_{false};     // the change in progress has not been called off

  void update(const hal::Period& period) noexcept {
    if (enable_) advance(period.seconds());
    show();
  }

  void advance(double dt) noexcept {
    if (step_ >= arm_out && step_ <= arm_home && !change_) wanted_ = false;
    switch (step_) {
      case idle:
        if (change_)
          begin(arm_out, arm_s_);
        else if (prepare_)
          turn();
        return;
      case turning:
        // A new order while it turns, as after an abort: to the new pocket.
        if (prepare_) aim();
        if (fails(dt) || !step_carousel(dt)) return;
        step_ = prepare_ ? prepared : idle;
        return;
      case prepared:
        if (fails(dt)) return;
        if (change_)
          begin(arm_out, arm_s_);
        else if (!prepare_)
          step_ = idle;
        else if (target_ != wanted_pocket())
          turn();
        return;
      case arm_out:
        if (arm_is_home_.last() && !permit_) return;
        if (over(dt)) begin(opening, clamp_s_);
        return;
      case opening:
        if (over(dt)) begin(swapping, swap_s_);
        return;
      case swapping:
        if (!over(dt)) return;
        spindle_pocket_ = target_;
        begin(closing, clamp_s_);
        return;
      case closing:
        if (over(dt)) begin(arm_home, arm_s_);
        return;
      case arm_home:
        if (over(dt)) begin(wanted_ ? changed : idle, 0.0);
        return;
      case changed:
        if (!fails(dt) && !change_) begin(idle, 0.0);
        return;
      case failed:
        if (reset_)
          begin(clamped_.last() ? arm_home : closing, clamped_.last() ? arm_s_ : clamp_s_);
        if (step_ != failed) wanted_ = false;
        return;
    }
  }

  void begin(State step, double seconds) noexcept {
    if (step == arm_out) wanted_ = true;
    step_ = step;
    left_s_ = seconds;
    overdue_s_ = 0.0;
  }

  /// True once the step's time is over and it does not fail.
  bool over(double dt) noexcept {
    left_s_ -= dt;
    return !(left_s_ > 0.5 * dt) && !fails(dt);
  }

  /// The step at hand is the one to fail; after a time that is a fault.
  bool fails(double dt) noexcept {
    if (fault_step_ != step_) {
      overdue_s_ = 0.0;
      return false;
    }
    overdue_s_ += dt;
    if (report_faults_ && overdue_s_ >= fault_timeout_s_) {
      reason_ = step_;
      step_ = failed;
    }
    return true;
  }

  [[nodiscard]] std::int32_t count() const noexcept { return std::max(pockets_.get(), 1); }
  /// prep-pocket, around the carousel.
  [[nodiscard]] std::int32_t wanted_pocket() const noexcept {
    const std::int32_t n = count();
    return ((prep_pocket_ - 1) % n + n) % n + 1;
  }
  void aim() noexcept { target_ = wanted_pocket(); }
  void turn() noexcept {
    aim();
    begin(turning, 0.0);
  }

  /// True when the pocket is there.
  bool step_carousel(double dt) noexcept {
    const double n = count();
    const double missing = std::remainder(target_ - place_, n);
    const double step = pocket_s_ > 0.0 ? dt / pocket_s_ : n;
    if (std::fabs(missing) <= step) {
      place_ = target_;
      return true;
    }
    place_ += std::copysign(step, missing);
    if (place_ < 0.5) place_ += n;
    if (place_ >= n + 0.5) place_ -= n;
    return false;
  }

  void show() noexcept {
    const bool fault_here = fault_step_ == step_;
    state_ = step_;
    fault_ = step_ == failed;
    if (step_ != failed && step_ != idle) reason_ = 0;
    busy_ = step_ == turning || (step_ >= arm_out && step_ <= arm_home);
    prepared_ = step_ == prepared && !fault_here;
    changed_ = step_ == changed && !fault_here;
    if (step_ == arm_out) arm_is_home_ = arm_is_home_.last() && !permit_;
    if (step_ == idle || step_ == changed) arm_is_home_ = true;
    arm_is_out_ = step_ >= opening && step_ <= closing;
    if (step_ == opening) clamped_ = false;
    if (step_ == arm_home || step_ == idle) clamped_ = true;
    position_ = place_;
    const double whole = std::round(place_);
    pocket_ = place_ == whole ? static_cast<std::int32_t>(whole) : 0;
    const double missing = std::remainder(target_ - place_, static_cast<double>(count()));
    const bool turns = step_ == turning && !fault_here && enable_;
    motor_fwd_ = turns && missing > 0.0;
    motor_rev_ = turns && missing < 0.0;
  }
  hal::Function update_{function<&SimToolchanger::update>("", "Moves the changer by one period")};
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::SimToolchanger)
