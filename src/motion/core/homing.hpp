// Homing: finds each joint's home switch or index and goes to its home position (manual "Homing Configuration"). @rt.
//
// One request owns all joints that it homes. The first failure stops all of them, and none of them is homed then. Legs, which are
// joints of one axis in a synchronised group, back off their switches together and begin each phase together, so they never are
// farther apart than their switches are.
#pragma once

#include <cstdint>

#include "motion/api/kinematics.hpp"
#include "motion/core/homing_module.hpp"
#include "motion/core/io.hpp"
#include "motion/core/joint.hpp"

namespace kerf::motion {

/// Why a homing request failed: FaultRecord::value of Fault::home_failed.
enum class HomeFailure : std::int32_t {
  not_enabled = 1,     ///< machine off
  wrong_mode = 2,      ///< not in joint (free) mode
  inhibited = 3,       ///< motion.homing-inhibit
  latch_vel_zero = 4,  ///< HOME_SEARCH_VEL without HOME_LATCH_VEL
  latch_alone = 5,     ///< HOME_LATCH_VEL, and neither switch nor index
  switch_closed = 6,   ///< HOME_IS_SHARED and the switch is closed already
  switch_stuck = 7,    ///< the switch did not open within the search distance
  no_such_joint = 8,
  stopped = 9,             ///< abort, disable, or another joint's failure
  nothing_to_home = 10,    ///< home all, and no joint has a HOME_SEQUENCE
  switch_lost = 11,        ///< closed in the search, and not found again on the way back
  no_index = 12,           ///< joint.N.index-enable stayed true (limit: how far it went)
  index_without_vel = 13,  ///< HOME_USE_INDEX, and HOME_LATCH_VEL is 0
  extra_while_on = 14,     ///< unhome of an extra joint while the machine is on
  sequence_gap =
      15,  ///< home all ended: the next HOME_SEQUENCE (FaultRecord::limit) does not follow
  stale_feedback = 16,  ///< the switch or index came in a cycle without feedback
};

class Homing {
 public:
  /// Joints' states, as shown by joint.N.home-state.
  enum State : std::int32_t {
    idle = 0,
    backoff_first = 1,  ///< the switch was closed at the start
    search = 2,
    backoff_final = 3,  ///< before a latch in the direction of the search
    latch = 4,
    latch_stop = 5,
    wait_sequence = 6,  ///< for the others of a synchronised sequence
    final_move = 7,
    wait_unlock = 8,  ///< a locking indexer, before it moves
    index_search = 9,
    wait_lock = 10,  ///< and when it is home
  };

  /// Somebody else homes from now on.
  void use(HomingModule& module) noexcept { module_ = &module; }
  [[nodiscard]] HomingModule* module() const noexcept { return module_; }
  /// With a module, after the feedback is read: which joints are homed, and whose command follows the drive.
  void look_at_module(std::size_t joints, Joint* state) noexcept;
  /// `joint` -1: all, in the order of the absolute values of HOME_SEQUENCE, equal ones together. A joint with a negative
  /// sequence takes the whole group along, and the group makes its final moves together. Faults are added to the list; what
  /// no joint could do is refused before anything moves.
  void start(std::int32_t joint, std::size_t joints, Joint* state, const MachineConfig& config,
             const Kinematics& kinematics, FaultList& faults) noexcept;
  /// When the feedback is read: the index may have come, and with it the encoder's new count.
  void watch_index(std::size_t j, Joint& joint, const JointConfig& c) noexcept;
  /// One cycle, before the movers are stepped.
  void step(std::size_t joints, Joint* state, const MachineConfig& config,
            FaultList& faults) noexcept;
  /// All joints that home brake and are not homed.
  void stop(std::size_t joints, Joint* state) noexcept;
  [[nodiscard]] bool active() const noexcept { return active_; }

 private:
  /// What homing keeps of a joint.
  struct Leg {
    std::uint32_t partners{0};  ///< the legs of its axis that home with it, itself among them
    bool ready{false};          ///< done with its phase; the next begins when all partners are
    bool late{false};           ///< the index came in a cycle without feedback
    bool seen{false};           ///< the switch was closed at some time in this phase
    double goal{0};             ///< where the phase ends at the latest
    double speed{0}, bound{0};  ///< of the phase; signed speed
    double edge{0};             ///< where the search met the switch
    double overrun{0};          ///< how far it went on
  };

  [[nodiscard]] bool is_member(std::size_t j, const MachineConfig& config) const noexcept;
  [[nodiscard]] bool possible(std::size_t joints, const MachineConfig& config,
                              FaultList& faults) const noexcept;
  void begin_group(std::size_t joints, Joint* state, const MachineConfig& config,
                   FaultList& faults) noexcept;
  void find_partners(std::size_t joints, const Joint* state, const MachineConfig& config) noexcept;
  void begin_joint(std::size_t j, Joint* state, const MachineConfig& config) noexcept;
  void begin_moving(std::size_t j, Joint* state, const MachineConfig& config) noexcept;
  void step_joint(std::size_t j, Joint* state, const MachineConfig& config,
                  FaultList& faults) noexcept;
  void back_off(std::size_t j, Joint* state, const MachineConfig& config,
                FaultList& faults) noexcept;
  void find_edge(std::size_t j, Joint& joint, const JointConfig& c, FaultList& faults) noexcept;
  void go_on(std::size_t j, Joint* state, const MachineConfig& config) noexcept;
  bool next_sequence(std::size_t joints, const MachineConfig& config, FaultList& faults) noexcept;
  void start_final_moves(std::size_t joints, Joint* state, const MachineConfig& config) noexcept;
  void finish(Joint& joint) noexcept;
  void found(Joint& joint) noexcept;
  /// Begins a phase with a move of at most `bound` towards the sign of `velocity`.
  void seek(std::size_t j, Joint* state, const MachineConfig& config, std::int32_t phase,
            double velocity, double bound) noexcept;
  [[nodiscard]] bool partners_ready(std::size_t j, const Joint* state) const noexcept;
  [[nodiscard]] bool lost_switch(std::size_t j, const Joint& joint) const noexcept;
  static void lock_if_at_rest(Joint& joint) noexcept;
  void fail(std::size_t j, Fault fault, double value, FaultList& faults, double limit = 0) noexcept;

  template <class F>
  void for_partners(std::size_t j, F&& f) const noexcept {
    for (std::size_t p = 0; p < kMaxJoints; ++p)
      if ((leg_[j].partners >> p & 1U) != 0) f(p);
  }

  HomingModule* module_{nullptr};
  bool active_{false}, all_{false}, failed_{false}, together_{false};
  std::int32_t sequence_{0};  ///< the group at work
  std::int32_t single_{-1};
  std::int32_t axis_[kMaxJoints]{};  ///< that a joint moves alone, or -1
  Leg leg_[kMaxJoints];
};

}  // namespace kerf::motion
