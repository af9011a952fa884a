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

/// Limits of its joints and axes, and with `path_jerk` of the jerk along the path ([TRAJ]MAX_LINEAR_JERK); 0: not limited.
inline void set_limits(motion::MachineConfig& config, Machine machine, double jerk,
                       double path_jerk = 0) {
  reference_machine(config);
  if (machine == Machine::table) {
    config.joint[4] = config.joint[3];
    config.axis[5] = config.axis[3];
  }
  for (auto& j : config.joint) j.max_jerk = jerk;
  config.traj_max_jerk_mm_s3 = path_jerk;
  config.max_feed_override = 2;
}

}  // namespace kerf::bench
