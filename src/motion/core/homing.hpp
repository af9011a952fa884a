// Homing: finds each joint's home switch and goes to its home position (manual "Homing Configuration"). @rt.
#pragma once

#include <cstdint>

#include "motion/core/io.hpp"
#include "motion/core/joint.hpp"

namespace kerf::motion {

/// Why a homing request failed: FaultRecord::value of Fault::home_failed.
enum class HomeFailure : std::int32_t {
  not_enabled = 1,        ///< machine off
  wrong_mode = 2,         ///< not in joint (free) mode
  inhibited = 3,          ///< motion.homing-inhibit
  latch_vel_zero = 4,     ///< HOME_SEARCH_VEL without HOME_LATCH_VEL
  index_unsupported = 5,  ///< homing to an encoder's index pulse
  switch_closed = 6,      ///< HOME_IS_SHARED and the switch is closed already
  switch_stuck = 7,       ///< the switch did not open within the search distance
  no_such_joint = 8,
  stopped = 9,           ///< abort, disable, or another joint's failure
  nothing_to_home = 10,  ///< home all, and no joint has a HOME_SEQUENCE
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
  };

  /// `joint` -1: all, in the order of the absolute values of HOME_SEQUENCE, equal ones together. A joint with a negative
  /// sequence takes the whole group along, and the group makes its final moves together. Faults are added to the list.
  void start(std::int32_t joint, std::size_t joints, Joint* state, const MachineConfig& config,
             FaultList& faults) noexcept;
  /// One cycle, before the movers are stepped.
  void step(std::size_t joints, Joint* state, const MachineConfig& config,
            FaultList& faults) noexcept;
  /// All joints that home brake and are not homed.
  void stop(std::size_t joints, Joint* state) noexcept;
  [[nodiscard]] bool active() const noexcept { return active_; }

 private:
  void begin_group(std::size_t joints, Joint* state, const MachineConfig& config,
                   FaultList& faults) noexcept;
  bool begin_joint(std::size_t j, Joint& joint, const JointConfig& c, FaultList& faults) noexcept;
  void step_joint(std::size_t j, Joint& joint, const JointConfig& c, FaultList& faults) noexcept;
  void set_home(Joint& joint, const JointConfig& c) noexcept;
  void seek(Joint& joint, const JointConfig& c, double velocity, double bound) noexcept;
  void fail(std::size_t j, Fault fault, double value, FaultList& faults) noexcept;

  bool active_{false}, all_{false}, failed_{false}, together_{false};
  std::int32_t sequence_{0};  ///< the group at work
  std::int32_t single_{-1};
};

}  // namespace kerf::motion
