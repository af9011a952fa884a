// The machines that programs of families.hpp are for, without HAL.
#pragma once

#include "bench/motion/families.hpp"
#include "bench/motion/table_kinematics.hpp"
#include "unit/motion/rig.hpp"

namespace kerf::bench {

inline constexpr TableKinematics kTable;

inline motion::test::RigKinematics moved_by(Machine machine) {
  return machine == Machine::table ? motion::test::RigKinematics(kTable)
                                   : motion::test::RigKinematics(std::vector<int>{0, 1, 2, 3});
}

/// Limits of its joints and axes; `jerk` 0: not limited.
inline void set_limits(motion::MachineConfig& config, Machine machine, double jerk) {
  reference_machine(config);
  if (machine == Machine::table) {
    config.joint[4] = config.joint[3];
    config.axis[5] = config.axis[3];
  }
  for (auto& j : config.joint) j.max_jerk = jerk;
  config.max_feed_override = 2;
}

}  // namespace kerf::bench
