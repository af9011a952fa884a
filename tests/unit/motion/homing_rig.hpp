// Machines with home switches, encoders that count from their index, and locks, for tests of homing.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "unit/motion/rig.hpp"

namespace kerf::motion::test {

/// What a motor has: where it truly stands, and what its switches and its encoder make of that.
struct Drive {
  double place{0};           ///< of the motor, whatever its encoder says
  double edge{3}, cam{1e9};  ///< the switch is closed from `edge` on, for `cam`
  double index_every{0};     ///< distance of index pulses; 0: none
  double zero{0};            ///< where the encoder counts from
  bool resets{true};         ///< the encoder counts from its index
  bool locks{false}, unlocked{false};
  int unlock_takes{20}, unlock_cycles{0};
  bool index_enable{false};
  double seen{0};  ///< place when the encoder last looked

  [[nodiscard]] bool closed() const { return place >= edge && place < edge + cam; }
};

class HomingRig : public Rig {
 public:
  explicit HomingRig(std::vector<int> axes = {0, 1, 2}) : Rig(std::move(axes)) {
    follow = false;
    for (JointConfig& c : config.joint) {
      c.home_search_vel = 20;
      c.home_latch_vel = -5;
      c.home_offset = 5;
      c.home = 1;
      c.home_sequence = 0;
      c.min_limit = -50;
      c.max_limit = 50;
      c.ferror = c.min_ferror = 0.5;
    }
    apply_config();
  }
  [[nodiscard]] std::size_t count() const { return controller->joints(); }

  /// The motors stand where `drive` says.
  void enable() {
    orders.enable = true;
    for (std::size_t j = 0; j < count(); ++j) drive[j].seen = drive[j].place;
    steps(2);
  }
  void home(int joint) {
    ++intent.home_seq;
    intent.home_joint = joint;
  }
  /// One cycle: encoders first, then motion, then the drives.
  void step() {
    for (std::size_t j = 0; j < count(); ++j) {
      Drive& d = drive[j];
      count_index(d);
      JointInputs& at = in.joint[j];
      at.motor_pos_fb = d.place - d.zero;
      at.home_switch = d.closed();
      at.index_enable = d.index_enable;
      at.is_unlocked = d.unlocked;
      before[j] = d.place;
    }
    if (disturb) disturb();
    cycle();
    for (std::size_t j = 0; j < count(); ++j) {
      Drive& d = drive[j];
      const Joint& joint = controller->joint(j);
      if (joint.index_order != 0) d.index_enable = joint.index_order > 0;
      move_lock(d, joint.unlock);
      const double wanted = joint.pos_cmd + joint.motor_offset + joint.backlash.position() + d.zero;
      if (!status().enabled) continue;
      if (d.locks && !d.unlocked && std::abs(wanted - d.place) > 1e-9) ++turned_locked;
      d.place = wanted;
    }
  }
  template <class F>
  bool step_until(F&& done, int limit = 20000) {
    for (int i = 0; i < limit; ++i) {
      step();
      if (done()) return true;
    }
    return false;
  }
  void steps(int n) {
    for (int i = 0; i < n; ++i) step();
  }
  [[nodiscard]] double failure() const {
    for (const auto& r : faults)
      if (r.fault == Fault::home_failed) return r.value;
    return 0;
  }
  [[nodiscard]] bool all_home() const { return status().all_homed && !status().homing_active; }

  Drive drive[kMaxJoints];
  double before[kMaxJoints]{};    ///< places at the start of the cycle
  std::function<void()> disturb;  ///< changes the inputs of the cycle
  int turned_locked{0};           ///< cycles in which a locked joint was to move

 private:
  static void count_index(Drive& d) {
    if (d.index_every > 0 && d.index_enable) {
      const double was = std::floor(d.seen / d.index_every),
                   is = std::floor(d.place / d.index_every);
      if (was != is) {
        d.index_enable = false;
        if (d.resets) d.zero = std::max(was, is) * d.index_every;
      }
    }
    d.seen = d.place;
  }
  static void move_lock(Drive& d, bool unlock) {
    if (!d.locks || unlock == d.unlocked) {
      d.unlock_cycles = 0;
      return;
    }
    if (++d.unlock_cycles >= d.unlock_takes) d.unlocked = unlock;
  }
};

}  // namespace kerf::motion::test
