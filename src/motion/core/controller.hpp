// Controller: everything that happens in one servo cycle, from feedback to commanded positions. Pure arithmetic, @rt.
//
// The shell (motmod, or a test) fills Inputs and Orders, calls step(), then copies status(), spindle and digital outputs to
// where they belong, publishes faults() and wakes whom changed() and view() concern.
#pragma once

#include <cstdint>

#include "motion/api/config.hpp"
#include "motion/api/kinematics.hpp"
#include "motion/api/screw.hpp"
#include "motion/core/executor.hpp"
#include "motion/core/external_offsets.hpp"
#include "motion/core/guard.hpp"
#include "motion/core/homing.hpp"
#include "motion/core/io.hpp"
#include "motion/core/jog_pace.hpp"
#include "motion/core/joint.hpp"
#include "motion/core/lost_cycles.hpp"
#include "motion/core/path_oracle.hpp"
#include "motion/core/spindles.hpp"

namespace kerf::motion {

class Controller {
 public:
  Controller(const Kinematics& kinematics, SpanRing& spans, const PlanSlots& slots,
             FaultRing& planner_faults, std::int32_t joints, std::int32_t spindles) noexcept;

  /// New limits; only while may_configure(), since moves under way were planned with the old ones.
  void configure(const MachineConfig& config) noexcept;
  /// Those values of new limits that bear on no move under way (following error, home positions); at any time.
  void adopt(const MachineConfig& config) noexcept;
  [[nodiscard]] bool at_rest() const noexcept;
  [[nodiscard]] bool homing() const noexcept { return homing_.active(); }
  [[nodiscard]] bool may_configure() const noexcept { return at_rest() && executor_.idle(); }
  /// Homing by somebody else, who stays the caller's.
  void use_homing(HomingModule& module) noexcept { homing_.use(module); }
  /// One of each joint; they stay the caller's, and change only while may_configure().
  void use_screws(const ScrewTable* tables) noexcept { screws_ = tables; }
  /// Other kinematics may be put in force: nothing is planned, nothing moves.
  [[nodiscard]] bool may_switch() const noexcept { return may_configure() && !homing_.active(); }
  /// Puts another kind of the kinematics in force while may_switch() and the planner stands still. The joints stay where they
  /// are; the position becomes what they mean now. False: refused, which the next step() says, and all is as before.
  bool switch_kinematics(Kinematics& kinematics, std::int32_t kind) noexcept;
  /// Pins of the kinematics (the length of a tool, a pivot) have changed while the machine stood: its joints mean another position
  /// now. They stay where they are, beside the one that is said, until take_up_kinematics().
  [[nodiscard]] bool kinematics_moved() const noexcept { return kinematics_moved_; }
  /// As switch_kinematics(), of what has changed by itself. Without a position there the next step() switches the machine off.
  void take_up_kinematics() noexcept { unplaced_ = !settle(); }

  void step(const Inputs& in, const Orders& orders, double dt, std::int64_t now_ns) noexcept;

  [[nodiscard]] const MotionStatus& status() const noexcept { return status_; }
  /// For the shell, which adds what only it knows (inputs of M66).
  [[nodiscard]] MotionStatus& status() noexcept { return status_; }
  [[nodiscard]] const FaultList& faults() const noexcept { return faults_; }
  [[nodiscard]] const OutputBank& outputs() const noexcept { return outputs_; }
  [[nodiscard]] const Spindles& spindles() const noexcept { return spindles_; }
  [[nodiscard]] const Executor& executor() const noexcept { return executor_; }
  [[nodiscard]] const ExternalOffsets& offsets() const noexcept { return offsets_; }
  [[nodiscard]] const Joint& joint(std::size_t j) const noexcept { return joint_[j]; }
  [[nodiscard]] const AxisMover& axis(std::size_t i) const noexcept { return axis_[i]; }
  /// joint.N.unlock: homing wants it, or the path.
  [[nodiscard]] bool unlocks(std::size_t j) const noexcept {
    return joint_[j].unlock || executor_.unlocks(static_cast<std::int32_t>(j));
  }
  [[nodiscard]] bool joint_wheel_active(std::size_t j) const noexcept {
    return joint_wheel_[j].drives && joint_[j].mover.active();
  }
  [[nodiscard]] bool axis_wheel_active(std::size_t i) const noexcept {
    return axis_wheel_[i].drives && axis_[i].active();
  }
  [[nodiscard]] std::size_t joints() const noexcept { return joints_; }
  [[nodiscard]] const MachineConfig& config() const noexcept { return config_; }
  /// For the planner.
  [[nodiscard]] ServoView view() const noexcept;
  /// All but what the shell knows; of joints those that there are.
  void fill(ServoView& view) const noexcept;
  /// True when this cycle changed something that task waits for.
  [[nodiscard]] bool changed() const noexcept { return changed_; }
  /// True when it ended items, and changed nothing else.
  [[nodiscard]] bool only_went_on() const noexcept { return only_went_on_; }

  /// All of it while may_switch(), for the flight record: rest_state.hpp. A controller that takes it over goes on as this one.
  struct Rest;
  void save(Rest& r) const noexcept;
  void restore(const Rest& r) noexcept;

 private:
  // controller.cpp: power and safety
  void read_feedback(const Inputs& in) noexcept;
  void read_position(Joint& joint, const JointInputs& source) noexcept;
  void watch_feedback() noexcept;
  void take_start_positions() noexcept;
  void switch_power(const Inputs& in, const Orders& orders) noexcept;
  [[nodiscard]] bool may_enable(const Inputs& in, const Orders& orders) noexcept;
  void enable() noexcept;
  void disable() noexcept;
  void apply_safe_outputs() noexcept;
  void watch_overrun(const Inputs& in, double dt) noexcept;
  void watch_heartbeat(const Orders& orders, double dt) noexcept;
  [[nodiscard]] bool machine_fault(const Inputs& in, const Orders& orders) noexcept;
  [[nodiscard]] bool joint_fault(std::size_t j, const Orders& orders) noexcept;
  void stop_everything(const Orders& orders) noexcept;
  void finish_abort(const Orders& orders) noexcept;
  /// Movers and path where the joints stand. False: the kinematics have no position there.
  bool settle() noexcept;
  [[nodiscard]] bool has_position() const noexcept;
  void take_requests(const Orders& orders) noexcept;
  void take_wishes(const Intent& want) noexcept;

  // controller_motion.cpp: modes and what moves in them
  [[nodiscard]] bool all_homed() const noexcept;
  [[nodiscard]] bool may_leave_free() const noexcept;
  void switch_mode(const Orders& orders) noexcept;
  void enter(MotionMode mode) noexcept;
  void take_jogs(const Inputs& in, const Orders& orders) noexcept;
  void take_jog(const JogIntent& jog, std::uint32_t& seen, bool allowed, AxisMover& mover,
                std::int32_t index, double speed_limit, double low, double high) noexcept;
  /// How far a jog of this joint or axis may go.
  struct Range {
    double low, high;
  };
  [[nodiscard]] Range joint_range(std::size_t j, const Intent& want) const noexcept;
  [[nodiscard]] Range axis_range(std::size_t i, const Intent& want) const noexcept;
  [[nodiscard]] bool may_jog(const Inputs& in, const Orders& orders) const noexcept;
  [[nodiscard]] bool may_jog_joint(std::size_t j) const noexcept;
  /// A locking indexer turns by hand only while something else has unlocked it.
  [[nodiscard]] bool axis_locked(std::size_t i) const noexcept;
  [[nodiscard]] bool joint_locked(std::size_t j) const noexcept;
  void watch_locks() noexcept;
  /// A jog wheel and what it has begun.
  struct Wheel {
    std::int32_t counts{0};  ///< of the last cycle
    bool known{false};       ///< there was a last cycle
    bool drives{false};      ///< the mover moves by this wheel
  };
  void take_wheels(const Inputs& in, const Orders& orders) noexcept;
  /// `allowed()` and `range_of()` are asked for only when the wheel has turned.
  template <class Allowed, class RangeOf>
  static void turn_wheel(const WheelInputs& in, Wheel& wheel, const Allowed& allowed,
                         AxisMover& mover, double max_vel, double max_acc, double max_jerk,
                         const RangeOf& range_of) noexcept;
  void take_homing(const Inputs& in, const Orders& orders) noexcept;
  void take_unhome(std::int32_t which) noexcept;
  void watch_jog_stop(const Inputs& in) noexcept;
  void watch_probe(const Inputs& in) noexcept;
  void move(const Inputs& in, const Orders& orders, double dt) noexcept;
  void look_for_other_equations(const Pose& was) noexcept;
  void move_joints() noexcept;
  void watch_tool_offset() noexcept;
  void step_axes(double dt) noexcept;
  void step_mixing_axes(double dt) noexcept;
  void pace_offsets() noexcept;
  void bring_up_slowly() noexcept;
  /// Where a stop of jogs leads: within soft limits, beyond one, or where there is no position.
  enum class StopBehind { inside, beyond, nowhere };
  [[nodiscard]] StopBehind stop_from_here(double cycle_s) const noexcept;
  /// Extra joints that are homed go where their pin says.
  void follow_posthome(const Inputs& in, double dt) noexcept;
  [[nodiscard]] bool is_posthome(std::size_t j) const noexcept {
    return j + static_cast<std::size_t>(status_.extra_joints) >= joints_ && joint_[j].homed;
  }
  void take_up_play(double dt) noexcept;
  /// Bit i: axis i jogs. An axis that the kinematics do not have never does.
  [[nodiscard]] std::uint32_t jogging_axes() const noexcept;
  [[nodiscard]] bool jogging() const noexcept;
  void watch_away(const Orders& orders) noexcept;
  void take_shift(const Orders& orders) noexcept;
  void fold_shift() noexcept;
  [[nodiscard]] Pose path_pose() const noexcept { return executor_.pose() + shift_; }
  [[nodiscard]] bool shift_leads_out() noexcept;
  [[nodiscard]] bool may_jog_axes() const noexcept { return mode_ == MotionMode::teleop || away_; }

  // controller_status.cpp
  void fill_status(const Inputs& in, const Orders& orders, double dt, std::int64_t now_ns) noexcept;
  void fill_joint(std::size_t j) noexcept;
  void note_changes() noexcept;

  const Kinematics& kinematics_;
  SpanRing& spans_;
  FaultRing& planner_faults_;
  std::size_t joints_, spindle_count_;
  MachineConfig config_{};
  const ScrewTable* screws_{nullptr};
  OutputBank outputs_;
  Spindles spindles_;
  Executor executor_;
  Homing homing_;
  Guard guard_;
  PathOracle path_oracle_;
  const ProgrammedMoves& programmed_;
  ExternalOffsets offsets_;
  Joint joint_[kMaxJoints];
  LostCycles lost_[kMaxJoints];
  bool plain_kinematics_{true};  ///< each joint moves an axis alone
  bool locks_{false};            ///< some axis has a joint that locks it
  bool kinematics_moved_{false}, unplaced_{false};
  int offset_told_{
      0};  ///< cycles within which pins of the kinematics may follow a new offset of the tool
  Pose offset_before_;         ///< of the tool, in the last cycle
  double skew_[kMaxJoints]{};  ///< of a joint from its place by the inverse kinematics; set at rest
  JogPace::Movers axis_;
  JogPace jog_pace_;
  double mixed_share_{
      1};  ///< of the limits of joints that mix axes, without what external offsets have of it
  Wheel joint_wheel_[kMaxJoints], axis_wheel_[rtapi::kAxes];
  AxisConfig
      axis_limit_[rtapi::kAxes];  ///< of the axis and of the joints that it moves alone, without
                                  ///< what external offsets have of it

  bool configured_{false}, enabled_{false}, armed_{true}, closing_down_{false};
  std::uint32_t enable_request_{0};  ///< the last one seen
  bool single_step_{false};
  bool start_due_{false}, start_taken_{false};
  bool jog_stop_before_{false}, jog_dead_before_{false}, probe_before_{false};
  MotionMode mode_{MotionMode::free}, refused_mode_{MotionMode::free};
  bool away_{false};     ///< jogs move the machine beside the path, which is held
  Pose shift_;           ///< of the machine from the coordinates of executor_
  Pose pose_, pose_fb_;  ///< the first without external offsets
  Pose pose_before_;     ///< pose_ of the last cycle
  std::uint32_t acked_epoch_{0};
  std::uint32_t intent_taken_{0};  ///< in force in the cycle before
  bool jog_waits_{false};          ///< for its mode
  std::uint64_t heartbeat_{0};
  double heartbeat_age_s_{0};
  std::uint32_t joint_jog_seen_[kMaxJoints]{}, axis_jog_seen_[rtapi::kAxes]{};
  std::uint32_t home_seen_{0}, unhome_seen_{0}, spindle_stop_seen_[kMaxSpindles]{};
  std::uint32_t wishes_seen_{0};
  struct WishesSeen {
    std::uint32_t digital_out[kMaxDigital]{}, analog_out[kMaxAnalog]{};
    std::uint32_t feed{0}, adaptive{0}, feed_hold{0}, spindle[kMaxSpindles]{},
        brake[kMaxSpindles]{}, restart[kMaxSpindles]{};
  } seen_;

  /// Of kinematics that were refused between two cycles.
  struct Refused {
    std::int32_t kind{0}, why{0};
  } refused_;
  FaultList faults_;
  std::uint64_t fault_number_{0};
  MotionStatus status_;
  struct Digest {
    std::uint64_t retraced{0}, faults{0};
    std::uint32_t acked{0}, intent{0}, flags{0}, homed{0};
    Pose shift;
    friend bool operator==(const Digest&, const Digest&) = default;
  } digest_;
  std::uint64_t executed_before_{0};
  bool changed_{false}, only_went_on_{false};
};

}  // namespace kerf::motion
