// motmod: the motion controller's HAL shell. It copies pins to plain values, lets Controller run one cycle, and copies back.
#pragma once

#include <array>
#include <limits>

#include "hal/component.hpp"
#include "hal/switch_off.hpp"
#include "motion/core/controller.hpp"
#include "motion/core/planner/asked_kinematics.hpp"
#include "motion/motmod/args.hpp"
#include "motion/motmod/c_homing.hpp"
#include "motion/motmod/c_kinematics.hpp"
#include "motion/motmod/flight_recorder.hpp"
#include "motion/motmod/pins.hpp"
#include "motion/motmod/planner_participant.hpp"
#include "rtapi/clock/clock.hpp"
#include "rtapi/sync/used_words.hpp"

namespace kerf::motion {

/// Numbered inputs and outputs and those with names of their own, in one row.
class IoPins {
 public:
  void create(hal::Builder& b, const MotmodArgs& args) noexcept;
  [[nodiscard]] std::uint64_t digital_in() const noexcept;
  void read_analog(double* values) const noexcept;
  /// A bit each.
  [[nodiscard]] std::uint64_t errors() const noexcept;
  /// Writes what changed.
  void write(const OutputBank& bank) noexcept;
  [[nodiscard]] std::size_t digital_count() const noexcept { return digital_in_.size(); }
  [[nodiscard]] std::size_t analog_count() const noexcept { return analog_in_.size(); }
  [[nodiscard]] std::size_t error_count() const noexcept { return error_.size(); }

 private:
  hal::PinArray<In<Bit>, kMaxDigital> digital_in_;
  hal::PinArray<Out<Bit>, kMaxDigital> digital_out_;
  hal::PinArray<In<double>, kMaxAnalog> analog_in_;
  hal::PinArray<Out<double>, kMaxAnalog> analog_out_;
  hal::PinArray<In<Bit>, 64> error_;
  OutputBank written_{};
};

class Motmod final : public hal::Component<Motmod> {
 public:
  static constexpr hal::Info kInfo{
      .name = "motmod",
      .summary = "Motion controller: planner, homing, jogging, spindles and synchronised outputs",
      .license = "MIT",
      .notes =
          "Load a kinematics module first. Add motion-command-handler and motion-controller, in "
          "this order, to servo-thread.",
      .singleton = true};

  explicit Motmod(hal::Builder& b) noexcept;

  void command_handler(const hal::Period& period) noexcept;
  void motion_controller(const hal::Period& period) noexcept;

 private:
  void create_parts(hal::Builder& b) noexcept;
  void begin_cells() noexcept;
  void create_unlock_pins(hal::Builder& b) noexcept;
  void read_inputs() noexcept;
  void write_joint(std::size_t j) noexcept;
  void write_axes() noexcept;
  void write_spindle(std::size_t n) noexcept;
  void write_motion(const hal::Period& period) noexcept;
  [[nodiscard]] double path_scale(const PathSpan* move) const noexcept;
  void write_move(const MotionStatus& s) noexcept;
  void publish() noexcept;
  [[nodiscard]] bool task_should_look() noexcept;
  void answer_planner() noexcept;
  void take_config() noexcept;
  void choose_axes() noexcept;
  void take_screws() noexcept;
  /// What motion.switchkins-type asks for; true when that is not the kind in force.
  [[nodiscard]] std::int32_t wanted_kind() const noexcept;
  [[nodiscard]] bool wants_switch(std::int32_t& kind) const noexcept;
  [[nodiscard]] bool has_unlock(std::size_t j) const noexcept {
    return (args_.unlock_mask >> j & 1U) != 0;
  }
  /// Machine units in 1 mm, for a joint or an axis; 1 for rotary ones.
  [[nodiscard]] double joint_scale(std::size_t j) const noexcept { return joint_scale_[j]; }

  MotmodArgs args_;
  const rtapi::Clock& clock_;
  MotionPins pins_;
  hal::Array<JointPins> joint_;
  hal::Array<AxisPins> axis_;
  hal::Array<SpindlePins> spindle_;
  hal::PinArray<In<double>, kMaxJoints> posthome_cmd_;  ///< of the extra joints
  In<Bit> is_unlocked_[kMaxJoints];                     ///< of unlock_joints_mask
  Out<Bit> unlock_[kMaxJoints];
  IoPins io_;
  MotionShared* shared_{nullptr};
  PlannerLink* link_{nullptr};
  Controller* controller_{nullptr};
  PlannerParticipant* planner_{nullptr};
  Kinematics* kinematics_{nullptr};
  CHoming* homing_{nullptr};         ///< [EMCMOT]HOMEMOD, when it is not motmod's own
  AskedKinematics* asked_{nullptr};  ///< the planner's, when the module is in C
  std::uint32_t axis_mask_{0};
  std::uint32_t axes_read_{0};  ///< of which axis.L.jog-* and axis.L.eoffset-* are read
  rtapi::StopWord forsaken_;    ///< the supervisor is dead: drives stay off
  hal::SwitchOff switch_off_{
      [](void* machine) noexcept { static_cast<Motmod*>(machine)->forsaken_.request(); }, this};

  ScrewTable screw_[kMaxJoints];
  std::uint64_t screw_version_[kMaxJoints]{};
  CycleInputs inputs_;
  Orders orders_;
  Intent intent_;
  ServoView view_[2];  ///< of this cycle and of the last one, by turns
  std::size_t view_now_{0};
  /// Of the joints, spindles, inputs and outputs that there are: who reads the cells finds the others as they are by default.
  std::array<rtapi::WordPart, 5> status_parts_{};
  std::array<rtapi::WordPart, 3> view_parts_{};
  std::uint64_t intent_version_{0}, config_version_{0};
  std::uint64_t adopted_version_{0};  ///< of which the harmless values are in force
  std::uint64_t config_wish_{0}, last_wish_{0};
  std::uint64_t limits_version_{0};  ///< of limits and kinematics together, for the planner
  In<double> switchkins_type_;
  static constexpr std::int32_t kNoKind = std::numeric_limits<std::int32_t>::min();
  std::int32_t refused_kind_{kNoKind};  ///< not asked for again until the pin changes
  bool pending_before_{false};
  static constexpr std::int64_t kTellEvery =
      10'000'000;  ///< ns, on whole multiples, at which task and io look anyway
  std::int64_t told_ns_{0};
  bool untold_{false};  ///< something has changed since task was told to look
  double scale_{1};     ///< machine units in 1 mm
  double joint_scale_[kMaxJoints];
  bool coord_error_{false};
  FlightRecorder* recorder_{nullptr};
  std::uint32_t last_ack_{0};
  hal::Function handler_;
  hal::Function function_;
};

}  // namespace kerf::motion
